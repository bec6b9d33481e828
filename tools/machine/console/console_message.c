/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "scene/scene.h"

#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- fields -- */
/* Fields of a page's message, checked one by one: a field that is missing, unknown or out of range is an
 * error that names it. */

static bool fail(const char *key, const char *what, hs_error *err) {
    return hs_fail(err, HS_ERR_INPUT, "message: %s: %s", key, what);
}

/* An object that has these keys and no others; `keys` ends with NULL. `name` is what messages call the
 * object. */
static bool hs_console_object(const json_t *object, const char *name, const char *const *keys,
                              hs_error *err) {
    if (!json_is_object(object)) return fail(name, "expected an object", err);
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        bool known = false;
        for (uint32_t i = 0; keys[i] && !known; i++) known = strcmp(key, keys[i]) == 0;
        if (!known) return hs_fail(err, HS_ERR_INPUT, "message: %s: '%.60s' is no field of it", name, key);
    }
    for (uint32_t i = 0; keys[i]; i++)
        if (!json_object_get(object, keys[i]))
            return hs_fail(err, HS_ERR_INPUT, "message: %s: '%s' is missing", name, keys[i]);
    return true;
}

static bool in_range(const json_t *value, const char *key, double low, double high, double *out,
                     hs_error *err) {
    if (!json_is_number(value)) return fail(key, "expected a number", err);
    *out = json_number_value(value);
    return (isfinite(*out) && *out >= low && *out <= high) ||
           hs_fail(err, HS_ERR_INPUT, "message: %s: %g is outside %g .. %g", key, *out, low, high);
}

/* Member `key`, of the type and in low .. high. */
static bool hs_console_number(const json_t *object, const char *key, double low, double high, double *out,
                              hs_error *err) {
    return in_range(json_object_get(object, key), key, low, high, out, err);
}

static bool hs_console_float(const json_t *object, const char *key, double low, double high, float *out,
                             hs_error *err) {
    double value = 0.0;
    if (!hs_console_number(object, key, low, high, &value, err)) return false;
    *out = (float)value;
    return true;
}

static bool hs_console_whole(const json_t *object, const char *key, uint64_t low, uint64_t high,
                             uint64_t *out, hs_error *err) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_integer(value)) return fail(key, "expected a whole number", err);
    const json_int_t number = json_integer_value(value);
    if (number < 0 || (uint64_t)number < low || (uint64_t)number > high)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: %lld is outside %llu .. %llu", key, (long long)number,
                       (unsigned long long)low, (unsigned long long)high);
    *out = (uint64_t)number;
    return true;
}

static bool hs_console_count(const json_t *object, const char *key, uint32_t low, uint32_t high,
                             uint32_t *out, hs_error *err) {
    uint64_t value = 0;
    if (!hs_console_whole(object, key, low, high, &value, err)) return false;
    *out = (uint32_t)value;
    return true;
}

static bool hs_console_flag(const json_t *object, const char *key, bool *out, hs_error *err) {
    const json_t *value = json_object_get(object, key);
    *out = json_is_true(value);
    return json_is_boolean(value) || fail(key, "expected true or false", err);
}

/* Text of fewer than `bytes` bytes without control characters, copied; and one of `count` words, as its
 * index. */
static bool hs_console_text(const json_t *object, const char *key, char *out, size_t bytes, hs_error *err) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_string(value)) return fail(key, "expected a text", err);
    const char *text = json_string_value(value);
    const size_t length = json_string_length(value);
    if (length >= bytes)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: %zu bytes, expected at most %zu", key, length,
                       bytes - 1);
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] < 0x20 || text[i] == 0x7f)
            return fail(key, "has a control character", err);
    memcpy(out, text, length + 1);
    return true;
}

static bool hs_console_word(const json_t *object, const char *key, const char *const *words, uint32_t count,
                            uint32_t *out, hs_error *err) {
    char word[64];
    if (!hs_console_text(object, key, word, sizeof word, err)) return false;
    for (*out = 0; *out < count; ++*out)
        if (strcmp(word, words[*out]) == 0) return true;
    return hs_fail(err, HS_ERR_INPUT, "message: %s: '%s' is not known", key, word);
}

/* An array of `count` numbers in low .. high; and the same as a member. */
static bool numbers_of(const json_t *array, const char *key, uint32_t count, double low, double high,
                       double *out, hs_error *err) {
    if (!json_is_array(array) || json_array_size(array) != count)
        return hs_fail(err, HS_ERR_INPUT, "message: %s: expected %u numbers", key, count);
    for (uint32_t i = 0; i < count; i++)
        if (!in_range(json_array_get(array, i), key, low, high, &out[i], err)) return false;
    return true;
}

