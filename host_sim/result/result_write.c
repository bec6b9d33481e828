/* SPDX-License-Identifier: MIT */
#include "result/result_write.h"

#include "core/paths.h"
#include "core/progress.h"
#include "core/system.h"
#include "volume/metaimage_parts.h"
#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)HS_RESULT_CHUNK <= (int)HS_MET_CHUNK, "the file hands on that many at once");

struct hs_result_voxels {
    const hs_source *source;
    hs_error *err;
    bool from_files;
    hs_met_type type;
    /* What stands for a voxel that was cut away: 0 in MET_UCHAR, else the smallest value of all volumes, so
     * that what is black stays black. */
    uint8_t fill[8];
    double fill_value;
    hs_met_voxels *file;
    uint32_t frame; /* of the file, invalid ones included, that comes next, */
    uint64_t at;    /* and its next voxel */
    hs_met_room room;
    const uint8_t *memory; /* the volume's next voxel */
};

static size_t volume_voxels(const hs_result_voxels *v) {
    return hs_volume_count(hs_source_shape(v->source));
}

static bool is_invalid(const hs_met_header *h, uint32_t frame) {
    return h->fields && h->fields[frame].invalid;
}

/* Opens the file that begins with volume `index` of the source. It was read before, but files change. */
static bool open_file(hs_result_voxels *v, uint32_t index) {
    const char *path = hs_source_origin_of(v->source, index)->path;
    const hs_volume *like = hs_source_shape(v->source);
    hs_met_voxels_close(v->file);
    v->frame = 0;
    v->file = hs_met_voxels_open(path, NULL, v->err);
    if (!v->file) return false;
    hs_met_voxels_allow_gaps(v->file);
    const hs_met_header *h = hs_met_voxels_header(v->file);
    if (h->size[0] != like->nx || h->size[1] != like->ny || h->size[2] != like->nz)
        return hs_fail(v->err, HS_ERR_INPUT,
                       "%s: DimSize is %s, and was another one before: the file changed", path, h->size_text);
    if (index == 0) v->type = h->type;
    return h->type == v->type ||
           hs_fail(v->err, HS_ERR_INPUT,
                   "%s: ElementType is %s, but %s has %s: a clipped sequence has one type", path,
                   hs_met_type_name(h->type), hs_source_origin_of(v->source, 0)->path,
                   hs_met_type_name(v->type));
}

bool hs_result_voxels_turn(hs_result_voxels *v, uint32_t index) {
    if (!v->from_files) {
        const hs_volume *volume = hs_source_bring(v->source, index, v->err);
        v->memory = volume ? volume->voxels : NULL;
        return volume != NULL;
    }
    const hs_source_origin *origin = hs_source_origin_of(v->source, index);
    if (origin->index == 0 && !open_file(v, index)) return false;
    const hs_met_header *h = hs_met_voxels_header(v->file);
    while (v->frame < h->frames && is_invalid(h, v->frame)) v->frame++;
    if (v->frame == h->frames)
        return hs_fail(v->err, HS_ERR_INPUT, "%s: has fewer volumes than before: the file changed",
                       origin->path);
    v->at = v->frame++ * (uint64_t)volume_voxels(v);
    return true;
}

const uint8_t *hs_result_voxels_next(hs_result_voxels *v, size_t count) {
    const uint8_t *bytes = v->from_files ? v->room.raw : v->memory;
    if (!v->from_files) v->memory += count;
    if (v->from_files && !hs_met_voxels_read_at(v->file, v->at, count, &v->room, v->err)) return NULL;
    v->at += count;
    return bytes;
}

/* The smallest value of all volumes, bit by bit as the files have it. */
static bool find_fill(hs_result_voxels *v) {
    const size_t count = volume_voxels(v), width = hs_met_type_bytes(v->type);
    v->fill_value = INFINITY;
    for (uint32_t index = 0; index < v->source->count; index++) {
        if (!hs_result_voxels_turn(v, index)) return false;
        for (size_t first = 0; first < count; first += HS_MET_CHUNK) {
            const size_t n = count - first < HS_MET_CHUNK ? count - first : HS_MET_CHUNK;
            if (!hs_result_voxels_next(v, n)) return false;
            for (size_t i = 0; i < n; i++) {
                const double value = v->room.value[i];
                if (!(value < v->fill_value) || !isfinite(value)) continue;
                v->fill_value = value;
                memcpy(v->fill, v->room.raw + i * width, width);
            }
        }
    }
    return true;
}

/* A Kretz file holds beams: what is clipped of it is its Cartesian copy, or its voxels as they were read. */
static bool all_from_metaimage(const hs_source *source) {
    if (!hs_source_origin_of(source, 0)) return false;
    for (uint32_t i = 0; i < source->count; i++)
        if (!hs_source_origin_of(source, i)->metaimage) return false;
    return true;
}

hs_result_voxels *hs_result_voxels_open(const hs_source *source, hs_error *err) {
    hs_result_voxels *v = hs_memory(1, sizeof *v, "results", err);
    if (!v) return NULL;
    v->source = source;
    v->err = err;
    v->type = HS_MET_UCHAR;
    bool ok = true;
    v->from_files = all_from_metaimage(source);
    if (v->from_files) ok = open_file(v, 0) && (v->type == HS_MET_UCHAR || find_fill(v));
    if (ok) return v;
    hs_result_voxels_close(v);
    return NULL;
}

