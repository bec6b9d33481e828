/* SPDX-License-Identifier: MIT */
#include "loop/source.h"

#include "base/progress.h"
#include "volume/scanned_maps.h"

#include <stdio.h>
#include <stdlib.h>

/* A loop keeps one box, one format and one device volume for all frames, so all volumes must be alike. */
static bool same_grid(const hs_volume *first, const hs_volume *other, const char *first_path,
                      const char *path, hs_error *err) {
    if (first->nx != other->nx || first->ny != other->ny || first->nz != other->nz)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: %u x %u x %u voxels, but %s has %u x %u x %u: a sequence has one size", path,
                       other->nx, other->ny, other->nz, first_path, first->nx, first->ny, first->nz);
    for (int axis = 0; axis < 3; axis++)
        if (first->spacing[axis] != other->spacing[axis])
            return hs_fail(err, HS_ERR_INPUT, "%s: spacing %g mm along axis %d, but %s has %g mm", path,
                           other->spacing[axis], axis, first_path, first->spacing[axis]);
    for (int i = 0; i < 9; i++)
        if (first->pose.direction[i] != other->pose.direction[i] || first->probe != other->probe)
            return hs_fail(err, HS_ERR_INPUT,
                           "%s: lies otherwise in the patient than %s, or was scanned from "
                           "another side: a sequence has one orientation",
                           path, first_path);
    return true;
}

/* Room for `more` volumes of a file. */
static bool grow_files(hs_source *source, uint32_t more, hs_error *err) {
    const size_t count = (size_t)source->count + more;
    hs_volume *files = realloc(source->files, count * sizeof *files);
    if (files) source->files = files;
    hs_source_origin *origins = realloc(source->origins, count * sizeof *origins);
    if (origins) source->origins = origins;
    return (files && origins) || hs_fail(err, HS_ERR_MEMORY, "sequence: no memory for %zu volumes", count);
}

/* All volumes of one file, behind those that are there. */
static bool append_file(hs_source *source, const char *const *paths, uint32_t which,
                        const hs_metaimage_options *read, const hs_source_scanned *scanned, hs_error *err) {
    hs_metaimage *file = hs_metaimage_open(paths[which], read, err);
    const uint32_t volumes = file ? hs_metaimage_volumes(file) : 0;
    bool ok = file && grow_files(source, volumes, err);
    for (uint32_t i = 0; ok && i < volumes; i++) {
        hs_volume *volume = &source->files[source->count];
        hs_source_origin *origin = &source->origins[source->count];
        *origin = (hs_source_origin){.path = paths[which], .index = i};
        ok = hs_metaimage_next(file, volume, &origin->fields);
        source->count += ok;
        ok = ok && (!scanned || hs_scanned_maps_apply(volume, scanned->first, scanned->end, err)) &&
             same_grid(&source->files[0], volume, paths[0], paths[which], err);
    }
    if (ok) source->left_out += hs_metaimage_left_out(file);
    hs_metaimage_close(file);
    return ok;
}

bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_metaimage_options *options, const hs_source_scanned *scanned,
                          hs_error *err) {
    const bool mapped = scanned && scanned->first;
    hs_metaimage_options read = options ? *options : (hs_metaimage_options){0};
    if (mapped) read.padding = HS_PADDING_ALL; /* no need to guess: the maps tell */
    *source = (hs_source){0};
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no volume given");
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = append_file(source, paths, i, &read, mapped ? scanned : NULL, err);
    source->volumes = ok ? calloc(source->count, sizeof *source->volumes) : NULL;
    if (ok && !source->volumes)
        ok = hs_fail(err, HS_ERR_MEMORY, "sequence: no memory for %u volumes", source->count);
    for (uint32_t i = 0; ok && i < source->count; i++) source->volumes[i] = &source->files[i];
    if (!ok) hs_source_close(source);
    return ok;
}

/* Memory for `count` volumes of a scene. */
static bool allocate_scenes(hs_source *source, uint32_t count, hs_error *err) {
    *source = (hs_source){.count = count};
    source->volumes = calloc(count, sizeof *source->volumes);
    source->truths = calloc(count, sizeof *source->truths);
    source->scenes = calloc(count, sizeof *source->scenes);
    return (source->volumes && source->truths && source->scenes) ||
           hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %u volumes", count);
}

bool hs_source_open_scene(hs_source *source, const hs_source_scene *what, hs_error *err) {
    *source = (hs_source){0};
    hs_scene *scene = hs_scene_open(what->name, err);
    if (!scene) return false;
    bool ok = allocate_scenes(source, what->volumes, err);
    hs_progress progress;
    hs_progress_begin(&progress, "generating the scene", what->volumes);
    for (uint32_t i = 0; ok && i < what->volumes; i++) {
        const hs_scene_options options = {
            .size = what->size, .seed = what->seed, .frame = i, .real = what->real};
        ok = hs_scene_frame(scene, &options, &source->scenes[i], NULL, err);
        source->volumes[i] = &source->scenes[i].full;
        source->truths[i] = &source->scenes[i].truth;
        if (what->volumes > 1) hs_progress_step(&progress, i + 1u);
    }
    hs_progress_end(&progress);
    if (ok) (void)snprintf(source->title, sizeof source->title, "%s", hs_scene_title(scene));
    hs_scene_close(scene);
    if (!ok) hs_source_close(source);
    return ok;
}

void hs_source_close(hs_source *source) {
    for (uint32_t i = 0; source->files && i < source->count; i++) hs_volume_free(&source->files[i]);
    for (uint32_t i = 0; source->scenes && i < source->count; i++) hs_scene_free(&source->scenes[i]);
    free(source->files);
    free(source->origins);
    free(source->scenes);
    free(source->truths);
    free(source->volumes);
    *source = (hs_source){0};
}

const hs_volume *hs_source_volume(const hs_source *source, uint32_t index) {
    return source->volumes[index % source->count];
}

const hs_volume *hs_source_truth(const hs_source *source, uint32_t index) {
    return source->truths ? source->truths[index % source->count] : NULL;
}

const hs_scene_data *hs_source_scene_data(const hs_source *source, uint32_t index) {
    return source->scenes ? &source->scenes[index % source->count] : NULL;
}

const hs_source_origin *hs_source_origin_of(const hs_source *source, uint32_t index) {
    return source->origins ? &source->origins[index % source->count] : NULL;
}

bool hs_source_set_truth(hs_source *source, const hs_volume *truth, hs_error *err) {
    const hs_volume **truths = calloc(source->count, sizeof *truths);
    if (!truths) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for its place in a sequence", truth->name);
    truths[0] = truth;
    free(source->truths);
    source->truths = truths;
    return true;
}
