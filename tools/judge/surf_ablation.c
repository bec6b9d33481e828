/* SPDX-License-Identifier: MIT */
#include "judge/surf_ablation.h"

#include "ref/ref_cost.h"

#include <stdio.h>
#include <stdlib.h>

/* One thing changed. Numbers are factors; 0 in `gain` is 1. */
static const struct {
    const char *what;
    enum {
        NOTHING,
        CUT,
        OCCLUDER,
        WRONG_FLUID,
        THICK,
        BEHIND,
        TAU,
        SIGMA,
        AVERAGE_MARGIN,
        SHIFT,
        SPLIT,
        CONTACT,
        MEDIAN
    } part;
    double factor;
    int level;   /* T_L; 0: from the histogram */
    double gain; /* of the grey levels */
} changes[] = {
    {"as it is", NOTHING, 1, 0, 0},
    {"cutting costs half", CUT, 0.5, 0, 0},
    {"cutting costs twice", CUT, 2, 0, 0},
    {"leaving occluders costs nothing", OCCLUDER, 0, 0, 0},
    {"leaving occluders costs twice", OCCLUDER, 2, 0, 0},
    {"no term for the longest interval", WRONG_FLUID, 0, 0, 0},
    {"thickness is no evidence", THICK, 0, 0, 0},
    {"no doubt by runs farther back", BEHIND, 0, 0, 0},
    {"runs are not parted at bone", SPLIT, 0, 0, 0},
    {"what touches the wall is part of it", CONTACT, 0, 0, 0},
    {"fluid four times as near (tau / 4)", TAU, 0.25, 0, 0},
    {"fluid twice as far (tau x 2)", TAU, 2, 0, 0},
    {"lateral Gaussian x 0.7", SIGMA, 0.7, 0, 0},
    {"lateral Gaussian x 1.4", SIGMA, 1.4, 0, 0},
    {"no median", MEDIAN, 0, 0, 0},
    {"sharper minimum (slack / 4)", AVERAGE_MARGIN, 0.25, 0, 0},
    {"no yielding where unsure", SHIFT, 0, 0, 0},
    {"yielding three times as much", SHIFT, 3, 0, 0},
    {"T_L fixed at 25", NOTHING, 1, 25, 0},
    {"T_L fixed at 40", NOTHING, 1, 40, 0},
    {"T_L fixed at 60", NOTHING, 1, 60, 0},
    {"gain 0.7, T_L found", NOTHING, 1, 0, 0.7},
    {"gain 1.4, T_L found", NOTHING, 1, 0, 1.4},
    {"gain 1.4, T_L fixed at 40", NOTHING, 1, 40, 1.4},
};
enum { CHANGES = sizeof changes / sizeof *changes };

static sv_ref_cost_layout changed_layout(uint32_t n, int i) {
    sv_ref_cost_layout l = sv_ref_cost_layout_of(n, n, n, 0.0f);
    double *const parts[] = {
        [CUT] = &l.cut_cost, [OCCLUDER] = &l.occluder_cost,        [WRONG_FLUID] = &l.wrong_fluid_cost,
        [THICK] = &l.thick,  [BEHIND] = &l.behind_penalty,         [TAU] = &l.tau,
        [SIGMA] = &l.sigma,  [AVERAGE_MARGIN] = &l.average_margin, [SHIFT] = &l.viewer_shift};
    switch (changes[i].part) {
    case NOTHING:
        break;
    case SPLIT:
        l.bone_splits = false;
        break;
    case CONTACT:
        l.sizes.contact = l.sizes.labels;
        break;
    case MEDIAN:
        l.median = false;
        break;
    default:
        *parts[changes[i].part] *= changes[i].factor;
    }
    l.level = changes[i].level;
    return l;
}

/* Grey levels times `gain`; what was scanned stays scanned. */
static void amplify(const uint8_t *from, size_t count, double gain, uint8_t *to) {
    for (size_t i = 0; i < count; i++) {
        const double value = from[i] * gain + 0.5;
        to[i] = from[i] == 0 ? 0 : value < 1.0 ? 1 : value > 255.0 ? 255 : (uint8_t)value;
    }
}

static bool score(const surf_case *c, int i, uint8_t *voxels, double *maps, float *depth, surf_score *out,
                  hs_error *err) {
    const size_t pixels = (size_t)c->n * c->n;
    const sv_ref_cost_layout l = changed_layout(c->n, i);
    amplify(c->voxels, pixels * c->n, changes[i].gain > 0.0 ? changes[i].gain : 1.0, voxels);
    const sv_ref_volume v = {voxels, c->n, c->n, c->n, 0, NULL};
    if (!sv_ref_cost_surface_with(&v, &l, maps, maps + pixels, maps + 2 * pixels, NULL, NULL))
        return hs_fail(err, HS_ERR_MEMORY, "no memory for the cost volume");
    for (size_t p = 0; p < pixels; p++) depth[p] = (float)(0.5 * (maps[p] + maps[pixels + p]));
    *out = surf_judge(c, depth);
    return true;
}

bool surf_ablation(const char *const *names, uint32_t count, uint32_t n, hs_error *err) {
    static const uint32_t sets[2][2] = {{101, 0}, {402, 31}}; /* seed, pose */
    surf_score sums[2][CHANGES] = {{{0}}};
    const size_t pixels = (size_t)n * n;
    uint8_t *voxels = malloc(pixels * n);
    double *maps = malloc(3 * pixels * sizeof *maps);
    float *depth = malloc(pixels * sizeof *depth);
    bool ok = (voxels && maps && depth) || hs_fail(err, HS_ERR_MEMORY, "no memory for %u^3 voxels", n);
    for (int set = 0; set < 2; set++)
        for (uint32_t k = 0; ok && k < count; k++) {
            surf_case c;
            ok = surf_case_make(names[k], n, sets[set][0], sets[set][1], 0, &c, err);
            for (int i = 0; ok && i < CHANGES; i++) {
                surf_score s = {0};
                ok = score(&c, i, voxels, maps, depth, &s, err);
                sums[set][i].error += s.error / count;
                sums[set][i].cut += s.cut / count;
            }
            if (ok) surf_case_free(&c);
        }
    if (ok) printf("One thing changed at a time (scalar definition): tuned set 101/0, untuned set 402/31\n");
    for (int i = 0; ok && i < CHANGES; i++)
        printf("  %-36s %5.2f (cut %4.1f %%)   %5.2f (cut %4.1f %%)\n", changes[i].what, sums[0][i].error,
               100.0 * sums[0][i].cut, sums[1][i].error, 100.0 * sums[1][i].cut);
    free(depth);
    free(maps);
    free(voxels);
    return ok;
}