void hs_result_voxels_close(hs_result_voxels *v) {
    if (!v) return;
    hs_met_voxels_close(v->file);
    free(v);
}

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
    w->fields = hs_memory(w->source->count, sizeof *w->fields, "results", w->err);
    if (!w->fields) return false;
    for (uint32_t i = 0; i < w->source->count; i++) w->fields[i] = hs_source_origin_of(w->source, i)->fields;
    return true;
}

static bool file_path(const writing *w, const char *name, const char *ending, char out[SYS_PATH]) {
    char file[64];
    (void)snprintf(file, sizeof file, "%s%s", name, ending);
    return hs_path_join(w->folder, file, out, SYS_PATH, w->err);
}

/* Maps have the camera's grid, volumes the source's. */
static bool open_stream(writing *w, uint32_t index) {
    const hs_volume *v = hs_source_shape(w->source);
    const bool is_map = index < 3;
    hs_result_grid grid;
    char path[SYS_PATH];
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
    format.spacing_unsaid = v->spacing_unsaid;
    static const hs_met_type types[FILES] = {HS_MET_FLOAT, HS_MET_FLOAT, HS_MET_UCHAR, HS_MET_UCHAR,
                                             HS_MET_UCHAR};
    format.type = 1u << index == HS_RESULT_CLIPPED ? w->voxels->type : types[index];
    if (!file_path(w, names[index], ".mha", path)) return false;
    w->streams[index] = hs_metaimage_stream_open(path, &format, w->err);
    return w->streams[index] != NULL;
}

/* Once the first frame has told what the plugin gives. */
static bool open_files(writing *w, uint32_t wanted) {
    if (!w->maps.frame.has_confidence) {
        /* Where nothing is clipped there is nothing to be sure of. */
        const bool unclipped = w->maps.frame.outcome == SV_NO_SURFACE;
        if (wanted & HS_RESULT_CONFIDENCE && !unclipped)
            return hs_fail(w->err, HS_ERR_PLUGIN, "confidence: the plugin gave none for the first volume");
        if (!(wanted & HS_RESULT_CONFIDENCE)) w->report->what &= ~(uint32_t)HS_RESULT_CONFIDENCE;
    }
    if (w->report->what & HS_RESULT_CLIPPED) {
        w->voxels = hs_result_voxels_open(w->source, w->err);
        if (!w->voxels) return false;
        w->report->fill = w->voxels->fill_value;
    }
    if (w->report->what & (HS_RESULT_CLIPPED | HS_RESULT_MASK)) {
        const size_t count = hs_volume_count(hs_source_shape(w->source));
        w->mask = hs_memory(1, count, "mask", w->err);
        if (!w->mask) return false;
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
    float *mm = hs_memory(rays, sizeof *mm, "depthmap", w->err);
    if (!mm) return false;
    for (size_t i = 0; i < rays; i++) mm[i] = (float)((double)w->maps.depth[i] * grid.spacing[2]);
    const bool ok = hs_metaimage_stream_write(out, mm, rays * sizeof *mm);
    free(mm);
    return ok;
}

/* A volume of a sequence without a confidence is unsure everywhere. */
static bool write_confidence(writing *w, hs_metaimage_stream *out) {
    const size_t rays = (size_t)w->maps.width * w->maps.height;
    if (w->maps.confidence)
        return hs_metaimage_stream_write(out, w->maps.confidence, rays * sizeof *w->maps.confidence);
    float *none = hs_memory(rays, sizeof *none, "confidence", w->err);
    if (!none) return false;
    const bool ok = hs_metaimage_stream_write(out, none, rays * sizeof *none);
    free(none);
    return ok;
}

static bool write_clipped(writing *w, uint32_t index, hs_metaimage_stream *out) {
    const size_t count = hs_volume_count(hs_source_shape(w->source));
    const size_t width = hs_met_type_bytes(w->voxels->type);
    const uint8_t *fill = w->voxels->fill;
    uint8_t *kept = hs_memory(1, HS_RESULT_CHUNK * width, "clipped", w->err);
    if (!kept) return false;
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
    char name[32], path[SYS_PATH];
    (void)snprintf(name, sizeof name, w->source->count > 1 ? "surface_%04u" : "surface", index);
    return file_path(w, name, ".ply", path) &&
           hs_result_write_surface(path, &w->maps, hs_source_shape(w->source), &w->source->crop,
                                   &w->report->surface, w->err);
}

static bool write_volume(writing *w, uint32_t index) {
    const hs_volume *volume = hs_source_shape(w->source);
    const size_t rays = (size_t)w->maps.width * w->maps.height;
    hs_metaimage_stream **out = w->streams;
    w->report->clipped += w->maps.frame.clipped;
    if (w->mask) hs_result_mask(&w->maps, volume, w->mask);
    if (w->mask && w->source->crop.used) hs_crop_apply(&w->source->crop, volume, w->mask);
    hs_maps_crop(&w->maps, w->source); /* behind the mask, which has depths between rays */
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
    writing w = {.loop = loop, .source = source, .folder = folder, .report = report, .err = err};
    const bool ok = write_all(&w, wanted);
    hs_result_voxels_close(w.voxels);
    free(w.fields);
    free(w.mask);
    return ok;
}
