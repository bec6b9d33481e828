/* SPDX-License-Identifier: MIT */
#include "console/console_draw.h"

#include "loop/maps.h"
#include "picture/picture_colour.h"
#include "show/picture_map.h"
#include "show/slice_pixels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BAND_MM 8.0 /* half the width of the confidence band where nothing is sure */

bool hs_console_can_draw(const hs_console_stage *stage, hs_console_view view) {
    if (view == HS_CONSOLE_TRUTH) return stage->truth != NULL;
    return view != HS_CONSOLE_OTHER || stage->lane[1].loop != NULL;
}

static bool is_slice(hs_console_view view) {
    return view == HS_CONSOLE_ACROSS || view == HS_CONSOLE_ALONG || view == HS_CONSOLE_DEEP;
}

static bool same_place(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool hs_console_is_stale(const hs_console_stage *stage, hs_console_view view, hs_console_sent *sent) {
    const bool clips = view != HS_CONSOLE_FULL && view != HS_CONSOLE_TRUTH;
    const uint64_t clip_epoch = clips ? stage->clip_epoch : 0;
    const bool same = sent->sent && sent->size == stage->screen_dvr.width &&
                      sent->scene_epoch == stage->scene_epoch && sent->clip_epoch == clip_epoch &&
                      (!is_slice(view) || same_place(sent->cross, stage->state.cross));
    *sent = (hs_console_sent){.sent = true,
                              .size = stage->screen_dvr.width,
                              .scene_epoch = stage->scene_epoch,
                              .clip_epoch = clip_epoch};
    memcpy(sent->cross, stage->state.cross, sizeof sent->cross);
    return !same;
}

static bool from_rgba(const uint8_t *rgba, uint32_t size, hs_picture *out, hs_error *err) {
    if (!hs_picture_init(out, size, size, 0, err)) return false;
    for (size_t i = 0; i < (size_t)size * size; i++)
        out->pixels[i] = (uint32_t)rgba[4 * i] << 16 | (uint32_t)rgba[4 * i + 1] << 8 | rgba[4 * i + 2];
    return true;
}

/* What the renderer draws. */
static bool render(hs_console_stage *stage, hs_console_view view, hs_error *err) {
    hs_lane *lane = &stage->lane[view == HS_CONSOLE_OTHER];
    if (view == HS_CONSOLE_TRUTH)
        return hs_truth_picture_draw(stage->truth, stage->screen, stage->screen_dvr.look, stage->index, err);
    return hs_loop_draw(lane->loop, stage->screen, stage->index,
                        view == HS_CONSOLE_FULL ? NULL : &lane->frame, err);
}

static bool draw_rendered(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err) {
    const uint32_t size = stage->screen_dvr.width;
    uint8_t *rgba = malloc((size_t)size * size * 4);
    if (!rgba) return hs_fail(err, HS_ERR_MEMORY, "picture: no memory for %u x %u pixels", size, size);
    const bool ok = render(stage, view, err) && hs_screen_read(stage->screen, rgba, err) &&
                    from_rgba(rgba, size, out, err);
    free(rgba);
    return ok;
}

/* The share of the box that the picture's window shows. */
static double window_share(hs_console_stage *stage) {
    hs_camera window;
    float share;
    hs_loop_window(stage->lane[0].loop, stage->index, &window, &share);
    return (double)share;
}

static bool draw_slice(hs_console_stage *stage, hs_slice_plane plane, const hs_maps *maps, hs_picture *out,
                       hs_error *err) {
    const uint32_t size = stage->screen_dvr.width;
    const double share = window_share(stage);
    hs_slice_scene s = {.volume = hs_source_bring(&stage->source, stage->index, err),
                        .camera = maps->camera,
                        .map_width = maps->width,
                        .map_height = maps->height,
                        .slices = maps->slices,
                        .depth = maps->depth,
                        .sure = maps->sure,
                        .band_mm = BAND_MM};
    for (int k = 0; k < 3; k++) {
        s.low[k] = 0.5 - 0.5 * share;
        s.side[k] = share;
        s.at[k] = fmin(fmax(s.low[k] + share * stage->state.cross[k], 0.0), 1.0);
    }
    if (!s.volume) return false;
    uint8_t *rgba = calloc((size_t)size * size, 4);
    bool *removed = calloc((size_t)size * size, sizeof *removed);
    bool ok =
        (rgba && removed) || hs_fail(err, HS_ERR_MEMORY, "slice: no memory for %u x %u pixels", size, size);
    if (ok) {
        hs_slice_fill(&s, plane, size, rgba, removed);
        ok = from_rgba(rgba, size, out, err);
    }
    free(rgba);
    free(removed);
    return ok;
}

/* Depths in viridis, over the depths that the slices show; what clips nothing is hatched. */
static bool draw_depthmap(hs_console_stage *stage, const hs_maps *maps, hs_picture *out, hs_error *err) {
    const uint32_t size = stage->screen_dvr.width;
    const double share = window_share(stage);
    if (!hs_picture_init(out, size, size, HS_COLOUR_BACKGROUND, err)) return false;
    for (uint32_t j = 0; j < size; j++)
        for (uint32_t i = 0; i < size; i++) {
            const double u = 0.5 + ((i + 0.5) / size - 0.5) * share,
                         v = 0.5 + ((j + 0.5) / size - 0.5) * share;
            if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) continue;
            const size_t at = (size_t)(v * maps->height) * maps->width + (size_t)(u * maps->width);
            const double depth = (double)maps->depth[at];
            const uint32_t nothing = (i + j) / 6 % 2 ? HS_COLOUR_NOTHING_A : HS_COLOUR_NOTHING_B;
            const double t = ((depth + 0.5) / maps->slices - 0.5) / fmin(share, 1.0) + 0.5;
            out->pixels[(size_t)j * size + i] = depth > 0.0 ? hs_colour_viridis(t) : nothing;
        }
    return true;
}

static bool draw_map(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err) {
    hs_maps maps;
    if (!hs_loop_read_maps(stage->lane[0].loop, stage->index, &stage->lane[0].frame, &maps, err))
        return false;
    const bool ok = view == HS_CONSOLE_DEPTH
                        ? draw_depthmap(stage, &maps, out, err)
                        : draw_slice(stage, (hs_slice_plane)(view - HS_CONSOLE_ACROSS), &maps, out, err);
    hs_maps_free(&maps);
    return ok;
}

bool hs_console_draw(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err) {
    *out = (hs_picture){0};
    return view == HS_CONSOLE_DEPTH || is_slice(view) ? draw_map(stage, view, out, err)
                                                      : draw_rendered(stage, view, out, err);
}
