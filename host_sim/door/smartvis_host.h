/* SPDX-License-Identifier: MIT */
/*
 * libsmartvis_host: the simulated ultrasound machine as a library. A volume goes in, in memory or as a file;
 * out come depthmap, confidence, mask, clipped voxels and surface, with the bits of `host_sim run`, and the
 * reason in words where nothing is clipped. For programs in any language that calls C.
 *
 *     svh_open, svh_clipper_open, svh_set ...         once
 *     svh_volume_take or svh_volume_read, svh_clip    for every volume
 *
 * STRUCTS begin with their size, which the caller sets to sizeof; all else may be 0. A struct that a function
 * fills in is an out, and has its size set all the same. Later versions add fields at the end: a program and
 * a library of two versions of 1.x go together. What the shorter struct lacks counts as 0, and is not
 * written.
 *
 * ERRORS. A function that can fail returns a code, SVH_OK or one of host_sim's exit codes, and fills in
 * `error`, which may be NULL: one sentence with file, field and value. Another pointer that is NULL is
 * SVH_USAGE, unless its comment allows it.
 *
 * OWNERSHIP. What a function makes is freed by the caller, in any order: a host ends with the last of its
 * clippers and volumes. What a pointer in a struct points to, its comment says.
 *
 * THREADS. Any thread may call, for any object: calls of one host's objects are one after the other. Two
 * hosts are independent of each other.
 *
 * A plugin other than the house's runs guarded, in a process of its own, unless the host was opened
 * otherwise.
 */
#ifndef SMARTVIS_HOST_H
#define SMARTVIS_HOST_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef _WIN32
#define SVH_EXPORT __declspec(dllexport)
#else
#define SVH_EXPORT __attribute__((visibility("default")))
#endif

/* What a call came to. */
enum {
    SVH_OK = 0,
    SVH_USAGE = 2,  /* an argument is wrong */
    SVH_INPUT = 3,  /* a volume cannot be taken or read */
    SVH_PLUGIN = 4, /* the plugin cannot be loaded, or one of its calls failed */
    SVH_DEVICE = 5, /* OpenCL */
    SVH_MEMORY = 7
};

typedef struct {
    uint32_t size;
    int32_t code;
    int32_t status; /* SVH_PLUGIN: what the plugin's call returned, sv_status of smartvis_plugin.h; else 0 */
    char call[16];  /* ... and its name: "activate"; "" if no call is to blame */
    char reason[1024]; /* ... and the plugin's own words; "" if it has none */
    char text[1024];   /* the sentence, all of it */
} svh_error;

/* ---------------------------------------------------------------------------------------------- host -- */

enum { SVH_GUARD_AUTO = 0, SVH_GUARD_ON = 1, SVH_GUARD_OFF = 2 };

typedef struct {
    uint32_t size;
    uint32_t guard;      /* SVH_GUARD_*: every plugin but the house's, each, or none */
    const char *program; /* host_sim, which serves as the guarded plugin's process; NULL: the one that lies
                            beside this library, or in bin/ */
    /* Gets every line of plugins that are not guarded (SV_LOG_* of smartvis_plugin.h). On any thread. NULL:
     * warnings and errors are printed to standard error. A guarded plugin's always are. */
    void (*log)(void *context, int32_t severity, const char *text);
    void *context;
} svh_options;

typedef struct svh_host svh_host;

/* `options` may be NULL. OpenCL is opened by the first call that needs it, once for the host. SVH_USAGE,
 * SVH_MEMORY. */
SVH_EXPORT int32_t svh_open(const svh_options *options, svh_host **out, svh_error *error);
SVH_EXPORT void svh_close(svh_host *host); /* NULL is allowed; nothing more is made of it */

/* A runtime keeps a part of every activation that was, until OpenCL is closed: that happens after so many of
 * a host have ended, once nothing of it is on the device. Who keeps clippers ends all of them as often. */
SVH_EXPORT uint32_t svh_rests_after(void);

/* The version of the library with its commit, "1.0.0+6da99c0a3f21"; static. */
SVH_EXPORT const char *svh_version(void);

/* -------------------------------------------------------------------------------------------- volume -- */

