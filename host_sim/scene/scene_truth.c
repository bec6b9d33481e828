/* SPDX-License-Identifier: MIT */
/*
 * Ground truth, read from the tissues themselves and not from the picture (thesis 3.2): a ray that meets
 * the fetus may be clipped between the exit of the last occluder before it and the fetus' skin; a ray that
 * meets the sac only, between entry and exit of the fluid. Where something floats in the fluid of such a
 * ray, its longest stretch of fluid counts.
 */
#include "core/threads.h"
#include "scene/scene_field.h"

#include <stdlib.h>
#include <string.h>

#define REACH_MM 2.0f /* how far the point spread carries an occluder sideways */
#define WIDE     1.5f /* standard deviations of a thick slice, for the same */

typedef struct {
    const hs_field *field;
    const hs_scene_spec *spec;
    hs_scene_data *data;
    int64_t reach[2]; /* voxels in x and y */
} truth;

typedef struct {
    uint8_t label;
    uint32_t near_end, far_end;
} interval;

static interval column(const truth *t, size_t pixel) {
    const hs_field *f = t->field;
    const size_t slice = hs_field_slice(f);
    interval best = {HS_LABEL_NEITHER, 0, 0};
    uint32_t run = 0;
    for (uint32_t z = 0; z < f->n[2]; z++) {
        size_t index = slice * z + pixel;
        uint8_t tissue = f->tissue[index];
        if (t->data->full.voxels[index] == 0) {
            run = 0;
            continue;
        }
        if (hs_tissue_is_fetus(tissue)) return (interval){HS_LABEL_FETUS, run ? z - run : z, run ? z - 1 : z};
        run = tissue == HS_TISSUE_FLUID ? run + 1 : 0;
        if (run > 0 && (best.label == HS_LABEL_NEITHER || run > best.far_end - best.near_end + 1))
            best = (interval){HS_LABEL_SAC, z + 1 - run, z};
    }
    return best;
}

static void truth_row(void *context, uint32_t y) {
    const truth *t = context;
    for (uint32_t x = 0; x < t->field->n[0]; x++) {
        size_t pixel = (size_t)y * t->field->n[0] + x;
        interval i = column(t, pixel);
        t->data->label[pixel] = i.label;
        t->data->near_end[pixel] = i.label ? (float)i.near_end : NAN;
        t->data->far_end[pixel] = i.label ? (float)i.far_end : NAN;
    }
}

typedef struct {
    float *map, *distance;
    uint32_t nx, ny;
} spread;

static void take(spread *s, uint32_t x, uint32_t y, int dx, int dy, float step) {
    int64_t fx = (int64_t)x + dx, fy = (int64_t)y + dy;
    if (fx < 0 || fy < 0 || fx >= (int64_t)s->nx || fy >= (int64_t)s->ny) return;
    size_t to = (size_t)y * s->nx + x, from = (size_t)fy * s->nx + (size_t)fx;
    if (s->distance[from] + step < s->distance[to]) {
        s->distance[to] = s->distance[from] + step;
        s->map[to] = s->map[from];
    }
}

/* Gives every NAN of a map the value of the nearest pixel that has one (chamfer distance); 0 if none has. */
static bool spread_out(float *map, uint32_t nx, uint32_t ny, hs_error *err) {
    spread s = {map, calloc((size_t)nx * ny, sizeof(float)), nx, ny};
    if (!s.distance) return hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %u x %u pixels", nx, ny);
    const float diagonal = 1.41421356f;
    for (size_t i = 0; i < (size_t)nx * ny; i++) {
        s.distance[i] = isnan(map[i]) ? INFINITY : 0.0f;
        if (isnan(map[i])) map[i] = 0.0f;
    }
    for (uint32_t y = 0; y < ny; y++) {
        for (uint32_t x = 0; x < nx; x++) {
            take(&s, x, y, -1, 0, 1.0f);
            take(&s, x, y, 0, -1, 1.0f);
            take(&s, x, y, -1, -1, diagonal);
            take(&s, x, y, 1, -1, diagonal);
        }
        for (uint32_t x = nx; x-- > 0;) take(&s, x, y, 1, 0, 1.0f);
    }
    for (uint32_t y = ny; y-- > 0;) {
        for (uint32_t x = nx; x-- > 0;) {
            take(&s, x, y, 1, 0, 1.0f);
            take(&s, x, y, 0, 1, 1.0f);
            take(&s, x, y, 1, 1, diagonal);
            take(&s, x, y, -1, 1, diagonal);
        }
        for (uint32_t x = 0; x < nx; x++) take(&s, x, y, -1, 0, 1.0f);
    }
    free(s.distance);
    return true;
}

/* How far the point spread carries what ends at slice z to other rows, mm. */
static float reach_across(const truth *t, float z) {
    const hs_slice_spec *slice = &t->spec->slice;
    if (!slice->on) return REACH_MM;
    const float off = ((z + 0.5f) * t->field->h[2] - slice->focus_mm) / slice->rayleigh_mm;
    return fmaxf(REACH_MM, WIDE * slice->elevation_mm * sqrtf(1.0f + off * off));
}

