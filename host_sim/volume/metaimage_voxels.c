/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_voxels.h"

#include "volume/metaimage_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct hs_met_voxels {
    const char *path;
    hs_error *err;
    hs_met_header header;
    hs_met_data *data;
    size_t at; /* the next voxel, counted from the file's first */
    uint8_t raw[HS_MET_CHUNK * 8];
    double value[HS_MET_CHUNK];
};

static void swap_bytes(uint8_t *bytes, size_t count, size_t width) {
    for (size_t i = 0; i < count; i++) {
        for (size_t low = 0, high = width - 1; low < high; low++, high--) {
            const uint8_t kept = bytes[i * width + low];
            bytes[i * width + low] = bytes[i * width + high];
            bytes[i * width + high] = kept;
        }
    }
}

/* memcpy, since the bytes need not be aligned for the type. */
#define DECODE(type)                                                                                         \
    for (size_t i = 0; i < count; i++) {                                                                     \
        type v;                                                                                              \
        memcpy(&v, raw + i * sizeof v, sizeof v);                                                            \
        value[i] = (double)v;                                                                                \
    }                                                                                                        \
    break

static void decode(hs_met_type type, const uint8_t *raw, size_t count, double *value) {
    switch (type) {
    case HS_MET_CHAR:
        DECODE(int8_t);
    case HS_MET_UCHAR:
        DECODE(uint8_t);
    case HS_MET_SHORT:
        DECODE(int16_t);
    case HS_MET_USHORT:
        DECODE(uint16_t);
    case HS_MET_INT:
        DECODE(int32_t);
    case HS_MET_UINT:
        DECODE(uint32_t);
    case HS_MET_LONG_LONG:
        DECODE(int64_t);
    case HS_MET_ULONG_LONG:
        DECODE(uint64_t);
    case HS_MET_FLOAT:
        DECODE(float);
    case HS_MET_DOUBLE:
        DECODE(double);
    case HS_MET_TYPES:
        break;
    }
}

hs_met_voxels *hs_met_voxels_open(const char *path, hs_error *err) {
    hs_met_voxels *v = calloc(1, sizeof *v);
    if (!v) {
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the file", path);
        return NULL;
    }
    v->path = path;
    v->err = err;
    if (hs_met_header_read(path, &v->header, err)) v->data = hs_met_data_open(path, &v->header, err);
    if (v->data) return v;
    hs_met_voxels_close(v);
    return NULL;
}

void hs_met_voxels_close(hs_met_voxels *v) {
    if (!v) return;
    hs_met_data_close(v->data);
    hs_met_header_free(&v->header);
    free(v);
}

void hs_met_voxels_report_to(hs_met_voxels *v, hs_error *err) {
    v->err = err;
}

const hs_met_header *hs_met_voxels_header(const hs_met_voxels *v) {
    return &v->header;
}

/* Names the first of the last `count` voxels that is no number. */
static bool all_finite(const hs_met_voxels *v, size_t count) {
    const hs_met_header *h = &v->header;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(v->value[i])) continue;
        const size_t volume = (size_t)h->size[0] * h->size[1] * h->size[2];
        const size_t all = v->at + i, at = all % volume, nx = h->size[0], ny = h->size[1];
        char which[40] = "";
        if (h->frames > 1) (void)snprintf(which, sizeof which, " of volume %zu", all / volume);
        return hs_fail(
            v->err, HS_ERR_INPUT,
            "%s:%u: ElementDataFile '%s': voxel (%zu, %zu, %zu)%s is '%g', expected a finite number", v->path,
            h->data_line, h->data_name, at % nx, at / nx % ny, at / nx / ny, which, v->value[i]);
    }
    return true;
}

const double *hs_met_voxels_read(hs_met_voxels *v, size_t count, const uint8_t **raw) {
    const hs_met_header *h = &v->header;
    if (!hs_met_data_read(v->data, v->raw, count * h->element_bytes, v->err)) return NULL;
    const bool host_is_big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    if (h->big_endian != host_is_big) swap_bytes(v->raw, count, h->element_bytes);
    decode(h->type, v->raw, count, v->value);
    if ((h->type == HS_MET_FLOAT || h->type == HS_MET_DOUBLE) && !all_finite(v, count)) return NULL;
    v->at += count;
    if (raw) *raw = v->raw;
    return v->value;
}

bool hs_met_voxels_take(hs_met_voxels *v, size_t count, uint8_t *out) {
    v->at += count;
    return hs_met_data_read(v->data, out, count, v->err);
}

bool hs_met_voxels_skip(hs_met_voxels *v, size_t count) {
    return hs_met_voxels_seek(v, v->at + count);
}

bool hs_met_voxels_seek(hs_met_voxels *v, uint64_t at) {
    v->at = (size_t)at;
    return hs_met_data_seek(v->data, at * v->header.element_bytes, v->err);
}

bool hs_met_voxels_finish(hs_met_voxels *v) {
    return hs_met_data_finish(v->data, v->err);
}
