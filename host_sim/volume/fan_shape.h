/* SPDX-License-Identifier: MIT */
/* The border of a scan, and the toroidal fan that lies closest to it from a face: what fan_fit.c decides by.
 */
#pragma once

#include "volume/volume.h"

enum {
    HS_BORDER_COLUMNS = 40, /* a side of the grid of columns along each axis */
    HS_BORDER_MOST = 6 * HS_BORDER_COLUMNS * HS_BORDER_COLUMNS, /* points */
    HS_BORDER_LEAST = 60,                                       /* points that say anything */
    PLACE = 0,
    SWEEP = 3,
    TURN = 4,
    LOW_LINE = 7,
    HIGH_LINE,
    PLANE,
    FACE,
    END,
    SCALE, /* logarithm of what the lengths along x are multiplied by; the next one, along y */
    SCALES = 2,
    UNKNOWNS = SCALE + SCALES /* of a fan */
};

typedef struct border {
    const double (*points)[3]; /* mm from the volume's corner */
    uint32_t count;
    double size[3]; /* mm */
    double close;   /* mm: as far may a point lie from a fan that holds it */
} border;

typedef struct {
    double rotation[9]; /* row-major: the probe's axes in those of the volume */
    double x[UNKNOWNS]; /* apex, sweep, (no turn), limits of the lines, of the planes, of the radii, scales */
    bool scaled;        /* these are sought */
    double factor[3];   /* of the lengths along each axis */
    double cost;        /* 0: all points lie on it, 1: none */
    double share, median;
    double follows; /* share of the points near by that are close */
    uint32_t on[6]; /* points close to each surface, as `beyond` numbers them */
} fan;

/* Room for HS_BORDER_MOST points. */
void hs_border_find(const hs_volume *volume, border *b, double (*points)[3]);

/* The best fan from a face. `turned`: of a scan whose axis is not the volume's, 28 degrees to either side.
 * `scaled`: the scales of x and y are sought, too: up to a factor for
 * all axes, any shape. `hopeless`: what begins at such a cost or ends at it
 * is not brought to rest, which takes most of the time. `room`: HS_BORDER_MOST numbers. */
fan hs_fan_from(const double axes[9], const border *b, double *room, bool turned, bool scaled,
                double hopeless);

/* The scales that were sought have come to rest within the reach of a trial. */
bool hs_fan_scale_rests(const fan *f);

/* It narrows towards the face it was begun from, and enough of what shows its shape is on it. */
bool hs_fan_holds(const fan *f, const border *b, const double axes[9]);

/* The spacing with which nearly all of the border lies on a fan, and clearly more than `share`, which is that
 * of the fan with the volume's own, 0 if there is none. Only their ratios are told: as many stay as were said
 * as fit, in another order if need be. False: there is none; `spacing` is untouched. */
bool hs_fan_find_scale(const hs_volume *volume, const border *b, double share, double *room,
                       double spacing[3]);
