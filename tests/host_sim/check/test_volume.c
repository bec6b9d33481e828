/* SPDX-License-Identifier: MIT */
/* hs_volume: limits, and the unscanned region against a plain flood fill. */
#include "support/host_fixture.h"
#include "volume/crop.h"
#include "volume/volume.h"

#include <pthread.h>

static hs_volume make(uint32_t nx, uint32_t ny, uint32_t nz) {
    hs_volume volume;
    must(hs_volume_init(&volume, nx, ny, nz, &err));
    keep_volume(&volume);
    return volume;
}

static size_t count_value(const hs_volume *volume, uint8_t value) {
    size_t count = 0;
    for (size_t i = 0; i < hs_volume_count(volume); i++) count += volume->voxels[i] == value ? 1 : 0;
    return count;
}

static void mark(hs_volume *volume) {
    hs_error err = {0};
    assert_true(hs_volume_mark_unscanned(volume, &err));
    assert_int_equal(err.code, HS_OK);
}

static void sizes_outside_the_limits_are_refused(void **state) {
    static const uint32_t bad[][3] = {{0, 4, 4},          {4, 0, 4},          {4, 4, 0},
                                      {2049, 1, 1},       {1, UINT32_MAX, 1}, {1, 1, 2049},
                                      {2048, 2048, 2048}, {2048, 1024, 1025}};
    static const char *const told[] = {"x is 0",          "y is 0",    "z is 0",     "x is 2049",
                                       "y is 4294967295", "z is 2049", "8589934592", "2149580800"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        hs_volume volume;
        must_not(hs_volume_init(&volume, bad[i][0], bad[i][1], bad[i][2], &err), HS_ERR_INPUT, told[i]);
        assert_null(volume.voxels);
    }
}

static void a_new_volume_is_zero_and_one_mm(void **state) {
    hs_volume volume;
    must(hs_volume_init(&volume, 3, 5, 7, &err));
    assert_int_equal(hs_volume_count(&volume), 105);
    assert_int_equal(count_value(&volume, 0), 105);
    for (int axis = 0; axis < 3; axis++) assert_true(volume.spacing[axis] == 1.0);
    hs_volume_free(&volume);
    assert_null(volume.voxels);
    hs_volume_free(&volume); /* safe a second time */
    mark(&volume);           /* and there is nothing to mark */
}

/* The definition, voxel by voxel: sweep until nothing changes. 2 stands for a reached zero; voxels hold 0
 * or 9. */
static void plain_flood(uint8_t *v, int nx, int ny, int nz) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int z = 0; z < nz; z++)
            for (int y = 0; y < ny; y++)
                for (int x = 0; x < nx; x++) {
                    uint8_t *at = v + ((size_t)z * (size_t)ny + (size_t)y) * (size_t)nx + x;
                    if (*at != 0) continue;
                    const ptrdiff_t row = nx, slice = (ptrdiff_t)nx * ny;
                    const bool border =
                        x == 0 || y == 0 || z == 0 || x == nx - 1 || y == ny - 1 || z == nz - 1;
                    if (border || at[-1] == 2 || at[1] == 2 || at[-row] == 2 || at[row] == 2 ||
                        at[-slice] == 2 || at[slice] == 2) {
                        *at = 2;
                        changed = true;
                    }
                }
    }
    for (size_t i = 0; i < (size_t)nx * (size_t)ny * (size_t)nz; i++)
        v[i] = v[i] == 2 ? 0 : v[i] == 0 ? 1 : v[i];
}

/* Widths around the 64 voxels of a word; densities on both sides of the percolation threshold of the cubic
 * grid (0.31), where regions are most winding. */
static void unscanned_equals_a_plain_flood(void **state) {
    static const uint32_t widths[] = {1, 2, 3, 31, 63, 64, 65, 127, 128, 129, 150};
    static const uint32_t percents[] = {10, 25, 31, 35, 45, 60, 90};
    uint32_t random = 0x9e3779b9u;
    size_t inner = 0;
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++) {
        for (size_t p = 0; p < sizeof percents / sizeof *percents; p++) {
            hs_volume volume = make(widths[w], 1 + unit_random(&random) % 12, 1 + unit_random(&random) % 12);
            const size_t count = hs_volume_count(&volume);
            for (size_t i = 0; i < count; i++)
                volume.voxels[i] = unit_random(&random) % 100 < percents[p] ? 0 : 9;
            uint8_t *expected = unit_memory(count);
            memcpy(expected, volume.voxels, count);
            plain_flood(expected, (int)volume.nx, (int)volume.ny, (int)volume.nz);
            mark(&volume);
            assert_memory_equal(volume.voxels, expected, count);
            inner += count_value(&volume, 1);
        }
    }
    assert_true(inner > 1000); /* the comparison met inner zeros, not border zeros alone */
}

