/* SPDX-License-Identifier: MIT */
#include "show/loop_knob.h"

#include "base/paths.h"
#include "loop/view.h"
#include "picture/picture_panel.h"
#include "plugin/loader_param.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#define POSITIONS 6u
#define CELL      256u /* pixels */

/* The pictures, one after the other, and what stands above them. */
typedef struct {
    uint8_t *rgba[POSITIONS];
    char captions[POSITIONS][96];
} turns;

/* Position 0 .. POSITIONS - 1 of the display range. */
static double knob_value(const sv_param_info *info, uint32_t position) {
    return info->display_min + (info->display_max - info->display_min) * position / (POSITIONS - 1);
}

/* One frame, then the knob at every position. */
static bool make_turns(hs_loop *loop, const hs_plugin *plugin, const hs_loop_options *options,
                       const sv_param_info *info, uint32_t index, turns *t, hs_error *err) {
    hs_frame frame = {0};
    if (!hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, err)) return false;
    for (uint32_t i = 0; i < POSITIONS; i++) {
        const size_t bytes = (size_t)options->dvr.width * options->dvr.height * 4;
        char text[64] = "";
        const double value = knob_value(info, i);
        hs_plugin_value_text(plugin, info, value, text, sizeof text);
        (void)snprintf(t->captions[i], sizeof t->captions[i], "%.24s = %s", info->key, text);
        t->rgba[i] = malloc(bytes);
        if (!t->rgba[i]) return hs_fail(err, HS_ERR_MEMORY, "knob.png: no memory for %zu bytes", bytes);
        if (!hs_loop_turn(loop, index, info, value, t->rgba[i], err)) return false;
    }
    return true;
}

static bool draw(const turns *t, const hs_loop_options *options, const sv_param_info *info, const char *title,
                 const char *path, hs_error *err) {
    hs_panel_item items[POSITIONS];
    for (uint32_t i = 0; i < POSITIONS; i++)
        items[i] = (hs_panel_item){.caption = t->captions[i],
                                   .image = {.data = t->rgba[i],
                                             .width = options->dvr.width,
                                             .height = options->dvr.height,
                                             .channels = 4}};
    const hs_caption caption = {.title = title, .footer = info->help};
    hs_picture picture;
    if (!hs_picture_panel(&picture, items, POSITIONS, CELL, &caption, err)) return false;
    const bool ok = hs_picture_save(&picture, path, err);
    hs_picture_free(&picture);
    return ok;
}

bool hs_loop_write_knob(hs_loop *loop, const hs_plugin *plugin, const hs_loop_options *options,
                        uint32_t index, const char *folder, const char *title, hs_error *err) {
    sv_param_info info;
    char path[PATH_MAX];
    if (!plugin || !hs_plugin_find_primary(plugin, &info)) return true;
    if (!hs_path_join(folder, "knob.png", path, sizeof path, err)) return false;
    turns t = {0};
    const bool ok = make_turns(loop, plugin, options, &info, index, &t, err) &&
                    draw(&t, options, &info, title, path, err);
    for (uint32_t i = 0; i < POSITIONS; i++) free(t.rgba[i]);
    return ok;
}
