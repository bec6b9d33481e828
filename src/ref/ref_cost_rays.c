/* SPDX-License-Identifier: MIT */
/* Cost volume: the runs of tissue along a ray, which of them may be the fetus, and what every label costs. */
#include "ref/ref_cost.h"

#include <math.h>

/* A run: tissue from bin `start` on, and the fluid in front of it, bins fluid .. start - 1. Bone splits a run
 * in two, of which the second has no fluid in front of it. */
typedef struct {
    uint32_t fluid, start, end;
    bool touching; /* it reaches from the wall on, where the fluid should begin */
    double fetus;  /* probability that it is the fetus; below 0: it cannot be */
} run_t;

enum { MAX_RUNS = 2 * SV_COST_LABELS };
typedef struct {
    const sv_ref_cost_scan *scan;
    uint32_t labels, wall, back;
    uint8_t value[SV_COST_LABELS];
    uint16_t sum[SV_COST_LABELS], nearby[SV_COST_LABELS];
    bool fluid[SV_COST_LABELS]; /* scanned, and no tissue of `thin` bins or more */
    uint32_t count;
    run_t run[MAX_RUNS];
} ray_t;

static bool is_tissue(const ray_t *r, uint32_t bin) {
    return r->value[bin] > r->scan->levels.fluid;
}

static bool read_ray(const sv_ref_cost_scan *scan, uint32_t column, uint32_t row, ray_t *r) {
    const sv_ref_cost_layout *l = scan->layout;
    const size_t plane = (size_t)l->sizes.columns * l->sizes.rows,
                 ray = (size_t)row * l->sizes.columns + column;
    const size_t cell = (size_t)(row / l->sizes.block) * l->sizes.cells_x + column / l->sizes.block;
    bool scanned = false;
    *r = (ray_t){.scan = scan, .labels = l->sizes.labels, .wall = scan->wall[cell], .back = scan->back[cell]};
    for (uint32_t bin = 0; bin < l->sizes.labels; bin++) {
        r->value[bin] = scan->bins[bin * plane + ray];
        r->sum[bin] = scan->sums[bin * plane + ray];
        r->nearby[bin] = scan->nearby[bin * plane + ray];
        scanned = scanned || r->value[bin];
    }
    for (uint32_t bin = 0; bin < l->sizes.labels;) {
        uint32_t end = bin;
        while (end < l->sizes.labels && is_tissue(r, end)) end++;
        const bool is_thin = end - bin < l->sizes.thin;
        for (; bin < end; bin++) r->fluid[bin] = is_thin;
        if (bin < l->sizes.labels) {
            r->fluid[bin] = r->value[bin] > 0;
            bin++;
        }
    }
    return scanned;
}

/* Finds the fluid intervals from the wall on, each with the tissue behind it. The first one is at least `gap`
 * long. Without a wall there is none. */
static void find_runs(ray_t *r) {
    const sv_ref_cost_layout *l = r->scan->layout;
    uint32_t bin = r->wall > l->sizes.solid ? r->wall - l->sizes.solid : 0;
    while (r->wall > 0 && bin < r->labels) {
        uint32_t end = bin;
        while (end < r->labels && r->fluid[end]) end++;
        if (end - bin >= (r->count ? 1 : l->sizes.gap)) {
            if (r->count == 0 && bin > r->wall + l->sizes.contact)
                r->run[r->count++] = (run_t){.fluid = r->wall - 1, .start = r->wall, .touching = true};
            if (r->count) r->run[r->count - 1].end = bin;
            r->run[r->count++] = (run_t){.fluid = bin, .start = end, .end = r->labels};
        }
        bin = end > bin ? end : bin + 1;
    }
}

/* Splits every run but the last where bone begins well behind its front. */
static void split_runs(ray_t *r) {
    const sv_ref_cost_layout *l = r->scan->layout;
    if (!l->bone_splits) return;
    run_t parts[MAX_RUNS];
    uint32_t count = 0;
    for (uint32_t j = 0; j < r->count; j++) {
        parts[count++] = r->run[j];
        if (j + 1 == r->count) break;
        const run_t run = r->run[j];
        uint32_t maximum = 0, bone = run.start;
        for (uint32_t bin = run.start; bin < run.end; bin++)
            if (is_tissue(r, bin) && r->nearby[bin] > maximum) maximum = r->nearby[bin];
        if (2 * maximum < SV_COST_BONE * SV_COST_NEIGHBOURS * r->scan->levels.bright) continue;
        while (!is_tissue(r, bone) || 10 * r->nearby[bone] < SV_COST_FRONT * maximum) bone++;
        if (bone - run.start < l->sizes.split) continue;
        parts[count - 1].end = bone;
        parts[count++] = (run_t){.fluid = bone, .start = bone, .end = run.end};
    }
    for (uint32_t j = 0; j < count; j++) r->run[j] = parts[j];
    r->count = count;
}

