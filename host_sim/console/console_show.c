/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "core/paths.h"
#include "core/progress.h"
#include "loop/view.h"
#include "picture/picture.h"
#include "show/picture_map.h"
#include "show/picture_slices.h"

#include <limits.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ----------------------------------------------------------------------------------------------- views -- */
/* The views of a stage as pictures. */

/* What a page has of a view. */
typedef struct {
    bool sent;
    uint32_t size;
    uint64_t scene_epoch, clip_epoch;
    double cross[3], thick;
} hs_console_sent;

#define BAND_MM 8.0 /* half the width of the confidence band where nothing is sure */

/* True if the stage can draw the view at all: a truth needs a scene, the other result a second lane. */
static bool hs_console_can_draw(const hs_console_stage *stage, hs_console_view view) {
    if (view == HS_CONSOLE_TRUTH) return stage->truth != NULL;
    return view != HS_CONSOLE_OTHER || stage->lane[1].loop != NULL;
}

static bool is_slice(hs_console_view view) {
    return view == HS_CONSOLE_ACROSS || view == HS_CONSOLE_ALONG || view == HS_CONSOLE_DEEP;
}

static bool same_place(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* True if the view looks otherwise than what was sent; notes it as sent. */
static bool hs_console_is_stale(const hs_console_stage *stage, hs_console_view view, hs_console_sent *sent) {
    const bool clips = view != HS_CONSOLE_FULL && view != HS_CONSOLE_TRUTH;
    const uint64_t clip_epoch = clips ? stage->clip_epoch : 0;
    const bool same = sent->sent && sent->size == stage->screen_dvr.width &&
                      sent->scene_epoch == stage->scene_epoch && sent->clip_epoch == clip_epoch &&
                      (!is_slice(view) ||
                       (same_place(sent->cross, stage->state.cross) && sent->thick == stage->state.thick));
    *sent = (hs_console_sent){.sent = true,
                              .size = stage->screen_dvr.width,
                              .scene_epoch = stage->scene_epoch,
                              .clip_epoch = clip_epoch,
                              .thick = stage->state.thick};
    memcpy(sent->cross, stage->state.cross, sizeof sent->cross);
    return !same;
}

static bool from_rgba(const uint8_t *rgba, uint32_t size, hs_picture *out, hs_error *err) {
    if (!hs_picture_init(out, size, size, 0, err)) return false;
    for (size_t i = 0; i < (size_t)size * size; i++)
        out->pixels[i] = (uint32_t)rgba[4 * i] << 16 | (uint32_t)rgba[4 * i + 1] << 8 | rgba[4 * i + 2];
    return true;
}

/* Draws a view that the renderer makes. */
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
                        .maps = maps,
                        .band_mm = BAND_MM,
                        .thick_mm = stage->state.thick,
                        .crop = stage->source.crop.used ? &stage->source.crop : NULL};
    for (int k = 0; k < 3; k++) {
        s.low[k] = 0.5 - 0.5 * share;
        s.side[k] = share;
        s.at[k] = fmin(fmax(s.low[k] + share * stage->state.cross[k], 0.0), 1.0);
    }
    if (!s.volume) return false;
    uint8_t *rgba = calloc((size_t)size * size, 4);
    uint8_t *state = calloc((size_t)size * size, sizeof *state);
    bool ok =
        (rgba && state) || hs_fail(err, HS_ERR_MEMORY, "slice: no memory for %u x %u pixels", size, size);
    if (ok) {
        hs_slice_fill(&s, plane, size, rgba, state);
        ok = from_rgba(rgba, size, out, err);
    }
    free(rgba);
    free(state);
    return ok;
}

/* The map's depth at a pixel of a picture with `size` of them a side; negative: it lies beside the map, or
 * nothing was scanned there. */
static double depth_at(const hs_maps *maps, double share, uint32_t size, uint32_t pixel) {
    const uint32_t column = pixel % size, row = pixel / size;
    const double u = 0.5 + ((column + 0.5) / size - 0.5) * share,
                 v = 0.5 + ((row + 0.5) / size - 0.5) * share;
    if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) return -1.0;
    return (double)maps->depth[(size_t)(v * maps->height) * maps->width + (size_t)(u * maps->width)];
}

