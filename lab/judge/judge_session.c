/* SPDX-License-Identifier: MIT */
/* A plugin at work on cases in memory, known by its ABI only. */
#include "judge/judge.h"

#include "loop/clipper.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLAB = 16 };

static void deactivate(surf_session *s) {
    if (s->active) s->plugin.instance->deactivate(s->plugin.instance);
    s->active = false;
    stage_free(&s->stage);
    free(s->scanned);
    free(s->confidence);
    s->scanned = NULL;
    s->confidence = NULL;
    s->depth = NULL;
}

void surf_session_close(surf_session *s) {
    if (!s->plugin.instance) return;
    deactivate(s);
    hs_plugin_close(&s->plugin);
    *s = (surf_session){0};
}

static bool take_settings(surf_session *s, const char *settings, hs_error *err) {
    char text[512], *rest = NULL;
    if (strlen(settings) >= sizeof text)
        return hs_fail(err, HS_ERR_USAGE, "'%.40s...': settings of more than %zu characters", settings,
                       sizeof text - 1);
    (void)strcpy(text, settings);
    for (const char *one = strtok_r(text, " ", &rest); one; one = strtok_r(NULL, " ", &rest))
        if (!hs_eval_values_parse(&s->values, &s->plugin, &one, 1, err)) return false;
    return true;
}

bool surf_session_open(surf_session *s, const char *path, const char *settings, hs_error *err) {
    *s = (surf_session){0};
    if (!hs_plugin_open(&s->plugin, path, NULL, SV_LOG_ERROR, err)) return false;
    if (take_settings(s, settings, err)) return true;
    surf_session_close(s);
    return false;
}

bool surf_session_set(surf_session *s, const char *key, double value, hs_error *err) {
    sv_param_info info = {.size = sizeof info};
    if (!hs_plugin_find_param(&s->plugin, key, &info))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: no parameter '%s'", s->plugin.path, key);
    return hs_eval_values_add(&s->values, info.id, value, err);
}

/* ---- a frame */

static bool fits(const surf_session *s, const wall_case *c) {
    const stage_way *w = &s->stage.way;
    return s->active && w->width == c->nx && w->height == c->ny && w->slices == c->nz &&
           s->spacing_mm[0] == c->spacing_mm[0] && s->spacing_mm[1] == c->spacing_mm[1] &&
           s->spacing_mm[2] == c->spacing_mm[2];
}

/* What the stage cannot have ends the program: there is nothing to judge without it. */
static void cannot_have(void *data, const char *what, cl_int code) {
    (void)data;
    (void)fprintf(stderr, "sv_judge: no memory for %s (%d)\n", what, (int)code);
    exit(HS_ERR_MEMORY);
}

/* One tile to a texture row: a slab lies in memory as the volume does. */
static bool activate(surf_session *s, const wall_case *c, hs_error *err) {
    const sv_plugin *p = s->plugin.instance;
    const size_t rays = (size_t)c->nx * c->ny;
    stage_way way = {.width = c->nx,
                     .height = c->ny,
                     .slices = c->nz,
                     .longest = SLAB,
                     .tiles_x = 1,
                     .carrier = SV_CARRIER_HOST,
                     .own_queue = true,
                     .ranges = true,
                     .padding = SV_NO_PADDING};
    deactivate(s);
    for (int axis = 0; axis < 3; axis++) way.spacing_mm[axis] = (float)c->spacing_mm[axis];
    memcpy(s->spacing_mm, c->spacing_mm, sizeof s->spacing_mm);
    for (uint32_t v = 0; v < s->values.count; v++)
        if (hs_plugin_is_fixed(p, s->values.at[v].id)) way.fixed[way.fixed_count++] = s->values.at[v];
    stage_make(&s->stage, &way, NULL, cannot_have, NULL);
    s->depth = stage_result(&s->stage).depth;
    s->scanned = calloc(rays, sizeof *s->scanned);
    s->confidence = calloc(rays, sizeof *s->confidence);
    if (!s->scanned || !s->confidence)
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", c->name, rays);
    s->active = hs_plugin_check(&s->plugin, p->activate(p, &s->stage.format), "activate", err);
    const sv_ext_confidence *ext = s->active ? hs_plugin_confidence(p) : NULL;
    s->sure = ext && ext->offered(p);
    return s->active;
}

/* What the frame tells of the case's probe and beams. */
static sv_frame told_of(surf_told told, const wall_case *c) {
    if (told == SURF_BEAMS) return c->told;
    sv_frame frame = {0};
    if (told == SURF_NOTHING) return frame;
    memcpy(frame.probe_rotation, c->told.probe_rotation, sizeof frame.probe_rotation);
    memcpy(frame.probe_side, c->told.probe_side, sizeof frame.probe_side);
    return frame;
}

surf_answer surf_answer_of(uint32_t reason, bool clips) {
    return reason == SV_REASON_DOUBTFUL ? SURF_DOUBTFUL : clips ? SURF_SURE : SURF_REFUSED;
}

bool surf_session_frame(surf_session *s, const wall_case *c, hs_error *err) {
    const sv_plugin *p = s->plugin.instance;
    const size_t rays = (size_t)c->nx * c->ny;
    if (!fits(s, c) && !activate(s, c, err)) return false;
    for (size_t i = 0; i < rays; i++) s->scanned[i] = (sv_scanned){c->first[i], c->end[i]};
    stage_fill(&s->stage, c->full, s->scanned);
    stage_poison(&s->stage, 0);
    s->stage.told = told_of(s->told, c);
    const sv_result result = stage_result(&s->stage);
    s->outcome = stage_run(&s->stage, p, s->values.at, s->values.count, &result);
    memset(s->confidence, 0, rays * sizeof *s->confidence);
    sv_confidence_report report = {.size = sizeof report};
    const bool done =
        hs_plugin_check(&s->plugin, s->outcome, "a frame", err) &&
        (!s->sure || hs_plugin_check(&s->plugin, hs_plugin_confidence(p)->read(p, s->confidence, &report),
                                     "confidence", err));
    s->answer = surf_answer_of(report.reason, surf_session_clips(s));
    return done;
}

bool surf_session_clips(const surf_session *s) {
    return hs_outcome_clips(s->outcome);
}
