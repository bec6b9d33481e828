/* SPDX-License-Identifier: MIT */
/*
 * SmartVis plugin ABI, version 1.1: occlusion removal for 3D ultrasound. Frozen since release 1.0.0 of
 * SmartVis: what comes later is added, and nothing here changes its meaning, value or place.
 *
 * This header is all a host or a plugin author needs. It includes <stdint.h> and <stddef.h> only, and
 * compiles as C99 to C23 and C++11 to C++20. Extensions have a header each in include/smartvis/, and so have
 * five optional helpers: author.h for plugins, lookup.h and open.h for hosts, device.h and probe.h for both.
 *
 *   host                                                        plugin
 *   ----                                                        ------
 *   dlopen, read smartvis_plugin_entry.abi_major  ------------>  (no plugin code has run yet)
 *   entry.descriptor(i)                           ------------>  what it is, and what it can do
 *   entry.create(host, id)                        ------------>  a whole instance, or an error
 *     activate(format)                            ------------>  allocates, compiles, warms up, tests itself
 *       begin(frame)                              ------------>  \
 *       slab(slab 0) .. slab(slab n-1)            ------------>   > one volume: enqueues work, nothing else
 *       end(result)                               ------------>  /
 *       adjust(values, result)  (optional)        ------------>  the same volume, another surface position
 *     deactivate                                  ------------>  frees what activate made
 *   destroy                                       ------------>  gone
 *
 * WHAT IT COMPUTES. For every viewing ray the depth at which the host's renderer may start, so that the
 * fetus is seen and nothing hides it: the *clipping depthmap* (thesis 3.2 to 3.4).
 *
 * AXES. The volume is camera-aligned, the camera orthographic: a viewing ray is a column (x, y) along +z.
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
 * INTENSITIES are 8-bit unorm: 0 .. 255 stands for 0 .. 1, and thresholds are given in 0 .. 1.
 *
 * WHERE THE FAN IS. Black fluid is 0, and so, in most machines, is what lies outside the fan. What was not
 * scanned is neither fluid nor tissue: a ray skips it. A host says for every ray which slices were scanned:
 *
 *     ray (x, y):   [ not scanned | scanned .................... | not scanned ]
 *     slice:          0 ..          first .................. end - 1         .. slices - 1
 *
 * A host that cannot say so names a padding_value instead: voxels of that value were not scanned. Where both
 * are given, a voxel was scanned if it lies in its ray's range and does not hold the padding value.
 *
 * LENGTHS. spacing_mm gives the distance between voxels, so that a method can measure in millimetres: the
 * same anatomy then gives the same surface at any resolution. Depths in results stay in slices.
 *
 * WHERE THE PROBE IS. The camera may look from elsewhere than the probe. sv_frame.probe_rotation (since 1.1)
 * tells how the two stand to each other, and probe_side on which side of the volume the probe is:
 *
 *     the probe's axes: x along its array, y across it, z away from it, into the body
 *
 *          probe        camera        probe_rotation       probe_side
 *            |            |              1  0  0
 *            v            v              0  1  0            0  0 -1      the camera looks along the beams
 *        :.......:    :.......:          0  0  1
 *
 *            |                           0  0 -1
 *            v        --->:.......:      0  1  0            1  0  0      it looks from the probe's left (-x)
 *        :.......:                       1  0  0
 *
 * WHERE THE BEAMS RUN. Along every beam the ultrasound passes the probe's face, the wall, the fluid, the
 * fetus. sv_frame.beams (since 1.1) tells how they run: parallel along the probe's z, or as a fan that is
 * swept about an axis parallel to the probe's x; smartvis/probe.h draws it and has its formula.
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
 * A depth <= 0 clips nothing on that ray. A depth may be negative, where the surface lies before the volume;
 * the host clamps when it renders, a plugin must not. A map of zeros clips nothing at all.
 *
 * WHEN A MAP MAY BE USED. If the outcome of a frame is SV_OK or SV_PARTIAL, the host renders with its map. If
 * it is SV_NO_SURFACE, or any call returned an error, the host renders unclipped, never with an earlier map.
 * The reason goes to sv_host.log and to last_error. A plugin never aborts, and fails no call in silence.
 *
 * THREADS AND STATES, the tag before every function:
 *     [control]  setup calls, one at a time for an instance; may block and allocate
 *     [frame]    one at a time for an instance, in order; no heap allocation, no clCreate*, no compilation,
 *                no file access, no unbounded loop. With the host's queue: no blocking call either.
 *     [any]      any thread, any time between create and destroy
 *     & active / & !active: only between activate and deactivate / only outside of it
 * A tag names a symbolic thread: any system thread will do if the calls do not overlap. [control] and [frame]
 * calls of one instance never overlap each other either: the host orders them. Only [any] calls may run
 * beside them. Two instances are independent of each other; a library has no global state.
 *
 * STATE. All settings live in the host: parameter values come with every frame, so there are no presets to
 * save and none to restore. A frame's map belongs to that frame's volume: there is no latency to make up for.
 * A plugin that remembers earlier frames forgets them at SV_FRAME_DISCONTINUITY and at deactivate.
 *
 * EVOLUTION. A struct that may grow begins with `size`, set by whoever owns the memory to sizeof of the
 * struct it was compiled with: sv_host, sv_param_info, sv_format, sv_frame, sv_slab, sv_stats, sv_result,
 * sv_descriptor, sv_plugin and every struct of an extension; sv_entry has its size behind the version.
 * sv_param_value and sv_scanned travel in arrays: they have no size and never grow. Fields are appended,
 * never moved or reused. A reader tests SV_HAS before it reads a field newer than 1.0; a writer stays within
 * `size`. Unknown enum values, flags and ids are refused with an error, never guessed. Reserved fields are 0.
 *
 * NOT IN 1.0, and how it would come without breaking anything:
 *
 *     16-bit voxels           SV_VOXEL_U16 is reserved; a plugin that reads it sets its bit in voxel_types
 *     a Doppler channel       a second carrier in sv_slab, announced by a feature bit
 *     a perspective camera    a flag of the format, and the rays' geometry behind its last field;
 *                             today the host resamples to parallel rays
 *     a region of interest    a rectangle behind the last field of sv_frame; today the host gives a
 *                             smaller format
 *     several maps            an extension that writes them after end, as smartvis.confidence/1 does
 *     3D images               a further carrier, announced by its bit in carriers
 *     semaphores,             an extension that hands them over at activate; the queue stays the order
 *     external memory
 *
 * WHERE HOSTS LOOK for plugins is up to them. By convention a host that scans for them reads the folders of
 * the environment variable SMARTVIS_PLUGIN_PATH (separated by ':', on Windows by ';'), then, but not on
 * Windows, /usr/local/lib/smartvis and /usr/lib/smartvis. A plugin is a file there that exports
 * smartvis_plugin_entry; its name does not matter.
 *
 * Source: "Application of Smart Visibility on Medical 3D Ultrasound Datasets" (diploma thesis, Vienna
 * University of Technology): "the thesis" below; section and algorithm numbers are its own.
 */
