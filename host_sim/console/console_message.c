/* SPDX-License-Identifier: MIT */
/* Messages of a page. The tables are what a message may have: a field that is missing, unknown or out of
 * range is an error that names it. */
#include "console/console.h"

#include "core/json_fields.h"
#include "scene/scene.h"

#include <jansson.h>
#include <stdint.h>
#include <string.h>

#define MAX_INDEX                 1000000u
#define MAX_DEPTH                 8                  /* of objects and arrays; a state has four */
#define MAX_SERIAL                9007199254740991.0 /* what a page can count to */
#define READ(object, fields, out) hs_json_read(object, fields, HS_COUNT(fields), out)

static const char *const view_names[HS_CONSOLE_VIEWS] = {"result", "full",  "truth", "depthmap",
                                                         "across", "along", "deep",  "other"};

const char *hs_console_view_name(hs_console_view view) {
    return view_names[view];
}

/* A member of an object whose table was read: it is there. */
static hs_json member(const hs_json *object, const char *key) {
    hs_json at = {0};
    (void)hs_json_member(object, key, &at);
    return at;
}

static const hs_json_field scene_fields[] = {
    FIELD(hs_console_source, scene, TEXT, 0, 0, true),
    FIELD(hs_console_source, size, UINT, 32, 256, true),
    FIELD(hs_console_source, volumes, UINT, 1, 16, true),
    OTHER("from", true),
};
static const hs_json_field file_fields[] = {
    FIELD(hs_console_source, folder, UINT, 0, 63, true),
    FIELD(hs_console_source, path, TEXT, 0, 0, true),
    OTHER("from", true),
};

/* A scene by the name of a built-in one: a path would lead anywhere. */
static bool is_built_in(const hs_json *at, const char *scene) {
    const char *name;
    for (int group = 0; group < HS_SCENES_REAL; group++)
        for (uint32_t i = 0; (name = hs_scene_of_group((hs_scene_group)group, i)) != NULL; i++)
            if (strcmp(name, scene) == 0) return true;
    return hs_json_fail(at, "is '%s', expected one that is built in", scene);
}

static bool read_source(const hs_json *object, hs_console_source *source) {
    const char *places[HS_FROM_COUNT];
    uint32_t place;
    hs_json at;
    for (int i = 0; i < HS_FROM_COUNT; i++) places[i] = hs_from_name((hs_from)i);
    if (hs_json_member(object, "scene", &at)) {
        if (!READ(object, scene_fields, source) || !is_built_in(&at, source->scene)) return false;
    } else {
        if (!READ(object, file_fields, source)) return false;
        at = member(object, "path");
        if (source->path[0] == '\0') return hs_json_fail(&at, "is empty");
    }
    at = member(object, "from");
    if (!hs_json_word(&at, places, HS_FROM_COUNT, &place)) return false;
    source->from = (hs_from)place;
    return true;
}

static const hs_json_field camera_fields[] = {
    FIELD(hs_console_state, yaw, DOUBLE, -360, 360, true),
    FIELD(hs_console_state, pitch, DOUBLE, -90, 90, true),
    FIELD(hs_console_state, roll, DOUBLE, -360, 360, true),
    FIELD(hs_console_state, zoom, DOUBLE, 0.25, 16, true),
};
static const hs_json_field play_fields[] = {
    NAMED("on", hs_console_state, playing, FLAG, 0, 0, true),
    FIELD(hs_console_state, speed, DOUBLE, 0.1, 100, true),
    FIELD(hs_console_state, index, UINT, 0, MAX_INDEX, true),
};
static const hs_json_field render_fields[] = {
    OTHER("look", true),
    FIELD(hs_dvr_settings, light, FLOAT, -180, 180, true),
    NAMED("t_low", hs_dvr_settings, threshold_low, FLOAT, 0, 1, true),
    NAMED("t_high", hs_dvr_settings, threshold_high, FLOAT, 0, 1, true),
    FIELD(hs_dvr_settings, ghost_width, FLOAT, 0, 256, true),
    FIELD(hs_dvr_settings, ghost_offset, FLOAT, -256, 256, true),
    FIELD(hs_dvr_settings, ghost_doubt, FLOAT, 0, (double)HS_DVR_MAX_DOUBT, true),
    FIELD(hs_dvr_settings, exposure, FLOAT, 0.1, 10, true),
};

