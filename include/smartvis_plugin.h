/* SPDX-License-Identifier: MIT */
/*
 * SmartVis plugin ABI, version 1.0: occlusion removal for 3D ultrasound.
 *
 * This header is all a host or a plugin author needs. It includes <stdint.h> and <stddef.h> only, and
 * compiles as C99 to C23 and C++11 to C++20.
 *
 *   host                                                        plugin
 *   ----                                                        ------
 *   dlopen, read smartvis_plugin_entry.abi_major  ------------>  (no plugin code has run yet)
 *   entry.create(host, id)                        ------------>  a whole instance, or an error
 *     activate(format)                            ------------>  allocates, compiles, warms up, tests itself
 *       begin(frame)                              ------------>  \
 *       slab(slab 0) .. slab(slab n-1)            ------------>   > one volume: enqueues work, nothing else
 *       end(result)                               ------------>  /
 *       adjust(values, result)  (optional)        ------------>  the same volume with the knob turned
 *     deactivate                                  ------------>  frees what activate made
 *   destroy                                       ------------>  gone
 *
 * WHAT IT COMPUTES. For every viewing ray the depth at which the host's renderer may start, so that the
 * fetus is seen and nothing hides it: the *clipping depthmap* (thesis 3.2 to 3.4).
 *
 * AXES. The volume is camera-aligned and the camera is orthographic: a viewing ray is one column (x, y),
 * walked in +z.
 *
 *            viewer                         x  to the right, 0 .. width - 1
 *              |                            y  down,         0 .. height - 1
 *              v                            z  away from the viewer, 0 .. slices - 1
 *       o-----------> x
 *      /|  slice 0                          A depth is a float32 in slices: 0 is the centre of slice 0,
 *     / |  slice 1                          1 the centre of slice 1, 2.5 half way between 2 and 3.
 *    z  |  ...
 *       v y
 *
 * SLABS. The volume arrives front to back in *slabs*: runs of consecutive slices. In a slab the slices are
 * tiles of one 2D texture, placed row by row, tiles_x to a row. With tiles_x = 3 a slab of 5 slices is
 *
 *       |<------ row_pitch bytes from one texture row to the next ------>|
 *       |<- tile_w ->|
 *       +---------+--+---------+--+---------+--+--------+   -
 *       | slice 0 |//| slice 1 |//| slice 2 |//|////////|   |  tile_h
 *       |/////////|//|/////////|//|/////////|//|////////|   |
 *       +---------+--+---------+--+---------+--+--------+   -
 *       | slice 3 |//| slice 4 |//|/ unused /|/|////////|
 *       |/////////|//|/////////|//|//////////|/|////////|
 *       +---------+--+---------+--+---------+--+--------+
 *
 *     byte of voxel (x, y) of the slab's slice s =
 *         ((s / tiles_x) * tile_h + y) * row_pitch + ((s % tiles_x) * tile_w + x) * bytes_per_voxel
 *
 * Hatched bytes (tile padding, where tile_w > width or tile_h > height, and pitch padding) are never part
 * of a result; they may hold anything. Slabs may differ in length from call to call, the last is often
 * short; none is longer than max_slab_slices.
 *
 * INTENSITIES are 8-bit unorm: 0 .. 255 stands for 0 .. 1, and thresholds are given in 0 .. 1. Voxels the
 * probe did not scan carry padding_value. They are neither fluid nor tissue: a ray skips them.
 *
 * DEPTH, AND "CLIPS NOTHING":
 *
 *     depth:     -3    0                     7.25
 *                 :    |   occluder   | fluid  :   | fetus
 *     ray ------->:----|##############|--------:---|@@@@@@@@@-->
 *                 :    |                       |
 *                 :    0 or less: the ray      renderer starts here: slices 0 .. 7 are not drawn
 *                 :    starts at the front,
 *                      nothing is clipped
 *
 * A depth <= 0 clips nothing on that ray. For q > 1 depths may be negative; the host clamps when it
 * renders, a plugin must not. A map of zeros clips nothing at all.
 *
 * ON FAILURE. Whatever a call returns but SV_OK, the host renders unclipped, never with an earlier map.
 * The reason goes to sv_host.log and to last_error. A plugin never aborts, and fails no call in silence.
 *
 * THREADS AND STATES, the tag before every function:
 *     [control]  setup calls, one at a time for an instance; may block and allocate
 *     [frame]    one at a time for an instance, in order; no heap allocation, no clCreate*, no compilation,
 *                no file access, no unbounded loop. With the host's queue: no blocking call either.
 *     [any]      any thread, any time between create and destroy
 *     & active / & !active: only between activate and deactivate / only outside of it
 * A tag names a symbolic thread: any system thread will do if the calls do not overlap. Two instances are
 * independent of each other; a library has no global state.
 *
 * EVOLUTION. Every struct that crosses begins with `size`, set by whoever owns the memory to sizeof of the
 * struct it was compiled with. Fields are appended, never moved or reused. A reader tests SV_HAS before it
 * reads a field that is newer than 1.0; a writer writes no further than `size`. Unknown enum values, flags
 * and ids are refused with an error, never guessed. Reserved fields are 0.
 *
 * Source: "Application of Smart Visibility on Medical 3D Ultrasound Datasets" (diploma thesis, Vienna
 * University of Technology): "the thesis" below; section and algorithm numbers are its own.
 */