/* What was scanned. */
enum {
    SVH_AUTO = 0, /* zeros that the border reaches were not, nor was a constant that lies outside a fan */
    SVH_ALL_SCANNED = 1,
    SVH_ZEROS = 2 /* every zero was not */
};

/* The face of a volume that the probe touches; the beams run to the opposite one. */
enum { SVH_LOW_Z = 0, SVH_HIGH_Z, SVH_LOW_Y, SVH_HIGH_Y, SVH_LOW_X, SVH_HIGH_X };

/* A volume in memory, of `bytes` or `values`: only read, until svh_volume_take returns. */
typedef struct {
    uint32_t size, n[3]; /* voxels along x, y, z */
    double spacing[3];   /* mm; ignored if unsaid */
    uint32_t unsaid;     /* nobody knows the spacing */
    uint32_t scanned;    /* SVH_AUTO, ...; a `mask` takes its place */
    double direction[9]; /* row-major; column a is where index a grows to in the patient (left, back, head),
                            at right angles; zeros: not known */
    double origin[3];    /* mm in the patient: where the centre of the first voxel lies */
    uint32_t probe;      /* SVH_LOW_Z, ... */
    uint32_t probe_said; /* ... and that is known */
    uint32_t apex_said;  /* where the lines meet that scanned it is known, */
    double apex[3];      /* ... mm along its axes from its corner; the probe is said, too */
    double
        window[2]; /* values that become 0 and 255; both 0: bytes as they are, other values by their range */
    const uint8_t *bytes; /* the voxels, x fastest, or ... */
    const double *values; /* ... the voxels as numbers; NaN was not scanned */
    const uint8_t *mask;  /* 1 where a voxel was scanned, or NULL */
    const char *kretz; /* the Kretz file whose Cartesian copy `bytes` are, or NULL: what lies in it is seen */
    uint32_t number, mirrored; /* of it: which volume; its angles grow to the other side */
} svh_voxels;

/* How a file is read: MetaImage or Kretz. */
typedef struct {
    uint32_t size;
    uint32_t number;   /* of a sequence: which volume */
    uint32_t scanned;  /* SVH_AUTO, ... */
    uint32_t mirrored; /* Kretz: angles grow to the other side */
    double spacing[3]; /* mm, instead of what the file says; zeros: that */
    double window[2];  /* as above */
    uint32_t probe, probe_said;
} svh_file;

/* What is known of a volume that was taken. Texts and levels are the volume's. */
typedef struct {
    uint32_t size, n[3];
    double spacing[3];
    uint32_t unsaid;
    const uint8_t *levels; /* grey levels as the machine has them: 0 was not scanned */
    double low, high;      /* the values that became 0 and 255 */
    double outside;        /* what lies outside the scan, ... */
    uint32_t has_outside;  /* ... if a constant does */
    uint32_t has_beams;    /* it is seen in the probe's geometry */
    uint32_t fitted;       /* its fan was fitted anew; else that of a volume with the same outline is meant */
    const char *doubt;     /* what is not plausible about the size, or "" */
    const char *question;  /* what to ask of where the probe was, or "" */
    const char *beams;     /* how they ran, and how sure that is */
} svh_about;

typedef struct svh_volume svh_volume;

/* SVH_INPUT, SVH_USAGE, SVH_MEMORY. */
SVH_EXPORT int32_t svh_volume_take(svh_host *host, const svh_voxels *given, svh_volume **out,
                                   svh_error *error);
/* `how` may be NULL. SVH_USAGE, too, if the library was built without zlib, which files need. */
SVH_EXPORT int32_t svh_volume_read(svh_host *host, const char *path, const svh_file *how, svh_volume **out,
                                   svh_error *error);
SVH_EXPORT int32_t svh_volume_about(const svh_volume *volume, svh_about *out, svh_error *error);
SVH_EXPORT void svh_volume_free(svh_volume *volume); /* NULL is allowed */

/* ---------------------------------------------------------------------------------------------- view -- */

/* From where the camera looks while yaw and pitch are 0. */
enum {
    SVH_FROM_PROBE = 0,
    SVH_FROM_ANTERIOR,
    SVH_FROM_POSTERIOR,
    SVH_FROM_LEFT,
    SVH_FROM_RIGHT,
    SVH_FROM_SUPERIOR,
    SVH_FROM_INFERIOR
};