static bool hs_console_numbers(const json_t *object, const char *key, uint32_t count, double low, double high,
                               double *out, hs_error *err) {
    return numbers_of(json_object_get(object, key), key, count, low, high, out, err);
}

/* -------------------------------------------------------------------------------------------- messages -- */

#define MAX_INDEX  1000000u
#define MAX_DEPTH  8                          /* of objects and arrays; a state has four */
#define MAX_SERIAL UINT64_C(9007199254740991) /* what a page can count to */

static const char *const view_names[HS_CONSOLE_VIEWS] = {"result", "full",  "truth", "depthmap",
                                                         "across", "along", "deep",  "other"};

const char *hs_console_view_name(hs_console_view view) {
    return view_names[view];
}

/* A scene by the name of a built-in one: a path would lead anywhere. */
static bool read_scene(const json_t *object, hs_console_source *source, hs_error *err) {
    static const char *const keys[] = {"scene", "size", "volumes", "from", NULL};
    const char *name;
    if (!hs_console_object(object, "source", keys, err) ||
        !hs_console_text(object, "scene", source->scene, sizeof source->scene, err) ||
        !hs_console_count(object, "size", 32, 256, &source->size, err) ||
        !hs_console_count(object, "volumes", 1, 16, &source->volumes, err))
        return false;
    for (int group = 0; group < HS_SCENES_REAL; group++)
        for (uint32_t i = 0; (name = hs_scene_of_group((hs_scene_group)group, i)) != NULL; i++)
            if (strcmp(name, source->scene) == 0) return true;
    return hs_fail(err, HS_ERR_INPUT, "message: scene: '%s' is none that is built in", source->scene);
}

static bool read_file(const json_t *object, hs_console_source *source, hs_error *err) {
    static const char *const keys[] = {"folder", "path", "from", NULL};
    return hs_console_object(object, "source", keys, err) &&
           hs_console_count(object, "folder", 0, 63, &source->folder, err) &&
           hs_console_text(object, "path", source->path, sizeof source->path, err) &&
           (source->path[0] != '\0' || hs_fail(err, HS_ERR_INPUT, "message: path: is empty"));
}

static bool read_source(const json_t *object, hs_console_source *source, hs_error *err) {
    const char *places[HS_FROM_COUNT];
    uint32_t from;
    for (int i = 0; i < HS_FROM_COUNT; i++) places[i] = hs_from_name((hs_from)i);
    const bool ok =
        json_object_get(object, "scene") ? read_scene(object, source, err) : read_file(object, source, err);
    if (!ok || !hs_console_word(object, "from", places, HS_FROM_COUNT, &from, err)) return false;
    source->from = (hs_from)from;
    return true;
}

static bool read_camera(const json_t *object, hs_console_state *state, hs_error *err) {
    static const char *const keys[] = {"yaw", "pitch", "roll", "zoom", NULL};
    return hs_console_object(object, "camera", keys, err) &&
           hs_console_number(object, "yaw", -360, 360, &state->yaw, err) &&
           hs_console_number(object, "pitch", -90, 90, &state->pitch, err) &&
           hs_console_number(object, "roll", -360, 360, &state->roll, err) &&
           hs_console_number(object, "zoom", 0.25, 16, &state->zoom, err);
}

static bool read_play(const json_t *object, hs_console_state *state, hs_error *err) {
    static const char *const keys[] = {"on", "speed", "index", NULL};
    return hs_console_object(object, "play", keys, err) &&
           hs_console_flag(object, "on", &state->playing, err) &&
           hs_console_number(object, "speed", 0.1, 100, &state->speed, err) &&
           hs_console_count(object, "index", 0, MAX_INDEX, &state->index, err);
}

