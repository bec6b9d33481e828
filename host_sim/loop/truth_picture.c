/* SPDX-License-Identifier: MIT */
#include "loop/truth_picture.h"

#include "loop/loop_state.h"
#include "loop/truth_surface.h"

#include <stdlib.h>

struct hs_truth_picture {
    hs_loop *loop;
    hs_device_volume *volume; /* the truth of frame `index`, or NULL */
    uint32_t index;           /* of the source's volumes */
};

hs_truth_picture *hs_truth_picture_create(hs_loop *loop, hs_error *err) {
    hs_truth_picture *picture = calloc(1, sizeof *picture);
    if (picture)
        picture->loop = loop;
    else
        (void)hs_fail(err, HS_ERR_MEMORY, "ground truth: no memory");
    return picture;
}

void hs_truth_picture_destroy(hs_truth_picture *picture) {
    if (!picture) return;
    hs_device_volume_destroy(picture->volume);
    free(picture);
}

static bool bring(hs_truth_picture *picture, uint32_t index, hs_error *err) {
    hs_loop *loop = picture->loop;
    const uint32_t wanted = index % loop->source->count;
    if (picture->volume && picture->index == wanted) return true;
    const hs_volume *truth = hs_source_truth(loop->source, wanted);
    picture->index = wanted;
    if (picture->volume) return hs_device_volume_replace(picture->volume, truth, err);
    picture->volume = hs_device_volume_create(loop->cl, truth, err);
    return picture->volume != NULL;
}

static bool wait_for(const hs_loop *loop, hs_error *err) {
    return hs_cl_check(clFinish(loop->cl->queue), "clFinish (ground truth)", err);
}

static bool draw_cut(hs_loop *loop, const hs_scene_data *scene, uint32_t index, const hs_camera *window,
                     float share, hs_screen *screen, hs_error *err) {
    hs_camera box;
    hs_start_depths start = {0};
    hs_loop_camera(loop, index, &box);
    bool ok = hs_truth_surface(loop->cl, scene, &box, &start, err);
    start.share = share;
    ok = ok && hs_screen_render(screen, loop->volume, window, &start, false, err) && wait_for(loop, err);
    if (start.depth) (void)clReleaseMemObject(start.depth);
    return ok;
}

bool hs_truth_picture_draw(hs_truth_picture *picture, hs_screen *screen, hs_look look, uint32_t index,
                           hs_error *err) {
    hs_loop *loop = picture->loop;
    const hs_scene_data *scene = hs_source_scene_data(loop->source, index);
    hs_camera window;
    float share;
    hs_loop_window(loop, index, &window, &share);
    if (scene && look == HS_LOOK_LIT && hs_truth_surface_fits(&window))
        return draw_cut(loop, scene, index, &window, share, screen, err);
    return bring(picture, index, err) &&
           hs_screen_render(screen, picture->volume, &window, NULL, false, err) && wait_for(loop, err);
}
