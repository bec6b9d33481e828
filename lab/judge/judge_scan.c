/* SPDX-License-Identifier: MIT */
#include "judge/judge.h"

#include "loop/loop_run.h"
#include "render/camera.h"
#include "volume/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const told_names[] = {"nothing", "pose", "beams"};

static void print_answers(const char *what, surf_told told, const uint32_t answers[SURF_ANSWERS]) {
    printf("  %-32s %-8s %4u /%3u /%3u", what, told_names[told], answers[SURF_SURE], answers[SURF_DOUBTFUL],
           answers[SURF_REFUSED]);
}

static bool print_set(const site_set *set, const char *plugin, const site_method *m, surf_told told,
                      hs_error *err) {
    surf_session s;
    site_score score;
    double q;
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    s.told = told;
    const bool ok = site_judge(&s, set, m->best_q, &score, &q, NULL, err);
    surf_session_close(&s);
    if (!ok) return false;
    const wall_score mean = site_score_mean(&score);
    print_answers(m->settings, told, score.answers);
    printf("  %5.2f slices  cut %5.2f %%  left %5.2f %%  AUC cut %.3f, left %.3f", mean.error,
           100.0 * mean.cut, 100.0 * mean.left, wall_auc(&score.calibration, WALL_CUT),
           wall_auc(&score.calibration, WALL_LEFT));
    site_score_print_surest(&score);
    printf("\n");
    return true;
}

/* ------------------------------------------------------------------------------ a volume with labels -- */

enum { NOT_SCANNED, TISSUE, FLUID, FETUS, CORD, BEHIND, DOUBTFUL };

/* mm along a ray from voxel to voxel of labels; shorter fluid is none. */
static const double step_mm = 0.25, pocket_mm = 2.0;

static int kind_of(uint8_t label) {
    return label == BEHIND ? TISSUE : label > DOUBTFUL ? DOUBTFUL : label;
}

/* Whether tissue, or what nobody can tell, goes on at `k`; *to: where it ends, if so. A pocket of fluid or
 * cord in tissue is tissue. */
static bool goes_on(const uint8_t *label, uint32_t k, uint32_t end, uint32_t *to) {
    const int kind = kind_of(label[k]);
    for (*to = k; *to < end && kind_of(label[*to]) == kind;) ++*to;
    if (kind == TISSUE || kind == DOUBTFUL || kind == NOT_SCANNED) return true;
    return kind != FETUS && *to - k < pocket_mm / step_mm && *to < end && kind_of(label[*to]) == TISSUE;
}

/* Of a ray's labels, a step each. */
static scan_ray ray_of(const uint8_t *label, uint32_t steps) {
    const scan_ray none = {0};
    uint32_t begin = 0, end = steps, first, next, last = 0;
    while (begin < end && label[begin] == NOT_SCANNED) begin++;
    while (end > begin && label[end - 1] == NOT_SCANNED) end--;
    if (begin == end || label[begin] >= DOUBTFUL) return none;
    for (first = begin; first < end && goes_on(label, first, end, &next);) first = next;
    if (first == end) return none;
    for (uint32_t k = begin; k < first; k++)
        if (kind_of(label[k]) == TISSUE) last = k + 1;
    uint32_t stays = first;
    while (stays < end && kind_of(label[stays]) != FETUS && kind_of(label[stays]) != TISSUE) stays++;
    if (stays == end || kind_of(label[stays]) != FETUS) return none;
    return (scan_ray){step_mm * (begin - 0.5), step_mm * ((last > begin ? last : begin) - 0.5),
                      step_mm * (stays - 0.5), step_mm * (end - 0.5)};
}

/* Of all rays of a map of n[0] x n[1]. The caller frees them. */
static scan_ray *rays_of(const hs_volume *labels, const hs_camera *camera, const uint32_t n[3],
                         hs_error *err) {
    hs_box_map box;
    hs_camera_box_map(camera, labels, &box);
    const double slice = camera->depth_extent / n[2];
    const uint32_t steps = (uint32_t)(camera->depth_extent / step_mm);
    uint8_t *const label = calloc(steps, 1);
    scan_ray *const rays = calloc((size_t)n[0] * n[1], sizeof *rays);
    if (!label || !rays) {
        free(label);
        free(rays);
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for its rays", labels->name);
        return NULL;
    }
    for (uint32_t i = 0; i < n[0] * n[1]; i++) {
        const uint32_t x = i % n[0], y = i / n[0];
        double place[3] = {(x + 0.5) / n[0], (y + 0.5) / n[1], 0.0};
        for (uint32_t k = 0; k < steps; k++) {
            uint32_t at[3];
            place[2] = (0.5 * slice + k * step_mm) / camera->depth_extent;
            const bool inside = hs_box_map_voxel(&box, labels, place, at);
            label[k] = inside ? labels->voxels[((size_t)at[2] * labels->ny + at[1]) * labels->nx + at[0]]
                              : NOT_SCANNED;
        }
        rays[i] = ray_of(label, steps);
    }
    free(label);
    return rays;
}