static double logistic(double x) {
    return 1.0 / (1.0 + exp(-x));
}

/* Finds the probability that each run is the fetus. It depends on thickness and brightness, and is less if a
 * run behind is likely. The last run is the back of the sac. */
static void find_probabilities(ray_t *r) {
    const sv_ref_cost_layout *l = r->scan->layout;
    const double unit = (double)SV_COST_NEIGHBOURS * r->scan->levels.bright;
    double behind = 0.0;
    for (uint32_t j = r->count; j-- > 0;) {
        run_t *run = &r->run[j];
        uint32_t tissue = 0, own = 0, nearby = 0;
        for (uint32_t bin = run->start; bin < run->end; bin++) {
            if (!is_tissue(r, bin)) continue;
            tissue++;
            if (r->sum[bin] > own) own = r->sum[bin];
            if (r->nearby[bin] > nearby) nearby = r->nearby[bin];
        }
        run->fetus = -1.0;
        if (j + 1 == r->count || tissue < l->sizes.thin) continue;
        const double thickness =
            fmin(fmax((tissue - l->thick_from) / (l->thick_full - l->thick_from), 0.0), 1.0);
        const double evidence = run->touching ? (double)SV_COST_WALL * nearby / unit + SV_COST_WALL_BIAS
                                              : (double)SV_COST_NEARBY * nearby / unit +
                                                    (double)SV_COST_OWN * own / unit + l->thick * thickness +
                                                    SV_COST_BIAS;
        run->fetus = logistic(evidence - l->behind_penalty * behind);
        behind = fmax(behind, logistic(evidence));
    }
}

/* Sets the costs to the distance to the fluid of the intervals, as a share of tau. */
static void cost_distance(const ray_t *r, double cost[]) {
    for (uint32_t bin = 0; bin < r->labels; bin++) {
        double distance = INFINITY;
        for (uint32_t j = 0; j < r->count; j++) {
            const run_t *run = &r->run[j];
            if (run->fluid == run->start) continue;
            if (bin < run->fluid)
                distance = fmin(distance, run->fluid - bin - 0.5);
            else
                distance = bin < run->start ? 0.0 : fmin(distance, bin - run->start + 0.5);
        }
        cost[bin] = fmin(distance / r->scan->layout->tau, 1.0);
    }
}

/* Returns the longest interval in front of the back of the sac. */
static const run_t *longest_interval(const ray_t *r) {
    const run_t *best = &r->run[0];
    for (uint32_t j = 1; j < r->count; j++) {
        const run_t *run = &r->run[j];
        if (run->fluid + r->scan->layout->sizes.solid >= r->back) break;
        if (run->start - run->fluid > best->start - best->fluid) best = run;
    }
    return best;
}

bool sv_ref_cost_of_ray(const sv_ref_cost_scan *scan, uint32_t column, uint32_t row, sv_ref_cost_ray *out) {
    const sv_ref_cost_layout *l = scan->layout;
    ray_t r;
    if (!read_ray(scan, column, row, &r)) return false;
    find_runs(&r);
    split_runs(&r);
    find_probabilities(&r);
    *out = (sv_ref_cost_ray){.weight = 1.0, .open = r.count > 0};
    cost_distance(&r, out->cost);
    if (!out->open) return true;
    double none = 1.0; /* probability that no run so far is the fetus */
    for (uint32_t j = 0; j < r.count; j++) {
        const run_t *run = &r.run[j];
        if (run->fetus < 0.0) continue;
        const double here = none * run->fetus;
        none *= 1.0 - run->fetus;
        if (run->touching) out->weight = pow(2.0 * run->fetus - 1.0, 2.0);
        for (uint32_t bin = 0; bin < r.labels; bin++) {
            if (bin >= run->start) out->cost[bin] += l->cut_cost * here;
            if (bin < run->fluid) out->cost[bin] += l->occluder_cost * here;
        }
    }
    const run_t *open = longest_interval(&r);
    for (uint32_t bin = 0; bin < r.labels; bin++)
        if (bin < open->fluid || bin >= open->start) out->cost[bin] += l->wrong_fluid_cost * none;
    return true;
}
