/* SPDX-License-Identifier: MIT */
/* A plugin at work on volumes in memory, known by its ABI only: one instance with its settings, active for
 * whatever size came last. */
#include "judge/judge_session.h"

#include "loop/clipper.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLAB = 16 };

static void deactivate(surf_session *s) {
    if (s->active) s->plugin.instance->deactivate(s->plugin.instance);
    s->active = false;
    free(s->scanned);
    free(s->depth);
    free(s->confidence);
    s->scanned = NULL;
    s->depth = s->confidence = NULL;
}

void surf_session_close(surf_session *s) {
    if (!s->plugin.instance) return;
    deactivate(s);
    hs_plugin_close(&s->plugin);
    *s = (surf_session){0};
}

/* Appends a value, or replaces that of the same parameter. */
static bool put(sv_param_value *list, uint32_t *count, sv_param_value value, hs_error *err) {
    uint32_t i = 0;
    while (i < *count && list[i].id != value.id) i++;
    if (i == SURF_MAX_VALUES)
        return hs_fail(err, HS_ERR_USAGE, "more than %d parameter values", SURF_MAX_VALUES);
    list[i] = value;
    if (i == *count) ++*count;
    return true;
}

static bool take_setting(surf_session *s, char *text, hs_error *err) {
    sv_param_value value;
    sv_param_info info = {.size = sizeof info};
    if (!hs_plugin_parse_param(&s->plugin, text, &value, err)) return false;
    *strchr(text, '=') = '\0'; /* it was parsed, so it has one */
    if (!hs_plugin_find_param(&s->plugin, text, &info))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: no parameter '%s'", s->plugin.path, text);
    return info.flags & SV_PARAM_REACTIVATE ? put(s->fixed, &s->fixed_count, value, err)
                                            : put(s->values, &s->value_count, value, err);
}

bool surf_session_open(surf_session *s, const char *path, const char *settings, hs_error *err) {
    char text[512];
    *s = (surf_session){0};
    if (strlen(settings) >= sizeof text)
        return hs_fail(err, HS_ERR_USAGE, "'%.40s...': settings of more than %zu characters", settings,
                       sizeof text - 1);
    if (!hs_plugin_open(&s->plugin, path, NULL, SV_LOG_ERROR, err)) return false;
    (void)strcpy(text, settings);
    char *rest = NULL;
    for (char *one = strtok_r(text, " ", &rest); one; one = strtok_r(NULL, " ", &rest)) {
        if (take_setting(s, one, err)) continue;
        surf_session_close(s);
        return false;
    }
    return true;
}

bool surf_session_set(surf_session *s, const char *key, double value, hs_error *err) {
    sv_param_info info = {.size = sizeof info};
    if (!hs_plugin_find_param(&s->plugin, key, &info))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: no parameter '%s'", s->plugin.path, key);
    return put(s->values, &s->value_count, (sv_param_value){.id = info.id, .value = value}, err);
}

/* ---- a frame */

static bool fits(const surf_session *s, const surf_volume *v) {
    for (int axis = 0; axis < 3; axis++)
        if (s->spacing_mm[axis] != v->spacing_mm[axis]) return false;
    return s->active && s->width == v->width && s->height == v->height && s->slices == v->slices &&
           s->ranged == (v->first != NULL);
}

static bool allocate(surf_session *s, hs_error *err) {
    const size_t rays = (size_t)s->width * s->height;
    s->scanned = calloc(rays, sizeof *s->scanned);
    s->depth = calloc(rays, sizeof *s->depth);
    s->confidence = calloc(rays, sizeof *s->confidence);
    return (s->scanned && s->depth && s->confidence) ||
           hs_fail(err, HS_ERR_MEMORY, "no memory for maps of %u x %u pixels", s->width, s->height);
}

static bool activate(surf_session *s, const surf_volume *v, hs_error *err) {
    deactivate(s);
    s->width = v->width;
    s->height = v->height;
    s->slices = v->slices;
    s->ranged = v->first != NULL;
    memcpy(s->spacing_mm, v->spacing_mm, sizeof s->spacing_mm);
    if (!allocate(s, err)) return false;
    /* One tile to a texture row: a slab lies in memory as the volume does. */
    sv_format format = {.size = sizeof format,
                        .width = v->width,
                        .height = v->height,
                        .slices = v->slices,
                        .max_slab_slices = v->slices < SLAB ? v->slices : SLAB,
                        .voxel_type = SV_VOXEL_U8,
                        .carrier = SV_CARRIER_HOST,
                        .padding_value = s->ranged ? SV_NO_PADDING : 0,
                        .tiles_x = 1,
                        .tile_w = v->width,
                        .tile_h = v->height,
                        .row_pitch = v->width,
                        .flags = s->ranged ? SV_FORMAT_SCANNED : 0,
                        .values = s->fixed,
                        .value_count = s->fixed_count};
    for (int axis = 0; axis < 3; axis++) format.spacing_mm[axis] = (float)v->spacing_mm[axis];
    const sv_plugin *p = s->plugin.instance;
    s->active = hs_plugin_check(&s->plugin, p->activate(p, &format), "activate", err);
    const sv_ext_confidence *ext = s->active ? hs_plugin_confidence(p) : NULL;
    s->sure = ext && ext->offered(p);
    return s->active;
}

static bool send(surf_session *s, const surf_volume *v, hs_error *err) {
    const sv_plugin *p = s->plugin.instance;
    const size_t plane = (size_t)v->width * v->height;
    for (uint32_t first = 0; first < v->slices; first += SLAB) {
        const uint32_t count = v->slices - first < SLAB ? v->slices - first : SLAB;
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = first,
                              .slice_count = count,
                              .bytes = (uint64_t)count * plane,
                              .memory = v->voxels + first * plane};
        if (!hs_plugin_check(&s->plugin, p->slab(p, &slab), "slab", err)) return false;
    }
    return true;
}

bool surf_session_frame(surf_session *s, const surf_volume *v, hs_error *err) {
    const sv_plugin *p = s->plugin.instance;
    const size_t rays = (size_t)v->width * v->height;
    if (!fits(s, v) && !activate(s, v, err)) return false;
    for (size_t i = 0; s->ranged && i < rays; i++) s->scanned[i] = (sv_scanned){v->first[i], v->end[i]};
    const sv_frame frame = {.size = sizeof frame,
                            .values = s->values,
                            .value_count = s->value_count,
                            .scanned = s->ranged ? s->scanned : NULL};
    s->stats = (sv_stats){.size = sizeof s->stats};
    const sv_result result = {.size = sizeof result, .depth = s->depth, .stats = &s->stats};
    if (!hs_plugin_check(&s->plugin, p->begin(p, &frame), "begin", err) || !send(s, v, err)) return false;
    s->outcome = p->end(p, &result);
    return hs_plugin_check(&s->plugin, s->outcome, "end", err);
}

bool surf_session_clips(const surf_session *s) {
    return hs_outcome_clips(s->outcome);
}

bool surf_session_confidence(surf_session *s, sv_confidence_report *report, hs_error *err) {
    const sv_plugin *p = s->plugin.instance;
    memset(s->confidence, 0, (size_t)s->width * s->height * sizeof *s->confidence);
    return !s->sure || hs_plugin_check(&s->plugin, hs_plugin_confidence(p)->read(p, s->confidence, report),
                                       "confidence", err);
}
