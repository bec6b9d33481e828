/* SPDX-License-Identifier: MIT */
#include "loop/sequence.h"

#include "volume/metaimage.h"

#include <stdlib.h>
#include <string.h>

/* An open file, MetaImage or Kretz: one of the two, or none. Owned. */
typedef struct {
    hs_kretz *kretz;
    hs_metaimage *metaimage;
} sequence_file;

/* What only MetaImage files take must not be asked of others in vain. */
static bool check_kretz(const char *path, const hs_source_files *how, hs_error *err) {
    if (how->metaimage.scanned[0])
        return hs_fail(err, HS_ERR_USAGE,
                       "%s: a Kretz file says itself what was scanned, maps of it were given", path);
    if (how->metaimage.has_probe)
        return hs_fail(err, HS_ERR_USAGE, "%s: a Kretz file says itself where the probe is, %s was given",
                       path, hs_probe_name(how->metaimage.probe));
    if (how->metaimage.has_spacing)
        return hs_fail(err, HS_ERR_USAGE, "%s: a Kretz file says itself how large it is, --spacing was given",
                       path);
    return !how->metaimage.has_window ||
           hs_fail(err, HS_ERR_USAGE, "%s: a window was given, but a Kretz file has 8 bits", path);
}

/* Opens a MetaImage (.mha, .mhd) or Kretz file (.vol); `path` must outlive it. On failure nothing is open:
 * HS_ERR_INPUT if it cannot be read, HS_ERR_USAGE for a window, maps or a probe for a Kretz file, and the
 * errors of hs_metaimage_open and hs_kretz_open. */
static bool file_open(sequence_file *file, const char *path, const hs_source_files *how, hs_error *err) {
    *file = (sequence_file){0};
    if (hs_kretz_is_file(path)) {
        hs_kretz_options options = how->kretz;
        options.padding = how->metaimage.padding;
        options.folder = how->metaimage.folder;
        file->kretz = check_kretz(path, how, err) ? hs_kretz_open(path, &options, err) : NULL;
        return file->kretz != NULL;
    }
    file->metaimage = hs_metaimage_open(path, &how->metaimage, err);
    return file->metaimage != NULL;
}

/* Volumes in it, without those that are invalid. */
static uint32_t file_count(const sequence_file *file) {
    return file->kretz ? hs_kretz_count(file->kretz) : hs_metaimage_volumes(file->metaimage);
}

/* What hs_metaimage_shape and hs_kretz_shape say. Free it with hs_volume_free. */
static bool file_shape(const sequence_file *file, hs_volume *shape, hs_error *err) {
    if (file->kretz) return hs_kretz_shape(file->kretz, shape, err);
    hs_metaimage_shape(file->metaimage, shape);
    return true;
}

/* Reads volume `index` (0 .. count - 1). A zeroed `volume` is made, one that an earlier call made of a file
 * of the same shape is filled again; the errors are those of hs_kretz_read or hs_metaimage_read_at, and after
 * them a volume that was to be made is zeroed. One thread at a time. */
static bool file_read(sequence_file *file, uint32_t index, hs_volume *volume, hs_error *err) {
    if (file->kretz) return hs_kretz_read(file->kretz, index, volume, err);
    return hs_metaimage_read_at(file->metaimage, index, volume, err);
}

/* Safe if none is open. */
static void file_close(sequence_file *file) {
    hs_kretz_close(file->kretz);
    hs_metaimage_close(file->metaimage);
    *file = (sequence_file){0};
}

/* A file, and what must not change until it is opened again. */
typedef struct {
    const char *path;
    uint32_t first, volumes; /* in the sequence */
    bool mapped;             /* to 8 bit, from ... */
    double low, high;
    hs_pose pose;
    char name[256];
} part;

struct hs_sequence {
    hs_source_files how;
    part *parts;
    hs_source_origin *origins;
    uint32_t count, left_out;
    hs_volume shape; /* of all volumes; without voxels */
    sequence_file file;
    const part *open; /* what `file` is; NULL: none is open */
};

/* ------------------------------------------------------------------------------------------ all alike -- */

static bool same_table(const double *a, const double *b, uint32_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static bool same_beams(const hs_beams *a, const hs_beams *b) {
    if (!a || !b) return a == b;
    return a->samples == b->samples && a->lines == b->lines && a->planes == b->planes &&
           a->pitch == b->pitch && a->start == b->start && a->axis == b->axis &&
           same_table(a->theta, b->theta, a->lines) && same_table(a->phi, b->phi, a->planes);
}

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
    return same_beams(first->beams, other->beams) ||
           hs_fail(err, HS_ERR_INPUT, "%s: was scanned in another geometry than %s: a sequence has one", path,
                   first_path);
}

/* ------------------------------------------------------------------------------------------- one file -- */