#ifndef SMARTVIS_PLUGIN_H
#define SMARTVIS_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define SMARTVIS_BEGIN_C extern "C" {
#define SMARTVIS_END_C   }
#else
#define SMARTVIS_BEGIN_C
#define SMARTVIS_END_C
#endif
SMARTVIS_BEGIN_C

#define SV_ABI_MAJOR 1u /* differs: the host must not call anything */
#define SV_ABI_MINOR 1u /* adds only: any pair of minors works together */

/* True if the struct at p is long enough to hold `field`. For every field added after 1.0. */
#define SV_HAS(p, field)                                                                                     \
    ((p)->size >= (uint32_t)((const char *)&(p)->field - (const char *)(p)) + sizeof((p)->field))

/* OpenCL handles by their tags: the very types cl_mem, cl_context, ... without a CL include. */
struct _cl_context;
struct _cl_device_id;
struct _cl_command_queue;
struct _cl_mem;

/* The calling convention of every function that crosses. */
#if defined(_WIN32) && !defined(_WIN64)
#define SV_CALL __cdecl
#else
#define SV_CALL
#endif

typedef struct sv_plugin sv_plugin;
typedef struct sv_host sv_host;

/* ------------------------------------------------------------------------------------------- status -- */

/* 0 success; positive: success with a note; negative: error. Numbers are pinned forever. */
typedef int32_t sv_status;
enum {
    SV_OK = 0,
    SV_NO_SURFACE = 1, /* too little evidence of fluid before the fetus: the map holds zeros, which clip
                          nothing. Where nothing hides the fetus it may be this, or SV_OK with a surface in
                          front of it. */
    SV_PARTIAL = 2, /* the map holds, but some pixels have no surface: they are 0 and clip nothing. The host
                       renders with it as with SV_OK. */

