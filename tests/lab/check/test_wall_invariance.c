/* SPDX-License-Identifier: MIT */
/*
 * Method wall through the ABI, on three scenes of ours at 128^3, or on the nine volumes of the folder that
 * the first argument names: what moves, brightens or resamples the scan must move or keep the surface
 * (docs/surface.md). Errors are those of sv_judge, the mean over the cases. That a mirrored scan has the
 * mirrored surface, to the bit: test_wall_definition.
 * Requirement: R3.
 */
#include "judge/judge.h"
#include "support/unit.h"

#include <math.h>

enum { MAX_CASES = 9 };
/* The first three of our scenes. */
static const char *const names[MAX_CASES] = {"E01", "E04", "M01", "E02", "E03", "M02", "M03", "D01", "D02"};
static wall_case cases[MAX_CASES];
static int case_count;

static size_t plane_of(const wall_case *c) {
    return (size_t)c->nx * c->ny;
}

/* A copy behind so many slices that were not scanned. */
static wall_case copy_behind(const wall_case *from, uint32_t room) {
    wall_case c;
    must(wall_case_room(from, room, &c, &err));
    memcpy(c.full + plane_of(&c) * room, from->full, plane_of(&c) * from->nz);
    for (size_t i = 0; i < plane_of(&c); i++) {
        const uint32_t more = from->end[i] > from->first[i] ? room : 0;
        c.first[i] = (uint16_t)(from->first[i] + more);
        c.end[i] = (uint16_t)(from->end[i] + more);
    }
    return c;
}

/* The plugin's map. */
static float *map_of(surf_session *session, const wall_case *c) {
    must(surf_session_frame(session, c, &err));
    assert_true(surf_session_clips(session));
    float *map = unit_memory(plane_of(c) * sizeof *map);
    memcpy(map, session->depth, plane_of(c) * sizeof *map);
    return map;
}

/* Error of a map of the case's own size. */
static double error_of(const wall_case *c, const float *map) {
    wall_calibration calibration = {0};
    float *confidence = unit_memory(plane_of(c) * sizeof *confidence);
    return wall_judge(c, c->full, map, confidence, &calibration).error;
}

static double error_unchanged(surf_session *s) {
    double sum = 0.0;
    for (int n = 0; n < case_count; n++) sum += error_of(&cases[n], map_of(s, &cases[n])) / case_count;
    return sum;
}

/* One pixel sideways is less than a block, so every block is another one. */
static void test_moved_sideways(void **state) {
    double sum = 0.0, rays = 0.0;
    for (int n = 0; n < case_count; n++) {
        const wall_case *from = &cases[n];
        wall_case c = copy_behind(from, 0);
        for (size_t i = plane_of(&c) * c.nz; i-- > 1;) /* to the right; the first column stays */
            if (i % c.nx > 0) c.full[i] = from->full[i - 1];
        for (size_t i = 0; i < plane_of(&c); i++)
            if (i % c.nx > 0) c.first[i] = from->first[i - 1];
        for (size_t i = 0; i < plane_of(&c); i++)
            if (i % c.nx > 0) c.end[i] = from->end[i - 1];
        float *map = map_of(*state, from), *moved = map_of(*state, &c);
        for (size_t i = 0; i + 1 < plane_of(&c); i++) {
            if (from->label[i] == 0 || i % c.nx + 1 == c.nx) continue;
            sum += fabs((double)(moved[i + 1] - map[i]));
            rays += 1.0;
        }
        wall_case_free(&c);
    }
    print_message("one pixel sideways: %.3f slices\n", sum / rays);
    assert_true(sum / rays <= 0.2);
}

/* The scan begins farther back, behind room that was not scanned. Eight slices are no whole number of layers
 * at every spacing. */
static void test_room_in_front(void **state) {
    enum { ROOM = 8 };
    for (int n = 0; n < case_count; n++) {
        const wall_case *from = &cases[n];
        wall_case c = copy_behind(from, ROOM);
        float *map = map_of(*state, from), *far = map_of(*state, &c);
        double sum = 0.0, rays = 0.0;
        for (size_t i = 0; i < plane_of(&c); i++) {
            if (from->label[i] == 0) continue;
            sum += fabs((double)(far[i] - map[i]) - ROOM);
            rays += 1.0;
        }
        print_message("%s: room in front: %.4f slices\n", from->name, sum / rays);
        assert_true(sum / rays <= 0.3);
        wall_case_free(&c);
    }
}

