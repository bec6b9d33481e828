/* SPDX-License-Identifier: MIT */
#include "cost_layout.h"

#include "common/sv_shared.h"

/* The longest side if the spacing is unknown: SV_ASSUMED_EXTENT_MM of the ABI. */
#define EXTENT_MM 120.0f

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static uint32_t shares(uint32_t whole, uint32_t part) {
    return (whole + part - 1) / part;
}

/* Converts a length to bins, at least one. */
static uint32_t bins(uint32_t length, float scale) {
    return larger((uint32_t)((double)length * (double)scale + 0.5), 1);
}

sv_cost_layout sv_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices, float slice_mm) {
    sv_cost_layout l = {.width = width, .height = height, .slices = slices};
    l.shrink = larger(larger(width, height) / SV_COST_RAYS, 1);
    l.columns = shares(width, l.shrink);
    l.rows = shares(height, l.shrink);
    l.padded_columns = shares(l.columns, SV_LANES) * SV_LANES;
    l.bin_slices = shares(slices, SV_COST_LABELS);
    l.labels = shares(slices, l.bin_slices);
    const uint32_t side = larger(l.columns, l.rows);
    l.block = larger((side + SV_COST_CELLS / 2) / SV_COST_CELLS, 1);
    l.cells_x = shares(l.columns, l.block);
    l.cells_y = shares(l.rows, l.block);
    l.lateral = larger((3 * l.block + 2) / 4, 1);
    if (!(slice_mm > 0.0f)) slice_mm = EXTENT_MM / (float)larger(larger(width, height), slices);
    l.scale = SV_COST_UNIT_MM / ((float)l.bin_slices * slice_mm);
    l.thin = bins(SV_COST_THIN, l.scale);
    l.gap = bins(SV_COST_GAP, l.scale);
    l.solid = bins(SV_COST_SOLID, l.scale);
    l.contact = bins(SV_COST_CONTACT, l.scale);
    l.split = bins(SV_COST_SPLIT, l.scale);
    l.axial = bins(SV_COST_AXIAL, l.scale);
    return l;
}

double sv_cost_sigma(const sv_cost_layout *l) {
    return SV_COST_SIGMA * (double)larger(l->columns, l->rows) / (SV_COST_CELLS * l->block);
}
