/* SPDX-License-Identifier: MIT */
#include "eval/eval_best.h"

#include <math.h>
#include <stdlib.h>

const hs_measures *hs_eval_at(const hs_eval_space *space, hs_eval_pick pick) {
    const hs_eval_plan *plan = space->plan;
    const size_t item = (size_t)pick.threshold * plan->kernel.count + pick.kernel;
    return &space->at[item * plan->knob.count + pick.knob];
}

hs_eval_pick hs_eval_best_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel) {
    hs_eval_pick best = {threshold, kernel, 0}, pick = best;
    for (pick.knob = 1; pick.knob < space->plan->knob.count; pick.knob++)
        if (hs_eval_at(space, pick)->of[HS_MEASURE_ABS] < hs_eval_at(space, best)->of[HS_MEASURE_ABS])
            best = pick;
    return best;
}

hs_eval_pick hs_eval_best(const hs_eval_space *space) {
    hs_eval_pick best = {0, 0, 0};
    for (uint32_t t = 0; t < space->plan->threshold.count; t++) {
        for (uint32_t k = 0; k < space->plan->kernel.count; k++) {
            const hs_eval_pick pick = hs_eval_best_knob(space, t, k);
            if (hs_eval_at(space, pick)->of[HS_MEASURE_ABS] < hs_eval_at(space, best)->of[HS_MEASURE_ABS])
                best = pick;
        }
    }
    return best;
}

double hs_eval_delta(const hs_eval_space *space, uint32_t threshold) {
    const hs_eval_axis *axis = &space->plan->threshold;
    return axis->exists ? space->volume_max - axis->value[threshold] : NAN;
}

bool hs_eval_threshold_at(const hs_eval_space *space, double delta, uint32_t *out) {
    const hs_eval_axis *axis = &space->plan->threshold;
    *out = 0;
    if (!axis->exists) return true;
    const double position = (space->volume_max - delta - axis->value[0]) / axis->step;
    const double nearest = floor(position + 0.5);
    if (nearest < 0 || nearest >= axis->count) return false;
    *out = (uint32_t)nearest;
    return true;
}

/* The values of Delta_MI from 0 on that every case has. */
static void find_deltas(hs_eval_mean *mean, const hs_eval_space *spaces, uint32_t count) {
    const hs_eval_axis *axis = &spaces[0].plan->threshold;
    for (uint32_t i = 0; i < HS_EVAL_MAX_LINE; i++) {
        const double delta = i * axis->step;
        uint32_t position, with = 0;
        while (with < count && hs_eval_threshold_at(&spaces[with], delta, &position)) with++;
        if (with == count) mean->delta[mean->deltas++] = axis->exists ? round(delta * 1e6) / 1e6 : NAN;
        if (!axis->exists) return;
    }
}

static float average(const hs_eval_space *spaces, uint32_t count, double delta, uint32_t kernel,
                     uint32_t knob) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        hs_eval_pick pick = {0, kernel, knob};
        (void)hs_eval_threshold_at(&spaces[i], delta, &pick.threshold);
        sum += (double)hs_eval_at(&spaces[i], pick)->of[HS_MEASURE_ABS];
    }
    return (float)(sum / count);
}

bool hs_eval_mean_make(hs_eval_mean *mean, const hs_eval_space *spaces, uint32_t count, hs_error *err) {
    *mean = (hs_eval_mean){.kernels = spaces[0].plan->kernel.count, .knobs = spaces[0].plan->knob.count};
    find_deltas(mean, spaces, count);
    const size_t results = (size_t)mean->deltas * mean->kernels * mean->knobs;
    mean->e_abs = calloc(results + 1, sizeof *mean->e_abs);
    if (!mean->e_abs) return hs_fail(err, HS_ERR_MEMORY, "averages: no memory for %zu settings", results);
    size_t best = 0;
    for (size_t i = 0; i < results; i++) {
        const uint32_t knob = (uint32_t)(i % mean->knobs), rest = (uint32_t)(i / mean->knobs);
        mean->e_abs[i] =
            average(spaces, count, mean->delta[rest / mean->kernels], rest % mean->kernels, knob);
        if (mean->e_abs[i] < mean->e_abs[best]) best = i;
    }
    mean->best_knob = (uint32_t)(best % mean->knobs);
    mean->best_kernel = (uint32_t)(best / mean->knobs % mean->kernels);
    mean->best = (uint32_t)(best / mean->knobs / mean->kernels);
    return true;
}

void hs_eval_mean_free(hs_eval_mean *mean) {
    free(mean->e_abs);
    *mean = (hs_eval_mean){0};
}