    SV_ERR_INTERNAL = -1, /* a defect of the plugin */

    SV_ERR_ARGUMENT = -10,    /* a pointer is NULL, a flag or an enum value is unknown, an object is none of
                                 the host's context */
    SV_ERR_SIZE = -11,        /* a struct's `size` is smaller than version 1.0 of that struct */
    SV_ERR_FORMAT = -12,      /* the format is impossible (width 0, pitch too small), not supported, or needs
                                 more memory than the device has */
    SV_ERR_PARAM_ID = -13,    /* no parameter has this id */
    SV_ERR_PARAM_RANGE = -14, /* outside its hard range, not finite, or not a value of its type */
    SV_ERR_PARAM_FIXED = -15, /* flagged SV_PARAM_REACTIVATE and differs from the value at activate */
    SV_ERR_UNKNOWN_ID = -16,  /* create: this library has no plugin with that id */

    SV_ERR_STATE = -20,        /* a call in the wrong state (its tag is violated) */
    SV_ERR_SLAB_ORDER = -21,   /* a slab does not start where the one before it ended */
    SV_ERR_SLAB_MISSING = -22, /* end before the last slice came */
    SV_ERR_SLAB_SHAPE = -23,   /* a slab is empty, too long, or its memory is too small, of a wrong carrier or
                                  of another context */

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
    void(SV_CALL *log)(const sv_host *host, int32_t severity, const char *text);

    /* [any] A host extension by its id ("name/revision"), or NULL. May be NULL. Valid until destroy. */
    const void *(SV_CALL *get_extension)(const sv_host *host, const char *id);
};

/* --------------------------------------------------------------------------------------- parameters -- */

enum { SV_PARAM_FLOAT = 0, SV_PARAM_INT = 1, SV_PARAM_BOOL = 2, SV_PARAM_ENUM = 3 };

enum {
    SV_PARAM_PRIMARY = 1u << 0,    /* the one that every user sees; at most one parameter has it */
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

    /* What belongs together in a host's controls: "Surface", "Bone threshold". Not NULL, "" for none. */
    const char *group;

    /* When the parameter matters: always, if depends_on is 0. Else depends_on is the id of an int, bool or
     * enum parameter, and this one matters only while that one matters and its value is min_value + n * step
     * with bit n of depends_values set (n < 64). A value that does not matter is still checked. No parameter
     * depends on itself, directly or through others. */
    uint32_t depends_on;
    uint32_t reserved; /* 0 */
    uint64_t depends_values;
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
    SV_CARRIER_BUFFER = 2, /* an OpenCL buffer of the host's context */
    SV_CARRIER_IMAGE = 3   /* an OpenCL 2D image, CL_R with CL_UNORM_INT8 or CL_UNSIGNED_INT8; the same.
                              An image has no row_pitch: the field is ignored. */
};

