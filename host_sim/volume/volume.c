/* SPDX-License-Identifier: MIT */
#include "volume/volume.h"

#include "core/threads.h"
#include "smartvis/lengths.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
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

void hs_volume_scanned_from(hs_volume *volume, hs_probe probe) {
    volume->probe = probe;
    for (int k = 0; k < 9; k++) volume->probe_turn[k] = k % 4 == 0 ? 1.0 : 0.0;
}

void hs_volume_free(hs_volume *volume) {
    free(volume->voxels);
    hs_beams_free(volume->beams);
    memset(volume, 0, sizeof *volume);
}

size_t hs_volume_count(const hs_volume *volume) {
    return (size_t)volume->nx * volume->ny * volume->nz;
}

void hs_volume_size_words(const hs_volume *v, char out[HS_SIZE_BYTES]) {
    const int at = snprintf(out, HS_SIZE_BYTES, "%u x %u x %u voxels of ", v->nx, v->ny, v->nz);
    if (at < 0 || at >= HS_SIZE_BYTES) return;
    if (v->spacing_unsaid)
        (void)snprintf(out + at, HS_SIZE_BYTES - (size_t)at, "unknown size: spacing not said");
    else
        (void)snprintf(out + at, HS_SIZE_BYTES - (size_t)at, "%g x %g x %g mm: %.1f x %.1f x %.1f mm",
                       v->spacing[0], v->spacing[1], v->spacing[2], v->nx * v->spacing[0],
                       v->ny * v->spacing[1], v->nz * v->spacing[2]);
}

bool hs_spacing_words(const char *question, char *out, size_t bytes) {
    return snprintf(out, bytes, "%c%s --spacing X,Y,Z says it (mm).", question[0] - 'a' + 'A', question + 1) >
           0;
}

bool hs_volume_doubt(const hs_volume *v, char out[HS_DOUBT_BYTES]) {
    const uint32_t count[3] = {v->nx, v->ny, v->nz};
    char question[SV_LENGTHS_TEXT_BYTES];
    if (v->spacing_unsaid)
        return snprintf(
                   out, HS_DOUBT_BYTES,
                   "The file does not say how far apart its voxels are: no length is known, and all sides "
                   "count as equal. --spacing X,Y,Z says it (mm).") > 0;
    return !v->beams && sv_lengths_doubt(count, v->spacing, question, sizeof question) &&
           hs_spacing_words(question, out, HS_DOUBT_BYTES);
}

/* ---------------------------------------------------------- the Cartesian copy of probe geometry -- */

#define WHOLE 1e-9 /* of a voxel: a side of 2.0000000001 voxels is 2 of them */

static double default_spacing(const hs_beams *beams, const double side[3]) {
    return fmax(beams->pitch, fmax(side[0], fmax(side[1], side[2])) / HS_CARTESIAN_AXIS);
}

bool hs_beams_cartesian_init(hs_volume *volume, hs_beams *beams, double spacing, hs_error *err) {
    double low[3], high[3], side[3];
    uint32_t count[3];
    hs_beams_box(beams, low, high);
    for (int a = 0; a < 3; a++) side[a] = high[a] - low[a];
    if (spacing == 0.0) spacing = default_spacing(beams, side);
    memset(volume, 0, sizeof *volume);
    for (int a = 0; a < 3; a++) {
        const double voxels = fmax(ceil(side[a] / spacing - WHOLE), 1.0);
        if (!(voxels <= HS_VOLUME_MAX_AXIS))
            return hs_fail(err, HS_ERR_USAGE,
                           "spacing of %g mm: %.0f voxels along %c, expected at most %u (%g mm are scanned)",
                           spacing, voxels, "xyz"[a], HS_VOLUME_MAX_AXIS, side[a]);
        count[a] = (uint32_t)voxels;
        beams->corner[a] = 0.5 * (low[a] + high[a]) - 0.5 * voxels * spacing;
    }
    if (!hs_volume_init(volume, count[0], count[1], count[2], err)) return false;
    for (int a = 0; a < 3; a++) {
        volume->spacing[a] = spacing;
        volume->pose.origin[a] = beams->corner[a] + 0.5 * spacing;
    }
    volume->beams = beams;
    return true;
}

