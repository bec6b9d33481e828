/* SPDX-License-Identifier: MIT */
#include "result/result_write.h"

#include "base/paths.h"
#include "base/progress.h"
#include "result/result_voxels.h"
#include "volume/metaimage_write.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILES = 5 /* of MetaImage: all but the surface */ };

static const char *const names[HS_RESULT_COUNT] = {"depthmap", "confidence", "status",
                                                   "clipped",  "mask",       "surface"};

typedef struct {
    hs_loop *loop;
    const hs_source *source;
    const char *folder;
    hs_result_report *report;
    hs_error *err;
    hs_maps maps;
    hs_metaimage_stream *streams[FILES];
    hs_frame_fields *fields; /* of a sequence's volumes, or NULL */
    hs_result_voxels *voxels;
    uint8_t *mask;
} writing;

const char *hs_result_name(uint32_t index) {
    return names[index];
}

static bool parse_word(const char *option, const char *word, size_t length, uint32_t *what, hs_error *err) {
    for (uint32_t i = 0; i < HS_RESULT_COUNT; i++)
        if (strlen(names[i]) == length && memcmp(names[i], word, length) == 0) {
            *what |= 1u << i;
            return true;
        }
    return hs_fail(err, HS_ERR_USAGE,
                   "%s: '%.*s' is none of depthmap, confidence, status, clipped, mask, surface, or all",
                   option, (int)(length < 64 ? length : 64), word);
}

bool hs_result_parse(const char *option, const char *text, uint32_t *what, hs_error *err) {
    *what = 0;
    if (strcmp(text, "all") == 0) {
        *what = HS_RESULT_ALL;
        return true;
    }
    for (const char *word = text;;) {
        const size_t length = strcspn(word, ",");
        if (!parse_word(option, word, length, what, err)) return false;
        if (word[length] == '\0') return true;
        word += length + 1;
    }
}

static bool wants(const writing *w, uint32_t index) {
    return (w->report->what >> index & 1u) != 0;
}

/* A sequence, or one volume that a sequence says something about. */
static bool is_sequence(const writing *w) {
    const hs_source_origin *origin = hs_source_origin_of(w->source, 0);
    return w->source->count > 1 ||
           (origin && (origin->fields.has_time || origin->fields.transform_count > 0));
}

static bool gather_fields(writing *w) {
    if (!is_sequence(w) || !hs_source_origin_of(w->source, 0)) return true;
    w->fields = calloc(w->source->count, sizeof *w->fields);
    if (!w->fields)
        return hs_fail(w->err, HS_ERR_MEMORY, "results: no memory for %u volumes", w->source->count);
    for (uint32_t i = 0; i < w->source->count; i++) w->fields[i] = hs_source_origin_of(w->source, i)->fields;
    return true;
}

static bool file_path(const writing *w, const char *name, const char *ending, char out[PATH_MAX]) {
    char file[64];
    (void)snprintf(file, sizeof file, "%s%s", name, ending);
    return hs_path_join(w->folder, file, out, PATH_MAX, w->err);
}

/* Maps have the camera's grid, volumes the source's. */
static bool open_stream(writing *w, uint32_t index) {
    const hs_volume *v = hs_source_shape(w->source);
    const bool is_map = index < 3;
    hs_result_grid grid;
    char path[PATH_MAX];
    hs_result_grid_of(&w->maps, v, &grid);
    hs_metaimage_format format = {.dims = is_sequence(w) ? 4 : 3,
                                  .pose = is_map ? &grid.pose : &v->pose,
                                  .fields = w->fields,
                                  .compress =
                                      1u << index == HS_RESULT_MASK || 1u << index == HS_RESULT_STATUS};
    const uint32_t map[4] = {w->maps.width, w->maps.height, 1, w->source->count};
    const uint32_t volume[4] = {v->nx, v->ny, v->nz, w->source->count};
    memcpy(format.size, is_map ? map : volume, sizeof map);
    memcpy(format.spacing, is_map ? grid.spacing : v->spacing, sizeof format.spacing);
    static const hs_met_type types[FILES] = {HS_MET_FLOAT, HS_MET_FLOAT, HS_MET_UCHAR, HS_MET_UCHAR,
                                             HS_MET_UCHAR};
    format.type = 1u << index == HS_RESULT_CLIPPED ? hs_result_voxels_type(w->voxels) : types[index];
    if (!file_path(w, names[index], ".mha", path)) return false;
    w->streams[index] = hs_metaimage_stream_open(path, &format, w->err);
    return w->streams[index] != NULL;
}

/* Once the first frame has told what the plugin gives. */
static bool open_files(writing *w, uint32_t wanted) {
    if (!w->maps.frame.sure) {
        if (wanted & HS_RESULT_CONFIDENCE)
            return hs_fail(w->err, HS_ERR_PLUGIN, "confidence: the plugin gave none for the first volume");
        w->report->what &= ~(uint32_t)HS_RESULT_CONFIDENCE;
    }
    if (w->report->what & HS_RESULT_CLIPPED) {
        w->voxels = hs_result_voxels_open(w->source, w->err);
        if (!w->voxels) return false;
        w->report->fill = hs_result_voxels_fill_value(w->voxels);
    }
    if (w->report->what & (HS_RESULT_CLIPPED | HS_RESULT_MASK)) {
        const size_t count = hs_volume_count(hs_source_shape(w->source));
        w->mask = malloc(count);
        if (!w->mask) return hs_fail(w->err, HS_ERR_MEMORY, "mask: no memory for %zu voxels", count);
    }
    if (!gather_fields(w)) return false;
    for (uint32_t i = 0; i < FILES; i++)
        if (wants(w, i) && !open_stream(w, i)) return false;
    return true;
}