/* ------------------------------------------------------------------------------------ turned cameras -- */

/* Yaw and pitch: those of a probe's user, and all around. */
static const int user_views[][2] = {{0, 0},   {10, 0},   {-10, 10},  {20, 0}, {-20, 0}, {0, 20},
                                    {0, -20}, {20, 20},  {-20, -20}, {30, 0}, {-30, 0}, {0, 30},
                                    {0, -30}, {30, -30}, {-30, 30},  {40, 0}, {-40, 0}, {0, 40},
                                    {0, -40}, {50, 0},   {-50, 0},   {0, 50}, {0, -50}};
enum {
    USER_VIEWS = sizeof user_views / sizeof *user_views,
    NEAR_VIEWS = 9,
    AROUND = 54,
    ORBIT = 200,
    BANDS = 3
};
static const int band_to[BANDS] = {20, 40, 50}; /* degrees */

/* A volume at work. */
typedef struct {
    hs_cl cl;
    surf_session session; /* its plugin and its values */
    hs_source source;
    hs_volume labels; /* no voxels: nothing hides */
} scan;

static surf_answer answer_of(const scan *s, const hs_frame *frame) {
    sv_confidence_report report;
    char words[HS_REASON_BYTES];
    (void)hs_plugin_reason(s->session.plugin.instance, &report, words);
    return surf_answer_of(report.reason, frame->clipped);
}

static hs_loop *make_loop(scan *s, double yaw, double pitch, bool turnable, hs_error *err) {
    hs_loop_options o;
    hs_loop_defaults(&o);
    o.yaw = yaw;
    o.pitch = pitch;
    o.turnable = turnable;
    o.frames = turnable ? ORBIT : 1;
    o.dvr.width = o.dvr.height = 16; /* no picture is looked at */
    o.values = s->session.values.at;
    o.value_count = s->session.values.count;
    return hs_loop_create(&s->cl, &s->source, &s->session.plugin, &o, err);
}

/* Judges a map, or (`marks` not NULL) plays on from it. */
static bool judge_map(const scan *s, const hs_loop *loop, const hs_frame *frame, const float *map,
                      site_sum *counts, mark_scores *marks, hs_error *err) {
    const hs_slab_layout *l = hs_loop_layout(loop);
    site_play play = {.volume = *s->source.file, .n = {l->width, l->height, l->slices}};
    hs_loop_camera(loop, 0, &play.camera);
    scan_ray *const rays = rays_of(&s->labels, &play.camera, play.n, err);
    if (!rays) return false;
    play.rays = rays;
    const double slice = play.camera.depth_extent / l->slices;
    for (uint32_t i = 0; i < l->width * l->height; i++)
        if (rays[i].high > 0.0) site_count(counts, site_scan_off(&rays[i], (double)map[i] * slice), true);
    const bool ok = !marks || site_play_marks(&play, map, frame->clipped, marks, err);
    free(rays);
    return ok;
}

/* The first frame of a new activation. */
static bool look(scan *s, const int view[2], uint32_t answers[SURF_ANSWERS], site_sum *counts,
                 mark_scores *marks, hs_error *err) {
    hs_frame frame;
    hs_loop *const loop = make_loop(s, view[0], view[1], false, err);
    if (!loop) return false;
    const hs_slab_layout *l = hs_loop_layout(loop);
    float *const map = malloc((size_t)l->width * l->height * sizeof *map);
    bool ok = map || hs_fail(err, HS_ERR_MEMORY, "no memory for a map");
    ok = ok && hs_loop_convert(loop, 0, err) && hs_loop_clip(loop, 0, &frame, map, err) &&
         (!s->labels.voxels || judge_map(s, loop, &frame, map, counts, marks, err));
    if (ok) answers[answer_of(s, &frame)]++;
    free(map);
    hs_loop_destroy(loop);
    return ok;
}

