/* The picture of the one knob a user turns: the same frame for several positions of it. */
#include "hs_loop_pictures.h"

#include "hs_cli.h"
#include "hs_picture.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POSITIONS 6u
#define CELL      256u /* pixels */

/* Position 0 .. POSITIONS - 1 of the display range. */
static double knob_value(const sv_param_info *info, uint32_t position) {
    return info->display_min + (info->display_max - info->display_min) * position / (POSITIONS - 1);
}

/* The frame for every position. `values` has room for one more value than the options, which comes last and
 * so counts. */
static bool make_views(hs_loop *loop, const hs_plugin *plugin, const sv_param_info *info,
                       sv_param_value *values, uint32_t count, uint32_t index, hs_view *views,
                       char captions[][96], hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < POSITIONS; i++) {
        char text[64] = "";
        values[count] = (sv_param_value){.id = info->id, .value = knob_value(info, i)};
        (void)plugin->instance->param_text(plugin->instance, info->id, values[count].value, text,
                                           sizeof text);
        (void)snprintf(captions[i], sizeof captions[i], "%.24s = %s", info->key, text);
        hs_loop_set_values(loop, values, count + 1);
        ok = hs_loop_view(loop, index, &views[i], err);
    }
    return ok;
}

static bool draw(const hs_view *views, char captions[][96], const sv_param_info *info, const char *title,
                 const char *path, hs_error *err) {
    hs_panel_item items[POSITIONS];
    for (uint32_t i = 0; i < POSITIONS; i++)
        items[i] = (hs_panel_item){
            .caption = captions[i],
            .image = {
                .data = views[i].result, .width = views[i].width, .height = views[i].height, .channels = 4}};
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
    if (!hs_cli_join(folder, "knob.png", path, sizeof path, err)) return false;
    sv_param_value *values = calloc(options->value_count + 1u, sizeof *values);
    if (!values)
        return hs_fail(err, HS_ERR_MEMORY, "plugin parameters: no memory for %u", options->value_count + 1u);
    if (options->value_count) memcpy(values, options->values, options->value_count * sizeof *values);
    hs_view views[POSITIONS] = {0};
    char captions[POSITIONS][96];
    const bool ok =
        make_views(loop, plugin, &info, values, options->value_count, index, views, captions, err) &&
        draw(views, captions, &info, title, path, err);
    hs_loop_set_values(loop, options->values, options->value_count);
    for (uint32_t i = 0; i < POSITIONS; i++) hs_view_free(&views[i]);
    free(values);
    return ok;
}
