/* SPDX-License-Identifier: MIT */
/*
 * A method of surface reconstruction (spec 4): a table that holds everything about it. It gets a depth at
 * every initial point of a map, or the slabs themselves, and leaves a surface at every pixel; the *chain*
 * around it (chain.h) fetches the points, runs the pre-filter and hands the surfaces on.
 *
 * Linear methods run once for the near and once for the far ends, before q is known, and S(q) is one
 * multiply-add per pixel. The minimum filter, and every chain with it, is not linear: q is applied to the
 * points first, and another q means another run. Then the first surface plane holds the result and the
 * second holds zeros.
 *
 * The rules of the frame path hold: `run` and `slabs` only enqueue, a bounded number of commands; what they
 * need, `buffers` makes. A method sees its map and nothing else of the frame.
 */
#pragma once

#include "common/sv_shared.h"
#include "device/program.h"
#include "device/queue.h"
#include "method/values.h"
#include "ref/ref_method.h"
#include "smartvis/confidence.h"
#include "sv_beams.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- what stays the same from frame to frame; from sv_format and the parameters that need reactivation */

typedef struct {
    uint32_t width, height, slices, max_slab_slices;
    uint32_t tiles_x, tile_w, tile_h, row_pitch; /* row_pitch of the texture as the kernels read it */
    uint32_t carrier;
    uint32_t padding; /* the voxel value that was not scanned; or SV_UNPADDED */
    bool ranged;      /* every frame brings the scanned range of every ray */
    float spacing[3]; /* mm between voxels; never 0: where the host does not know it, assumed */
    uint32_t substeps;
    uint32_t strategy;          /* SV_STRATEGY_*; AUTO is resolved by sv_pipeline_create */
    uint32_t method, prefilter; /* SV_METHOD_*, SV_PREFILTER_* */
    uint32_t merge_grid, spline_grid;
    bool float32; /* the solvers do without float64 even where the device has it */
    const void *host_memory;
    uint64_t host_memory_bytes;
} sv_config;

#define SV_UNPADDED 256u /* no voxel's value */

static inline bool sv_is_padded(const sv_config *c) {
    return c->padding != SV_UNPADDED;
}

/* ---- the map (map.c): what a method works on */

typedef struct {
    const sv_queue *queue;
    const sv_program *narrow,
        *wide; /* kernels with 32-bit sums, with 64-bit sums (NULL: nothing needs them) */
    const sv_config *config;
    uint32_t width, height;
    uint32_t padded_width; /* of the rows of every buffer: a multiple of SV_LANES */
    uint32_t bands;        /* bands of rows that work items share, strategy bands */
    uint32_t sum_bytes;    /* of a value in the mean filter's planes: 4, or 8 if a frame can need wide sums */
    bool doubles;          /* the spline's solver computes in float64 */

    /* Rows of padded_width. The map owns them, except for the last two, which are the frame's. */
    cl_mem status;   /* 8 bits a pixel: SV_STATUS_* */
    cl_mem surfaces; /* near, far: float32 slices */

    /* Near and far plane: float32 depth at initial points, INFINITY elsewhere. NULL if the method takes the
     * sums. */
    cl_mem points;

    /* The mean filter's first planes, which the points stage writes; NULL if the method takes the slabs. */
    cl_mem sums;

    cl_mem scanned; /* planes SV_SCANNED_*, 16 bits; NULL unless config->ranged */
    cl_mem record;  /* SV_REC_* */

    /* the frame under way, or the last one */
    sv_values values;
    sv_job job;
    const sv_program *program; /* narrow or wide */
} sv_map;

/* True if some frame of a method that takes sums can need 64-bit ones. */
bool sv_map_needs_wide(const sv_config *config);

/* Sizes of the map. Makes no buffer. `wide_sums`: planes of sums leave room for 64 bits. The pointed-to
 * objects must outlive the map. */
void sv_map_init(sv_map *map, const sv_queue *queue, const sv_config *config, bool wide_sums);

