/* SPDX-License-Identifier: MIT */
/* The structures of a scene as solids: occluders, cord, particles, bladder and the fetus. */
#include "scene/scene_solids.h"

#include "scene/scene_cord.h"
#include "scene/scene_fetus.h"
#include "scene/scene_random.h"

#include <math.h>
#include <string.h>

static const hs_solid_frame scene_frame = {.axis = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1.0f};

static void occluder(hs_solid_list *list, const hs_occluder_spec *o, uint8_t style) {
    hs_solid_frame frame = {.scale = 1.0f};
    memcpy(frame.origin, o->centre, sizeof frame.origin);
    hs_rotation(o->rotation, frame.axis);
    const float zero[3] = {0, 0, 0};
    hs_solid *s = hs_solid_ellipsoid(list, &frame, HS_PART_OCCLUDER, o->tissue, o->blend_mm, zero, o->radii);
    if (s) s->style = style;
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

static void bladder(hs_solid_list *list, const hs_bladder_spec *b) {
    hs_solid_frame frame = {.scale = 1.0f};
    memcpy(frame.origin, b->centre, sizeof frame.origin);
    hs_rotation(b->rotation, frame.axis);
    const float zero[3] = {0, 0, 0};
    const float outer[3] = {b->radii[0] + b->wall_mm, b->radii[1] + b->wall_mm, b->radii[2] + b->wall_mm};
    hs_solid_ellipsoid(list, &frame, HS_PART_OCCLUDER, HS_TISSUE_MUSCLE, 0.0f, zero, outer);
    hs_solid_ellipsoid(list, &frame, HS_PART_BLADDER, HS_TISSUE_URINE, 0.0f, zero, b->radii);
}

static void fetus(hs_solid_list *list, const hs_fetus_spec *fetus, uint32_t body) {
    const hs_solid_frame frame = hs_fetus_frame(fetus);
    const size_t before = list->count;
    hs_fetus_solids(list, &frame, &fetus->pose);
    for (size_t i = before; i < list->count; i++) list->items[i].body = (uint8_t)body;
}

static bool add_structure(const hs_scene_spec *spec, uint32_t index, uint64_t seed, uint32_t *bodies,
                          hs_solid_list *list) {
    const hs_structure *s = &spec->structure[index];
    switch (s->kind) {
    case HS_STRUCTURE_OCCLUDER:
        occluder(list, &s->of.occluder, hs_scene_style(s) ? (uint8_t)(index + 1) : 0);
        return true;
    case HS_STRUCTURE_CORD:
        hs_scene_cord(list, &s->of.cord);
        return true;
    case HS_STRUCTURE_NUCHAL_CORD:
        return hs_scene_nuchal_cord(list, &s->of.nuchal, hs_scene_fetus(spec, s->of.nuchal.fetus));
    case HS_STRUCTURE_CLOUD:
        cloud(list, &s->of.cloud, hs_random_key(seed, 100u + index));
        return true;
    case HS_STRUCTURE_BLADDER:
        bladder(list, &s->of.bladder);
        return true;
    case HS_STRUCTURE_FETUS:
        fetus(list, &s->of.fetus, (*bodies)++);
        return true;
    }
    return true;
}

bool hs_scene_style(const hs_structure *s) {
    return s->kind == HS_STRUCTURE_OCCLUDER &&
           (s->of.occluder.echo_db != 0.0f || s->of.occluder.soft_mm > 0.0f);
}

const hs_fetus_spec *hs_scene_fetus(const hs_scene_spec *spec, uint32_t number) {
    for (uint32_t i = 0; i < spec->structure_count; i++)
        if (spec->structure[i].kind == HS_STRUCTURE_FETUS && number-- == 0)
            return &spec->structure[i].of.fetus;
    return NULL;
}

bool hs_scene_solids(const hs_scene_spec *spec, uint64_t seed, hs_solid_list *list, hs_error *err) {
    uint32_t bodies = 0;
    bool ok = true;
    for (uint32_t i = 0; ok && i < spec->structure_count; i++)
        ok = add_structure(spec, i, seed, &bodies, list);
    if (!ok || list->out_of_memory)
        return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for its solids", spec->name);
    return true;
}
