/* SPDX-License-Identifier: MIT */
#include "support/ref_lit.h"

#include "support/ref_dvr.h"
#include "support/unit.h"

#include <math.h>

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

size_t ref_lit_index(const uint32_t n[3], uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * n[1] + y) * n[0] + x;
}

/* Mean of factor^3 source voxels, halves up. */
static uint8_t reduced(const hs_volume *v, uint32_t factor, uint32_t x, uint32_t y, uint32_t z) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < factor * factor * factor; i++)
        sum += (uint32_t)ref_voxel(v, smaller(factor * x + i % factor, v->nx - 1),
                                   smaller(factor * y + i / factor % factor, v->ny - 1),
                                   smaller(factor * z + i / factor / factor, v->nz - 1));
    const double mean = sum / (double)(factor * factor * factor);
    return (uint8_t)floor(mean + 0.5);
}

/* Weights 1, 2, 1 along each axis, halves up; the outermost voxels become 0. */
static void smooth_once(const uint32_t n[3], const uint8_t *from, uint8_t *to) {
    for (uint32_t z = 0; z < n[2]; z++)
        for (uint32_t y = 0; y < n[1]; y++)
            for (uint32_t x = 0; x < n[0]; x++) {
                uint8_t *out = &to[ref_lit_index(n, x, y, z)];
                uint32_t sum = 0;
                *out = 0;
                if (!x || !y || !z || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1) continue;
                for (int i = 0; i < 27; i++) {
                    const int dx = i % 3 - 1, dy = i / 3 % 3 - 1, dz = i / 9 - 1;
                    sum += from[ref_lit_index(n, (uint32_t)((int)x + dx), (uint32_t)((int)y + dy),
                                              (uint32_t)((int)z + dz))] *
                           (uint32_t)((2 - abs(dx)) * (2 - abs(dy)) * (2 - abs(dz)));
                }
                *out = (uint8_t)floor(sum / 64.0 + 0.5);
            }
}

/* How much of a smoothed voxel's source was scanned: 0, 1/2 or 1; nothing of what lies outside. */
static double scanned_part(const hs_volume *v, uint32_t factor, uint32_t x, uint32_t y, uint32_t z) {
    uint32_t count = 0, all = factor * factor * factor;
    if (factor * x >= v->nx || factor * y >= v->ny || factor * z >= v->nz) return 0.0;
    for (uint32_t i = 0; i < all; i++)
        count += ref_voxel(v, smaller(factor * x + i % factor, v->nx - 1),
                           smaller(factor * y + i / factor % factor, v->ny - 1),
                           smaller(factor * z + i / factor / factor, v->nz - 1)) > 0;
    return count == all ? 1.0 : count ? 0.5 : 0.0;
}

/* The share of a cube's voxels that was scanned, 0 .. 255, halves up. */
static uint8_t cube_share(const hs_volume *v, const ref_lit_volume *lit, const uint32_t cube[3]) {
    const uint32_t side = lit->side;
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        if (cube[k] < REF_LIT_BORDER || cube[k] >= lit->shares[k] - REF_LIT_BORDER) return 0;
    for (uint32_t i = 0; i < side * side * side; i++)
        sum += scanned_part(v, lit->factor, (cube[0] - REF_LIT_BORDER) * side + i % side,
                            (cube[1] - REF_LIT_BORDER) * side + i / side % side,
                            (cube[2] - REF_LIT_BORDER) * side + i / side / side);
    return (uint8_t)floor(255.0 * sum / (double)(side * side * side) + 0.5);
}

static void make_scanned(ref_lit_volume *lit, const hs_volume *v) {
    const uint32_t min_side = lit->factor == 1 ? 4 : 3;
    lit->side = lit->block > min_side ? lit->block : min_side;
    for (int k = 0; k < 3; k++)
        lit->shares[k] = (lit->n[k] - 2 * REF_LIT_BORDER + lit->side - 1) / lit->side + 2 * REF_LIT_BORDER;
    const size_t count = (size_t)lit->shares[0] * lit->shares[1] * lit->shares[2];
    uint8_t *other = unit_memory(count);
    lit->scanned = unit_memory(count);
    for (uint32_t i = 0; i < count; i++)
        lit->scanned[i] =
            cube_share(v, lit,
                       (const uint32_t[]){i % lit->shares[0], i / lit->shares[0] % lit->shares[1],
                                          i / lit->shares[0] / lit->shares[1]});
    smooth_once(lit->shares, lit->scanned, other);
    smooth_once(lit->shares, other, lit->scanned);
}

double ref_lit_ramp(const hs_dvr_settings *s, double intensity) {
    const double low = (double)s->threshold_low * 255.0, high = (double)s->threshold_high * 255.0;
    return (intensity - low) / (high - low);
}

double ref_lit_limited(double value) {
    return fmin(fmax(value, 0.0), 1.0);
}

static void make_opacity(ref_lit_volume *lit, const hs_dvr_settings *s) {
    const uint32_t b = lit->block;
    for (uint32_t i = 0; i < lit->cells[0] * lit->cells[1] * lit->cells[2]; i++) {
        const uint32_t first[3] = {i % lit->cells[0] * b, i / lit->cells[0] % lit->cells[1] * b,
                                   i / lit->cells[0] / lit->cells[1] * b};
        double sum = 0.0;
        for (uint32_t z = first[2]; z < smaller(first[2] + b, lit->n[2]); z++)
            for (uint32_t y = first[1]; y < smaller(first[1] + b, lit->n[1]); y++)
                for (uint32_t x = first[0]; x < smaller(first[0] + b, lit->n[0]); x++)
                    sum += ref_lit_limited(ref_lit_ramp(s, lit->smooth[ref_lit_index(lit->n, x, y, z)]));
        lit->opacity[i] = (uint8_t)lrint(255.0 * sum / (b * b * b));
    }
}

ref_lit_volume ref_lit_make(const hs_volume *v, const hs_dvr_settings *s) {
    const uint32_t source[3] = {v->nx, v->ny, v->nz};
    ref_lit_volume lit = {.factor = v->nx > 96 || v->ny > 96 || v->nz > 96 ? 2 : 1};
    uint32_t longest = 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t count = (source[k] + lit.factor - 1) / lit.factor;
        lit.n[k] = count + 2 * REF_LIT_BORDER;
        longest = count > longest ? count : longest;
    }
    lit.block = longest > 48 ? (uint32_t)floor(longest / 48.0 + 0.5) : 1;
    for (int k = 0; k < 3; k++) lit.cells[k] = (lit.n[k] + lit.block - 1) / lit.block;
    const size_t count = (size_t)lit.n[0] * lit.n[1] * lit.n[2];
    uint8_t *other = unit_memory(count);
    lit.smooth = unit_memory(count);
    lit.opacity = unit_memory((size_t)lit.cells[0] * lit.cells[1] * lit.cells[2]);
    for (uint32_t z = REF_LIT_BORDER; z < lit.n[2] - REF_LIT_BORDER; z++)
        for (uint32_t y = REF_LIT_BORDER; y < lit.n[1] - REF_LIT_BORDER; y++)
            for (uint32_t x = REF_LIT_BORDER; x < lit.n[0] - REF_LIT_BORDER; x++)
                lit.smooth[ref_lit_index(lit.n, x, y, z)] =
                    reduced(v, lit.factor, x - REF_LIT_BORDER, y - REF_LIT_BORDER, z - REF_LIT_BORDER);
    smooth_once(lit.n, lit.smooth, other);
    smooth_once(lit.n, other, lit.smooth);
    make_opacity(&lit, s);
    make_scanned(&lit, v);
    return lit;
}
