/* SPDX-License-Identifier: MIT */
/* Where in the volume a mark is that was put on a picture. */
#include "console/console.h"

#include "loop/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SEEN 0.5f /* a ray's opacity at what is seen; tissue that lets light through has it, too */

/* How deep in the box what is seen at a place of the picture lies, mm. `frame` NULL: in the full volume. */
static bool find_seen(hs_console_stage *stage, hs_loop *loop, const hs_frame *frame, const double at[2],
                      double *mm, hs_error *err) {
    hs_dvr_settings s = stage->screen_dvr;
    s.look = HS_LOOK_THESIS; /* rays end at the same depth in either look, and are sooner drawn in this one */
    s.width = s.height = stage->state.picture;
    s.termination = SEEN;
    s.step = 1.0f;
    s.ghost_width = s.ghost_offset = 0.0f;
    const uint32_t x = (uint32_t)fmin(at[0] * s.width, s.width - 1.0);
    const uint32_t y = (uint32_t)fmin(at[1] * s.height, s.height - 1.0);
    hs_camera window;
    uint32_t steps = 1;
    hs_screen *screen = hs_screen_create(&stage->cl, &s, err);
    float *ends = screen ? calloc((size_t)s.width * s.height, sizeof *ends) : NULL;
    bool ok = ends || (screen && hs_fail(err, HS_ERR_MEMORY, "mark: no memory for %u^2 pixels", s.width));
    ok = ok && hs_loop_pick(loop, screen, stage->index, frame, &window, &steps, ends, err);
    const double end = ok ? (double)ends[(size_t)y * s.width + x] : 0.0;
    free(ends);
    hs_screen_destroy(screen);
    *mm = ok ? (end + 0.5) / steps * window.depth_extent : 0.0;
    return ok && (end < steps || hs_fail(err, HS_ERR_INPUT, "There is nothing to see at this place."));
}

static bool changes_something(const hs_mark *mark, const hs_volume *volume, const hs_maps *maps,
                              hs_error *err) {
    const uint32_t n[3] = {maps->width, maps->height, maps->slices};
    const size_t bytes = (size_t)n[0] * n[1] * sizeof(float);
    float *marked = malloc(bytes);
    if (!marked) return hs_fail(err, HS_ERR_MEMORY, "mark: no memory for %zu bytes", bytes);
    memcpy(marked, maps->depth, bytes);
    const bool ok = hs_marks_apply(mark, 1, volume, &maps->camera, n, marked, err);
    const bool same = memcmp(marked, maps->depth, bytes) == 0;
    free(marked);
    return ok && (!same || hs_fail(err, HS_ERR_INPUT,
                                   mark->keep ? "Nothing was cut from what is seen there."
                                              : "Nothing lies behind what is seen there."));
}

/* What is seen under the pointer; or, to keep it, the end of what was cut last before it. */
static bool find_place(hs_console_stage *stage, hs_console_view view, const double at[2],
                       const hs_volume *volume, const hs_maps *maps, hs_mark *mark, hs_error *err) {
    const hs_lane *lane = &stage->lane[view == HS_CONSOLE_OTHER];
    const uint32_t n[3] = {maps->width, maps->height, maps->slices};
    const bool was_cut = mark->keep && view != HS_CONSOLE_FULL;
    hs_camera window;
    float share;
    double mm = 0.5 * maps->camera.depth_extent;
    hs_loop_window(lane->loop, stage->index, &window, &share);
    if (!was_cut &&
        !find_seen(stage, lane->loop, view == HS_CONSOLE_FULL ? NULL : &lane->frame, at, &mm, err))
        return false;
    const double seen[3] = {(at[0] - 0.5) * window.extent, (at[1] - 0.5) * window.extent,
                            mm - 0.5 * window.depth_extent};
    hs_marks_place(volume, &window, seen, mark->place);
    if (was_cut && !hs_marks_find_cut(mark, volume, &maps->camera, n, maps->depth))
        return hs_fail(err, HS_ERR_INPUT, "Nothing was cut at this place.");
    for (int a = 0; a < 3; a++) mark->place[a] = round(mark->place[a] * 100.0) / 100.0;
    return true;
}

bool hs_console_stage_mark(hs_console_stage *stage, hs_console_view view, const double at[2], hs_mark *mark,
                           hs_error *err) {
    const hs_lane *lane = &stage->lane[view == HS_CONSOLE_OTHER];
    const bool shows_tissue =
        view == HS_CONSOLE_RESULT || view == HS_CONSOLE_FULL || view == HS_CONSOLE_OTHER;
    hs_maps maps;
    if (!shows_tissue || !lane->loop || !lane->frame.clipped)
        return hs_fail(err, HS_ERR_INPUT, "Nothing is clipped here, so there is nothing to mark.");
    const hs_volume *volume = hs_source_bring(&stage->source, stage->index % stage->source.count, err);
    if (!volume || !hs_loop_read_maps(lane->loop, stage->index, &lane->frame, &maps, err)) return false;
    const bool ok =
        find_place(stage, view, at, volume, &maps, mark, err) && changes_something(mark, volume, &maps, err);
    hs_maps_free(&maps);
    return ok;
}
