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

/* All volumes of a MetaImage file, behind those that are there. */
static bool append_metaimage(hs_source *source, const char *const *paths, uint32_t which,
                             const hs_source_files *how, hs_error *err) {
    const hs_source_scanned *scanned = &how->scanned;
    hs_metaimage_options read = how->metaimage;
    if (scanned->first) read.padding = HS_PADDING_ALL; /* no need to guess: the maps tell */
    hs_metaimage *file = hs_metaimage_open(paths[which], &read, err);
    const uint32_t volumes = file ? hs_metaimage_volumes(file) : 0;
    bool ok = file && grow_files(source, volumes, err);
    for (uint32_t i = 0; ok && i < volumes; i++) {
        hs_volume *volume = &source->files[source->count];
        hs_source_origin *origin = &source->origins[source->count];
        *origin = (hs_source_origin){.path = paths[which], .index = i};
        ok = hs_metaimage_next(file, volume, &origin->fields);
        source->count += ok;
        ok = ok && (!scanned->first || hs_scanned_maps_apply(volume, scanned->first, scanned->end, err)) &&
             same_grid(&source->files[0], volume, paths[0], paths[which], err);
    }
    if (ok) source->left_out += hs_metaimage_left_out(file);
    hs_metaimage_close(file);
    return ok;
}

/* What only MetaImage files take must not be asked of others in vain. */
static bool check_kretz(const char *path, const hs_source_files *how, hs_error *err) {
    if (how->scanned.first)
        return hs_fail(err, HS_ERR_USAGE,
                       "%s: a Kretz file says itself what was scanned, maps of it were given", path);
    if (how->metaimage.has_probe)
        return hs_fail(err, HS_ERR_USAGE, "%s: a Kretz file says itself where the probe is, %s was given",
                       path, hs_probe_name(how->metaimage.probe));
    return !how->metaimage.has_window ||
           hs_fail(err, HS_ERR_USAGE, "%s: a window was given, but a Kretz file has 8 bits", path);
}

static hs_kretz *open_kretz(const char *path, const hs_source_files *how, hs_error *err) {
    hs_kretz_options options = how->kretz;
    options.padding = how->metaimage.padding;
    return check_kretz(path, how, err) ? hs_kretz_open(path, &options, err) : NULL;
}

/* The one volume of a Kretz file, behind those that are there. */
static bool append_kretz(hs_source *source, const char *const *paths, uint32_t which,
                         const hs_source_files *how, hs_error *err) {
    hs_kretz *kretz = open_kretz(paths[which], how, err);
    if (!kretz) return false;
    bool ok = hs_kretz_count(kretz) == 1 ||
              hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, which comes alone", paths[which],
                      hs_kretz_count(kretz));
    ok = ok && grow_files(source, 1, err);
    if (ok) {
        hs_volume *volume = &source->files[source->count];
        *volume = (hs_volume){0};
        source->origins[source->count] = (hs_source_origin){.path = paths[which]};
        ok = hs_kretz_read(kretz, 0, volume, err);
        source->count += ok;
        ok = ok && same_grid(&source->files[0], volume, paths[0], paths[which], err);
    }
    hs_kretz_close(kretz);
    return ok;
}

/* *is: the files are one Kretz file that is a sequence, and it is open as a stream. */
static bool open_stream(hs_source *source, const char *const *paths, uint32_t count,
                        const hs_source_files *how, bool *is, hs_error *err) {
    *is = false;
    if (count != 1 || !hs_kretz_is_file(paths[0])) return true;
    hs_kretz *kretz = open_kretz(paths[0], how, err);
    if (!kretz) return false;
    *is = hs_kretz_count(kretz) > 1;
    if (!*is) {
        hs_kretz_close(kretz);
        return true;
    }
    source->stream = hs_stream_open(kretz, err);
    if (source->stream) source->count = hs_stream_count(source->stream);
    return source->stream != NULL;
}

static bool read_all(hs_source *source, const char *const *paths, uint32_t count, const hs_source_files *how,
                     hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = hs_kretz_is_file(paths[i]) ? append_kretz(source, paths, i, how, err)
                                        : append_metaimage(source, paths, i, how, err);
    source->volumes = ok ? calloc(source->count, sizeof *source->volumes) : NULL;
    if (ok && !source->volumes)
        ok = hs_fail(err, HS_ERR_MEMORY, "sequence: no memory for %u volumes", source->count);
    for (uint32_t i = 0; ok && i < source->count; i++) source->volumes[i] = &source->files[i];
    return ok;
}

bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_source_files *how, hs_error *err) {
    const hs_source_files defaults = {0};
    bool is_stream = false;
    if (!how) how = &defaults;
    *source = (hs_source){0};
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no volume given");
    const bool ok = open_stream(source, paths, count, how, &is_stream, err) &&
                    (is_stream || read_all(source, paths, count, how, err));
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
    hs_stream_close(source->stream);
    free(source->files);
    free(source->origins);
    free(source->scenes);
    free(source->truths);
    free(source->volumes);
    *source = (hs_source){0};
}

const hs_volume *hs_source_shape(const hs_source *source) {
    return source->stream ? hs_stream_shape(source->stream) : source->volumes[0];
}

const hs_volume *hs_source_bring(const hs_source *source, uint32_t index, hs_error *err) {
    return source->stream ? hs_stream_get(source->stream, index % source->count, err)
                          : source->volumes[index % source->count];
}

const hs_volume *hs_source_volume(const hs_source *source, uint32_t index) {
    hs_error unused = {0};
    return hs_source_bring(source, index, &unused);
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