/* How often the answer changes while the camera goes round. */
static bool orbit(scan *s, uint32_t *changes, hs_error *err) {
    hs_loop *const loop = make_loop(s, 0.0, 0.0, true, err);
    surf_answer before = SURF_REFUSED;
    bool ok = loop != NULL;
    *changes = 0;
    for (uint32_t i = 0; ok && i < ORBIT; i++) {
        hs_frame frame;
        hs_loop_look(loop, 360.0 * i / ORBIT, 40.0 * sin(0.1 * i), 0.0, 1.0);
        ok = hs_loop_convert(loop, i, err) && hs_loop_clip(loop, i, &frame, NULL, err);
        if (!ok) break;
        const surf_answer now = answer_of(s, &frame);
        *changes += i > 0 && now != before;
        before = now;
    }
    hs_loop_destroy(loop);
    return ok;
}

static bool print_orbit(scan *s, surf_told told, hs_error *err) {
    uint32_t changes;
    if (!orbit(s, &changes, err)) return false;
    printf("  %-32s %-8s the answer changes %u times in %d frames\n", "orbit", told_names[told], changes,
           ORBIT);
    (void)fflush(stdout);
    return true;
}

static bool print_user(scan *s, surf_told told, hs_error *err) {
    int from = -1;
    for (int band = 0; band < BANDS; from = band_to[band++]) {
        uint32_t answers[SURF_ANSWERS] = {0}, views = 0;
        site_sum sum = {0};
        double worst = 0.0;
        char what[48];
        for (int i = 0; i < USER_VIEWS; i++) {
            const int turn =
                abs(user_views[i][0]) > abs(user_views[i][1]) ? abs(user_views[i][0]) : abs(user_views[i][1]);
            site_sum c = {0};
            if (turn <= from || turn > band_to[band]) continue;
            if (!look(s, user_views[i], answers, &c, NULL, err)) return false;
            const double rays = fmax(c.rays, 1.0);
            views++;
            sum.cut += c.cut / rays;
            sum.left += c.left / rays;
            sum.error += c.error / rays;
            worst = fmax(worst, (c.cut + c.left) / rays);
        }
        (void)snprintf(what, sizeof what, "to %d degrees", band_to[band]);
        print_answers(what, told, answers);
        printf("  %5.2f mm      cut %5.2f %%  left %5.2f %%  bad %.1f %%, worst %.1f\n", sum.error / views,
               100.0 * sum.cut / views, 100.0 * sum.left / views, 100.0 * (sum.cut + sum.left) / views,
               100.0 * worst);
        (void)fflush(stdout);
    }
    return true;
}

static bool print_around(scan *s, surf_told told, hs_error *err) {
    uint32_t answers[SURF_ANSWERS] = {0};
    for (int i = 0; i < AROUND; i++) {
        const int view[2] = {20 * (i % 18), 30 * (i / 18 - 1)};
        if (!look(s, view, answers, NULL, NULL, err)) return false;
    }
    print_answers("all around", told, answers);
    printf("  nothing hides it\n");
    return true;
}

static bool print_marked(scan *s, hs_error *err) {
    mark_scores marks = {0};
    for (int i = 0; i < NEAR_VIEWS; i++) {
        uint32_t answers[SURF_ANSWERS] = {0};
        site_sum counts = {0};
        if (!look(s, user_views[i], answers, &counts, &marks, err)) return false;
    }
    site_print_marks(s->source.file->name, "mm", &marks);
    return true;
}

/* What is known of the volume. */
static void tell(hs_volume *v, const hs_volume *known, surf_told told) {
    v->course = told == SURF_BEAMS ? known->course : (hs_course){0};
    memset(v->probe_turn, 0, sizeof v->probe_turn);
    if (told != SURF_NOTHING) memcpy(v->probe_turn, known->probe_turn, sizeof v->probe_turn);
}

