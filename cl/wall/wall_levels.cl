/* SPDX-License-Identifier: MIT */
/*
 * Grey levels, in both layouts: the threshold between fluid and tissue, whether the surface lies in fluid,
 * and how likely tissue of a brightness is the fetus. Each kernel is one work group of any size and works in
 * integers. The histograms of all rows are some 16,000 words, which a single work item of a GPU would wait
 * for one by one. What one work item does alone is some thousand steps in local memory.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* Sums the histograms of all rows, and behind them their word `extra`. All work items of the group call it.
 * */
static void sum_rows(const sv_wall_layout *l, __global const uint *histograms, uint extra,
                     __local ulong *sums) {
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    for (uint i = item; i < 256; i += items) sums[i] = 0;
    if (item == 0) sums[256] = 0;
    for (uint y = 0; y < l->cells[1]; y++, histograms += HISTOGRAM_WORDS) {
        for (uint i = item; i < 256; i += items) sums[i] += histograms[i];
        if (item == 0) sums[256] += histograms[extra];
    }
}

/* Counts the levels up to the split, and sums up their roots. */
static void below(__local const ulong *histogram, __global const uint *root, ulong split, ulong *counted,
                  ulong *sum) {
    *counted = *sum = 0;
    for (uint i = 0; i < 256 && root[i] <= split; i++) {
        *counted += histogram[i];
        *sum += histogram[i] * root[i];
    }
}

/* Finds the split between the classes, midway between the means of their roots (isodata). False if there is
 * one class only. */
static bool find_split(__local const ulong *histogram, __global const uint *root, ulong *split) {
    ulong all, total, counted, sum, next;
    below(histogram, root, (ulong)root[255], &all, &total);
    if (all == 0) return false;
    next = total / all;
    *split = 0;
    for (uint turn = 0; turn < SV_WALL_MAX_ITERATIONS && next != *split; turn++) {
        *split = next;
        below(histogram, root, *split, &counted, &sum);
        if (counted == 0 || counted == all) return false;
        next = (sum / counted + (total - sum) / (all - counted)) / 2;
    }
    below(histogram, root, *split, &counted, &sum);
    return counted > 0 && counted < all;
}

