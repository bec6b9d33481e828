/* SPDX-License-Identifier: MIT */
/* Tissues, levels and the planes of a field. */
#include "scene/scene_field.h"

#include "scene/scene_spec.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/*
 * Attenuation, impedance and speed of sound after Duck, "Physical Properties of Tissue" (1990), chapter 4,
 * and Szabo, "Diagnostic Ultrasound Imaging: Inside Out" (2nd ed., 2014), appendix B. Fetal bone is less
 * mineralised than adult bone, so its impedance and attenuation lie at the lower end of what is given for
 * bone. Echo levels are set against the display: bone near the top, fluid below its range.
 */
const hs_tissue_properties hs_tissue_defaults[HS_TISSUE_COUNT] = {
    [HS_TISSUE_FLUID] = {-70.0f, 0.005f, 1.50f, 1510.0f},
    [HS_TISSUE_WALL] = {-33.0f, 0.55f, 1.65f, 1570.0f},
    [HS_TISSUE_FAT] = {-35.0f, 0.48f, 1.38f, 1450.0f},
    [HS_TISSUE_MUSCLE] = {-33.0f, 0.60f, 1.70f, 1580.0f},
    [HS_TISSUE_PLACENTA] = {-31.0f, 0.50f, 1.65f, 1560.0f},
    [HS_TISSUE_CORD] = {-31.0f, 0.40f, 1.60f, 1550.0f},
    [HS_TISSUE_CLOUD] = {-37.0f, 0.10f, 1.53f, 1520.0f},
    [HS_TISSUE_URINE] = {-70.0f, 0.005f, 1.52f, 1520.0f},
    [HS_TISSUE_SOFT] = {-30.0f, 0.50f, 1.63f, 1550.0f},
    [HS_TISSUE_BRAIN] = {-37.0f, 0.45f, 1.58f, 1540.0f},
    [HS_TISSUE_BONE] = {-9.0f, 6.0f, 3.75f, 2500.0f},
};

const char *const hs_tissue_names[HS_TISSUE_COUNT] = {"fluid", "wall",  "fat",  "muscle", "placenta", "cord",
                                                      "cloud", "urine", "soft", "brain",  "bone"};

float hs_level_amplitude_table[HS_LEVEL_MAX - HS_LEVEL_SILENT + 1];

float hs_level_mantissa_table[1024];

static void make_tables(void) {
    for (int i = 0; i <= HS_LEVEL_MAX - HS_LEVEL_SILENT; i++)
        hs_level_amplitude_table[i] =
            i == 0 ? 0.0f : (float)pow(10.0, (double)(i + HS_LEVEL_SILENT) / (20.0 * HS_LEVEL_ONE));
    for (int i = 0; i < 1024; i++)
        hs_level_mantissa_table[i] = (float)(10.0 * HS_LEVEL_ONE * log10(1.0 + ((double)i + 0.5) / 1024.0));
}

static pthread_once_t once = PTHREAD_ONCE_INIT;

/* Makes the tables between level and amplitude, once per process. Any thread. */
static void make_level_tables(void) {
    pthread_once(&once, make_tables);
}

bool hs_field_init(hs_field *field, const uint32_t n[3], const float h[3], hs_error *err) {
    size_t count = (size_t)n[0] * n[1] * n[2];
    memcpy(field->n, n, sizeof field->n);
    memcpy(field->h, h, sizeof field->h);
    field->tissue = malloc(count);
    field->surface = malloc(count);
    field->bone = malloc(count);
    field->diffuse = malloc(count * sizeof *field->diffuse);
    field->coherent = malloc(count * sizeof *field->coherent);
    field->envelope = malloc(count * sizeof *field->envelope);
    if (!field->tissue || !field->surface || !field->bone || !field->diffuse || !field->coherent ||
        !field->envelope) {
        hs_field_free(field);
        return hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", count);
    }
    make_level_tables();
    return true;
}

bool hs_field_add_style(hs_field *field, hs_error *err) {
    const size_t count = hs_field_slice(field) * field->n[2];
    field->style = malloc(count);
    field->share = malloc(count);
    return (field->style && field->share) ||
           hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", count);
}

void hs_field_free_surfaces(hs_field *field) {
    free(field->style);
    free(field->share);
    free(field->surface);
    free(field->bone);
    field->style = field->share = NULL;
    field->surface = field->bone = NULL;
}

void hs_field_free_levels(hs_field *field) {
    free(field->diffuse);
    free(field->coherent);
    free(field->envelope);
    field->diffuse = field->coherent = field->envelope = NULL;
}

void hs_field_free(hs_field *field) {
    hs_field_free_surfaces(field);
    hs_field_free_levels(field);
    free(field->haze_end);
    free(field->tissue);
    memset(field, 0, sizeof *field);
}

float hs_field_cosine(const hs_field *f, const int8_t *distance, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t at[3] = {x, y, z};
    const size_t stride[3] = {1, f->n[0], hs_field_slice(f)};
    const size_t index = hs_field_index(f, x, y, z);
    float g[3];
    for (int a = 0; a < 3; a++) {
        size_t back = at[a] > 0 ? index - stride[a] : index,
               ahead = at[a] + 1 < f->n[a] ? index + stride[a] : index;
        g[a] = (float)(distance[ahead] - distance[back]) / f->h[a];
    }
    float norm = sqrtf(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return norm > 0.0f ? fabsf(g[2]) / norm : 0.0f;
}
