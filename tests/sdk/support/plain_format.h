/* SPDX-License-Identifier: MIT */
#pragma once

#include "smartvis_plugin.h"

/* A volume in one slab of host memory, without padding. */
static inline sv_format plain_format(uint32_t width, uint32_t height, uint32_t slices, uint32_t tiles_x) {
    return (sv_format){.size = sizeof(sv_format),
                       .width = width,
                       .height = height,
                       .slices = slices,
                       .max_slab_slices = slices,
                       .voxel_type = SV_VOXEL_U8,
                       .carrier = SV_CARRIER_HOST,
                       .padding_value = SV_NO_PADDING,
                       .tiles_x = tiles_x,
                       .tile_w = width,
                       .tile_h = height,
                       .row_pitch = tiles_x * width};
}
