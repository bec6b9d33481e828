/* SPDX-License-Identifier: MIT */
/* The volumes in the folders of the command line, and nothing outside them. */
#include "console/console.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool hs_console_files_add(hs_console_files *files, const char *folder, hs_error *err) {
    struct stat what;
    if (files->count == HS_CONSOLE_FOLDERS)
        return hs_fail(err, HS_ERR_USAGE, "%s: more than %d folders", folder, HS_CONSOLE_FOLDERS);
    char *real = realpath(folder, NULL);
    if (!real || stat(real, &what) != 0 || !S_ISDIR(what.st_mode)) {
        free(real);
        return hs_fail(err, HS_ERR_INPUT, "%s: is no folder", folder);
    }
    files->folder[files->count++] = real;
    return true;
}

void hs_console_files_free(hs_console_files *files) {
    for (uint32_t i = 0; i < files->count; i++) free(files->folder[i]);
    *files = (hs_console_files){0};
}

static bool is_volume_name(const char *name) {
    static const char *const endings[] = {".mha", ".mhd", ".vol"};
    const size_t length = strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (length > 4 && strcasecmp(name + length - 4, endings[i]) == 0) return true;
    return false;
}

/* True for what `scenes --export` writes beside a volume: labels and depths, which are no echoes. */
static bool is_map_name(const char *name) {
    static const char *const endings[] = {"_label.mha", "_near.mha", "_far.mha"};
    const size_t length = strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        const size_t end = strlen(endings[i]);
        if (length > end && strcmp(name + length - end, endings[i]) == 0) return true;
    }
    return false;
}

/* True if a MetaImage says that it has one slice: a value a ray, beside a volume or in its place. */
static bool is_flat(const char *path) {
    char head[2048];
    unsigned n[3] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    head[fread(head, 1, sizeof head - 1, file)] = '\0';
    (void)fclose(file);
    const char *size = strstr(head, "DimSize");
    const int axes = size ? sscanf(size, "DimSize = %9u %9u %9u", &n[0], &n[1], &n[2]) : 0;
    return axes == 2 || (axes == 3 && n[2] == 1);
}

/* True if the real path `inner` is below the real folder `outer`. */
static bool is_below(const char *outer, const char *inner) {
    const size_t length = strlen(outer);
    if (strcmp(outer, "/") == 0) return true;
    return strncmp(outer, inner, length) == 0 && inner[length] == '/';
}

bool hs_console_files_find(const hs_console_files *files, uint32_t folder, const char *path, char *out,
                           size_t bytes, hs_error *err) {
    char joined[PATH_MAX], real[PATH_MAX];
    struct stat what;
    if (folder >= files->count)
        return hs_fail(err, HS_ERR_INPUT, "folder %u: the console has %u", folder, files->count);
    const int length = snprintf(joined, sizeof joined, "%s/%s", files->folder[folder], path);
    if (length < 0 || (size_t)length >= sizeof joined)
        return hs_fail(err, HS_ERR_INPUT, "%.200s...: the path is too long", path);
    if (!is_volume_name(path) || !realpath(joined, real) || stat(real, &what) != 0 || !S_ISREG(what.st_mode))
        return hs_fail(err, HS_ERR_INPUT, "%s: is no volume of folder %u", path, folder);
    if (!is_below(files->folder[folder], real) || strlen(real) >= bytes)
        return hs_fail(err, HS_ERR_INPUT, "%s: lies outside of folder %u", path, folder);
    (void)snprintf(out, bytes, "%s", real);
    return true;
}

/* A folder that is being listed. */
typedef struct {
    const hs_console_files *files;
    uint32_t folder, told;
    hs_console_file_fn tell;
    void *context;
} listing;

/* Tells of one entry, "path/in/folder"; what is neither a volume nor a folder is passed over. */
static bool list_folder(listing *l, const char *path, int depth);

static bool list_entry(listing *l, const char *path, int depth) {
    char joined[PATH_MAX], real[PATH_MAX];
    struct stat what;
    hs_error outside = {0};
    const int length = snprintf(joined, sizeof joined, "%s/%s", l->files->folder[l->folder], path);
    if (length < 0 || (size_t)length >= sizeof joined || lstat(joined, &what) != 0) return true;
    if (S_ISDIR(what.st_mode)) return list_folder(l, path, depth + 1);
    if (is_map_name(path)) return true;
    if (!hs_console_files_find(l->files, l->folder, path, real, sizeof real, &outside)) return true;
    if (is_flat(real)) return true;
    return ++l->told <= HS_CONSOLE_FILES && l->tell(l->context, l->folder, path);
}