static bool read_render(const hs_json *object, hs_dvr_settings *dvr) {
    const char *const looks[HS_LOOK_COUNT] = {hs_look_key(HS_LOOK_THESIS), hs_look_key(HS_LOOK_LIT)};
    uint32_t look;
    hs_dvr_defaults(dvr);
    if (!READ(object, render_fields, dvr)) return false;
    const hs_json at = member(object, "look");
    if (!hs_json_word(&at, looks, HS_LOOK_COUNT, &look)) return false;
    dvr->look = (hs_look)look;
    return hs_dvr_check_settings(dvr, object->file->err);
}

static bool read_value(const hs_json *values, const char *key, hs_console_lane *lane) {
    hs_console_value *out = &lane->values[lane->count];
    const hs_json at = member(values, key);
    const size_t length = strlen(key);
    if (lane->count == HS_CONSOLE_VALUES)
        return hs_json_fail(values, "has more than %d members", HS_CONSOLE_VALUES);
    if (length == 0 || length >= sizeof out->key ||
        strspn(key, "abcdefghijklmnopqrstuvwxyz0123456789_") != length)
        return hs_json_fail(values, "'%.60s' is no parameter's key", key);
    if (!json_is_number(at.value)) return hs_json_fail(&at, "is no number");
    memcpy(out->key, key, length + 1);
    out->value = json_number_value(at.value);
    lane->count++;
    return true;
}

static const hs_json_field lane_fields[] = {
    FIELD(hs_console_lane, plugin, UINT, 0, 255, true),
    OTHER("values", true),
};

static bool read_lane(const hs_json *object, hs_console_lane *lane) {
    const char *key;
    json_t *value;
    if (!READ(object, lane_fields, lane)) return false;
    const hs_json values = member(object, "values");
    if (!json_is_object(values.value)) return hs_json_fail(&values, "is no object");
    json_object_foreach(values.value, key, value) if (!read_value(&values, key, lane)) return false;
    lane->used = true;
    return true;
}

static bool read_lanes(const hs_json *array, hs_console_state *state) {
    hs_json one;
    if (!hs_json_is_array(array, 1, HS_CONSOLE_LANES)) return false;
    for (size_t i = 0; i < json_array_size(array->value); i++) {
        hs_json_element(array, i, &one);
        if (!read_lane(&one, &state->lane[i])) return false;
    }
    return true;
}

/* [x, y, z, radius, keep] each. */
static bool read_marks(const hs_json *array, hs_console_state *state) {
    hs_json one;
    if (!hs_json_is_array(array, 0, HS_MARKS_MAX)) return false;
    for (size_t i = 0; i < json_array_size(array->value); i++) {
        hs_mark *m = &state->marks[state->mark_count++];
        double n[5];
        hs_json_element(array, i, &one);
        if (!hs_json_numbers(&one, 5, -1e4, 1e4, n)) return false;
        memcpy(m->place, n, sizeof m->place);
        m->radius = n[3];
        m->keep = n[4] > 0.0;
        if (!(m->radius >= HS_MARK_RADIUS_LEAST && m->radius <= HS_MARK_RADIUS_MOST))
            return hs_json_fail(&one, "has a radius of %g mm", m->radius);
    }
    return true;
}

/* [x, y, z, x, y, z], or [] for all of the volume. */
static bool read_box(const hs_json *array, hs_crop *crop) {
    double ends[6] = {0};
    crop->used = !json_is_array(array->value) || json_array_size(array->value) > 0;
    if (crop->used && !hs_json_numbers(array, 6, -1e4, 1e4, ends)) return false;
    memcpy(crop->low, ends, sizeof crop->low);
    memcpy(crop->high, ends + 3, sizeof crop->high);
    return true;
}

static bool read_views(const hs_json *array, uint32_t *views) {
    hs_json one;
    uint32_t view;
    if (!hs_json_is_array(array, 0, HS_CONSOLE_VIEWS)) return false;
    for (size_t i = 0; i < json_array_size(array->value); i++) {
        hs_json_element(array, i, &one);
        if (!hs_json_word(&one, view_names, HS_CONSOLE_VIEWS, &view)) return false;
        *views |= 1u << view;
    }
    return true;
}

static const hs_json_field state_fields[] = {
    FIELD(hs_console_state, serial, WHOLE, 0, MAX_SERIAL, true),
    OTHER("source", true),
    OTHER("camera", true),
    OTHER("views", true),
    FIELD(hs_console_state, picture, UINT, 16, HS_CONSOLE_PICTURE, true),
    FIELD(hs_console_state, draft, UINT, 16, HS_CONSOLE_PICTURE, true),
    FIELD(hs_console_state, hurried, FLAG, 0, 0, true),
    OTHER("play", true),
    FIELD(hs_console_state, cross, DOUBLE, 0, 1, true),
    FIELD(hs_console_state, thick, DOUBLE, 0, HS_CONSOLE_THICK, true),
    OTHER("render", true),
    OTHER("lanes", true),
    OTHER("marks", true),
    OTHER("box", true),
};

