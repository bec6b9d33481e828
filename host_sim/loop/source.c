/* SPDX-License-Identifier: MIT */
#include "loop/source.h"

#include "base/progress.h"

#include <stdio.h>
#include <stdlib.h>

/* The only volume of the sequence. */
static bool read_one(hs_source *source, hs_error *err) {
    source->file = calloc(1, sizeof *source->file);
    source->volumes = calloc(1, sizeof *source->volumes);
    if (!source->file || !source->volumes) return hs_fail(err, HS_ERR_MEMORY, "source: no memory");
    source->volumes[0] = source->file;
    const bool ok = hs_sequence_read(source->sequence, 0, source->file, err);
    hs_sequence_rest(source->sequence);
    return ok;
}

bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_source_files *how, hs_error *err) {
    const hs_source_files defaults = {0};
    if (!how) how = &defaults;
    *source = (hs_source){0};
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no volume given");
    source->sequence = hs_sequence_open(paths, count, how, err);
    if (!source->sequence) return false;
    source->count = hs_sequence_count(source->sequence);
    source->left_out = hs_sequence_left_out(source->sequence);
    if (source->count > 1) source->stream = hs_stream_open(source->sequence, err);
    const bool ok = source->count > 1 ? source->stream != NULL : read_one(source, err);
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
    for (uint32_t i = 0; source->scenes && i < source->count; i++) hs_scene_free(&source->scenes[i]);
    hs_stream_close(source->stream);
    hs_sequence_close(source->sequence);
    if (source->file) hs_volume_free(source->file);
    free(source->file);
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
    return source->sequence ? &hs_sequence_origins(source->sequence)[index % source->count] : NULL;
}

bool hs_source_set_truth(hs_source *source, const hs_volume *truth, hs_error *err) {
    const hs_volume **truths = calloc(source->count, sizeof *truths);
    if (!truths) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for its place in a sequence", truth->name);
    truths[0] = truth;
    free(source->truths);
    source->truths = truths;
    return true;
}
