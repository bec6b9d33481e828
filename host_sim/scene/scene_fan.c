/* SPDX-License-Identifier: MIT */
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
#include "scene/scene_fan.h"

#include "base/threads.h"

typedef struct {
    const hs_field *field;
    const hs_fan_spec *fan;
    uint8_t *voxels;
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
                p->voxels[row + x] = 0;
    }
}

void hs_scene_fan(const hs_field *field, const hs_scene_spec *spec, hs_volume *full) {
    const float half_degree = 3.14159265f / 360.0f;
    fan_pass p = {.field = field, .fan = &spec->fan, .voxels = full->voxels};
    p.tan_azimuth = tanf(spec->fan.azimuth_deg * half_degree);
    p.tan_sweep = tanf(spec->fan.sweep_deg * half_degree);
    hs_parallel(field->threads, field->n[2], fan_slice, &p);
}