/* Makes the buffers that every method on points needs. */
sv_status sv_map_buffers(sv_map *map, cl_mem record);
/* Makes what is left where no points are looked for: a status map that says so. */
sv_status sv_map_status_buffer(sv_map *map, cl_mem record);

/* Makes the maps of the points. */
sv_status sv_map_point_buffers(sv_map *map);
void sv_map_release(sv_map *map);

/* Takes a frame's job and values, and chooses what depends on the map's size: passes, and the format
 * of the sums. */
void sv_map_begin(sv_map *map, const sv_job *job, const sv_values *values);

/* Notes in the map's record that every pixel has a surface after so many passes, or what the passes
 * themselves counted. */
sv_status sv_map_done_passes(const sv_map *map, uint32_t passes);

/* Begins a launch of one of the frame's kernels, by its name, with the map's job as the first argument. */
#define SV_LAUNCH(map, name)     sv_launch_begin((map)->queue, (map)->program->name, #name)
#define SV_LAUNCH_JOB(map, name) sv_launch_job((map)->queue, (map)->program->name, #name, &(map)->job)

/* ---- the method */

#define SV_MAX_METHOD_BUFFERS 42

/* What a method keeps from activate to deactivate. */
typedef struct {
    sv_kernel_set kernels;
    cl_mem buffer[SV_MAX_METHOD_BUFFERS];
    uint32_t capacity; /* spline: points it can solve for */
    union {
        max_align_t align;
        unsigned char bytes[2048];
    } own; /* of the method alone: `buffers` fills it, once an activation */
} sv_method_state;

/* What begin says of a frame besides its values and voxels. */
typedef struct {
    bool continues; /* the volume before is of the same scene: what it taught still holds */
    sv_beams beams;
} sv_frame_context;

/* Where a depthmap goes: width * height float32 without padding, from value `first` on. */
typedef struct {
    cl_mem buffer;
    cl_ulong first;
} sv_depth_target;

/* Kernel source, embedded by the build. */
typedef struct {
    const unsigned char *text;
    size_t size;
} sv_source;

/* Slabs as the kernels find them: their textures lie in `buffer`. One of 0 slices is not read (warm-up). */
typedef struct {
    cl_mem buffer;
    sv_batch batch;
} sv_placed_slabs;

/* One of them: its texture begins at byte `offset`. */
typedef struct {
    cl_mem buffer;
    uint64_t offset;
    uint32_t first_slice, slice_count;
} sv_placed_slab;

/* What the points stage has when one launch shall do all that is left of the frame. */
typedef struct {
    cl_mem state8, state16, histogram;
} sv_ray_states;

#define SV_METHOD_SCANNED 0 /* the place of scanned_planes in its list (cl/profile/scanned.cl) */

