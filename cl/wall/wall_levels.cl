/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, grey levels: the threshold between fluid and tissue, whether there is fluid at all, and
 * how likely tissue of a brightness is the fetus. One work item each, integers only.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* All rows' histograms together, and word `extra` of them. */
static ulong sum_rows(const sv_wall_layout *l, __global const uint *histograms, uint extra,
                      ulong histogram[256]) {
    ulong sum = 0;
    for (uint i = 0; i < 256; i++) histogram[i] = 0;
    for (uint y = 0; y < l->rows; y++, histograms += HISTOGRAM_WORDS) {
        for (uint i = 0; i < 256; i++) histogram[i] += histograms[i];
        sum += histograms[extra];
    }
    return sum;
}

/* The histogram after two box filters; beyond its ends it is mirrored. */
static void smooth_levels(const ulong *histogram, ulong *smooth) {
    ulong counts[256];
    for (int i = 0; i < 256; i++) counts[i] = histogram[i];
    for (int turn = 0; turn < 2; turn++) {
        for (int i = 0; i < 256; i++) {
            smooth[i] = 0;
            for (int k = i - SV_WALL_SMOOTH; k <= i + SV_WALL_SMOOTH; k++)
                smooth[i] += counts[k < 0 ? -k - 1 : k > 255 ? 511 - k : k];
        }
        for (int i = 0; i < 256; i++) counts[i] = smooth[i];
    }
}

/* True if the lowest count between the modes of the two classes is too high for fluid. Changes the
 * histogram. */
static bool is_shallow(const sv_wall_layout *l, ulong *histogram, uint threshold) {
    ulong smooth[256];
    histogram[255] = 0; /* saturated blocks are no mode */
    uint dark = 0, bright = threshold + 1;
    smooth_levels(histogram, smooth);
    for (uint i = 0; i <= threshold; i++)
        if (smooth[i] > smooth[dark]) dark = i;
    for (uint i = threshold + 1; i < 256; i++)
        if (smooth[i] > smooth[bright]) bright = i;
    ulong mode = min(smooth[dark], smooth[bright]), least = mode;
    for (uint i = dark; i <= bright; i++) least = min(least, smooth[i]);
    if (mode == 0) mode = least = 1;
    return least * SV_WALL_PER_MILLE > mode * l->valley;
}

/* Count and sum of root * count up to the split. */
static void below(const ulong *histogram, __global const uint *root, ulong split, ulong *counted,
                  ulong *sum) {
    *counted = *sum = 0;
    for (uint i = 0; i < 256 && root[i] <= split; i++) {
        *counted += histogram[i];
        *sum += histogram[i] * root[i];
    }
}

/* The split between the classes, midway between the means of their roots (isodata); false if there is one
 * class only. */
static bool find_split(const ulong *histogram, __global const uint *root, ulong *split) {
    ulong all, total, counted, sum, next;
    below(histogram, root, (ulong)root[255], &all, &total);
    if (all == 0) return false;
    next = total / all;
    *split = 0;
    for (uint turn = 0; turn < SV_WALL_TURNS && next != *split; turn++) {
        *split = next;
        below(histogram, root, *split, &counted, &sum);
        if (counted == 0 || counted == all) return false;
        next = (sum / counted + (total - sum) / (all - counted)) / 2;
    }
    below(histogram, root, *split, &counted, &sum);
    return counted > 0 && counted < all;
}

/* One work item. */
__kernel void wall_levels(sv_wall_layout l, __global const uint *restrict histograms,
                          __global const uint *restrict tables, __global uint *restrict info) {
    ulong histogram[256], split = 0, counted = 0, sum = 0;
    __global const uint *root = tables + SV_WALL_ROOTS;
    info[INFO_RAYS] = (uint)sum_rows(&l, histograms, HISTOGRAM_RAYS, histogram);
    info[INFO_OUTCOME] = SV_WALL_EMPTY;
    info[INFO_THRESHOLD] = info[INFO_TISSUE] = info[INFO_BRIGHT] = info[INFO_WALL_RAYS] = 0;
    if (!find_split(histogram, root, &split)) return;
    uint threshold = 0;
    for (uint i = 0; i < 256; i++) {
        if (root[i] <= split) {
            threshold = i;
        } else {
            counted += histogram[i];
            sum += i * histogram[i];
        }
    }
    info[INFO_THRESHOLD] = threshold;
    const uint bright = (uint)(SV_WALL_LEVEL_ONE * sum / counted);
    const uint way = bright - threshold * SV_WALL_LEVEL_ONE;
    info[INFO_TISSUE] = threshold + way * l.tissue / SV_WALL_PER_MILLE / SV_WALL_LEVEL_ONE;
    info[INFO_BRIGHT] = bright;
    info[INFO_SHALLOW] = is_shallow(&l, histogram, threshold);
    info[INFO_OUTCOME] = SV_WALL_SURFACE;
}

