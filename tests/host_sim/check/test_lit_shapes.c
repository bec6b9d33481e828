/* SPDX-License-Identifier: MIT */
/*
 * The lit look has no rings, and its brightness does not depend on the volume's resolution: a ball,
 * ellipsoids and planes without noise against their analytic shading, at 64^3 to 256^3 over the same 100 mm.
 * They stand free, so that all light arrives and the colour follows from the normal, the depth and the
 * formula of docs/rendering.md. `test_lit_shapes 512` adds 512^3 (`make bench` runs it), and prints the table
 * either way.
 */
#include "support/dvr_fixture.h"

#include <math.h>

#define EXTENT  100.0 /* mm */
#define PICTURE 256u
#define FLUID   1.0 /* grey level: black, and scanned */
#define PARTS   8   /* of a voxel along an axis */
#define BLOCK   8u  /* voxels along an axis that mostly lie on one side of the surface */
#define DEGREE  0.017453292519943295
#define STEEP   0.2588190451025207 /* cosine of 75 degrees */
#define LIMIT   0.02
#define ANGLES  16

#define LIT_BINARY  0.0  /* a voxel is in or out, by its centre */
#define LIT_COVERED -1.0 /* a voxel holds the share of it that is in */

/* The body where |axes (p - centre)| <= 1 (an ellipsoid), or a half space: what lies behind a plane. */
typedef struct {
    const char *name;
    bool plane;
    double radius[3];  /* mm, of an ellipsoid */
    double turn;       /* degrees: an ellipsoid about z and x; a plane about y ... */
    double tilt;       /* ... and, a plane, about x */
    double yaw, pitch; /* of the camera */
    double edge;       /* voxels from nothing to all; or LIT_BINARY, LIT_COVERED */
    double level;      /* grey level inside */
    bool scan_face;    /* nothing was scanned outside; else there is fluid */
} lit_shape;

static const lit_shape lit_shapes[] = {
    {"ball", false, {36, 36, 36}, 0, 0, 0, 0, 1, 200, false},
    {"ball, turned camera", false, {36, 36, 36}, 0, 0, 31, 17, 1, 200, false},
    {"ball, dim", false, {36, 36, 36}, 0, 0, 0, 0, 1, 110, false},
    {"ball, bright, soft", false, {36, 36, 36}, 0, 0, 0, 0, 3, 255, false},
    {"ellipsoid", false, {40, 28, 24}, 35, 0, 0, 0, 1, 200, false},
    {"ellipsoid, turned camera", false, {30, 38, 26}, 20, 0, -40, 25, 1, 200, false},
    {"plane, straight", true, {0}, 0, 0, 0, 0, 1, 200, false},
    {"plane, 9 degrees", true, {0}, 9, 4, 0, 0, 1, 200, false},
    {"plane, 40 degrees", true, {0}, 40, -23, 0, 0, 1, 200, false},
    {"ball, coverage", false, {36, 36, 36}, 0, 0, 0, 0, LIT_COVERED, 200, false},
    {"ellipsoid, coverage", false, {40, 28, 24}, 35, 0, 0, 0, LIT_COVERED, 200, false},
    {"plane, 9 deg., coverage", true, {0}, 9, 4, 0, 0, LIT_COVERED, 200, false},
    {"ball, binary", false, {36, 36, 36}, 0, 0, 0, 0, LIT_BINARY, 200, false},
    {"plane, 9 deg., binary", true, {0}, 9, 4, 0, 0, LIT_BINARY, 200, false},
    {"scan's face, ball", false, {28, 28, 28}, 0, 0, 0, 0, LIT_BINARY, 200, true},
    {"scan's face, flat cap", false, {60, 60, 25}, 0, 0, 0, 0, LIT_BINARY, 200, true},
    {"scan's face, 3 degrees", true, {0}, 3, 0, 0, 0, LIT_BINARY, 200, true},
    {"scan's face, 9 degrees", true, {0}, 9, 4, 0, 0, LIT_BINARY, 200, true},
};

