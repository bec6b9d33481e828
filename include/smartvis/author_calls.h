/* SPDX-License-Identifier: MIT */
/*
 * The functions of a plugin, but for those of author_any.h, and its creation, between the ABI and a method. A
 * part of smartvis/author.h; a method does not call it.
 */
#ifndef SMARTVIS_AUTHOR_CALLS_H
#define SMARTVIS_AUTHOR_CALLS_H

#include "smartvis/author_any.h"
#include "smartvis/band.h"

SMARTVIS_BEGIN_C

/* What ends a frame, or an adjust, without a map: the method lets go of the host's memory. */
static inline sv_status sva_fail(sva *a, sv_status status) {
    if (status < 0 && a->method->abandon) a->method->abandon(a);
    return status;
}

/* A method's status. An error without a reason gets one; success leaves none behind. */
static inline sv_status sva_heed(sva *a, const char *call, sv_status status) {
    if (status == SV_OK) a->reason[0] = '\0';
    if (status >= 0 || a->reason[0] != '\0') return status;
    return sva_error(a, status, "%s: the method returned %d without a reason", call, (int)status);
}

static inline sv_status sva_wrong_state(sva *a, const char *call) {
    static const char *const names[] = {"inactive", "active, and no frame is under way",
                                        "active, and slabs are awaited", "active, and a frame is finished"};
    return sva_blame(a, SV_ERR_STATE, "%s: the instance is %s", call, names[a->state]);
}

/* ----------------------------------------------------------------------------------------- control -- */

static inline void sva_free_map(void *map) {
    if (map) free((uint8_t *)map - SV_BAND_BYTES);
}

static inline void sva_release(sva *a) {
    if (a->method->deactivate) a->method->deactivate(a);
    free((void *)a->slice);
    sva_free_map(a->depth);
    sva_free_map(a->points);
    sva_free_map(a->rays);
    a->slice = NULL;
    a->rays = NULL;
    a->depth = NULL;
    a->points = NULL;
    a->scanned = NULL;
    a->state = SVA_INACTIVE;
}

/* The end of an instance that no call uses. */
static inline void sva_delete(sva *a) {
    if (a->state != SVA_INACTIVE) {
        (void)sva_wrong_state(a, "destroy");
        sva_release(a);
    }
    free(a->own);
    free(a->values);
    free(a);
}

/* Behind what sva_take allowed; returns `status`. */
static inline sv_status sva_leave(sva *a, sv_status status) {
    if (!sva_change(&a->busy, 1, 0)) sva_delete(a);
    return status;
}

static inline void SV_CALL sva_deactivate(const sv_plugin *plugin) {
    sva *a = sva_take(plugin, "deactivate");
    if (!a) return;
    if (a->state == SVA_INACTIVE)
        (void)sva_wrong_state(a, "deactivate");
    else
        sva_release(a);
    (void)sva_leave(a, SV_OK);
}

static inline void SV_CALL sva_destroy(const sv_plugin *plugin) {
    if (!plugin) return;
    sva *a = (sva *)plugin->plugin_data;
    if (sva_change(&a->busy, 1, 2))
        (void)sva_tell(a, SV_ERR_STATE, "destroy: comes while another call of this instance is under way");
    else
        sva_delete(sva_enter(plugin));
}

/* The format as the method sees it. */
static inline void sva_keep_format(sva *a, const sv_format *format) {
    sv_format *f = &a->format;
    *f = *format;
    f->values = NULL;
    f->value_count = 0;
    a->padding = a->method->descriptor->features & SV_FEATURE_PADDING ? f->padding_value : SV_NO_PADDING;
    if (f->spacing_mm[2] > 0.0f) return;
    uint32_t longest = f->width > f->height ? f->width : f->height;
    if (f->slices > longest) longest = f->slices;
    for (int i = 0; i < 3; i++) f->spacing_mm[i] = SV_ASSUMED_EXTENT_MM / (float)longest;
}