static void fill_row(const hs_volume *volume, double plane, double depth, uint8_t *row) {
    const hs_beams *beams = volume->beams;
    double index[3] = {0.0, 0.0, plane};
    for (uint32_t x = 0; x < volume->nx; x++) {
        const double place = beams->corner[0] + (x + 0.5) * volume->spacing[0];
        if (!hs_beams_locate_in_plane(beams, place, depth, index)) continue;
        const double level = floor(hs_beams_sample(beams, index) + 0.5);
        row[x] = level < 1.0 ? 1 : (uint8_t)level;
    }
}

/* All rows of one y. From one slice to the next the samples are neighbours in the same lines, so that the
 * cache holds most of them; from one y to the next they lie in other planes. */
static void fill_layer(void *context, uint32_t y) {
    const hs_volume *volume = context;
    const hs_beams *beams = volume->beams;
    const double place = beams->corner[1] + (y + 0.5) * volume->spacing[1];
    for (uint32_t z = 0; z < volume->nz; z++) {
        uint8_t *row = volume->voxels + ((size_t)z * volume->ny + y) * volume->nx;
        double depth;
        const double plane =
            hs_beams_locate_plane(beams, place, beams->corner[2] + (z + 0.5) * volume->spacing[2], &depth);
        memset(row, 0, volume->nx);
        if (plane >= 0.0) fill_row(volume, plane, depth, row);
    }
}

void hs_beams_cartesian_fill(hs_volume *volume) {
    hs_parallel(hs_thread_count(0), volume->ny, fill_layer, volume);
}

/* -------------------------------------------------------------------- filled, and zeros marked -- */

/* 1 in every byte of 8 voxels that is 0. The sum cannot carry from one byte into the next. */
static uint64_t zero_marks(uint64_t voxels) {
    const uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
    return ~(((voxels & low) + low) | voxels | low) >> 7;
}

void hs_raise_zeros(uint8_t *voxels, size_t count) {
    size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        uint64_t eight;
        memcpy(&eight, voxels + i, sizeof eight);
        eight |= zero_marks(eight);
        memcpy(voxels + i, &eight, sizeof eight);
    }
    for (; i < count; i++) voxels[i] |= voxels[i] == 0;
}

void hs_volume_mark_all_scanned(hs_volume *volume) {
    hs_raise_zeros(volume->voxels, hs_volume_count(volume));
}

enum { PIECE = 1 << 16 }; /* voxels, about: enough to keep a thread busy */

static uint32_t rows_of_piece(const hs_volume *volume) {
    return volume->nx < PIECE ? PIECE / volume->nx : 1;
}

static uint32_t count_pieces(const hs_volume *volume) {
    const size_t rows = (size_t)volume->ny * volume->nz, step = rows_of_piece(volume);
    return (uint32_t)((rows + step - 1) / step);
}

typedef struct {
    hs_volume *volume;
    hs_fill_fn fill;
    void *context;
} filling;

static bool fill_piece(void *context, uint32_t piece, hs_error *err) {
    const filling *f = context;
    const size_t rows = (size_t)f->volume->ny * f->volume->nz, step = rows_of_piece(f->volume);
    const size_t first = piece * step, left = rows - first;
    const size_t at = first * f->volume->nx, count = (left < step ? left : step) * f->volume->nx;
    return f->fill(f->context, at, count, f->volume->voxels + at, err);
}

bool hs_volume_fill(hs_volume *volume, uint32_t threads, hs_fill_fn fill, void *context, hs_error *err) {
    filling f = {.volume = volume, .fill = fill, .context = context};
    return hs_parallel_try(threads, count_pieces(volume), fill_piece, &f, err);
}

