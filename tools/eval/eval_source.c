/* SPDX-License-Identifier: MIT */
#include "eval/eval_source.h"

#include "volume/scanned_maps.h"
#include "volume/volume_file.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The files of a case, in the order of its name. */
enum { FULL, TRUTH, LABEL, FIRST, END, PARTS };

/* "FULL,TRUTH,LABEL" or "FULL,TRUTH,LABEL,FIRST,END" in its parts: how many there are, 0 if it is neither. */
static int split(const char *text, char part[PARTS][PATH_MAX]) {
    for (int i = 0; i < PARTS; i++) {
        const char *comma = strchr(text, ',');
        const size_t length = comma ? (size_t)(comma - text) : strlen(text);
        if (length == 0 || length >= PATH_MAX) return 0;
        memcpy(part[i], text, length);
        part[i][length] = '\0';
        if (!comma) return i == LABEL || i == END ? i + 1 : 0;
        text += length + 1;
    }
    return 0;
}

static bool check_truth(const hs_volume *full, const hs_volume *truth, const char *path, hs_error *err) {
    if (truth->nx != full->nx || truth->ny != full->ny || truth->nz != full->nz)
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels, the volume has %u x %u x %u", path,
                       truth->nx, truth->ny, truth->nz, full->nx, full->ny, full->nz);
    for (int axis = 0; axis < 3; axis++)
        if (truth->spacing[axis] != full->spacing[axis])
            return hs_fail(err, HS_ERR_INPUT, "%s: spacing %g mm along axis %d, the volume has %g mm", path,
                           truth->spacing[axis], axis, full->spacing[axis]);
    return true;
}

static bool check_label(const hs_volume *full, const hs_volume *label, const char *path, hs_error *err) {
    if (label->nx != full->nx || label->ny != full->ny || label->nz != 1)
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u labels, expected %u x %u x 1", path, label->nx,
                       label->ny, label->nz, full->nx, full->ny);
    for (size_t i = 0; i < hs_volume_count(label); i++)
        if (label->voxels[i] > HS_LABEL_FETUS)
            return hs_fail(err, HS_ERR_INPUT, "%s: label %u, expected 0 (neither), 1 (sac) or 2 (fetus)",
                           path, label->voxels[i]);
    return true;
}

/* A label promises that something can be seen there, so the ray must have been scanned. */
static bool check_scanned(const hs_volume *full, const hs_volume *label, char part[PARTS][PATH_MAX],
                          hs_error *err) {
    const size_t rays = (size_t)full->nx * full->ny;
    double *maps = malloc(2 * rays * sizeof *maps);
    if (!maps) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a map of %zu rays", part[FIRST], rays);
    bool ok = hs_metaimage_read_map(part[FIRST], full->nx, full->ny, maps, err) &&
              hs_metaimage_read_map(part[END], full->nx, full->ny, maps + rays, err);
    for (size_t i = 0; ok && i < rays; i++) {
        const size_t x = i % full->nx, y = i / full->nx;
        const double first = maps[i], end = maps[rays + i];
        if (first > end)
            ok = hs_fail(err, HS_ERR_INPUT, "%s: pixel (%zu, %zu) is %g, behind %g in %s", part[FIRST], x, y,
                         first, end, part[END]);
        else if (first == end && label->voxels[i] != HS_LABEL_NEITHER)
            ok = hs_fail(err, HS_ERR_INPUT,
                         "%s: label %u at pixel (%zu, %zu), where nothing was scanned: %g .. %g in %s and %s",
                         part[LABEL], label->voxels[i], x, y, first, end, part[FIRST], part[END]);
    }
    free(maps);
    return ok;
}

/* The volume that the plugin gets; with maps, what they call unscanned is 0. */
static bool open_full(hs_eval_source *s, char part[PARTS][PATH_MAX], bool ranged, hs_error *err) {
    const hs_source_files how = {.scanned = {ranged ? part[FIRST] : NULL, ranged ? part[END] : NULL}};
    const char *const path = part[FULL];
    if (!hs_source_open_files(&s->source, &path, 1, &how, err)) return false;
    return s->source.count == 1 ||
           hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, expected one", path, s->source.count);
}

static bool open_files(hs_eval_source *s, const char *names, hs_error *err) {
    /* Labels of 0 are labels: no zero is raised. */
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    char part[PARTS][PATH_MAX];
    const int parts = split(names, part);
    if (parts == 0)
        return hs_fail(err, HS_ERR_USAGE,
                       "'%s': expected three files, FULL,TRUTH,LABEL, or five, FULL,TRUTH,LABEL,FIRST,END",
                       names);
    const bool ranged = parts == PARTS;
    if (!open_full(s, part, ranged, err)) return false;
    const hs_volume *volume = hs_source_volume(&s->source, 0);
    const bool read = ranged ? hs_metaimage_read(part[TRUTH], &as_it_is, &s->given_truth, err)
                             : hs_volume_file_read(part[TRUTH], &s->given_truth, err);
    if (!read || !check_truth(volume, &s->given_truth, part[TRUTH], err) ||
        !hs_metaimage_read(part[LABEL], &as_it_is, &s->given_label, err) ||
        !check_label(volume, &s->given_label, part[LABEL], err))
        return false;
    if (ranged && (!check_scanned(volume, &s->given_label, part, err) ||
                   !hs_scanned_maps_apply(&s->given_truth, part[FIRST], part[END], err)))
        return false;
    s->label = s->given_label.voxels;
    return hs_source_set_truth(&s->source, &s->given_truth, err);
}

static bool open_scene(hs_eval_source *s, const hs_eval_request *request, hs_error *err) {
    const hs_source_scene scene = {.name = request->name,
                                   .size = request->size,
                                   .seed = request->seed,
                                   .volumes = 1,
                                   .real = strcmp(request->name, "real") == 0 ? request->real : NULL};
    if (!hs_source_open_scene(&s->source, &scene, err)) return false;
    s->label = hs_source_scene_data(&s->source, 0)->label;
    return true;
}

bool hs_eval_source_open(hs_eval_source *source, const hs_eval_request *request, hs_error *err) {
    *source = (hs_eval_source){0};
    const bool files = strchr(request->name, ',') != NULL;
    if (files ? open_files(source, request->name, err) : open_scene(source, request, err)) return true;
    hs_eval_source_close(source);
    return false;
}

void hs_eval_source_close(hs_eval_source *source) {
    hs_source_close(&source->source);
    hs_volume_free(&source->given_truth);
    hs_volume_free(&source->given_label);
    *source = (hs_eval_source){0};
}
