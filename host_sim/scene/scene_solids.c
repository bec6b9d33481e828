/* SPDX-License-Identifier: MIT */
/* The structures of a scene as solids: occluders, cord, particles and the fetus. */
#include "scene/scene_solids.h"

#include "scene/scene_fetus.h"
#include "scene/scene_random.h"

#include <math.h>
#include <string.h>

static const hs_solid_frame scene_frame = {.axis = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1.0f};

static void occluder(hs_solid_list *list, const hs_occluder_spec *o) {
    hs_solid_frame frame = {.scale = 1.0f};
    memcpy(frame.origin, o->centre, sizeof frame.origin);
    hs_rotation(o->rotation, frame.axis);
    const float zero[3] = {0, 0, 0};
    hs_solid_ellipsoid(list, &frame, HS_PART_OCCLUDER, o->tissue, o->blend_mm, zero, o->radii);
}

/* Catmull-Rom curve through the points; t in 0 .. count - 1. */
static void curve(const hs_points *points, float t, float out[3]) {
    int last = (int)points->count - 1, i = (int)t;
    if (i > last - 1) i = last - 1;
    float u = t - (float)i;
    const float *a = points->p[i > 0 ? i - 1 : 0], *b = points->p[i], *c = points->p[i + 1],
                *d = points->p[i + 2 <= last ? i + 2 : last];
    for (int k = 0; k < 3; k++)
        out[k] = b[k] + 0.5f * u *
                            (c[k] - a[k] +
                             u * (2.0f * a[k] - 5.0f * b[k] + 4.0f * c[k] - d[k] +
                                  u * (3.0f * (b[k] - c[k]) + d[k] - a[k])));
}

/* Three vessels wound round the curve: two arteries and a vein. */
static void cord(hs_solid_list *list, const hs_cord_spec *cord) {
    const int steps = 10 * ((int)cord->points.count - 1);
    float last[3][3], length = 0.0f, before[3] = {0, 0, 0};
    for (int i = 0; i <= steps; i++) {
        float p[3];
        curve(&cord->points, 0.1f * (float)i, p);
        float step[3] = {p[0] - before[0], p[1] - before[1], p[2] - before[2]};
        if (i > 0) length += sqrtf(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
        memcpy(before, p, sizeof before);
        for (int k = 0; k < 3; k++) {
            float angle = 6.2831853f * (length / cord->twist_mm + (float)k / 3.0f);
            float radius = cord->radius_mm * 0.45f;
            /* Wound in the plane across the viewing direction's diagonal, which no curve follows for long. */
            float q[3] = {p[0] + radius * cosf(angle), p[1] + radius * 0.7f * sinf(angle),
                          p[2] + radius * 0.7f * sinf(angle)};
            if (i > 0)
                hs_solid_cone(list, &scene_frame, HS_PART_OCCLUDER, HS_TISSUE_CORD, 0.3f * cord->radius_mm,
                              last[k], 0.6f * cord->radius_mm, q, 0.6f * cord->radius_mm);
            memcpy(last[k], q, sizeof q);
        }
    }
}

static void cloud(hs_solid_list *list, const hs_cloud_spec *cloud, uint64_t key) {
    uint64_t draw = 0;
    for (uint32_t i = 0; i < cloud->count; i++) {
        float p[3], square;
        do { /* a point in the unit ball; 16 tries in a row fail once in 10^5 */
            square = 0.0f;
            for (int a = 0; a < 3; a++) {
                p[a] = 2.0f * hs_random_unit(key, draw++) - 1.0f;
                square += p[a] * p[a];
            }
        } while (square > 1.0f);
        float u = hs_random_unit(key, draw++);
        float r = cloud->particle_min_mm + (cloud->particle_max_mm - cloud->particle_min_mm) * u * u;
        for (int a = 0; a < 3; a++) p[a] = cloud->centre[a] + p[a] * cloud->radii[a];
        const float flat[3] = {r, 0.8f * r, 0.7f * r};
        hs_solid_ellipsoid(list, &scene_frame, HS_PART_OCCLUDER, HS_TISSUE_CLOUD, 0.8f * r, p, flat);
    }
}

static void fetus(hs_solid_list *list, const hs_fetus_spec *fetus) {
    hs_solid_frame frame = {.scale = fetus->scale};
    memcpy(frame.origin, fetus->position, sizeof frame.origin);
    hs_rotation(fetus->rotation, frame.axis);
    hs_fetus_solids(list, &frame, &fetus->pose);
}

bool hs_scene_solids(const hs_scene_spec *spec, uint64_t seed, hs_solid_list *list, hs_error *err) {
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        const hs_structure *s = &spec->structure[i];
        switch (s->kind) {
        case HS_STRUCTURE_OCCLUDER:
            occluder(list, &s->of.occluder);
            break;
        case HS_STRUCTURE_CORD:
            cord(list, &s->of.cord);
            break;
        case HS_STRUCTURE_CLOUD:
            cloud(list, &s->of.cloud, hs_random_key(seed, 100u + i));
            break;
        case HS_STRUCTURE_FETUS:
            fetus(list, &s->of.fetus);
            break;
        }
    }
    if (list->out_of_memory)
        return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for its solids", spec->name);
    return true;
}
