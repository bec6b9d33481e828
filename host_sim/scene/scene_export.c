/* SPDX-License-Identifier: MIT */
/* Scenes as MetaImage files, and sampled along beams as Kretz files. */
#include "scene/scene_export.h"

#include "core/threads.h"
#include "volume/metaimage_write.h"
#include "volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool file_path(char path[1100], const char *prefix, const char *what, const char *ending,
                      hs_error *err) {
    const int length = snprintf(path, 1100, "%s_%s.%s", prefix, what, ending);
    return (length >= 0 && length < 1100) ||
           hs_fail(err, HS_ERR_OUTPUT, "%.200s...: the path is too long", prefix);
}

/* A map is one slice: what reads volumes reads it, too. */
static bool write_slices(const char *prefix, const char *what, const hs_volume *volume, hs_met_type type,
                         const void *data, uint32_t slices, hs_error *err) {
    char path[1100];
    const hs_metaimage_format format = {
        .type = type,
        .dims = 3,
        .size = {volume->nx, volume->ny, slices},
        .spacing = {volume->spacing[0], volume->spacing[1], volume->spacing[2]},
        .compress = true,
        .pose = &volume->pose};
    return file_path(path, prefix, what, "mha", err) && hs_metaimage_write(path, &format, data, err);
}

/* Readers differ in what they make of NaN: -1 says "no interval" in the file. */
static bool write_depths(const char *prefix, const char *what, const hs_volume *volume, const float *depth,
                         hs_error *err) {
    size_t count = (size_t)volume->nx * volume->ny;
    float *copy = malloc(count * sizeof *copy);
    if (!copy) return hs_fail(err, HS_ERR_MEMORY, "%s_%s.mha: no memory for %zu pixels", prefix, what, count);
    for (size_t i = 0; i < count; i++) copy[i] = isnan(depth[i]) ? -1.0f : depth[i];
    bool ok = write_slices(prefix, what, volume, HS_MET_FLOAT, copy, 1, err);
    free(copy);
    return ok;
}

bool hs_scene_export(const hs_scene_data *data, const char *prefix, hs_error *err) {
    const hs_volume *v = &data->full;
    return write_slices(prefix, "full", v, HS_MET_UCHAR, v->voxels, v->nz, err) &&
           write_slices(prefix, "truth", v, HS_MET_UCHAR, data->truth.voxels, v->nz, err) &&
           write_slices(prefix, "label", v, HS_MET_UCHAR, data->label, 1, err) &&
           write_depths(prefix, "near", &data->full, data->near_end, err) &&
           write_depths(prefix, "far", &data->full, data->far_end, err);
}

#define START_SHARE 0.15 /* of the volume's depth, behind the centre of curvature */
#define AXIS_SHARE  0.10 /* the same, before it */

static uint32_t count_of(double wanted) {
    return (uint32_t)fmin(fmax(floor(wanted), 2.0), HS_VOLUME_MAX_AXIS);
}

static double *make_table(uint32_t count, double half) {
    double *table = malloc(count * sizeof *table);
    for (uint32_t i = 0; table && i < count; i++) table[i] = half * (2.0 * i / (count - 1) - 1.0);
    return table;
}

/* A fan that lies in the volume, voxels not filled: the pitch is the voxels', and the outer lines and planes
 * reach the volume's sides at its far end; three lines to five voxels, two planes to five. NULL:
 * HS_ERR_MEMORY. */
static hs_beams *make_beams(const hs_volume *v, hs_error *err) {
    const double width = v->nx * v->spacing[0], height = v->ny * v->spacing[1], depth = v->nz * v->spacing[2];
    const double start = START_SHARE * depth, axis = -AXIS_SHARE * depth, end = start + depth;
    hs_beams shape = {.samples = count_of(depth / v->spacing[2] + 1.0),
                      .lines = count_of(0.6 * v->nx),
                      .planes = count_of(0.4 * v->ny),
                      .pitch = v->spacing[2],
                      .start = start,
                      .axis = axis};
    shape.theta = make_table(shape.lines, atan(0.5 * width / end));
    shape.phi = make_table(shape.planes, atan(0.5 * height / (end - axis)));
    hs_beams *beams = NULL;
    if (shape.theta && shape.phi)
        beams = hs_beams_like(&shape, err);
    else
        (void)hs_fail(err, HS_ERR_MEMORY, "geometry: no memory for its tables");
    free(shape.theta);
    free(shape.phi);
    return beams;
}

typedef struct {
    hs_beams *beams;
    const hs_volume *volume;
} fill_pass;

/* Linear between voxel centres; in the outer half voxel the nearest counts, beyond that it is black. */
static uint8_t sample(const hs_volume *v, const double place[3]) {
    const uint32_t count[3] = {v->nx, v->ny, v->nz};
    const size_t stride[3] = {1, v->nx, (size_t)v->nx * v->ny};
    size_t at[2] = {0, 0};
    double share[3], sum = 0.0;
    size_t step[3];
    for (int a = 0; a < 3; a++) {
        const double p = place[a] / v->spacing[a];
        if (!(p >= 0.0 && p <= count[a])) return 0;
        const double index = fmin(fmax(p - 0.5, 0.0), count[a] - 1.0);
        const uint32_t low = (uint32_t)fmin(floor(index), fmax(count[a] - 2.0, 0.0));
        share[a] = index - low;
        step[a] = count[a] > 1 ? stride[a] : 0;
        at[0] += low * stride[a];
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1.0;
        at[1] = at[0];
        for (int a = 0; a < 3; a++) {
            weight *= corner >> a & 1 ? share[a] : 1.0 - share[a];
            at[1] += corner >> a & 1 ? step[a] : 0;
        }
        sum += weight * v->voxels[at[1]];
    }
    return (uint8_t)(sum + 0.5);
}

