/* SPDX-License-Identifier: MIT */
#include "loop/source.h"

#include "base/progress.h"

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

static bool open_file(hs_sequence_file *file, const char *path, const hs_source_files *how, hs_error *err) {
    *file = (hs_sequence_file){0};
    if (hs_kretz_is_file(path)) {
        hs_kretz_options options = how->kretz;
        options.padding = how->metaimage.padding;
        file->kretz = check_kretz(path, how, err) ? hs_kretz_open(path, &options, err) : NULL;
        return file->kretz != NULL;
    }
    hs_metaimage_options options = how->metaimage;
    if (how->scanned.first) options.padding = HS_PADDING_ALL; /* no need to guess: the maps tell */
    file->scanned = how->scanned;
    file->metaimage = hs_metaimage_open(path, &options, err);
    return file->metaimage != NULL;
}

/* What is known of a file's volumes, behind that of those before. */
static void note_origins(hs_source *source, const hs_sequence_file *file, const char *path) {
    const uint32_t volumes = hs_sequence_file_count(file);
    for (uint32_t i = 0; i < volumes; i++) {
        hs_source_origin *origin = &source->origins[source->count + i];
        const hs_frame_fields *said = file->metaimage ? hs_metaimage_fields(file->metaimage, i) : NULL;
        *origin = (hs_source_origin){.path = path, .metaimage = file->metaimage != NULL, .index = i};
        if (said) origin->fields = *said;
    }
    if (file->metaimage) source->left_out += hs_metaimage_left_out(file->metaimage);
}

/* All volumes of a file, behind those that are there. */
static bool read_file(hs_source *source, const char *first_path, const char *path, hs_sequence_file *file,
                      hs_error *err) {
    const uint32_t volumes = hs_sequence_file_count(file);
    if (file->kretz && volumes > 1)
        return hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, which comes alone", path, volumes);
    if (!grow_files(source, volumes, err)) return false;
    note_origins(source, file, path);
    bool ok = true;
    for (uint32_t i = 0; ok && i < volumes; i++) {
        hs_volume *volume = &source->files[source->count];
        *volume = (hs_volume){0};
        ok = hs_sequence_file_read(file, i, volume, err);
        source->count += ok;
        ok = ok && same_grid(&source->files[0], volume, first_path, path, err);
    }
    return ok;
}

static bool point_to_files(hs_source *source, hs_error *err) {
    source->volumes = calloc(source->count, sizeof *source->volumes);
    if (!source->volumes)
        return hs_fail(err, HS_ERR_MEMORY, "sequence: no memory for %u volumes", source->count);
    for (uint32_t i = 0; i < source->count; i++) source->volumes[i] = &source->files[i];
    return true;
}

static bool read_all(hs_source *source, const char *const *paths, uint32_t count, const hs_source_files *how,
                     hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++) {
        hs_sequence_file file;
        ok = open_file(&file, paths[i], how, err) && read_file(source, paths[0], paths[i], &file, err);
        hs_sequence_file_close(&file);
    }
    return ok && point_to_files(source, err);
}

/* The file goes to the stream, or is closed. */
static bool play(hs_source *source, const char *path, hs_sequence_file *file, hs_error *err) {
    const uint32_t volumes = hs_sequence_file_count(file);
    source->origins = calloc(volumes, sizeof *source->origins);
    if (!source->origins) {
        hs_sequence_file_close(file);
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %u volumes", path, volumes);
    }
    note_origins(source, file, path);
    source->count = volumes;
    source->stream = hs_stream_open(file, err);
    return source->stream != NULL;
}

static bool open_one(hs_source *source, const char *path, const hs_source_files *how, hs_error *err) {
    hs_sequence_file file;
    if (!open_file(&file, path, how, err)) return false;
    if (hs_sequence_file_count(&file) > 1) return play(source, path, &file, err);
    const bool ok = read_file(source, path, path, &file, err) && point_to_files(source, err);
    hs_sequence_file_close(&file);
    return ok;
}

bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_source_files *how, hs_error *err) {
    const hs_source_files defaults = {0};
    if (!how) how = &defaults;
    *source = (hs_source){0};
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no volume given");
    const bool ok =
        count == 1 ? open_one(source, paths[0], how, err) : read_all(source, paths, count, how, err);
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
