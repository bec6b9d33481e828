/* SPDX-License-Identifier: MIT */
#include "eval/eval_case.h"

#include "loop/loop_run.h"
#include "render/dvr_settings.h"

#include <math.h>
#include <stdlib.h>
#include <zlib.h>

/* ----------------------------------------------------------------------------------------------- table -- */

#define HS_EVAL_MAX_STEPS 32767u /* errors are 16 bit */
/* Steps: errors beyond it count as "cut" and "left" (docs/evaluation.md). */
#define HS_EVAL_TOLERANCE 2

#define HARD_CUT_MARGIN 1e-3f /* steps; as in cl/dvr.cl */

uint32_t hs_eval_start_step(float depth, float steps_per_slice, uint32_t steps) {
    if (!(depth > 0.0f && depth < INFINITY)) return 0;
    const float first = (depth + 0.5f) * steps_per_slice - 0.5f - HARD_CUT_MARGIN;
    if (first >= (float)steps) return steps;
    return first > 0.0f ? (uint32_t)ceilf(first) : 0;
}

/* The row of errors of ray r, and the error when it starts at a depth. */
static int16_t error_at(const hs_eval_table *t, uint32_t r, float depth) {
    return t->error[(size_t)r * (t->steps + 1) + hs_eval_start_step(depth, t->steps_per_slice, t->steps)];
}

/* The label of the source column in which each pixel's centre lies. */
static void sample_labels(hs_eval_table *t, const hs_volume *full, const uint8_t *label,
                          const hs_camera *camera) {
    hs_box_map map;
    hs_camera_box_map(camera, full, &map);
    for (uint32_t y = 0; y < t->height; y++) {
        for (uint32_t x = 0; x < t->width; x++) {
            const double u = (x + 0.5) / t->width, v = (y + 0.5) / t->height;
            const double sx = floor(map.origin[0] + u * map.du[0] + v * map.dv[0] + 0.5 + 1e-6);
            const double sy = floor(map.origin[1] + u * map.du[1] + v * map.dv[1] + 0.5 + 1e-6);
            const bool inside = sx >= 0 && sy >= 0 && sx < full->nx && sy < full->ny;
            t->label[(size_t)y * t->width + x] =
                inside ? label[(size_t)sy * full->nx + (size_t)sx] : HS_LABEL_NEITHER;
        }
    }
}

/* Adds the pixels of a label. */
static void list_label(hs_eval_table *t, uint8_t label) {
    for (uint32_t i = 0; i < t->width * t->height; i++)
        if (t->label[i] == label) t->pixel[t->all++] = i;
}

static void list_rays(hs_eval_table *t) {
    list_label(t, HS_LABEL_SAC);
    t->first_fetus = t->all;
    list_label(t, HS_LABEL_FETUS);
    t->count = t->all;
    list_label(t, HS_LABEL_NEITHER);
}

/* Column `step` of the errors from a picture whose rays start there. */
static void store_column(hs_eval_table *t, uint32_t step, const float *termination) {
    const size_t row = (size_t)t->steps + 1;
    for (uint32_t r = 0; r < t->all; r++)
        t->error[r * row + step] = (int16_t)lrintf(t->truth[t->pixel[r]] - termination[t->pixel[r]]);
}

static void mark_occluded(hs_eval_table *t) {
    const size_t row = (size_t)t->steps + 1;
    for (uint32_t r = 0; r < t->count; r++) {
        t->is_occluded[r] = t->error[r * row] > HS_EVAL_TOLERANCE;
        t->occluded += t->is_occluded[r];
    }
}

/* Starting at step 0 is the full volume; at `steps` nothing is left to draw. */
static bool fill(hs_eval_table *t, hs_loop *loop, float *picture, hs_error *err) {
    const size_t pixels = (size_t)t->width * t->height;
    if (!hs_loop_ray_ends(loop, 0, NULL, t->full, err)) return false;
    store_column(t, 0, t->full);
    for (uint32_t step = 1; step < t->steps; step++) {
        if (!hs_loop_ray_ends_from(loop, 0, step, picture, err)) return false;
        store_column(t, step, picture);
    }
    for (size_t i = 0; i < pixels; i++) picture[i] = (float)t->steps;
    store_column(t, t->steps, picture);
    mark_occluded(t);
    return true;
}