/* A body's way of telling how far outside a point is: a rotation's columns are its axes. */
typedef struct {
    const lit_shape *shape;
    double axes[9];
} body;

static body body_of(const lit_shape *s) {
    const double a = s->turn * DEGREE, b = (s->plane ? s->tilt : s->turn) * DEGREE;
    body out = {.shape = s};
    /* About y then x for a plane (whose normal is the last row), about z then x for an ellipsoid. */
    const double plane[9] = {cos(a), 0, sin(a), 0, 1, 0, -sin(a), 0, cos(a)};
    const double round[9] = {cos(a), sin(a), 0, -sin(a), cos(a), 0, 0, 0, 1};
    const double *first = s->plane ? plane : round;
    const double second[9] = {1, 0, 0, 0, cos(b), sin(b), 0, -sin(b), cos(b)};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) out.axes[3 * i + j] += second[3 * i + k] * first[3 * k + j];
    return out;
}

/* A point in the body's own coordinates. */
static void to_body(const body *b, const double p[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = b->axes[3 * i] * p[0] + b->axes[3 * i + 1] * p[1] + b->axes[3 * i + 2] * p[2];
}

/* Millimetres outside the surface, to first order. */
static double distance_of(const body *b, const double p[3]) {
    double q[3], value = 0.0, slope = 0.0;
    to_body(b, p, q);
    if (b->shape->plane) return -q[2];
    for (int i = 0; i < 3; i++) {
        const double r = b->shape->radius[i];
        value += q[i] * q[i] / (r * r);
        slope += q[i] * q[i] / (r * r * r * r);
    }
    return slope > 0.0 ? (value - 1.0) / (2.0 * sqrt(slope)) : -EXTENT;
}

/* The share of the parts of a voxel whose middle lies in the body. */
static double covered_share(const body *b, const double p[3], double spacing) {
    double middle[3], weight[3];
    double step[PARTS][3][3]; /* of a part, an axis of the volume, one of the body */
    to_body(b, p, middle);
    for (int i = 0; i < 3; i++) {
        weight[i] = b->shape->plane ? 0.0 : 1.0 / (b->shape->radius[i] * b->shape->radius[i]);
        for (int part = 0; part < PARTS; part++)
            for (int k = 0; k < 3; k++)
                step[part][k][i] = b->axes[3 * i + k] * ((part + 0.5) / PARTS - 0.5) * spacing;
    }
    int inside = 0;
    for (int part = 0; part < PARTS * PARTS; part++) {
        const double *y = step[part % PARTS][1], *z = step[part / PARTS][2];
        const double q[3] = {middle[0] + y[0] + z[0], middle[1] + y[1] + z[1], middle[2] + y[2] + z[2]};
        for (int x = 0; x < PARTS; x++) {
            const double *s = step[x][0], at[3] = {q[0] + s[0], q[1] + s[1], q[2] + s[2]};
            const double norm =
                at[0] * at[0] * weight[0] + at[1] * at[1] * weight[1] + at[2] * at[2] * weight[2];
            inside += b->shape->plane ? at[2] >= 0.0 : norm <= 1.0;
        }
    }
    return inside / (double)(PARTS * PARTS * PARTS);
}

/* The share of a voxel that lies in the body. */
static double share_of(const body *b, const double p[3], double spacing) {
    const double edge = b->shape->edge * spacing, d = distance_of(b, p);
    if (edge > 0.0) return fmin(fmax(0.5 - d / edge, 0.0), 1.0);
    if (b->shape->edge >= LIT_BINARY || fabs(d) > spacing) return d <= 0.0;
    return covered_share(b, p, spacing);
}

static uint8_t level_of(const body *b, double share) {
    const double outside = b->shape->scan_face ? 0.0 : FLUID;
    return (uint8_t)lround(outside + share * (b->shape->level - outside));
}

/* 1: all points within `reach` of `p` lie at least `band` outside, -1: inside, 0: neither is certain. The
 * body's norm (1 on the surface) changes by at most 1 / least a millimetre, and distance_of is at least half
 * of what it says. */
static int side_of(const body *b, const double p[3], double reach, double band) {
    const double *radius = b->shape->radius, shortest = fmin(radius[0], fmin(radius[1], radius[2]));
    double q[3], norm = 0.0, away;
    to_body(b, p, q);
    for (int i = 0; i < 3 && !b->shape->plane; i++) norm += q[i] * q[i] / (radius[i] * radius[i]);
    away = b->shape->plane ? -q[2] : (sqrt(norm) - 1.0) * shortest;
    return fabs(away) <= reach + 2.0 * band ? 0 : away > 0.0 ? 1 : -1;
}

/* A cube of BLOCK voxels a side, whose first one is `first`. */
static void fill_block(const body *b, hs_volume *v, const uint32_t first[3]) {
    const double spacing = v->spacing[0];
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = (first[k] + 0.5 * BLOCK) * spacing - 0.5 * EXTENT;
    const int side = side_of(b, p, BLOCK * spacing, fmax(b->shape->edge, 1.0) * spacing);
    for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
        const uint32_t y = first[1] + i % BLOCK, z = first[2] + i / BLOCK;
        uint8_t *row = v->voxels + ((size_t)z * v->ny + y) * v->nx + first[0];
        if (side != 0) {
            memset(row, level_of(b, side < 0 ? 1.0 : 0.0), BLOCK);
            continue;
        }
        p[1] = (y + 0.5) * spacing - 0.5 * EXTENT;
        p[2] = (z + 0.5) * spacing - 0.5 * EXTENT;
        for (uint32_t x = 0; x < BLOCK; x++) {
            p[0] = (first[0] + x + 0.5) * spacing - 0.5 * EXTENT;
            row[x] = level_of(b, share_of(b, p, spacing));
        }
    }
}