typedef struct {
    /* What it means: the scalar definition, which the self-test holds the device to, within its bound. */
    const sv_ref_method *definition;

    /* SV_USES(...) of every parameter that matters for it: the others leave its surface as it is. */
    uint64_t parameters;

    bool linear;     /* in the depths of the points */
    bool takes_sums; /* on its own it starts from the planes that the points stage wrote: no maps of points */

    const char *const *kernels; /* names, NULL-terminated */
    sv_source (*source)(void);
    /* Others for strategy rays, where a work item a ray needs kernels of its own; or NULL. */
    const char *const *ray_kernels;
    sv_source (*ray_source)(void);

    /* Makes its buffers, and nothing but buffers: the queue may be counting (device/queue.h). */
    sv_status (*buffers)(const sv_map *map, sv_method_state *state);

    /* Enqueues what is needed once, after the buffers; or NULL. */
    sv_status (*prepare)(const sv_map *map, sv_method_state *state);

    /* For methods that need more of the volume than the points: all three, and then no `run`; or NULL. Such a
     * method is asked for no points and is not filtered; the map has no surfaces; and SV_METHOD_SCANNED is a
     * kernel of its own program, so that no other is built for it. `slabs` takes slabs, and
     * `find` all of them: it writes the record, sv_stats' part. `place` writes the depthmap at q, after
     * `find` and for every other q. */
    sv_status (*slabs)(const sv_map *map, sv_method_state *state, const sv_placed_slabs *slabs);
    sv_status (*find)(const sv_map *map, sv_method_state *state, const sv_frame_context *frame);
    sv_status (*place)(const sv_map *map, sv_method_state *state, float q, const sv_depth_target *to);

    /* From map->points to the surfaces, planes 0 .. planes - 1. With no point it must change nothing: the
     * surfaces hold zeros. */
    sv_status (*run)(const sv_map *map, sv_method_state *state, uint32_t planes);

    /* Passes that the record shall name after a run; or NULL: the run writes the record itself. */
    uint32_t (*passes)(const sv_map *map);

    /* Points and surfaces in one launch by one work item, strategy single; or NULL. */
    sv_status (*single)(const sv_map *map, sv_method_state *state, const sv_ray_states *rays);

    /* The last frame's confidence, float32 0..1, one plane of width * height without padding; or NULL:
     * it gives none. */
    cl_mem (*confidence)(const sv_method_state *state);

    /* Waits, and reads what is known of the last frame, behind `size`; or NULL. */
    sv_status (*confidence_report)(const sv_map *map, const sv_method_state *state,
                                   sv_confidence_report *out);
} sv_method;

#define SV_USES(NAME) (UINT64_C(1) << SV_PARAM_##NAME)
/* What matters where the initial points decide whether there is a surface at all (cl/common/record.clh). */
#define SV_USES_EVIDENCE                                                                                     \
    (SV_USES(FLUID_THRESHOLD) | SV_USES(BONE_MODE) | SV_USES(EVIDENCE) | SV_USES(MIN_GAP) |                  \
     SV_USES(DROP_EMPTY) | SV_USES(SUBSTEPS))
/* What matters for every method that starts from them. */
#define SV_USES_POINTS (SV_USES_EVIDENCE | SV_USES(PREFILTER))
_Static_assert(SV_PARAM_ID_END <= 64, "sv_method.parameters has a bit per parameter");

/* The tables of the methods. */
#define SV_METHOD_TABLE(NAME, value, key) extern const sv_method sv_method_##key;
SV_METHODS(SV_METHOD_TABLE)
#undef SV_METHOD_TABLE

/* The table of method SV_METHOD_*; NULL if no method has that value. */
const sv_method *sv_method_of(uint32_t method);

/* True if the method's surface depends on the parameter SV_PARAM_*. */
bool sv_method_uses(const sv_method *method, uint32_t parameter);

/* Enqueues what a method wants of one slab. */
typedef sv_status sv_take_slab(const sv_map *map, sv_method_state *state, const sv_placed_slab *slab);

/* For methods that have launches of their own for every slab: hands over one after the other. */
sv_status sv_slabs_one_by_one(const sv_map *map, sv_method_state *state, const sv_placed_slabs *slabs,
                              sv_take_slab *take);

/* A launch of a method's kernel on a slab, with the arguments that all such kernels begin with: from the
 * texture to the scanned ranges, as items_range has them (cl/wall/items_downsample.cl). `unread`: any buffer;
 * the kernel gets it where frames bring no ranges. */
sv_launch sv_slab_launch(const sv_map *map, cl_kernel kernel, const char *name, const sv_placed_slab *slab,
                         cl_mem unread);

/* The same for slabs together: a batch instead of an offset, the first slice and their number. */
sv_launch sv_slabs_launch(const sv_map *map, cl_kernel kernel, const char *name, const sv_placed_slabs *slabs,
                          cl_mem unread);

/* The minimum filter on plane 0 of the map's points, which keeps the initial points only; the pre-filter. */
sv_status sv_minimum_prefilter(const sv_map *map, sv_method_state *state, uint32_t k, uint32_t passes);
