/* SPDX-License-Identifier: MIT */
#include "volume/volume.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

bool hs_volume_init(hs_volume *volume, uint32_t nx, uint32_t ny, uint32_t nz, hs_error *err) {
    memset(volume, 0, sizeof *volume);
    const uint32_t size[3] = {nx, ny, nz};
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] == 0 || size[axis] > HS_VOLUME_MAX_AXIS)
            return hs_fail(err, HS_ERR_INPUT, "volume: size %c is %" PRIu32 ", expected 1 .. %u", "xyz"[axis],
                           size[axis], HS_VOLUME_MAX_AXIS);
        count *= size[axis];
    }
    if (count > HS_VOLUME_MAX_VOXELS)
        return hs_fail(err, HS_ERR_INPUT,
                       "volume: size %" PRIu32 " x %" PRIu32 " x %" PRIu32 " is %" PRIu64
                       " voxels, expected at most %" PRIu64,
                       nx, ny, nz, count, HS_VOLUME_MAX_VOXELS);
    uint8_t *voxels = calloc((size_t)count, 1);
    if (!voxels) return hs_fail(err, HS_ERR_MEMORY, "volume: no memory for %" PRIu64 " voxels", count);
    volume->nx = nx;
    volume->ny = ny;
    volume->nz = nz;
    for (int axis = 0; axis < 3; axis++) volume->spacing[axis] = 1.0;
    hs_pose_default(&volume->pose);
    volume->voxels = voxels;
    return true;
}

void hs_volume_free(hs_volume *volume) {
    free(volume->voxels);
    hs_beams_free(volume->beams);
    memset(volume, 0, sizeof *volume);
}

size_t hs_volume_count(const hs_volume *volume) {
    return (size_t)volume->nx * volume->ny * volume->nz;
}

void hs_volume_mark_all_scanned(hs_volume *volume) {
    const size_t count = hs_volume_count(volume);
    for (size_t i = 0; i < count; i++) volume->voxels[i] |= volume->voxels[i] == 0;
}

/*
 * Flood fill from the border through zeros, 64 voxels at a time. A row of voxels (fixed y, z) is a run of
 * words, one bit a voxel. Rows wait in a ring, each at most once: a row that gains a bit makes its four
 * neighbours wait. So the memory is fixed in advance, whatever the shape of the region.
 */
typedef struct {
    uint32_t rows_y, rows_z; /* rows of the volume: ny, nz */
    size_t words;            /* 64-bit words in a row */
    uint64_t *zero;          /* bit set: the voxel is 0 */
    uint64_t *reached;       /* bit set: it is 0 and connected to the border */
    uint32_t *ring;          /* rows that wait, by index z * rows_y + y */
    uint8_t *waits;          /* 1: the row is in the ring */
    size_t first, waiting;   /* oldest entry of the ring, and how many there are */
} flood;

static void flood_free(flood *f) {
    free(f->zero);
    free(f->reached);
    free(f->ring);
    free(f->waits);
}

static bool flood_init(flood *f, const hs_volume *volume) {
    memset(f, 0, sizeof *f);
    f->rows_y = volume->ny;
    f->rows_z = volume->nz;
    f->words = ((size_t)volume->nx + 63) / 64;
    const size_t rows = (size_t)volume->ny * volume->nz;
    f->zero = calloc(rows * f->words, sizeof *f->zero);
    f->reached = calloc(rows * f->words, sizeof *f->reached);
    f->ring = malloc(rows * sizeof *f->ring);
    f->waits = calloc(rows, 1);
    return f->zero && f->reached && f->ring && f->waits;
}

static void flood_push(flood *f, size_t row) {
    if (f->waits[row]) return;
    const size_t rows = (size_t)f->rows_y * f->rows_z;
    size_t slot = f->first + f->waiting;
    if (slot >= rows) slot -= rows;
    f->ring[slot] = (uint32_t)row;
    f->waits[row] = 1;
    f->waiting++;
}

static size_t flood_pop(flood *f) {
    const size_t row = f->ring[f->first];
    if (++f->first == (size_t)f->rows_y * f->rows_z) f->first = 0;
    f->waits[row] = 0;
    f->waiting--;
    return row;
}

