/* SPDX-License-Identifier: MIT */
#include "scene/scene_export.h"

#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool write_array(const char *prefix, const char *what, const hs_metaimage_array *array,
                        hs_error *err) {
    char path[1100];
    int length = snprintf(path, sizeof path, "%s_%s.mha", prefix, what);
    if (length < 0 || (size_t)length >= sizeof path)
        return hs_fail(err, HS_ERR_OUTPUT, "%.200s...: the path is too long", prefix);
    return hs_metaimage_write(path, array, err);
}

/* A map is one slice: what reads volumes reads it, too. */
static hs_metaimage_array describe(const hs_volume *volume, hs_array_type type, const void *data,
                                   uint32_t slices) {
    return (hs_metaimage_array){.type = type,
                                .data = data,
                                .dims = 3,
                                .size = {volume->nx, volume->ny, slices},
                                .spacing = {volume->spacing[0], volume->spacing[1], volume->spacing[2]},
                                .compress = true,
                                .pose = &volume->pose};
}

/* Readers differ in what they make of NaN: -1 says "no interval" in the file. */
static bool write_depths(const char *prefix, const char *what, const hs_volume *volume, const float *depth,
                         hs_error *err) {
    size_t count = (size_t)volume->nx * volume->ny;
    float *copy = malloc(count * sizeof *copy);
    if (!copy) return hs_fail(err, HS_ERR_MEMORY, "%s_%s.mha: no memory for %zu pixels", prefix, what, count);
    for (size_t i = 0; i < count; i++) copy[i] = isnan(depth[i]) ? -1.0f : depth[i];
    const hs_metaimage_array array = describe(volume, HS_ARRAY_F32, copy, 1);
    bool ok = write_array(prefix, what, &array, err);
    free(copy);
    return ok;
}

bool hs_scene_export(const hs_scene_data *data, const char *prefix, hs_error *err) {
    const hs_metaimage_array full = describe(&data->full, HS_ARRAY_U8, data->full.voxels, data->full.nz);
    const hs_metaimage_array truth = describe(&data->full, HS_ARRAY_U8, data->truth.voxels, data->full.nz);
    const hs_metaimage_array label = describe(&data->full, HS_ARRAY_U8, data->label, 1);
    return write_array(prefix, "full", &full, err) && write_array(prefix, "truth", &truth, err) &&
           write_array(prefix, "label", &label, err) &&
           write_depths(prefix, "near", &data->full, data->near_end, err) &&
           write_depths(prefix, "far", &data->full, data->far_end, err);
}