/* Zeros for every ray, with a band before and behind them; NULL without memory. sva_free_map frees it. */
static inline void *sva_make_map(const sva *a, size_t ray_bytes) {
    const size_t rays = sva_rays(a), bytes = rays * ray_bytes, bands = 2 * (size_t)SV_BAND_BYTES;
    if (ray_bytes > ((size_t)-1 - bands) / rays) return NULL;
    uint8_t *band = (uint8_t *)calloc(1, bytes + bands);
    if (!band) return NULL;
    sv_band_make(band);
    sv_band_make(band + SV_BAND_BYTES + bytes);
    return band + SV_BAND_BYTES;
}

/* 1 if something was written before or behind a map; its bands are whole again then. */
static inline int sva_is_overrun(const sva *a, void *map, size_t ray_bytes) {
    if (!map) return 0;
    const int before = sv_band_holds((uint8_t *)map - SV_BAND_BYTES);
    const int behind = sv_band_holds((uint8_t *)map + sva_rays(a) * ray_bytes);
    return !before || !behind;
}

/* The method's status, or SV_ERR_INTERNAL if it has written beyond its rays. */
static inline sv_status sva_check_maps(sva *a, const char *call, sv_status status) {
    const int depth = sva_is_overrun(a, a->depth, sizeof *a->depth), points = sva_is_overrun(a, a->points, 1),
              rays = sva_is_overrun(a, a->rays, a->method->ray_bytes);
    const unsigned count = (unsigned)sva_rays(a);
    if (!depth && !points && !rays) return status;
    return sva_accuse(a, SV_ERR_INTERNAL, SV_BAND_TEXT, call, count,
                      depth    ? ""
                      : points ? " into what surrounds sva.points"
                               : " into what surrounds sva.rays: is sva_method.ray_bytes right?");
}

static inline sv_status sva_allocate(sva *a) {
    const int maps = a->method->output == NULL;
    if (maps && a->format.carrier == SV_CARRIER_HOST)
        a->slice = (const uint8_t **)calloc(a->format.slices, sizeof *a->slice);
    if (maps) a->depth = (float *)sva_make_map(a, sizeof *a->depth);
    if (maps) a->points = (uint8_t *)sva_make_map(a, 1);
    if (maps && a->method->ray_bytes) a->rays = sva_make_map(a, a->method->ray_bytes);
    /* For who finds a crash behind it: sv_validate quotes the last line. */
    if (maps && !a->own)
        sva_log(a, SV_LOG_DEBUG, "should it crash: sva.own is NULL, since sva_method.own_bytes is 0");
    if (maps && !a->method->ray_bytes)
        sva_log(a, SV_LOG_DEBUG, "should it crash: sva.rays is NULL, since sva_method.ray_bytes is 0");
    if ((maps && (!a->depth || !a->points || (a->method->ray_bytes && !a->rays))) ||
        (maps && a->format.carrier == SV_CARRIER_HOST && !a->slice))
        return sva_error(a, SV_ERR_NO_MEMORY, "activate: no memory for maps of %u x %u",
                         (unsigned)a->format.width, (unsigned)a->format.height);
    return SV_OK;
}

static inline sv_status sva_on_activate(sva *a, const sv_format *format) {
    const uint32_t count = a->method->param_count;
    if (a->state != SVA_INACTIVE) return sva_wrong_state(a, "activate");
    sv_status status = sva_check_format(a, format, 0);
    if (status != SV_OK) return status;
    for (uint32_t i = 0; i < count; i++) a->values[i] = a->method->params[i].default_value;
    status = sva_take_values(a, "activate", format->values, format->value_count, SV_PARAM_REACTIVATE);
    if (status != SV_OK) return status;
    memcpy(a->fixed, a->values, count * sizeof *a->values);
    sva_keep_format(a, format);
    status = sva_allocate(a);
    if (status == SV_OK && a->method->activate) status = sva_heed(a, "activate", a->method->activate(a));
    if (status >= SV_OK)
        a->state = SVA_IDLE;
    else
        sva_release(a);
    char doubt[SV_LENGTHS_TEXT_BYTES];
    a->doubted = status >= SV_OK && sv_lengths_doubt_format(format, doubt, sizeof doubt);
    if (a->doubted) sva_say(a, SV_LOG_INFO, "activate: %s", doubt);
    return status;
}

