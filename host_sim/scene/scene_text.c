/* SPDX-License-Identifier: MIT */
/* The text of a scene: built in, drawn or a file. */
#include "core/input_file.h"
#include "core/paths.h"
#include "core/system.h"
#include "scene/scene.h"
#include "scene/scene_draw.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
void hs_scene_folder(char *folder, size_t size) {
    if (sys_environment("SMARTVIS_SCENES", folder, size) && folder[0]) return;
    if (!hs_path_beside_program("share/smartvis/scenes", folder, size) || !sys_is_folder(folder))
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
    char folder[SYS_PATH];
    hs_scene_drawn drawn;
    if (strpbrk(name_or_path, "/.")) {
        (void)snprintf(path, size, "%s", name_or_path);
    } else if (hs_scene_drawn_name(name_or_path, &drawn)) {
        (void)snprintf(path, size, "%s", name_or_path);
        char *text = hs_scene_draw(&drawn);
        if (!text) hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
        return text;
    } else {
        hs_scene_folder(folder, sizeof folder);
        (void)snprintf(path, size, "%s/%s.json", folder, name_or_path);
    }
    return read_text(path, err);
}
