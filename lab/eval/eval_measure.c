/* SPDX-License-Identifier: MIT */
#include "eval/eval_case.h"

#include "base/threads.h"
#include "loop/loop_run.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------- table -- */

#define HS_EVAL_MAX_STEPS 32767u /* errors are 16 bit */
/* Steps: errors beyond it count as "cut" and "left" (docs/evaluation.md). */
#define HS_EVAL_TOLERANCE 2

#define HARD_CUT_MARGIN 1e-3f /* steps; as in cl/dvr.cl */

uint32_t hs_eval_start_step(const hs_eval_table *table, float depth) {
    if (!(depth > 0.0f && depth < INFINITY)) return 0;
    const float first = (depth + 0.5f) * table->steps_per_slice - 0.5f - HARD_CUT_MARGIN;
    if (first >= (float)table->steps) return table->steps;
    return first > 0.0f ? (uint32_t)ceilf(first) : 0;
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

/* Pixels of labels 1 and 2, in that order. */
static void list_rays(hs_eval_table *t) {
    const uint32_t pixels = t->width * t->height;
    for (int label = HS_LABEL_SAC; label <= HS_LABEL_FETUS; label++) {
        if (label == HS_LABEL_FETUS) t->first_fetus = t->count;
        for (uint32_t i = 0; i < pixels; i++)
            if (t->label[i] == label) t->pixel[t->count++] = i;
    }
}

/* Column `step` of the errors from a picture whose rays start there. */
static void store_column(hs_eval_table *t, uint32_t step, const float *termination) {
    const size_t row = (size_t)t->steps + 1;
    for (uint32_t r = 0; r < t->count; r++)
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
    t->is_occluded = calloc((size_t)t->count + 1, 1);
    t->error = calloc((size_t)t->count + 1, row * sizeof *t->error);
    return (t->is_occluded && t->error) ||
           hs_fail(err, HS_ERR_MEMORY, "evaluation: no memory for %u rays of %u steps", t->count, t->steps);
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
                   "%s: its label map has no ray of the sac or the fetus: there is nothing to "
                   "evaluate",
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

#define BLOCKS      16u
#define MIN_LOOKUPS 8192u /* fewer are done before a second thread has started */

const char *hs_measure_key(hs_measure measure) {
    static const char *const keys[HS_MEASURE_COUNT] = {
        "e_abs",       "e_pos",       "e_neg",       "e_abs_sac", "e_pos_sac",    "e_neg_sac",
        "e_abs_fetus", "e_pos_fetus", "e_neg_fetus", "fetus_cut", "occluder_left"};
    return keys[measure];
}

/* What the rays of one label come to, for every map of a line. */
typedef struct {
    uint32_t positive[HS_EVAL_MAX_LINE], negative[HS_EVAL_MAX_LINE];         /* rays */
    uint64_t positive_sum[HS_EVAL_MAX_LINE], negative_sum[HS_EVAL_MAX_LINE]; /* steps */
    uint32_t cut[HS_EVAL_MAX_LINE], left[HS_EVAL_MAX_LINE];                  /* rays beyond the tolerance */
} tally;

typedef struct {
    const hs_eval_table *table;
    const float *zero, *one, *weight;
    uint32_t count, blocks;
    tally of[BLOCKS][2]; /* by block; sac, fetus */
} job;

static void count_error(tally *t, uint32_t i, int32_t e, uint32_t is_occluded) {
    const uint32_t too_early = e > 0 ? (uint32_t)e : 0u, too_late = e < 0 ? (uint32_t)-e : 0u;
    t->positive[i] += too_early != 0;
    t->negative[i] += too_late != 0;
    t->positive_sum[i] += too_early;
    t->negative_sum[i] += too_late;
    t->cut[i] += too_late > HS_EVAL_TOLERANCE;
    t->left[i] += is_occluded & (too_early > HS_EVAL_TOLERANCE);
}

static void count_block(void *context, uint32_t block) {
    job *j = context;
    const hs_eval_table *t = j->table;
    const uint32_t first = (uint32_t)((uint64_t)t->count * block / j->blocks);
    const uint32_t end = (uint32_t)((uint64_t)t->count * (block + 1) / j->blocks);
    for (uint32_t r = first; r < end; r++) {
        const int16_t *row = t->error + (size_t)r * (t->steps + 1);
        const float zero = j->zero ? j->zero[t->pixel[r]] : 0.0f;
        const float slope = j->zero ? j->one[t->pixel[r]] - zero : 0.0f;
        const uint32_t is_occluded = t->is_occluded[r];
        tally *of = &j->of[block][r >= t->first_fetus];
        for (uint32_t i = 0; i < j->count; i++)
            count_error(of, i, row[hs_eval_start_step(t, zero + j->weight[i] * slope)], is_occluded);
    }
}

static float mean(uint64_t sum, uint32_t rays, float none) {
    return rays ? (float)((double)sum / rays) : none;
}

/* The three means of `rays` rays. */
static void put_means(float *out, const tally *t, uint32_t i, uint32_t rays) {
    out[0] = mean(t->positive_sum[i] + t->negative_sum[i], rays, NAN);
    out[1] = mean(t->positive_sum[i], t->positive[i], rays ? 0.0f : NAN);
    out[2] = mean(t->negative_sum[i], t->negative[i], rays ? 0.0f : NAN);
}

static void add(tally *to, const tally *t, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        to->positive[i] += t->positive[i];
        to->negative[i] += t->negative[i];
        to->positive_sum[i] += t->positive_sum[i];
        to->negative_sum[i] += t->negative_sum[i];
        to->cut[i] += t->cut[i];
        to->left[i] += t->left[i];
    }
}

static void finish(const hs_eval_table *table, const tally *sac, const tally *fetus, uint32_t count,
                   hs_measures *out) {
    const uint32_t fetus_rays = table->count - table->first_fetus;
    tally both = *sac;
    add(&both, fetus, count);
    for (uint32_t i = 0; i < count; i++) {
        put_means(&out[i].of[HS_MEASURE_ABS], &both, i, table->count);
        put_means(&out[i].of[HS_MEASURE_ABS_SAC], sac, i, table->first_fetus);
        put_means(&out[i].of[HS_MEASURE_ABS_FETUS], fetus, i, fetus_rays);
        out[i].of[HS_MEASURE_FETUS_CUT] = mean(fetus->cut[i], fetus_rays, NAN);
        out[i].of[HS_MEASURE_OCCLUDER_LEFT] = mean(both.left[i], table->occluded, NAN);
    }
}

void hs_eval_measure_line(const hs_eval_table *table, const float *zero, const float *one,
                          const float *weight, uint32_t count, uint32_t threads, hs_measures *out) {
    assert(count >= 1 && count <= HS_EVAL_MAX_LINE);
    job j = {.table = table, .zero = zero, .one = one, .weight = weight, .count = count, .blocks = BLOCKS};
    const bool small = (uint64_t)table->count * count < MIN_LOOKUPS;
    hs_parallel(small ? 1 : hs_thread_count(threads), BLOCKS, count_block, &j);
    for (uint32_t b = 1; b < BLOCKS; b++)
        for (int label = 0; label < 2; label++) add(&j.of[0][label], &j.of[b][label], count);
    finish(table, &j.of[0][0], &j.of[0][1], count, out);
}

void hs_eval_measure_map(const hs_eval_table *table, const float *map, hs_measures *out) {
    const float weight = 0.0f;
    hs_eval_measure_line(table, map, map, &weight, 1, 1, out);
}

void hs_eval_error_picture(const hs_eval_table *table, const float *termination, float *out) {
    const uint32_t pixels = table->width * table->height;
    for (uint32_t i = 0; i < pixels; i++)
        out[i] = table->label[i] == HS_LABEL_NEITHER ? NAN : table->truth[i] - termination[i];
}

void hs_eval_measure_picture(const hs_eval_table *table, const float *termination, hs_measures *out) {
    tally by_label[2] = {0};
    const uint32_t pixels = table->width * table->height;
    for (uint32_t i = 0; i < pixels; i++) {
        if (table->label[i] == HS_LABEL_NEITHER) continue;
        const uint32_t occluded = table->truth[i] - table->full[i] > HS_EVAL_TOLERANCE;
        count_error(&by_label[table->label[i] == HS_LABEL_FETUS], 0,
                    (int32_t)lrintf(table->truth[i] - termination[i]), occluded);
    }
    finish(table, &by_label[0], &by_label[1], 1, out);
}

void hs_eval_look_up(const hs_eval_table *table, const float *map, float *termination) {
    memcpy(termination, table->truth, (size_t)table->width * table->height * sizeof *termination);
    for (uint32_t r = 0; r < table->count; r++) {
        const uint32_t i = table->pixel[r];
        const int16_t *row = table->error + (size_t)r * (table->steps + 1);
        termination[i] = table->truth[i] - (float)row[hs_eval_start_step(table, map ? map[i] : 0.0f)];
    }
}
