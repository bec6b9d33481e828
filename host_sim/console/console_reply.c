/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "core/json_text.h"
#include "plugin/loader_param.h"
#include "scene/scene.h"
#include "scene/scene_spec.h"
#include "show/loop_pictures.h"
#include "sv_version.h"
#include "volume/fan_fit.h"

#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

static void put(json_t *object, const char *key, json_t *value) {
    (void)json_object_set_new(object, key, value);
}

static char *dump(json_t *root) {
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    return text;
}

char *hs_console_reply_text(const char *type, const char *text) {
    json_t *root = json_object();
    put(root, "type", json_string(type));
    put(root, "text", hs_json_text(text));
    return dump(root);
}

/* -------------------------------------------------------------------------------------------- hello -- */

/* The title alone: opening a scene also finds places for what it holds, which takes a while. */
static json_t *scene_part(const char *name) {
    hs_error ignored = {0};
    char path[PATH_MAX + 256];
    char *text = hs_scene_text(name, path, sizeof path, &ignored);
    hs_scene_spec *spec = text ? calloc(1, sizeof *spec) : NULL;
    json_t *one = NULL;
    if (spec && hs_scene_read_text(path, text, spec, &ignored)) {
        one = json_object();
        put(one, "name", json_string(name));
        put(one, "title", hs_json_text(spec->title));
    }
    free(spec);
    free(text);
    return one;
}

static json_t *scenes(void) {
    json_t *list = json_array();
    const char *name;
    for (int group = 0; group < HS_SCENES_REAL; group++)
        for (uint32_t i = 0; (name = hs_scene_of_group((hs_scene_group)group, i)) != NULL; i++) {
            json_t *one = scene_part(name);
            if (one) (void)json_array_append_new(list, one);
        }
    return list;
}

static bool add_file(void *context, uint32_t folder, const char *path) {
    json_t *name = json_string(path);
    if (!name) return true; /* a name that is no UTF-8 could not come back */
    return json_array_append_new(context, json_pack("{s:i, s:o}", "folder", (int)folder, "path", name)) == 0;
}

static json_t *plugins(const hs_console_offers *offers) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < offers->count; i++) {
        const hs_console_offer *o = &offers->offer[i];
        json_t *one = json_object();
        put(one, "id", hs_json_text(o->id));
        put(one, "name", hs_json_text(o->name));
        put(one, "version", hs_json_text(o->version));
        put(one, "failure", hs_json_text(o->failure.text));
        put(one, "ours", json_boolean(o->ours));
        (void)json_array_append_new(list, one);
    }
    return list;
}

char *hs_console_reply_hello(const hs_console_offers *offers, const hs_console_files *files) {
    json_t *root = json_object(), *list = json_array(), *places = json_array();
    hs_dvr_settings usual;
    hs_dvr_defaults(&usual);
    hs_console_files_list(files, add_file, list);
    for (int i = 0; i < HS_FROM_COUNT; i++)
        (void)json_array_append_new(places, json_string(hs_from_name((hs_from)i)));
    put(root, "type", json_string("hello"));
    put(root, "version", json_string(SV_VERSION));
    put(root, "scenes", scenes());
    put(root, "files", list);
    put(root, "places", places);
    put(root, "plugins", plugins(offers));
    put(root, "drop",
        json_pack("{s:i, s:I, s:b}", "folder", (int)files->count - 1, "most",
                  (json_int_t)(files->drops ? HS_CONSOLE_DROP_BYTES : 0), "reader", files->reader != 0));
    put(root, "marks", json_pack("{s:i, s:f}", "most", HS_MARKS_MAX, "radius", HS_MARK_RADIUS));
    put(root, "render",
        json_pack("{s:s, s:[f, f], s:f, s:f, s:f, s:f, s:f, s:f}", "look", hs_look_key(HS_LOOK_LIT), "light",
                  (double)usual.light[0], (double)usual.light[1], "t_low", (double)usual.threshold_low,
                  "t_high", (double)usual.threshold_high, "ghost_width", (double)usual.ghost_width,
                  "ghost_offset", (double)usual.ghost_offset, "ghost_doubt", (double)usual.ghost_doubt,
                  "exposure", 1.0));
    return dump(root);
}

/* ------------------------------------------------------------------------------------------- plugin -- */

