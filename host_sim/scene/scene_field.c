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

bool hs_field_init(hs_field *field, const uint32_t n[3], uint32_t room, const float h[3], hs_error *err) {
    const size_t pixels = (size_t)n[0] * n[1], count = pixels * room;
    memcpy(field->n, n, sizeof field->n);
    memcpy(field->h, h, sizeof field->h);
    field->end = n[2];
    field->room = room;
    field->beam = calloc(pixels, sizeof *field->beam);
    field->tissues = malloc(pixels * n[2]);
    field->surface = malloc(count);
    field->bone = malloc(count);
    field->diffuse = malloc(count * sizeof *field->diffuse);
    field->coherent = malloc(count * sizeof *field->coherent);
    field->envelope = malloc(count * sizeof *field->envelope);
    if (!field->beam || !field->tissues || !field->surface || !field->bone || !field->diffuse ||
        !field->coherent || !field->envelope) {
        hs_field_free(field);
        return hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", pixels * n[2]);
    }
    hs_field_move(field, 0, room < n[2] ? room : n[2]);
    make_level_tables();
    return true;
}

bool hs_field_add_style(hs_field *field, hs_error *err) {
    const size_t count = hs_field_slice(field) * field->room;
    field->style = malloc(count);
    field->share = malloc(count);
    return (field->style && field->share) ||
           hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu voxels", count);
}

static void set_window(hs_field *f, uint32_t first, uint32_t end) {
    const size_t before = hs_field_slice(f) * first;
    f->first = first;
    f->n[2] = end - first;
    f->tissue = f->tissues + before;
    f->grey = f->greys ? f->greys + before : NULL;
    hs_field_aim(f, first, end);
}

void hs_field_aim(hs_field *field, uint32_t first, uint32_t end) {
    field->low = first - field->first;
    field->high = end - field->first;
}

void hs_field_move(hs_field *f, uint32_t first, uint32_t end) {
    const size_t slice = hs_field_slice(f), by = slice * (first - f->first);
    const struct {
        void *plane;
        size_t bytes;
    } planes[] = {{f->surface, 1}, {f->bone, 1},    {f->style, 1},
                  {f->share, 1},   {f->diffuse, 2}, {f->coherent, 2}};
    for (size_t i = 0; by > 0 && i < sizeof planes / sizeof *planes; i++) {
        uint8_t *plane = planes[i].plane;
        if (plane) memmove(plane, plane + by * planes[i].bytes, (slice * f->n[2] - by) * planes[i].bytes);
    }
    set_window(f, first, end);
}

void hs_field_free_planes(hs_field *f) {
    void *const planes[] = {f->style,   f->share,    f->surface,  f->bone,    f->beam,
                            f->diffuse, f->coherent, f->envelope, f->wall_end};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) free(planes[i]);
    f->style = f->share = NULL;
    f->surface = f->bone = NULL;
    f->beam = NULL;
    f->diffuse = f->coherent = f->envelope = f->wall_end = NULL;
    if (f->tissues) set_window(f, 0, f->end);
}

void hs_field_free(hs_field *field) {
    hs_field_free_planes(field);
    free(field->haze_end);
    free(field->tissues);
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
