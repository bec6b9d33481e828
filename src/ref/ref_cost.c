/* Cost volume: bins of a ray, the fluid level, and what every ray pays for every label. */
#include "ref/sv_ref_cost.h"

#include "sv_shared.h"

#include <math.h>
#include <stdlib.h>

sv_ref_cost_layout sv_ref_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices) {
    const uint32_t side = width > height ? width : height;
    sv_ref_cost_layout l = {.width = width, .height = height, .slices = slices};
    l.labels = slices < SV_COST_LABELS ? slices : SV_COST_LABELS;
    l.block = (side + SV_COST_CELLS / 2) / SV_COST_CELLS;
    if (l.block == 0) l.block = 1;
    l.cells_x = (width + l.block - 1) / l.block;
    l.cells_y = (height + l.block - 1) / l.block;
    l.scale = (double)l.labels / SV_COST_LABELS;
    l.gap = (uint32_t)ceil(SV_COST_GAP * l.scale);
    l.pitch = (double)slices / l.labels;
    l.sigma = SV_COST_SIGMA * (double)side / (SV_COST_CELLS * l.block);
    l.tau = SV_COST_TAU * l.scale;
    l.behind = SV_COST_BEHIND;
    l.other = SV_COST_OTHER;
    l.tissue = SV_COST_TISSUE / l.scale;
    l.tissues = SV_COST_TISSUES * l.scale;
    l.rank = SV_COST_RANK;
    l.slack = SV_COST_SLACK;
    l.yield = SV_COST_YIELD * l.scale;
    l.median = true;
    return l;
}

void sv_ref_cost_bins(const sv_ref_volume *v, const sv_ref_cost_layout *l, uint8_t *bins) {
    const size_t plane = (size_t)v->width * v->height;
    for (size_t pixel = 0; pixel < plane; pixel++) {
        uint32_t z = 0;
        for (uint32_t bin = 0; bin < l->labels; bin++) {
            uint32_t sum = 0, count = 0;
            for (; z < v->slices && (uint64_t)z * l->labels / v->slices == bin; z++) {
                const uint8_t voxel = v->voxels[z * plane + pixel];
                if (voxel == v->padding) continue;
                sum += voxel;
                count++;
            }
            const uint32_t mean = count ? (sum + count / 2) / count : 0;
            bins[bin * plane + pixel] = (uint8_t)(count && mean == 0 ? 1 : mean);
        }
    }
}

uint32_t sv_ref_cost_level(const uint8_t *bins, const sv_ref_cost_layout *l) {
    const size_t plane = (size_t)l->width * l->height;
    uint64_t histogram[256] = {0}, all = 0, total = 0;
    for (uint32_t cell = 0; cell < l->cells_y; cell++) {
        const uint32_t middle = cell * l->block + l->block / 2;
        const size_t y = middle < l->height ? middle : l->height - 1;
        for (uint32_t bin = 0; bin < l->labels; bin++)
            for (uint32_t x = 0; x < l->width; x++) histogram[bins[bin * plane + y * l->width + x]]++;
    }
    for (uint32_t i = 1; i < 256; i++) {
        all += histogram[i];
        total += i * histogram[i];
    }
    uint64_t split = all ? total / all : 0, dark = 0, bright = 0;
    for (uint32_t turn = 0; turn < 32; turn++) {
        uint64_t count = 0, sum = 0;
        for (uint32_t i = 1; i <= split; i++) {
            count += histogram[i];
            sum += i * histogram[i];
        }
        dark = count ? sum / count : 0;
        bright = all > count ? (total - sum) / (all - count) : split;
        const uint64_t next = (dark + bright) / 2;
        if (next == split) break;
        split = next;
    }
    const uint64_t level = dark + (bright > dark ? (bright - dark) / 4 : 0);
    return level ? (uint32_t)level : 1;
}

void sv_ref_cost_rays(const uint8_t *bins, const sv_ref_cost_layout *l, uint32_t level,
                      sv_ref_cost_ray *rays) {
    const size_t plane = (size_t)l->width * l->height;
    for (size_t pixel = 0; pixel < plane; pixel++) {
        sv_ref_cost_ray r = {.first = (uint8_t)l->labels, .place = (uint8_t)l->labels};
        bool seen = false;
        uint32_t run = 0;
        for (uint32_t bin = 0; bin < l->labels; bin++) {
            const uint8_t v = bins[bin * plane + pixel];
            if (v) r.scanned = true;
            const bool tissue = v > level;
            if (tissue) seen = true;
            run = v && !tissue && seen ? run + 1 : 0;
            if (run == l->gap && r.first == l->labels) r.first = (uint8_t)(bin + 1 - run);
            if (r.first < l->labels && tissue && v > r.maximum) {
                r.maximum = v;
                r.place = (uint8_t)bin;
            }
        }
        rays[pixel] = r;
    }
}

void sv_ref_cost_ranks(const sv_ref_cost_ray *rays, size_t count, double full, double bone[256]) {
    uint32_t histogram[256] = {0}, all = 0, below = 0;
    for (size_t i = 0; i < count; i++) histogram[rays[i].maximum]++;
    for (uint32_t i = 1; i < 256; i++) all += histogram[i];
    bone[0] = 0.0;
    for (uint32_t i = 1; i < 256; i++) {
        const double rank = all ? (below + 0.5 * histogram[i]) / all : 0.0;
        bone[i] = fmin(rank / full, 1.0);
        below += histogram[i];
    }
}

/* Marks the bins of fluid intervals that count: at least `gap` long, behind the first tissue. */
static void mark_open(const uint8_t *bins, const sv_ref_cost_layout *l, uint32_t level, size_t pixel,
                      bool open[]) {
    const size_t plane = (size_t)l->width * l->height;
    bool seen = false;
    for (uint32_t bin = 0; bin < l->labels;) {
        uint32_t end = bin;
        while (end < l->labels && bins[end * plane + pixel] && bins[end * plane + pixel] <= level) end++;
        const bool counts = seen && end - bin >= l->gap;
        for (uint32_t i = bin; i < end; i++) open[i] = counts;
        if (end < l->labels) {
            open[end] = false;
            seen = seen || bins[end * plane + pixel] > level;
        }
        bin = end + 1;
    }
}

void sv_ref_cost_of_ray(const uint8_t *bins, const sv_ref_cost_layout *l, uint32_t level,
                        const sv_ref_cost_ray *ray, double bone, uint32_t wall, size_t pixel, double cost[]) {
    const size_t plane = (size_t)l->width * l->height;
    const int n = (int)l->labels;
    bool open[SV_COST_LABELS];
    mark_open(bins, l, level, pixel, open);
    int last = ray->place < n ? ray->place : -1; /* the interval before the maximum: bins start .. last */
    while (last >= 0 && !open[last]) last--;
    int start = last;
    while (start > 0 && open[start - 1]) start--;
    double tissue = 0.0;
    for (int i = 0; i < n; i++) {
        double distance = INFINITY;
        for (int j = 0; j < n; j++)
            if (open[j]) distance = fmin(distance, i == j ? 0.0 : abs(i - j) - 0.5);
        double c = fmin(distance / l->tau, 1.0);
        if (last >= 0 && i > ray->place) c += l->behind * bone;
        if (last >= 0 && (i < start || i > last)) c += l->other * bone;
        const double here = i >= (int)wall && bins[(size_t)i * plane + pixel] > level ? 1.0 : 0.0;
        c += l->tissue * fmin(tissue + 0.5 * here, l->tissues);
        tissue += here;
        cost[i] = c;
    }
}
