/* SPDX-License-Identifier: MIT */
#include "plugin/plugin_path.h"

#include "base/paths.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define DEFAULT_PLUGIN "smartvis.so"

/* A file that is there, whatever it holds: what it holds is told when it is loaded. */
static bool is_file(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

/* The index-th part of a list that is not empty, or NULL and how many there are. */
static const char *list_part(const char *list, unsigned index, size_t *length, unsigned *count) {
    *count = 0;
    for (const char *at = list; at && *at != '\0';) {
        *length = strcspn(at, ":");
        if (*length > 0 && (*count)++ == index) return at;
        at += *length + (at[*length] == ':');
    }
    return NULL;
}

/* Of the installation that the program belongs to, without the "..". */
static bool own_folder(char *out, size_t bytes) {
    char beside[PATH_MAX];
    if (!hs_path_beside_program("../lib/smartvis", beside, sizeof beside)) return false;
    char *resolved = realpath(beside, NULL);
    const int length = resolved ? snprintf(out, bytes, "%s", resolved) : -1;
    free(resolved);
    return length >= 0 && (size_t)length < bytes;
}

/* Then it has its turn among them. */
static bool is_one_of(const char *folder, const char *const *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(folder, list[i]) == 0) return true;
    return false;
}

bool hs_plugin_folder(unsigned index, char *out, size_t bytes) {
    size_t length;
    unsigned listed;
    const char *part = list_part(getenv("SMARTVIS_PLUGIN_PATH"), index, &length, &listed);
    if (part) {
        (void)snprintf(out, bytes, "%.*s", (int)(length < PATH_MAX ? length : PATH_MAX), part);
        return true;
    }
    static const char *const fixed[] = {"/usr/local/lib/smartvis", "/usr/lib/smartvis"};
    index -= listed;
    if (index == 0) {
        if (!own_folder(out, bytes) || is_one_of(out, fixed, sizeof fixed / sizeof fixed[0])) out[0] = '\0';
        return true;
    }
    if (index - 1 >= sizeof fixed / sizeof fixed[0]) return false;
    (void)snprintf(out, bytes, "%s", fixed[index - 1]);
    return true;
}

/* True, with the path in out, if one of the folders has the file. */
static bool find_in_folders(const char *name, const char *ending, char *out, size_t bytes) {
    char folder[PATH_MAX];
    for (unsigned i = 0; hs_plugin_folder(i, folder, sizeof folder); i++) {
        const int length = snprintf(out, bytes, "%s/%s%s", folder, name, ending);
        if (folder[0] != '\0' && length >= 0 && (size_t)length < bytes && is_file(out)) return true;
    }
    return false;
}

void hs_plugin_find(const char *name, char *out, size_t bytes) {
    const bool as_it_is = name[0] == '\0' || strchr(name, '/') || is_file(name);
    if (!as_it_is && (find_in_folders(name, "", out, bytes) || find_in_folders(name, ".so", out, bytes)))
        return;
    (void)snprintf(out, bytes, "%s", name);
}

void hs_plugin_default_path(char *out, size_t bytes) {
    if (hs_path_beside_program(DEFAULT_PLUGIN, out, bytes) && is_file(out)) return;
    if (find_in_folders(DEFAULT_PLUGIN, "", out, bytes)) return;
    if (!hs_path_beside_program(DEFAULT_PLUGIN, out, bytes)) (void)snprintf(out, bytes, "./" DEFAULT_PLUGIN);
}