/* A camera, and the grid on which a plugin sees a volume through it. */
typedef struct {
    uint32_t size;
    uint32_t from;           /* SVH_FROM_* */
    double yaw, pitch, roll; /* degrees, as of `host_sim run` */
    uint32_t turned;         /* `rotation` is where the camera looks, and not the fields above */
    double rotation[9]; /* row-major: columns are the camera's right, down and forward in the volume's axes */
    uint32_t lowres;    /* pixels across; 0: 1 mm each, as host_sim has it */
    uint32_t around;    /* the box holds the volume from every direction, as an orbit's does */
    /* Out: */
    uint32_t n[3]; /* width, height, slices of the grid */
    double box[2]; /* mm across, and deep */
    /* Where the probe was: fields of sv_frame, as svh_plan finds them. Who knows better writes over them. */
    float probe_rotation[9], probe_side[3];
    uint32_t beams;
    float beam_apex_mm[3], beam_sweep_mm;
} svh_view;

/* Fills in the grid, and the rotation. SVH_INPUT, SVH_USAGE. */
SVH_EXPORT int32_t svh_plan(const svh_volume *volume, svh_view *view, svh_error *error);

/* The voxels of that grid, n[0] * n[1] * n[2] bytes, and of every ray the first scanned slice and the first
 * one behind the scan, n[0] * n[1] pairs; the caller's. SVH_DEVICE. */
SVH_EXPORT int32_t svh_convert(svh_volume *volume, const svh_view *view, uint8_t *voxels, uint16_t *ranges,
                               svh_error *error);

/* A user's mark, which changes a surface that was found. */
typedef struct {
    double place[3]; /* mm along the volume's x, y, z from the centre of its first voxel */
    double radius;   /* mm, > 0 */
    uint32_t keep;   /* else remove */
    uint32_t reserved;
} svh_mark;

/* ------------------------------------------------------------------------------------------- clipper -- */

/* A plugin with its settings. It is activated by the first volume, and anew when the grid of a volume, or the
 * value of a parameter that only activation reads, is another one. */
typedef struct svh_clipper svh_clipper;

/* `path`: a library of plugins; NULL: smartvis beside this library, or where host_sim looks. `id`: one of its
 * plugins; NULL: the first. SVH_PLUGIN names file and cause. */
SVH_EXPORT int32_t svh_clipper_open(svh_host *host, const char *path, const char *id, svh_clipper **out,
                                    svh_error *error);
SVH_EXPORT void svh_clipper_free(svh_clipper *clipper); /* NULL is allowed */

/* Texts are the clipper's. */
typedef struct {
    uint32_t size;
    uint32_t features, queues; /* of sv_descriptor */
    uint32_t guarded;
    uint32_t parameters; /* how many */
    const char *path, *id, *name, *vendor, *version, *summary;
} svh_plugin;

SVH_EXPORT int32_t svh_clipper_about(const svh_clipper *clipper, svh_plugin *out, svh_error *error);

/* A parameter, as sv_param_info has it. Texts are the clipper's, UTF-8 as the plugin wrote them. */
typedef struct {
    uint32_t size;
    uint32_t id;
    uint32_t type;  /* SV_PARAM_FLOAT, ... */
    uint32_t flags; /* SV_PARAM_PRIMARY, ... */
    double default_value, min_value, max_value, step, display_min, display_max;
    const char *key, *label, *unit, *help, *group;
} svh_param;

SVH_EXPORT int32_t svh_param_at(svh_clipper *clipper, uint32_t index, svh_param *out, svh_error *error);

/* The name of an enum's value: at most 63 bytes and a NUL. SVH_USAGE: it has none. */
SVH_EXPORT int32_t svh_param_name(svh_clipper *clipper, uint32_t id, double value, char name[64],
                                  svh_error *error);

/* Another value from the next volume on: "q=0.4", "method=wall", checked here (SVH_USAGE); or by number, as
 * it is. svh_reset: the defaults for all. */
SVH_EXPORT int32_t svh_set(svh_clipper *clipper, const char *setting, svh_error *error);
SVH_EXPORT int32_t svh_set_number(svh_clipper *clipper, uint32_t id, double value, svh_error *error);
SVH_EXPORT void svh_reset(svh_clipper *clipper); /* NULL is allowed */

