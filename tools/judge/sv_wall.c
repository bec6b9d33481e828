/* SPDX-License-Identifier: MIT */
/* sv_wall: how good the definition of the wall's surface is (docs/surface.md). */
#include "judge/wall_constant.h"
#include "judge/wall_flicker.h"
#include "judge/wall_judge.h"
#include "judge/wall_tilt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: sv_wall [--KEY VALUE]... --site FOLDER | --case FILES... | --scenes SEED,POSE... |\n"
    "               --still SEED,POSE | --named NAME... | --views FILE...\n"
    "  --site FOLDER          the nine cases of a folder with NAME_full.mha, NAME_truth.mha, "
    "NAME_label.mha,\n"
    "                         scan_first.mha and scan_end.mha\n"
    "  --case FILES...        cases of FULL,TRUTH,LABEL[,FIRST,END], as host_sim report takes them\n"
    "  --scenes SEED,POSE...  the nine scenes at 128^3 for each seed and pose\n"
    "  --still SEED,POSE      the nine scenes standing still, other speckle and particles in each of 8 "
    "frames:\n"
    "                         how much the ends of rays move from frame to frame (sv_sites flicker: in "
    "motion)\n"
    "  --named NAME...        these scenes at 128^3: H01, or R7_3, number 3 of the random set with seed 7\n"
    "  --views FILE...        a volume with nothing to remove, from 12 x 3 sides: what is cut\n"
    "  --tilt X,Y             turn the camera by so many degrees about x and then y first (not views and "
    "still)\n"
    "  --gain G --gamma G --black B   change the grey levels first; the judgement is on the unchanged ones\n"
    "  --KEY VALUE            another value of a constant: a field of sv_wall_settings\n"
    "Prints error in slices of 128 / cut, % of the fetus / left, % of the labelled rays.\n";

static const char *const names[] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"};
enum { CASES = sizeof names / sizeof *names, SIDE = 96, STILL = 8 };

typedef struct {
    sv_wall_settings settings;
    double gain, gamma, black, tilt[2];
} options;

static bool set_tilt(options *o, const char *text, hs_error *err) {
    int length = 0;
    const bool read = sscanf(text, "%lf,%lf%n", &o->tilt[0], &o->tilt[1], &length) == 2 && text[length] == 0;
    return (read && fabs(o->tilt[0]) <= 45.0 && fabs(o->tilt[1]) <= 45.0) ||
           hs_fail(err, HS_ERR_USAGE, "--tilt: '%s' is no X,Y of -45 to 45 degrees", text);
}

static bool set(options *o, const char *key, const char *text, hs_error *err) {
    if (strcmp(key, "tilt") == 0) return set_tilt(o, text, err);
    double *const value = strcmp(key, "gain") == 0    ? &o->gain
                          : strcmp(key, "gamma") == 0 ? &o->gamma
                          : strcmp(key, "black") == 0 ? &o->black
                                                      : wall_constant(&o->settings, key);
    char *end;
    const double number = strtod(text, &end);
    if (strcmp(key, "median") == 0)
        o->settings.median = number != 0.0;
    else if (!value)
        return hs_fail(err, HS_ERR_USAGE, "--%s: no such option", key);
    else
        *value = number;
    return (end != text && *end == 0) || hs_fail(err, HS_ERR_USAGE, "--%s: '%s' is no number", key, text);
}

typedef struct {
    wall_score sum;
    double worst;
    uint32_t count;
    wall_calibration calibration;
} totals;

static bool surface_of(const wall_case *c, const options *o, float *depth, float *confidence,
                       sv_wall_outcome *outcome, sv_wall_facts *facts, hs_error *err) {
    const sv_wall_volume v = wall_case_volume(c);
    char text[160];
    if (!sv_wall_check(&v, text, sizeof text)) return hs_fail(err, HS_ERR_INPUT, "%s: %s", c->name, text);
    return sv_wall_surface(&v, &o->settings, depth, confidence, outcome, facts) ||
           hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
}

