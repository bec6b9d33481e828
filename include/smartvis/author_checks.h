/* SPDX-License-Identifier: MIT */
/*
 * What smartvis_plugin.h demands of a host, checked once at the edge: every struct, every value, and one call
 * at a time. A part of smartvis/author.h; a method does not call it.
 */
#ifndef SMARTVIS_AUTHOR_CHECKS_H
#define SMARTVIS_AUTHOR_CHECKS_H

#include "smartvis/author_method.h"
#include "smartvis/lengths.h"
#include "smartvis/probe.h"

SMARTVIS_BEGIN_C

enum { SVA_MAX_SIDE = 8192, SVA_MAX_TILE = 16384 };

/* ----------------------------------------------------------------------------------------- parameters -- */

/* The parameter with this id, or NULL. */
static inline const sva_param *sva_find(const sva *a, uint32_t id) {
    for (uint32_t i = 0; i < a->method->param_count; i++)
        if (a->method->params[i].id == id) return &a->method->params[i];
    return NULL;
}

/* The distance of two values; floats have none that counts. */
static inline double sva_step(const sva_param *p) {
    return p->step > 0.0 || p->type == SV_PARAM_FLOAT ? p->step : 1.0;
}

/* 1 if `value` is on a step of the hard range; NaN is in no range. */
static inline int sva_on_step(const sva_param *p, double value) {
    if (!(value >= p->min_value && value <= p->max_value && value >= -DBL_MAX && value <= DBL_MAX)) return 0;
    if (p->type == SV_PARAM_FLOAT) return 1;
    const double steps = (value - p->min_value) / sva_step(p);
    return steps < 9e15 && steps == (double)(int64_t)steps;
}

/* 1 if an enum's names leave this value out. */
static inline int sva_left_out(const sva_param *p, double value) {
    return p->type == SV_PARAM_ENUM && p->names && sva_on_step(p, value) &&
           !p->names[(size_t)((value - p->min_value) / sva_step(p))];
}

/* 1 if `value` is in the hard range and a value of the parameter's type. */
static inline int sva_value_fits(const sva_param *p, double value) {
    return sva_on_step(p, value) && !sva_left_out(p, value);
}

/* A number as text, with a point in any locale. */
SVA_PRINTF(3, 4) static inline void sva_text(char *out, size_t bytes, const char *format, ...) {
    va_list args;
    va_start(args, format);
    sva_print(out, bytes, format, args);
    va_end(args);
}

/* A value that fits, by its name if it has one. */
static inline void sva_value_text(const sva_param *p, double value, char *out, size_t bytes) {
    if (p->names)
        (void)snprintf(out, bytes, "%s", p->names[(size_t)((value - p->min_value) / sva_step(p))]);
    else if (p->type == SV_PARAM_BOOL)
        (void)snprintf(out, bytes, "%s", value != 0.0 ? "true" : "false");
    else
        sva_text(out, bytes, "%.6g", value);
}

static inline sv_status sva_refuse_fixed(sva *a, const char *call, const sva_param *p, double value,
                                         double fixed) {
    char now[64], then[64];
    sva_value_text(p, value, now, sizeof now);
    sva_value_text(p, fixed, then, sizeof then);
    return sva_blame(a, SV_ERR_PARAM_FIXED, "%s: %s is %s, activated with %s", call, p->key, now, then);
}

static inline sv_status sva_refuse_value(sva *a, const char *call, const sva_param *p, double value) {
    if (sva_left_out(p, value))
        return sva_blame(a, SV_ERR_PARAM_RANGE, "%s: %s is %g, which is none of its values", call, p->key,
                         value);
    if (p->type == SV_PARAM_FLOAT)
        return sva_blame(a, SV_ERR_PARAM_RANGE, "%s: %s is %g, expected %g to %g", call, p->key, value,
                         p->min_value, p->max_value);
    return sva_blame(a, SV_ERR_PARAM_RANGE, "%s: %s is %g, expected %g to %g in steps of %g", call, p->key,
                     value, p->min_value, p->max_value, sva_step(p));
}

