/*
 * The clipping surface told by the wall: whatever stands before the fluid on most rays is the wall, and the
 * fetus is what is brighter than the wall is. docs/surface.md has the definition in words. Nothing here needs
 * OpenCL, and nothing is fast. All but the evidence tables, the mean of the labels, the interpolation and the
 * confidence is integer arithmetic, so kernels can follow it bit for bit.
 */
#ifndef REF_WALL_H
#define REF_WALL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A camera-aligned volume: voxel (x, y, z) at voxels[(z * height + y) * width + x], z away from the probe.
 * Borrowed. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices; /* 1 .. 2048 each */
    /* Ray (x, y) was scanned in slices first[y * width + x] .. end[y * width + x] - 1; first = end: not at
     * all. Voxels outside that range are not read. Both NULL: everything was scanned. */
    const uint16_t *first, *end;
    /* Along x, y and z, 0.05 .. 20. All three 0: not known; then the longest side counts as
     * SV_WALL_EXTENT_MM. */
    double spacing_mm[3];
} sv_wall_volume;

#define SV_WALL_EXTENT_MM 120.0

/* Every constant of the definition: lengths in mm, ratios and ranks. An experiment may change them. */
typedef struct {
    double mean_mm;   /* brightness: mean of a box that reaches so far to either side */
    double beside_mm; /* and the largest of the means so far to either side of the ray */
    double thin_mm;   /* tissue thinner than this counts as fluid */
    double gap_mm;    /* fluid thinner than this is no place for the surface */
    double valley;    /* no fluid if the histogram's valley is higher than this share of its lower mode */
    double wall_rank; /* the wall's brightness among the brightnesses of first tissues */
    double low_rank, high_rank; /* the spread of the wall's brightness lies between these */
    double sure;                /* evidence per spread */
    double level;               /* spreads above the wall where any tissue is as likely the fetus as not */
    double first;               /* spreads more for the first tissue of a ray */
    double skin_mm;             /* bone of a first tissue lies this far behind its skin */
    double tau_mm;              /* distance to the fluid that costs 1 */
    /* Costs: the fetus is cut; an occluder is left; another fluid than the first. Together at most 31, or the
     * sums of the Gaussian leave 32 bits. */
    double cut, left, other;
    double label_mm, cell_mm; /* depths and neighbourhoods for which costs are kept */
    double sigma_mm;          /* lateral Gaussian over the costs */
    double slack;             /* labels that cost at most this much more than the cheapest are averaged */
    bool median;              /* 3 x 3 median of the cells */
    double doubt;             /* own cost at which a surface is as likely wrong as right */
    double fetus_share;       /* of the rays must show the fetus; else nothing is clipped */
    double wall_share;        /* of the rays must see a wall; else these two are assumed: */
    double assumed_wall;      /* its brightness in units of the bright class' mean */
    double assumed_spread;    /* ln of the odds */
} sv_wall_settings;

/* The settings that docs/surface.md states. */
sv_wall_settings sv_wall_settings_default(void);

typedef enum {
    SV_WALL_SURFACE = 0,  /* the maps hold a surface */
    SV_WALL_NO_FLUID = 1, /* the grey levels show no fluid: depth and confidence are 0, nothing is clipped */
    SV_WALL_EMPTY = 2,    /* too little was scanned to tell, or it is of one grey level: the same */
    SV_WALL_NO_FETUS = 3  /* nothing behind the wall is brighter than it: the same */
} sv_wall_outcome;

/* What was found on the way. */
typedef struct {
    uint32_t threshold;  /* T: tissue is brighter, grey levels */
    double valley;       /* of the histogram, 0 .. 1 */
    uint32_t rays;       /* scanned ones */
    uint32_t wall_rays;  /* rays that begin in tissue and have fluid behind it */
    double wall, spread; /* brightness of the wall, grey levels; its spread, ln of the odds */
    double fetus;        /* mean probability over the rays that the fetus is on them */
} sv_wall_facts;

/* True if sizes, spacing and ranges are as stated above; else the text names field and value. */
bool sv_wall_check(const sv_wall_volume *volume, char *text, size_t size);

/*
 * The surface. `depth` gets width * height slices (0 is the centre of slice 0; 0 clips nothing), `confidence`
 * as many numbers 0 .. 1: how likely the surface is right within two slices of 128. `settings` NULL: the
 * default. `facts` may be NULL. False if memory runs out or sv_wall_check fails; the maps are then as they
 * were. Any thread.
 */
bool sv_wall_surface(const sv_wall_volume *volume, const sv_wall_settings *settings, float *depth,
                     float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts);

#endif
