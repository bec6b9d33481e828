/* SPDX-License-Identifier: MIT */
#include "result/result_voxels.h"

#include "volume/metaimage_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)HS_RESULT_CHUNK <= (int)HS_MET_CHUNK, "the file hands on that many at once");

struct hs_result_voxels {
    const hs_source *source;
    hs_error *err;
    bool from_files;
    hs_met_type type;
    uint8_t fill[8];
    double fill_value;
    hs_met_voxels *file;
    uint32_t frame;        /* of the file, invalid ones included, that comes next */
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
    v->file = hs_met_voxels_open(path, v->err);
    if (!v->file) return false;
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
    for (; v->frame < h->frames && is_invalid(h, v->frame); v->frame++)
        if (!hs_met_voxels_skip(v->file, volume_voxels(v))) return false;
    if (v->frame == h->frames)
        return hs_fail(v->err, HS_ERR_INPUT, "%s: has fewer volumes than before: the file changed",
                       origin->path);
    v->frame++;
    return true;
}

const uint8_t *hs_result_voxels_next(hs_result_voxels *v, size_t count) {
    const uint8_t *bytes = v->memory;
    if (!v->from_files)
        v->memory += count;
    else if (!hs_met_voxels_read(v->file, count, &bytes))
        return NULL;
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
            const uint8_t *raw;
            const double *value = hs_met_voxels_read(v->file, n, &raw);
            if (!value) return false;
            for (size_t i = 0; i < n; i++) {
                if (!(value[i] < v->fill_value)) continue;
                v->fill_value = value[i];
                memcpy(v->fill, raw + i * width, width);
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
    hs_result_voxels *v = calloc(1, sizeof *v);
    if (!v) {
        (void)hs_fail(err, HS_ERR_MEMORY, "results: no memory");
        return NULL;
    }
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

hs_met_type hs_result_voxels_type(const hs_result_voxels *v) {
    return v->type;
}

const uint8_t *hs_result_voxels_fill(const hs_result_voxels *v) {
    return v->fill;
}

double hs_result_voxels_fill_value(const hs_result_voxels *v) {
    return v->fill_value;
}