#define SV_NO_PADDING (-1)

/* Flags of a format. */
enum {
    SV_FORMAT_SCANNED = 1u << 0 /* every frame brings the scanned range of every ray (sv_frame.scanned) */
};

/* What a plugin takes the longest side of a volume for if the spacing is unknown: about the depth of a
 * prenatal scan. Its voxels are then taken as cubes. */
#define SV_ASSUMED_EXTENT_MM 120.0f

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

    /* Millimetres from one voxel's centre to the next in x, y and z; finite, and either all above 0 or all 0:
     * unknown, and SV_ASSUMED_EXTENT_MM holds. */
    float spacing_mm[3];
    uint32_t flags; /* SV_FORMAT_* */

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

/* Flags of a frame, one at most. DISCONTINUITY: this volume does not continue the one before, and whatever
 * remembers forgets: another scan or patient, a frozen image; a turned camera, where probe_rotation is not
 * told. SAME_VOLUME (since 1.1, to plugins with SV_FEATURE_PROBE): the very volume of the frame before, by
 * another camera or with other values. */
enum { SV_FRAME_DISCONTINUITY = 1u << 0, SV_FRAME_SAME_VOLUME = 1u << 1 };
enum { SV_BEAMS_UNKNOWN = 0, SV_BEAMS_PARALLEL = 1, SV_BEAMS_FAN = 2 }; /* sv_frame.beams, since 1.1 */

/* The slices of one ray that were scanned: first .. end - 1. first >= end: none. What lies beyond the
 * volume's slices is cut off. */
typedef struct sv_scanned {
    uint16_t first;
    uint16_t end;
} sv_scanned;

/*
 * Read by begin, which copies what it needs, except the contents of `scanned`. A parameter that is not listed
 * has its default value.
 */
typedef struct sv_frame {
    uint32_t size;
    uint32_t flags;               /* SV_FRAME_* */
    uint64_t index;               /* the host's own number of this volume, for the log */
    uint64_t time_ns;             /* when it was acquired, on any clock that does not run back; 0: unknown */
    const sv_param_value *values; /* may be NULL if value_count is 0; a repeated id: the last counts */
    uint32_t value_count;
    uint32_t reserved; /* 0 */

    /* With SV_FORMAT_SCANNED exactly one of the two, else neither: width * height ranges, row by row without
     * a gap, in host memory, or in an OpenCL buffer of the host's context. As a slab's, the contents must not
     * change until the commands of this frame have run (host queue), or end or a call that failed has
     * returned (own queue). */
    const sv_scanned *scanned;
    struct _cl_mem *scanned_object;
    uint64_t scanned_offset; /* bytes from the buffer's start, a multiple of 4 */

    /* Since 1.1. How this volume's axes stand to the probe's: row by row a rotation that turns a direction
     * along the probe's axes into the same direction along the volume's, in millimetres. All 0: unknown. */
    float probe_rotation[9];
    /* The unit vector along the volume's axes to the side where the probe is. All 0: unknown. A host that
     * knows the rotation gives both: the side is then the opposite of the rotation's third column. All of it
     * to within 0.001. */
    float probe_side[3];
    uint32_t beams;        /* SV_BEAMS_*; unless UNKNOWN, with probe_rotation */
    float beam_apex_mm[3]; /* FAN: where the lines of the middle plane meet, along the volume's axes from the
                              centre of voxel (0, 0, 0); within 100,000; else 0 */
    float beam_sweep_mm;   /* FAN: from there to the sweep's axis along the probe's z, likewise */
    uint32_t reserved_beams; /* 0 */
} sv_frame;

#define SV_FRAME_SIZE_1_0 ((uint32_t)offsetof(sv_frame, probe_rotation)) /* the least that begin takes */

