/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_volume.h"

#include <stdio.h>

#define LARGEST_SIDE 8192

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
        if (!(mm[axis] >= SV_WALL_SHORTEST_MM && mm[axis] <= SV_WALL_LONGEST_MM)) {
            (void)snprintf(text, size, "spacing_mm[%d] is %g, allowed are %g .. %g, or 0 for all three", axis,
                           mm[axis], SV_WALL_SHORTEST_MM, SV_WALL_LONGEST_MM);
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