/* Returns the level below which `rank` per mille of the histogram lie, in units of 1 / SV_WALL_LEVEL_ONE. */
static uint quantile(__local const ulong *histogram, uint rank) {
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

/* Stores what the histogram shows. One work item calls it. */
static void store_levels(const sv_wall_layout *l, __local const ulong *histogram, __global const uint *root,
                         __global uint *info) {
    ulong split = 0, counted = 0, sum = 0;
    info[SV_WALL_INFO_RAYS] = (uint)histogram[256];
    info[SV_WALL_INFO_OUTCOME] = SV_WALL_EMPTY;
    info[SV_WALL_INFO_DOUBTFUL] = info[SV_WALL_INFO_FOUND] = info[SV_WALL_INFO_WANTED] = 0;
    info[SV_WALL_INFO_THRESHOLD] = info[SV_WALL_INFO_FLUID] = info[SV_WALL_INFO_BRIGHT] =
        info[SV_WALL_INFO_WALL_RAYS] = 0;
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
    info[SV_WALL_INFO_THRESHOLD] = threshold;
    info[SV_WALL_INFO_FLUID] =
        (quantile(histogram, l->fluid_rank) + SV_WALL_LEVEL_ONE / 2) / SV_WALL_LEVEL_ONE;
    info[SV_WALL_INFO_BRIGHT] = (uint)(SV_WALL_LEVEL_ONE * sum / counted);
    info[SV_WALL_INFO_OUTCOME] = SV_WALL_SURFACE;
}

/* Returns the square root of a level in units of 1 / SV_WALL_LEVEL_ONE, linear between whole levels. */
static uint root_of(__global const uint *root, uint level) {
    const uint whole = level / SV_WALL_LEVEL_ONE, part = level % SV_WALL_LEVEL_ONE;
    if (whole >= 255) return root[255];
    return root[whole] + (root[whole + 1] - root[whole]) * part / SV_WALL_LEVEL_ONE;
}

/* Stores what levels are multiplied by: SV_WALL_TISSUE over the threshold at each brightness around them.
 * All work items of the group call it. */
static void store_gains(const sv_wall_layout *l, __local const ulong *histogram, __global const uint *root,
                        __global uint *info) {
    const uint one = SV_WALL_PER_MILLE;
    const uint dark = root_of(root, max(quantile(histogram, l->dark_rank), (uint)SV_WALL_LEVEL_ONE));
    for (uint i = (uint)get_local_id(0); i < SV_WALL_GAINS; i += (uint)get_local_size(0)) {
        const uint bright = root_of(root, i * (SV_WALL_LEVEL_ONE / SV_WALL_BRIGHT_ONE));
        const uint threshold = ((one - l->threshold) * dark + l->threshold * bright) / one;
        info[SV_WALL_INFO_GAINS + i] =
            ((uint)SV_WALL_TISSUE << (2 * SV_WALL_ROOT_BITS + SV_WALL_GAIN_BITS)) / (threshold * threshold);
    }
}

/* Launched as one work group. */
__kernel void wall_levels(sv_wall_layout l, __global const uint *restrict histograms,
                          __global const uint *restrict tables, __global uint *restrict info) {
    __local ulong histogram[257];
    sum_rows(&l, histograms, HISTOGRAM_RAYS, histogram);
    barrier(CLK_LOCAL_MEM_FENCE);
    store_gains(&l, histogram, tables + SV_WALL_ROOTS, info);
    if (get_local_id(0) == 0) store_levels(&l, histogram, tables + SV_WALL_ROOTS, info);
}

/* Returns ln of the odds of a level in units of 1 / SV_WALL_LEVEL_ONE. */
static int odds(__global const uint *tables, uint level) {
    const int here = (int)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE];
    const int next = (int)tables[SV_WALL_ODDS + level / SV_WALL_LEVEL_ONE + 1];
    return here + (next - here) * (int)(level % SV_WALL_LEVEL_ONE) / SV_WALL_LEVEL_ONE;
}

/* Returns the logistic function for a brightness that is `above` spreads over the wall's. */
static uint probability(const sv_wall_layout *l, __global const uint *tables, int above) {
    const int evidence = clamp(above, -SV_WALL_MAX_EVIDENCE, SV_WALL_MAX_EVIDENCE) * l->slope / 16;
    const uint size = abs(evidence), part = 1 << SV_WALL_LOGISTIC_BITS;
    uint p = SV_WALL_PROBABILITY_ONE;
    if (size / part < SV_WALL_LOGISTIC) {
        __global const uint *at = tables + SV_WALL_CURVE + size / part;
        p = at[0] + ((at[1] - at[0]) * (size % part) + part / 2) / part;
    }
    return evidence < 0 ? SV_WALL_PROBABILITY_ONE - p : p;
}

/* Returns the probability that tissue of a brightness is the fetus. `from`: ln of the odds of the wall's
 * brightness. */
static uint probability_of(const sv_wall_layout *l, __global const uint *tables, uint bright, int from,
                           int spread, bool first) {
    const int more = odds(tables, bright * SV_WALL_LEVEL_ONE) - from;
    const int above = more * (1 << SV_WALL_ODDS_BITS) / spread - l->fetus_level;
    return probability(l, tables, first ? above - l->first_run_extra : above);
}

/* Launched as one work group: from the histogram of the walls to probabilities. All work items find the same
 * wall. */
