/* SPDX-License-Identifier: MIT */
/* What of the scan is seen: the fan of the probe, and the voxels of a turned camera. */
#include "core/threads.h"
#include "scene/scene_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * The region a mechanically swept convex probe scans (Fenster, Downey and Cardinal, "Three-dimensional
 * ultrasound imaging", Phys. Med. Biol. 46, 2001, section 3.1: tilt scanning): the beams of one plane leave
 * an arc of radius r_a over the angle `azimuth`, and the plane is tilted over an arc of radius r_s and the
 * angle `sweep`. A point (x, y, z), measured from the middle of the probe's surface, is scanned if
 *
 *     |x| <= (z + r_a) tan(azimuth / 2),   |y| <= (z + r_s) tan(sweep / 2),
 *     sqrt(x^2 + (z + r_a)^2) - r_a + sqrt(y^2 + (z + r_s)^2) - (z + r_s) <= depth.
 *
 * All else holds 0.
 */

typedef struct {
    const hs_field *field;
    const hs_fan_spec *fan;
    float tan_azimuth, tan_sweep; /* of half the angles */
} fan_pass;

static bool scanned(const fan_pass *p, float x, float y, float z) {
    const hs_fan_spec *fan = p->fan;
    float za = z + fan->azimuth_radius_mm, zs = z + fan->sweep_radius_mm;
    if (fabsf(x) > za * p->tan_azimuth || fabsf(y) > zs * p->tan_sweep) return false;
    float ra = sqrtf(x * x + za * za), rs = sqrtf(y * y + zs * zs);
    return ra - fan->azimuth_radius_mm + rs - zs <= fan->depth_mm;
}

static void fan_slice(void *context, uint32_t z) {
    const fan_pass *p = context;
    const hs_field *f = p->field;
    const float middle[2] = {0.5f * (float)f->n[0] * f->h[0], 0.5f * (float)f->n[1] * f->h[1]};
    for (uint32_t y = 0; y < f->n[1]; y++) {
        size_t row = hs_field_index(f, 0, y, z);
        for (uint32_t x = 0; x < f->n[0]; x++)
            if (!scanned(p, ((float)x + 0.5f) * f->h[0] - middle[0], ((float)y + 0.5f) * f->h[1] - middle[1],
                         ((float)z + 0.5f) * f->h[2]))
                f->grey[row + x] = 0;
    }
}

void hs_scene_fan(hs_field *field, const hs_scene_spec *spec) {
    const float half_degree = 3.14159265f / 360.0f;
    fan_pass p = {.field = field, .fan = &spec->fan};
    p.tan_azimuth = tanf(spec->fan.azimuth_deg * half_degree);
    p.tan_sweep = tanf(spec->fan.sweep_deg * half_degree);
    hs_parallel(field->threads, field->n[2], fan_slice, &p);
}

/*
 * The probe stands where it stood: all that happens to the pulse happens along +z of the scene. A camera
 * turned by R around the cube's middle m sees voxel p at m + R (p - m). Its grey value is the trilinear one
 * of the scan there, over the neighbours that were scanned; it counts as scanned where the nearest voxel
 * was. Its tissue is read from the solids at that very point, so the truth is no resampled one.
 */

typedef struct {
    const hs_field *field;
    const uint8_t *scan;
    float turn[9];
} camera;

/* The trilinear value at low + t over the neighbours that are in the volume and were
 * scanned. One of them is. */
static uint8_t sample_border(const camera *c, const int32_t low[3], const float t[3]) {
    const hs_field *f = c->field;
    float sum = 0.0f, weights = 0.0f;
    for (int i = 0; i < 8; i++) {
        float weight = 1.0f;
        int32_t at[3];
        bool inside = true;
        for (int a = 0; a < 3; a++) {
            const int32_t step = i >> a & 1;
            at[a] = low[a] + step;
            inside = inside && at[a] >= 0 && at[a] < (int32_t)f->n[a];
            weight *= step ? t[a] : 1.0f - t[a];
        }
        if (!inside) continue;
        const uint8_t v = c->scan[hs_field_index(f, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2])];
        if (v == 0) continue;
        sum += weight * (float)v;
        weights += weight;
    }
    return (uint8_t)lrintf(fmaxf(sum / weights, 1.0f));
}

