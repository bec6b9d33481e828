/* SPDX-License-Identifier: MIT */
#include "eval/eval_source.h"

#include "volume/volume_file.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "FULL,TRUTH,LABEL" in its parts; false if there are not three. */
static bool split(const char *text, char part[3][PATH_MAX]) {
    for (int i = 0; i < 3; i++) {
        const char *comma = strchr(text, ',');
        const size_t length = comma ? (size_t)(comma - text) : strlen(text);
        if (length == 0 || length >= PATH_MAX || (i < 2) != (comma != NULL)) return false;
        memcpy(part[i], text, length);
        part[i][length] = '\0';
        text += length + 1;
    }
    return true;
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

static bool open_files(hs_eval_source *s, const char *names, hs_error *err) {
    /* Labels of 0 are labels: no zero is raised. */
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    char part[3][PATH_MAX];
    if (!split(names, part))
        return hs_fail(err, HS_ERR_USAGE, "'%s': expected three files, FULL,TRUTH,LABEL", names);
    const char *const full = part[0];
    if (!hs_source_open_files(&s->source, &full, 1, NULL, err)) return false;
    if (s->source.count > 1)
        return hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, expected one", full,
                       s->source.count);
    const hs_volume *volume = hs_source_volume(&s->source, 0);
    if (!hs_volume_file_read(part[1], &s->given_truth, err) ||
        !check_truth(volume, &s->given_truth, part[1], err) ||
        !hs_metaimage_read(part[2], &as_it_is, &s->given_label, err) ||
        !check_label(volume, &s->given_label, part[2], err))
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