/* A tunnel one voxel wide that runs to and fro through a slab of tissue, in at one end only. Cell i of it is
 * returned by tunnel_cell; row r of 48 is joined to the next at alternating ends. */
enum { TUNNEL_X = 130, TUNNEL_ROWS = 48 };

static size_t carve_tunnel(hs_volume *volume) {
    *volume = make(TUNNEL_X, 2 * TUNNEL_ROWS + 1, 3);
    memset(volume->voxels, 200, hs_volume_count(volume));
    uint8_t *slice = volume->voxels + (size_t)volume->nx * volume->ny; /* the middle one */
    size_t length = 0;
    for (size_t r = 0; r < TUNNEL_ROWS; r++) {
        for (size_t x = 1; x + 1 < TUNNEL_X; x++, length++) slice[(2 * r + 1) * TUNNEL_X + x] = 0;
        if (r + 1 == TUNNEL_ROWS) break;
        slice[(2 * r + 2) * TUNNEL_X + (r % 2 ? 1 : TUNNEL_X - 2)] = 0;
        length++;
    }
    slice[TUNNEL_X] = 0; /* the mouth, on the border at x = 0 of the first row */
    return length + 1;
}

static void a_winding_tunnel_is_followed_to_its_end(void **state) {
    hs_volume volume;
    const size_t length = carve_tunnel(&volume);
    mark(&volume);
    assert_int_equal(count_value(&volume, 0), length); /* all of it */
    assert_int_equal(count_value(&volume, 1), 0);
    carve_tunnel(&volume);
    volume.voxels[(size_t)volume.nx * volume.ny + TUNNEL_X + 10] =
        200; /* plugged at x = 10 of the first row */
    mark(&volume);
    assert_int_equal(count_value(&volume, 0), 10); /* x = 0 .. 9 */
    assert_int_equal(count_value(&volume, 1), length - 11);
}

static void extremes_keep_their_meaning(void **state) {
    static const uint32_t sizes[][3] = {{1, 1, 1},  {70, 1, 1},  {1, 70, 1},
                                        {1, 1, 70}, {70, 70, 1}, {9, 9, 9}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        hs_volume volume = make(sizes[i][0], sizes[i][1], sizes[i][2]);
        const size_t count = hs_volume_count(&volume);
        mark(&volume); /* all zero: all of it touches the border */
        assert_int_equal(count_value(&volume, 0), count);
        hs_volume_mark_all_scanned(&volume);
        assert_int_equal(count_value(&volume, 1), count);
        mark(&volume); /* no zero: nothing changes */
        assert_int_equal(count_value(&volume, 1), count);
    }
}

static void *mark_on_small_stack(void *volume) {
    hs_error err = {0};
    return hs_volume_mark_unscanned(volume, &err) ? volume : NULL;
}

/* 6.9 million connected zeros with 128 KB of stack: a recursive fill would need a frame for each. */
static void the_fill_does_not_recurse(void **state) {
    hs_volume volume = make(190, 190, 190);
    pthread_attr_t attributes;
    pthread_t thread;
    void *done = NULL;
    assert_int_equal(pthread_attr_init(&attributes), 0);
    assert_int_equal(pthread_attr_setstacksize(&attributes, 128 * 1024), 0);
    assert_int_equal(pthread_create(&thread, &attributes, mark_on_small_stack, &volume), 0);
    assert_int_equal(pthread_join(thread, &done), 0);
    (void)pthread_attr_destroy(&attributes);
    assert_ptr_equal(done, &volume);
    assert_int_equal(count_value(&volume, 0), 190 * 190 * 190);
}

/* ----------------------------------------------------------------------------------------- filling -- */

enum { FILL_X = 300, FILL_Y = 70, FILL_Z = 9, FILL = FILL_X * FILL_Y * FILL_Z }; /* in several pieces */