/*
 * Flood fill from the border through zeros, 64 voxels at a time. A row of voxels (fixed y, z) is a run of
 * words, one bit a voxel. What is reached along the rows themselves is marked while the voxels are read,
 * once, by all threads. Only open rows, which have zeros that are not reached, are looked at again: they wait
 * in a ring, each at most once, and a row that gains a bit makes its open neighbours wait. So the memory is
 * fixed in advance, whatever the shape of the region.
 */
typedef struct {
    hs_volume *volume;
    uint32_t rows_y, rows_z; /* rows of the volume: ny, nz */
    size_t words;            /* 64-bit words in a row */
    uint64_t *zero;          /* bit set: the voxel is 0 */
    uint64_t *reached;       /* bit set: it is 0 and connected to the border */
    uint32_t *ring;          /* rows that wait, by index z * rows_y + y */
    uint8_t *waits;          /* 1: the row is in the ring */
    uint8_t *open;           /* 1: it has a zero that is not reached */
    size_t first, waiting;   /* oldest entry of the ring, and how many there are */
} flood;

static void flood_free(flood *f) {
    free(f->zero);
    free(f->reached);
    free(f->ring);
    free(f->waits);
    free(f->open);
}

static bool flood_init(flood *f, hs_volume *volume) {
    *f = (flood){.volume = volume};
    f->rows_y = volume->ny;
    f->rows_z = volume->nz;
    f->words = ((size_t)volume->nx + 63) / 64;
    const size_t rows = (size_t)volume->ny * volume->nz;
    f->zero = calloc(rows * f->words, sizeof *f->zero);
    f->reached = calloc(rows * f->words, sizeof *f->reached);
    f->ring = malloc(rows * sizeof *f->ring);
    f->waits = calloc(rows, 1);
    f->open = calloc(rows, 1);
    return f->zero && f->reached && f->ring && f->waits && f->open;
}

static void flood_push(flood *f, size_t row) {
    if (f->waits[row] || !f->open[row]) return;
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

/* One bit a voxel, set where it is 0, of up to 64 of them. */
static uint64_t zero_bits(const uint8_t *voxels, size_t count) {
    uint64_t bits = 0;
    size_t x = 0;
    for (; x + 8 <= count; x += 8) {
        uint64_t eight;
        memcpy(&eight, voxels + x, sizeof eight);
        if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) eight = __builtin_bswap64(eight);
        /* The product moves bit 8 i to bit 56 + i, for i = 0 .. 7. */
        bits |= zero_marks(eight) * UINT64_C(0x0102040810204080) >> 56 << x;
    }
    for (; x < count; x++) bits |= (uint64_t)(voxels[x] == 0) << x;
    return bits;
}

/* Spreads the bits of `reached` through neighbouring bits of `zero`, to both sides (a fill by doubling
 * steps). */
static uint64_t spread_in_word(uint64_t reached, uint64_t zero) {
    if (reached == 0 || reached == zero) return reached;
    uint64_t up = zero, down = zero;
    for (unsigned step = 1; step < 64; step *= 2) {
        reached |= (up & (reached << step)) | (down & (reached >> step));
        up &= up << step;
        down &= down >> step;
    }
    return reached;
}

/* Spreads what is reached along a row of n words. True if it has zeros that are not reached. */
static bool spread_along(const uint64_t *zero, uint64_t *reached, size_t n) {
    uint64_t carry = 0, left = 0;
    for (size_t w = 0; w < n; w++) {
        if (zero[w]) reached[w] = spread_in_word(reached[w] | (carry & zero[w]), zero[w]);
        carry = reached[w] >> 63;
    }
    carry = 0;
    for (size_t w = n; w-- > 0;) {
        if (zero[w]) reached[w] = spread_in_word(reached[w] | (carry << 63 & zero[w]), zero[w]);
        left |= zero[w] & ~reached[w];
        carry = reached[w] & 1;
    }
    return left != 0;
}