static json_t *enum_names(const hs_plugin *plugin, const sv_param_info *info) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < hs_plugin_enum_count(info); i++) {
        char name[HS_ENUM_NAME];
        double value;
        if (!hs_plugin_enum_at(plugin, info, i, &value, name, sizeof name)) continue;
        json_t *one = json_object();
        put(one, "value", json_real(value));
        put(one, "name", hs_json_text(name));
        (void)json_array_append_new(list, one);
    }
    return list;
}

/* Bits of depends_values, as their numbers: a page counts to 2^53 only. */
static json_t *bit_numbers(uint64_t bits) {
    json_t *list = json_array();
    for (int n = 0; n < 64; n++)
        if (bits >> n & 1u) (void)json_array_append_new(list, json_integer(n));
    return list;
}

static json_t *param(const hs_plugin *plugin, const sv_param_info *i) {
    static const char *const types[] = {"float", "int", "bool", "enum"};
    json_t *one = json_object();
    put(one, "id", json_integer(i->id));
    put(one, "type", json_string(i->type <= SV_PARAM_ENUM ? types[i->type] : "float"));
    put(one, "key", hs_json_text(i->key));
    put(one, "label", hs_json_text(i->label));
    put(one, "unit", hs_json_text(i->unit));
    put(one, "help", hs_json_text(i->help));
    put(one, "group", hs_json_text(i->group));
    put(one, "primary", json_boolean(i->flags & SV_PARAM_PRIMARY));
    put(one, "expert", json_boolean(i->flags & SV_PARAM_EXPERT));
    put(one, "reactivate", json_boolean(i->flags & SV_PARAM_REACTIVATE));
    put(one, "adjust", json_boolean(i->flags & SV_PARAM_ADJUST));
    put(one, "min", json_real(i->min_value));
    put(one, "max", json_real(i->max_value));
    put(one, "low", json_real(i->display_min));
    put(one, "high", json_real(i->display_max));
    put(one, "default", json_real(i->default_value));
    put(one, "step", json_real(i->step));
    put(one, "depends_on", json_integer(i->depends_on));
    put(one, "depends_values", bit_numbers(i->depends_values));
    if (i->type == SV_PARAM_ENUM) put(one, "names", enum_names(plugin, i));
    return one;
}

char *hs_console_reply_plugin(const hs_console_stage *stage, uint32_t lane) {
    const hs_lane *l = &stage->lane[lane];
    json_t *root = json_object(), *params = json_array();
    put(root, "type", json_string("plugin"));
    put(root, "lane", json_integer(lane));
    put(root, "plugin", json_integer(l->offer ? l->offer - stage->offers->offer : 0));
    put(root, "failure", hs_json_text(l->failure.text));
    if (l->has_plugin) { /* a build may have changed them */
        put(root, "name", hs_json_text(l->plugin.instance->descriptor->name));
        put(root, "version", hs_json_text(l->plugin.instance->descriptor->version));
    }
    const uint32_t count = l->has_plugin ? hs_plugin_param_count(&l->plugin) : 0;
    for (uint32_t i = 0; i < count; i++) {
        sv_param_info info = {.size = sizeof info};
        if (l->plugin.instance->param_info(l->plugin.instance, i, &info) != SV_OK || !info.key) continue;
        (void)json_array_append_new(params, param(&l->plugin, &info));
    }
    put(root, "params", params);
    return dump(root);
}

/* -------------------------------------------------------------------------------------------- frame -- */

char *hs_console_reply_marked(const hs_mark *mark) {
    if (!mark) return dump(json_pack("{s:s, s:n}", "type", "marked", "mark"));
    return dump(json_pack("{s:s, s:[f, f, f, f, i]}", "type", "marked", "mark", mark->place[0],
                          mark->place[1], mark->place[2], mark->radius, (int)mark->keep));
}

/* The marks as the pictures show them: 0 .. 1 right and down, the radius likewise, 1: keep. */
static json_t *marks_part(const hs_console_stage *stage) {
    json_t *list = json_array();
    hs_camera window;
    float share;
    hs_loop_window(stage->lane[0].loop, stage->index, &window, &share);
    for (uint32_t i = 0; i < stage->state.mark_count; i++) {
        double seen[3];
        const hs_mark *m = &stage->state.marks[i];
        hs_marks_seen(hs_source_shape(&stage->source), &window, m->place, seen);
        (void)json_array_append_new(list, json_pack("[f, f, f, i]", seen[0] / window.extent + 0.5,
                                                    seen[1] / window.extent + 0.5, m->radius / window.extent,
                                                    (int)m->keep));
    }
    return list;
}