static bool allocate_maps(hs_eval_table *t, hs_error *err) {
    const size_t pixels = (size_t)t->width * t->height;
    t->label = calloc(pixels, 1);
    t->truth = calloc(pixels, sizeof *t->truth);
    t->full = calloc(pixels, sizeof *t->full);
    t->pixel = calloc(pixels, sizeof *t->pixel);
    return (t->label && t->truth && t->full && t->pixel) ||
           hs_fail(err, HS_ERR_MEMORY, "evaluation: no memory for %zu pixels", pixels);
}

static bool allocate_rows(hs_eval_table *t, hs_error *err) {
    const size_t row = (size_t)t->steps + 1;
    t->is_occluded = calloc((size_t)t->all + 1, 1);
    t->error = calloc((size_t)t->all + 1, row * sizeof *t->error);
    return (t->is_occluded && t->error) ||
           hs_fail(err, HS_ERR_MEMORY, "evaluation: no memory for %u rays of %u steps", t->all, t->steps);
}

static bool check_loop(const hs_loop *loop, uint32_t steps, hs_error *err) {
    const hs_dvr_settings *dvr = &hs_loop_get_options(loop)->dvr;
    const hs_slab_layout *layout = hs_loop_layout(loop);
    if (dvr->width != layout->width || dvr->height != layout->height || dvr->step != 1.0f ||
        dvr->ghost_width != 0.0f || dvr->ghost_offset != 0.0f)
        return hs_fail(err, HS_ERR_USAGE,
                       "evaluation: picture %u x %u, step %g, ghost %g + %g; expected the map's %u x %u, "
                       "step 1, no ghost",
                       dvr->width, dvr->height, (double)dvr->step, (double)dvr->ghost_offset,
                       (double)dvr->ghost_width, layout->width, layout->height);
    if (steps > HS_EVAL_MAX_STEPS)
        return hs_fail(err, HS_ERR_USAGE, "evaluation: %u DVR steps, allowed are 1 .. %u", steps,
                       HS_EVAL_MAX_STEPS);
    return true;
}

/* The rays to look at, by the labels that frame 0's camera sees. */
static bool find_rays(hs_eval_table *t, const hs_loop *loop, const hs_volume *full, const uint8_t *label,
                      hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, 0, &camera);
    sample_labels(t, full, label, &camera);
    list_rays(t);
    return t->count > 0 ||
           hs_fail(err, HS_ERR_INPUT,
                   "%s: its label map has no ray of the sac or the fetus: there is nothing to evaluate",
                   full->name);
}

bool hs_eval_table_build(hs_eval_table *table, hs_loop *loop, const hs_volume *full, const hs_volume *truth,
                         const uint8_t *label, hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    const uint32_t steps = hs_loop_ray_steps(loop, 0);
    *table = (hs_eval_table){.width = layout->width,
                             .height = layout->height,
                             .steps = steps,
                             .steps_per_slice = (float)((double)steps / layout->slices)};
    if (!check_loop(loop, steps, err)) return false;
    float *picture = calloc((size_t)layout->width * layout->height, sizeof *picture);
    bool ok = picture || hs_fail(err, HS_ERR_MEMORY, "evaluation: no memory for a picture");
    ok = ok && allocate_maps(table, err) && hs_loop_ray_ends_in(loop, 0, truth, table->truth, err) &&
         find_rays(table, loop, full, label, err) && allocate_rows(table, err) &&
         fill(table, loop, picture, err);
    free(picture);
    if (!ok) hs_eval_table_free(table);
    return ok;
}

void hs_eval_table_free(hs_eval_table *table) {
    free(table->label);
    free(table->truth);
    free(table->full);
    free(table->pixel);
    free(table->is_occluded);
    free(table->error);
    *table = (hs_eval_table){0};
}

/* -------------------------------------------------------------------------------------------- measures -- */

const char *hs_measure_key(hs_measure measure) {
    static const char *const keys[HS_MEASURE_COUNT] = {
        "e_abs",       "e_pos",       "e_neg",       "e_abs_sac", "e_pos_sac",     "e_neg_sac",
        "e_abs_fetus", "e_pos_fetus", "e_neg_fetus", "fetus_cut", "occluder_left", "e_abs_outside"};
    return keys[measure];
}