/* Takes a list into a->values. `needed`: the flag that the call asks for (0: any). Values of activate are
 * refused where they differ, but by activate itself. */
static inline sv_status sva_take_values(sva *a, const char *call, const sv_param_value *list, uint32_t count,
                                        uint32_t needed) {
    if (count > 0 && !list)
        return sva_blame(a, SV_ERR_ARGUMENT, "%s: values is NULL, value_count is %u", call, (unsigned)count);
    for (uint32_t n = 0; n < count; n++) {
        const sva_param *p = sva_find(a, list[n].id);
        const double value = list[n].value;
        if (!p)
            return sva_blame(a, SV_ERR_PARAM_ID, "%s: no parameter has id %u", call, (unsigned)list[n].id);
        if (!sva_value_fits(p, value)) return sva_refuse_value(a, call, p, value);
        const size_t i = (size_t)(p - a->method->params);
        const int frozen = (p->flags & SV_PARAM_REACTIVATE) && needed != SV_PARAM_REACTIVATE;
        if (frozen && value != a->fixed[i]) return sva_refuse_fixed(a, call, p, value, a->fixed[i]);
        if (!frozen && (p->flags & needed) != needed)
            return sva_blame(a, SV_ERR_PARAM_ID, "%s: %s is not a parameter of this call", call, p->key);
        a->values[i] = value;
    }
    return SV_OK;
}

/* -------------------------------------------------------------------------------- format and frame -- */

static inline sv_status sva_check_size(sva *a, const char *what, uint32_t size, size_t minimum) {
    if (size >= minimum) return SV_OK;
    return sva_blame(a, SV_ERR_SIZE, "%s.size is %u, expected at least %u", what, (unsigned)size,
                     (unsigned)minimum);
}

/* SV_OK, or SV_ERR_FORMAT with the field and its value. */
static inline sv_status sva_check_range(sva *a, const char *field, uint64_t value, uint64_t minimum,
                                        uint64_t maximum) {
    if (value >= minimum && value <= maximum) return SV_OK;
    return sva_blame(a, SV_ERR_FORMAT, "activate: %s is %llu, expected %llu to %llu", field,
                     (unsigned long long)value, (unsigned long long)minimum, (unsigned long long)maximum);
}

/* What the descriptor offers. `planned`: a format that is to be, whose OpenCL objects may still be missing.
 */
static inline sv_status sva_check_offer(sva *a, const sv_format *f, int planned) {
    const sv_descriptor *d = a->method->descriptor;
    const int given = (f->context != NULL) + (f->device != NULL) + (f->queue != NULL);
    if (given != 0 && given != 3)
        return sva_blame(a, SV_ERR_ARGUMENT,
                         "activate: %d of context, device and queue given, expected all "
                         "or none",
                         given);
    if (!(d->queues & (given ? (uint32_t)SV_QUEUE_HOST : (uint32_t)SV_QUEUE_OWN)))
        return sva_blame(a, SV_ERR_FORMAT, "activate: queue is %s; see the descriptor's queues",
                         given ? "the host's" : "NULL");
    if (f->carrier < SV_CARRIER_HOST || f->carrier > SV_CARRIER_IMAGE)
        return sva_blame(a, SV_ERR_ARGUMENT, "activate: carrier is %u, expected 1, 2 or 3",
                         (unsigned)f->carrier);
    if (!(d->carriers & SV_BIT(f->carrier)) || (!given && !planned && f->carrier != SV_CARRIER_HOST))
        return sva_blame(a, SV_ERR_FORMAT,
                         "activate: carrier is %u; see the descriptor's carriers and queues",
                         (unsigned)f->carrier);
    if (f->voxel_type != SV_VOXEL_U8 || !(d->voxel_types & SV_BIT(SV_VOXEL_U8)))
        return sva_blame(a, SV_ERR_FORMAT, "activate: voxel_type is %u, this plugin reads SV_VOXEL_U8 (1)",
                         (unsigned)f->voxel_type);
    if (f->flags & ~(uint32_t)SV_FORMAT_SCANNED)
        return sva_blame(a, SV_ERR_ARGUMENT, "activate: flags is 0x%x, only 0x1 is known",
                         (unsigned)f->flags);
    if (f->flags && !(d->features & SV_FEATURE_SCANNED))
        return sva_blame(a, SV_ERR_FORMAT, "activate: flags is 0x1, this plugin takes no scanned ranges");
    if ((f->host_memory != NULL) != (f->host_memory_bytes > 0))
        return sva_blame(a, SV_ERR_ARGUMENT, "activate: host_memory is %s, host_memory_bytes is %llu",
                         f->host_memory ? "given" : "NULL", (unsigned long long)f->host_memory_bytes);
    return SV_OK;
}