/* Adds speckle of up to a quarter more or less, which depends on the voxel's place only. */
static void add_speckle(wall_case *c) {
    uint32_t state = 12345;
    for (size_t i = 0; i < plane_of(c) * c->nz; i++) {
        state = state * 1664525u + 1013904223u;
        const double level = c->full[i] * (0.75 + 0.5 * (state >> 8) / 16777216.0);
        c->full[i] = (uint8_t)fmin(level + 0.5, 255.0);
    }
}

/* Weights 1 2 1 along an axis, twice: a Gaussian of one voxel. */
static void blur_along(wall_case *c, size_t stride, size_t count) {
    const size_t all = plane_of(c) * c->nz;
    uint8_t *from = unit_memory(all);
    memcpy(from, c->full, all);
    for (size_t group = 0; group < all; group += stride * count)
        for (size_t at = 0; at < count; at++)
            for (size_t i = group + at * stride; i < group + (at + 1) * stride; i++) {
                const int low = at > 0 ? from[i - stride] : from[i],
                          high = at + 1 < count ? from[i + stride] : from[i];
                c->full[i] = (uint8_t)((low + 2 * from[i] + high + 2) / 4);
            }
}

static void blur(wall_case *c) {
    blur_along(c, 1, c->nx);
    blur_along(c, c->nx, c->ny);
    blur_along(c, plane_of(c), c->nz);
}

static void test_grey_levels(void **state) {
    static const double changes[][3] = {{0.5, 1, 0}, {2, 1, 0},  {1, 0.7, 0},
                                        {1, 1.4, 0}, {1, 1, 15}, {1, 1, -15}};
    enum { LEVELS = sizeof changes / sizeof *changes, SPECKLE = LEVELS, BLUR, ALL };
    const double base = error_unchanged(*state);
    print_message("unchanged: %.3f slices\n", base);
    for (int k = 0; k < ALL; k++) {
        double sum = 0.0;
        for (int n = 0; n < case_count; n++) {
            wall_case c = copy_behind(&cases[n], 0);
            if (k == SPECKLE) add_speckle(&c);
            if (k == BLUR) blur(&c);
            if (k < LEVELS) wall_case_change(&c, changes[k][0], changes[k][1], changes[k][2]);
            sum += error_of(&cases[n], map_of(*state, &c)) / case_count;
            wall_case_free(&c);
        }
        if (k < LEVELS)
            print_message("gain %.1f, gamma %.1f, black level %+.0f: %.3f slices\n", changes[k][0],
                          changes[k][1], changes[k][2], sum);
        else
            print_message("%s: %.3f slices\n", k == SPECKLE ? "more speckle" : "blurred", sum);
        assert_true(sum <= 1.25 * base);
    }
}

/* ---- other sizes of the same scan */

/* Interpolates between the centres of voxels; beyond the outermost their value counts. */
static uint8_t trilinear(const wall_case *c, const double at[3]) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    size_t low[3], high[3];
    double part[3], sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double inside = fmin(fmax(at[k], 0.0), n[k] - 1.0);
        low[k] = (size_t)inside;
        high[k] = low[k] + 1 < n[k] ? low[k] + 1 : low[k];
        part[k] = inside - (double)low[k];
    }
    for (int corner = 0; corner < 8; corner++) {
        const size_t x = corner & 1 ? high[0] : low[0], y = corner & 2 ? high[1] : low[1],
                     z = corner & 4 ? high[2] : low[2];
        const double weight = (corner & 1 ? part[0] : 1.0 - part[0]) *
                              (corner & 2 ? part[1] : 1.0 - part[1]) * (corner & 4 ? part[2] : 1.0 - part[2]);
        sum += weight * c->full[z * plane_of(c) + y * c->nx + x];
    }
    return (uint8_t)(sum + 0.5);
}

/* The pixel of `from` that holds the centre of pixel `i` of `c`. */
static size_t pixel_below(const wall_case *from, const wall_case *c, size_t i) {
    const size_t x = (2 * (i % c->nx) + 1) * from->nx / (2 * c->nx);
    const size_t y = (2 * (i / c->nx) + 1) * from->ny / (2 * c->ny);
    return y * from->nx + x;
}