static bool list_folder(listing *l, const char *path, int depth) {
    char joined[PATH_MAX];
    struct dirent **entries = NULL;
    if (depth > HS_CONSOLE_DEPTH_OF_FOLDERS) return true;
    (void)snprintf(joined, sizeof joined, "%s/%s", l->files->folder[l->folder], path);
    const int count = scandir(joined, &entries, NULL, alphasort);
    bool more = true;
    for (int i = 0; i < count; i++) {
        char inner[PATH_MAX];
        const int length =
            snprintf(inner, sizeof inner, "%s%s%s", path, path[0] ? "/" : "", entries[i]->d_name);
        if (more && entries[i]->d_name[0] != '.' && length >= 0 && (size_t)length < sizeof inner)
            more = list_entry(l, inner, depth);
        free(entries[i]);
    }
    free(entries);
    return more;
}

void hs_console_files_list(const hs_console_files *files, hs_console_file_fn tell, void *context) {
    listing l = {.files = files, .tell = tell, .context = context};
    for (l.folder = 0; l.folder < files->count; l.folder++)
        if (!list_folder(&l, "", 0)) return;
}

/* --------------------------------------------------------------------------------------------- plugins -- */

static hs_console_offer *add(hs_console_offers *offers, const char *library, const char *path,
                             hs_error *err) {
    if (offers->count == HS_CONSOLE_OFFERS) {
        (void)hs_fail(err, HS_ERR_USAGE, "%s: more than %d plugins", path, HS_CONSOLE_OFFERS);
        return NULL;
    }
    hs_console_offer *offer = &offers->offer[offers->count++];
    *offer = (hs_console_offer){.library = library};
    (void)snprintf(offer->path, sizeof offer->path, "%s", path);
    return offer;
}

static bool is_default(const char *path) {
    char ours[1024], real[2][PATH_MAX];
    hs_plugin_default_path(ours, sizeof ours);
    return realpath(ours, real[0]) && realpath(path, real[1]) && strcmp(real[0], real[1]) == 0;
}

static bool add_plugins(hs_console_offers *offers, const char *library, const char *path,
                        const hs_plugin *plugin, hs_error *err) {
    for (uint32_t i = 0; i < plugin->count; i++) {
        const sv_descriptor *d = plugin->descriptor[i];
        hs_console_offer *offer = add(offers, library, path, err);
        if (!offer) return false;
        (void)snprintf(offer->id, sizeof offer->id, "%s", d->id);
        (void)snprintf(offer->name, sizeof offer->name, "%s", d->name);
        (void)snprintf(offer->version, sizeof offer->version, "%s", d->version);
        offer->first = i == 0;
        offer->ours = i == 0 && is_default(path);
    }
    return true;
}

bool hs_console_offer_library(hs_console_offers *offers, const char *library, hs_error *err) {
    char path[1024];
    hs_plugin plugin;
    hs_error failure = {0}, closed = {0};
    if (library)
        hs_plugin_find(library, path, sizeof path);
    else
        hs_plugin_default_path(path, sizeof path);
    if (hs_guarded_open(&plugin, path, NULL, SV_LOG_WARNING, &offers->guard, &failure)) {
        const bool ok = add_plugins(offers, library, path, &plugin, err);
        (void)hs_guarded_close(&plugin, &closed); /* what it does when it ends is told when it is used */
        return ok;
    }
    hs_console_offer *offer = add(offers, library, path, err);
    if (!offer) return false;
    offer->failure = failure;
    (void)snprintf(offer->name, sizeof offer->name, "%.120s", path);
    return true;
}

bool hs_console_offer_ours(hs_console_offers *offers, hs_error *err) {
    const uint32_t others = offers->count;
    for (uint32_t i = 0; i < others; i++)
        if (offers->offer[i].ours) return true;
    if (!hs_console_offer_library(offers, NULL, err)) return false;
    if (others > 0 && offers->offer[others].failure.code != HS_OK) offers->count = others;
    return true;
}
