/* SPDX-License-Identifier: MIT */
#include "loop/maps.h"

#include "loop/loop_state.h"

#include <stdlib.h>
#include <string.h>

static bool allocate(const hs_loop *loop, hs_maps *maps, hs_error *err) {
    const hs_slab_layout *layout = hs_loop_layout(loop);
    maps->width = layout->width;
    maps->height = layout->height;
    maps->slices = layout->slices;
    const size_t rays = (size_t)maps->width * maps->height;
    maps->depth = calloc(rays, sizeof *maps->depth);
    maps->status = calloc(rays, 1);
    return (maps->depth && maps->status) ||
           hs_fail(err, HS_ERR_MEMORY, "maps: no memory for %u x %u pixels", maps->width, maps->height);
}

static bool read_confidence(const hs_loop *loop, size_t rays, hs_maps *maps, hs_error *err) {
    maps->sure = malloc(rays * sizeof *maps->sure);
    if (!maps->sure) return hs_fail(err, HS_ERR_MEMORY, "confidence: no memory for %zu pixels", rays);
    return hs_clipper_read_confidence(loop->clipper, maps->sure, err);
}

/* A map that was not used is not shown either, since it may be an earlier frame's. */
static bool read_back(const hs_loop *loop, hs_maps *maps, hs_error *err) {
    const size_t rays = (size_t)maps->width * maps->height;
    if (maps->frame.clipped && !hs_clipper_read_depth(loop->clipper, maps->depth, err)) return false;
    if (maps->frame.sure && !read_confidence(loop, rays, maps, err)) return false;
    if (maps->frame.outcome >= SV_OK) memcpy(maps->status, hs_clipper_status(loop->clipper), rays);
    return true;
}

bool hs_loop_read_maps(hs_loop *loop, uint32_t index, const hs_frame *frame, hs_maps *maps, hs_error *err) {
    *maps = (hs_maps){.frame = *frame};
    hs_loop_camera(loop, index, &maps->camera);
    const bool ok = allocate(loop, maps, err) && read_back(loop, maps, err);
    if (!ok) hs_maps_free(maps);
    return ok;
}

bool hs_loop_maps(hs_loop *loop, uint32_t index, hs_maps *maps, hs_error *err) {
    const bool wanted = hs_clipper_wants_confidence(loop->clipper);
    hs_frame frame;
    *maps = (hs_maps){0};
    hs_loop_want(loop, true, true);
    const bool ok = hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, err);
    hs_loop_want(loop, false, wanted);
    return ok && hs_loop_read_maps(loop, index, &frame, maps, err);
}

void hs_maps_free(hs_maps *maps) {
    free(maps->depth);
    free(maps->status);
    free(maps->sure);
    *maps = (hs_maps){0};
}