static inline sv_status SV_CALL sva_activate(const sv_plugin *plugin, const sv_format *format) {
    sva *a = sva_take(plugin, "activate");
    return a ? sva_leave(a, sva_on_activate(a, format)) : SV_ERR_STATE;
}

/* ------------------------------------------------------------------------------------------- frame -- */

/* Once an activation. */
static inline void sva_doubt_frame(sva *a) {
    char doubt[SV_LENGTHS_TEXT_BYTES];
    if (a->doubted || !sv_lengths_doubt_frame(&a->format, &a->frame, doubt, sizeof doubt)) return;
    a->doubted = 1;
    sva_say(a, SV_LOG_INFO, "begin: %s", doubt);
}

static inline sv_status sva_on_begin(sva *a, const sv_frame *frame) {
    if (a->state == SVA_INACTIVE) return sva_wrong_state(a, "begin");
    if (a->state == SVA_SLABS && a->method->abandon) a->method->abandon(a);
    a->state = SVA_IDLE;
    sv_status status = sva_check_frame(a, frame);
    if (status != SV_OK) return status;
    memcpy(a->values, a->fixed, a->method->param_count * sizeof *a->values);
    status = sva_take_values(a, "begin", frame->values, frame->value_count, 0);
    if (status != SV_OK) return status;
    memcpy(a->framed, a->values, a->method->param_count * sizeof *a->values);
    memset(&a->frame, 0, sizeof a->frame); /* what an older host does not say */
    memcpy(&a->frame, frame, frame->size < sizeof a->frame ? frame->size : sizeof a->frame);
    a->frame.values = NULL;
    a->frame.value_count = 0;
    a->scanned = frame->scanned;
    a->next_slice = 0;
    if (a->rays) memset(a->rays, 0, sva_rays(a) * a->method->ray_bytes);
    if (a->method->begin) status = sva_heed(a, "begin", a->method->begin(a));
    if (status >= SV_OK) a->state = SVA_SLABS;
    if (status >= SV_OK) sva_doubt_frame(a);
    return sva_fail(a, status);
}

static inline sv_status SV_CALL sva_begin(const sv_plugin *plugin, const sv_frame *frame) {
    sva *a = sva_take(plugin, "begin");
    return a ? sva_leave(a, sva_on_begin(a, frame)) : SV_ERR_STATE;
}

static inline sv_status sva_on_slab(sva *a, const sv_slab *slab) {
    if (a->state != SVA_SLABS) return sva_wrong_state(a, "slab");
    a->state = SVA_IDLE; /* an error ends the frame */
    sv_status status = sva_check_slab(a, slab);
    if (status == SV_OK && !sva_in_host_memory(&a->format, slab))
        status = sva_blame(a, SV_ERR_SLAB_SHAPE,
                           "slab: memory does not lie within the %llu bytes of the format's host_memory",
                           (unsigned long long)a->format.host_memory_bytes);
    if (status != SV_OK) return sva_fail(a, status);
    for (uint32_t s = 0; a->slice && s < slab->slice_count; s++)
        a->slice[slab->first_slice + s] = (const uint8_t *)slab->memory + sva_byte(&a->format, 0, 0, s);
    a->next_slice += slab->slice_count;
    if (a->method->slab) status = sva_check_maps(a, "slab", sva_heed(a, "slab", a->method->slab(a, slab)));
    if (status >= SV_OK) a->state = SVA_SLABS;
    return sva_fail(a, status);
}

static inline sv_status SV_CALL sva_slab(const sv_plugin *plugin, const sv_slab *slab) {
    sva *a = sva_take(plugin, "slab");
    return a ? sva_leave(a, sva_on_slab(a, slab)) : SV_ERR_STATE;
}

/* The map that a method has filled becomes one that may leave: finite, and 0 where there is no surface. Also
 * the statistics. Returns the outcome. */
