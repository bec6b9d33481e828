/* SPDX-License-Identifier: MIT */
#include "loop/loop_stages.h"

#include "loop/loop_state.h"

#include <string.h>

bool hs_loop_convert(hs_loop *loop, uint32_t index, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_slabs_convert(loop->slabs, loop->volume, &camera, err) &&
           hs_cl_check(clFinish(loop->cl->queue), "clFinish (scan conversion)", err);
}

/* A call's outcome as a frame, and its map. */
static bool take(hs_loop *loop, const hs_clip *clip, hs_frame *frame, float *map, hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    *frame = (hs_frame){0};
    hs_loop_note_clip(clip, frame);
    if (!map) return true;
    if (clip->clipped) return hs_clipper_read_depth(loop->clipper, map, err);
    memset(map, 0, (size_t)layout->width * layout->height * sizeof *map);
    return true;
}

bool hs_loop_clip(hs_loop *loop, uint32_t index, hs_frame *frame, float *map, hs_error *err) {
    hs_clip clip;
    const hs_moment alone = {.index = index}; /* it continues nothing: what it comes to is its own */
    return hs_clipper_frame(loop->clipper, alone, &clip, err) && take(loop, &clip, frame, map, err);
}

bool hs_loop_adjust(hs_loop *loop, sv_param_value value, hs_frame *frame, float *map, hs_error *err) {
    hs_clip clip;
    return hs_clipper_adjust(loop->clipper, value, &clip, err) && take(loop, &clip, frame, map, err);
}

bool hs_loop_ray_ends(hs_loop *loop, uint32_t index, const hs_frame *frame, float *ends, hs_error *err) {
    hs_camera camera;
    hs_start_depths depths;
    const hs_start_depths *start =
        frame ? hs_clipper_start(loop->clipper, frame->clipped, frame->sure, &depths) : NULL;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_render(loop->screen, loop->volume, &camera, start, true, err) &&
           hs_screen_read_termination(loop->screen, ends, err);
}

bool hs_loop_ray_ends_from(hs_loop *loop, uint32_t index, uint32_t step, float *ends, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_render_from(loop->screen, loop->volume, &camera, step, err) &&
           hs_screen_read_termination(loop->screen, ends, err);
}

bool hs_loop_ray_ends_in(hs_loop *loop, uint32_t index, const hs_volume *other, float *ends, hs_error *err) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    hs_device_volume *volume = hs_device_volume_create(loop->cl, other, err);
    const bool ok = volume && hs_screen_render(loop->screen, volume, &camera, NULL, true, err) &&
                    hs_screen_read_termination(loop->screen, ends, err);
    hs_device_volume_destroy(volume);
    return ok;
}

uint32_t hs_loop_ray_steps(const hs_loop *loop, uint32_t index) {
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_screen_steps(loop->screen, loop->volume, &camera);
}