__kernel void wall_evidence(sv_wall_layout l, __global const uint *restrict histograms,
                            __global const uint *restrict tables, __global uint *restrict info) {
    __local ulong histogram[257];
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), rays = info[SV_WALL_INFO_RAYS];
    const bool wanted = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    sum_rows(&l, histograms, HISTOGRAM_WALL_RAYS, histogram);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE); /* until all have read the outcome */
    if (!wanted) return;
    const uint wall_rays = (uint)histogram[256];
    uint wall = min(info[SV_WALL_INFO_BRIGHT] * l.assumed_wall / SV_WALL_PER_MILLE, 255u * SV_WALL_LEVEL_ONE);
    int spread = l.assumed_spread;
    const bool bare = wall_rays == 0 || (ulong)wall_rays * SV_WALL_PER_MILLE < (ulong)rays * l.seen_share;
    if (!bare) {
        wall = quantile(histogram, SV_WALL_PER_MILLE / 2);
        spread = odds(tables, quantile(histogram, SV_WALL_PER_MILLE - l.tail_rank)) -
                 odds(tables, quantile(histogram, l.tail_rank));
        spread = max(spread, SV_WALL_MIN_SPREAD);
    }
    const int from = odds(tables, wall);
    for (uint i = item; i < 256; i += items) {
        const uint any = probability_of(&l, tables, i, from, spread, false);
        const bool is_least =
            i == 0 || probability_of(&l, tables, i - 1, from, spread, false) < SV_WALL_LIKELY;
        info[SV_WALL_INFO_PROBABILITIES + i] = any << 16 | probability_of(&l, tables, i, from, spread, true);
        /* probabilities grow with the brightness, so one work item writes */
        if (any >= SV_WALL_LIKELY && is_least) info[SV_WALL_INFO_FETUS] = i;
        if (any < SV_WALL_LIKELY && i == 255) info[SV_WALL_INFO_FETUS] = 256;
    }
    if (item > 0) return;
    info[SV_WALL_INFO_WALL_RAYS] = wall_rays;
    info[SV_WALL_INFO_BARE] = bare;
}

/* Returns the outcome of the frame that this one continues. */
static uint last_of(const sv_wall_layout *l, __global const uint *info) {
    return l->last == SV_WALL_REMEMBERED ? info[SV_WALL_INFO_LAST] : l->last;
}

/* Moves a limit in favour of what was said of the frame before: that the share is above it, or below. */
static uint limit_after(const sv_wall_layout *l, uint limit, bool above, bool below) {
    const uint lower = limit - min(limit, l->hysteresis);
    return above ? lower : below ? limit + l->hysteresis : limit;
}

/* True if a person who asks for it gets a surface all the same. */
static bool clips_if_asked(uint answer) {
    return answer == SV_WALL_DOUBTFUL || answer == SV_WALL_NO_FLUID;
}

/* Takes what the beams say of the volume: without a surface along them there is none. */
static void take_answer(const sv_wall_layout *l, __global const uint *told, __global uint *info) {
    const uint answer = told[SV_WALL_INFO_LAST];
    info[SV_WALL_INFO_FOUND] = told[SV_WALL_INFO_LAST_FOUND];
    info[SV_WALL_INFO_WANTED] = told[SV_WALL_INFO_LAST_WANTED];
    if (answer != SV_WALL_DOUBTFUL && !(clips_if_asked(answer) && l->clip_doubtful))
        info[SV_WALL_INFO_OUTCOME] = answer;
}

/* Launched as one work item: asks whether enough rays show the fetus by its brightness. `fetus`: for each row
 * of cells, the sum over its rays of the probability that the fetus is on them. They are so few that they
 * need no group. `told`: what is known along the beams, if layout.told. */
__kernel void wall_decide(sv_wall_layout l, __global const ulong *restrict fetus,
                          __global const uint *restrict told, __global uint *restrict info) {
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    if (l.told) {
        take_answer(&l, told, info);
        return;
    }
    ulong sum = 0;
    for (uint y = 0; y < l.cells[1]; y++) sum += fetus[y];
    const ulong whole = (ulong)info[SV_WALL_INFO_RAYS] * SV_WALL_PROBABILITY_ONE;
    const uint last = last_of(&l, info);
    const bool was = last != SV_WALL_NO_FETUS && last != SV_WALL_EMPTY;
    const uint limit = limit_after(&l, l.seen_share, was, last == SV_WALL_NO_FETUS);
    info[SV_WALL_INFO_FOUND] = (uint)(sum * SV_WALL_PER_MILLE / max(whole, (ulong)1));
    info[SV_WALL_INFO_WANTED] = limit;
    info[SV_WALL_INFO_UNSEEN] = sum * SV_WALL_PER_MILLE < whole * limit;
}

