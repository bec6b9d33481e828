/* SPDX-License-Identifier: MIT */
/* What the plugin made of one frame, read back to the host. Not on the frame path. */
#ifndef HS_MAPS_H
#define HS_MAPS_H

#include "loop/loop.h"

/* Maps are width * height values, row by row. Free with hs_maps_free. */
typedef struct {
    uint32_t width, height, slices; /* of the low-resolution volume */
    float *depth;                   /* the depthmap, in slices; zeros if it was not used */
    uint8_t *status;                /* SV_POINT_* */
    float *sure;                    /* the plugin's confidence, 0 .. 1; NULL if it gave none */
    hs_camera camera;
    hs_frame frame;
} hs_maps;

/* Runs frame `index` of the setting "smartvis" and reads back every map the plugin has. HS_ERR_DEVICE or
 * HS_ERR_MEMORY; the maps are zeroed then. */
bool hs_loop_maps(hs_loop *loop, uint32_t index, hs_maps *maps, hs_error *err);

/* Reads back what frame `index` left, which was the loop's last: the depthmap, and points and confidence if
 * the plugin was asked for them (hs_loop_want). The errors are the same. */
bool hs_loop_read_maps(hs_loop *loop, uint32_t index, const hs_frame *frame, hs_maps *maps, hs_error *err);

/* Frees everything. Safe on a zeroed struct. */
void hs_maps_free(hs_maps *maps);

#endif