#ifndef SMARTVIS_PLUGIN_H
#define SMARTVIS_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SV_ABI_MAJOR 1u /* differs: the host must not call anything */
#define SV_ABI_MINOR 0u /* adds only: any pair of minors works together */

/* True if the struct at p is long enough to hold `field`. For every field added after 1.0. */
#define SV_HAS(p, field)                                                                                     \
    ((p)->size >= (uint32_t)((const char *)&(p)->field - (const char *)(p)) + sizeof((p)->field))

/* OpenCL handles by their tags: the very types cl_mem, cl_context, ... without a CL include. */
struct _cl_context;
struct _cl_device_id;
struct _cl_command_queue;
struct _cl_mem;

typedef struct sv_plugin sv_plugin;
typedef struct sv_host sv_host;

/* ------------------------------------------------------------------------------------------- status -- */

/* 0 success; positive: success with a note; negative: error. Numbers are pinned forever. */
typedef int32_t sv_status;
enum {
    SV_OK = 0,
    SV_NO_SURFACE = 1, /* no initial point, or too little evidence of fluid before the bone: nothing is sure.
                          The map holds zeros, which clip nothing. */
    SV_PARTIAL = 2,    /* some pixels could not be reached (fill weight 0): they hold 0 and clip nothing */

    SV_ERR_INTERNAL = -1, /* a defect of the plugin */

    SV_ERR_ARGUMENT = -10,    /* a pointer is NULL, a flag or an enum value is unknown */
    SV_ERR_SIZE = -11,        /* a struct's `size` is smaller than version 1.0 of that struct */
    SV_ERR_FORMAT = -12,      /* the format is impossible (width 0, pitch too small) or not supported */
    SV_ERR_PARAM_ID = -13,    /* no parameter has this id */
    SV_ERR_PARAM_RANGE = -14, /* outside its hard range, not finite, or not a value of its type */
    SV_ERR_PARAM_FIXED = -15, /* flagged SV_PARAM_REACTIVATE and differs from the value at activate */
    SV_ERR_UNKNOWN_ID = -16,  /* create: this library has no plugin with that id */

    SV_ERR_STATE = -20,        /* a call in the wrong state (its tag is violated) */
    SV_ERR_SLAB_ORDER = -21,   /* a slab does not start where the one before it ended */
    SV_ERR_SLAB_MISSING = -22, /* end before the last slice came */
    SV_ERR_SLAB_SHAPE = -23, /* a slab is empty, too long, or its memory is too small or of a wrong carrier */

    SV_ERR_NO_DEVICE = -30, /* no OpenCL platform or device */
    SV_ERR_BUILD = -31,     /* a kernel did not compile; the build log went to sv_host.log */
    SV_ERR_OPENCL = -32,    /* an OpenCL call failed; its name and code are in last_error */
    SV_ERR_SELF_TEST = -33, /* the device computed a known answer wrongly */

    SV_ERR_NO_MEMORY = -40 /* host memory */
};

/* --------------------------------------------------------------------------------------------- host -- */

enum {
    SV_LOG_DEBUG = 0,
    SV_LOG_INFO = 1,
    SV_LOG_WARNING = 2,
    SV_LOG_ERROR = 3,
    SV_LOG_HOST_MISBEHAVING = 4,  /* the plugin caught the host breaking a rule of this header */
    SV_LOG_PLUGIN_MISBEHAVING = 5 /* the plugin caught itself */
};

