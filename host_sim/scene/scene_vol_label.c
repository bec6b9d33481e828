/* SPDX-License-Identifier: MIT */
#include "scene/scene_vol_label.h"

#include "volume/beams_cartesian.h"
#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The scene's label at a column of the copy; 0 if what ends its interval was not scanned. The scene's middle,
 * and its first slice's face, lie where hs_vol_fill has them. */
static uint8_t label_at(const hs_scene_data *data, const hs_beams *beams, double x, double y) {
    const hs_volume *v = &data->full;
    const double i = floor(x / v->spacing[0] + 0.5 * v->nx), j = floor(y / v->spacing[1] + 0.5 * v->ny);
    if (!(i >= 0.0 && i < v->nx && j >= 0.0 && j < v->ny)) return 0;
    const size_t at = (size_t)j * v->nx + (size_t)i;
    if (data->label[at] == 0) return 0;
    const double behind =
        (double)data->far_end[at] + 1.5; /* voxels to the middle of the first one behind it */
    double index[3];
    const double place[3] = {x, y, beams->start + behind * v->spacing[2]};
    return hs_beams_locate(beams, place, index) ? data->label[at] : 0;
}

static void fill_labels(const hs_volume *copy, const hs_scene_data *data, uint8_t *label) {
    const double *corner = copy->beams->corner;
    for (uint32_t y = 0; y < copy->ny; y++)
        for (uint32_t x = 0; x < copy->nx; x++)
            label[(size_t)y * copy->nx + x] =
                label_at(data, copy->beams, corner[0] + (x + 0.5) * copy->spacing[0],
                         corner[1] + (y + 0.5) * copy->spacing[1]);
}

bool hs_vol_label_write(const char *prefix, hs_beams *beams, const hs_scene_data *data, hs_error *err) {
    char path[1100];
    hs_volume copy;
    const int length = snprintf(path, sizeof path, "%s_label.mha", prefix);
    if (length < 0 || (size_t)length >= sizeof path)
        return hs_fail(err, HS_ERR_OUTPUT, "%.200s...: the path is too long", prefix);
    if (!hs_beams_cartesian_init(&copy, beams, 0.0, err)) return false;
    uint8_t *label = calloc(copy.nx, copy.ny);
    bool ok = label || hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
    if (ok) {
        fill_labels(&copy, data, label);
        const hs_metaimage_array array = {.type = HS_ARRAY_U8,
                                          .data = label,
                                          .dims = 3,
                                          .size = {copy.nx, copy.ny, 1},
                                          .spacing = {copy.spacing[0], copy.spacing[1], copy.spacing[2]},
                                          .compress = true,
                                          .pose = &copy.pose};
        ok = hs_metaimage_write(path, &array, err);
    }
    copy.beams = NULL; /* the caller's */
    hs_volume_free(&copy);
    free(label);
    return ok;
}
