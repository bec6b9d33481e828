/* SPDX-License-Identifier: MIT */
#include "support/compare.h"

#include <math.h>

/* Slices by which the fixed-point filter may differ from the float64 definition after `passes` passes. */
static double bound_of(const sv_ref_volume *volume, const rig_settings *s, sv_fixed format, uint32_t passes) {
    const double depth =
        volume->slices - 1.0; /* no interval end lies deeper, and a mean never leaves its inputs */
    const double fixed_step = ldexp(0.5, -(int)format.fraction);
    /* A mean is a convex combination: it passes errors on, but never enlarges them, so each pass
     * adds its own. That is half a fixed-point step for the rounding to one, and float32's rounding
     * of sum and quotient. Thirds of a slice cost another half step at the start, and so do
     * quarters where a step is coarser. */
    const bool rounded = s->substeps == 3 || (s->substeps == 4 && format.fraction < 2);
    const double surface = (passes + rounded) * fixed_step + passes * depth * ldexp(1.0, -23);
    const double q = (double)s->q;
    /* S_f (1 - q) + q S_n, and three roundings of float32 in the blend. */
    return surface * (fabs(1.0 - q) + q) + depth * (1.0 + 3.0 * q) * ldexp(1.0, -24);
}

static void fail_pixel(const char *where, const char *map, size_t i, uint32_t width, double got,
                       double expected) {
    fail_msg("%s: %s at (%zu, %zu) is %.9g, expected %.9g", where, map, i % width, i / width, got, expected);
}

static void compare_stats(const rig_result *result, const rig_expected *e, uint32_t count,
                          const char *where) {
    const sv_stats *got = &result->stats;
    const sv_points_report *points = &result->points;
    const struct {
        const char *name;
        double got, expected;
    } fields[] = {
        {"outcome", got->outcome, e->outcome},
        {"rays", got->rays, count},
        {"points", got->points, e->points},
        {"empty_points", points->empty_points, e->empty_points},
        {"passes", points->passes, e->fill.passes},
        {"unfilled", got->unfilled, e->fill.unfilled},
        {"volume_max", (double)points->volume_max, (double)((float)e->maximum / 255.0f)},
        {"bone_threshold", (double)points->bone_threshold, (double)((float)e->level / 255.0f)},
        {"sure_points", points->sure_points, e->sure_points},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (fields[i].got != fields[i].expected)
            fail_msg("%s: stats.%s is %g, expected %g", where, fields[i].name, fields[i].got,
                     fields[i].expected);
}

/* A delivered result against what is expected. `count` rays, `width` to a row. */
static void compare_maps(const rig_result *got, const rig_expected *e, uint32_t width, uint32_t count,
                         const char *where) {
    for (size_t i = 0; i < count; i++)
        if (got->status[i] != e->status[i])
            fail_pixel(where, "status", i, width, got->status[i], e->status[i]);
    for (size_t i = 0; i < count; i++)
        if (memcmp(&got->depth[i], &e->depth[i], sizeof(float)) != 0)
            fail_pixel(where, "depth", i, width, (double)got->depth[i], (double)e->depth[i]);
    compare_stats(got, e, count, where);
}

static compare_summary summary;

static void compare_double(const rig_result *got, const rig_expected *e, const sv_ref_volume *volume,
                           const rig_settings *s, const char *where) {
    const double bound = bound_of(volume, s, e->format, e->fill.passes);
    const size_t count = (size_t)volume->width * volume->height;
    for (size_t i = 0; i < count; i++) {
        const double error = fabs((double)got->depth[i] - e->depth_double[i]);
        if (!(error <= bound)) {
            (void)fprintf(stderr, "%u passes allow an error of %g\n", e->fill.passes, bound);
            fail_pixel(where, "depth (float64)", i, volume->width, (double)got->depth[i], e->depth_double[i]);
        }
        if (!(error <= COMPARE_PROMISE))
            fail_pixel(where, "depth (promise)", i, volume->width, (double)got->depth[i], e->depth_double[i]);
        if (error > summary.worst) summary.worst = error;
        if (bound > 0.0 && error / bound > summary.worst_share) summary.worst_share = error / bound;
    }
    if (e->fill.passes > summary.max_passes) summary.max_passes = e->fill.passes;
    summary.frames++;
}

void compare_frame(rig *r, const stage *t, const uint8_t *voxels, const rig_settings *s, const char *where) {
    char text[512];
    const void *mark = unit_mark();
    const sv_format *f = &t->format;
    const sv_ref_volume volume = {voxels,    f->width,         f->height,
                                  f->slices, f->padding_value, t->way.ranges ? t->ranges : NULL};
    (void)snprintf(
        text, sizeof text,
        "%s: %u x %u x %u, padding %d, carrier %u, %u slabs, tiles_x %u, T_L %.4f, bone mode %d, k %u, "
        "omega %.2f, substeps %u, q %.2f, drop %d, evidence %.3f, gap %.2f",
        where, f->width, f->height, f->slices, f->padding_value, f->carrier, t->slab_count, f->tiles_x,
        s->fluid_threshold, s->bone.bone_mode, s->k, s->omega, s->substeps, (double)s->q, s->bone.drop_empty,
        s->evidence, s->min_gap);
    const uint32_t count = f->width * f->height;
    sv_param_value values[RIG_MAX_VALUES];
    const uint32_t value_count = rig_values(r, s, values);
    const rig_expected expected = rig_expect(&volume, s, true);
    rig_result got = rig_result_make(f->width, f->height);
    memset(got.depth, 0xAB, count * sizeof *got.depth);
    memset(got.status, 0xAB, count);
    const sv_status status = rig_frame(r, t, values, value_count, &got);
    if (status != expected.outcome)
        fail_msg("%s: status is %d, expected %d; last log line: %s", text, status, expected.outcome,
                 r->last_log);
    compare_maps(&got, &expected, f->width, count, text);
    compare_double(&got, &expected, &volume, s, text);
    unit_return(mark);
}

void compare_run(rig *r, const rig_format *f, const uint8_t *volume, const rig_settings *s,
                 const char *where) {
    const void *mark = unit_mark();
    const stage *t = rig_stage(r, f, volume);
    const sv_status status = r->plugin->activate(r->plugin, &t->format);
    if (status != SV_OK) fail_msg("%s: activate is %d: %s", where, status, r->last_log);
    compare_frame(r, t, volume, s, where);
    r->plugin->deactivate(r->plugin);
    unit_return(mark);
}

compare_summary compare_print(const char *what) {
    const compare_summary s = summary;
    summary = (compare_summary){0};
    print_message("%s: %u frames bit-equal; against float64 at most %.2e slices (%.0f %% of the bound), "
                  "at most %u passes\n",
                  what, s.frames, s.worst, 100.0 * s.worst_share, s.max_passes);
    return s;
}