/* What the host offers. Owned by the host, unchanged and valid from create until destroy has returned. */
struct sv_host {
    uint32_t size;       /* sizeof(sv_host) */
    uint32_t abi_minor;  /* SV_ABI_MINOR the host was built with */
    void *host_data;     /* the host's own; a plugin does not touch it */
    const char *name;    /* UTF-8, not NULL */
    const char *version; /* UTF-8, not NULL */

    /* [any] One finished line of text, without a newline. May be NULL. The text is valid during the call. */
    void (*log)(const sv_host *host, int32_t severity, const char *text);

    /* [any] A host extension by its id ("name/revision"), or NULL. May be NULL. Valid until destroy. */
    const void *(*get_extension)(const sv_host *host, const char *id);
};

/* --------------------------------------------------------------------------------------- parameters -- */

enum { SV_PARAM_FLOAT = 0, SV_PARAM_INT = 1, SV_PARAM_BOOL = 2, SV_PARAM_ENUM = 3 };

enum {
    SV_PARAM_PRIMARY = 1u << 0,    /* the one knob a user sees; at most one parameter has it */
    SV_PARAM_EXPERT = 1u << 1,     /* hide behind "advanced" */
    SV_PARAM_REACTIVATE = 1u << 2, /* read by activate only */
    SV_PARAM_ADJUST = 1u << 3      /* adjust accepts it: no new volume is needed when it changes */
};

/*
 * A parameter describes itself, so that a host can draw its controls from this alone. Values are plain
 * (0.24, 23, ...), never rescaled to 0 .. 1; all types travel as double. The host owns the memory and sets
 * size; the strings are the plugin's, UTF-8, never NULL, valid until destroy.
 */
typedef struct sv_param_info {
    uint32_t size;
    uint32_t id;       /* stable across versions, unique, never 0 */
    uint32_t type;     /* SV_PARAM_FLOAT .. SV_PARAM_ENUM */
    uint32_t flags;    /* SV_PARAM_PRIMARY | ... */
    const char *key;   /* for files and command lines: [a-z0-9_]+ */
    const char *label; /* for a person */
    const char *unit;  /* "slices", "pixels", "" if it has none */
    const char *help;  /* one sentence */
    double min_value;  /* hard range, both ends included: outside is SV_ERR_PARAM_RANGE */
    double max_value;
    double display_min; /* what a slider should span; inside the hard range */
    double display_max;
    double default_value;
    double step; /* the value is min_value + n * step for int, bool, enum; a hint for float */
} sv_param_info;

typedef struct sv_param_value {
    uint32_t id;
    uint32_t reserved; /* 0 */
    double value;
} sv_param_value;

/* ------------------------------------------------------------------------------------------- format -- */

enum { SV_VOXEL_U8 = 1, SV_VOXEL_U16 = 2 /* reserved: a 1.0 plugin may refuse it with SV_ERR_FORMAT */ };

enum {
    SV_CARRIER_HOST = 1,   /* host memory */
    SV_CARRIER_BUFFER = 2, /* an OpenCL buffer; needs the host's context */
    SV_CARRIER_IMAGE = 3   /* an OpenCL 2D image, CL_R with CL_UNORM_INT8 or CL_UNSIGNED_INT8; the same.
                              An image has no row_pitch: the field is ignored. */
};

#define SV_NO_PADDING (-1)

/*
 * Everything that stays the same from frame to frame. Read by activate, which copies what it needs.
 *
 * OpenCL: either context, device and queue are all given (the *host queue* mode), or all are NULL and the
 * plugin picks a device itself (the *own queue* mode, SV_CARRIER_HOST only). The queue must be in-order.
 * The plugin never retains or releases a host object; all three stay valid until deactivate has returned.
 */
