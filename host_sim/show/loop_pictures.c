/* SPDX-License-Identifier: MIT */
#include "show/loop_pictures.h"

#include "core/paths.h"
#include "core/system.h"
#include "loop/view.h"
#include "picture/picture.h"
#include "picture/picture_draw.h"
#include "show/picture_map.h"
#include "show/picture_slices.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *hs_frame_note(const hs_frame *frame, const char *failure, char *out, size_t bytes) {
    if (frame->clipped && hs_doubt_words(frame->doubt, out, bytes)) return out;
    if (frame->clipped && frame->outcome == SV_OK) return NULL;
    if (frame->clipped)
        (void)snprintf(out, bytes,
                       "Clipped in part: %u of %u rays have no clipping surface and show everything.",
                       frame->stats.unfilled, frame->stats.rays);
    else if (frame->outcome == SV_NO_SURFACE)
        (void)snprintf(out, bytes, "No fluid found before the fetus: nothing removed.");
    else if (frame->outcome > SV_OK)
        (void)snprintf(out, bytes, "Not clipped: the plugin says %s.", hs_status_name(frame->outcome));
    else
        (void)snprintf(out, bytes, "Not clipped: %s", failure);
    return out;
}

/* What the colours of a view's renderings mean; NULL in the thesis' look, whose brightness is the echo's. */
static const char *hs_view_legend(const hs_view *view) {
    if (view->look != HS_LOOK_LIT) return NULL;
    if (!view->maps.frame.clipped)
        return "Skin tones: surfaces, darker and redder with depth. Grey: the scan's end.";
    if (view->ghosted)
        return "Skin tones: surfaces, redder with depth. Grey: cut by the clipping surface or the scan's "
               "end. Blue veil: removed tissue, shown faintly.";
    return "Skin tones: surfaces, redder with depth. Grey: cut by the clipping surface or the scan's end.";
}

/* The colours' meaning, and below it the note; NULL if there is neither. */
static const char *foot_of(const hs_view *view, const char *note, char *out, size_t bytes) {
    const char *legend = hs_view_legend(view);
    if (!legend) return note;
    (void)snprintf(out, bytes, "%s%s%s", legend, note ? "\n" : "", note ? note : "");
    return out;
}

/* The depthmap in millimetres from the front of the box; what clips nothing stays 0 or below. The caller
 * frees it. NULL without memory. */
static float *depth_in_mm(const hs_view *view, hs_error *err) {
    const size_t rays = (size_t)view->maps.width * view->maps.height;
    const double slice = view->maps.camera.depth_extent / view->maps.slices;
    float *mm = hs_memory(1, rays * sizeof *mm, "depthmap", err);
    if (!mm) return NULL;
    for (size_t i = 0; i < rays; i++)
        mm[i] = view->maps.depth[i] > 0.0f ? (float)(((double)view->maps.depth[i] + 0.5) * slice)
                                           : view->maps.depth[i];
    return mm;
}

/* Saves and frees; `made` tells whether the picture is there. */
static bool save(bool made, hs_picture *picture, const char *folder, const char *name, hs_error *err) {
    char path[SYS_PATH];
    const bool ok =
        made && hs_path_join(folder, name, path, sizeof path, err) && hs_picture_save(picture, path, err);
    if (made) hs_picture_free(picture);
    return ok;
}

static hs_image rgba_image(const hs_view *view, const uint8_t *pixels) {
    return (hs_image){.data = pixels, .width = view->width, .height = view->height};
}

/* A rendered picture without anything around it. */
static bool write_plain(const hs_view *view, const uint8_t *pixels, const char *folder, const char *name,
                        hs_error *err) {
    hs_picture picture;
    const hs_image image = rgba_image(view, pixels);
    const bool made = hs_picture_init(&picture, view->width, view->height, 0, err);
    if (made) hs_picture_blit(&picture, 0, 0, view->width, view->height, &image, HS_SCALE_NEAREST);
    return save(made, &picture, folder, name, err);
}

