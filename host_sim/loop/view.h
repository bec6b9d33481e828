/* SPDX-License-Identifier: MIT */
/* What one frame left, read back to the host: the plugin's maps, a scene's ground truth, and the pictures.
 * Not on the frame path. */
#pragma once

#include "loop/loop.h"
#include "loop/map_at.h"
#include "loop/screen.h"
#include "render/dvr.h"
#include "scene/scene.h"

/* Maps are width * height values, row by row. Free with hs_maps_free. */
typedef struct {
    uint32_t width, height, slices; /* of the low-resolution volume */
    float *depth;                   /* the depthmap, in slices; zeros if it was not used */
    uint8_t *status;                /* SV_POINT_* */
    float *confidence;              /* the plugin's confidence, 0 .. 1; NULL if it gave none */
    hs_camera camera;
    hs_frame frame;
} hs_maps;

/* Runs frame `index` of the setting "smartvis" and reads back every map the plugin has. HS_ERR_DEVICE or
 * HS_ERR_MEMORY; the maps are zeroed then. */
bool hs_loop_maps(hs_loop *loop, uint32_t index, hs_maps *maps, hs_error *err);

/* Reads back what frame `index` left, which was the loop's last: the depthmap, and points and confidence if
 * the plugin was asked for them (hs_loop_want). The errors are the same. */
bool hs_loop_read_maps(hs_loop *loop, uint32_t index, const hs_frame *frame, hs_maps *maps, hs_error *err);

/* Takes the depths of rays that pass beside the source's box: there is nothing to remove. */
void hs_maps_crop(hs_maps *maps, const hs_source *source);

/* Takes the depths of rays before which nothing of the volume was scanned: 0, there is nothing to remove, or
 * -1, the ray meets nothing at all. */
void hs_maps_scan(hs_maps *maps, const hs_volume *volume);

/* Where the rays of a picture end that `screen` draws of frame `index`, from where those of `frame` start
 * (NULL: the full volume): its settings say at which opacity. As many values as it has pixels, in steps, of
 * which a ray through the box of `window` has *steps. HS_ERR_DEVICE. */
bool hs_loop_pick(hs_loop *loop, hs_screen *screen, uint32_t index, const hs_frame *frame, hs_camera *window,
                  uint32_t *steps, float *ends, hs_error *err);

/* Frees everything. Safe on a zeroed struct. */
void hs_maps_free(hs_maps *maps);

/* True if the picture of frame `index`'s truth shows, in grey, where the fetus is cut because its occluder
 * touches it: in the lit look, along the scene's own rays. */
bool hs_truth_shows_cut(const hs_loop *loop, hs_look look, uint32_t index);

typedef struct hs_truth_picture hs_truth_picture;

/* Nothing is made yet. `loop` must have a source with a ground truth and outlive it.
 * NULL with HS_ERR_MEMORY. */
hs_truth_picture *hs_truth_picture_create(hs_loop *loop, hs_error *err);
void hs_truth_picture_destroy(hs_truth_picture *picture);

/* Enqueues the truth of frame `index` with the loop's window, in the screen's look, and waits for it. In the
 * lit look the truth is drawn as a result is, where the camera sees the scene's own rays: the frame's volume,
 * which must be on the device (hs_loop_bring), cut at the scene's surface, so that a cut is drawn as one.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_truth_picture_draw(hs_truth_picture *picture, hs_screen *screen, hs_look look, uint32_t index,
                           hs_error *err);

/*
 * Everything pictures are made of, for one frame of the setting "smartvis". Pictures are width * height RGBA
 * bytes. Free with hs_view_free.
 */
typedef struct {
    uint32_t width, height;
    uint8_t *result;         /* as the loop renders it */
    uint8_t *full;           /* unclipped, same camera */
    uint8_t *truth;          /* the scene's ground truth, same camera; NULL if there is none */
    float *termination;      /* of the result: see hs_dvr_render */
    float *full_termination; /* of the full volume */
    hs_maps maps;            /* cropped (hs_maps_crop); they show all of the box, and have the frame */
    double picture_mm;       /* the side of what the pictures show */
    const hs_volume *volume; /* the frame's; the source's, until the loop's next frame */
    hs_look look;            /* of the pictures */
    bool ghosted;            /* what is before the clipping surface fades */
    bool truth_cut;          /* the truth's picture shows a cut (hs_truth_shows_cut) */
} hs_view;

/* HS_ERR_DEVICE or HS_ERR_MEMORY; the view is zeroed then. The result comes first, for whom it is enough:
 * the rest is `full`, `full_termination` and `truth`. */
bool hs_loop_view(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err);
bool hs_loop_view_result(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err);
bool hs_loop_view_rest(hs_loop *loop, uint32_t index, hs_view *view, hs_error *err);

/* Frees everything. Safe on a zeroed struct. */
void hs_view_free(hs_view *view);

/* Frame `index` once more with the primary parameter at `value`, after hs_loop_frame has run it: by the
 * plugin's adjust where the parameter allows it, else as a whole frame. `rgba` receives the picture, 4 bytes
 * a pixel. HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_loop_turn(hs_loop *loop, uint32_t index, const sv_param_info *primary, double value, uint8_t *rgba,
                  hs_error *err);
