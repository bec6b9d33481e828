/* SPDX-License-Identifier: MIT */
/* The text of a scene: built in, drawn or a file, with fields that a command line sets otherwise. */
#include "base/input_file.h"
#include "base/paths.h"
#include "scene/scene.h"
#include "scene/scene_draw.h"
#include "scene/scene_spec.h"

#include <ctype.h>
#include <jansson.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *hs_scene_of_group(hs_scene_group group, uint32_t index) {
    static const char *const names[HS_SCENES_GROUPS][17] = {
        [HS_SCENES_THESIS] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"},
        [HS_SCENES_HARD] = {"H01", "H02", "H03", "H04", "H05", "H06", "H07", "H08", "H09", "H10", "H11",
                            "H12", "H13", "H14", "H15", "H16"},
        [HS_SCENES_EXAMPLE] = {"example"},
        [HS_SCENES_REAL] = {"real"}};
    return index < sizeof names[0] / sizeof names[0][0] ? names[group][index] : NULL;
}

/* The built-in cases lie below the program's folder or beside it: nothing here knows where the sources
 * were. */
static void scene_folder(char *folder, size_t size) {
    const char *named = getenv("SMARTVIS_SCENES");
    if (named && named[0])
        (void)snprintf(folder, size, "%s", named);
    else if (!hs_path_beside_program("share/smartvis/scenes", folder, size) || access(folder, X_OK) != 0)
        (void)hs_path_beside_program("../share/smartvis/scenes", folder, size);
}

/* A scene file's text, up to 1 MiB; free() it. NULL: HS_ERR_INPUT names the file, HS_ERR_MEMORY. */
static char *read_text(const char *path, hs_error *err) {
    enum { MAX_BYTES = 1 << 20 };
    uint64_t bytes;
    FILE *file = hs_input_open(path, path, &bytes, err); /* a regular file: nothing that waits for a writer */
    if (!file) return NULL;
    char *text = malloc(MAX_BYTES + 1);
    size_t length = text ? fread(text, 1, MAX_BYTES + 1, file) : 0;
    bool bad = ferror(file) != 0;
    fclose(file);
    if (!text) {
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
    } else if (bad || length > MAX_BYTES) {
        hs_fail(err, HS_ERR_INPUT, "%s: %s", path,
                bad ? "cannot be read" : "longer than a scene file may be (1 MiB)");
        free(text);
        text = NULL;
    } else {
        text[length] = '\0';
    }
    return text;
}

char *hs_scene_text(const char *name_or_path, char *path, size_t size, hs_error *err) {
    char folder[PATH_MAX];
    hs_scene_drawn drawn;
    if (strpbrk(name_or_path, "/.")) {
        (void)snprintf(path, size, "%s", name_or_path);
    } else if (hs_scene_drawn_name(name_or_path, &drawn)) {
        (void)snprintf(path, size, "%s", name_or_path);
        char *text = hs_scene_draw(&drawn);
        if (!text) hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
        return text;
    } else {
        scene_folder(folder, sizeof folder);
        (void)snprintf(path, size, "%s/%s.json", folder, name_or_path);
    }
    return read_text(path, err);
}

/* The place a path names: a member of an object or an element of an array. */
typedef struct {
    json_t *parent;
    char key[64]; /* "": an element */
    size_t index;
} place;

/* The next part of a path: a name or "[index]". */
static bool next_part(const char **path, place *part) {
    const char *p = *path;
    part->key[0] = '\0';
    if (*p == '[') {
        char *end;
        if (!isdigit((unsigned char)p[1])) return false;
        part->index = strtoul(p + 1, &end, 10);
        if (*end != ']') return false;
        *path = end + 1;
    } else {
        const size_t length = strcspn(p, ".[");
        if (length == 0 || length >= sizeof part->key) return false;
        memcpy(part->key, p, length);
        part->key[length] = '\0';
        *path = p + length;
    }
    if (**path == '.') return *++*path != '\0' && **path != '[';
    return **path == '\0' || **path == '[';
}

