/* SPDX-License-Identifier: MIT */
/* How checks drive a plugin: the run, the library, its parameters, a device, volumes, stages and frames. */
#ifndef V_DRIVE_H
#define V_DRIVE_H

#include "rules/rules.h"
#include "smartvis_plugin.h"
#include "stage/stage.h"
#include "validate/spy/cl_spy.h"

#include <CL/cl.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ------------------------------------------------------------------------------------------------- run -- */
/* One check under way: what it was asked for, and what it reports. */

typedef enum {
    V_PASS,
    V_WARN, /* it holds, and something is not as it should be */
    V_SKIP, /* not tried: the text says why */
    V_FAIL,
    V_CRASH, /* the process ended before the check did */
    V_TIMEOUT
} v_verdict;

/* What a check leaves behind. It lies in memory that the validator shares with the check's process, so it is
 * still there when that has crashed. */
typedef struct {
    v_verdict verdict;
    bool finished;
    bool on_device;            /* the check has opened the OpenCL device */
    bool no_device;            /* it needed one, and there is none: says nothing about the plugin */
    char text[700];            /* what was found; "" if there is nothing to say */
    char where[200];           /* the call that is under way */
    char values[400];          /* of the frame that it belongs to: "q = 0.5, level = 0"; "" for no frame */
    _Atomic uint64_t since_ns; /* when it began, if it belongs to a frame; else 0 */
    _Atomic bool warm;         /* no call of a frame compiles any more: each must come back soon */
    spy_work opencl;           /* what that does; a kernel that runs must end soon at any time */
    char line[200];            /* the last that the plugin has logged */
} v_report;

typedef struct v_watch v_watch;
typedef struct v_rig v_rig;

typedef struct {
    const char *path; /* of the library */
    const char *id;   /* of the plugin; NULL: the library's first */
    uint64_t seed;
    uint32_t level; /* 1 .. 10: how much is tried */
    bool verbose;   /* what the plugin logs goes to standard error */
    v_report *report;
    v_watch *watch;                /* what is looked at around every call; NULL: nothing */
    uint64_t random;               /* state of v_random */
    jmp_buf escape;                /* where v_fail and v_skip go */
    v_rig *rig;                    /* that the check has open; NULL: none */
    const struct v_params *params; /* that have been read; NULL: none */
} v_run;

