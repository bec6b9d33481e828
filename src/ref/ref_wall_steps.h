/* SPDX-License-Identifier: MIT */
/* The steps of the surface told by the wall, in their order (docs/surface.md). Each has what it needs from
 * those before it. Functions that allocate return false or NULL if memory runs out. */
#pragma once

#include "ref/ref_volume.h"
#include "wall_layout.h"

/* ---- blocks of about 2 mm around rays half as far apart (ref_wall_blocks.c) */

/* Block z of ray (x, y) at means[(z * rows + y) * columns + x]: the weighted mean of its voxels, rounded half
 * up; 0 if the block was not scanned. Blocks first .. end - 1 of a ray were scanned: all of their voxels
 * were. `levels`: the means, smoothed along the rays where a layer is one slice. `relative`: the levels in
 * units of the threshold around them, which is SV_WALL_TISSUE (sv_wall_relate_levels); what is brighter is
 * tissue. */
typedef struct {
    uint32_t columns, rows, layers;
    uint8_t *means, *levels, *relative;
    uint16_t *first, *end;
    uint32_t rays; /* that were scanned */
} sv_wall_blocks;

/* Blocks of a layout that were not scanned. */
bool sv_wall_blocks_allocate(const sv_wall_layout *layout, sv_wall_blocks *blocks);

bool sv_wall_blocks_create(const sv_wall_volume *volume, const sv_wall_layout *layout,
                           sv_wall_blocks *blocks);
void sv_wall_blocks_destroy(sv_wall_blocks *blocks);

/* The brightness of every cell, at [(z * cells[1] + y) * cells[0] + x]: the maximum within layout->dilation
 * cells of its own, in the same layer, of half the sums of the means of a block and the one behind it,
 * rounded half up; blocks that were not scanned count as 0. The caller frees it. */
uint8_t *sv_wall_brightness_map(const sv_wall_layout *layout, const sv_wall_blocks *blocks);

/* ---- the same blocks along the beams (ref_wall_beams.c) */

/* Takes the levels at a grid's samples, each from the nearest block of the camera. `layout`: the grid's. */
bool sv_wall_gather(const sv_wall_blocks *camera, const sv_wall_grid *grid, const sv_wall_layout *layout,
                    sv_wall_blocks *blocks);

/* Of every sample of the grid, laid out like its blocks: 1 if a limb floats there (ref_wall_limbs.c). It is
 * thin tissue behind the first run of its beam, and tissue of first runs, or the side of what was scanned,
 * reaches it through tissue of its layer from one of four sides at most. `blocks`: with their relative
 * levels. The caller frees it. */
uint8_t *sv_wall_limbs_of(const sv_wall_layout *layout, const sv_wall_blocks *blocks);

/* What the beams say. */
typedef struct {
    sv_wall_outcome outcome;
    uint32_t share; /* of the dark blocks in gaps, of 1000 */
    const sv_wall_grid *grid;
    const sv_wall_layout *layout; /* the grid's */
    uint8_t *limbs;               /* NULL: none were looked for; and then the next is NULL, too */
    uint8_t *near_field;          /* 1: a sample that was skipped (sv_wall_near_field_of) */
} sv_wall_told;

/* Of every sample of the grid, laid out like its blocks: 1 if it is not black and lies before its beam's
 * scan, because the near field was skipped. The caller frees it. */
uint8_t *sv_wall_near_field_of(const sv_wall_layout *layout, const sv_wall_blocks *blocks);

/* Gives the cells of a camera that lie near samples the flag SV_WALL_FLOATS. `samples`: of told->grid, 1
 * where there is one. `cells`: laid out like the brightness map. */
void sv_wall_mark_cells(const sv_wall_told *told, const uint8_t *samples, const sv_wall_layout *camera,
                        uint8_t *cells);

/* ---- grey levels: the threshold between fluid and tissue (ref_wall_levels.c) */

/* Counts the scanned blocks of one ray a cell: of four rays that overlap by half it tells as much as all. It
 * is the ray next to the middle of the image, so that a mirrored volume has the same histogram, and both rays
 * of a cell that lies in the middle. */
void sv_wall_histogram(const sv_wall_blocks *blocks, uint64_t histogram[256]);

typedef struct {
    bool two;           /* there are two classes: false if all blocks are equal, or there is none */
    uint32_t threshold; /* largest level of the dark class */
    uint32_t bright;    /* mean of the bright class, in units of 1 / SV_WALL_LEVEL_ONE */
    uint32_t dark;      /* layout->dark_rank of the blocks are darker, in the same units; 1 at least */
    uint32_t fluid;     /* the darkest layout->fluid_rank of the blocks have at most this level */
} sv_wall_levels;

/* The classes are split midway between the means of their square roots, until the split no longer moves
 * (isodata). */