/* Where the occluders of the neighbourhood end, as far as that is within the pixel's interval. */
static float beside(const truth *t, size_t pixel, float clip) {
    const hs_scene_data *data = t->data;
    const int64_t nx = t->field->n[0], ny = t->field->n[1];
    const int64_t x = (int64_t)pixel % nx, y = (int64_t)pixel / nx;
    for (int64_t v = y - t->reach[1]; v <= y + t->reach[1]; v++)
        for (int64_t u = x - t->reach[0]; u <= x + t->reach[0]; u++) {
            if (u < 0 || v < 0 || u >= nx || v >= ny) continue;
            size_t other = (size_t)v * (size_t)nx + (size_t)u;
            if (!data->label[other] || data->near_end[other] > data->far_end[pixel]) continue;
            const int64_t rows = v < y ? y - v : v - y;
            if (t->spec->slice.on && (float)rows * t->field->h[1] > reach_across(t, data->near_end[other]))
                continue;
            clip = fmaxf(clip, data->near_end[other]);
        }
    return clip;
}

/* Behind the haze, as far as it leaves room before the skin. */
static float behind_haze(const truth *t, size_t pixel, float clip) {
    const hs_field *f = t->field;
    const uint32_t column = (uint32_t)(pixel % f->n[0]), row = (uint32_t)(pixel / f->n[0]);
    float first[3], next[3]; /* the ray's slices 0 and 1 in the scene */
    for (int i = 0; i < 2; i++) {
        const float p[3] = {((float)column + 0.5f) * f->h[0], ((float)row + 0.5f) * f->h[1],
                            ((float)i + 0.5f) * f->h[2]};
        hs_scene_camera_point(t->spec, p, i ? next : first);
    }
    for (float z = t->data->far_end[pixel] - REACH_MM / f->h[2]; z > clip; z -= 1.0f) {
        const float depth = first[2] + z * (next[2] - first[2]);
        const int64_t x = (int64_t)floorf((first[0] + z * (next[0] - first[0])) / f->h[0]);
        const int64_t y = (int64_t)floorf((first[1] + z * (next[1] - first[1])) / f->h[1]);
        if (x < 0 || y < 0 || x >= (int64_t)f->n[0] || y >= (int64_t)f->n[1]) continue;
        if (depth < f->haze_end[(size_t)y * f->n[0] + (size_t)x]) return z;
    }
    return clip;
}

/*
 * The clipping surface: the middle of the interval, but no nearer than where the occluders of the
 * neighbourhood end, because the point spread makes them visible beside themselves, and no nearer than
 * where haze can be seen, but for the last REACH_MM before the skin. It never leaves the pixel's own
 * interval.
 */
static void clip_row(void *context, uint32_t y) {
    const truth *t = context;
    const hs_scene_data *data = t->data;
    for (uint32_t x = 0; x < t->field->n[0]; x++) {
        size_t pixel = (size_t)y * t->field->n[0] + x;
        data->clip[pixel] = NAN;
        if (data->label[pixel] == HS_LABEL_NEITHER) continue;
        float clip = beside(t, pixel, 0.5f * (data->near_end[pixel] + data->far_end[pixel]));
        data->clip[pixel] = t->field->haze_end ? behind_haze(t, pixel, clip) : clip;
    }
}

static void clip_slice(void *context, uint32_t z) {
    const hs_scene_data *data = context;
    const size_t slice = (size_t)data->full.nx * data->full.ny, start = slice * z;
    uint8_t *out = data->truth.voxels + start;
    memcpy(out, data->full.voxels + start, slice);
    for (size_t i = 0; i < slice; i++)
        if ((float)z < data->clip[i] && out[i] > 1) out[i] = 1;
}

void hs_scene_fill_truth(hs_scene_data *data) {
    if (data->truth_later) hs_parallel(hs_thread_count(0), data->full.nz, clip_slice, data);
    data->truth_later = false;
}

bool hs_scene_truth(const hs_field *field, const hs_scene_spec *spec, hs_scene_data *data, hs_error *err) {
    truth t = {field, spec, data, {lrintf(REACH_MM / field->h[0]), lrintf(REACH_MM / field->h[1])}};
    if (spec->slice.on) {
        const float front = reach_across(&t, 0.0f), back = reach_across(&t, (float)field->n[2]);
        t.reach[1] = lrintf(fmaxf(front, back) / field->h[1]);
    }
    hs_parallel(field->threads, field->n[1], truth_row, &t);
    hs_parallel(field->threads, field->n[1], clip_row, &t);
    data->truth_later = true;
    return spread_out(data->clip, field->n[0], field->n[1], err);
}

#define ECHO 77 /* the middle of the renderer's usual window, 0.1588 .. 0.45 */

/* What the probe shows around a voxel of a slice is an echo: nine voxels, for speckle has dark spots. */
static bool is_echo(const hs_volume *v, const uint8_t *slice, uint32_t x, uint32_t y) {
    unsigned sum = 0, maximum = 0;
    for (uint32_t j = y ? y - 1 : 0; j <= y + 1 && j < v->ny; j++)
        for (uint32_t i = x ? x - 1 : 0; i <= x + 1 && i < v->nx; i++, maximum += ECHO)
            sum += slice[(size_t)j * v->nx + i];
    return sum > maximum;
}

double hs_scene_touched(const hs_scene_data *data) {
    const hs_volume *v = &data->full;
    const size_t pixels = (size_t)v->nx * v->ny;
    size_t fetus = 0, touched = 0;
    for (uint32_t y = 0; y < v->ny; y++)
        for (uint32_t x = 0; x < v->nx; x++) {
            const size_t i = (size_t)y * v->nx + x;
            if (data->label[i] != HS_LABEL_FETUS) continue;
            fetus++;
            touched += is_echo(v, v->voxels + pixels * (size_t)ceilf(data->clip[i]), x, y);
        }
    return fetus > 0 ? (double)touched / (double)fetus : 0.0;
}
