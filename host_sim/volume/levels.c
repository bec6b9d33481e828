/* SPDX-License-Identifier: MIT */
#include "volume/levels.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

enum { LANES = 16 }; /* loops of a fixed length, which compilers turn into vectors */

#define MAX_VALUE 1e30 /* beyond stand marks and rubbish, which would leave two grey levels of a scan */

void hs_levels_begin(hs_levels *levels) {
    *levels = (hs_levels){.low = INFINITY, .high = -INFINITY};
}

static bool is_gap(double v) {
    return !(v >= -DBL_MAX);
}

void hs_levels_widen(hs_levels *l, const double *value, const uint8_t *scanned, size_t count) {
    double low[LANES], high[LANES];
    int gaps = 0;
    for (int k = 0; k < LANES; k++) {
        low[k] = l->low;
        high[k] = l->high;
    }
    for (size_t i = 0; i < count; i += LANES)
        for (size_t k = 0; k < LANES && i + k < count; k++) {
            const double v = value[i + k];
            const bool gap = is_gap(v);
            const bool out = gap || (l->has_outside && v == l->outside) || (scanned && !scanned[i + k]);
            gaps |= gap;
            low[k] = !out && v < low[k] ? v : low[k];
            high[k] = !out && v > high[k] ? v : high[k];
        }
    for (int k = 0; k < LANES; k++) {
        l->low = low[k] < l->low ? low[k] : l->low;
        l->high = high[k] > l->high ? high[k] : l->high;
    }
    l->gaps |= gaps != 0;
}

/* Levels for each half of the numbers' unit. Halved, since high - low may exceed the largest double. */
static double scale_of(double low, double high) {
    return 255.0 / (high * 0.5 - low * 0.5);
}

static inline int level_of(double value, double half, double scale, double least) {
    const double level = (value * 0.5 - half) * scale;
    const double clamped = level < least ? least : level;
    return (int)((clamped > 255.0 ? 255.0 : clamped) + 0.5);
}

void hs_levels_of(const hs_levels *l, const double *value, size_t count, uint8_t *out) {
    const double half = l->low * 0.5, scale = scale_of(l->low, l->high);
    const bool marks = l->gaps || l->has_outside;
    size_t i = 0;
    for (; !marks && i + LANES <= count; i += LANES) {
        int level[LANES];
        for (int k = 0; k < LANES; k++) level[k] = level_of(value[i + (size_t)k], half, scale, 0.0);
        for (int k = 0; k < LANES; k++) out[i + (size_t)k] = (uint8_t)level[k];
    }
    for (; i < count; i++) {
        const bool not_scanned = marks && (is_gap(value[i]) || (l->has_outside && value[i] == l->outside));
        out[i] = not_scanned ? 0 : (uint8_t)level_of(value[i], half, scale, marks ? 1.0 : 0.0);
    }
}

bool hs_levels_check(const hs_levels *l, const char *what, hs_error *err) {
    if (l->low > l->high) return hs_fail(err, HS_ERR_INPUT, "%s: no voxel of it was scanned", what);
    if (l->low < -MAX_VALUE || l->high > MAX_VALUE)
        return hs_fail(err, HS_ERR_INPUT, "%s: values are %g .. %g, expected -1e30 .. 1e30; give a window",
                       what, l->low, l->high);
    if (!(l->low < l->high))
        return hs_fail(err, HS_ERR_INPUT, "%s: every voxel is %g: no range to map to 8 bit, give a window",
                       what, l->low);
    return isfinite(scale_of(l->low, l->high)) ||
           hs_fail(err, HS_ERR_INPUT, "%s: %g .. %g is too narrow a range to map to 8 bit", what, l->low,
                   l->high);
}

void hs_levels_words(const hs_levels *l, char *out, size_t bytes) {
    if (bytes > 0) out[0] = '\0';
    if (l->has_outside) (void)snprintf(out, bytes, "; what lies outside the scan holds %g", l->outside);
}

/* A single voxel of noise may hold the lowest value, too. */
static bool is_zero_in_a_corner(const hs_volume *v) {
    const size_t row = v->nx, slice = row * v->ny;
    for (uint32_t c = 0; c < 8; c++) {
        const size_t x = c & 1u ? v->nx - 2 : 0, y = c & 2u ? v->ny - 2 : 0, z = c & 4u ? v->nz - 2 : 0;
        const uint8_t *at = v->voxels + z * slice + y * row + x;
        uint8_t any = 0;
        for (uint32_t i = 0; i < 8; i++) any |= at[(i & 1u) + (i >> 1 & 1u) * row + (i >> 2) * slice];
        if (any == 0) return true;
    }
    return false;
}

bool hs_levels_mark_unscanned(const hs_levels *l, hs_volume *volume, hs_error *err) {
    const bool small = volume->nx < 2 || volume->ny < 2 || volume->nz < 2;
    if (l->low == 0.0 || l->has_outside || small || is_zero_in_a_corner(volume)) {
        const bool marked = hs_volume_mark_unscanned(volume, err);
        volume->zeros_guessed &= !l->has_outside;
        return marked;
    }
    hs_volume_mark_all_scanned(volume);
    return true;
}