/* Marks the zeros of a row, and as reached those on the volume's border and what they lead to in the row. */
static void flood_seed(flood *f, size_t row) {
    const size_t nx = f->volume->nx, last = (nx - 1) / 64, y = row % f->rows_y, z = row / f->rows_y;
    const uint8_t *voxels = f->volume->voxels + row * nx;
    uint64_t *zero = f->zero + row * f->words, *reached = f->reached + row * f->words, any = 0;
    for (size_t w = 0; w < f->words; w++) {
        const uint64_t bits = zero_bits(voxels + w * 64, w < last ? 64 : nx - last * 64);
        if (bits) zero[w] = bits; /* memory that stays 0 is not touched */
        any |= bits;
    }
    if (!any) return;
    if (y == 0 || y + 1 == f->rows_y || z == 0 || z + 1 == f->rows_z) {
        memcpy(reached, zero, f->words * sizeof *zero);
        return;
    }
    reached[0] |= zero[0] & 1;
    reached[last] |= zero[last] & (UINT64_C(1) << ((nx - 1) % 64));
    f->open[row] = spread_along(zero, reached, f->words);
}

static void seed_slice(void *context, uint32_t z) {
    flood *f = context;
    for (size_t y = 0; y < f->rows_y; y++) flood_seed(f, (size_t)z * f->rows_y + y);
}

/* Takes over what the four neighbouring rows reached, spreads it along the row. True if the row gained a bit.
 * An open row has all four: on the border everything is reached. */
static bool flood_row(flood *f, size_t row) {
    const size_t n = f->words, slice = n * f->rows_y;
    const uint64_t *zero = f->zero + row * n;
    uint64_t *reached = f->reached + row * n, gained = 0;
    for (size_t w = 0; w < n; w++) {
        const uint64_t *at = reached + w;
        const uint64_t seeds = (at[-(ptrdiff_t)n] | at[n] | at[-(ptrdiff_t)slice] | at[slice]) & zero[w];
        gained |= seeds & ~reached[w];
        reached[w] |= seeds;
    }
    if (gained) f->open[row] = spread_along(zero, reached, n);
    return gained != 0;
}

static void flood_run(flood *f) {
    const size_t rows = (size_t)f->rows_y * f->rows_z;
    for (size_t row = 0; row < rows; row++) flood_push(f, row);
    while (f->waiting > 0) {
        const size_t row = flood_pop(f);
        if (!flood_row(f, row)) continue; /* all open rows wait at the start, so no seed is missed */
        flood_push(f, row - 1);
        flood_push(f, row + 1);
        flood_push(f, row - f->rows_y);
        flood_push(f, row + f->rows_y);
    }
}

static void flood_raise_inner(const flood *f) {
    const size_t rows = (size_t)f->rows_y * f->rows_z;
    for (size_t row = 0; row < rows; row++) {
        uint8_t *voxels = f->volume->voxels + row * f->volume->nx;
        for (size_t w = 0; f->open[row] && w < f->words; w++) {
            const size_t i = row * f->words + w;
            uint64_t inner = f->zero[i] & ~f->reached[i];
            for (; inner != 0; inner &= inner - 1) voxels[w * 64 + (size_t)__builtin_ctzll(inner)] = 1;
        }
    }
}

bool hs_volume_mark_unscanned(hs_volume *volume, hs_error *err) {
    if (volume->nx == 0 || volume->ny == 0 || volume->nz == 0) return true; /* a freed one */
    flood f;
    const bool ok = flood_init(&f, volume) ||
                    hs_fail(err, HS_ERR_MEMORY, "%s: no memory to find the unscanned region of %zu voxels",
                            volume->name, hs_volume_count(volume));
    if (ok) {
        hs_parallel(hs_thread_count(0), volume->nz, seed_slice, &f);
        flood_run(&f);
        flood_raise_inner(&f);
        volume->zeros_guessed = true;
    }
    flood_free(&f);
    return ok;
}