typedef struct sv_format {
    uint32_t size;
    uint32_t width;           /* pixels, 1 .. 8192: rays in x, and columns of the depthmap */
    uint32_t height;          /* pixels, 1 .. 8192 */
    uint32_t slices;          /* slices of a whole volume, 1 .. 8192 */
    uint32_t max_slab_slices; /* slices of the longest slab, 1 .. slices */
    uint32_t voxel_type;      /* SV_VOXEL_U8 */
    uint32_t carrier;         /* SV_CARRIER_HOST .. SV_CARRIER_IMAGE */
    int32_t padding_value;    /* 0 .. 255: voxels of this value were not scanned; or SV_NO_PADDING */
    uint32_t tiles_x;         /* tiles in one row of a slab texture, 1 .. 8192 */
    uint32_t tile_w;          /* voxels from one tile to the next in x, width .. 16384 */
    uint32_t tile_h;          /* texture rows from one tile to the next in y, height .. 16384 */
    uint32_t row_pitch;       /* bytes from one texture row to the next, >= tiles_x * tile_w * voxel bytes */

    struct _cl_context *context;
    struct _cl_device_id *device;
    struct _cl_command_queue *queue;

    /* SV_CARRIER_HOST: memory in which all slabs will lie, or NULL. A device that shares the host's memory
     * then reads it in place, without a copy (docs/performance.md). Valid until deactivate has returned. */
    const void *host_memory;
    uint64_t host_memory_bytes;

    /* Values of the parameters flagged SV_PARAM_REACTIVATE; the rest keep their defaults. May be NULL. */
    const sv_param_value *values;
    uint32_t value_count;
    uint32_t reserved; /* 0 */
} sv_format;

/* -------------------------------------------------------------------------------------------- frame -- */

/* Read by begin, which copies what it needs. A parameter that is not listed has its default value. */
typedef struct sv_frame {
    uint32_t size;
    uint32_t flags;               /* 0 */
    uint64_t index;               /* the host's own number of this volume, for the log */
    const sv_param_value *values; /* may be NULL if value_count is 0; a repeated id: the last counts */
    uint32_t value_count;
    uint32_t reserved; /* 0 */
} sv_frame;

/*
 * One slab. Exactly one carrier, the one named in the format. The contents must not change until the
 * commands of this frame have run (host queue), or end or a call that failed has returned (own queue).
 */
typedef struct sv_slab {
    uint32_t size;
    uint32_t first_slice;   /* 0 for the first slab; afterwards where the one before it ended */
    uint32_t slice_count;   /* 1 .. max_slab_slices */
    uint32_t reserved;      /* 0 */
    const void *memory;     /* SV_CARRIER_HOST: the texture's first byte */
    struct _cl_mem *object; /* SV_CARRIER_BUFFER or SV_CARRIER_IMAGE */
    uint64_t offset;        /* SV_CARRIER_BUFFER: bytes from the buffer's start to the texture's first byte */
    uint64_t bytes;         /* HOST and BUFFER: bytes from the texture's first byte that may be read */
} sv_slab;

/* Per-frame statistics. All counts are of this frame's rays. */
typedef struct sv_stats {
    uint32_t size;
    sv_status outcome;     /* SV_OK, SV_NO_SURFACE or SV_PARTIAL: what this frame came to */
    uint32_t rays;         /* width * height */
    uint32_t points;       /* initial points, those with an empty interval included */
    uint32_t empty_points; /* points whose interval is empty: depth 0, "clip nothing here" */
    uint32_t passes;       /* passes or steps of the surface reconstruction; 1 if it has none */
    uint32_t unfilled;     /* pixels without a surface (SV_PARTIAL, SV_NO_SURFACE) */
    float volume_max;      /* largest intensity, 0 .. 1; padding does not count */
    float bone_threshold;  /* the T_B that was used, 0 .. 1: a ray is bone above it */
    uint32_t sure_points;  /* bone rays whose interval is long enough to be sure it is fluid */
} sv_stats;

/* Values in the status map, one byte a ray. */
enum {
    SV_POINT_NONE = 0,    /* no initial point on this ray */
    SV_POINT_INITIAL = 1, /* an initial point in a fluid interval */
    SV_POINT_EMPTY = 2    /* an initial point with an empty interval: depth 0 */
};

/*
 * Where results go. The host owns all memory. Either depth or depth_object must be given; the rest is
 * optional (NULL). Host queue: everything, statistics included, is written by the queue and valid when it
 * has run; the memory must stay until then, and end itself returns SV_OK or an error. Own queue: end waits,
 * all is valid when it returns, and it returns sv_stats.outcome.
 */
typedef struct sv_result {
    uint32_t size;
    uint32_t depth_pitch;         /* bytes from one row of depth to the next, a multiple of 4; 0: width * 4 */
    float *depth;                 /* float32 slices, height rows */
    struct _cl_mem *depth_object; /* an OpenCL buffer instead of depth; rows are width * 4 bytes apart */
    uint64_t depth_offset;        /* bytes into depth_object, a multiple of 4 */
    uint8_t *status;              /* width * height bytes, SV_POINT_* */
    sv_stats *stats;              /* stats->size set by the host; filled from the start up to that size */
} sv_result;