static hs_volume fill_volume(const body *b, uint32_t size) {
    hs_volume v;
    assert_int_equal(size % BLOCK, 0);
    must(hs_volume_init(&v, size, size, size, &err));
    for (int k = 0; k < 3; k++) v.spacing[k] = EXTENT / size;
    for (uint32_t z = 0; z < size; z += BLOCK)
        for (uint32_t y = 0; y < size; y += BLOCK)
            for (uint32_t x = 0; x < size; x += BLOCK) fill_block(b, &v, (const uint32_t[3]){x, y, z});
    return v;
}

/* The brightness (mean of red, green and blue, 0 .. 1) of a surface with this normal at depth t (0 .. 1) of
 * the box, in all light: docs/rendering.md. Normals are in camera coordinates. `echo`: of a cut, the
 * intensity that shows, 0 .. 1; of skin -1. */
static double lit_brightness(const hs_dvr_settings *s, const double n[3], double t, double echo) {
    const double azimuth = (double)s->light[0] * DEGREE, elevation = (double)s->light[1] * DEGREE;
    const double lamp[3] = {sin(azimuth) * cos(elevation), -sin(elevation), -cos(azimuth) * cos(elevation)};
    const double between[3] = {lamp[0], lamp[1], lamp[2] - 1.0};
    const double length = sqrt(between[0] * between[0] + between[1] * between[1] + between[2] * between[2]);
    double facing = 0.0, shine = 0.0;
    for (int k = 0; k < 3; k++) {
        facing += n[k] * lamp[k];
        shine += n[k] * between[k] / length;
    }
    const double light = 0.24 - 0.24 * n[2] + 0.58 * fmax(facing, 0.0);
    const double fade[3] = {0.30, 0.55, 0.62}, share[3] = {0.30, 0.59, 0.11};
    double sum = 0.0, tone[3], grey = 0.0;
    for (int k = 0; k < 3; k++) grey += share[k] * (tone[k] = (double)s->skin[k] * (1.0 - fade[k] * t));
    for (int k = 0; k < 3; k++) {
        const double skin = tone[k] * light + 0.14 * pow(fmax(shine, 0.0), 24.0);
        const double cut = (0.3 * tone[k] + 0.7 * grey * (k == 2 ? 1.04 : 1.0)) * (0.55 + 0.6 * echo) * light;
        sum += fmin(echo < 0.0 ? skin : cut, 1.0);
    }
    return sum / 3.0;
}