static wall_case resampled(const wall_case *from, const uint32_t n[3]) {
    wall_case c = {.nx = n[0], .ny = n[1], .nz = n[2]};
    c.full = calloc(plane_of(&c), c.nz);
    c.first = calloc(plane_of(&c), sizeof *c.first);
    c.end = calloc(plane_of(&c), sizeof *c.end);
    assert_true(c.full && c.first && c.end);
    const double step[3] = {(double)from->nx / n[0], (double)from->ny / n[1], (double)from->nz / n[2]};
    for (int k = 0; k < 3; k++) c.spacing_mm[k] = from->spacing_mm[k] * step[k];
    for (size_t i = 0; i < plane_of(&c); i++) {
        const size_t below = pixel_below(from, &c, i);
        c.first[i] = (uint16_t)ceil(from->first[below] / step[2]);
        c.end[i] = (uint16_t)(from->end[below] / step[2]);
        if (c.first[i] > c.end[i]) c.first[i] = c.end[i];
        for (size_t z = c.first[i]; z < c.end[i]; z++) {
            const double at[3] = {((double)(i % n[0]) + 0.5) * step[0] - 0.5,
                                  ((double)(i / n[0]) + 0.5) * step[1] - 0.5,
                                  ((double)z + 0.5) * step[2] - 0.5};
            c.full[z * plane_of(&c) + i] = trilinear(from, at);
        }
    }
    return c;
}

/* Resamples the map of `c` at the pixels of `from`, which shows the same scan (bilinear). */
static float *map_back(const wall_case *from, const wall_case *c, const float *map) {
    float *out = unit_memory(plane_of(from) * sizeof *out);
    for (size_t i = 0; i < plane_of(from); i++) {
        const double x = ((double)(i % from->nx) + 0.5) * c->nx / from->nx - 0.5,
                     y = ((double)(i / from->nx) + 0.5) * c->ny / from->ny - 0.5;
        const double u = fmin(fmax(x, 0.0), c->nx - 1.0), v = fmin(fmax(y, 0.0), c->ny - 1.0);
        const size_t left = (size_t)u, right = left + 1 < c->nx ? left + 1 : left;
        const float *top = map + (size_t)v * c->nx;
        const float *bottom = (size_t)v + 1 < c->ny ? top + c->nx : top;
        const double s = u - (double)left, t = v - floor(v);
        const double depth = (1.0 - t) * ((1.0 - s) * (double)top[left] + s * (double)top[right]) +
                             t * ((1.0 - s) * (double)bottom[left] + s * (double)bottom[right]);
        if (depth > 0.0) out[i] = (float)((depth + 0.5) * from->nz / c->nz - 0.5);
    }
    return out;
}

/* Lengths are in mm: other voxels of the same scan, and voxels of unequal sides, give as good a surface. */
static void test_sizes(void **state) {
    static const uint32_t sizes[][3] = {{128, 128, 192}, {128, 128, 193}, {133, 133, 133}, {192, 160, 128},
                                        {256, 256, 256}, {96, 96, 96},    {100, 144, 240}};
    const double base = error_unchanged(*state);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const uint32_t *n = sizes[k];
        double sum = 0.0;
        for (int i = 0; i < case_count; i++) {
            wall_case c = resampled(&cases[i], n);
            sum += error_of(&cases[i], map_back(&cases[i], &c, map_of(*state, &c))) / case_count;
            wall_case_free(&c);
        }
        print_message("%u x %u x %u voxels: %.3f slices, %.3f as they are\n", n[0], n[1], n[2], sum, base);
        assert_true(sum <= 1.25 * base);
    }
}

static const char *folder; /* of a site's cases */

static int read_cases(void **state) {
    static surf_session session;
    for (int n = 0; n < case_count; n++)
        must(folder ? wall_case_read(folder, names[n], &cases[n], &err)
                    : wall_case_make(names[n], 1, 0, 0, &cases[n], &err));
    must(surf_session_open(&session, SURF_PLUGIN, "method=wall", &err));
    *state = &session;
    return 0;
}

static int free_cases(void **state) {
    surf_session_close(*state);
    for (int n = 0; n < case_count; n++) wall_case_free(&cases[n]);
    return 0;
}

int main(int argc, char **argv) {
    folder = argc > 1 ? argv[1] : NULL;
    case_count = folder ? MAX_CASES : 3;
    return UNIT_RUN(__FILE__, read_cases, free_cases, test_moved_sideways, test_room_in_front,
                    test_grey_levels, test_sizes);
}