/* Who fills how: levels of a fixed pattern with zeros in it. */
typedef struct {
    size_t fail_from; /* pieces that hold this voxel or later ones fail */
    uint32_t calls;
    bool in_order;
    size_t next;
} pattern;

static uint8_t pattern_at(size_t i) {
    return (uint8_t)(i * 2654435761u >> 13 & 3u);
}

static bool fill_pattern(void *context, size_t first, size_t count, uint8_t *out, hs_error *err) {
    pattern *p = context;
    if (first + count > p->fail_from) return hs_fail(err, HS_ERR_INPUT, "piece at %zu", first);
    for (size_t i = 0; i < count; i++) out[i] = (uint8_t)(out[i] + pattern_at(first + i));
    if (p->in_order) {
        assert_int_equal(first, p->next);
        p->next += count;
        p->calls++;
    }
    return true;
}

static void expect_pattern(const hs_volume *volume) {
    for (size_t i = 0; i < FILL; i++) assert_int_equal(volume->voxels[i], pattern_at(i));
}

/* Every voxel once, with one thread in order. */
static void a_volume_is_filled_in_pieces(void **state) {
    hs_volume plain = make(FILL_X, FILL_Y, FILL_Z);
    pattern in_order = {.fail_from = SIZE_MAX, .in_order = true}, at_once = {.fail_from = SIZE_MAX};
    must(hs_volume_fill(&plain, 1, fill_pattern, &in_order, &err));
    assert_true(in_order.calls > 2);
    assert_int_equal(in_order.next, FILL);
    expect_pattern(&plain);
    memset(plain.voxels, 0, FILL);
    must(hs_volume_fill(&plain, 8, fill_pattern, &at_once, &err));
    expect_pattern(&plain);
}

/* The ends count, and what rounding leaves of them. */
static void a_box_keeps_what_lies_in_it(void **state) {
    (void)state;
    hs_volume volume = make(5, 6, 7);
    for (int k = 0; k < 3; k++) volume.spacing[k] = 0.1;
    hs_raise_zeros(volume.voxels, hs_volume_count(&volume));
    const hs_crop crop = {true, {0.1 * 3 - 0.2, -9, 0.25}, {0.1 + 0.2, 0.24, 9}};
    must(hs_crop_check(&crop, &volume, &err));
    hs_crop_apply(&crop, &volume, volume.voxels);
    for (uint32_t z = 0; z < 7; z++)
        for (uint32_t y = 0; y < 6; y++)
            for (uint32_t x = 0; x < 5; x++)
                assert_int_equal(volume.voxels[(z * 6 + y) * 5 + x], x >= 1 && x <= 3 && y <= 2 && z >= 3);
    const double a[3] = {0.2, 0.2, -1}, b[3] = {0.2, 0.2, 1}, c[3] = {0.2, 0.5, 1}, d[3] = {0.3, 0.2, 0.3},
                 e[3] = {0.6, 0.2, 0.3};
    assert_true(hs_crop_meets(&crop, a, b));  /* along an axis */
    assert_true(hs_crop_meets(&crop, a, d));  /* through a corner */
    assert_false(hs_crop_meets(&crop, a, c)); /* it leaves before it would come in */
    assert_false(hs_crop_meets(&crop, c, e));
    const hs_crop none = {true, {0.11, 0, 0}, {0.19, 1, 1}};
    must_not(hs_crop_check(&none, &volume, &err), HS_ERR_INPUT, "holds no voxel");
}

static void the_first_failure_is_told(void **state) {
    hs_volume volume = make(FILL_X, FILL_Y, FILL_Z);
    for (uint32_t threads = 1; threads <= 8; threads++) {
        pattern p = {.fail_from = FILL / 2}; /* in the second piece, and in all behind it */
        hs_error err = {0};
        assert_false(hs_volume_fill(&volume, threads, fill_pattern, &p, &err));
        assert_int_equal(err.code, HS_ERR_INPUT);
        assert_string_equal(err.text, "piece at 65400"); /* 218 rows of 300 */
    }
}

UNIT_MAIN(NULL, NULL, sizes_outside_the_limits_are_refused, a_new_volume_is_zero_and_one_mm,
          unscanned_equals_a_plain_flood, a_winding_tunnel_is_followed_to_its_end,
          extremes_keep_their_meaning, the_fill_does_not_recurse, a_volume_is_filled_in_pieces,
          the_first_failure_is_told, a_box_keeps_what_lies_in_it)