/* ------------------------------------------------------------------------------------------- plugin -- */

/* Static facts about one plugin of the library. Valid until the library is unloaded; strings not NULL. */
typedef struct sv_descriptor {
    uint32_t size;
    uint32_t reserved; /* 0 */
    const char *id;    /* reverse domain and unique: "org.smartvis.clip" */
    const char *name;  /* for a person */
    const char *vendor;
    const char *version; /* of the plugin, "1.0.0" */
    const char *summary; /* one sentence */
} sv_descriptor;

/* One instance. The plugin owns it; the function pointers are never NULL and never change. */
struct sv_plugin {
    uint32_t size;
    uint32_t reserved; /* 0 */
    const sv_descriptor *descriptor;
    void *plugin_data; /* the plugin's own; a host does not touch it */

    /* [control & !active] Frees the instance. An active one is deactivated first (and the host is told). */
    void (*destroy)(const sv_plugin *plugin);

    /* [control & !active] Makes everything a frame needs for this format, compiles and launches every kernel
     * once, and has the device compute a known answer. SV_ERR_* leaves the instance inactive. */
    sv_status (*activate)(const sv_plugin *plugin, const sv_format *format);

    /* [control & active] Waits for its own outstanding work and frees what activate made. */
    void (*deactivate)(const sv_plugin *plugin);

    /* [frame & active] Starts a volume. One that is under way is dropped. */
    sv_status (*begin)(const sv_plugin *plugin, const sv_frame *frame);

    /* [frame & active, after begin] The next slab, front to back. After an error the frame is over. */
    sv_status (*slab)(const sv_plugin *plugin, const sv_slab *slab);

    /* [frame & active, after the last slab] Delivers the results. Either way the frame is over. */
    sv_status (*end)(const sv_plugin *plugin, const sv_result *result);

    /* [frame & active, after a successful end] The last volume again, with other values for parameters that
     * are flagged SV_PARAM_ADJUST; the rest keep the frame's. Where the surface is linear in q, q costs one
     * multiply-add per pixel, S(q) = S_f + q (S_n - S_f), so a slider may call it at will; where it is not
     * (minimum filter), the surface is reconstructed again. */
    sv_status (*adjust)(const sv_plugin *plugin, const sv_param_value *values, uint32_t value_count,
                        const sv_result *result);

    /* [any] Parameters; 0 .. param_count - 1 is an index, not an id. The order is that of importance. */
    uint32_t (*param_count)(const sv_plugin *plugin);
    sv_status (*param_info)(const sv_plugin *plugin, uint32_t index, sv_param_info *out);

    /* [any] A value as a person reads it ("0.24", "offset"): writes at most bytes - 1 characters and a NUL.
     * An enum's value text is its name. */
    sv_status (*param_text)(const sv_plugin *plugin, uint32_t id, double value, char *out, uint32_t bytes);

    /* [control] or [frame] The reason of the last [control] or [frame] call that did not return SV_OK, or ""
     * if the last one did. UTF-8, valid until the next such call of this instance. Calls for [any] thread
     * only log. */
    const char *(*last_error)(const sv_plugin *plugin);

    /* [any] An extension's const table by its id, or NULL. Valid until destroy. */
    const void *(*get_extension)(const sv_plugin *plugin, const char *id);
};

/* --------------------------------------------------------------------------------------- extensions -- */

/*
 * smartvis.stats/1: where the time of a frame went. It needs a queue with CL_QUEUE_PROFILING_ENABLE (the
 * plugin's own queue has it).
 */
#define SV_EXT_STATS "smartvis.stats/1"

typedef struct sv_stage_times {
    uint32_t size;
    uint32_t reserved;     /* 0 */
    double transfer_ms;    /* copies of slabs to the device; 0 where slabs are read in place */
    double profile_ms;     /* ray profiles, all slabs */
    double threshold_ms;   /* bone threshold and initial points */
    double reconstruct_ms; /* surface reconstruction and S(q), where the device tells it from threshold */
    double output_ms;      /* results to the host */
} sv_stage_times;

typedef struct sv_ext_stats {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control] Switches timing on or off (off after activate): on, each command keeps its event. */
    sv_status (*enable)(const sv_plugin *plugin, uint32_t on);

    /* [control] Times of the last frame whose end succeeded. Its commands must have run. SV_ERR_STATE if
     * there is none or timing was off, SV_ERR_OPENCL if the queue does not profile. */
    sv_status (*stage_times)(const sv_plugin *plugin, sv_stage_times *out);
} sv_ext_stats;