static bool write_panel(const hs_view *view, const char *folder, const char *title, const char *note,
                        uint32_t cell, hs_error *err) {
    const char *result = !view->maps.frame.clipped              ? "Result: not clipped"
                         : view->maps.frame.doubt.wanted > 0.0f ? "Result: doubtful, the fetus may be cut"
                                                                : "Result";
    const hs_panel_item items[3] = {{.caption = "Full volume", .image = rgba_image(view, view->full)},
                                    {.caption = result, .image = rgba_image(view, view->result)},
                                    {.caption = "Ground truth", .image = rgba_image(view, view->truth)}};
    char foot[1400];
    const hs_caption caption = {.title = title, .footer = foot_of(view, note, foot, sizeof foot)};
    hs_picture picture;
    const bool made = hs_picture_panel(&picture, items, view->truth ? 3 : 2, cell, &caption, err);
    return save(made, &picture, folder, "panel.png", err);
}

static bool write_depthmap(const hs_view *view, const char *folder, const char *title, const char *note,
                           hs_error *err) {
    char facts[1400];
    const hs_camera *c = &view->maps.camera;
    (void)snprintf(facts, sizeof facts,
                   "%u x %u rays over %.0f x %.0f mm, %.0f mm deep, seen from the viewer%s%s",
                   view->maps.width, view->maps.height, c->extent, c->extent, c->depth_extent,
                   note ? "\n" : "", note ? note : "");
    const hs_caption caption = {.title = title, .footer = facts};
    hs_picture picture;
    float *mm = depth_in_mm(view, err);
    const bool made =
        mm && hs_picture_depthmap(&picture, mm, view->maps.width, view->maps.height, &caption, err);
    free(mm);
    return save(made, &picture, folder, "depthmap.png", err);
}

/* What an earlier run left under a name that this one has no picture for, is not this one's. */
static bool leave_out(const char *folder, const char *name, hs_error *err) {
    char path[SYS_PATH];
    if (!hs_path_join(folder, name, path, sizeof path, err)) return false;
    return sys_remove(path) || errno == ENOENT ||
           hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be removed: %s", path, strerror(errno));
}

/* Only a plugin that has one gives a confidence. */
static bool write_confidence(const hs_view *view, const char *folder, const char *title, hs_error *err) {
    static const hs_share_words words = {.quantity = "confidence", .high = "sure", .low = "nothing is known"};
    const hs_caption caption = {
        .title = title,
        .footer = "how sure the plugin is of its depthmap; where it is not, ghosting begins sooner"};
    hs_picture picture;
    if (!view->maps.confidence) return leave_out(folder, "confidence.png", err);
    const bool made = hs_picture_share(&picture, view->maps.confidence, view->maps.width, view->maps.height,
                                       &words, &caption, err);
    return save(made, &picture, folder, "confidence.png", err);
}

static bool write_slices(const hs_view *view, const char *folder, const char *title, const char *note,
                         uint32_t cell, hs_error *err) {
    char foot[1400];
    const hs_caption caption = {.title = title, .footer = foot_of(view, note, foot, sizeof foot)};
    hs_picture picture;
    const bool made = hs_picture_slices(&picture, view, cell, &caption, err);
    return save(made, &picture, folder, "slices.png", err);
}

bool hs_loop_write_result(const hs_view *view, const char *folder, hs_error *err) {
    return write_plain(view, view->result, folder, "result.png", err);
}

bool hs_loop_write_full(const hs_view *view, const char *folder, hs_error *err) {
    return write_plain(view, view->full, folder, "full.png", err);
}

bool hs_loop_write_rest(const hs_view *view, const char *folder, const char *title, const char *note,
                        uint32_t cell, hs_error *err) {
    return (!view->truth || write_plain(view, view->truth, folder, "truth.png", err)) &&
           write_panel(view, folder, title, note, cell, err) &&
           write_slices(view, folder, title, note, cell, err) &&
           write_depthmap(view, folder, title, note, err) && write_confidence(view, folder, title, err);
}

bool hs_loop_write_pictures(const hs_view *view, const char *folder, const char *title, const char *note,
                            uint32_t cell, hs_error *err) {
    return hs_loop_write_result(view, folder, err) && hs_loop_write_full(view, folder, err) &&
           hs_loop_write_rest(view, folder, title, note, cell, err);
}
