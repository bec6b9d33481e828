/* SPDX-License-Identifier: MIT */
/*
 * What method wall's two layouts of the work share: rows, a work item a row of rays or cells with vectors of
 * rays, for CPUs; and items, a work item a ray, a block, a cell or a pixel, for GPUs (docs/architecture.md).
 * A layout says which kernels there are, what each is launched over, and with which of the method's buffers.
 */
#pragma once

#include "method/method.h"
#include "wall/wall_shared.h"
#include "wall_grid.h"

/* The method's buffers. */
enum {
    SV_WALL_SPANS,
    SV_WALL_SUMS,   /* of the layer that the slabs are in */
    SV_WALL_RANGES, /* of pixels */
    SV_WALL_LEVELS,
    SV_WALL_SMOOTHED,   /* smoothed levels if layers are one slice; else LEVELS takes its place */
    SV_WALL_RELATIVE,   /* levels relative to the threshold around them */
    SV_WALL_WINDOWS,    /* sums and counts of bright blocks near cells */
    SV_WALL_FRONTS,     /* for each row of cells, rays that begin with a few dark layers */
    SV_WALL_ROW_MAXIMA, /* brightness dilated along x */
    SV_WALL_BRIGHT,
    SV_WALL_FLAGS, /* of cells */
    SV_WALL_LIMBS, /* along the beams: what floats, LIMB_PLANES words a layer of a plane of beams */
    SV_WALL_RAYS,
    SV_WALL_HISTOGRAMS, /* later the sums of probabilities, SV_WALL_FETUS; then SV_WALL_GAPS */
    SV_WALL_TABLES,
    SV_WALL_INFO,
    SV_WALL_SCRATCH,
    SV_WALL_COSTS,
    SV_WALL_FINE, /* costs after the Gaussian */
    SV_WALL_PLANES,
    SV_WALL_CONFIDENCE,
    SV_WALL_BUFFERS,
    /* the same of a grid along the beams, from here on, which alone has LIMBS; SPANS, SUMS, RANGES, SMOOTHED,
     * TABLES and CONFIDENCE have no bytes there */
    SV_WALL_BEAMS = SV_WALL_BUFFERS,
    SV_WALL_TOLD = SV_WALL_BEAMS + SV_WALL_INFO, /* what the beams say */
    SV_WALL_ALL_BUFFERS = 2 * SV_WALL_BUFFERS
};
_Static_assert(SV_WALL_ALL_BUFFERS <= SV_MAX_METHOD_BUFFERS, "every buffer has a place");
enum { SV_WALL_FETUS = SV_WALL_HISTOGRAMS, SV_WALL_GAPS = SV_WALL_HISTOGRAMS };
enum { SV_WALL_WINDOW_SUMS = SV_WALL_SCRATCH };
enum { SV_WALL_RIM = SV_WALL_COSTS }; /* once the costs are smoothed: where the surface goes on to */

/* What a kernel is launched over. */
typedef enum {
    SV_WALL_ONCE,       /* one work item */
    SV_WALL_ROWS,       /* a work item a row of rays */
    SV_WALL_ALL_LAYERS, /* a work item a layer */
    SV_WALL_CELL_ROWS,  /* a work item a row of cells */
    SV_WALL_PIXEL_ROWS, /* a work item a row of pixels */
    SV_WALL_WORDS,      /* a work item for 8 columns of cells and SV_WALL_LAYERS layers */
    SV_WALL_ONE_GROUP,  /* one work group */
    SV_WALL_GROUPS,     /* a work group a row of cells */
    SV_WALL_EACH_LAYER, /* a work group a layer */
    SV_WALL_EACH_RAY,   /* a work item a ray */
    SV_WALL_EACH_CELL,  /* a work item a cell of every layer */
    SV_WALL_EACH_PIXEL
} sv_wall_over;

/* Arguments besides the layout, which is always the first, and the method's buffers: numbers before these,
 * the record, or place and buffer of the depthmap, behind. */
enum { SV_WALL_BOUNDS = 1, SV_WALL_SCRATCH_WORDS = 2, SV_WALL_RECORD = 4, SV_WALL_DEPTH = 8 };

/* Kernels that are not launched for every volume. */
typedef enum {
    SV_WALL_ALWAYS,
    SV_WALL_IF_SMOOTHED,
    SV_WALL_UNLESS_TOLD, /* the beams do not say whether there is a surface */
    SV_WALL_FOR_BEAMS    /* along the beams alone */
} sv_wall_when;

typedef struct {
    int kernel;
    sv_wall_over over;
    int buffers[11]; /* up to -1 */
    int takes;
    sv_wall_when when;
} sv_wall_launch;

typedef struct {
    const char *const *kernels; /* names, NULL-terminated */
    sv_status (*slabs)(const sv_map *map, sv_method_state *state, const sv_placed_slabs *from);
    /* Makes the blocks of a grid along the beams, in place of the first launches. */
    sv_status (*gather)(const sv_map *map, sv_method_state *state, const sv_wall_grid *grid);
    /* The kernels that mark a camera's cells at samples of the beams, and let rays begin behind a near field
     * that is marked. */
    int mark, skip;
    const sv_wall_launch *launches; /* what follows the slabs, in this order */
    uint32_t count, first_at_q;     /* their number; the first one that depends on q */
    uint32_t
        reconstructs; /* the first one of SV_STAGE_RECONSTRUCT; before it all are of SV_STAGE_THRESHOLD */
    uint32_t gathered, verdict; /* those between are launched for the beams, too, with the latter */
    uint32_t near;              /* the first one that reads where rays begin behind the near field */
    uint32_t floated;           /* what comes before it finds limbs along the beams, of those between */
    uint32_t surrounded;        /* the first one that reads what surrounds cells, and where limbs float */
} sv_wall_work;

/* The method's own: the layouts of an activation, with what the frame says of them, and their words of
 * scratch memory in a row. */
typedef struct {
    sv_wall_layout camera, beams;
    uint32_t camera_words, beam_words;
    bool holds;    /* the answer of the beams holds for the last frame's volume */
    sv_beams seen; /* the beams as the camera of the last frame saw them: where limbs float is its own */
} sv_wall_own;
sv_wall_own *sv_wall_own_of(sv_method_state *state);

/* Rounds up to a multiple of SV_WALL_LANES. */
size_t sv_wall_lanes_of(uint32_t values);

/* Returns the bytes of the cells' classes: whole lanes and whole groups of SV_WALL_LAYERS layers. */
size_t sv_wall_flags_bytes(const sv_wall_layout *layout);

/* True if pixels have ranges. */
bool sv_wall_is_bounded(const sv_config *config);

/* Launches what follows the slabs, `first` .. end - 1, for a camera or for the beams. `to`: for the kernel
 * that writes depths. */
sv_status sv_wall_launch_all(const sv_map *map, sv_method_state *state, const sv_wall_work *work,
                             uint32_t first, uint32_t end, bool beams, const sv_depth_target *to);

/* The layouts of cl/wall/wall_*.cl and of cl/wall/items_*.cl. */
extern const sv_wall_work sv_wall_rows, sv_wall_items;
extern const char *const sv_wall_rows_kernels[], *const sv_wall_items_kernels[];
sv_source sv_wall_rows_source(void);
sv_source sv_wall_items_source(void);