/* Depths in viridis, over those that are seen; what clips nothing is hatched. */
static bool draw_depthmap(hs_console_stage *stage, const hs_maps *maps, hs_picture *out, hs_error *err) {
    const uint32_t size = stage->screen_dvr.width;
    const double share = window_share(stage), mm = maps->camera.depth_extent / maps->slices;
    double low = INFINITY, high = 0.0;
    if (!hs_picture_init(out, size, size, HS_COLOUR_BACKGROUND, err)) return false;
    for (uint32_t p = 0; p < size * size; p++) {
        const double depth = depth_at(maps, share, size, p);
        low = depth > 0.0 ? fmin(low, depth) : low;
        high = fmax(high, depth);
    }
    for (uint32_t p = 0; p < size * size; p++) {
        const double depth = depth_at(maps, share, size, p);
        const uint32_t nothing = (p % size + p / size) / 6 % 2 ? HS_COLOUR_NOTHING_A : HS_COLOUR_NOTHING_B;
        if (depth >= 0.0)
            out->pixels[p] =
                depth > 0.0 ? hs_colour_viridis((depth - low) / fmax(high - low, 1e-9)) : nothing;
    }
    stage->depth_mm[0] = high > 0.0 ? (low + 0.5) * mm : 0.0;
    stage->depth_mm[1] = high > 0.0 ? (high + 0.5) * mm : 0.0;
    return true;
}

static bool draw_map(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err) {
    hs_maps maps;
    if (!hs_loop_read_maps(stage->lane[0].loop, stage->index, &stage->lane[0].frame, &maps, err))
        return false;
    const hs_volume *volume = hs_source_bring(&stage->source, stage->index, err);
    if (volume && view == HS_CONSOLE_DEPTH) {
        hs_maps_crop(&maps, &stage->source);
        hs_maps_scan(&maps, volume);
    }
    const bool ok = volume && view == HS_CONSOLE_DEPTH
                        ? draw_depthmap(stage, &maps, out, err)
                        : draw_slice(stage, (hs_slice_plane)(view - HS_CONSOLE_ACROSS), &maps, out, err);
    hs_maps_free(&maps);
    return ok;
}

/* Draws a view at the screen's size. Allocates *out (hs_picture_free); zeroed on failure: HS_ERR_DEVICE,
 * HS_ERR_MEMORY or those of the source. */
static bool hs_console_draw(hs_console_stage *stage, hs_console_view view, hs_picture *out, hs_error *err) {
    *out = (hs_picture){0};
    return view == HS_CONSOLE_DEPTH || is_slice(view) ? draw_map(stage, view, out, err)
                                                      : draw_rendered(stage, view, out, err);
}

/* ------------------------------------------------------------------------------------------------ show -- */

enum { QUALITY = 92, DRAFT_QUALITY = 80, HEADER = 20 };

/* What a binary message holds. */
enum { KIND_JPEG = 0, KIND_PNG = 1 };

struct hs_console_show {
    const hs_console_shared *shared;
    hs_console_send send;
    void *connection;
    hs_console_stage stage;
    bool open; /* the stage is: a page that asks for nothing takes no device */
    hs_console_sent sent[HS_CONSOLE_VIEWS];
};

/* Sends a text that was made for it, and frees it. */
static bool say(const hs_console_show *show, char *text) {
    const bool ok = text && show->send(show->connection, false, (const uint8_t *)text, strlen(text));
    free(text);
    return ok;
}

hs_console_show *hs_console_show_open(const hs_console_shared *shared, hs_console_send send,
                                      void *connection) {
    hs_console_show *show = calloc(1, sizeof *show);
    if (!show) return NULL;
    show->shared = shared;
    show->send = send;
    show->connection = connection;
    if (say(show, hs_console_reply_hello(&shared->offers, &shared->files))) return show;
    hs_console_show_close(show);
    return NULL;
}

void hs_console_show_close(hs_console_show *show) {
    if (!show) return;
    if (show->open) hs_console_stage_close(&show->stage);
    free(show);
}

/* -------------------------------------------------------------------------------------------- frame -- */

/* "SVP", kind, frame and view as 32 bits, width and height as 16, the state's serial as 32, the lower byte
 * first. */
static void put_header(uint8_t *out, unsigned kind, uint64_t frame, hs_console_view view,
                       const hs_picture *picture, uint64_t serial) {
    const uint32_t words[4] = {(uint32_t)frame, (uint32_t)view, picture->width | picture->height << 16,
                               (uint32_t)serial};
    out[0] = 'S';
    out[1] = 'V';
    out[2] = 'P';
    out[3] = (uint8_t)kind;
    for (unsigned w = 0; w < 4; w++)
        for (unsigned b = 0; b < 4; b++) out[4 + 4 * w + b] = (uint8_t)(words[w] >> 8 * b);
}

