/* SPDX-License-Identifier: MIT */
#include "console/console_show.h"

#include "base/paths.h"
#include "base/progress.h"
#include "console/console_draw.h"
#include "console/console_reply.h"
#include "picture/picture_jpeg.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { QUALITY = 92, DRAFT_QUALITY = 80, HEADER = 16 };

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

/* "SVP", kind, frame and view as 32 bits, width and height as 16, the lower byte first. */
static void put_header(uint8_t *out, unsigned kind, uint64_t frame, hs_console_view view,
                       const hs_picture *picture) {
    const uint32_t words[3] = {(uint32_t)frame, (uint32_t)view, picture->width | picture->height << 16};
    out[0] = 'S';
    out[1] = 'V';
    out[2] = 'P';
    out[3] = (uint8_t)kind;
    for (unsigned w = 0; w < 3; w++)
        for (unsigned b = 0; b < 4; b++) out[4 + 4 * w + b] = (uint8_t)(words[w] >> 8 * b);
}

static bool send_picture(const hs_console_show *show, unsigned kind, uint64_t frame, hs_console_view view,
                         const hs_picture *picture, const uint8_t *data, size_t bytes) {
    uint8_t *message = malloc(HEADER + bytes);
    if (!message) return false;
    put_header(message, kind, frame, view, picture);
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

/* Parameters of plugins that the page does not know yet. */
static bool tell_plugins(hs_console_show *show) {
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
    return show->open;
}

static bool refuse(const hs_console_show *show, const hs_error *err) {
    return say(show, hs_console_reply_text("refused", err->text));
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
    const bool followed = hs_console_stage_show(&show->stage, state, index, &err);
    if (!tell_plugins(show)) return false;
    if (followed && !send_views(show, &shown, &err) && err.code == HS_OK) return false;
    if (err.code != HS_OK) {
        memset(show->sent, 0, sizeof show->sent);
        return refuse(show, &err) && say(show, hs_console_reply_skipped(frame));
    }
    shown.all_ms = (hs_now() - start) * 1e3;
    return say(show, hs_console_reply_frame(&show->stage, &shown));
}

/* ------------------------------------------------------------------------------------------- deeds -- */

/* At rest, whatever is under way. */
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
    return ok ? say(show, hs_console_reply_written(folder, &report)) : refuse(show, &err);
}

bool hs_console_show_deed(hs_console_show *show, const hs_console_message *deed) {
    return deed->deed == HS_CONSOLE_SNAPSHOT ? snapshot(show, deed->view) : write_results(show);
}