/*
 * One slab. Exactly one carrier, the one named in the format. The contents must not change until the
 * commands of this frame have run (host queue), or end or a call that failed has returned (own queue).
 *
 * `bytes` must reach the last voxel that belongs to a slice. With n = slice_count, r = (n - 1) / tiles_x (the
 * last row of tiles) and v bytes a voxel, the exact least is the larger of
 *     (r * tile_h + height - 1) * row_pitch + ((n - 1) % tiles_x * tile_w + width) * v
 * and, if r > 0,
 *     ((r - 1) * tile_h + height - 1) * row_pitch + ((tiles_x - 1) * tile_w + width) * v
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

/* Per-frame statistics: what every method has. All counts are of this frame's rays. Methods that know more
 * say it in an extension (include/smartvis/). */
typedef struct sv_stats {
    uint32_t size;
    sv_status outcome; /* SV_OK, SV_NO_SURFACE or SV_PARTIAL: what this frame came to */
    uint32_t rays;     /* width * height */
    uint32_t points;   /* rays that the surface rests on; 0 if the method does not count them */
    uint32_t unfilled; /* pixels without a surface: 0 with SV_OK, all rays with SV_NO_SURFACE */
} sv_stats;

/* Values in the status map, one byte a ray. */
enum {
    SV_POINT_NONE = 0,    /* the surface does not rest on this ray */
    SV_POINT_INITIAL = 1, /* it does: the ray gave a depth in a fluid interval */
    SV_POINT_EMPTY = 2    /* it does, by a vote for depth 0: there is no fluid before the fetus on this ray */
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
    struct _cl_mem *depth_object; /* an OpenCL buffer of the host's context instead of depth; rows are
                                     width * 4 bytes apart */
    uint64_t depth_offset;        /* bytes into depth_object, a multiple of 4 */
    uint8_t *status; /* width * height bytes, SV_POINT_*; SV_POINT_NONE for methods without points */
    sv_stats *stats; /* stats->size set by the host; filled from the start up to that size */
} sv_result;

/* ------------------------------------------------------------------------------------------- plugin -- */

/* Queue modes, bits of sv_descriptor.queues. */
enum {
    SV_QUEUE_OWN =
        1u << 0, /* activate without context, device and queue; a plugin on the CPU knows this only */
    SV_QUEUE_HOST = 1u << 1 /* activate with the host's */
};

/* What a plugin makes use of, bits of sv_descriptor.features. */
enum {
    SV_FEATURE_SCANNED = 1u << 0, /* takes SV_FORMAT_SCANNED; without the bit it refuses the flag */
    SV_FEATURE_PADDING = 1u << 1, /* heeds padding_value; without the bit it ignores the field */
    SV_FEATURE_ADJUST = 1u << 2,  /* has parameters flagged SV_PARAM_ADJUST */
    SV_FEATURE_PROBE = 1u << 3    /* takes what a frame tells of the probe and SAME_VOLUME, and refuses what
                                     cannot be with SV_ERR_ARGUMENT; without the bit the fields are ignored */
};

/* The bit of a carrier or a voxel type in sv_descriptor. */
#define SV_BIT(value) (1u << (value))

/*
 * Static facts about one plugin of the library, and what it can do: a host reads here what activate would
 * refuse with SV_ERR_FORMAT, before any kernel is compiled. Valid until the library is unloaded; strings not
 * NULL, UTF-8.
 */
typedef struct sv_descriptor {
    uint32_t size;
    uint32_t carriers; /* SV_BIT(SV_CARRIER_HOST) | ...; SV_CARRIER_HOST is always among them */
    const char *id;    /* reverse domain and unique: "org.smartvis.clip" */
    const char *name;  /* for a person */
    const char *vendor;
    const char *version;           /* of the plugin, "1.0.0" */
    const char *summary;           /* one sentence */
    uint32_t voxel_types;          /* SV_BIT(SV_VOXEL_U8) | ... */
    uint32_t queues;               /* SV_QUEUE_OWN | SV_QUEUE_HOST */
    uint32_t features;             /* SV_FEATURE_* */
    uint32_t reserved;             /* 0 */
    const char *const *extensions; /* ids that get_extension knows, ended by NULL; never NULL itself. An id
                                      may still give NULL in an instance. */
} sv_descriptor;