/* Why there is no surface or a doubtful one, and the setting that takes it all the same. */
static void put_reason(json_t *one, const hs_lane *lane) {
    sv_confidence_report r;
    sv_param_info info = {.size = sizeof info};
    char words[HS_REASON_BYTES];
    if (!hs_lane_reason(lane, &r, words)) return;
    put(one, "why", hs_json_text(words));
    const sv_plugin *instance = lane->plugin.instance;
    const uint32_t params = hs_plugin_param_count(&lane->plugin);
    for (uint32_t i = 0; r.try_id != 0 && i < params; i++)
        if (instance->param_info(instance, i, &info) == SV_OK && info.key && info.id == r.try_id)
            put(one, "try",
                json_pack("{s:o, s:f}", "key", hs_json_text(info.key), "value", (double)r.try_value));
}

static json_t *lane_part(const hs_console_stage *stage, uint32_t i) {
    const hs_lane *l = &stage->lane[i];
    const sv_points_report *p = &l->frame.points;
    char words[1200];
    const char *note = hs_frame_note(&l->frame, hs_lane_error(l)->text, words, sizeof words);
    json_t *one = json_object();
    char *line = stage->state.hurried ? NULL : hs_console_line(stage, i);
    put(one, "outcome", json_string(hs_status_name(l->frame.outcome)));
    put(one, "words", hs_json_text(note ? note : "Clipped."));
    put(one, "clipped", json_boolean(l->frame.clipped));
    put(one, "doubtful", json_boolean(l->frame.clipped && l->frame.doubt.wanted > 0.0f));
    put(one, "failed", json_boolean(hs_lane_error(l)->code != HS_OK));
    put(one, "adjusted", json_boolean(l->was_adjusted));
    put(one, "activation_ms", json_real(l->activation_ms));
    put(one, "activations", json_integer(l->activations));
    put(one, "restarts", json_integer(l->has_plugin ? hs_guarded_restarts(&l->plugin) : 0));
    put(one, "rays", json_integer(l->frame.stats.rays));
    put(one, "points", json_integer(l->frame.stats.points));
    put(one, "unfilled", json_integer(l->frame.stats.unfilled));
    if (p->size > 0) {
        put(one, "t_b", json_real((double)p->bone_threshold));
        put(one, "volume_max", json_real((double)p->volume_max));
    }
    if (!stage->state.hurried) put_reason(one, l);
    if (line) put(one, "line", hs_json_text(line));
    free(line);
    return one;
}

/* Where the probe is, seen from the picture's middle, and where the picture's axes run in the patient, if the
 * file says so. */
static void put_directions(json_t *source, const hs_camera *camera, const hs_volume *volume) {
    static const uint32_t voxels[3] = {1, 1, 1};
    char words[160];
    hs_told told;
    double axes[9], middle[3];
    json_t *list = json_array();
    for (int i = 0; i < 9; i++) (void)json_array_append_new(list, json_real(camera->rotation[i]));
    hs_marks_place(volume, camera, (const double[3]){0.0, 0.0, 0.0}, middle);
    put(source, "axes", list); /* of the picture, in the volume: the camera's rotation */
    put(source, "middle", json_pack("[f, f, f]", middle[0], middle[1], middle[2]));
    hs_camera_tell(camera, volume, voxels, &told);
    if (hs_probe_is_known(volume))
        put(source, "probe",
            json_pack("[f, f, f]", (double)told.side[0], (double)told.side[1], (double)told.side[2]));
    hs_course_words(volume, words, sizeof words);
    put(source, "beams", json_string(words));
    hs_course_question(volume, words, sizeof words);
    if (words[0]) put(source, "question", json_string(words));
    if (!hs_camera_in_patient(camera, volume, axes)) return;
    put(source, "patient",
        json_pack("[[f, f, f], [f, f, f], [f, f, f]]", axes[0], axes[3], axes[6], axes[1], axes[4], axes[7],
                  axes[2], axes[5], axes[8]));
}

