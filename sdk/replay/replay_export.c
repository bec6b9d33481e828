/* SPDX-License-Identifier: MIT */
/* A frame as two MetaImage files that host_sim run draws: the volume, and the map that was played. */
#include "core/output_file.h"
#include "core/paths.h"
#include "core/system.h"
#include "core/text.h"
#include "replay/replay.h"

#include <stdio.h>
#include <stdlib.h>

#define SQUARE_VOXELS (UINT64_C(1) << 24) /* that a volume may have beside four times those of the frame */

/* The recorded volume is camera-aligned already. The machine's maps are square, so it lies in the middle of a
 * square of `side` rays. */
typedef struct {
    const rp_frame *frame;
    uint32_t side, left, top;
    double mm[2]; /* of a pixel, of a slice; 1 where the host told none */
} square;

/* The voxel as host_sim reads it: 0 is not scanned, and nothing else is 0. */
static uint8_t voxel_of(const rp_frame *frame, size_t ray, uint32_t z, uint8_t value) {
    const sv_scanned all = {0, UINT16_MAX}, range = frame->ranges ? frame->ranges[ray] : all;
    if (value == frame->format.padding_value || z < range.first || z >= range.end) return 0;
    return value ? value : 1;
}

/* The ray of the frame at a pixel of the square; false beside it. */
static bool ray_at(const square *s, size_t pixel, size_t *ray) {
    const size_t x = pixel % s->side - s->left, y = pixel / s->side - s->top; /* beside it: wraps round */
    if (x >= s->frame->format.width || y >= s->frame->format.height) return false;
    *ray = y * s->frame->format.width + x;
    return true;
}

static bool begin_file(hs_output_file *file, const char *folder, const char *name, const square *s,
                       uint32_t slices, const char *type, hs_error *err) {
    char path[SYS_PATH];
    if (!hs_path_join(folder, name, path, sizeof path, err) || !hs_output_open(file, path, err)) return false;
    (void)fprintf(
        file->file,
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
        "DimSize = %u %u %u\nElementSpacing = %.9g %.9g %.9g\nElementType = %s\nElementDataFile = LOCAL\n",
        s->side, s->side, slices, s->mm[0], s->mm[0], s->mm[1], type);
    return true;
}

/* Ends a file whose contents were made. */
static bool end_file(hs_output_file *file, bool ok, hs_error *err) {
    if (ok) return hs_output_commit(file, err);
    hs_output_discard(file);
    return false;
}

static bool write_volume(const square *s, const char *folder, hs_error *err) {
    const sv_format *f = &s->frame->format;
    const size_t pixels = (size_t)s->side * s->side, slice = (size_t)f->width * f->height;
    uint8_t *row = malloc(pixels);
    hs_output_file file = {0};
    size_t ray;
    bool ok = row || hs_fail(err, HS_ERR_MEMORY, "volume.mha: no memory for %zu pixels", pixels);
    ok = ok && begin_file(&file, folder, "volume.mha", s, f->slices, "MET_UCHAR", err);
    for (uint32_t z = 0; ok && z < f->slices; z++) {
        for (size_t p = 0; p < pixels; p++)
            row[p] = ray_at(s, p, &ray) ? voxel_of(s->frame, ray, z, s->frame->voxels[z * slice + ray]) : 0;
        ok = hs_output_write(&file, row, pixels, err);
    }
    free(row);
    return end_file(&file, ok, err);
}

/* As --map takes it: mm from the volume's front, which lies half a slice before the middle of the first one.
 */
static bool write_map(const square *s, const char *folder, hs_error *err) {
    const bool clips = s->frame->outcome == SV_OK || s->frame->outcome == SV_PARTIAL;
    hs_output_file file = {0};
    size_t ray;
    bool ok = begin_file(&file, folder, "map.mha", s, 1, "MET_FLOAT", err);
    for (size_t p = 0; ok && p < (size_t)s->side * s->side; p++) {
        const float depth = clips && ray_at(s, p, &ray) ? s->frame->depth[ray] : 0.0f;
        const float mm = depth > 0.0f ? (depth + 0.5f) * (float)s->mm[1] : 0.0f;
        ok = hs_output_write(&file, &mm, sizeof mm, err);
    }
    return end_file(&file, ok, err);
}

/* A recording may say anything: a square for a frame of one row would take the memory of many. */
static bool make_square(square *s, const rp_frame *frame, hs_error *err) {
    const sv_format *f = &frame->format;
    const uint32_t side = f->width > f->height ? f->width : f->height;
    const uint64_t voxels = (uint64_t)f->width * f->height * f->slices;
    const bool told = f->spacing_mm[2] > 0.0f;
    *s = (square){frame, side, (side - f->width) / 2, (side - f->height) / 2, {1.0, 1.0}};
    if (told) s->mm[0] = (double)f->spacing_mm[0], s->mm[1] = (double)f->spacing_mm[2];
    return (uint64_t)side * side * f->slices <= SQUARE_VOXELS + 4 * voxels ||
           hs_fail(err, HS_ERR_INPUT, "--out: files are square, and %u x %u rays are not nearly", f->width,
                   f->height);
}

bool rp_export(const rp_options *o, const rp_report *report, hs_error *err) {
    square s;
    if (!report->drawn.voxels)
        return hs_fail(err, HS_ERR_INPUT, "%s: there is no frame %s with voxels and a map", o->file,
                       o->frame == RP_LAST ? "at all" : "of that number");
    if (!make_square(&s, &report->drawn, err) || !hs_path_make_folder(o->out, err) ||
        !write_volume(&s, o->out, err) || !write_map(&s, o->out, err))
        return false;
    hs_print(stdout,
             "frame %u is in %s; to draw it: host_sim run --volume %s/volume.mha --probe -z --map %s/map.mha "
             "--lowres %u --setting smartvis --frames 1\n",
             report->drawn.number, o->out, o->out, o->out, s.side);
    return true;
}
