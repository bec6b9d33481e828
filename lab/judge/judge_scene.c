/* SPDX-License-Identifier: MIT */
/* Scenes to judge surfaces on, each in its own pose or in a shifted one. */
#include "judge/judge.h"

#include "core/paths.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 128 }; /* voxels an axis */

int judge_temporary(const char *stem, const char *ending, char *out, size_t bytes, hs_error *err) {
    const char *const folder = getenv("TMPDIR");
    char name[64];
    (void)snprintf(name, sizeof name, "%s_XXXXXX%s", stem, ending);
    if (!hs_path_join(folder ? folder : "/tmp", name, out, bytes, err)) return -1;
    const int file = mkstemps(out, (int)strlen(ending));
    if (file < 0) (void)hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be made: %s", out, strerror(errno));
    return file;
}

/* -1 .. 1 */
static double random_number(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0 * 2.0 - 1.0;
}

/* Shifts the numbers of a list, or scales a single number, by up to `amount`. */
static void shift(json_t *object, const char *key, double amount, uint64_t *state) {
    json_t *value = json_object_get(object, key);
    if (json_is_number(value))
        json_object_set_new(object, key,
                            json_real(json_number_value(value) * (1.0 + amount * random_number(state))));
    for (size_t i = 0; json_is_array(value) && i < json_array_size(value); i++)
        json_array_set_new(
            value, i, json_real(json_number_value(json_array_get(value, i)) + amount * random_number(state)));
}

static void shift_structure(json_t *structure, uint64_t *state) {
    static const char *const joints[] = {"right_elbow", "right_hand",  "left_elbow", "left_hand",
                                         "right_knee",  "right_ankle", "left_knee",  "left_ankle"};
    const char *type = json_string_value(json_object_get(structure, "type"));
    if (type && strcmp(type, "fetus") == 0) {
        shift(structure, "position_mm", 4.0, state);
        shift(structure, "rotation_deg", 8.0, state);
        shift(structure, "scale", 0.04, state);
        for (size_t i = 0; i < sizeof joints / sizeof *joints; i++) shift(structure, joints[i], 3.0, state);
    } else {
        shift(structure, "centre_mm", 4.0, state);
        if (type && strcmp(type, "occluder") == 0) shift(structure, "radii_mm", 2.0, state);
    }
}

/* Writes the scene of `name` in another pose to a new temporary file. */
static bool write_pose(const char *name, uint32_t pose, char *path, size_t size, hs_error *err) {
    char from[1024];
    (void)snprintf(from, sizeof from, "%s/%s.json", SURF_SCENE_DIR, name);
    json_error_t why;
    json_t *root = json_load_file(from, 0, &why);
    if (!root) return hs_fail(err, HS_ERR_INPUT, "%s:%d: %s", from, why.line, why.text);
    uint64_t state = (uint64_t)pose * 7919 + (uint64_t)name[0] * 31 + (uint64_t)name[2];
    for (int i = 0; i < 5; i++) (void)random_number(&state);
    shift(json_object_get(root, "sac"), "centre_mm", 2.0, &state);
    size_t i;
    json_t *structure;
    json_array_foreach(json_object_get(root, "structures"), i, structure) shift_structure(structure, &state);
    const int file = judge_temporary("surfaces", ".json", path, size, err);
    const bool written = file >= 0 && json_dumpfd(root, file, JSON_INDENT(1)) == 0;
    if (file >= 0) (void)close(file);
    json_decref(root);
    return written || (file >= 0 && hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be written", path));
}

bool wall_case_make(const char *name, uint64_t seed, uint32_t pose, uint32_t frame, wall_case *out,
                    hs_error *err) {
    const hs_scene_options options = {.size = SIDE, .seed = seed, .frame = frame};
    char path[1024];
    hs_scene_data data;
    *out = (wall_case){0};
    if (pose && !write_pose(name, pose, path, sizeof path, err)) return false;
    hs_scene *scene = hs_scene_open(pose ? path : name, err);
    if (pose) (void)unlink(path);
    if (!scene) return false;
    const bool made = hs_scene_frame(scene, &options, &data, err);
    hs_scene_close(scene);
    if (!made) return false;
    const bool ok = wall_case_scene(&data, name, out, err);
    hs_scene_free(&data);
    return ok;
}