static bool read_render(const json_t *object, hs_dvr_settings *dvr, hs_error *err) {
    static const char *const keys[] = {"look",         "light",       "t_low",    "t_high", "ghost_width",
                                       "ghost_offset", "ghost_doubt", "exposure", NULL};
    const char *const looks[HS_LOOK_COUNT] = {hs_look_key(HS_LOOK_THESIS), hs_look_key(HS_LOOK_LIT)};
    double light[2];
    uint32_t look;
    hs_dvr_defaults(dvr);
    if (!hs_console_object(object, "render", keys, err) ||
        !hs_console_word(object, "look", looks, HS_LOOK_COUNT, &look, err) ||
        !hs_console_numbers(object, "light", 2, -180, 180, light, err) ||
        !hs_console_float(object, "t_low", 0, 1, &dvr->threshold_low, err) ||
        !hs_console_float(object, "t_high", 0, 1, &dvr->threshold_high, err) ||
        !hs_console_float(object, "ghost_width", 0, 256, &dvr->ghost_width, err) ||
        !hs_console_float(object, "ghost_offset", -256, 256, &dvr->ghost_offset, err) ||
        !hs_console_float(object, "ghost_doubt", 0, (double)HS_DVR_MAX_DOUBT, &dvr->ghost_doubt, err) ||
        !hs_console_float(object, "exposure", 0.1, 10, &dvr->exposure, err))
        return false;
    dvr->look = (hs_look)look;
    for (int i = 0; i < 2; i++) dvr->light[i] = (float)light[i];
    return hs_dvr_check_settings(dvr, err);
}

static bool read_value(const char *key, const json_t *value, hs_console_lane *lane, hs_error *err) {
    hs_console_value *out = &lane->values[lane->count];
    const size_t length = strlen(key);
    if (lane->count == HS_CONSOLE_VALUES)
        return hs_fail(err, HS_ERR_INPUT, "message: values: more than %d", HS_CONSOLE_VALUES);
    if (length == 0 || length >= sizeof out->key ||
        strspn(key, "abcdefghijklmnopqrstuvwxyz0123456789_") != length)
        return hs_fail(err, HS_ERR_INPUT, "message: values: '%.60s' is no parameter's key", key);
    if (!json_is_number(value))
        return hs_fail(err, HS_ERR_INPUT, "message: values: %s: expected a number", key);
    memcpy(out->key, key, length + 1);
    out->value = json_number_value(value);
    lane->count++;
    return true;
}

static bool read_lane(json_t *object, hs_console_lane *lane, hs_error *err) {
    static const char *const keys[] = {"plugin", "values", NULL};
    const char *key;
    json_t *value;
    if (!hs_console_object(object, "lanes", keys, err) ||
        !hs_console_count(object, "plugin", 0, 255, &lane->plugin, err))
        return false;
    json_t *values = json_object_get(object, "values");
    if (!json_is_object(values)) return hs_fail(err, HS_ERR_INPUT, "message: values: expected an object");
    json_object_foreach(values, key, value) if (!read_value(key, value, lane, err)) return false;
    lane->used = true;
    return true;
}

static bool read_lanes(const json_t *array, hs_console_state *state, hs_error *err) {
    const size_t count = json_array_size(array);
    if (!json_is_array(array) || count < 1 || count > HS_CONSOLE_LANES)
        return hs_fail(err, HS_ERR_INPUT, "message: lanes: expected 1 .. %d", HS_CONSOLE_LANES);
    for (size_t i = 0; i < count; i++)
        if (!read_lane(json_array_get(array, i), &state->lane[i], err)) return false;
    return true;
}

/* [x, y, z, radius, keep] each. */
static bool read_marks(const json_t *array, hs_console_state *state, hs_error *err) {
    if (!json_is_array(array) || json_array_size(array) > HS_MARKS_MAX)
        return hs_fail(err, HS_ERR_INPUT, "message: marks: expected at most %d", HS_MARKS_MAX);
    for (size_t i = 0; i < json_array_size(array); i++) {
        hs_mark *m = &state->marks[state->mark_count++];
        double n[5];
        if (!numbers_of(json_array_get(array, i), "marks", 5, -1e4, 1e4, n, err)) return false;
        memcpy(m->place, n, sizeof m->place);
        m->radius = n[3];
        m->keep = n[4] > 0.0;
        if (!(m->radius >= HS_MARK_RADIUS_LEAST && m->radius <= HS_MARK_RADIUS_MOST))
            return hs_fail(err, HS_ERR_INPUT, "message: marks: a radius of %g mm", m->radius);
    }
    return true;
}

/* [x, y, z, x, y, z], or [] for all of the volume. */
static bool read_box(const json_t *array, hs_crop *crop, hs_error *err) {
    double ends[6] = {0};
    crop->used = !json_is_array(array) || json_array_size(array) > 0;
    if (crop->used && !numbers_of(array, "box", 6, -1e4, 1e4, ends, err)) return false;
    memcpy(crop->low, ends, sizeof crop->low);
    memcpy(crop->high, ends + 3, sizeof crop->high);
    return true;
}

