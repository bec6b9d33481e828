/* SPDX-License-Identifier: MIT */
/*
 * What a plugin's author writes, and what a method may call: the types of smartvis/author.h.
 */
#ifndef SMARTVIS_AUTHOR_METHOD_H
#define SMARTVIS_AUTHOR_METHOD_H

#include "smartvis_plugin.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

SMARTVIS_BEGIN_C

typedef struct sva sva;

/* One parameter, as sv_param_info; id, key, label, unit and help are needed. */
typedef struct sva_param {
    uint32_t id;    /* not 0, unique */
    uint32_t type;  /* SV_PARAM_FLOAT .. SV_PARAM_ENUM */
    uint32_t flags; /* SV_PARAM_PRIMARY | ... */
    const char *key, *label, *unit, *help;
    double min_value, max_value, default_value;
    double step;                     /* 0: 1 for int, bool and enum, none for float */
    double display_min, display_max; /* both 0: the hard range */
    const char *group;               /* NULL: none */
    const char *const *names; /* an enum's values, (max_value - min_value) / step + 1 of them, NULL for one
                               * that it leaves out; or NULL */
    uint32_t depends_on;      /* id of another parameter, or 0 */
    uint64_t depends_values;
} sva_param;

/* A parameter of no group that depends on nothing. */
#define SVA_PARAM(id, type, flags, key, label, unit, help, minimum, maximum, standard, step)                 \
    { id, type, flags, key, label, unit, help, minimum, maximum, standard, step, 0.0, 0.0, NULL, NULL, 0, 0 }

/* A depth for pixels without a surface. The helper makes it 0, which clips nothing, and counts it. */
#define SVA_NO_DEPTH (-FLT_MAX)

/*
 * A plugin, constant. Functions that are NULL are not called; only `finish` is needed. They return SV_OK, or
 * sva_error(...) with a reason.
 */
typedef struct sva_method {
    const sv_descriptor *descriptor;
    const sva_param *params;
    uint32_t param_count;
    size_t own_bytes; /* of the author's own struct: sva.own, all zero after create; 0: sva.own is NULL */
    size_t ray_bytes; /* of what is kept for a ray: sva.rays, all zero at begin; 0: sva.rays is NULL */

    /* a->format is valid and within what the descriptor offers. If it fails, deactivate is called. */
    sv_status (*activate)(sva *a);

    /* Frees what activate made, or a part of it. */
    void (*deactivate)(sva *a);

    /* A volume starts: a->frame, a->scanned and sva_value are the new ones. */
    sv_status (*begin)(sva *a);

    /* A slab has come, in order and whole. Kernels are enqueued here. */
    sv_status (*slab)(sva *a, const sv_slab *slab);

    /* All slabs are there: fills `depth`, width * height values without a gap, and if it likes a->points (the
     * status map, all SV_POINT_NONE so far). What is written behind these, or a->rays, fails the frame.
     * Returns SV_OK: the outcome follows from how many depths are SVA_NO_DEPTH. Or SV_NO_SURFACE: the map is
     * zeroed. With `output`, depth is NULL. */
    sv_status (*finish)(sva *a, float *depth);

    /* The frame of the last finish again with other values, from what finish kept in a->own: the voxels may
     * be gone. Needed if a parameter is flagged SV_PARAM_ADJUST; else the results are given out again. */
    sv_status (*adjust)(sva *a, float *depth);

    /* Gives the results out itself, after finish and after adjust: for results that lie on a device. The
     * result has been checked, except that objects are buffers. Returns what end returns. */
    sv_status (*output)(sva *a, const sv_result *result);

    /* Answers get_extension, from any thread. */
    const void *(*extension)(const sva *a, const char *id);

    /* A frame under way ends without a map, by an error or another begin; or adjust failed. With an own queue
     * it waits for commands that use the host's memory: after this the host may use it again. */
    void (*abandon)(sva *a);

    /* sv_param_info.depends_values where the table cannot know it, from any thread. */
    uint64_t (*depends_values)(const sva_param *param);
} sva_method;

/* The descriptor of a plugin on the CPU without extensions; features: SV_FEATURE_*. */
#define SVA_DESCRIPTOR(id, name, vendor, version, summary, features)                                         \
    SVA_DESCRIPTOR_OF(id, name, vendor, version, summary, features, SV_BIT(SV_CARRIER_HOST), SV_QUEUE_OWN)

/* SVA_DESCRIPTOR with the bits of its carriers and queues. */
#define SVA_DESCRIPTOR_OF(id, name, vendor, version, summary, features, carriers, queues)                    \
    {                                                                                                        \
        (uint32_t)sizeof(sv_descriptor), carriers, id, name, vendor, version, summary, SV_BIT(SV_VOXEL_U8),  \
            queues, features, 0, sva_no_extensions                                                           \
    }
static const char *const sva_no_extensions[] = {NULL};

enum { SVA_INACTIVE = 0, SVA_IDLE, SVA_SLABS, SVA_FINISHED };