/* Returns what the gaps tell of a surface, and stores by which figures; those of an unseen fetus are there.
 */
static uint verdict_of(const sv_wall_layout *l, ulong dark, ulong in_gaps, ulong open, __global uint *info) {
    const ulong share = in_gaps * SV_WALL_PER_MILLE;
    const uint last = last_of(l, info);
    const bool no_fluid = last == SV_WALL_NO_FLUID || last == SV_WALL_OPEN,
               doubtful = last == SV_WALL_DOUBTFUL;
    const uint least = limit_after(l, l->doubtful_share, last == SV_WALL_SURFACE || doubtful, no_fluid);
    const uint limit = limit_after(l, l->gap_share, last == SV_WALL_SURFACE, doubtful || no_fluid);
    const uint clear = limit_after(l, l->clear_share, last == SV_WALL_SURFACE, last == SV_WALL_NO_FETUS);
    if (info[SV_WALL_INFO_UNSEEN] && (dark == 0 || share < dark * clear)) return SV_WALL_NO_FETUS;
    info[SV_WALL_INFO_FOUND] = (uint)(share / max(dark, (ulong)1));
    info[SV_WALL_INFO_WANTED] = limit;
    if (dark == 0 || share < dark * least)
        return open > 0 && 2 * open >= info[SV_WALL_INFO_RAYS] ? SV_WALL_OPEN : SV_WALL_NO_FLUID;
    return share < dark * limit ? SV_WALL_DOUBTFUL : SV_WALL_SURFACE;
}

/* Sums what wall_gaps has counted, and returns what it tells. */
static uint ask_gaps(const sv_wall_layout *l, __global const ulong *gaps, __global uint *info) {
    ulong sums[3] = {0, 0, 0};
    for (uint y = 0; y < l->cells[1]; y++)
        for (uint k = 0; k < 3; k++) sums[k] += gaps[3 * y + k];
    return verdict_of(l, sums[0], sums[1], sums[2], info);
}

/* Launched as one work item: decides whether the frame clips at its surface. `gaps`: for each row of cells,
 * what wall_gaps has counted; it is not read if layout.told. */
__kernel void wall_verdict(sv_wall_layout l, __global const ulong *restrict gaps,
                           __global const uint *restrict told, __global uint *restrict info,
                           __global uint *restrict record) {
    uint verdict = info[SV_WALL_INFO_OUTCOME];
    if (verdict == SV_WALL_SURFACE) {
        verdict = l.told ? told[SV_WALL_INFO_LAST] : ask_gaps(&l, gaps, info);
        const bool asked = clips_if_asked(verdict) && l.clip_doubtful;
        info[SV_WALL_INFO_DOUBTFUL] = asked || verdict == SV_WALL_DOUBTFUL;
        info[SV_WALL_INFO_OUTCOME] = asked ? SV_WALL_SURFACE : verdict;
    }
    info[SV_WALL_INFO_LAST] = verdict;
    info[SV_WALL_INFO_LAST_FOUND] = info[SV_WALL_INFO_FOUND];
    info[SV_WALL_INFO_LAST_WANTED] = info[SV_WALL_INFO_WANTED];
    const bool clips = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    record[SV_REC_RAYS] = l.width * l.height;
    record[SV_REC_POINTS] = 0;
    record[SV_REC_UNFILLED] = clips ? 0 : record[SV_REC_RAYS];
    record[SV_REC_OUTCOME] = clips ? SV_OUTCOME_OK : SV_OUTCOME_NO_SURFACE;
}