static bool print_scan(scan *s, const char *path, bool marked, hs_error *err) {
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    char labels[1024];
    const size_t stem = strlen(path) - (strlen(path) > 4 ? 4 : 0);
    (void)snprintf(labels, sizeof labels, "%.*s_label.mha", (int)stem, path);
    if (!hs_source_open_files(&s->source, &path, 1, NULL, err)) return false;
    if (!s->source.file) return hs_fail(err, HS_ERR_INPUT, "%s: a sequence, expected one volume", path);
    if (access(labels, F_OK) == 0 && !hs_metaimage_read(labels, &as_it_is, &s->labels, err)) return false;
    const hs_volume known = *s->source.file;
    if (marked)
        return s->labels.voxels ? print_marked(s, err)
                                : hs_fail(err, HS_ERR_INPUT, "%s: there is none", labels);
    printf("%s\n", known.name);
    bool ok = true;
    for (int told = SURF_BEAMS; ok && told >= SURF_NOTHING; told--) {
        tell(s->source.file, &known, (surf_told)told);
        ok = (s->labels.voxels ? print_user : print_around)(s, (surf_told)told, err) &&
             print_orbit(s, (surf_told)told, err);
    }
    return ok;
}

static bool print_volumes(const char *const *volumes, uint32_t count, const char *plugin,
                          const site_method *m, bool marked, hs_error *err) {
    scan s = {0};
    bool ok = hs_cl_open(&s.cl, err) && surf_session_open(&s.session, plugin, m->settings, err);
    if (ok && !marked) printf("%s\n", m->settings);
    for (uint32_t i = 0; ok && i < count; i++) {
        ok = print_scan(&s, volumes[i], marked, err);
        hs_source_close(&s.source);
        hs_volume_free(&s.labels);
    }
    surf_session_close(&s.session);
    hs_cl_close(&s.cl);
    return ok;
}

bool site_scans(const site_list *list, const char *const *volumes, uint32_t count,
                const site_methods *methods, hs_error *err) {
    bool ok = true;
    printf(
        "Told; sure / doubtful / refused; error, and share of the fetus' rays that are cut, of all rays on "
        "which an occluder is left;\nof volumes with labels: of the fetus' rays\n");
    for (uint32_t i = 0; ok && i < list->count; i++) {
        printf("%s (%u cases)\n", list->set[i].title, list->set[i].count);
        for (uint32_t m = 0; ok && m < methods->count; m++)
            for (int told = SURF_BEAMS; ok && told >= SURF_NOTHING; told--)
                ok = print_set(&list->set[i], methods->plugin, &methods->method[m], (surf_told)told, err);
    }
    for (uint32_t m = 0; ok && count > 0 && m < methods->count; m++)
        ok = print_volumes(volumes, count, methods->plugin, &methods->method[m], false, err);
    return ok;
}

static bool print_set_marked(const site_set *set, const char *plugin, const site_method *m, hs_error *err) {
    surf_session s;
    mark_scores marks = {0};
    if (!surf_session_open(&s, plugin, m->settings, err)) return false;
    s.told = SURF_BEAMS;
    bool ok = true;
    for (uint32_t i = 0; ok && i < set->count; i++) {
        const wall_case *c = &set->cases[i];
        site_play play = {.n = {c->nx, c->ny, c->nz}, .c = c};
        play.volume = (hs_volume){.nx = c->nx, .ny = c->ny, .nz = c->nz, .voxels = c->full};
        memcpy(play.volume.spacing, c->spacing_mm, sizeof play.volume.spacing);
        hs_camera_look(&play.camera, &play.volume, 0.0, 0.0);
        ok = (c->nx == c->ny || hs_fail(err, HS_ERR_INPUT, "%s: its map is not square", c->name)) &&
             surf_session_frame(&s, c, err) &&
             site_play_marks(&play, s.depth, surf_session_clips(&s), &marks, err);
    }
    surf_session_close(&s);
    if (ok) site_print_marks(set->title, "slices", &marks);
    return ok;
}

bool site_marks(const site_list *list, const char *const *volumes, uint32_t count,
                const site_methods *methods, hs_error *err) {
    bool ok = true;
    printf("Cases or views; error / cut %% / left %% after");
    for (int i = 0; i < MARK_ROWS; i++) printf("%s %u", i ? "," : "", mark_rows[i]);
    printf(" marks\n");
    for (uint32_t m = 0; ok && m < methods->count; m++) {
        printf("%s\n", methods->method[m].settings);
        for (uint32_t i = 0; ok && i < list->count; i++)
            ok = print_set_marked(&list->set[i], methods->plugin, &methods->method[m], err);
        ok = ok &&
             (count == 0 || print_volumes(volumes, count, methods->plugin, &methods->method[m], true, err));
    }
    return ok;
}