/* Where a pixel's ray meets the body, as the brightness of that place; negative where it is not compared. */
static double expected_at(const body *b, const hs_camera *camera, const hs_dvr_settings *s, uint32_t x,
                          uint32_t y) {
    const double eye[3] = {((x + 0.5) / PICTURE - 0.5) * camera->extent,
                           ((y + 0.5) / PICTURE - 0.5) * camera->extent, -0.5 * camera->depth_extent};
    double start[3], along[3], q[3], d[3], t;
    for (int k = 0; k < 3; k++) {
        const double *row = camera->rotation + (size_t)k * 3;
        start[k] = row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2];
        along[k] = row[2];
    }
    to_body(b, start, q);
    to_body(b, along, d);
    double normal[3] = {0, 0, -1};
    if (b->shape->plane) {
        t = -q[2] / d[2];
    } else {
        double aa = 0.0, bb = 0.0, cc = -1.0;
        for (int k = 0; k < 3; k++) {
            const double r = b->shape->radius[k] * b->shape->radius[k];
            aa += d[k] * d[k] / r;
            bb += q[k] * d[k] / r;
            cc += q[k] * q[k] / r;
        }
        if (bb * bb < aa * cc) return -1.0;
        t = (-bb - sqrt(bb * bb - aa * cc)) / aa;
        for (int k = 0; k < 3; k++)
            normal[k] = (q[k] + t * d[k]) / (b->shape->radius[k] * b->shape->radius[k]);
    }
    /* The cut of a plane through the volume's own faces is no plane any more; two faces of a scan meet
     * there. */
    const double reach = b->shape->scan_face ? 0.3 : 0.42;
    for (int k = 0; k < 3; k++)
        if (fabs(start[k] + t * along[k]) > reach * EXTENT) return -1.0;
    const double echo = b->shape->scan_face ? b->shape->level / 255.0 : -1.0;
    double world[3], seen[3], length = 0.0;
    for (int k = 0; k < 3; k++)
        world[k] = b->axes[k] * normal[0] + b->axes[3 + k] * normal[1] + b->axes[6 + k] * normal[2];
    for (int k = 0; k < 3; k++) length += world[k] * world[k];
    for (int a = 0; a < 3; a++)
        seen[a] = (camera->rotation[a] * world[0] + camera->rotation[3 + a] * world[1] +
                   camera->rotation[6 + a] * world[2]) /
                  sqrt(length);
    return -seen[2] < STEEP ? -1.0 : lit_brightness(s, seen, t / camera->depth_extent, echo);
}

/* How a picture of 256 x 256 differs from the analytic one where the surface is seen at less than 75
 * degrees. */
typedef struct {
    double rms;  /* difference, over the mean brightness */
    double mean; /* brightness, 0 .. 1 */
    size_t pixels;
} lit_difference;