static inline sv_status sva_settle(sva *a, const char *call, sv_status status) {
    const size_t rays = sva_rays(a);
    uint32_t unfilled = 0, points = 0;
    if (status < 0) return sva_heed(a, call, status);
    for (size_t i = 0; i < rays; i++) {
        if (status == SV_NO_SURFACE || a->depth[i] == SVA_NO_DEPTH) {
            a->depth[i] = 0.0f;
            unfilled++;
        } else if (!(a->depth[i] >= -FLT_MAX && a->depth[i] <= FLT_MAX)) {
            (void)sva_error(a, SV_ERR_INTERNAL, "%s: the depth of ray (%u, %u) is %g", call,
                            (unsigned)(i % a->format.width), (unsigned)(i / a->format.width),
                            (double)a->depth[i]);
            return SV_ERR_INTERNAL;
        }
        points += a->points[i] != SV_POINT_NONE;
    }
    a->stats.size = (uint32_t)sizeof a->stats;
    a->stats.outcome = unfilled == 0 ? SV_OK : unfilled == rays ? SV_NO_SURFACE : SV_PARTIAL;
    a->stats.rays = (uint32_t)rays;
    a->stats.points = points;
    a->stats.unfilled = unfilled;
    return SV_OK;
}

/* The helper's maps and statistics into the host's memory. */
static inline sv_status sva_give_out(sva *a, const char *call, const sv_result *r) {
    const size_t width = a->format.width, row = width * sizeof(float);
    const size_t pitch = r->depth_pitch ? r->depth_pitch : row;
    for (size_t y = 0; y < a->format.height; y++)
        memcpy((char *)r->depth + y * pitch, a->depth + y * width, row);
    if (r->status) memcpy(r->status, a->points, sva_rays(a));
    if (r->stats) {
        const uint32_t size = r->stats->size;
        *r->stats = a->stats;
        r->stats->size = size;
    }
    if (a->stats.outcome == SV_OK) return SV_OK;
    return sva_error(a, a->stats.outcome, "%s: %u of %u pixels are without a surface", call,
                     (unsigned)a->stats.unfilled, (unsigned)a->stats.rays);
}

/* What finish and adjust have in common: from the method's status to the host's results. */
static inline sv_status sva_deliver(sva *a, const char *call, sv_status status, const sv_result *result) {
    if (a->method->output) {
        status = sva_heed(a, call, status);
        return status < 0 ? status : sva_heed(a, call, a->method->output(a, result));
    }
    status = sva_settle(a, call, sva_check_maps(a, call, status));
    return status < 0 ? status : sva_give_out(a, call, result);
}

static inline sv_status sva_on_end(sva *a, const sv_result *result) {
    if (a->state != SVA_SLABS) return sva_wrong_state(a, "end");
    a->state = SVA_IDLE;
    sv_status status = sva_check_end(a, result);
    if (status != SV_OK) return sva_fail(a, status);
    if (a->points) memset(a->points, SV_POINT_NONE, sva_rays(a));
    status = sva_deliver(a, "end", a->method->finish(a, a->depth), result);
    if (status >= 0) a->state = SVA_FINISHED;
    return sva_fail(a, status);
}

static inline sv_status SV_CALL sva_end(const sv_plugin *plugin, const sv_result *result) {
    sva *a = sva_take(plugin, "end");
    return a ? sva_leave(a, sva_on_end(a, result)) : SV_ERR_STATE;
}

static inline sv_status sva_on_adjust(sva *a, const sv_param_value *values, uint32_t value_count,
                                      const sv_result *result) {
    if (a->state != SVA_FINISHED) return sva_wrong_state(a, "adjust");
    memcpy(a->values, a->framed, a->method->param_count * sizeof *a->values);
    sv_status status = sva_take_values(a, "adjust", values, value_count, SV_PARAM_ADJUST);
    if (status == SV_OK) status = sva_check_result(a, "adjust", result);
    if (status != SV_OK) return sva_fail(a, status);
    if (!a->method->adjust && !a->method->output) return sva_give_out(a, "adjust", result);
    status = a->method->adjust ? a->method->adjust(a, a->depth) : SV_OK;
    return sva_fail(a, sva_deliver(a, "adjust", status, result));
}

static inline sv_status SV_CALL sva_adjust(const sv_plugin *plugin, const sv_param_value *values,
                                           uint32_t value_count, const sv_result *result) {
    sva *a = sva_take(plugin, "adjust");
    return a ? sva_leave(a, sva_on_adjust(a, values, value_count, result)) : SV_ERR_STATE;
}