/* -------------------------------------------------------------------------------------- one volume -- */

/* In mm from the map, which lies in the middle of the first slice. */
static bool write_depthmap(writing *w, hs_metaimage_stream *out) {
    hs_result_grid grid;
    hs_result_grid_of(&w->maps, hs_source_shape(w->source), &grid);
    const size_t rays = (size_t)w->maps.width * w->maps.height;
    float *mm = malloc(rays * sizeof *mm);
    if (!mm) return hs_fail(w->err, HS_ERR_MEMORY, "depthmap: no memory for %zu pixels", rays);
    for (size_t i = 0; i < rays; i++) mm[i] = (float)((double)w->maps.depth[i] * grid.spacing[2]);
    const bool ok = hs_metaimage_stream_write(out, mm, rays * sizeof *mm);
    free(mm);
    return ok;
}

/* A volume of a sequence without a confidence is unsure everywhere. */
static bool write_confidence(writing *w, hs_metaimage_stream *out) {
    const size_t rays = (size_t)w->maps.width * w->maps.height;
    if (w->maps.sure) return hs_metaimage_stream_write(out, w->maps.sure, rays * sizeof *w->maps.sure);
    float *none = calloc(rays, sizeof *none);
    if (!none) return hs_fail(w->err, HS_ERR_MEMORY, "confidence: no memory for %zu pixels", rays);
    const bool ok = hs_metaimage_stream_write(out, none, rays * sizeof *none);
    free(none);
    return ok;
}

static bool write_clipped(writing *w, uint32_t index, hs_metaimage_stream *out) {
    const size_t count = hs_volume_count(hs_source_shape(w->source));
    const size_t width = hs_met_type_bytes(hs_result_voxels_type(w->voxels));
    const uint8_t *fill = hs_result_voxels_fill(w->voxels);
    uint8_t *kept = malloc(HS_RESULT_CHUNK * width);
    if (!kept) return hs_fail(w->err, HS_ERR_MEMORY, "clipped: no memory");
    const uint8_t *mask = w->mask; /* open_files made it */
    bool ok = mask && hs_result_voxels_turn(w->voxels, index);
    for (size_t first = 0; ok && first < count; first += HS_RESULT_CHUNK) {
        const size_t n = count - first < HS_RESULT_CHUNK ? count - first : HS_RESULT_CHUNK;
        const uint8_t *bytes = hs_result_voxels_next(w->voxels, n);
        ok = bytes != NULL;
        for (size_t i = 0; ok && i < n; i++)
            memcpy(kept + i * width, mask[first + i] ? bytes + i * width : fill, width);
        ok = ok && hs_metaimage_stream_write(out, kept, n * width);
    }
    free(kept);
    return ok;
}

static bool write_surface(writing *w, uint32_t index) {
    char name[32], path[PATH_MAX];
    (void)snprintf(name, sizeof name, w->source->count > 1 ? "surface_%04u" : "surface", index);
    return file_path(w, name, ".ply", path) &&
           hs_result_write_surface(path, &w->maps, hs_source_shape(w->source), &w->report->surface, w->err);
}

static bool write_volume(writing *w, uint32_t index) {
    const hs_volume *volume = hs_source_shape(w->source);
    const size_t rays = (size_t)w->maps.width * w->maps.height;
    hs_metaimage_stream **out = w->streams;
    w->report->clipped += w->maps.frame.clipped;
    if (w->mask) hs_result_mask(&w->maps, volume, w->mask);
    return (!out[0] || write_depthmap(w, out[0])) && (!out[1] || write_confidence(w, out[1])) &&
           (!out[2] || hs_metaimage_stream_write(out[2], w->maps.status, rays)) &&
           (!out[3] || write_clipped(w, index, out[3])) &&
           (!out[4] || hs_metaimage_stream_write(out[4], w->mask, hs_volume_count(volume))) &&
           (!(w->report->what & HS_RESULT_SURFACE) || write_surface(w, index));
}

static bool write_all(writing *w, uint32_t wanted) {
    hs_progress progress;
    bool ok = true;
    hs_progress_begin(&progress, "results", w->source->count);
    for (uint32_t i = 0; ok && i < w->source->count; i++) {
        ok = hs_loop_maps(w->loop, i, &w->maps, w->err);
        if (ok && i == 0) ok = open_files(w, wanted);
        ok = ok && write_volume(w, i);
        hs_maps_free(&w->maps);
        hs_progress_step(&progress, i + 1u);
    }
    hs_progress_end(&progress);
    for (uint32_t i = 0; i < FILES; i++) {
        hs_metaimage_stream *stream = w->streams[i];
        if (ok && stream)
            ok = hs_metaimage_stream_close(stream);
        else
            hs_metaimage_stream_discard(stream);
    }
    return ok;
}

bool hs_results_write(hs_loop *loop, const hs_source *source, uint32_t wanted, uint32_t welcome,
                      const char *folder, hs_result_report *report, hs_error *err) {
    *report = (hs_result_report){.what = wanted | welcome, .volumes = source->count};
    if (hs_loop_get_options(loop)->orbit != 0)
        return hs_fail(err, HS_ERR_USAGE, "results: an orbit of %g degrees has no one camera",
                       hs_loop_get_options(loop)->orbit);
    writing w = {.loop = loop, .source = source, .folder = folder, .report = report, .err = err};
    const bool ok = write_all(&w, wanted);
    hs_result_voxels_close(w.voxels);
    free(w.fields);
    free(w.mask);
    return ok;
}