static bool send_picture(const hs_console_show *show, unsigned kind, uint64_t frame, hs_console_view view,
                         const hs_picture *picture, const uint8_t *data, size_t bytes) {
    uint8_t *message = malloc(HEADER + bytes);
    if (!message) return false;
    put_header(message, kind, frame, view, picture, show->stage.state.serial);
    memcpy(message + HEADER, data, bytes);
    const bool ok = show->send(show->connection, true, message, HEADER + bytes);
    free(message);
    return ok;
}

/* One view, drawn and sent. False with an error: it cannot be drawn; without: the page is gone. */
static bool send_view(hs_console_show *show, hs_console_view view, hs_console_shown *shown, hs_error *err) {
    hs_picture picture;
    uint8_t *data = NULL;
    size_t bytes = 0;
    const double start = hs_now();
    if (!hs_console_draw(&show->stage, view, &picture, err)) return false;
    const double drawn = hs_now();
    const int quality = show->stage.state.hurried ? DRAFT_QUALITY : QUALITY;
    bool ok = hs_picture_jpeg(&picture, quality, &data, &bytes, err);
    shown->draw_ms += (drawn - start) * 1e3;
    shown->encode_ms += (hs_now() - drawn) * 1e3;
    ok = ok && send_picture(show, KIND_JPEG, shown->frame, view, &picture, data, bytes);
    shown->pictures++;
    free(data);
    hs_picture_free(&picture);
    return ok;
}

static bool send_views(hs_console_show *show, hs_console_shown *shown, hs_error *err) {
    for (uint32_t v = 0; v < HS_CONSOLE_VIEWS; v++) {
        const hs_console_view view = (hs_console_view)v;
        if (!(show->stage.state.views >> v & 1u) || !hs_console_can_draw(&show->stage, view)) continue;
        if (!hs_console_is_stale(&show->stage, view, &show->sent[v])) continue;
        if (!send_view(show, view, shown, err)) return false;
    }
    return true;
}

/* Sends the parameters of plugins that the page does not know yet. */
static bool send_plugins(hs_console_show *show) {
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++) {
        if (!show->stage.lane[i].offer || show->stage.told[i]) continue;
        show->stage.told[i] = true;
        if (!say(show, hs_console_reply_plugin(&show->stage, i))) return false;
    }
    return true;
}

static bool open_stage(hs_console_show *show, hs_error *err) {
    show->open =
        show->open || hs_console_stage_open(&show->stage, &show->shared->offers, &show->shared->files, err);
    show->stage.lowres = show->shared->lowres;
    show->stage.read = show->shared->read;
    return show->open;
}

/* Takes every "FOLDER/" out of a text. */
static void leave_out(char *text, const char *folder) {
    const size_t length = strlen(folder);
    for (char *at = text; length > 0 && (at = strstr(at, folder)) != NULL;) {
        if (at[length] != '/') {
            at += length;
            continue;
        }
        memmove(at, at + length + 1, strlen(at + length + 1) + 1);
    }
}

/* A page names files by their paths in a folder of the command line, and is told them so: where the folder
 * lies is not its business. */
static bool refuse(const hs_console_show *show, const hs_error *err) {
    hs_error told = *err;
    for (uint32_t i = show->shared->files.count; i-- > 0;) /* the last may lie in another */
        leave_out(told.text, show->shared->files.folder[i]);
    leave_out(told.text, show->shared->out);
    return say(show, hs_console_reply_text("refused", told.text));
}

bool hs_console_show_is_rebuilt(const hs_console_show *show) {
    return show->open && hs_console_stage_is_rebuilt(&show->stage);
}

bool hs_console_show_rest(hs_console_show *show) {
    const bool works = show->open && hs_console_stage_loop(&show->stage) != NULL;
    if (works) hs_console_stage_rest(&show->stage);
    return works;
}

/* What a deed is of: a stage that was at rest draws its last state again. */
static bool wake(hs_console_show *show, hs_error *err) {
    if (!show->open || !show->stage.has_source || hs_console_stage_loop(&show->stage)) return true;
    const hs_console_state state = show->stage.state;
    return hs_console_stage_show(&show->stage, &state, show->stage.index, err);
}

