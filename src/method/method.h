/* SPDX-License-Identifier: MIT */
/*
 * Surface reconstruction methods (spec 4). A method gets a depth at every initial point and leaves one at
 * every pixel; the *chain* around it fetches the points, runs the pre-filter and hands them on.
 *
 *     ray states -> chain_gather -> maps -> [minimum filter, n passes] -> maps -> method -> surfaces -> S(q)
 *
 * At a reduced resolution chain_cells takes the place of chain_gather, and chain_spread follows the method.
 *
 * Linear methods run once for the near and once for the far ends, before q is known, and S(q) is one
 * multiply-add per pixel. The minimum filter, and every chain with it, is not linear: q is applied to the
 * points first, and another q means another run. Then the first surface plane holds the result and the second
 * holds zeros.
 *
 * To add a method: one file method_<name>.c with a table like those below, its kernels in
 * cl/method_<name>.cl, which CMakeLists.txt embeds, its definition in src/ref/, and a line in method_list.h;
 * no other method is touched. It may not ask what it works on: maps, sizes, windows and weights are those of
 * its pipeline, at whatever resolution. The rules of the frame path hold: `run` only enqueues, a bounded
 * number of commands; what it needs, `create` makes.
 */
#ifndef SV_METHOD_H
#define SV_METHOD_H

#include "device/program.h"
#include "method_list.h"

struct sv_config;
struct sv_pipeline;

#define SV_MAX_METHOD_BUFFERS 14
#define SV_MAX_LEVELS         14 /* of a pyramid over 8192 pixels */

/* Sizes of a pyramid's levels, the map itself first; offsets count pixels from the first level's start. */
typedef struct {
    uint32_t count;
    uint32_t width[SV_MAX_LEVELS], height[SV_MAX_LEVELS], offset[SV_MAX_LEVELS];
    uint32_t pixels; /* of all levels together */
} sv_levels;

/* What a method keeps from activate to deactivate. */
typedef struct {
    sv_kernel_set kernels;
    cl_mem buffer[SV_MAX_METHOD_BUFFERS];
    sv_levels levels;
    uint32_t capacity; /* spline: points it can solve for */
} sv_method_state;

/* Kernel source, embedded by the build. */
typedef struct {
    const unsigned char *text;
    size_t size;
} sv_source;

typedef struct {
    bool linear;
    const char *const *kernels; /* names, NULL-terminated; NULL: the method has no kernels of its own */
    sv_source (*source)(void);
    uint32_t (*commands)(const struct sv_config *config); /* most that one run enqueues; sizes the timing */
    sv_status (*create)(struct sv_pipeline *pipeline, sv_method_state *state); /* buffers */

    /* A method that needs more of the volume than the points: called for every slab, from
     * pipeline->next_slice on, with the slab's texture in `buffer` from byte `offset` on. It may be NULL. */
    sv_status (*slab)(struct sv_pipeline *pipeline, sv_method_state *state, cl_mem buffer, uint64_t offset,
                      uint32_t slice_count);

    /* From pipeline->chain.maps to the surfaces, planes 0 .. planes - 1. With no point it must change
     * nothing: the surfaces hold zeros. */
    sv_status (*run)(struct sv_pipeline *pipeline, sv_method_state *state, uint32_t planes);
} sv_method;

#define SV_METHOD_TABLE(NAME, value, key) extern const sv_method sv_method_##key;
SV_METHODS(SV_METHOD_TABLE)
#undef SV_METHOD_TABLE

/* The part of the pipeline between the points and the surfaces. */
typedef struct {
    const sv_method *method;
    bool plain_mean; /* the mean filter on its own takes its points from the sums: no maps, no gather */
    bool linear;     /* in the depths: one run serves every q */
    bool doubles;    /* the solvers compute in float64 */
    sv_method_state state, filter; /* of the method, of the pre-filter */
    sv_kernel_set gather;
    cl_mem maps; /* near and far plane: float32 depth at initial points, INFINITY elsewhere; and a plane of
                    how many points a point stands for: 1, or those of a cell */
} sv_chain;

/* Where the methods work: the frame's own map, or the smaller one of a reduced resolution, which is a
 * pipeline of its own with a part of the buffers. A method sees only the pipeline it is given. */
struct sv_pipeline *sv_chain_map(struct sv_pipeline *pipeline);

/* Most commands that one frame enqueues between points and surfaces. */
uint32_t sv_chain_commands(const struct sv_config *config);

sv_status sv_chain_create(struct sv_pipeline *pipeline);
void sv_chain_destroy(sv_chain *chain);

/* Enqueues everything from the points to the surfaces. */
sv_status sv_chain_run(struct sv_pipeline *pipeline, float q);

/* What methods share. */
sv_levels sv_levels_make(uint32_t width, uint32_t height); /* sides are halved, rounding up, down to 1 x 1 */
sv_status sv_chain_done(struct sv_pipeline *pipeline,
                        uint32_t passes);                     /* record: every pixel has a surface */
sv_status sv_chain_done_passes(struct sv_pipeline *pipeline); /* record: by the counts of the passes */

/* The mean filter on its own, points included, in one launch by one work item. */
sv_status sv_mean_single(struct sv_pipeline *pipeline);

/* The minimum filter on plane 0 of the maps, which keeps the initial points only; the pre-filter. */
sv_status sv_minimum_prefilter(struct sv_pipeline *pipeline, sv_method_state *state, uint32_t k,
                               uint32_t passes);

/* Enqueues what the method wants of a slab, if it wants any. */
sv_status sv_chain_slab(struct sv_pipeline *pipeline, cl_mem buffer, uint64_t offset, uint32_t slice_count);

/* Waits, and reads the confidence (width * height, may be NULL) and the SV_COST_INFO_* words of the last
 * frame of method cost. */
sv_status sv_cost_read(struct sv_pipeline *pipeline, float *confidence, uint32_t *info);

/* The same frame's confidence, float32, one plane of the pixels; the method's own buffer. */
cl_mem sv_cost_confidence(const struct sv_pipeline *pipeline);

/* Waits, and reads what the spline of the last frame came to: points, cells per side of the merging grid (0:
 * not merged), rank of the plane, unknowns left out, condition estimate, residual in slices. */
#define SV_SPLINE_REPORT_WORDS 6
sv_status sv_spline_read(struct sv_pipeline *pipeline, float report[SV_SPLINE_REPORT_WORDS]);

#endif