static void fill_plane(void *context, uint32_t k) {
    const fill_pass *pass = context;
    const hs_beams *b = pass->beams;
    const hs_volume *v = pass->volume;
    const double middle[2] = {0.5 * v->nx * v->spacing[0], 0.5 * v->ny * v->spacing[1]};
    uint8_t *out = b->voxels + (size_t)k * b->lines * b->samples;
    for (uint32_t j = 0; j < b->lines; j++)
        for (uint32_t i = 0; i < b->samples; i++) {
            double place[3];
            hs_beams_place(b, i, j, k, place);
            const double in_volume[3] = {place[0] + middle[0], place[1] + middle[1], place[2] - b->start};
            *out++ = sample(v, in_volume);
        }
}

/* Samples the volume along the beams, linearly. The middle of its first slice's outer face lies where the
 * samples of the middle line start. What lies outside the volume, or was not scanned, is a black echo. */
static void fill_beams(hs_beams *beams, const hs_volume *volume) {
    fill_pass pass = {.beams = beams, .volume = volume};
    hs_parallel(hs_thread_count(0), beams->planes, fill_plane, &pass);
}

static bool open_file(hs_kretz_writer *writer, const char *prefix, const char *what, const hs_beams *beams,
                      uint32_t frames, hs_error *err) {
    char path[1100];
    return file_path(path, prefix, what, "vol", err) && hs_kretz_write_open(writer, path, beams, frames, err);
}

static bool write_frame(hs_kretz_writer *writer, hs_beams *beams, const hs_volume *volume, hs_error *err) {
    fill_beams(beams, volume);
    return hs_kretz_write_volume(writer, beams->voxels, err);
}

/* The scene's label at a column of the copy; 0 if what ends its interval was not scanned. The scene's middle,
 * and its first slice's face, lie where fill_beams has them. */
static uint8_t label_at(const hs_scene_data *data, const hs_beams *beams, double x, double y) {
    const hs_volume *v = &data->full;
    const double i = floor(x / v->spacing[0] + 0.5 * v->nx), j = floor(y / v->spacing[1] + 0.5 * v->ny);
    if (!(i >= 0.0 && i < v->nx && j >= 0.0 && j < v->ny)) return 0;
    const size_t at = (size_t)j * v->nx + (size_t)i;
    if (data->label[at] == 0) return 0;
    const double behind =
        (double)data->far_end[at] + 1.5; /* voxels to the middle of the first one behind it */
    double index[3];
    const double place[3] = {x, y, beams->start + behind * v->spacing[2]};
    return hs_beams_locate(beams, place, index) ? data->label[at] : 0;
}

static void fill_labels(const hs_volume *copy, const hs_scene_data *data, uint8_t *label) {
    const double *corner = copy->beams->corner;
    for (uint32_t y = 0; y < copy->ny; y++)
        for (uint32_t x = 0; x < copy->nx; x++)
            label[(size_t)y * copy->nx + x] =
                label_at(data, copy->beams, corner[0] + (x + 0.5) * copy->spacing[0],
                         corner[1] + (y + 0.5) * copy->spacing[1]);
}

/* Writes <prefix>_label.mha, of as many columns as the copy has that hs_kretz_read makes by default, in one
 * slice. HS_ERR_USAGE (the copy), HS_ERR_OUTPUT or HS_ERR_MEMORY. */
static bool write_label(const char *prefix, hs_beams *beams, const hs_scene_data *data, hs_error *err) {
    hs_volume copy;
    if (!hs_beams_cartesian_init(&copy, beams, 0.0, err)) return false;
    uint8_t *label = calloc(copy.nx, copy.ny);
    bool ok = label || hs_fail(err, HS_ERR_MEMORY, "%s_label.mha: no memory", prefix);
    if (ok) {
        fill_labels(&copy, data, label);
        ok = write_slices(prefix, "label", &copy, HS_MET_UCHAR, label, 1, err);
    }
    copy.beams = NULL; /* the caller's */
    hs_volume_free(&copy);
    free(label);
    return ok;
}

bool hs_vol_export_frame(hs_vol_export *out, const char *prefix, uint32_t frames, const hs_scene_data *data,
                         hs_error *err) {
    bool ok = true;
    if (!out->beams) {
        out->beams = make_beams(&data->full, err);
        ok = out->beams && open_file(&out->full, prefix, "full", out->beams, frames, err) &&
             open_file(&out->truth, prefix, "truth", out->beams, frames, err);
    }
    ok = ok && write_frame(&out->full, out->beams, &data->full, err) &&
         write_frame(&out->truth, out->beams, &data->truth, err);
    if (ok && out->full.left > 0) return true;
    ok = ok && (frames > 1 || write_label(prefix, out->beams, data, err));
    ok = ok && hs_kretz_write_commit(&out->full, err) && hs_kretz_write_commit(&out->truth, err);
    hs_vol_export_discard(out);
    return ok;
}

void hs_vol_export_discard(hs_vol_export *out) {
    hs_kretz_write_discard(&out->full);
    hs_kretz_write_discard(&out->truth);
    hs_beams_free(out->beams);
    *out = (hs_vol_export){0};
}
