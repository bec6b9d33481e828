#include "ref/ref_wall_layout.h"

#include <math.h>
#include <stdio.h>

#define LARGEST_SIDE   2048
#define SHORTEST_MM    0.05
#define LONGEST_MM     20.0
#define GAUSSIAN_REACH 3.0 /* standard deviations */

sv_wall_settings sv_wall_settings_default(void) {
    return (sv_wall_settings){.mean_mm = 1.0,
                              .beside_mm = 3.75,
                              .thin_mm = 2.5,
                              .gap_mm = 2.0,
                              .valley = 0.9,
                              .wall_rank = 0.5,
                              .low_rank = 0.1,
                              .high_rank = 0.9,
                              .sure = 6.0,
                              .level = 0.25,
                              .first = 1.0,
                              .skin_mm = 7.5,
                              .tau_mm = 4.0,
                              .cut = 11.0,
                              .left = 5.0,
                              .other = 1.5,
                              .label_mm = 2.0,
                              .cell_mm = 4.0,
                              .sigma_mm = 4.0,
                              .slack = 0.4,
                              .median = true,
                              .doubt = 3.8,
                              .wall_share = 0.05,
                              .fetus_share = 0.05,
                              .assumed_wall = 1.5,
                              .assumed_spread = 0.5};
}

uint32_t sv_wall_first(const sv_wall_volume *v, size_t pixel) {
    return v->first ? v->first[pixel] : 0;
}

uint32_t sv_wall_end(const sv_wall_volume *v, size_t pixel) {
    return v->end ? v->end[pixel] : v->slices;
}

static bool check_side(const char *name, uint32_t value, char *text, size_t size) {
    if (value >= 1 && value <= LARGEST_SIDE) return true;
    (void)snprintf(text, size, "%s is %u, allowed are 1 .. %d", name, value, LARGEST_SIDE);
    return false;
}

static bool check_spacing(const sv_wall_volume *v, char *text, size_t size) {
    const double *mm = v->spacing_mm;
    if (mm[0] == 0.0 && mm[1] == 0.0 && mm[2] == 0.0) return true;
    for (int axis = 0; axis < 3; axis++)
        if (!(mm[axis] >= SHORTEST_MM && mm[axis] <= LONGEST_MM)) {
            (void)snprintf(text, size, "spacing_mm[%d] is %g, allowed are %g .. %g, or 0 for all three", axis,
                           mm[axis], SHORTEST_MM, LONGEST_MM);
            return false;
        }
    return true;
}

bool sv_wall_check(const sv_wall_volume *v, char *text, size_t size) {
    if (!v->voxels) {
        (void)snprintf(text, size, "voxels is NULL");
        return false;
    }
    if (!check_side("width", v->width, text, size) || !check_side("height", v->height, text, size) ||
        !check_side("slices", v->slices, text, size) || !check_spacing(v, text, size))
        return false;
    if (!v->first != !v->end) {
        (void)snprintf(text, size, "%s is NULL and the other is not", v->first ? "end" : "first");
        return false;
    }
    for (size_t i = 0; v->first && i < (size_t)v->width * v->height; i++)
        if (v->first[i] > v->end[i] || v->end[i] > v->slices) {
            (void)snprintf(text, size, "ray (%zu, %zu): first %u, end %u; expected first <= end <= %u",
                           i % v->width, i / v->width, v->first[i], v->end[i], v->slices);
            return false;
        }
    return true;
}

/* A length in voxels, rounded half up; at least `least`. */
static uint32_t voxels(double mm, double spacing, uint32_t least) {
    const double n = floor(mm / spacing + 0.5);
    return n > least ? (uint32_t)n : least;
}

/* Integer weights of a Gaussian, mirrored at 0, that sum up to SV_WALL_KERNEL_ONE; the one at 0 takes what
 * rounding leaves. */
static uint32_t gaussian(double sigma, uint32_t *weights) {
    const double wanted = floor(GAUSSIAN_REACH * sigma + 0.5);
    const uint32_t reach = wanted < SV_WALL_KERNEL ? (uint32_t)wanted : SV_WALL_KERNEL;
    double sum = 1.0;
    for (uint32_t i = 1; i <= reach; i++) sum += 2.0 * exp(-0.5 * i * i / (sigma * sigma));
    uint32_t rest = SV_WALL_KERNEL_ONE;
    for (uint32_t i = 1; i <= reach; i++) {
        weights[i] = (uint32_t)(SV_WALL_KERNEL_ONE * exp(-0.5 * i * i / (sigma * sigma)) / sum + 0.5);
        rest -= 2 * weights[i];
    }
    weights[0] = rest;
    return reach;
}

sv_wall_layout sv_wall_layout_of(const sv_wall_volume *v, const sv_wall_settings *s) {
    sv_wall_layout l = {.width = v->width, .height = v->height, .slices = v->slices};
    double mm[3] = {v->spacing_mm[0], v->spacing_mm[1], v->spacing_mm[2]};
    if (mm[0] == 0.0) {
        const uint32_t side = v->width > v->height ? v->width : v->height;
        mm[0] = mm[1] = mm[2] = SV_WALL_EXTENT_MM / (side > v->slices ? side : v->slices);
    }
    for (int axis = 0; axis < 3; axis++) l.mean[axis] = voxels(s->mean_mm, mm[axis], 0);
    for (int axis = 0; axis < 2; axis++) l.beside[axis] = voxels(s->beside_mm, mm[axis], 0);
    l.thin = voxels(s->thin_mm, mm[2], 1);
    l.gap = voxels(s->gap_mm, mm[2], 1);
    l.skin = voxels(s->skin_mm, mm[2], 0);
    l.tau = s->tau_mm / mm[2];
    l.step = voxels(s->label_mm, mm[2], 1);
    l.labels = (v->slices + l.step - 1) / l.step;
    const uint32_t cell_x = voxels(s->cell_mm, mm[0], 1), cell_y = voxels(s->cell_mm, mm[1], 1);
    l.cells_x = (v->width + cell_x - 1) / cell_x;
    l.cells_y = (v->height + cell_y - 1) / cell_y;
    l.reach_x = gaussian(s->sigma_mm / mm[0] * l.cells_x / v->width, l.kernel_x);
    l.reach_y = gaussian(s->sigma_mm / mm[1] * l.cells_y / v->height, l.kernel_y);
    l.cut = (uint32_t)(s->cut * SV_WALL_ONE + 0.5);
    l.left = (uint32_t)(s->left * SV_WALL_ONE + 0.5);
    l.other = (uint32_t)(s->other * SV_WALL_ONE + 0.5);
    l.slack = (uint32_t)(s->slack * SV_WALL_CELL_ONE + 0.5);
    return l;
}