/* An artefact by its type: its place in the list, behind the last if it is not there. */
static void find_type(place *part) {
    size_t i;
    json_t *one;
    json_array_foreach(part->parent, i, one) {
        const char *type = json_string_value(json_object_get(one, "type"));
        if (type && strcmp(type, part->key) == 0) break;
    }
    part->index = i;
}

static json_t *value_at(const place *at) {
    return json_is_array(at->parent) ? json_array_get(at->parent, at->index)
                                     : json_object_get(at->parent, at->key);
}

/* Puts a value there; it is taken over. */
static bool put_value(const place *at, json_t *value) {
    if (!json_is_array(at->parent)) return json_object_set_new(at->parent, at->key, value) == 0;
    if (at->index < json_array_size(at->parent)) return json_array_set_new(at->parent, at->index, value) == 0;
    return json_array_append_new(at->parent, value) == 0;
}

/* Makes `part` a place in its parent; what is not there yet may come into an object, or into a list by
 * its type. */
static bool resolve(place *part) {
    if (json_is_array(part->parent) && part->key[0]) {
        find_type(part);
        return true;
    }
    return json_is_array(part->parent) ? part->index < json_array_size(part->parent)
                                       : json_is_object(part->parent) && part->key[0] != '\0';
}

/* What must be there for the rest of the path to name something of it. */
static json_t *make_way(const place *part) {
    json_t *there = value_at(part);
    if (there) return there;
    json_t *made = json_is_array(part->parent) ? json_pack("{s:s}", "type", part->key) : json_object();
    return made && put_value(part, made) ? made : NULL;
}

static bool find(json_t *root, const char *path, place *at) {
    at->parent = root;
    while (next_part(&path, at)) {
        if (!resolve(at)) return false;
        if (*path == '\0') return true;
        at->parent = make_way(at);
        if (!at->parent) return false;
    }
    return false;
}

static void take_away(const place *at) {
    if (json_is_array(at->parent))
        (void)json_array_remove(at->parent, at->index);
    else
        (void)json_object_del(at->parent, at->key);
}

/* JSON, or a word that is none. */
static json_t *value_of(const char *text) {
    json_t *value = json_loads(text, JSON_DECODE_ANY, NULL);
    return value ? value : json_string(text);
}

static bool apply(json_t *root, const char *assignment, hs_error *err) {
    const char *equals = strchr(assignment, '=');
    char path[128];
    place at;
    if (!equals || equals[1] == '\0' || (size_t)(equals - assignment) >= sizeof path)
        return hs_fail(err, HS_ERR_USAGE, "--set: '%.100s' is not PATH=VALUE", assignment);
    memcpy(path, assignment, (size_t)(equals - assignment));
    path[equals - assignment] = '\0';
    if (!find(root, path, &at))
        return hs_fail(err, HS_ERR_USAGE, "--set: '%s' names nothing of the scene", path);
    if (strcmp(equals + 1, "off") == 0) {
        take_away(&at);
        return true;
    }
    if (strcmp(equals + 1, "on") == 0 && json_is_array(at.parent)) return make_way(&at) != NULL;
    json_t *value = value_of(equals + 1);
    return (value && put_value(&at, value)) ||
           hs_fail(err, HS_ERR_USAGE, "--set: '%.100s' is no value", assignment);
}

char *hs_scene_override(const char *path, const char *text, const char *assignment, hs_error *err) {
    json_error_t bad;
    char *out = NULL;
    json_t *root = json_loads(text, JSON_REJECT_DUPLICATES, &bad);
    if (!root) {
        hs_fail(err, HS_ERR_INPUT, "%s:%d: column %d: not JSON: %s", path, bad.line, bad.column, bad.text);
        return NULL;
    }
    if (apply(root, assignment, err)) {
        out = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
        if (!out) hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
    }
    json_decref(root);
    return out;
}