bool hs_console_show_frame(hs_console_show *show, const hs_console_state *state, uint32_t index,
                           uint64_t frame) {
    hs_error err = {0};
    hs_console_shown shown = {.frame = frame};
    const double start = hs_now();
    if (!open_stage(show, &err)) return refuse(show, &err) && say(show, hs_console_reply_skipped(frame));
    if (hs_console_stage_changes_source(&show->stage, state) &&
        !say(show, hs_console_reply_text("busy", state->source.scene[0] ? "Generating the scene"
                                                                        : "Reading the file")))
        return false;
    if (hs_console_show_is_rebuilt(show) &&
        !say(show, hs_console_reply_text("busy", "The plugin was built anew: loading it")))
        return false;
    const bool followed = hs_console_stage_show(&show->stage, state, index, &err);
    if (!send_plugins(show)) return false;
    if (followed && !send_views(show, &shown, &err) && err.code == HS_OK) return false;
    if (err.code != HS_OK) {
        memset(show->sent, 0, sizeof show->sent);
        return refuse(show, &err) && say(show, hs_console_reply_skipped(frame));
    }
    shown.all_ms = (hs_now() - start) * 1e3;
    return say(show, hs_console_reply_frame(&show->stage, &shown));
}

/* ------------------------------------------------------------------------------------------- deeds -- */

/* Draws a view as it is at rest, whatever is under way. */
static bool draw_at_rest(hs_console_show *show, hs_console_view view, hs_picture *picture, hs_error *err) {
    hs_console_state state = show->stage.state;
    state.hurried = false;
    state.views |= 1u << view;
    if (!show->stage.has_source) return hs_fail(err, HS_ERR_INPUT, "snapshot: nothing is shown yet");
    if (!hs_console_can_draw(&show->stage, view))
        return hs_fail(err, HS_ERR_INPUT, "snapshot: there is no view '%s' now", hs_console_view_name(view));
    return hs_console_stage_show(&show->stage, &state, show->stage.index, err) &&
           hs_console_draw(&show->stage, view, picture, err);
}

static bool snapshot(hs_console_show *show, hs_console_view view) {
    hs_error err = {0};
    hs_picture picture = {0};
    uint8_t *data = NULL;
    size_t bytes = 0;
    if (!draw_at_rest(show, view, &picture, &err)) return refuse(show, &err);
    bool ok = hs_picture_png(&picture, &data, &bytes, &err);
    ok = ok ? send_picture(show, KIND_PNG, 0, view, &picture, data, bytes) : refuse(show, &err);
    free(data);
    hs_picture_free(&picture);
    return ok;
}

/* A folder for every time: "OUT/0001", ..., of this process. */
static bool make_folder(const hs_console_show *show, char out[PATH_MAX], hs_error *err) {
    static atomic_uint count;
    char name[32];
    do {
        (void)snprintf(name, sizeof name, "%04u", atomic_fetch_add(&count, 1u) + 1u);
        if (!hs_path_join(show->shared->out, name, out, PATH_MAX, err)) return false;
    } while (access(out, F_OK) == 0);
    return hs_path_make_folder(out, err);
}

static bool write_results(hs_console_show *show) {
    hs_error err = {0};
    char folder[PATH_MAX];
    hs_result_report report = {0};
    hs_loop *loop = show->open ? hs_console_stage_loop(&show->stage) : NULL;
    bool ok = loop != NULL || hs_fail(&err, HS_ERR_INPUT, "write: nothing is shown yet");
    if (ok && !say(show, hs_console_reply_text("busy", "Writing the results"))) return false;
    ok = ok && make_folder(show, folder, &err) &&
         hs_results_write(loop, &show->stage.source, 0, HS_RESULT_ALL, folder, &report, &err);
    /* The loop went through all volumes: what is shown now is not the last frame it had. */
    if (loop) hs_lane_needs(&show->stage.lane[0], HS_LANE_CONVERT);
    return ok ? say(show, hs_console_reply_written(&show->stage, folder, &report)) : refuse(show, &err);
}

static bool find_mark(hs_console_show *show, const hs_console_message *deed) {
    hs_error err = {0};
    hs_mark mark = deed->mark;
    const bool ok = show->open && show->stage.has_source
                        ? hs_console_stage_mark(&show->stage, deed->view, deed->at, &mark, &err)
                        : hs_fail(&err, HS_ERR_INPUT, "mark: nothing is shown yet");
    return (ok || refuse(show, &err)) && say(show, hs_console_reply_marked(ok ? &mark : NULL));
}

bool hs_console_show_deed(hs_console_show *show, const hs_console_message *deed) {
    hs_error err = {0};
    if (!wake(show, &err) && !refuse(show, &err)) return false;
    if (deed->deed == HS_CONSOLE_MARK) return find_mark(show, deed);
    return deed->deed == HS_CONSOLE_SNAPSHOT ? snapshot(show, deed->view) : write_results(show);
}