sv_wall_levels sv_wall_levels_of(const sv_wall_layout *layout, const uint64_t histogram[256]);

/* The level below which `rank` per mille of the histogram lie, in units of 1 / SV_WALL_LEVEL_ONE; a level's
 * count is spread evenly over level +- 0.5. */
uint32_t sv_wall_quantile(const uint64_t histogram[256], uint32_t rank);

/* ---- levels relative to the threshold around them (ref_wall_relative.c) */

/* Fills blocks->relative. The brightness around a block is the mean of the blocks above levels->threshold
 * within layout->window of its cell. False: no memory. */
bool sv_wall_relate_levels(const sv_wall_layout *layout, const sv_wall_levels *levels,
                           sv_wall_blocks *blocks);

/* Skips the near field: dead zone, ringing and gel are dark, but no fluid. If enough rays begin with at most
 * layout->near_field dark layers, the scan of these rays begins behind them. Fluid in front of a limb near
 * the probe is dark, too, but on few rays. Changes blocks->first. */
void sv_wall_skip_near_field(const sv_wall_layout *layout, sv_wall_blocks *blocks);

/* The same where the beams tell it: rays that begin with dark blocks in marked cells begin behind them,
 * however many these are. False: no memory. */
bool sv_wall_skip_told_field(const sv_wall_told *told, const sv_wall_layout *layout, sv_wall_blocks *blocks);

/* Dim blocks at the start of a ray's scan are tissue: SV_WALL_DIM_TISSUE. Changes blocks->relative. */
void sv_wall_fill_dim_fronts(const sv_wall_layout *layout, sv_wall_blocks *blocks);

/* Parts the first run of a ray, if it begins where the scan does and fluid follows it, where a valley shows
 * that a limb lies against the wall: the sum of the levels of the ray and of those SV_WALL_VALLEY_REACH
 * around it is below layout->valley of the largest one in front of it in the run, and of the largest one
 * behind it. It lies behind the skin, and at most layout->full_distance layers before the run's end. Such
 * blocks become fluid. Changes blocks->relative. (ref_wall_valleys.c) */
void sv_wall_part_valleys(const sv_wall_layout *layout, sv_wall_blocks *blocks);

/* ---- how bright the wall is, and how likely tissue of a brightness is the fetus (ref_wall_evidence.c) */

typedef struct {
    uint32_t wall_rays;
    bool bare;                               /* there is no wall: the next two are assumed */
    uint32_t wall;                           /* grey level, in units of 1 / SV_WALL_LEVEL_ONE */
    int32_t spread;                          /* ln of the odds, fixed-point */
    uint32_t first_run[256], later_run[256]; /* probability of the fetus by brightness */
} sv_wall_evidence;

/* Everything that rays are judged from. The pointers are borrowed. */
typedef struct {
    const sv_wall_layout *layout;
    const sv_wall_blocks *blocks;
    const uint8_t *brightness;   /* of every cell (sv_wall_brightness_map) */
    const uint8_t *surroundings; /* of every cell (sv_wall_surroundings_map) */
} sv_wall_scan;

/* True if the block in layer z of a ray is tissue. */
bool sv_wall_is_tissue(const sv_wall_scan *scan, size_t ray, size_t z);

/* The brightness of a ray in layer z is its cell's. */
uint8_t sv_wall_brightness_at(const sv_wall_scan *scan, size_t ray, size_t z);

/* The first run of tissue of a ray: layers [begin, end), both the end of the scan if there is none.
 * `touches`: it begins where the scan does. `fluid`: fluid follows it. */
typedef struct {
    uint32_t begin, end;
    bool touches, fluid;
} sv_wall_run;
sv_wall_run sv_wall_first_run(const sv_wall_scan *scan, size_t ray);

void sv_wall_evidence_of(const sv_wall_scan *scan, const sv_wall_levels *levels, sv_wall_evidence *out);

/* ---- what surrounds tissue in its layer (ref_wall_surroundings.c) */

/*
 * Tissue that the wall encloses lies behind fluid and is wall all the same, as behind a bladder. Tissue
 * beside the fetus may be a limb that lies against the wall.
 *
 * A cell is tissue, wall, or tissue of a later run, if at least SV_WALL_MAJORITY of its rays are. A ray is
 * wall in its first run, if that touches the start of the scan. The fetus: cells of later runs that are not
 * enclosed, and whose probability is SV_WALL_LIKELY at least.
 *
 * Enclosed: connected to the wall through tissue on three sides at least, of left, right, above, below.
 * Flanked: connected to the fetus so on the left and on the right, or above and below. One side: on some
 * side only.
 */
enum { SV_WALL_ENCLOSED = 1, SV_WALL_FLANKED = 2, SV_WALL_ONE_SIDE = 4, SV_WALL_FLOATS = 8 };