/* What is known of the volumes of the file that is open, behind that of those before. */
static bool note_origins(hs_sequence *s, const part *p, hs_error *err) {
    const size_t count = (size_t)s->count + p->volumes;
    hs_source_origin *origins = count <= UINT32_MAX ? realloc(s->origins, count * sizeof *origins) : NULL;
    if (!origins) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu volumes", p->path, count);
    s->origins = origins;
    const hs_metaimage *file = s->file.metaimage;
    for (uint32_t i = 0; i < p->volumes; i++) {
        const hs_frame_fields *said = file ? hs_metaimage_fields(file, i) : NULL;
        hs_source_origin *origin = &origins[s->count + i];
        *origin = (hs_source_origin){.path = p->path, .metaimage = file != NULL, .index = i};
        if (said) origin->fields = *said;
    }
    s->count = (uint32_t)count;
    if (file) s->left_out += hs_metaimage_left_out(file);
    return true;
}

/* Takes the shape of the file that is open for that of the sequence if it is the first; else they must
 * agree. */
static bool note_shape(hs_sequence *s, part *p, hs_error *err) {
    hs_volume shape;
    if (!file_shape(&s->file, &shape, err)) return false;
    p->pose = shape.pose;
    memcpy(p->name, shape.name, sizeof p->name);
    if (p == s->parts) {
        s->shape = shape;
        return true;
    }
    const bool same = same_grid(&s->shape, &shape, s->parts->path, p->path, err);
    hs_volume_free(&shape);
    return same;
}

static bool add_file(hs_sequence *s, part *p, hs_error *err) {
    hs_sequence_stop_reading(s);
    if (!file_open(&s->file, p->path, &s->how, err)) return false;
    s->open = p;
    p->first = s->count;
    p->volumes = file_count(&s->file);
    p->mapped = s->file.metaimage && hs_metaimage_range(s->file.metaimage, &p->low, &p->high);
    return note_shape(s, p, err) && note_origins(s, p, err);
}

/* Opens a file once more. Its range is known already. */
static bool open_again(hs_sequence *s, const part *p, hs_error *err) {
    hs_source_files how = s->how;
    double low, high;
    hs_volume shape;
    hs_sequence_stop_reading(s);
    if (p->mapped) {
        how.metaimage.has_window = true;
        how.metaimage.window_low = p->low;
        how.metaimage.window_high = p->high;
    }
    if (!file_open(&s->file, p->path, &how, err)) return false;
    s->open = p;
    const bool mapped = s->file.metaimage && hs_metaimage_range(s->file.metaimage, &low, &high);
    bool ok = file_shape(&s->file, &shape, err);
    if (ok) {
        ok = (file_count(&s->file) == p->volumes && mapped == p->mapped &&
              same_grid(&s->shape, &shape, p->path, p->path, &(hs_error){0})) ||
             hs_fail(err, HS_ERR_INPUT, "%s: is not as it was before: the file changed", p->path);
        hs_volume_free(&shape);
    }
    if (!ok) hs_sequence_stop_reading(s);
    return ok;
}

/* ---------------------------------------------------------------------------------------- all of them -- */

hs_sequence *hs_sequence_open(const char *const *paths, uint32_t count, const hs_source_files *how,
                              hs_error *err) {
    hs_sequence *s = calloc(1, sizeof *s);
    if (s) s->parts = calloc(count, sizeof *s->parts);
    bool ok = (s && s->parts) || hs_fail(err, HS_ERR_MEMORY, "sequence: no memory for %u files", count);
    if (ok) s->how = *how;
    for (uint32_t i = 0; ok && i < count; i++) {
        s->parts[i].path = paths[i];
        ok = add_file(s, &s->parts[i], err);
    }
    if (ok) return s;
    hs_sequence_close(s);
    return NULL;
}

void hs_sequence_stop_reading(hs_sequence *s) {
    file_close(&s->file);
    s->open = NULL;
}

void hs_sequence_close(hs_sequence *s) {
    if (!s) return;
    hs_sequence_stop_reading(s);
    hs_volume_free(&s->shape);
    free(s->parts);
    free(s->origins);
    free(s);
}

uint32_t hs_sequence_count(const hs_sequence *s) {
    return s->count;
}

uint32_t hs_sequence_left_out(const hs_sequence *s) {
    return s->left_out;
}

const hs_source_origin *hs_sequence_origins(const hs_sequence *s) {
    return s->origins;
}

const hs_levels *hs_sequence_levels(const hs_sequence *s) {
    return s->file.metaimage ? hs_metaimage_levels(s->file.metaimage) : NULL;
}

bool hs_sequence_read(hs_sequence *s, uint32_t index, hs_volume *volume, hs_error *err) {
    const part *p = s->parts;
    while (index - p->first >= p->volumes) p++;
    if (s->open != p && !open_again(s, p, err)) return false;
    if (!file_read(&s->file, index - p->first, volume, err)) return false;
    volume->pose = p->pose;
    memcpy(volume->name, p->name, sizeof p->name);
    return true;
}