/* Marks the zeros of every row, and as reached those on the volume's border. */
static void flood_seed(flood *f, const hs_volume *volume) {
    const size_t nx = volume->nx;
    for (size_t row = 0; row < (size_t)f->rows_y * f->rows_z; row++) {
        const uint8_t *voxels = volume->voxels + row * nx;
        uint64_t *zero = f->zero + row * f->words;
        uint64_t *reached = f->reached + row * f->words;
        for (size_t x = 0; x < nx; x++) zero[x / 64] |= (uint64_t)(voxels[x] == 0) << (x % 64);
        const size_t y = row % f->rows_y, z = row / f->rows_y;
        const bool on_border = y == 0 || y + 1 == f->rows_y || z == 0 || z + 1 == f->rows_z;
        if (on_border) {
            memcpy(reached, zero, f->words * sizeof *zero);
        } else {
            reached[0] |= zero[0] & 1;
            reached[(nx - 1) / 64] |= zero[(nx - 1) / 64] & (UINT64_C(1) << ((nx - 1) % 64));
        }
        flood_push(f, row);
    }
}

/* Spreads the bits of `reached` through neighbouring bits of `zero`, to both
 * sides (a fill by doubling steps). */
static uint64_t spread_in_word(uint64_t reached, uint64_t zero) {
    uint64_t up = zero, down = zero;
    for (unsigned step = 1; step < 64; step *= 2) {
        reached |= (up & (reached << step)) | (down & (reached >> step));
        up &= up << step;
        down &= down >> step;
    }
    return reached;
}

/* Takes over what the four neighbouring rows reached, spreads it along the row.
 * True if the row gained a bit. */
static bool flood_row(flood *f, size_t row) {
    const size_t y = row % f->rows_y, z = row / f->rows_y, n = f->words;
    const uint64_t *zero = f->zero + row * n;
    uint64_t *reached = f->reached + row * n;
    uint64_t gained = 0, carry = 0;
    for (size_t w = 0; w < n; w++) {
        uint64_t seeds = carry;
        if (y > 0) seeds |= reached[(ptrdiff_t)w - (ptrdiff_t)n];
        if (y + 1 < f->rows_y) seeds |= reached[w + n];
        if (z > 0) seeds |= reached[(ptrdiff_t)w - (ptrdiff_t)(n * f->rows_y)];
        if (z + 1 < f->rows_z) seeds |= reached[w + n * f->rows_y];
        const uint64_t spread = spread_in_word(reached[w] | (seeds & zero[w]), zero[w]);
        gained |= spread & ~reached[w];
        reached[w] = spread;
        carry = spread >> 63;
    }
    for (size_t w = n - 1; w-- > 0;) {
        const uint64_t from_right = (reached[w + 1] & 1) << 63;
        const uint64_t spread = spread_in_word(reached[w] | (from_right & zero[w]), zero[w]);
        gained |= spread & ~reached[w];
        reached[w] = spread;
    }
    return gained != 0;
}

static void flood_run(flood *f) {
    while (f->waiting > 0) {
        const size_t row = flood_pop(f);
        if (!flood_row(f, row)) continue; /* all rows wait at the start, so no seed is missed */
        const size_t y = row % f->rows_y, z = row / f->rows_y;
        if (y > 0) flood_push(f, row - 1);
        if (y + 1 < f->rows_y) flood_push(f, row + 1);
        if (z > 0) flood_push(f, row - f->rows_y);
        if (z + 1 < f->rows_z) flood_push(f, row + f->rows_y);
    }
}

static void flood_raise_inner(const flood *f, hs_volume *volume) {
    const size_t words = (size_t)f->rows_y * f->rows_z * f->words;
    for (size_t i = 0; i < words; i++) {
        uint64_t inner = f->zero[i] & ~f->reached[i];
        uint8_t *voxels = volume->voxels + (i / f->words) * volume->nx + (i % f->words) * 64;
        for (; inner != 0; inner &= inner - 1) voxels[__builtin_ctzll(inner)] = 1;
    }
}

bool hs_volume_mark_unscanned(hs_volume *volume, hs_error *err) {
    if (volume->nx == 0 || volume->ny == 0 || volume->nz == 0) return true; /* a freed one */
    flood f;
    const bool ready = flood_init(&f, volume);
    if (ready) {
        flood_seed(&f, volume);
        flood_run(&f);
        flood_raise_inner(&f, volume);
    }
    flood_free(&f);
    return ready || hs_fail(err, HS_ERR_MEMORY, "%s: no memory to find the unscanned region of %zu voxels",
                            volume->name, hs_volume_count(volume));
}