static inline sv_status sva_check_spacing(sva *a, const float *mm) {
    const int known = mm[0] > 0.0f && mm[1] > 0.0f && mm[2] > 0.0f && mm[0] <= FLT_MAX && mm[1] <= FLT_MAX &&
                      mm[2] <= FLT_MAX;
    if (known || (mm[0] == 0.0f && mm[1] == 0.0f && mm[2] == 0.0f)) return SV_OK;
    return sva_blame(a, SV_ERR_FORMAT, "activate: spacing_mm is %g, %g, %g, expected all above 0 or all 0",
                     (double)mm[0], (double)mm[1], (double)mm[2]);
}

static inline sv_status sva_check_format(sva *a, const sv_format *f, int planned) {
    if (!f) return sva_blame(a, SV_ERR_ARGUMENT, "activate: format is NULL");
    sv_status s = sva_check_size(a, "activate: format", f->size, sizeof *f);
    if (s == SV_OK) s = sva_check_range(a, "width", f->width, 1, SVA_MAX_SIDE);
    if (s == SV_OK) s = sva_check_range(a, "height", f->height, 1, SVA_MAX_SIDE);
    if (s == SV_OK) s = sva_check_range(a, "slices", f->slices, 1, SVA_MAX_SIDE);
    if (s == SV_OK) s = sva_check_range(a, "max_slab_slices", f->max_slab_slices, 1, f->slices);
    if (s == SV_OK) s = sva_check_range(a, "tiles_x", f->tiles_x, 1, SVA_MAX_SIDE);
    if (s == SV_OK) s = sva_check_range(a, "tile_w", f->tile_w, f->width, SVA_MAX_TILE);
    if (s == SV_OK) s = sva_check_range(a, "tile_h", f->tile_h, f->height, SVA_MAX_TILE);
    if (s == SV_OK) s = sva_check_offer(a, f, planned);
    if (s == SV_OK && f->carrier != SV_CARRIER_IMAGE)
        s = sva_check_range(a, "row_pitch", f->row_pitch, (uint64_t)f->tiles_x * f->tile_w, UINT32_MAX);
    if (s == SV_OK && (f->padding_value < SV_NO_PADDING || f->padding_value > 255))
        s = sva_blame(a, SV_ERR_FORMAT, "activate: padding_value is %d, expected -1 (none) or 0 to 255",
                      (int)f->padding_value);
    return s == SV_OK ? sva_check_spacing(a, f->spacing_mm) : s;
}

