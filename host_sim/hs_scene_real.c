/*
 * Synthetic occluders before a given volume, which then is its own ground truth. What lies before the first
 * sample of a column that is brighter than the fluid is taken as free; occluders are put there, and kept a
 * gap away from it.
 */
#include "hs_scene_field.h"
#include "hs_scene_threads.h"

#include <stdlib.h>

#define FLUID_LEVEL 40   /* T_L = 40.5 / 255 (spec 9): a voxel above it is tissue */
#define GAP_MM      3.0f /* of fluid left between an occluder and the volume's tissue */

typedef struct {
    hs_field *field;
    const hs_volume *given;
    uint8_t *full;
} real;

/* The first slice of a column's tissue, or the number of slices. */
static uint32_t first_tissue(const hs_volume *v, size_t pixel) {
    const size_t slice = (size_t)v->nx * v->ny;
    uint32_t z = 0;
    while (z < v->nz && v->voxels[slice * z + pixel] <= FLUID_LEVEL) z++;
    return z;
}

static void place_row(void *context, uint32_t y) {
    const real *r = context;
    hs_field *f = r->field;
    const uint32_t gap = (uint32_t)ceilf(GAP_MM / f->h[2]);
    for (uint32_t x = 0; x < f->n[0]; x++) {
        size_t pixel = (size_t)y * f->n[0] + x;
        uint32_t first = first_tissue(r->given, pixel);
        for (uint32_t z = first > gap ? first - gap : 0; z < f->n[2]; z++) {
            size_t index = hs_field_slice(f) * z + pixel;
            f->tissue[index] = z < first ? HS_TISSUE_FLUID : HS_TISSUE_SOFT;
            f->surface[index] = z < first ? HS_DISTANCE_FAR : -HS_DISTANCE_FAR;
        }
    }
}

void hs_scene_real_place(hs_field *field, const hs_volume *given) {
    real r = {field, given, NULL};
    hs_scene_parallel(field->threads, field->n[1], place_row, &r);
}

/* Before the tissue the brighter one counts; from it on, and where nothing was scanned, the given volume. */
static void combine_slice(void *context, uint32_t z) {
    const real *r = context;
    const hs_field *f = r->field;
    size_t slice = hs_field_slice(f), start = slice * z;
    for (size_t i = start; i < start + slice; i++) {
        uint8_t given = r->given->voxels[i];
        bool before = given != 0 && !hs_tissue_is_fetus(f->tissue[i]);
        if (!before || given > r->full[i]) r->full[i] = given;
    }
}

void hs_scene_real_combine(hs_field *field, const hs_volume *given, uint8_t *full) {
    real r = {field, given, full};
    hs_scene_parallel(field->threads, field->n[2], combine_slice, &r);
}
