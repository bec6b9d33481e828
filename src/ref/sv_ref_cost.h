/*
 * The cost volume in float64, from its written definition (docs/cost_volume.md). Nothing here needs OpenCL,
 * and nothing is fast. Constants are SV_COST_* in cl/sv_shared.h.
 */
#ifndef SV_REF_COST_H
#define SV_REF_COST_H

#include "ref/sv_ref.h"

/* How rays are binned and gathered into cells. */
typedef struct {
    uint32_t width, height, slices;
    uint32_t labels; /* bins of a ray: min(slices, SV_COST_LABELS) */
    uint32_t block;  /* rays along the side of a cell */
    uint32_t cells_x, cells_y;
    uint32_t gap; /* bins: shortest fluid interval that counts */
    double scale; /* labels / SV_COST_LABELS */
    double pitch; /* slices per bin */
    double sigma; /* of the lateral Gaussian, in cells */
    /* What sv_ref_cost_layout_of takes from SV_COST_*; an experiment may change them. */
    double tau, behind, other, tissue, tissues, rank, slack, yield;
    bool median;      /* false: the cells' minima as they are */
    int level;        /* T_L as a grey level; 0: from the histogram */
    double memory;    /* share of the frame before, 0 .. 1 */
    double *previous; /* cells_x * cells_y * SV_COST_VALUES, zeros at first, kept by the caller; NULL: no
                         memory */
} sv_ref_cost_layout;

sv_ref_cost_layout sv_ref_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices);

/* Bin l of a ray, at bins[(l * height + y) * width + x]: the mean of its scanned voxels, rounded half up, at
 * least 1; 0 if none was scanned. Slice z falls into bin z * labels / slices. */
void sv_ref_cost_bins(const sv_ref_volume *volume, const sv_ref_cost_layout *layout, uint8_t *bins);

/* T_L for the bins: a quarter of the way from the mean of the dark class to that of the bright one, the
 * classes being split half way between their means. Reads the middle row of every row of cells. */
uint32_t sv_ref_cost_level(const uint8_t *bins, const sv_ref_cost_layout *layout);

/* What a ray came to. */
typedef struct {
    uint8_t first;   /* bin at which its first fluid interval begins; labels: it has none */
    uint8_t maximum; /* largest tissue bin behind that; 0: none */
    uint8_t place;   /* where that is; labels: none */
    bool scanned;
} sv_ref_cost_ray;

void sv_ref_cost_rays(const uint8_t *bins, const sv_ref_cost_layout *layout, uint32_t level,
                      sv_ref_cost_ray *rays);

/* Bone confidence 0 .. 1 of a maximum, by its rank among the rays that have one: full from rank `full` on. */
void sv_ref_cost_ranks(const sv_ref_cost_ray *rays, size_t count, double full, double bone[256]);

/* Costs of one ray at every label. `wall` is the bin from which tissue counts as cut through. */
void sv_ref_cost_of_ray(const uint8_t *bins, const sv_ref_cost_layout *layout, uint32_t level,
                        const sv_ref_cost_ray *ray, double bone, uint32_t wall, size_t pixel, double cost[]);

typedef struct {
    uint32_t level; /* T_L that was used, as a grey level */
    uint32_t rays;  /* scanned ones */
    uint32_t open;  /* with a fluid interval */
    uint32_t ties;  /* pixels near a cell where two labels, or a label and the edge of the minimum, are within
                       1e-5 */
} sv_ref_cost_facts;

/* Everything: both ends of the q range, float64 slices, the confidence 0 .. 1, and 1 in `tie` for pixels that
 * a tie can reach. Maps are width * height. `tie` and `facts` may be NULL. False if memory runs out. */
bool sv_ref_cost_surface(const sv_ref_volume *volume, double *near_surface, double *far_surface,
                         double *confidence, uint8_t *tie, sv_ref_cost_facts *facts);

/* The same with a changed layout. */
bool sv_ref_cost_surface_with(const sv_ref_volume *volume, const sv_ref_cost_layout *layout,
                              double *near_surface, double *far_surface, double *confidence, uint8_t *tie,
                              sv_ref_cost_facts *facts);

/* The blurred cost volume, cells_x * cells_y * SV_COST_VALUES, from bins; the caller frees it. NULL: no
 * memory. */
double *sv_ref_cost_volume(const uint8_t *bins, const sv_ref_cost_layout *layout, sv_ref_cost_facts *facts);

#endif
