/* SPDX-License-Identifier: MIT */
#include "volume/kretz.h"

#include "core/input_file.h"
#include "volume/kretz_parts.h"
#include "volume/volume.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct hs_kretz {
    hs_kretz_items items;
    hs_kretz_header header;
    hs_kretz_options options;
    char path[4096];
};

static bool is_content(const char *path) {
    uint8_t head[HS_KRETZ_HEAD_BYTES] = {0};
    uint64_t bytes = 0;
    hs_error unused = {0};
    FILE *file = hs_input_open(path, path, &bytes, &unused);
    if (!file) return false;
    const size_t read = fread(head, 1, sizeof head, file);
    (void)fclose(file);
    return memcmp(head, HS_KRETZ_MAGIC, HS_KRETZ_MAGIC_BYTES) == 0 || hs_kretz_is_dicom(head, read);
}

bool hs_kretz_is_name(const char *name) {
    static const char *const endings[] = {".vol", ".v00", ".v01", ".v02", ".v03", ".v04", ".v05"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof endings[0]; i++)
        if (strcasecmp(dot, endings[i]) == 0) return true;
    return false;
}

bool hs_kretz_is_file(const char *path) {
    return hs_kretz_is_name(path) || is_content(path);
}

hs_kretz *hs_kretz_open(const char *path, const hs_kretz_options *options, hs_error *err) {
    hs_kretz *kretz = calloc(1, sizeof *kretz);
    if (!kretz || strlen(path) >= sizeof kretz->path) {
        (void)hs_fail(err, kretz ? HS_ERR_INPUT : HS_ERR_MEMORY, "%.200s: %s", path,
                      kretz ? "the path is too long" : "no memory to read the file");
        free(kretz);
        return NULL;
    }
    strcpy(kretz->path, path);
    if (options) kretz->options = *options;
    if (hs_kretz_items_open(&kretz->items, kretz->path, kretz->options.folder, err) &&
        hs_kretz_header_read(&kretz->items, &kretz->header, err)) {
        kretz->header.beams.mirrored = kretz->options.mirrored;
        return kretz;
    }
    hs_kretz_close(kretz);
    return NULL;
}

void hs_kretz_close(hs_kretz *kretz) {
    if (!kretz) return;
    hs_kretz_header_free(&kretz->header);
    hs_kretz_items_close(&kretz->items);
    free(kretz);
}

uint32_t hs_kretz_count(const hs_kretz *kretz) {
    return kretz->header.count;
}

static bool read_bytes(const hs_kretz *kretz, uint32_t index, uint8_t *voxels, hs_error *err) {
    const uint32_t *size = kretz->header.size;
    const size_t bytes = (size_t)size[0] * size[1] * size[2];
    return hs_kretz_items_read(&kretz->items, kretz->header.voxels + (uint64_t)index * bytes, voxels, bytes,
                               err);
}

static bool make(const hs_kretz *kretz, hs_volume *volume, hs_error *err) {
    const hs_kretz_header *h = &kretz->header;
    if (h->cartesian) {
        if (!hs_volume_init(volume, h->size[0], h->size[1], h->size[2], err)) return false;
        for (int a = 0; a < 3; a++) volume->spacing[a] = h->spacing;
    } else {
        hs_beams *beams = hs_beams_like(&h->beams, err);
        if (!beams) return false;
        if (!hs_beams_cartesian_init(volume, beams, kretz->options.spacing, err)) {
            hs_beams_free(beams);
            return false;
        }
    }
    hs_volume_scanned_from(volume, HS_PROBE_LOW_Z);
    const char *slash = strrchr(kretz->path, '/');
    (void)snprintf(volume->name, sizeof volume->name, "%.255s", slash ? slash + 1 : kretz->path);
    return true;
}

bool hs_kretz_shape(const hs_kretz *kretz, hs_volume *shape, hs_error *err) {
    *shape = (hs_volume){0};
    if (!make(kretz, shape, err)) return false;
    free(shape->voxels);
    shape->voxels = NULL;
    if (!shape->beams) return true;
    free(shape->beams->voxels);
    shape->beams->voxels = NULL;
    return true;
}

static bool mark(const hs_kretz *kretz, hs_volume *volume, hs_error *err) {
    switch (kretz->options.padding) {
    case HS_PADDING_AUTO:
        return hs_volume_mark_unscanned(volume, err);
    case HS_PADDING_NONE:
        hs_volume_mark_all_scanned(volume);
        return true;
    default:
        return true;
    }
}

bool hs_kretz_read(const hs_kretz *kretz, uint32_t index, hs_volume *volume, hs_error *err) {
    const bool fresh = volume->voxels == NULL;
    if (fresh && !make(kretz, volume, err)) return false;
    bool ok = read_bytes(kretz, index, volume->beams ? volume->beams->voxels : volume->voxels, err);
    if (ok && volume->beams)
        hs_beams_cartesian_fill(volume);
    else if (ok)
        ok = mark(kretz, volume, err);
    if (!ok && fresh) hs_volume_free(volume);
    return ok;
}
