/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---------------------------------------------------------------------------------------------- a case -- */
/* How good a surface is by the report's measures, for which every labelled ray is hidden, and whether the
 * confidence tells. */

float wall_ray_end(const wall_case *c, const uint8_t *voxels, size_t pixel, float depth) {
    return hs_eval_ray_end(voxels, (size_t)c->nx * c->ny, c->nz, pixel,
                           hs_eval_start_step(depth, 1.0f, c->nz));
}

/* Whether a ray of the fetus is clipped more than 2 mm out of its admissible depths. */
static void judge_interval(const wall_case *c, size_t i, float depth, uint64_t *deep, uint64_t *shallow) {
    const float tolerance = (float)(SITE_TOLERANCE / c->spacing_mm[2]);
    *deep += depth > c->far[i] + tolerance;
    *shallow += depth < c->near[i] - tolerance;
}

double site_scan_off(const scan_ray *ray, double depth) {
    const double at = fmin(fmax(depth, ray->low), ray->high);
    return fmax(ray->near - at, 0.0) - fmax(at - ray->far, 0.0);
}

void site_count(site_sum *sum, double off, bool of_fetus) {
    sum->rays++;
    sum->fetus += of_fetus;
    sum->error += fabs(off);
    sum->cut += of_fetus && off < -SITE_TOLERANCE;
    sum->left += off > SITE_TOLERANCE;
}

static double known(float measure) {
    return isnan(measure) ? 0.0 : (double)measure;
}

wall_score wall_judge(const wall_case *c, const uint8_t *original, const float *depth,
                      const float *confidence, wall_calibration *calibration) {
    const float scale = 128.0f / (float)c->nz;
    const uint32_t tolerance = (uint32_t)((float)SITE_TOLERANCE / scale);
    hs_eval_tally by_label[HS_EVAL_LABELS] = {{0}};
    hs_measures m;
    uint64_t deep = 0, shallow = 0;
    double rays = 0.0, confident = 0.0;
    for (size_t i = 0; i < (size_t)c->nx * c->ny; i++) {
        if (c->label[i] == HS_LABEL_NEITHER) continue;
        const int32_t e = (int32_t)(c->truth[i] - wall_ray_end(c, original, i, depth[i]));
        const int bin = (int)(confidence[i] * (WALL_BINS - 1) + 0.5f);
        hs_eval_count(&by_label[c->label[i]], e, true, tolerance);
        if (c->label[i] == HS_LABEL_FETUS && c->far) judge_interval(c, i, depth[i], &deep, &shallow);
        const bool wrong = (uint32_t)abs(e) > tolerance;
        rays += 1.0;
        confident += (double)confidence[i];
        calibration->right[bin] += !wrong;
        calibration->wrong[bin] += wrong;
        calibration->cut[bin] += wrong && e < 0;
    }
    hs_eval_measures(by_label, &m);
    const double fetus = by_label[HS_LABEL_FETUS].rays ? by_label[HS_LABEL_FETUS].rays : 1.0;
    return (wall_score){.error = (double)scale * known(m.of[HS_MEASURE_ABS]),
                        .cut = known(m.of[HS_MEASURE_FETUS_CUT]),
                        .left = known(m.of[HS_MEASURE_OCCLUDER_LEFT]),
                        .fetus = (double)scale * known(m.of[HS_MEASURE_ABS_FETUS]),
                        .deep = c->far ? (double)deep / fetus : NAN,
                        .shallow = c->far ? (double)shallow / fetus : NAN,
                        .confidence = confident / fmax(rays, 1.0)};
}

void wall_calibration_add(wall_calibration *to, const wall_calibration *from) {
    for (int i = 0; i < WALL_BINS; i++) {
        to->right[i] += from->right[i];
        to->wrong[i] += from->wrong[i];
        to->cut[i] += from->cut[i];
    }
}

double wall_auc(const wall_calibration *t, wall_fault fault) {
    double right = 0.0, wrong = 0.0, pairs = 0.0;
    for (int i = 0; i < WALL_BINS; i++) { /* rays of less confidence have been counted */
        const uint64_t cut = t->cut[i], all = t->wrong[i];
        const double here = (double)(fault == WALL_CUT ? cut : fault == WALL_LEFT ? all - cut : all);
        pairs += (double)t->right[i] * (wrong + 0.5 * here);
        right += (double)t->right[i];
        wrong += here;
    }
    return right > 0.0 && wrong > 0.0 ? pairs / (right * wrong) : 1.0;
}