/* Notes the finding and ends the check. */
_Noreturn void v_fail(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));
_Noreturn void v_skip(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The check needs an OpenCL device and has none: the run ends, with this reason. */
_Noreturn void v_no_device(v_run *run, const char *why);

/* A judge tells the check: it fails by what is wrong. */
rule_sink v_sink(v_run *run);

/* Notes the finding, the first one only, and goes on. */
void v_warn(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Says what a passed check has tried. */
void v_note(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Fails unless `holds`. */
#define V_EXPECT(run, holds, ...)                                                                            \
    do {                                                                                                     \
        if (!(holds)) v_fail(run, __VA_ARGS__);                                                              \
    } while (0)

/* The call that comes next: what a crash or a hang is told with. */
void v_where(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same for a call of a frame, which must come back soon; its values are in report->values. */
void v_where_frame(v_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The process as it is now, for run->watch: v_where then looks first whether it still is, and the check fails
 * with the call before. NULL: no memory for a file. One at a time. */
v_watch *v_watch_begin(void);

/* What of the host's has changed, in words, or NULL. A descriptor that is new may be the plugin's own. */
const char *v_watch_change(const v_watch *watch);

/* Random numbers from the seed and the check's name: the same for the same command. */
void v_random_begin(v_run *run, const char *name);
uint32_t v_random(v_run *run, uint32_t below); /* 0 .. below - 1; `below` at least 1 */
double v_random_unit(v_run *run);              /* 0 .. 1, both ends possible */

/* `bytes` of memory, all zero, until v_memory_end. Fails the check if there are none. */
void *v_memory(v_run *run, size_t bytes);
void v_memory_end(void);

/* --------------------------------------------------------------------------------------------- subject -- */
/* The library under test with one instance of its plugin, and the host that it sees. */

/* The host that a plugin is given. It keeps the last line of the log, and notes what a plugin must not do. */
typedef struct {
    sv_host api;
    v_run *run;
    pthread_mutex_t lock;
    uint32_t lines;
    uint64_t bytes;   /* of all lines */
    int32_t severity; /* of the last line */
    char line[512];
    char fault[256]; /* the first rule that a call to the host broke; "" */
} v_host;

typedef struct {
    v_run *run;
    void *library;
    const sv_entry *entry;
    const sv_descriptor *descriptor; /* of the plugin that was asked for */
    const sv_plugin *plugin;
    v_host host; /* must not move */
} v_subject;

/* dlopen and the entry; fails if it cannot be loaded or the entry cannot be used. Names no descriptor. */
void v_load(v_run *run, v_subject *s);

/* The same and an instance, whole enough to be called. `bare`: the host has no log and no extensions. */
void v_open(v_run *run, v_subject *s);
void v_open_bare(v_run *run, v_subject *s);

/* Another instance of the plugin, of the same host. */
const sv_plugin *v_another(v_subject *s);

/* Calls destroy and dlclose. */
void v_close(v_subject *s);

/* A status with its name, "SV_ERR_STATE (-20)", in one of a few buffers that are used in turn. */
const char *v_status(sv_status status);

/* ------------------------------------------------------------------------------------------ parameters -- */
/* A plugin's parameters as checks use them: what it reports, bounded, and values to try. */

#define V_MAX_PARAMS 256u

typedef struct v_params {
    uint32_t count;
    sv_param_info info[V_MAX_PARAMS];
} v_params;

/* The parameters that describe themselves well enough to be used; what else is wrong with them, the checks of
 * parameters find. */
void v_params_read(v_subject *s, v_params *params);

/* Number of values of an int, bool or enum; 0 for a float, or if they are more than 10^6. */
uint32_t v_param_values(const sv_param_info *info);

/* False for a value that an enum leaves out between others: param_text says so, and every call that is given
 * it must refuse it. */
bool v_param_has(const v_subject *s, const sv_param_info *info, double value);

/* All values of the parameter where there are `most` (3 or more) at most; else the ends and the middle.
 * Returns how many. */
uint32_t v_param_choice(const v_subject *s, const sv_param_info *info, double *out, uint32_t most);

/* A value of the parameter: anywhere in the hard range, an end now and then. */
double v_param_random(const v_subject *s, const sv_param_info *info);

/* A value that is not the default, or the default if there is no other. */
double v_param_other(const sv_param_info *info);

/* ---------------------------------------------------------------------------------------------- device -- */
/* The device that smartvis/device.h finds; v_no_device if there is none. */
void v_device_open(v_run *run, stage_device *d);
void v_device_close(stage_device *d);

/* --------------------------------------------------------------------------------------------- volumes -- */
/* Volumes to try a plugin on. */

typedef enum {
    V_LAYERS, /* skin, fluid and fetus, with noise: a frame that has a surface */
    V_OTHER,  /* the same with the fluid elsewhere */
    V_BLACK,
    V_WHITE,
    V_GREY,
    V_NOISE,
    V_STRIPES, /* 0 and 255 in turn along the ray */
    V_KINDS
} v_kind;

typedef struct {
    uint32_t width, height, slices;
    uint8_t *voxels;    /* x runs fastest, then y, then z */
    sv_scanned *ranges; /* of every ray: all of the volume */
} v_volume;

/* Fills a volume by the run's random numbers. */
void v_volume_make(v_run *run, v_volume *v, v_kind kind, uint32_t width, uint32_t height, uint32_t slices);

/* Ranges that cut a few slices off either end, other ones on every ray. */
void v_volume_narrow(v_volume *v);

/* Every voxel outside its ray's range becomes `value`; -1: noise. */
void v_volume_outside(v_run *run, v_volume *v, int value);

const char *v_kind_name(v_kind kind);

/* ------------------------------------------------------------------------------------------------ ways -- */
/* Host memory, three slabs, three tiles a row with some padding around, and ranges if the plugin takes them.
 * The host's queue if the plugin takes that, else its own. */
stage_way v_standard_way(const v_subject *s);

/* Another size, in as many slabs as before. */
stage_way v_sized(stage_way way, uint32_t width, uint32_t height, uint32_t slices);

/* stage_make and stage_fill that skip the check if OpenCL refuses an object, and fail it without memory. */
void v_stage_make(v_run *run, stage *st, const stage_way *way, const stage_device *device);
void v_stage_fill(stage *st, const v_volume *v);

/* ---------------------------------------------------------------------------------------------- frames -- */
/* Frames: the calls one by one or all together, and what came out. */

/* A frame's results without pitch and guards. */
typedef struct {
    uint32_t width, height;
    float *depth;
    uint8_t *status;
    sv_stats stats;
    sv_status returned; /* by end or adjust */
    sv_status outcome;  /* `returned`, or with the host's queue and a success what the statistics say */
} v_map;

/* The depths, as rule_depths judges them. */
void v_map_check_depths(v_run *run, const v_map *map, uint32_t slices, const char *what);

/* Says where two maps differ, in one of a few texts that are used in turn, or NULL if depths (to the bit),
 * status maps and outcome are the same. */
const char *v_map_difference(const v_map *a, const v_map *b);

/* The check fails with this text and where the maps differ, unless they are the same. */
void v_map_expect(v_run *run, const v_map *wanted, const v_map *map, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* activate; the check fails on an error. */
void v_activate(v_subject *s, const sv_plugin *p, const stage *st);
void v_deactivate(v_subject *s, const sv_plugin *p);

/* Single calls: what they return. end and adjust poison the results before; with the host's queue they are
 * there after v_collect, which waits for it. */
sv_status v_begin(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count);
sv_status v_slab(const sv_plugin *p, stage *st, uint32_t n);
sv_status v_end(const sv_plugin *p, stage *st);
sv_status v_adjust(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count);
v_map v_collect(stage *st, sv_status returned);

/* begin and all slabs: the first error, or SV_OK. */
sv_status v_feed(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count);

/* begin, all slabs, end. Returns the first error, or what end returned; the results are collected then. */
sv_status v_try_frame(const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count,
                      v_map *out);

/* v_try_frame; the check fails on an error. */
v_map v_frame(v_subject *s, const sv_plugin *p, stage *st, const sv_param_value *values, uint32_t count);

/* The subject's own instance, activated, with a layered volume in its stage. The device is open if the way
 * needs one. A check has one rig at most. */
struct v_rig {
    v_subject s;
    stage_device device;
    stage stage;
    v_volume volume;
    v_map good; /* of v_rig_good */
};
v_rig *v_rig_open(v_run *run);                               /* loads, creates; no stage yet */
v_rig *v_rig_open_bare(v_run *run);                          /* the same of v_open_bare */
void v_rig_set(v_rig *r, const stage_way *way, v_kind kind); /* drops; stage and volume; activates */
void v_rig_again(v_rig *r, const stage_way *way); /* another stage for the same volume; activates */
void v_rig_fill(v_rig *r, v_kind kind);           /* another volume for the same stage */
void v_rig_drop(v_rig *r);                        /* deactivates; the stage is gone */

/* All that is open; the validator calls it behind every check that came to its end. NULL: nothing is. */
void v_rig_close(v_rig *r);

/* All in one: opens, the standard way, a layered volume, activated; and a frame of it, which is kept. */
v_rig *v_rig_standard(v_run *run);
v_rig *v_rig_good(v_run *run);

/* v_frame of the rig. */
v_map v_rig_frame(v_rig *r, const sv_param_value *values, uint32_t count);

/* A frame without values comes, and its map is this one: else the check fails with the text. */
void v_rig_expect(v_rig *r, const v_map *wanted, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