/* One instance. A method reads all of it and writes `own`, `depth` and `points`. */
struct sva {
    sv_plugin api;
    const sva_method *method;
    const sv_host *host;
    void *own;
    void *rays;       /* without `output`: ray_bytes for every ray, row by row, until the next begin */
    sv_format format; /* since activate, its values left out; the spacing is never 0 */
    int32_t padding;  /* the voxel value that was not scanned, or SV_NO_PADDING */
    sv_frame frame;   /* since begin, its values left out; zeros for what an older host does not say */
    const sv_scanned *scanned; /* the ranges in host memory, or NULL */
    const uint8_t **slice;     /* SV_CARRIER_HOST without `output`: voxel (0, 0) of every slice that has come,
                                * until end */
    float *depth;              /* without `output`: width * height */
    uint8_t *points;           /* the same: SV_POINT_* of every ray */
    sv_stats stats;            /* the same: of the last finish or adjust */
    double *values;            /* what sva_value reads, in the table's order */
    double *framed;            /* of the frame */
    double *fixed;             /* of activate */
    uint32_t next_slice;
    uint32_t state; /* SVA_INACTIVE .. SVA_FINISHED */
    char reason[512];
    int doubted; /* 1: the log was told that its lengths are those of no scan */
    long busy;   /* 1: a call is under way, 2: and then the instance is destroyed */
};

/* ----------------------------------------------------------------------------- what a method may call -- */

/* The value of parameter `id` in this frame (in activate: at activate); 0 if there is none. */
static inline double sva_value(const sva *a, uint32_t id) {
    for (uint32_t i = 0; i < a->method->param_count; i++)
        if (a->method->params[i].id == id) return a->values[i];
    return 0.0;
}

/* Number of rays, width * height. */
static inline size_t sva_rays(const sva *a) {
    return (size_t)a->format.width * a->format.height;
}

/* Voxel (x, y) of slice z, which must have come, in host memory. */
static inline uint8_t sva_voxel(const sva *a, uint32_t x, uint32_t y, uint32_t z) {
    return a->slice[z][(size_t)y * a->format.row_pitch + x];
}

/* 1 if voxel (x, y, z), which holds `voxel`, was scanned, else 0. */
static inline int sva_scanned(const sva *a, uint32_t x, uint32_t y, uint32_t z, uint8_t voxel) {
    if (voxel == a->padding) return 0;
    if (!a->scanned) return 1;
    const sv_scanned range = a->scanned[(size_t)y * a->format.width + x];
    return z >= range.first && z < range.end;
}

/* Byte of voxel (x, y) of a slab's slice s from the texture's first byte. */
static inline size_t sva_byte(const sv_format *f, uint32_t x, uint32_t y, uint32_t s) {
    return ((size_t)(s / f->tiles_x) * f->tile_h + y) * f->row_pitch + (size_t)(s % f->tiles_x) * f->tile_w +
           x;
}

#if defined(__MINGW_PRINTF_FORMAT) /* that compiler's printf knows %zu only so */
#define SVA_PRINTF(text, first) __attribute__((format(__MINGW_PRINTF_FORMAT, text, first)))
#elif defined(__GNUC__)
#define SVA_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define SVA_PRINTF(text, first)
#endif

/* Tells the host's log. Any thread. */
static inline void sva_log(const sva *a, int32_t severity, const char *text) {
    if (a->host && a->host->log) a->host->log(a->host, severity, text);
}

/* printf with a decimal point in the host's locale, too, which may have a comma: what a program reads must
 * not depend on it. `text` must not have one between two digits by itself ("1,2"). */
SVA_PRINTF(3, 0)
static inline void sva_print(char *text, size_t bytes, const char *format, va_list args) {
    char half[16];
    (void)vsnprintf(text, bytes, format, args);
    (void)snprintf(half, sizeof half, "%.1f", 0.5);
    const size_t mark = strlen(half) - 2; /* of the locale's point, which may have more than one byte */
    if (half[1] == '.' || bytes == 0) return;
    for (char *at = text; *at; at++)
        if (at[0] >= '0' && at[0] <= '9' && strncmp(at + 1, half + 1, mark) == 0 && at[1 + mark] >= '0' &&
            at[1 + mark] <= '9') {
            at[1] = '.';
            memmove(at + 2, at + 1 + mark, strlen(at + 1 + mark) + 1);
        }
}

/* Keeps the reason for last_error, tells the log, and returns `status`. */
SVA_PRINTF(3, 0)
static inline sv_status sva_report(sva *a, int32_t severity, const char *format, va_list args,
                                   sv_status status) {
    sva_print(a->reason, sizeof a->reason, format, args);
    sva_log(a, severity, a->reason);
    return status;
}

/* Tells the host's log one line, without an error. */
SVA_PRINTF(3, 4) static inline void sva_say(const sva *a, int32_t severity, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    sva_print(text, sizeof text, format, args);
    va_end(args);
    sva_log(a, severity, text);
}

/* A method's error with its reason: `return sva_error(a, SV_ERR_NO_MEMORY, "...", ...)`. */
SVA_PRINTF(3, 4) static inline sv_status sva_error(sva *a, sv_status status, const char *format, ...) {
    va_list args;
    va_start(args, format);
    status = sva_report(a, status < 0 ? SV_LOG_ERROR : SV_LOG_DEBUG, format, args, status);
    va_end(args);
    return status;
}

/* Reports and returns an error, as sva_error does, where the host broke a rule of the header. */
SVA_PRINTF(3, 4) static inline sv_status sva_blame(sva *a, sv_status status, const char *format, ...) {
    va_list args;
    va_start(args, format);
    status = sva_report(a, SV_LOG_HOST_MISBEHAVING, format, args, status);
    va_end(args);
    return status;
}

/* The same where the method itself broke one. */
SVA_PRINTF(3, 4) static inline sv_status sva_accuse(sva *a, sv_status status, const char *format, ...) {
    va_list args;
    va_start(args, format);
    status = sva_report(a, SV_LOG_PLUGIN_MISBEHAVING, format, args, status);
    va_end(args);
    return status;
}

SMARTVIS_END_C

#endif