/* Share of right rays among those of confidence low .. high, and the mean confidence there. Returns how many
 * there are. */
static uint64_t wall_reliability(const wall_calibration *t, double low, double high, double *right,
                                 double *mean) {
    uint64_t good = 0, all = 0;
    double sum = 0.0;
    for (int i = 0; i < WALL_BINS; i++) {
        const double confidence = (double)i / (WALL_BINS - 1);
        if (confidence < low || confidence >= high) continue;
        good += t->right[i];
        all += t->right[i] + t->wrong[i];
        sum += confidence * (double)(t->right[i] + t->wrong[i]);
    }
    *right = (double)good / (double)all;
    *mean = sum / (double)all;
    return all;
}

/* ---------------------------------------------------------------------------------------------- a site -- */

enum { TENTHS = 10, LEAST_RAYS = 100 };
static const double much_cut = 0.1, harm_cut = 0.02;

void site_score_add(site_score *to, const char *name, const wall_score *score) {
    to->sum.error += score->error;
    to->sum.cut += score->cut;
    to->sum.left += score->left;
    to->sum.fetus += score->fetus;
    to->sum.deep += score->deep;
    to->sum.shallow += score->shallow;
    to->sum.confidence += score->confidence;
    if (to->count == 0 || score->error > to->worst) {
        to->worst = score->error;
        (void)snprintf(to->worst_name, sizeof to->worst_name, "%s", name);
    }
    to->worst_cut = fmax(to->worst_cut, score->cut);
    to->harmed += score->cut > harm_cut;
    if (score->cut > much_cut && score->confidence > to->surest) {
        to->surest = score->confidence;
        (void)snprintf(to->surest_name, sizeof to->surest_name, "%s", name);
    }
    to->count++;
}

void site_score_print_surest(const site_score *s) {
    if (s->surest > 0.0) printf("  cut above 10 %%: confidence %.2f %s", s->surest, s->surest_name);
}

wall_score site_score_mean(const site_score *s) {
    const double n = s->count ? s->count : 1.0;
    return (wall_score){s->sum.error / n, s->sum.cut / n,     s->sum.left / n,      s->sum.fetus / n,
                        s->sum.deep / n,  s->sum.shallow / n, s->sum.confidence / n};
}

void site_score_print(const site_score *s, bool sure) {
    const wall_score m = site_score_mean(s);
    printf("%5.2f / %5.2f / %5.2f  worst %5.2f %-4s", m.error, 100.0 * m.cut, 100.0 * m.left, s->worst,
           s->worst_name);
    if (sure)
        printf("  AUC %.3f (cut %.3f, left %.3f)", wall_auc(&s->calibration, WALL_WRONG),
               wall_auc(&s->calibration, WALL_CUT), wall_auc(&s->calibration, WALL_LEFT));
    else
        printf("  no confidence");
    if (sure) site_score_print_surest(s);
    if (s->refused) printf("  %u refused", s->refused);
    printf("\n");
}

void site_score_print_fetus(const site_score *s) {
    const wall_score m = site_score_mean(s);
    printf("       the fetus' rays: error %.2f", m.fetus);
    if (!isnan(m.deep))
        printf("; by the admissible depths %.1f %% cut, %.1f %% left", 100.0 * m.deep, 100.0 * m.shallow);
    printf("\n");
}

void site_score_print_calibration(const char *what, const wall_calibration *t) {
    double right, mean;
    const double rays = (double)wall_reliability(t, 0.0, 1.1, &right, &mean);
    printf("  %s: it says / right / share of the rays, %%\n   ", what);
    for (int i = 0; i < TENTHS; i++) {
        const double low = 0.1 * i, high = i == TENTHS - 1 ? 1.1 : 0.1 * (i + 1);
        const uint64_t here = wall_reliability(t, low, high, &right, &mean);
        if (here >= LEAST_RAYS) printf(" %.2f/%.2f/%.0f", mean, right, 100.0 * (double)here / rays);
    }
    printf("\n");
}
