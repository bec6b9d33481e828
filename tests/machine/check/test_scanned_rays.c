/* SPDX-License-Identifier: MIT */
/*
 * The scanned range of every ray (render/scan_convert.h) of volumes seen from all sides: exactly the first
 * and the last voxel of the converted slabs that is not 0, however little of the slabs is looked at.
 */
#include "render/scan_convert.h"
#include "support/host_fixture.h"

#include <math.h>

typedef enum { FULL, FAN, HOLES, CORNER, NOTHING, PATTERNS } pattern;

static const uint32_t sizes[][3] = {{64, 64, 64}, {41, 70, 53}, {90, 33, 20}};
static const double cameras[][2] = {{0, 0}, {90, 0}, {30, 20}, {45, 35}, {-20, 80}, {137, -61}, {180, 3}};

/* Slices of a slab, tiles in a row, padding of a tile and of a row. */
static const uint32_t layouts[][4] = {{16, 1, 0, 0}, {7, 3, 2, 5}, {1000, 1, 0, 0}};

static uint8_t voxel_of(test_random *random, pattern p, const uint32_t n[3], uint32_t x, uint32_t y,
                        uint32_t z) {
    const uint8_t some = (uint8_t)test_uniform(random, 1.0, 255.0);
    const double off = hypot(x - 0.5 * n[0], y - 0.5 * n[1]);
    switch (p) {
    case FULL:
        return some;
    case FAN:
        return off < 5.0 + 0.5 * z && off * off + (double)z * z < (double)n[2] * n[2] ? some : 0;
    case HOLES:
        return test_uniform(random, 0.0, 1.0) < 0.1 ? some : 0;
    case CORNER:
        return x + 12 > n[0] && y + 12 > n[1] && z + 12 > n[2] ? some : 0;
    default:
        return 0;
    }
}

static hs_volume make_volume(test_random *random, pattern p, const uint32_t n[3]) {
    static const double spacing[3] = {0.5, 0.5, 0.55};
    hs_volume v = test_volume(random, TEST_SMOOTH, n, spacing);
    for (uint32_t z = 0; z < n[2]; z++)
        for (uint32_t y = 0; y < n[1]; y++)
            for (uint32_t x = 0; x < n[0]; x++)
                v.voxels[((size_t)z * n[1] + y) * n[0] + x] = voxel_of(random, p, n, x, y, z);
    return v;
}

static hs_slab_layout lay_out(const hs_camera *camera, const uint32_t how[4], double edge) {
    hs_slab_layout l = {.tiles_x = how[1]};
    l.width = l.height = (uint32_t)fmax(camera->extent / edge, 1.0);
    l.slices = (uint32_t)fmax(camera->depth_extent / edge, 1.0);
    l.slab_slices = how[0] < l.slices ? how[0] : l.slices;
    l.tile_w = l.width + how[2];
    l.tile_h = l.height + how[2];
    l.row_pitch = l.tiles_x * l.tile_w + how[3];
    return l;
}

static const uint8_t *voxel_at(const hs_slab_layout *l, const uint8_t *slabs, size_t stride, uint32_t x,
                               uint32_t y, uint32_t z) {
    const uint32_t slice = z % l->slab_slices;
    return slabs + z / l->slab_slices * stride +
           ((size_t)(slice / l->tiles_x) * l->tile_h + y) * l->row_pitch +
           (size_t)(slice % l->tiles_x) * l->tile_w + x;
}

/* Returns how many rays met something. */
static size_t compare(const hs_slab_layout *l, const uint8_t *slabs, size_t stride, const cl_ushort2 *ranges,
                      const char *where) {
    size_t met = 0;
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            uint32_t first = l->slices, end = l->slices;
            for (uint32_t z = l->slices; z-- > 0;)
                if (*voxel_at(l, slabs, stride, x, y, z)) first = z;
            for (uint32_t z = first; z < l->slices; z++)
                if (*voxel_at(l, slabs, stride, x, y, z)) end = z + 1;
            const cl_ushort2 got = ranges[(size_t)y * l->width + x];
            if (got.s[0] != first || got.s[1] != end)
                fail_msg("%s: ray %u, %u: scanned %u .. %u, expected %u .. %u", where, x, y, got.s[0],
                         got.s[1], first, end);
            met += first < l->slices;
        }
    return met;
}

/* Voxels of 1.7 mm come from the halved volume; those of 0.7 mm, from two cameras, from trilinear samples. */
static size_t check_volume(const hs_cl *cl, const hs_volume *v, pattern p) {
    size_t met = 0;
    for (size_t c = 0; c < sizeof cameras / sizeof cameras[0]; c++) {
        hs_camera camera;
        hs_camera_look(&camera, v, cameras[c][0], cameras[c][1]);
        const hs_slab_layout l =
            lay_out(&camera, layouts[(c + (size_t)p) % 3], c % 5 == 2 && p == FAN ? 0.7 : 1.7);
        char where[64];
        (void)snprintf(where, sizeof where, "pattern %d, %u slices deep, camera %g, %g", (int)p, v->nz,
                       cameras[c][0], cameras[c][1]);
        const void *mark = unit_mark();
        const size_t stride = hs_slab_bytes(&l, l.slab_slices);
        const test_slabs out = test_convert(cl, v, &camera, &l, 0, stride);
        met += compare(&l, out.voxels, stride, out.ranges, where);
        unit_return(mark);
    }
    return met;
}

static void ranges_are_what_was_converted(void **state) {
    for (int p = 0; p < PATTERNS; p++)
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            test_random random = {(uint32_t)(700 + 31 * p + (int)i)};
            hs_volume v = make_volume(&random, (pattern)p, sizes[i]);
            const size_t met = check_volume(*state, &v, (pattern)p);
            assert_true(p == NOTHING ? met == 0 : met > 20);
        }
}

HOST_MAIN(cmocka_unit_test(ranges_are_what_was_converted))