static json_t *source_part(const hs_console_stage *stage) {
    const hs_volume *v = hs_source_shape(&stage->source);
    const hs_slab_layout *l = hs_loop_layout(stage->lane[0].loop);
    char doubt[HS_DOUBT_BYTES];
    hs_camera window;
    float share;
    hs_loop_window(stage->lane[0].loop, stage->index, &window, &share);
    json_t *one =
        json_pack("{s:o, s:o, s:i, s:[i, i, i], s:[i, i, i], s:f, s:[f, f], s:b, s:b, s:f}", "name",
                  hs_json_text(v->name), "title", hs_json_text(stage->source.title), "volumes",
                  (int)stage->source.count, "voxels", (int)v->nx, (int)v->ny, (int)v->nz, "slabs",
                  (int)l->width, (int)l->height, (int)l->slices, "window_mm", window.extent, "depth_mm",
                  stage->depth_mm[0], stage->depth_mm[1], "truth", stage->truth != NULL, "truth_cut",
                  hs_truth_shows_cut(stage->lane[0].loop, stage->screen_dvr.look, stage->index), "opened_ms",
                  stage->source_ms);
    put(one, "voxel_mm", json_real(fmax(fmax(v->spacing[0], v->spacing[1]), v->spacing[2])));
    put_directions(one, &window, v);
    put(one, "mm", json_boolean(!v->spacing_unsaid));
    if (hs_volume_doubt(v, doubt) || hs_pose_doubt(&v->pose, doubt)) put(one, "doubt", json_string(doubt));
    return one;
}

/* The part of the page's state that says whose pictures these are, in the page's own words. */
static json_t *made_for(const hs_console_stage *stage) {
    const hs_console_source *s = &stage->state.source;
    json_t *root = json_object(), *source = json_object(), *plugins = json_array();
    if (s->scene[0] != '\0') {
        put(source, "scene", json_string(s->scene));
        put(source, "size", json_integer(s->size));
        put(source, "volumes", json_integer(s->volumes));
    } else {
        put(source, "folder", json_integer(s->folder));
        put(source, "path", json_string(s->path));
    }
    put(source, "from", json_string(hs_from_name(s->from)));
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++)
        if (stage->lane[i].offer)
            (void)json_array_append_new(plugins, json_integer(stage->lane[i].offer - stage->offers->offer));
    put(root, "source", source);
    put(root, "plugins", plugins);
    return root;
}

char *hs_console_reply_frame(const hs_console_stage *stage, const hs_console_shown *shown) {
    json_t *root = json_object(), *lanes = json_array();
    double stage_ms[HS_STAGE_COUNT] = {0};
    for (uint32_t i = 0; i < HS_CONSOLE_LANES; i++) {
        if (!stage->lane[i].loop) continue;
        for (int s = 0; s < HS_STAGE_COUNT; s++) stage_ms[s] += stage->lane[i].ms[s];
        (void)json_array_append_new(lanes, lane_part(stage, i));
    }
    put(root, "type", json_string("frame"));
    put(root, "frame", json_integer((json_int_t)shown->frame));
    put(root, "serial", json_integer((json_int_t)stage->state.serial));
    put(root, "pictures", json_integer(shown->pictures));
    put(root, "index", json_integer(stage->index % stage->source.count));
    put(root, "draft", json_boolean(stage->state.hurried));
    put(root, "of", made_for(stage));
    put(root, "source", source_part(stage));
    put(root, "marks", marks_part(stage));
    put(root, "ms",
        json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "upload", stage_ms[HS_STAGE_UPLOAD], "convert",
                  stage_ms[HS_STAGE_CONVERT], "plugin", stage_ms[HS_STAGE_PLUGIN], "draw", shown->draw_ms,
                  "encode", shown->encode_ms, "all", shown->all_ms));
    put(root, "lanes", lanes);
    return dump(root);
}

char *hs_console_reply_skipped(uint64_t frame) {
    json_t *root = json_object();
    put(root, "type", json_string("skipped"));
    put(root, "frame", json_integer((json_int_t)frame));
    return dump(root);
}

char *hs_console_reply_written(const hs_console_stage *stage, const char *folder,
                               const hs_result_report *report) {
    json_t *root = json_object(), *names = json_array();
    for (uint32_t i = 0; i < HS_RESULT_COUNT; i++)
        if (report->what >> i & 1u) (void)json_array_append_new(names, json_string(hs_result_name(i)));
    put(root, "type", json_string("written"));
    put(root, "of", made_for(stage));
    put(root, "folder", hs_json_text(folder));
    put(root, "names", names);
    return dump(root);
}