/* ---------------------------------------------------------------------------------------- creation -- */

/* What is wrong with the author's own tables as a text for the log; "" if nothing is. */
static inline void sva_fault(const sva_method *m, char *out, size_t bytes) {
    const char *fault = !m->finish                     ? "sva_method.finish is NULL"
                        : m->params && !m->param_count ? "sva_method.params is given, and param_count is 0"
                        : m->param_count && !m->params ? "sva_method.params is NULL, and param_count is not 0"
                                                       : "";
    for (uint32_t i = 0; i < m->param_count && !fault[0]; i++) {
        const sva_param *p = &m->params[i];
        const int whole = p->id != 0 && p->key && p->label && p->unit && p->help;
        if (whole && !sva_value_fits(p, p->default_value)) {
            (void)snprintf(out, bytes, "parameter '%s': the default is %g, expected %g to %g in steps of %g",
                           p->key, p->default_value, p->min_value, p->max_value, sva_step(p));
            return;
        }
        if (!whole) fault = "a parameter is incomplete";
        if ((p->flags & SV_PARAM_ADJUST) && (!m->adjust || !(m->descriptor->features & SV_FEATURE_ADJUST)))
            fault = "SV_PARAM_ADJUST needs the function adjust and SV_FEATURE_ADJUST";
        for (uint32_t n = 0; n < i; n++)
            if (m->params[n].id == p->id) fault = "two parameters have the same id";
    }
    (void)snprintf(out, bytes, "%s", fault);
}

static inline void sva_fill_api(sva *a) {
    sv_plugin *p = &a->api;
    p->size = (uint32_t)sizeof *p;
    p->descriptor = a->method->descriptor;
    p->plugin_data = a;
    p->destroy = sva_destroy;
    p->activate = sva_activate;
    p->deactivate = sva_deactivate;
    p->begin = sva_begin;
    p->slab = sva_slab;
    p->end = sva_end;
    p->adjust = sva_adjust;
    p->param_count = sva_param_count;
    p->param_info = sva_param_info;
    p->param_text = sva_param_text;
    p->last_error = sva_last_error;
    p->get_extension = sva_get_extension;
}

/* sv_entry.create for a library whose only plugin is `method`. */
static inline sv_status sva_create(const sva_method *method, const sv_host *host, const char *id,
                                   const sv_plugin **out) {
    if (!out) return SV_ERR_ARGUMENT;
    *out = NULL;
    if (!host || !id) return SV_ERR_ARGUMENT;
    if (host->size < sizeof *host) return SV_ERR_SIZE;
    char fault[256];
    sva_fault(method, fault, sizeof fault);
    const int known = strcmp(id, method->descriptor->id) == 0;
    if (fault[0] && host->log) host->log(host, SV_LOG_PLUGIN_MISBEHAVING, fault);
    if (!known) {
        (void)snprintf(fault, sizeof fault, "create: no plugin '%.100s' here, only '%.100s'", id,
                       method->descriptor->id);
        if (host->log) host->log(host, SV_LOG_HOST_MISBEHAVING, fault);
        return SV_ERR_UNKNOWN_ID;
    }
    if (fault[0]) return SV_ERR_INTERNAL;
    sva *a = (sva *)calloc(1, sizeof *a);
    double *values = (double *)calloc(3 * (size_t)method->param_count + 1, sizeof *values);
    void *own = method->own_bytes > 0 ? calloc(1, method->own_bytes) : NULL;
    if (!a || !values || (method->own_bytes > 0 && !own)) {
        free(a);
        free(values);
        free(own);
        if (host->log) host->log(host, SV_LOG_ERROR, "create: no memory for an instance");
        return SV_ERR_NO_MEMORY;
    }
    a->method = method;
    a->host = host;
    a->own = own;
    a->values = values;
    a->framed = values + method->param_count;
    a->fixed = a->framed + method->param_count;
    sva_fill_api(a);
    *out = &a->api;
    return SV_OK;
}

SMARTVIS_END_C

#endif