/* One instance. The plugin owns it; the function pointers are never NULL and never change. */
struct sv_plugin {
    uint32_t size;
    uint32_t reserved; /* 0 */
    const sv_descriptor *descriptor;
    void *plugin_data; /* the plugin's own; a host does not touch it */

    /* [control & !active] Frees the instance. An active one is deactivated first (and the host is told). */
    void(SV_CALL *destroy)(const sv_plugin *plugin);

    /* [control & !active] Makes everything a frame needs for this format, compiles and launches every kernel
     * once, and has the device compute a known answer. SV_ERR_* leaves the instance inactive. */
    sv_status(SV_CALL *activate)(const sv_plugin *plugin, const sv_format *format);

    /* [control & active] Waits for its own outstanding work and frees what activate made. */
    void(SV_CALL *deactivate)(const sv_plugin *plugin);

    /* [frame & active] Starts a volume. One that is under way is dropped. */
    sv_status(SV_CALL *begin)(const sv_plugin *plugin, const sv_frame *frame);

    /* [frame & active, after begin] The next slab, front to back. After an error the frame is over. */
    sv_status(SV_CALL *slab)(const sv_plugin *plugin, const sv_slab *slab);

    /* [frame & active, after the last slab] Delivers the results. Either way the frame is over. */
    sv_status(SV_CALL *end)(const sv_plugin *plugin, const sv_result *result);

    /* [frame & active, after an end that returned SV_OK, SV_PARTIAL or SV_NO_SURFACE] The last volume again,
     * with other values for parameters that are flagged SV_PARAM_ADJUST; the rest keep the frame's. A slider
     * may call it at will. The outcome may be another one with other values; after SV_NO_SURFACE it mostly
     * stays that, with a map of zeros. An error leaves the frame as it is: adjust may be called again. */
    sv_status(SV_CALL *adjust)(const sv_plugin *plugin, const sv_param_value *values, uint32_t value_count,
                               const sv_result *result);

    /* [any] Parameters; 0 .. param_count - 1 is an index, not an id. The order is that of importance. */
    uint32_t(SV_CALL *param_count)(const sv_plugin *plugin);
    sv_status(SV_CALL *param_info)(const sv_plugin *plugin, uint32_t index, sv_param_info *out);

    /* [any] A value as a person reads it ("0.24", "offset"): writes at most bytes - 1 characters and a NUL.
     * An enum's value text is its name. An enum may leave values out between its ends (retired ones, say):
     * each is SV_ERR_PARAM_RANGE here as in every other call, and a host does not offer it. */
    sv_status(SV_CALL *param_text)(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                   uint32_t bytes);

    /* [control] or [frame] The reason of the last [control] or [frame] call that did not return SV_OK, or ""
     * if the last one did. UTF-8, valid until the next such call of this instance. Calls for [any] thread
     * only log. */
    const char *(SV_CALL *last_error)(const sv_plugin *plugin);

    /* [any] An extension's const table by its id, or NULL. Valid until destroy. */
    const void *(SV_CALL *get_extension)(const sv_plugin *plugin, const char *id);
};

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
    const sv_descriptor *(SV_CALL *descriptor)(uint32_t index);

    /* [control] Makes an instance of the plugin with this id. On success *out is whole; on an error it is
     * NULL and nothing is left behind. Makes no OpenCL call: an instance on a machine without a device can
     * still describe its parameters. */
    sv_status(SV_CALL *create)(const sv_host *host, const char *id, const sv_plugin **out);
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

SMARTVIS_END_C

#endif