/* Bytes that the plugin needs for this view and the values that are set (smartvis.needs/1); of one that does
 * not tell, of a volume and its maps. SVH_PLUGIN: it refuses them. */
SVH_EXPORT int32_t svh_needs(svh_clipper *clipper, const svh_volume *volume, const svh_view *view,
                             uint64_t *bytes, svh_error *error);

enum {
    SVH_CONTINUES = 1u,   /* the volume continues the one before, as of a probe that is held on */
    SVH_SAME_VOLUME = 2u, /* it is the very one, by another camera or with other values */
    SVH_TIMED = 4u        /* with the plugin's own clock (smartvis.timing/1), which costs time */
};

/* What is to be told of a volume with it. */
typedef struct {
    uint32_t size;
    uint32_t flags;        /* SVH_CONTINUES, ... */
    uint64_t time_ns;      /* when it was acquired; 0: unknown */
    const svh_mark *marks; /* change the map, in their order */
    uint32_t mark_count;
} svh_frame;

/* What a frame came to. Maps are the clipper's, width * height values row by row, until its next call. */
typedef struct {
    uint32_t size;
    uint32_t n[3];           /* width, height, slices */
    double spacing[3];       /* mm between pixels, and slices */
    int32_t outcome;         /* SV_OK 0, SV_NO_SURFACE 1 or SV_PARTIAL 2 */
    uint32_t clips;          /* the map may be used */
    const float *depth;      /* slices along the view; 0 or less clips nothing */
    const uint8_t *status;   /* SV_POINT_* */
    const float *confidence; /* 0 .. 1, or NULL */
    uint32_t points, unfilled;
    uint32_t knows_fluid; /* the method has a confidence: */
    float fluid_threshold;
    uint32_t open_rays;
    uint32_t knows_points; /* the method starts from points: */
    float bone_threshold, volume_max;
    uint32_t passes;
    float reconstruct_ms; /* SVH_TIMED: what the surface took by the plugin's own clock; else 0 */
    uint32_t try_id; /* the parameter that takes the doubtful surface all the same, and its value; 0: none */
    double try_value;
    const char *why; /* why nothing is clipped, or a doubtful surface, for who holds the probe, or "" */
} svh_result;

/* Clips one volume. `view` NULL: from the probe; else its grid must be planned. `frame` may be NULL. */
SVH_EXPORT int32_t svh_clip(svh_clipper *clipper, svh_volume *volume, const svh_view *view,
                            const svh_frame *frame, svh_result *out, svh_error *error);

/* The last volume again with other values of adjustable parameters; its marks hold. The volume must still be
 * there. */
SVH_EXPORT int32_t svh_adjust(svh_clipper *clipper, const uint32_t *ids, const double *values, uint32_t count,
                              svh_result *out, svh_error *error);

/* ------------------------------------------------------------------------- what a depthmap makes of it -- */

/* Of a depthmap on the view's grid, most often that of a result. svh_mark_depth applies marks to it.
 * svh_mask: 1 where a voxel is kept, 0 where it lies before the map. svh_clipped: the levels where they are
 * kept, else 0. Both write as many bytes as the volume has voxels. */
SVH_EXPORT int32_t svh_mark_depth(const svh_volume *volume, const svh_view *view, const svh_mark *marks,
                                  uint32_t count, float *depth, svh_error *error);
SVH_EXPORT int32_t svh_mask(const svh_volume *volume, const svh_view *view, const float *depth, uint8_t *mask,
                            svh_error *error);
SVH_EXPORT int32_t svh_clipped(const svh_volume *volume, const svh_view *view, const float *depth,
                               uint8_t *levels, svh_error *error);

/* The clipping surface, as surface.ply has it: three floats a vertex, in mm of the patient, and three numbers
 * of vertices a triangle, whose front is towards the camera. svh_mesh_free gives the memory back. */
typedef struct {
    uint32_t size;
    uint32_t vertex_count, triangle_count;
    float *vertices;
    int32_t *triangles;
} svh_mesh;

SVH_EXPORT int32_t svh_surface(const svh_volume *volume, const svh_view *view, const float *depth,
                               svh_mesh *out, svh_error *error);
SVH_EXPORT void svh_mesh_free(svh_mesh *mesh); /* NULL is allowed */

#ifdef __cplusplus
}
#endif

#endif
