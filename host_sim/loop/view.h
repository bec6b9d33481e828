/* SPDX-License-Identifier: MIT */
/* Everything the pictures of one frame are made of, read back to the host. Not on the frame path. */
#ifndef HS_VIEW_H
#define HS_VIEW_H

#include "loop/loop.h"

/*
 * Everything pictures are made of, for one frame of the setting "smartvis". Pictures are width * height RGBA
 * bytes; maps are map_width * map_height values. Free with hs_view_free.
 */
typedef struct {
    uint32_t width, height;
    uint8_t *result;         /* as the loop renders it */
    uint8_t *full;           /* unclipped, same camera */
    uint8_t *truth;          /* the scene's ground truth, same camera; NULL if there is none */
    uint8_t *mip;            /* maximum intensity projection, one byte a pixel */
    float *termination;      /* of the result: see hs_dvr_render */
    float *full_termination; /* of the full volume */
    uint32_t map_width, map_height, slices;
    float *depth;            /* the plugin's depthmap, in low-resolution slices; zeros if it was not used */
    uint8_t *status;         /* SV_POINT_* */
    float *sure;             /* the plugin's confidence, 0 .. 1; NULL if it gave none */
    hs_camera camera;        /* of the box: maps and the mip show all of it */
    double picture_mm;       /* the side of what the pictures show */
    const hs_volume *volume; /* the frame's; the source's, until the loop's next frame */
    hs_look look;            /* of the pictures */
    bool ghosted;            /* what is before the clipping surface fades */
    hs_frame frame;
} hs_view;

/* HS_ERR_DEVICE or HS_ERR_MEMORY; the view is zeroed then. */
bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err);

/* Frees everything. Safe on a zeroed struct. */
void hs_view_free(hs_view *view);

/* Frame `index` once more with the primary parameter at `value`, after hs_loop_frame has run it: by the
 * plugin's adjust where the parameter allows it, else as a whole frame. `rgba` receives the picture, 4 bytes
 * a pixel. HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_loop_turn(hs_loop *loop, uint32_t index, const sv_param_info *primary, double value, uint8_t *rgba,
                  hs_error *err);

#endif
