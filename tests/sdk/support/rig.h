/* SPDX-License-Identifier: MIT */
/* A plugin under test, driven through the ABI alone: any format, carrier and split into slabs. */
#pragma once

#include "plugin/capabilities.h"
#include "ref/ref_mean.h"
#include "ref/ref_points.h"
#include "smartvis_plugin.h"
#include "stage/stage.h"
#include "support/unit.h"
#include "sv_beams.h"

#include <CL/cl.h>

/* --- rig_expect.c: what a plugin under test should give by the definition, and volumes to try it on. */

typedef struct {
    double fluid_threshold, omega;
    sv_ref_bone bone;
    uint32_t k, substeps;
    float q;
    double evidence, min_gap; /* the default here is 0: a surface however little speaks for a gap */
} rig_settings;
rig_settings rig_default_settings(void);

typedef struct {
    uint8_t *status;
    float *depth;         /* fixed point: what the kernels must give to the bit */
    double *depth_double; /* float64 definition */
    uint32_t points, empty_points, sure_points, level, maximum;
    sv_ref_fill fill;
    sv_status outcome;
    sv_fixed format;
} rig_expected;
/* The same frame by the scalar definition: fixed point, and float64 if `with_double` is true.
 * Arrays of width * height. */
rig_expected rig_expect(const sv_ref_volume *volume, const rig_settings *settings, bool with_double);

/* A seeded volume of the given kind. */
typedef enum {
    RIG_NOISE,    /* any value anywhere */
    RIG_EXTREMES, /* values at 0, 255 and within one level of T_L */
    RIG_LAYERS,   /* tissue, fluid, bone: like a scan */
    RIG_SPARSE,   /* mostly fluid, few bones: the filter needs many passes */
    RIG_KIND_COUNT
} rig_kind;
uint8_t *rig_volume(rig_kind kind, uint32_t width, uint32_t height, uint32_t slices, uint32_t seed);

/* A volume whose rays have the given fluid intervals, so that a test can state a map and not a volume: ray i
 * is tissue up to slice near_end[i], fluid up to far_end[i] and bone (255) there; far_end 0: bone at slice 0,
 * an empty interval; far_end < 0: fluid all along, no initial point. */
uint8_t *rig_map_volume(const int32_t *near_end, const int32_t *far_end, uint32_t width, uint32_t height,
                        uint32_t slices);

/* --- rig.c */

typedef struct {
    void *library;
    const sv_entry *entry;
    const sv_plugin *plugin;
    sv_host host;
    cl_context context; /* the host's OpenCL objects, made by rig_open */
    cl_device_id device;
    cl_command_queue queue;
    char last_log[1024]; /* the last line the plugin logged, and its severity */
    int32_t last_severity;
    unsigned log_lines;
    char all_logs[16384]; /* the first lines, as far as they fit */
} rig;

enum { RIG_MAX_FIXED = 8 };

/* One way of handing a volume over. Zeroed fields take the plain default. */
typedef struct {
    uint32_t width, height, slices;
    uint32_t slab_slices;    /* longest slab; 0: all slices */
    const uint32_t *lengths; /* lengths of the slabs, ending with 0; NULL: slab_slices each, the last short */
    uint32_t tiles_x;        /* 0: 4 */
    uint32_t extra_w, extra_h, extra_pitch; /* tile and pitch padding */
    uint32_t carrier;                       /* 0: SV_CARRIER_HOST; images become buffers if there are none */
    bool own_queue;                         /* the plugin picks its device */
    bool in_place;                          /* register the slab memory at activation */
    float voxel_mm;                         /* edge of a voxel; 0: not told */
    int32_t padding;                        /* 0 is a value: SV_NO_PADDING for none */
    const sv_scanned *scanned;              /* of every ray; NULL: the frames bring none */
    bool scanned_in_buffer;                 /* hands them over in an OpenCL buffer */
    sv_param_value fixed[RIG_MAX_FIXED];    /* for activate, up to an id of 0; by default method is mean */
} rig_format;

typedef struct {
    float *depth;
    uint8_t *status;
    sv_stats stats;
    sv_points_report points; /* size 0: the plugin does not tell */
} rig_result;

/* Loads SV_BUILD_DIR/smartvis.so (or `path`) and creates its first plugin. If it
 * cannot, the test program fails. */
void rig_open(rig *r, const char *path);
void rig_close(rig *r);

/* A buffer of the host's context; and one of the same device in another context, which no call may take. */
cl_mem rig_buffer(const rig *r, size_t bytes);
cl_mem rig_foreign_buffer(const rig *r, size_t bytes);
/* The test gives the object back. */
cl_mem rig_keep(cl_mem object);

/* Whether the device is a CPU: it reads the host's memory in place and computes in wide vectors. */
bool rig_is_cpu(const rig *r);

/* cmocka fixture: *state is a rig, a new one for each test. */
int rig_setup(void **state);
int rig_teardown(void **state);
#define RIG_TEST(function) cmocka_unit_test_setup_teardown(function, rig_setup, rig_teardown)

/* A stage of the format with this volume in it: frames without flags. Everything that is padding (of tiles,
 * of the pitch, unused tiles) holds 255, the worst it could. The test's (support/unit.h), as all that is made
 * here. */
stage *rig_stage(const rig *r, const rig_format *f, const uint8_t *volume);

/* Frames tell these beams from now on. */
void rig_tell(stage *st, const sv_beams *beams);

/* begin, all slabs, end and, with the host's queue, clFinish. Returns the first status that is not SV_OK,
 * else the outcome in the statistics. The instance must be active with this format. */
sv_status rig_frame(rig *r, const stage *st, const sv_param_value *values, uint32_t count, rig_result *out);

/* activate, one frame, deactivate; returns the first status that is not SV_OK, else that of rig_frame. */
sv_status rig_run(rig *r, const rig_format *f, const uint8_t *volume, const sv_param_value *values,
                  uint32_t count, rig_result *out);

rig_result rig_result_make(uint32_t width, uint32_t height);

/* Settings as parameter values for a frame (by key); returns their number (at most RIG_MAX_VALUES). */
enum { RIG_MAX_VALUES = 12 };
uint32_t rig_values(const rig *r, const rig_settings *settings, sv_param_value *values);
/* Id of the parameter with this key; fails the test if there is none. */
uint32_t rig_param(const rig *r, const char *key);
double rig_param_default(const rig *r, const char *key);

/* The values of others with which a parameter matters to a method, into `out`. Returns how many; -1: it does
 * not matter to that. */
enum { RIG_MAX_ENABLE = 2 };
int rig_enable(const rig *r, const sv_param_info *param, double method, sv_param_value *out);

/* The value of an enum parameter by its name. Fails the test program if there is none. */
double rig_enum(const rig *r, const char *key, const char *name);