/* ------------------------------------------------------------------------------- the constant outside -- */

enum { MOST_ACROSS = 64 };

typedef struct {
    const uint32_t *size;
    uint32_t edge[3]; /* of a block */
    hs_values_fn read;
    void *context;
    hs_error *err;
    double value[HS_CORNERS]; /* corner x + 2 y + 4 z: of its first voxel, */
    bool whole[HS_CORNERS];   /* and whether its block holds nothing else */
} looking;

/* A row of a block at (x, y, z); *same stays true if it holds *value alone, which `first` sets. */
static bool read_row(const looking *l, uint64_t x, uint64_t y, uint64_t z, bool first, double *value,
                     bool *same) {
    double row[MOST_ACROSS];
    if (!*same) return true;
    if (!l->read(l->context, (z * l->size[1] + y) * l->size[0] + x, l->edge[0], row, l->err)) return false;
    if (first) *value = row[0];
    for (uint32_t i = 0; i < l->edge[0]; i++) *same = *same && row[i] == *value;
    return true;
}

/* The four corners of the first slices, or of the last ones, in the order of the voxels. */
static bool read_corners(looking *l, uint32_t back) {
    for (uint32_t z = 0; z < l->edge[2]; z++)
        for (uint32_t y = 0; y < 2 * l->edge[1]; y++)
            for (uint32_t right = 0; right < 2; right++) {
                const uint32_t down = y >= l->edge[1], corner = back * 4 + down * 2 + right;
                const bool first = z == 0 && y == (down ? l->edge[1] : 0);
                if (first) l->whole[corner] = true;
                if (!read_row(
                        l, right ? l->size[0] - l->edge[0] : 0, down ? l->size[1] - 2 * l->edge[1] + y : y,
                        back ? l->size[2] - l->edge[2] + z : z, first, &l->value[corner], &l->whole[corner]))
                    return false;
            }
    return true;
}

static bool is_corner_of(const looking *l, uint32_t corner, double value) {
    return l->whole[corner] && l->value[corner] == value;
}

static uint32_t count_corners(const looking *l, double value) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < HS_CORNERS; c++) count += is_corner_of(l, c, value);
    return count;
}

/* Whether the block in the middle of a face (side 0 or 1 of an axis), or of the volume (axis 3), holds
 * `value` alone. */
static bool read_middle(const looking *l, int axis, uint32_t side, double value, bool *same) {
    uint64_t at[3];
    for (int a = 0; a < 3; a++) at[a] = (l->size[a] - l->edge[a]) / 2;
    if (axis < 3) at[axis] = side ? l->size[axis] - l->edge[axis] : 0;
    *same = true;
    for (uint32_t z = 0; z < l->edge[2]; z++)
        for (uint32_t y = 0; y < l->edge[1]; y++)
            if (!read_row(l, at[0], at[1] + y, at[2] + z, false, &value, same)) return false;
    return true;
}

/* A layer of one value has such corners, too: so a face between four of them, or the middle between all
 * eight, must hold something else. */
static bool is_around(const looking *l, double value, bool *around) {
    bool same = true;
    *around = false;
    if (count_corners(l, value) == HS_CORNERS) {
        if (!read_middle(l, 3, 0, value, &same)) return false;
        return (*around = !same), true;
    }
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t side = 0; side < 2; side++) {
            bool all = true;
            for (uint32_t c = 0; c < HS_CORNERS; c++)
                all = all && ((c >> axis & 1u) != side || is_corner_of(l, c, value));
            if (!all) continue;
            if (!read_middle(l, axis, side, value, &same)) return false;
            *around = *around || !same;
        }
    return true;
}

bool hs_levels_find_outside(hs_levels *l, const uint32_t size[3], bool zero, hs_values_fn read, void *context,
                            hs_error *err) {
    looking at = {.size = size, .read = read, .context = context, .err = err};
    for (int a = 0; a < 3; a++) {
        at.edge[a] = size[a] / 8 < MOST_ACROSS ? size[a] / 8 : MOST_ACROSS;
        if (at.edge[a] < 2) return true; /* too small for a shape */
    }
    bool any = false;
    if (!read_corners(&at, 0)) return false;
    for (uint32_t c = 0; c < HS_CORNERS / 2; c++) any |= at.whole[c] && !(zero && at.value[c] == 0.0);
    if (!any) return true; /* the rest of a compressed file need not be inflated */
    if (!read_corners(&at, 1)) return false;
    for (uint32_t c = 0; c < HS_CORNERS && !l->has_outside; c++) {
        const double value = at.value[c];
        if (!at.whole[c] || (zero && value == 0.0) || count_corners(&at, value) < HS_CORNERS_ENOUGH) continue;
        if (!is_around(&at, value, &l->has_outside)) return false;
        l->outside = value;
    }
    return true;
}