/*
 * smartvis.spline/1: what the thin-plate spline of the last frame came to (parameter method = spline).
 */
#define SV_EXT_SPLINE "smartvis.spline/1"

typedef struct sv_spline_report {
    uint32_t size;
    uint32_t points;     /* control points, after merging; 0: the frame had no initial point */
    uint32_t merge_grid; /* cells per side that points were merged on; 0: not merged */
    uint32_t rank;       /* of the plane: 3, or 2 for collinear points, or 1 for a single one */
    uint32_t dropped;    /* unknowns left out because their pivot was as good as 0 */
    float condition;   /* ratio of the largest to the smallest pivot: at most the matrix' condition number */
    float residual;    /* largest error of the solved equations at a control point, slices */
    uint32_t reserved; /* 0 */
} sv_spline_report;

typedef struct sv_ext_spline {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control] Waits for the queue and reads the report of the last frame whose end succeeded. SV_ERR_STATE
     * if there is none, or the method is another one. */
    sv_status (*report)(const sv_plugin *plugin, sv_spline_report *out);
} sv_ext_spline;

/*
 * smartvis.confidence/1: how sure the surface of the last frame is (parameter method = cost).
 */
#define SV_EXT_CONFIDENCE "smartvis.confidence/1"

typedef struct sv_confidence_report {
    uint32_t size;
    float fluid_threshold; /* T_L that was found from the volume's own grey levels, 0 .. 1 */
    uint32_t rays;         /* that have a scanned voxel */
    uint32_t open_rays;    /* with an interval of fluid behind tissue; too few of them: SV_NO_SURFACE */
} sv_confidence_report;

typedef struct sv_ext_confidence {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control] Waits for the queue and reads the last frame whose end succeeded. `map`: width * height
     * float32, row by row, 0 (nothing is known) .. 1 (no other depth comes near in cost, and all rays nearby
     * show fluid); all 0 without a surface. The surface lies nearer to the viewer where it is low; a host may
     * widen its ghosting window there. `map` or `out` may be NULL. SV_ERR_STATE if there is no such frame or
     * the method is another one. */
    sv_status (*read)(const sv_plugin *plugin, float *map, sv_confidence_report *out);

    /* [control & active] or [frame & active] 1 if the method that is active gives a map, else 0. It stays the
     * same until deactivate. */
    uint32_t (*offered)(const sv_plugin *plugin);

    /* [frame & active, after a successful end or adjust] The map of the last frame on the frame path, into
     * either `map` or `object`, an OpenCL buffer, at `offset` bytes (a multiple of 4). Host queue: enqueued
     * behind the frame's own commands and valid when the queue has run; the memory must stay until then. Own
     * queue: `map` only; valid when it returns. SV_ERR_STATE as `read`; SV_ERR_ARGUMENT for none or both, or
     * an object that the queue cannot reach or that is too small. */
    sv_status (*write)(const sv_plugin *plugin, float *map, struct _cl_mem *object, uint64_t offset);
} sv_ext_confidence;

/* -------------------------------------------------------------------------------------------- entry -- */

/*
 * The one symbol a library exports. The host reads abi_major before it calls anything: a different major
 * means that nothing else in this struct may be trusted.
 */
typedef struct sv_entry {
    uint32_t abi_major; /* SV_ABI_MAJOR */
    uint32_t abi_minor; /* SV_ABI_MINOR */
    uint32_t size;      /* sizeof(sv_entry) */
    uint32_t count;     /* plugins in this library, >= 1 */

    /* [any] Facts about plugin 0 .. count - 1; NULL for any other index. Cheap: a host may scan folders. */
    const sv_descriptor *(*descriptor)(uint32_t index);

    /* [control] Makes an instance of the plugin with this id. On success *out is whole; on an error it is
     * NULL and nothing is left behind. Makes no OpenCL call: an instance on a machine without a device can
     * still describe its parameters. */
    sv_status (*create)(const sv_host *host, const char *id, const sv_plugin **out);
} sv_entry;

#define SV_ENTRY_SYMBOL "smartvis_plugin_entry"

#if defined(_WIN32)
#define SV_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define SV_EXPORT __attribute__((visibility("default")))
#else
#define SV_EXPORT
#endif

extern SV_EXPORT const sv_entry smartvis_plugin_entry;

#ifdef __cplusplus
}
#endif

#endif