static bool read_state(const hs_json *root, hs_console_state *s) {
    if (!hs_json_read_typed(root, state_fields, HS_COUNT(state_fields), s)) return false;
    const hs_json source = member(root, "source"), camera = member(root, "camera"),
                  views = member(root, "views"), play = member(root, "play"), render = member(root, "render"),
                  lanes = member(root, "lanes"), marks = member(root, "marks"), box = member(root, "box");
    return read_source(&source, &s->source) && READ(&camera, camera_fields, s) &&
           read_views(&views, &s->views) && READ(&play, play_fields, s) && read_render(&render, &s->dvr) &&
           read_lanes(&lanes, s) && read_marks(&marks, s) && read_box(&box, &s->crop);
}

static const hs_json_field seen_fields[] = {
    NAMED("frame", hs_console_message, seen, WHOLE, 0, MAX_SERIAL, true),
};
/* Of deeds: what all have; a snapshot's view behind it; and the rest of a mark. */
static const hs_json_field deed_fields[] = {
    OTHER("what", true),
    OTHER("view", true),
    FIELD(hs_console_message, at, DOUBLE, 0, 1, true),
    NAMED("radius", hs_console_message, mark.radius, DOUBLE, HS_MARK_RADIUS_LEAST, HS_MARK_RADIUS_MOST, true),
    NAMED("keep", hs_console_message, mark.keep, FLAG, 0, 0, true),
};

static bool read_deed(const hs_json *root, hs_console_message *out) {
    static const char *const deeds[] = {"snapshot", "write", "mark"};
    static const size_t counts[] = {2, 1, HS_COUNT(deed_fields)};
    uint32_t what, view = 0;
    hs_json at;
    if (!hs_json_member(root, "what", &at)) return hs_json_fail(root, "has no field 'what'");
    if (!hs_json_word(&at, deeds, 3, &what) || !hs_json_read_typed(root, deed_fields, counts[what], out))
        return false;
    out->deed = (hs_console_deed)what;
    if (!hs_json_member(root, "view", &at)) return true;
    const bool ok = hs_json_word(&at, view_names, HS_CONSOLE_VIEWS, &view);
    out->view = (hs_console_view)view;
    return ok;
}

static bool read_message(hs_json_file *file, json_t *value, hs_console_message *out) {
    static const char *const types[] = {"state", "seen", "do"};
    const hs_json root = {.file = file, .value = value};
    const char *name;
    uint32_t type;
    hs_json at;
    if (!hs_json_type(&root, &at, &name) || !hs_json_word(&at, types, 3, &type)) return false;
    file->whole = name;
    out->says = (hs_console_says)type;
    if (out->says == HS_CONSOLE_SAYS_STATE) return read_state(&root, &out->state);
    if (out->says == HS_CONSOLE_SAYS_DO) return read_deed(&root, out);
    return hs_json_read_typed(&root, seen_fields, HS_COUNT(seen_fields), out);
}

/* The parser calls itself for every level, thousands deep if it is let, and a server's threads have little
 * stack. */
static bool is_too_deep(const char *text, size_t bytes) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < bytes; i++) {
        if (quoted) {
            if (text[i] == '\\')
                i++;
            else if (text[i] == '"')
                quoted = false;
        } else if (text[i] == '"') {
            quoted = true;
        } else if (text[i] == '[' || text[i] == '{') {
            if (++depth > MAX_DEPTH) return true;
        } else if (text[i] == ']' || text[i] == '}') {
            depth--;
        }
    }
    return false;
}

bool hs_console_message_read(const char *text, size_t bytes, hs_console_message *out, hs_error *err) {
    *out = (hs_console_message){0};
    if (bytes > HS_CONSOLE_MAX_MESSAGE)
        return hs_fail(err, HS_ERR_INPUT, "message: %zu bytes, expected at most %u", bytes,
                       HS_CONSOLE_MAX_MESSAGE);
    if (is_too_deep(text, bytes))
        return hs_fail(err, HS_ERR_INPUT, "message: more than %d levels deep", MAX_DEPTH);
    json_error_t at;
    json_t *root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &at);
    if (!root) return hs_fail(err, HS_ERR_INPUT, "message: no JSON: %s (byte %d)", at.text, at.position);
    hs_json_file file = {"message", "all of it", err};
    const bool ok = read_message(&file, root, out);
    json_decref(root);
    return ok;
}