/* Judges one case, adds it to the totals and frees it. */
static bool judge(wall_case *c, const options *o, totals *t, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    if ((o->tilt[0] != 0.0 || o->tilt[1] != 0.0) && !wall_case_tilt(c, o->tilt, err)) {
        wall_case_free(c);
        return false;
    }
    float *depth = malloc(plane * sizeof *depth), *confidence = malloc(plane * sizeof *confidence);
    uint8_t *original = malloc(plane * c->nz);
    sv_wall_outcome outcome;
    sv_wall_facts f;
    bool ok = (depth && confidence && original) || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
    if (ok) {
        memcpy(original, c->full, plane * c->nz);
        if (o->gain != 1.0 || o->gamma != 1.0 || o->black != 0.0)
            wall_case_change(c, o->gain, o->gamma, o->black);
        ok = surface_of(c, o, depth, confidence, &outcome, &f, err);
    }
    if (ok) {
        const wall_score s = wall_judge(c, original, depth, confidence, &t->calibration);
        t->sum.error += s.error;
        t->sum.cut += s.cut;
        t->sum.left += s.left;
        t->worst = fmax(t->worst, s.error);
        t->count++;
        printf("  %-4s %5.2f / %4.1f / %4.1f   outcome %d, T %u, valley %.2f, parted %.2f, wall %.0f, spread "
               "%.2f, seen by %.0f %%\n",
               c->name, s.error, 100.0 * s.cut, 100.0 * s.left, (int)outcome, f.threshold, f.valley,
               f.separability, f.wall, f.spread, f.rays ? 100.0 * f.wall_rays / f.rays : 0.0);
    }
    free(depth);
    free(confidence);
    free(original);
    wall_case_free(c);
    return ok;
}

static void print_totals(const char *what, const totals *t) {
    printf("%s: %.2f / %.2f / %.2f, worst %.2f, AUC %.3f; right where the confidence says", what,
           t->sum.error / t->count, 100.0 * t->sum.cut / t->count, 100.0 * t->sum.left / t->count, t->worst,
           wall_auc(&t->calibration));
    for (int i = 0; i < 10; i++) {
        double right, mean;
        if (wall_reliability(&t->calibration, 0.1 * i, i == 9 ? 1.1 : 0.1 * (i + 1), 100, &right, &mean))
            printf(" %.2f: %.2f", mean, right);
    }
    printf("\n");
}

static bool judge_site(const char *folder, const options *o, hs_error *err) {
    totals t = {0};
    for (int i = 0; i < CASES; i++) {
        wall_case c;
        if (!wall_case_read(folder, names[i], &c, err) || !judge(&c, o, &t, err)) return false;
    }
    print_totals("site", &t);
    return true;
}

static bool judge_files(char **files, int count, const options *o, hs_error *err) {
    totals t = {0};
    for (int i = 0; i < count; i++) {
        wall_case c;
        if (!wall_case_files(files[i], &c, err) || !judge(&c, o, &t, err)) return false;
    }
    print_totals("cases", &t);
    return true;
}

static bool judge_scenes(char **sets, int count, const options *o, hs_error *err) {
    totals all = {0};
    for (int k = 0; k < count; k++) {
        unsigned long seed, pose;
        if (sscanf(sets[k], "%lu,%lu", &seed, &pose) != 2)
            return hs_fail(err, HS_ERR_USAGE, "--scenes: '%s' is no SEED,POSE", sets[k]);
        printf("seed %lu, pose %lu\n", seed, pose);
        for (int i = 0; i < CASES; i++) {
            wall_case c;
            if (!wall_case_make(names[i], seed, (uint32_t)pose, 0, &c, err) || !judge(&c, o, &all, err))
                return false;
        }
    }
    print_totals("scenes", &all);
    return true;
}

/* As wall_flicker_of asks for it; user: options. */
static bool depth_of(void *user, const wall_case *c, float *depth, hs_error *err) {
    const options *o = user;
    float *confidence = malloc((size_t)c->nx * c->ny * sizeof *confidence);
    sv_wall_outcome outcome;
    const bool ok = confidence ? surface_of(c, o, depth, confidence, &outcome, NULL, err)
                               : hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
    free(confidence);
    return ok;
}

/* A scene that stands still: only the seed is another in every frame. */
static bool flicker_of(const char *scene, uint64_t seed, uint32_t pose, options *o, wall_flicker *out,
                       hs_error *err) {
    wall_case frames[STILL];
    uint32_t count = 0;
    while (count < STILL && wall_case_make(scene, seed + count, pose, 0, &frames[count], err)) count++;
    const bool ok = count == STILL && wall_flicker_of(frames, count, depth_of, o, out, err);
    while (count > 0) wall_case_free(&frames[--count]);
    return ok;
}