/* The level below which `rank` per mille of the histogram lie, in units of 1 / SV_WALL_LEVEL_ONE. */
static uint quantile(const ulong *histogram, uint rank) {
    ulong all = 0, before = 0;
    for (uint i = 0; i < 256; i++) all += histogram[i];
    const ulong wanted = all * rank;
    for (uint i = 0; i < 256; i++) {
        const ulong upto = (before + histogram[i]) * SV_WALL_PER_MILLE;
        if (histogram[i] > 0 && upto >= wanted) {
            const ulong part = (wanted - before * SV_WALL_PER_MILLE) * SV_WALL_LEVEL_ONE /
                               (histogram[i] * SV_WALL_PER_MILLE);
            const uint level = i * SV_WALL_LEVEL_ONE + (uint)part;
            return max(level, (uint)(SV_WALL_LEVEL_ONE / 2)) - SV_WALL_LEVEL_ONE / 2;
        }
        before += histogram[i];
    }
    return 255 * SV_WALL_LEVEL_ONE;
}

/* ln of the odds of a level in units of 1 / SV_WALL_LEVEL_ONE. */
static int odds(__global const uint *tables, uint level) {
    const int here = (int)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE];
    const int next = (int)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE + 1];
    return here + (next - here) * (int)(level % SV_WALL_LEVEL_ONE) / SV_WALL_LEVEL_ONE;
}

/* The logistic function of the evidence that a brightness `above` spreads over the wall's is. */
static uint probability(const sv_wall_layout *l, __global const uint *tables, int above) {
    const int evidence = clamp(above, -SV_WALL_FAR_ABOVE, SV_WALL_FAR_ABOVE) * l->sure / 16;
    const uint size = abs(evidence), part = 1 << SV_WALL_LOGISTIC_BITS;
    uint p = SV_WALL_SURE;
    if (size / part < SV_WALL_LOGISTIC) {
        __global const uint *at = tables + SV_WALL_CURVE + size / part;
        p = at[0] + ((at[1] - at[0]) * (size % part) + part / 2) / part;
    }
    return evidence < 0 ? SV_WALL_SURE - p : p;
}

/* One work item: from the histogram of the walls to probabilities. */
__kernel void wall_evidence(sv_wall_layout l, __global const uint *restrict histograms,
                            __global const uint *restrict tables, __global uint *restrict info) {
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    ulong histogram[256];
    const uint rays = info[INFO_RAYS];
    const uint wall_rays = (uint)sum_rows(&l, histograms, HISTOGRAM_WALL_RAYS, histogram);
    uint wall = min(info[INFO_BRIGHT] * l.assumed_wall / SV_WALL_PER_MILLE, 255u * SV_WALL_LEVEL_ONE);
    int spread = l.assumed_spread;
    const bool bare = wall_rays == 0 || (ulong)wall_rays * SV_WALL_PER_MILLE < (ulong)rays * l.wall_share;
    if (!bare) {
        wall = quantile(histogram, l.wall_rank);
        spread =
            odds(tables, quantile(histogram, l.high_rank)) - odds(tables, quantile(histogram, l.low_rank));
        spread = max(spread, SV_WALL_SPREAD_LEAST);
    }
    info[INFO_WALL_RAYS] = wall_rays;
    info[INFO_BARE] = bare;
    const bool walled = (ulong)wall_rays * SV_WALL_PER_MILLE >= (ulong)rays * l.walled;
    if (info[INFO_SHALLOW] && !walled) info[INFO_OUTCOME] = SV_WALL_NO_FLUID;
    const int from = odds(tables, wall);
    for (uint i = 0; i < 256; i++) {
        const int more = odds(tables, i * SV_WALL_LEVEL_ONE) - from;
        const int above = more * (1 << SV_WALL_ODDS_BITS) / spread - l.level;
        info[INFO_CHANCES + i] = probability(&l, tables, above - l.first);
        info[INFO_CHANCES + 256 + i] = probability(&l, tables, above);
    }
}

/* One work item: whether the frame has a surface. `fetus`: sums over the rays of a row of the
 * probability that the fetus is on them. */
__kernel void wall_decide(sv_wall_layout l, __global const ulong *restrict fetus,
                          __global uint *restrict info, __global uint *restrict record) {
    bool wanted = info[INFO_OUTCOME] == SV_WALL_SURFACE;
    if (wanted) {
        ulong sum = 0;
        for (uint y = 0; y < l.rows; y++) sum += fetus[y];
        wanted = sum * SV_WALL_PER_MILLE >= (ulong)info[INFO_RAYS] * SV_WALL_SURE * l.fetus_share;
        if (!wanted) info[INFO_OUTCOME] = SV_WALL_NO_FETUS;
    }
    record[SV_REC_PASSES] = wanted;
    record[SV_REC_UNFILLED] = wanted ? 0 : record[SV_REC_RAYS];
    record[SV_REC_OUTCOME] = wanted ? SV_OUTCOME_OK : SV_OUTCOME_NO_SURFACE;
}