static lit_difference lit_shape_measure(const hs_cl *cl, const lit_shape *shape, uint32_t size) {
    const body b = body_of(shape);
    hs_volume v = fill_volume(&b, size);
    hs_camera camera;
    hs_dvr_settings s;
    lit_difference out = {0};
    double squares = 0.0, known = 0.0;
    hs_camera_look(&camera, &v, shape->yaw, shape->pitch);
    hs_dvr_defaults(&s);
    s.look = HS_LOOK_LIT;
    s.width = s.height = PICTURE;
    const uint8_t *rgba = dvr_render(cl, &v, &camera, &s, NULL, NULL).rgba;
    for (uint32_t i = 0; i < PICTURE * PICTURE; i++) {
        const double expected = expected_at(&b, &camera, &s, i % PICTURE, i / PICTURE);
        if (expected < 0.0) continue;
        const double seen = (rgba[4 * i] + rgba[4 * i + 1] + rgba[4 * i + 2]) / 765.0;
        squares += (seen - expected) * (seen - expected);
        known += expected;
        out.mean += seen;
        out.pixels++;
    }
    assert_true(out.pixels > 2000);
    out.rms = sqrt(squares / (double)out.pixels) / (known / (double)out.pixels);
    out.mean /= (double)out.pixels;
    hs_volume_free(&v);
    return out;
}

static uint32_t largest = 256;

/* Whether the shading is the analytic one at `size`, and as bright as at half of it (`before`; 0: not known).
 * Returns the mean brightness. */
static double hold(const hs_cl *cl, const lit_shape *shape, uint32_t size, double before) {
    const lit_difference d = lit_shape_measure(cl, shape, size);
    print_message("%-26s %4u^3: RMS %5.2f %%, mean %.4f", shape->name, size, 100 * d.rms, d.mean);
    if (before > 0.0) print_message(" (%+.2f %%)", 100 * (d.mean / before - 1.0));
    print_message("\n");
    if (d.rms > LIMIT) fail_msg("%s at %u^3: off by %g", shape->name, size, d.rms);
    if (before > 0.0 && (d.mean > before * (1 + LIMIT) || d.mean < before * (1 - LIMIT)))
        fail_msg("%s at %u^3: mean %g, at half the size %g", shape->name, size, d.mean, before);
    return d.mean;
}

static void shading_is_the_analytic_one(void **state) {
    for (size_t i = 0; i < sizeof lit_shapes / sizeof *lit_shapes; i++) {
        const lit_shape *shape = &lit_shapes[i];
        double before = 0.0;
        /* In fluid a binary edge is a staircase that tissue does not have: docs/rendering.md. */
        const bool staircase = shape->edge <= LIT_BINARY && shape->edge >= LIT_BINARY && !shape->scan_face;
        for (uint32_t size = staircase ? 128 : 64; size <= largest; size *= 2)
            before = hold(*state, shape, size, before);
    }
}

/* Bodies of every kind from all sides, hard and soft, at the sizes where a voxel is largest. */
static void shading_is_the_analytic_one_at_any_angle(void **state) {
    static const double edges[3] = {LIT_COVERED, 1.0, 2.0};
    test_random random = {20};
    for (int i = 0; i < ANGLES; i++) {
        lit_shape s = {.plane = i % 2 == 0, .edge = edges[i % 3], .level = test_uniform(&random, 120, 255)};
        for (int k = 0; k < 3; k++) s.radius[k] = test_uniform(&random, 26, 40);
        s.turn = test_uniform(&random, -50, 50);
        s.tilt = test_uniform(&random, -30, 30);
        s.yaw = s.plane ? 0.0 : test_uniform(&random, -90, 90);
        s.pitch = s.plane ? 0.0 : test_uniform(&random, -60, 60);
        const char *const name = unit_text("%s %d, %+3.0f, %+3.0f", s.plane ? "plane" : "ellipsoid", i,
                                           s.turn, s.plane ? s.tilt : s.yaw);
        s.name = name;
        (void)hold(*state, &s, 128, hold(*state, &s, 64, 0.0));
    }
}

int main(int argc, char **argv) {
    if (argc > 1) largest = (uint32_t)strtoul(argv[1], NULL, 10);
    return UNIT_RUN("lit shapes", test_open_device, test_close_device, shading_is_the_analytic_one,
                    shading_is_the_analytic_one_at_any_angle);
}