static inline sv_status sva_check_frame(sva *a, const sv_frame *f) {
    if (!f) return sva_blame(a, SV_ERR_ARGUMENT, "begin: frame is NULL");
    const sv_status s = sva_check_size(a, "begin: frame", f->size, SV_FRAME_SIZE_1_0);
    char wrong[200];
    if (s != SV_OK) return s;
    const int probe = (a->method->descriptor->features & SV_FEATURE_PROBE) != 0;
    const uint32_t flags = probe ? SV_FRAME_DISCONTINUITY | SV_FRAME_SAME_VOLUME : SV_FRAME_DISCONTINUITY;
    if ((f->flags & ~flags) || f->flags == (SV_FRAME_DISCONTINUITY | SV_FRAME_SAME_VOLUME))
        return sva_blame(a, SV_ERR_ARGUMENT, "begin: flags is 0x%x, only %s known", (unsigned)f->flags,
                         probe ? "0x1 or 0x2 is" : "0x1 is");
    const int given = (f->scanned != NULL) + (f->scanned_object != NULL);
    const int expected = a->format.flags & SV_FORMAT_SCANNED ? 1 : 0;
    if (given != expected)
        return sva_blame(a, SV_ERR_ARGUMENT,
                         "begin: %d of scanned and scanned_object given, expected %d "
                         "with the format's flags 0x%x",
                         given, expected, (unsigned)a->format.flags);
    if (f->scanned_object && (!a->format.queue || f->scanned_offset % 4 != 0))
        return sva_blame(a, SV_ERR_ARGUMENT,
                         "begin: scanned_object at offset %llu: expected a multiple of 4, "
                         "and the host's queue",
                         (unsigned long long)f->scanned_offset);
    if (probe && !sv_probe_holds(f, wrong, sizeof wrong))
        return sva_blame(a, SV_ERR_ARGUMENT, "begin: %s", wrong);
    return SV_OK;
}

/* --------------------------------------------------------------------------------- slab and result -- */

/* The least bytes of a slab of n slices, as at sv_slab. */
static inline uint64_t sva_slab_bytes(const sv_format *f, uint32_t n) {
    const uint64_t r = (n - 1) / f->tiles_x, row = f->height - 1;
    const uint64_t last =
        (r * f->tile_h + row) * f->row_pitch + (uint64_t)((n - 1) % f->tiles_x) * f->tile_w + f->width;
    if (r == 0) return last;
    const uint64_t before =
        ((r - 1) * f->tile_h + row) * f->row_pitch + (uint64_t)(f->tiles_x - 1) * f->tile_w + f->width;
    return before > last ? before : last;
}

static inline sv_status sva_check_slab(sva *a, const sv_slab *slab) {
    const sv_format *f = &a->format;
    if (!slab) return sva_blame(a, SV_ERR_ARGUMENT, "slab: slab is NULL");
    const sv_status s = sva_check_size(a, "slab: slab", slab->size, sizeof *slab);
    if (s != SV_OK) return s;
    if (slab->first_slice != a->next_slice)
        return sva_blame(a, SV_ERR_SLAB_ORDER, "slab: first_slice is %u, expected %u",
                         (unsigned)slab->first_slice, (unsigned)a->next_slice);
    const uint32_t left = f->slices - a->next_slice;
    const uint32_t maximum = left < f->max_slab_slices ? left : f->max_slab_slices;
    if (slab->slice_count < 1 || slab->slice_count > maximum)
        return sva_blame(a, SV_ERR_SLAB_SHAPE, "slab: slice_count is %u, expected 1 to %u",
                         (unsigned)slab->slice_count, (unsigned)maximum);
    const int host = f->carrier == SV_CARRIER_HOST;
    if ((slab->memory != NULL) != host || (slab->object != NULL) == host)
        return sva_blame(a, SV_ERR_SLAB_SHAPE, "slab: memory is %s and object is %s, the carrier is %u",
                         slab->memory ? "given" : "NULL", slab->object ? "given" : "NULL",
                         (unsigned)f->carrier);
    if (f->carrier == SV_CARRIER_IMAGE) return SV_OK;
    const uint64_t minimum = sva_slab_bytes(f, slab->slice_count);
    if (slab->bytes >= minimum) return SV_OK;
    return sva_blame(a, SV_ERR_SLAB_SHAPE, "slab: bytes is %llu, %u slices need %llu",
                     (unsigned long long)slab->bytes, (unsigned)slab->slice_count,
                     (unsigned long long)minimum);
}

/* 1 unless the slab lies outside of the memory that the format registered. A host must not do that; a plugin
 * need not notice. */