/* Returns the flags of every cell of every layer, laid out like the brightness map. It does not read
 * `scan->surroundings`. The caller frees the map. */
uint8_t *sv_wall_surroundings_map(const sv_wall_scan *scan, const sv_wall_evidence *evidence);

/* The flags of the ray's cell. */
uint8_t sv_wall_surroundings_at(const sv_wall_scan *scan, size_t ray, size_t z);

/* ---- what rays pay for being clipped at every layer (ref_wall_costs.c) */

/* Costs in units of 1 / SV_WALL_COST_ONE: cell c clipped at layer z at [c * layers + z]. A cell pays the mean
 * of its two by two rays, rounded half up; a ray that was not scanned pays nothing. */
typedef struct {
    uint32_t *all;    /* the distance to the fluid, a cut fetus, an occluder that is left, a wrong fluid */
    uint64_t fetus;   /* sum over the rays of the probability that the fetus is on them */
    uint16_t *fronts; /* of every ray: where the run begins in which the fetus has more likely begun than
                         not; layout->layers: there is none, or no fluid in front of it */
    uint16_t *shown;  /* of every ray: the probability that the fetus is on it */
} sv_wall_costs;

bool sv_wall_costs_create(const sv_wall_scan *scan, const sv_wall_evidence *evidence, sv_wall_costs *costs);
void sv_wall_costs_destroy(sv_wall_costs *costs);

/* ---- from the costs to the maps (ref_wall_surface.c) */

/* Counts blocks as dark as fluid: all, and those in the gap of their ray. The gap is the fluid that the
 * surface lies in, or before which it lies in tissue, if tissue lies on both of its sides. Of dim tissue in
 * front of it the first layout->dim_front layers do not count. */
typedef struct {
    uint64_t dark, in_gaps;
    uint64_t rays, open; /* scanned rays, and those whose scan begins in the fluid */
} sv_wall_gaps;

/* Writes the maps of depth and confidence. `told`: the outcome, or NULL: the gaps tell it, and `costs`
 * whether the fetus is seen. */
bool sv_wall_select_surface(const sv_wall_scan *scan, const sv_wall_levels *levels,
                            const sv_wall_costs *costs, const sv_wall_outcome *told, float *depth,
                            float *confidence, sv_wall_gaps *gaps, sv_wall_outcome *outcome);

/* ---- what a surface costs, and how sure that makes it (ref_wall_between.c) */

/* What a ray pays at a layer, in units of 1 / SV_WALL_FINE_COST_ONE: linear between the smoothed costs of the
 * four cells around it, rounded half up. A ray lies a quarter of a cell from the middle of its own cell. */
uint32_t sv_wall_cost_at(const sv_wall_layout *layout, const uint32_t *costs, uint32_t x, uint32_t y,
                         uint32_t z);

/* How sure a surface is that costs so much, in a layer of that level relative to the threshold, 1. */
float sv_wall_confidence(const sv_wall_layout *layout, float cost, float level);

/* ---- where the surface goes on from the rim of the sac (ref_wall_rim.c) */

enum { SV_WALL_PLACES = 3 }; /* of a ray: its surface, and the ends of the range that the knob moves it in */

/* True if a ray has fluid of its own at `place`: two blocks within layout->full_distance of it are dark. A
 * ray is left alone, too, if the fetus is on it with a probability `shown` of SV_WALL_POSSIBLE at least, if
 * it was not scanned, or meets no tissue. */
bool sv_wall_has_fluid(const sv_wall_scan *scan, size_t ray, float place, uint32_t shown);

/* Moves the surface of the other rays, and the ends of its range, to where those of the rays beside them lie,
 * but not deeper than what costs 1 more than `least`, the ray's minimum in the smoothed `costs`. Their
 * confidence is that of where they lie then. If no ray has fluid of its own, nothing is moved. False: no
 * memory. */
bool sv_wall_go_on(const sv_wall_scan *scan, const uint32_t *costs, const float *least, const bool *own,
                   float *places, float *confidence);

/* ---- the surface itself, and the verdict (ref_wall_surface.c) */

/* From this mean probability on a fetus is seen; from this share of dark blocks in gaps on there is a
 * surface. Per mille, after layout->last. */
uint32_t sv_wall_fetus_limit(const sv_wall_layout *layout);
uint32_t sv_wall_gap_limit(const sv_wall_layout *layout);

/* What the gaps tell of the surface after layout->last: SURFACE, DOUBTFUL, NO_FLUID or OPEN. `seen`: enough
 * rays show the fetus by its brightness; if not, NO_FETUS, unless the fluid is clear. */
sv_wall_outcome sv_wall_verdict(const sv_wall_layout *layout, const sv_wall_gaps *gaps, bool seen);