static float mix(float a, float b, float t) {
    return a + t * (b - a);
}

/* The scan at q, in voxels: 0 is the centre of the first. 0 if it was not scanned there. */
static uint8_t sample(const camera *c, const float q[3]) {
    const hs_field *f = c->field;
    int32_t low[3];
    float t[3];
    bool whole = true;
    size_t nearest = 0;
    for (int a = 2; a >= 0; a--) {
        if (!(q[a] >= -0.5f && q[a] < (float)f->n[a] - 0.5f)) return 0;
        low[a] = (int32_t)(q[a] + 1.0f) - 1; /* rounded down; q is above -1 */
        t[a] = q[a] - (float)low[a];
        nearest = nearest * f->n[a] + (size_t)(low[a] + (t[a] >= 0.5f));
        whole = whole && low[a] >= 0 && low[a] + 1 < (int32_t)f->n[a];
    }
    if (c->scan[nearest] == 0) return 0;
    if (!whole) return sample_border(c, low, t);
    const size_t nx = f->n[0], slice = hs_field_slice(f);
    const uint8_t *v = c->scan + hs_field_index(f, (uint32_t)low[0], (uint32_t)low[1], (uint32_t)low[2]);
    const uint8_t *w = v + slice;
    if (!(v[0] && v[1] && v[nx] && v[nx + 1] && w[0] && w[1] && w[nx] && w[nx + 1]))
        return sample_border(c, low, t);
    const float front = mix(mix(v[0], v[1], t[0]), mix(v[nx], v[nx + 1], t[0]), t[1]);
    const float back = mix(mix(w[0], w[1], t[0]), mix(w[nx], w[nx + 1], t[0]), t[1]);
    return (uint8_t)lrintf(mix(front, back, t[2]));
}

static void camera_slice(void *context, uint32_t z) {
    const camera *c = context;
    const hs_field *f = c->field;
    const float middle[3] = {0.5f * (float)f->n[0] - 0.5f, 0.5f * (float)f->n[1] - 0.5f,
                             0.5f * (float)f->n[2] - 0.5f};
    for (uint32_t y = 0; y < f->n[1]; y++)
        for (uint32_t x = 0; x < f->n[0]; x++) {
            const float d[3] = {(float)x - middle[0], (float)y - middle[1], (float)z - middle[2]};
            float q[3];
            for (int a = 0; a < 3; a++)
                q[a] = middle[a] + d[0] * c->turn[a] + d[1] * c->turn[3 + a] + d[2] * c->turn[6 + a];
            f->grey[hs_field_index(f, x, y, z)] = sample(c, q);
        }
}

bool hs_scene_camera_turned(const hs_scene_spec *spec) {
    return spec->camera_deg[0] != 0.0f || spec->camera_deg[1] != 0.0f || spec->camera_deg[2] != 0.0f;
}

void hs_scene_camera_turn(const hs_scene_spec *spec, double turn[9]) {
    float rows[9];
    if (!hs_scene_camera_turned(spec)) return;
    hs_rotation(spec->camera_deg, rows);
    for (int k = 0; k < 9; k++) turn[k] = (double)rows[k];
}

void hs_scene_camera_point(const hs_scene_spec *spec, const float p[3], float out[3]) {
    float turn[9];
    const float m = 0.5f * spec->extent_mm;
    memcpy(out, p, 3 * sizeof *out);
    if (!hs_scene_camera_turned(spec)) return;
    hs_rotation(spec->camera_deg, turn);
    for (int a = 0; a < 3; a++)
        out[a] = m + (p[0] - m) * turn[a] + (p[1] - m) * turn[3 + a] + (p[2] - m) * turn[6 + a];
}

bool hs_scene_camera(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err) {
    const size_t count = hs_field_slice(field) * field->n[2];
    uint8_t *scan = malloc(count);
    if (!scan) return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for %zu voxels", spec->name, count);
    memcpy(scan, field->grey, count);
    camera c = {.field = field, .scan = scan};
    hs_rotation(spec->camera_deg, c.turn);
    hs_parallel(field->threads, field->n[2], camera_slice, &c);
    free(scan);
    return hs_scene_raster(field, spec, solids, c.turn, err);
}