static inline int sva_in_host_memory(const sv_format *f, const sv_slab *slab) {
    const char *from = (const char *)f->host_memory, *memory = (const char *)slab->memory;
    return !from || !memory ||
           (memory >= from && memory <= from + f->host_memory_bytes &&
            slab->bytes <= (uint64_t)(from + f->host_memory_bytes - memory));
}

static inline sv_status sva_check_result(sva *a, const char *call, const sv_result *r) {
    if (!r) return sva_blame(a, SV_ERR_ARGUMENT, "%s: result is NULL", call);
    sv_status s = sva_check_size(a, "result", r->size, sizeof *r);
    if (s == SV_OK && r->stats) s = sva_check_size(a, "result.stats", r->stats->size, sizeof *r->stats);
    if (s != SV_OK) return s;
    if ((r->depth != NULL) == (r->depth_object != NULL))
        return sva_blame(a, SV_ERR_ARGUMENT, "%s: %s of depth and depth_object given, expected one", call,
                         r->depth ? "both" : "neither");
    if (r->depth_object && (!a->format.queue || r->depth_offset % 4 != 0))
        return sva_blame(a, SV_ERR_ARGUMENT,
                         "%s: depth_object at depth_offset %llu: expected a multiple of "
                         "4, and the host's queue",
                         call, (unsigned long long)r->depth_offset);
    if (r->depth_pitch && (r->depth_pitch % 4 != 0 || r->depth_pitch / 4 < a->format.width))
        return sva_blame(a, SV_ERR_ARGUMENT,
                         "%s: depth_pitch is %u, expected 0 or a multiple of 4 of at "
                         "least %u",
                         call, (unsigned)r->depth_pitch, (unsigned)(a->format.width * 4));
    return SV_OK;
}

static inline sv_status sva_check_end(sva *a, const sv_result *r) {
    if (a->next_slice == a->format.slices) return sva_check_result(a, "end", r);
    return sva_blame(a, SV_ERR_SLAB_MISSING, "end: %u of %u slices came", (unsigned)a->next_slice,
                     (unsigned)a->format.slices);
}

/* ---------------------------------------------------------------------------------- one call at a time -- */

static inline sva *sva_enter(const sv_plugin *plugin) {
    sva *a = (sva *)plugin->plugin_data;
    a->reason[0] = '\0';
    return a;
}

/* A call from any thread only logs. */
SVA_PRINTF(3, 4)
static inline sv_status sva_tell(const sva *a, sv_status status, const char *format, ...) {
    char text[256];
    va_list args;
    va_start(args, format);
    sva_print(text, sizeof text, format, args);
    va_end(args);
    sva_log(a, SV_LOG_HOST_MISBEHAVING, text);
    return status;
}

#if defined(_MSC_VER) && !defined(__clang__)
long _InterlockedCompareExchange(long volatile *word, long to, long from); /* that compiler's own */
#endif

/* Of a word that several threads change: to `to` if it is `from`. False: it is not. */
/* NOLINTNEXTLINE(readability-non-const-parameter): clang-tidy does not see that the builtin writes. */
static inline int sva_change(long *word, long from, long to) {
#if defined(_MSC_VER) && !defined(__clang__)
    return _InterlockedCompareExchange((volatile long *)word, to, from) == from;
#else
    return __atomic_compare_exchange_n(word, &from, to, 0, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
#endif
}

/* Before a [control] or [frame] call, of which the host lets no two overlap. NULL: it did; nothing may be
 * touched, and the call is SV_ERR_STATE. */
static inline sva *sva_take(const sv_plugin *plugin, const char *call) {
    sva *a = (sva *)plugin->plugin_data;
    if (sva_change(&a->busy, 0, 1)) return sva_enter(plugin);
    (void)sva_tell(a, SV_ERR_STATE, "%s: comes while another call of this instance is under way", call);
    return NULL;
}

SMARTVIS_END_C

#endif