/* What the rays of one label counted so far come to. Zeroed: none. */
typedef struct {
    uint32_t rays, positive, negative;   /* e > 0, e < 0 */
    uint64_t positive_sum, negative_sum; /* steps */
    uint32_t cut, occluded, left;        /* beyond the tolerance */
} tally;

#define LABELS 3

static void count(tally *t, int32_t e, bool occluded) {
    const uint32_t too_early = e > 0 ? (uint32_t)e : 0u, too_late = e < 0 ? (uint32_t)-e : 0u;
    t->rays++;
    t->positive += too_early != 0;
    t->negative += too_late != 0;
    t->positive_sum += too_early;
    t->negative_sum += too_late;
    t->cut += too_late > HS_EVAL_TOLERANCE;
    t->occluded += occluded;
    t->left += occluded & (too_early > HS_EVAL_TOLERANCE);
}

static float mean(uint64_t sum, uint32_t rays, float none) {
    return rays ? (float)((double)sum / rays) : none;
}

static float mean_error(const tally *t) {
    return mean(t->positive_sum + t->negative_sum, t->rays, NAN);
}

/* The three means of a tally. */
static void put_means(float *out, const tally *t) {
    out[0] = mean_error(t);
    out[1] = mean(t->positive_sum, t->positive, t->rays ? 0.0f : NAN);
    out[2] = mean(t->negative_sum, t->negative, t->rays ? 0.0f : NAN);
}

static void add(tally *to, const tally *t) {
    to->rays += t->rays;
    to->positive += t->positive;
    to->negative += t->negative;
    to->positive_sum += t->positive_sum;
    to->negative_sum += t->negative_sum;
    to->cut += t->cut;
    to->occluded += t->occluded;
    to->left += t->left;
}

/* Of tallies, one of each HS_LABEL_*. */
static void measures_of(const tally by_label[LABELS], hs_measures *out) {
    const tally *const fetus = &by_label[HS_LABEL_FETUS];
    tally both = by_label[HS_LABEL_SAC];
    add(&both, fetus);
    put_means(&out->of[HS_MEASURE_ABS], &both);
    put_means(&out->of[HS_MEASURE_ABS_SAC], &by_label[HS_LABEL_SAC]);
    put_means(&out->of[HS_MEASURE_ABS_FETUS], fetus);
    out->of[HS_MEASURE_FETUS_CUT] = mean(fetus->cut, fetus->rays, NAN);
    out->of[HS_MEASURE_OCCLUDER_LEFT] = mean(both.left, both.occluded, NAN);
    out->of[HS_MEASURE_ABS_OUTSIDE] = mean_error(&by_label[HS_LABEL_NEITHER]);
}

void hs_eval_measure_map(const hs_eval_table *t, const float *map, hs_measures *out) {
    tally by_label[LABELS] = {{0}};
    for (uint32_t r = 0; r < t->all; r++)
        count(&by_label[t->label[t->pixel[r]]], error_at(t, r, map ? map[t->pixel[r]] : 0.0f),
              t->is_occluded[r]);
    measures_of(by_label, out);
}

uint32_t hs_eval_map_crc(const hs_eval_table *table, const float *map) {
    const size_t bytes = (size_t)table->width * table->height * sizeof *map;
    return (uint32_t)crc32(0, (const Bytef *)map, (uInt)bytes);
}

void hs_eval_error_picture(const hs_eval_table *table, const float *termination, float *out) {
    const uint32_t pixels = table->width * table->height;
    for (uint32_t i = 0; i < pixels; i++)
        out[i] = table->label[i] == HS_LABEL_NEITHER ? NAN : table->truth[i] - termination[i];
}

void hs_eval_measure_picture(const hs_eval_table *table, const float *termination, hs_measures *out) {
    tally by_label[LABELS] = {{0}};
    const uint32_t pixels = table->width * table->height;
    for (uint32_t i = 0; i < pixels; i++)
        count(&by_label[table->label[i]], (int32_t)lrintf(table->truth[i] - termination[i]),
              table->truth[i] - table->full[i] > HS_EVAL_TOLERANCE);
    measures_of(by_label, out);
}
