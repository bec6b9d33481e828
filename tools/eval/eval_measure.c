/* SPDX-License-Identifier: MIT */
#include "eval/eval_measure.h"

#include "base/threads.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define BLOCKS        16u
#define LEAST_LOOKUPS 8192u /* fewer are done before a second thread has started */

const char *hs_measure_key(hs_measure measure) {
    static const char *const keys[HS_MEASURE_COUNT] = {
        "e_abs",       "e_pos",       "e_neg",       "e_abs_sac", "e_pos_sac",    "e_neg_sac",
        "e_abs_fetus", "e_pos_fetus", "e_neg_fetus", "fetus_cut", "occluder_left"};
    return keys[measure];
}

/* Of the rays of one label, for every map of a line. */
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
    const bool small = (uint64_t)table->count * count < LEAST_LOOKUPS;
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
