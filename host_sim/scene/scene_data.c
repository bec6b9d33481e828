/* SPDX-License-Identifier: MIT */
#include "scene/scene_data.h"

#include <stdlib.h>
#include <string.h>

void hs_scene_free(hs_scene_data *data) {
    hs_volume_free(&data->full);
    hs_volume_free(&data->truth);
    free(data->label);
    free(data->near_end);
    free(data->far_end);
    free(data->clip);
    free(data->tissue);
    memset(data, 0, sizeof *data);
}
