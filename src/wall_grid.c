/* SPDX-License-Identifier: MIT */
#include "wall_grid.h"

#include "smartvis_plugin.h"

#include <math.h>
#include <stddef.h>

/* Beams from farther away are parallel: the sides of a grid then differ by less than a block. So no position
 * leaves 32 bits. */
#define FARTHEST_MM 4000.0
#define NEAREST_MM  20.0 /* between the apex, or the axis, and the middle: an angle has no less room */
#define WIDEST      1.4  /* radians from one side of the grid to its middle, at most */
#define HALF_PI     1.57079632679489661923

static uint32_t even(double count) {
    return 2 * (uint32_t)(count / 2.0 + 0.5);
}

sv_wall_layout sv_wall_grid_layout(const sv_wall_settings *s) {
    const uint32_t across = even(SV_WALL_GRID_MM / s->beam_mm);
    sv_wall_layout l = sv_wall_layout_of_grid(across, across, even(SV_WALL_GRID_MM / s->block_mm), s->beam_mm,
                                              s->block_mm, s);
    l.dim_front = 1; /* what is badly lit before the probe's face is wall all the same */
    l.valley = 0;    /* the answer needs no limb */
    return l;
}

/* A fan, in millimetres along the volume's axes. */
typedef struct {
    double apex[3], sweep;
    double radius; /* from the apex to the middle of the volume, in the plane of the lines */
} fan;

/* Finds the fan, if the middle of the volume lies in front of it. */
static bool find_fan(const sv_beams *b, const double middle[3], fan *out) {
    double p[3] = {0};
    for (int axis = 0; axis < 3; axis++) {
        out->apex[axis] = (double)b->apex_mm[axis];
        for (int a = 0; a < 3; a++)
            p[axis] += (double)b->rotation[3 * a + axis] * (middle[a] - (double)b->apex_mm[a]);
    }
    out->sweep = (double)b->sweep_mm;
    if (fabs(out->sweep) > FARTHEST_MM) out->sweep = copysign(FARTHEST_MM, out->sweep);
    const double h = hypot(p[1], p[2] - out->sweep);
    out->radius = hypot(p[0], h + out->sweep);
    return p[2] > out->sweep && h + out->sweep > 0.0 && out->radius < FARTHEST_MM;
}

/* Parallel beams: a fan that is as far away as a fan may be. */
static fan far_fan(const sv_beams *b, const double middle[3]) {
    fan f = {.radius = FARTHEST_MM};
    for (int a = 0; a < 3; a++) f.apex[a] = middle[a] - FARTHEST_MM * (double)b->rotation[3 * a + 2];
    return f;
}

static int fixed(double value, int bits) {
    return (int)floor(ldexp(value, bits) + 0.5);
}

/* The angle between rays that are `mm` apart at a radius, so that `count` of them are not too wide. */
static int angle_at(double mm, double radius, uint32_t count) {
    const double angle = fmin(mm / fmax(radius, NEAREST_MM), 2.0 * WIDEST / count);
    return fixed(angle / HALF_PI, SV_WALL_ANGLE_BITS);
}

bool sv_wall_grid_of(const sv_wall_layout *l, const sv_wall_layout *along, const double spacing_mm[3],
                     const sv_beams *b, const sv_wall_settings *s, sv_wall_grid *g) {
    bool told = false;
    for (int i = 0; i < 9; i++) told = told || b->rotation[i] != 0.0f;
    if (!told || l->layers < 2) return false;
    double mm[3];
    sv_wall_spacing_of(l, spacing_mm, mm);
    const double sizes[3] = {l->width, l->height, l->slices};
    const double per_mm[3] = {l->columns / (l->width * mm[0]), l->rows / (l->height * mm[1]),
                              1.0 / (l->depth * mm[2])};
    /* where block 0 has its middle, mm */
    const double zero[3] = {0.5 / per_mm[0] - 0.5 * mm[0], 0.5 / per_mm[1] - 0.5 * mm[1],
                            0.5 / per_mm[2] - 0.5 * mm[2]};
    double middle[3];
    for (int a = 0; a < 3; a++) middle[a] = 0.5 * (sizes[a] - 1.0) * mm[a];
    fan f;
    if (b->kind != SV_BEAMS_FAN || !find_fan(b, middle, &f)) f = far_fan(b, middle);
    const double first = fmax(f.radius - 0.5 * along->layers * s->block_mm, 0.0);
    *g = (sv_wall_grid){.columns = l->columns,
                        .rows = l->rows,
                        .layers = l->layers,
                        .lines = along->columns,
                        .planes = along->rows,
                        .samples = along->layers,
                        .line_angle = angle_at(s->beam_mm, f.radius, along->columns),
                        .plane_angle = angle_at(s->beam_mm, f.radius - f.sweep, along->rows),
                        .first = fixed(first, SV_WALL_MM_BITS),
                        .step = fixed(s->block_mm, SV_WALL_MM_BITS),
                        .sweep = fixed(f.sweep, SV_WALL_MM_BITS)};
    for (size_t a = 0; a < 3; a++) {
        const float *const turn = &b->rotation[(size_t)3 * a];
        g->axis[a] =
            fixed((f.apex[a] + f.sweep * (double)turn[2] - zero[a]) * per_mm[a], SV_WALL_POSITION_BITS);
        g->x[a] = fixed((double)turn[0] * per_mm[a], SV_WALL_VECTOR_BITS);
        g->y[a] = fixed((double)turn[1] * per_mm[a], SV_WALL_VECTOR_BITS);
        g->z[a] = fixed((double)turn[2] * per_mm[a], SV_WALL_VECTOR_BITS);
        g->near[a] = fixed(0.5 * s->beam_mm * per_mm[a], SV_WALL_POSITION_BITS);
    }
    return true;
}
