/* SPDX-License-Identifier: MIT */
/* Frames: the calls one by one or all together, and what came out. */
#ifndef DRIVE_FRAME_H
#define DRIVE_FRAME_H

#include "validate/drive/drive_stage.h"

/* A frame's results without pitch and guards. */
typedef struct {
    uint32_t width, height;
    float *depth;
    uint8_t *status;
    sv_stats stats;
    sv_status returned; /* by end or adjust */
    sv_status outcome;  /* `returned`, or with the host's queue and a success what the statistics say */
} v_map;

void v_map_free(v_map *map);

/* Says where two maps differ, in one of a few texts that are used in turn, or NULL if depths (to the bit),
 * status maps and outcome are the same. */
const char *v_map_difference(const v_map *a, const v_map *b);

/* The check fails with this text and where the maps differ, unless they are the same. Frees `map`. */
void v_map_expect(v_run *run, const v_map *wanted, v_map *map, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* activate; the check fails on an error. */
void v_activate(v_subject *s, const sv_plugin *p, const v_stage *st);
void v_deactivate(v_subject *s, const sv_plugin *p);

/* Single calls: what they return. end and adjust poison the results before; with the host's queue they are
 * there after v_collect, which waits for it. */
sv_status v_begin(const sv_plugin *p, v_stage *st, const sv_param_value *values, uint32_t count);
sv_status v_slab(const sv_plugin *p, v_stage *st, uint32_t n);
sv_status v_end(const sv_plugin *p, v_stage *st);
sv_status v_adjust(const sv_plugin *p, v_stage *st, const sv_param_value *values, uint32_t count);
void v_collect(v_stage *st, sv_status returned, v_map *out);

/* begin, all slabs, end. Returns the first error, or what end returned; the results are collected then. */
sv_status v_try_frame(const sv_plugin *p, v_stage *st, const sv_param_value *values, uint32_t count,
                      v_map *out);

/* The same; the check fails on an error. */
void v_frame(v_subject *s, const sv_plugin *p, v_stage *st, const sv_param_value *values, uint32_t count,
             v_map *out);

/* The subject's own instance, activated, with a layered volume in its stage. The device is open if the way
 * needs one. */
typedef struct {
    v_subject s;
    v_device device;
    v_stage stage;
    v_volume volume;
} v_rig;
void v_rig_open(v_run *run, v_rig *r);                   /* loads, creates; no stage yet */
void v_rig_set(v_rig *r, const v_way *way, v_kind kind); /* stage and volume; activates */
void v_rig_again(v_rig *r, const v_way *way);            /* another stage for the same volume; activates */
void v_rig_drop(v_rig *r);                               /* deactivates; stage and volume are gone */
void v_rig_close(v_rig *r);

/* All in one: opens, the standard way, a layered volume, activated. */
void v_rig_standard(v_run *run, v_rig *r);

#endif