static bool read_views(const json_t *array, uint32_t *views, hs_error *err) {
    if (!json_is_array(array) || json_array_size(array) > HS_CONSOLE_VIEWS)
        return hs_fail(err, HS_ERR_INPUT, "message: views: expected at most %d", HS_CONSOLE_VIEWS);
    for (size_t i = 0; i < json_array_size(array); i++) {
        const char *name = json_string_value(json_array_get(array, i));
        uint32_t v = 0;
        while (name && v < HS_CONSOLE_VIEWS && strcmp(name, view_names[v]) != 0) v++;
        if (!name || v == HS_CONSOLE_VIEWS)
            return hs_fail(err, HS_ERR_INPUT, "message: views: '%.60s' is none", name ? name : "(no text)");
        *views |= 1u << v;
    }
    return true;
}

static bool read_state(const json_t *root, hs_console_state *s, hs_error *err) {
    static const char *const keys[] = {"type",    "serial", "source",  "camera", "views",
                                       "picture", "draft",  "hurried", "play",   "cross",
                                       "render",  "lanes",  "marks",   "box",    NULL};
    return hs_console_object(root, "state", keys, err) &&
           hs_console_whole(root, "serial", 0, MAX_SERIAL, &s->serial, err) &&
           read_source(json_object_get(root, "source"), &s->source, err) &&
           read_camera(json_object_get(root, "camera"), s, err) &&
           read_views(json_object_get(root, "views"), &s->views, err) &&
           hs_console_count(root, "picture", 16, HS_CONSOLE_PICTURE, &s->picture, err) &&
           hs_console_count(root, "draft", 16, HS_CONSOLE_PICTURE, &s->draft, err) &&
           hs_console_flag(root, "hurried", &s->hurried, err) &&
           read_play(json_object_get(root, "play"), s, err) &&
           hs_console_numbers(root, "cross", 3, 0, 1, s->cross, err) &&
           read_render(json_object_get(root, "render"), &s->dvr, err) &&
           read_lanes(json_object_get(root, "lanes"), s, err) &&
           read_marks(json_object_get(root, "marks"), s, err) &&
           read_box(json_object_get(root, "box"), &s->crop, err);
}

static bool read_mark(const json_t *root, hs_console_message *out, hs_error *err) {
    static const char *const keys[] = {"type", "what", "view", "at", "radius", "keep", NULL};
    bool keep = false;
    if (!hs_console_object(root, "do", keys, err) || !hs_console_numbers(root, "at", 2, 0, 1, out->at, err) ||
        !hs_console_number(root, "radius", HS_MARK_RADIUS_LEAST, HS_MARK_RADIUS_MOST, &out->mark.radius,
                           err) ||
        !hs_console_flag(root, "keep", &keep, err))
        return false;
    out->mark.keep = keep;
    return true;
}

static bool read_deed(const json_t *root, hs_console_message *out, hs_error *err) {
    static const char *const deeds[] = {"snapshot", "write", "mark"};
    static const char *const snapshot_keys[] = {"type", "what", "view", NULL};
    static const char *const write_keys[] = {"type", "what", NULL};
    uint32_t what, view = 0;
    if (!hs_console_word(root, "what", deeds, 3, &what, err)) return false;
    out->deed = (hs_console_deed)what;
    if (out->deed == HS_CONSOLE_WRITE) return hs_console_object(root, "do", write_keys, err);
    const bool ok = out->deed == HS_CONSOLE_MARK ? read_mark(root, out, err)
                                                 : hs_console_object(root, "do", snapshot_keys, err);
    if (!ok || !hs_console_word(root, "view", view_names, HS_CONSOLE_VIEWS, &view, err)) return false;
    out->view = (hs_console_view)view;
    return true;
}

static bool read_message(const json_t *root, hs_console_message *out, hs_error *err) {
    static const char *const types[] = {"state", "seen", "do"};
    static const char *const seen_keys[] = {"type", "frame", NULL};
    uint32_t type;
    if (!json_is_object(root)) return hs_fail(err, HS_ERR_INPUT, "message: expected an object");
    if (!hs_console_word(root, "type", types, 3, &type, err)) return false;
    out->says = (hs_console_says)type;
    if (out->says == HS_CONSOLE_SAYS_STATE) return read_state(root, &out->state, err);
    if (out->says == HS_CONSOLE_SAYS_DO) return read_deed(root, out, err);
    return hs_console_object(root, "seen", seen_keys, err) &&
           hs_console_whole(root, "frame", 0, MAX_SERIAL, &out->seen, err);
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
    const bool ok = read_message(root, out, err);
    json_decref(root);
    return ok;
}