static bool judge_still(const char *set, options *o, hs_error *err) {
    unsigned long seed, pose;
    double sum = 0.0;
    if (sscanf(set, "%lu,%lu", &seed, &pose) != 2)
        return hs_fail(err, HS_ERR_USAGE, "--still: '%s' is no SEED,POSE", set);
    for (int i = 0; i < CASES; i++) {
        wall_flicker f;
        if (!flicker_of(names[i], seed, (uint32_t)pose, o, &f, err)) return false;
        sum += (f.result - f.truth) / CASES;
        printf("  %-4s %5.2f slices a frame, truth %5.2f\n", names[i], f.result, f.truth);
    }
    printf("still: %.2f slices a frame beyond the truth's\n", sum);
    return true;
}

static bool judge_named(char **scenes, int count, const options *o, hs_error *err) {
    totals all = {0};
    for (int i = 0; i < count; i++) {
        wall_case c;
        if (!wall_case_make(scenes[i], 0, 0, 0, &c, err) || !judge(&c, o, &all, err)) return false;
    }
    print_totals("named", &all);
    return true;
}

static bool judge_view(const wall_case *c, const options *o, double *worst, int *refused, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    float *depth = malloc(plane * sizeof *depth), *confidence = malloc(plane * sizeof *confidence);
    sv_wall_outcome outcome = SV_WALL_EMPTY;
    sv_wall_facts f = {0};
    const bool ok = ((depth && confidence) || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name)) &&
                    surface_of(c, o, depth, confidence, &outcome, &f, err);
    if (ok) {
        const double cut = wall_cut_anywhere(c, depth);
        *worst = fmax(*worst, cut);
        *refused += outcome != SV_WALL_SURFACE;
        printf("  %s: outcome %d, cut %.1f %%, valley %.2f, fetus on %.0f %%\n", c->name, (int)outcome,
               100.0 * cut, f.valley, 100.0 * f.fetus);
    }
    free(depth);
    free(confidence);
    return ok;
}

static bool judge_views(char **files, int count, const options *o, hs_error *err) {
    double worst = 0.0;
    int refused = 0;
    for (int k = 0; k < count; k++) {
        wall_case whole;
        if (!wall_case_open(files[k], &whole, err)) return false;
        bool ok = true;
        for (int i = 0; ok && i < 36; i++) {
            wall_case c;
            ok = wall_case_turn(&whole, i / 12, 30.0 * (i % 12), SIDE, &c, err) &&
                 judge_view(&c, o, &worst, &refused, err);
            wall_case_free(&c);
        }
        wall_case_free(&whole);
        if (!ok) return false;
    }
    printf("views: %d of %d refused, at most %.1f %% cut\n", refused, 36 * count, 100.0 * worst);
    return true;
}

int main(int argc, char **argv) {
    options o = {.settings = sv_wall_settings_default(), .gain = 1.0, .gamma = 1.0};
    hs_error err = {0};
    int i = 1;
    bool ok = true, done = false;
    for (; ok && !done && i < argc; i += 2) {
        const char *key = argv[i];
        const bool more = i + 1 < argc;
        done = true;
        if (strcmp(key, "--site") == 0 && more) {
            ok = judge_site(argv[i + 1], &o, &err);
        } else if (strcmp(key, "--case") == 0 && more) {
            ok = judge_files(argv + i + 1, argc - i - 1, &o, &err);
        } else if (strcmp(key, "--named") == 0 && more) {
            ok = judge_named(argv + i + 1, argc - i - 1, &o, &err);
        } else if (strcmp(key, "--scenes") == 0 && more) {
            ok = judge_scenes(argv + i + 1, argc - i - 1, &o, &err);
        } else if (strcmp(key, "--still") == 0 && more) {
            ok = judge_still(argv[i + 1], &o, &err);
        } else if (strcmp(key, "--views") == 0 && more) {
            ok = judge_views(argv + i + 1, argc - i - 1, &o, &err);
        } else {
            done = false;
            ok = (strncmp(key, "--", 2) == 0 && more) ||
                 hs_fail(&err, HS_ERR_USAGE, "'%s' is no option with a value", key);
            ok = ok && set(&o, key + 2, argv[i + 1], &err);
        }
    }
    if (ok && !done) printf("%s", help);
    if (!ok) fprintf(stderr, "sv_wall: %s\n", err.text);
    return ok ? HS_OK : (int)err.code;
}
