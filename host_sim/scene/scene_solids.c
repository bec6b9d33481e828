/* SPDX-License-Identifier: MIT */
/* A scene's structures as solids: occluders, cord, particles, bladder and the fetus; and their motion. */
#include "scene/scene_random.h"
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

#include <math.h>
#include <string.h>

static const hs_solid_frame scene_frame = {.axis = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .scale = 1.0f};

static void occluder(hs_solid_list *list, const hs_occluder_spec *o, uint8_t style) {
    const hs_solid_frame frame = hs_frame_at(o->centre, o->rotation);
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
    const hs_solid_frame frame = hs_frame_at(b->centre, b->rotation);
    const float zero[3] = {0, 0, 0};
    const float outer[3] = {b->radii[0] + b->wall_mm, b->radii[1] + b->wall_mm, b->radii[2] + b->wall_mm};
    hs_solid_ellipsoid(list, &frame, HS_PART_OCCLUDER, HS_TISSUE_MUSCLE, 0.0f, zero, outer);
    hs_solid_ellipsoid(list, &frame, HS_PART_BLADDER, HS_TISSUE_URINE, 0.0f, zero, b->radii);
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
static void cord_solids(hs_solid_list *list, const hs_cord_spec *cord) {
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

#define NECK_Y     (-15.0f) /* of the neck's middle, in the frame of the fetus */
#define NECK_Z     4.5f
#define NECK_TILT  4.0f  /* mm: how much lower the ring is before the neck, under the chin, than behind it */
#define VESSELS    0.75f /* of the radius: where the three vessels end, now one and now another, on any side */
#define NECK_REACH 15.0f /* mm: at most this far from the neck's middle, in a fetus of scale 1 */

/* How far from the middle of the neck the skin lies in a direction, plus `clear`: mm of the scene. */
static float ring_radius(const hs_shape *shape, const float middle[3], const float to[3], float clear,
                         float reach) {
    float r = 0.0f;
    for (const float step = 0.1f; r < reach; r += step) {
        const float p[3] = {middle[0] + r * to[0], middle[1] + r * to[1], middle[2] + r * to[2]};
        if (hs_shape_one_body(shape, 0, p) >= clear) break;
    }
    return r;
}

static void add_point(hs_points *points, const hs_solid_frame *f, float x, float y, float z) {
    const float p[3] = {x, y, z};
    hs_frame_point(f, p, points->p[points->count++]);
}

/* The rings, from the fetus' right side to its left, each a cord's width below the one before. */
static void rings(const hs_nuchal_spec *cord, const hs_solid_frame *f, const hs_shape *shape,
                  hs_points *points) {
    const uint32_t per_turn = cord->loops > 2 ? 6 : 8, last = cord->loops * per_turn + per_turn / 2;
    const float pitch = 2.2f * cord->radius_mm / f->scale;
    for (uint32_t i = 0; i <= last; i++) {
        const float turns = (float)i / (float)per_turn, angle = 6.2831853f * turns;
        const float side = -cosf(angle), front = sinf(angle); /* right, front, left, back */
        const float y = NECK_Y + NECK_TILT * front + pitch * (turns - 0.5f * (float)cord->loops - 0.25f);
        const float neck[3] = {0.0f, y, NECK_Z};
        float middle[3], to[3];
        hs_frame_point(f, neck, middle);
        for (int a = 0; a < 3; a++) to[a] = side * f->axis[a] - front * f->axis[6 + a];
        float r =
            ring_radius(shape, middle, to, cord->slack_mm + VESSELS * cord->radius_mm, NECK_REACH * f->scale);
        for (int a = 0; a < 3; a++) points->p[points->count][a] = middle[a] + r * to[a];
        points->count++;
    }
}

/* Round the neck of a fetus: the rings lie slack_mm off the skin, but no farther than the chin. False
 * without memory. */
static bool nuchal_cord(hs_solid_list *list, const hs_nuchal_spec *cord, const hs_fetus_spec *fetus) {
    hs_solid_list body = {0};
    const hs_solid_frame f = hs_fetus_frame(fetus);
    hs_fetus_solids(&body, fetus, 0);
    uint16_t item[HS_SCENE_MAX_SOLIDS];
    uint32_t first[HS_PART_COUNT + 1];
    const bool ok = hs_shape_all(&body, item, first);
    if (ok) {
        const hs_shape shape = {body.items, item, first};
        hs_cord_spec whole = {.radius_mm = cord->radius_mm, .twist_mm = cord->twist_mm};
        add_point(&whole.points, &f, -30.0f, -22.0f, -8.0f); /* to the placenta */
        add_point(&whole.points, &f, -20.0f, -18.0f, -2.0f);
        rings(cord, &f, &shape, &whole.points);
        add_point(&whole.points, &f, 13.0f, 2.0f, -14.0f); /* down to the navel */
        add_point(&whole.points, &f, 8.0f, 14.0f, -17.0f);
        add_point(&whole.points, &f, 0.0f, 20.0f, -9.0f);
        cord_solids(list, &whole);
    }
    hs_solid_list_free(&body);
    return ok;
}

/* The scene's fetus of that number, from 0; NULL if there are fewer. */
static const hs_fetus_spec *fetus_of(const hs_scene_spec *spec, uint32_t number) {
    for (uint32_t i = 0; i < spec->structure_count; i++)
        if (spec->structure[i].kind == HS_STRUCTURE_FETUS && number-- == 0)
            return &spec->structure[i].of.fetus;
    return NULL;
}

static bool add_structure(const hs_scene_spec *spec, uint32_t index, uint64_t seed, uint32_t *bodies,
                          hs_solid_list *list) {
    const hs_structure *s = &spec->structure[index];
    switch (s->kind) {
    case HS_STRUCTURE_OCCLUDER:
        occluder(list, &s->of.occluder, hs_scene_style(s) ? (uint8_t)(index + 1) : 0);
        return true;
    case HS_STRUCTURE_CORD:
        cord_solids(list, &s->of.cord);
        return true;
    case HS_STRUCTURE_NUCHAL_CORD:
        return nuchal_cord(list, &s->of.nuchal, fetus_of(spec, s->of.nuchal.fetus));
    case HS_STRUCTURE_CLOUD:
        cloud(list, &s->of.cloud, hs_random_key(seed, 100u + index));
        return true;
    case HS_STRUCTURE_BLADDER:
        bladder(list, &s->of.bladder);
        return true;
    case HS_STRUCTURE_FETUS:
        hs_fetus_solids(list, &s->of.fetus, (*bodies)++);
        return true;
    }
    return true;
}

bool hs_scene_style(const hs_structure *s) {
    return s->kind == HS_STRUCTURE_OCCLUDER &&
           (s->of.occluder.echo_db != 0.0f || s->of.occluder.soft_mm > 0.0f);
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

/* Motion: slow drift of the fetus and its particles, and limbs that move by themselves. */

static float swing(float phase, float offset) {
    return sinf(phase + offset) - sinf(offset); /* 0 in frame 0 */
}

static void move_joint(float joint[3], float amplitude, float phase, int index) {
    /* Every joint has a direction and a phase of its own, a golden angle apart. */
    float offset = 2.3999632f * (float)index;
    joint[0] += amplitude * 0.5f * swing(phase, offset + 1.0f);
    joint[1] += amplitude * swing(phase, offset);
    joint[2] += amplitude * 0.6f * swing(phase, offset + 2.0f);
}

static void move_fetus(hs_fetus_spec *fetus, const hs_motion_spec *motion, float phase) {
    for (int a = 0; a < 3; a++) fetus->position[a] += motion->drift_mm[a] * swing(phase, 0.0f);
    for (int side = 0; side < 2; side++) {
        move_joint(fetus->pose.elbow[side], motion->limb_mm, phase, side);
        move_joint(fetus->pose.hand[side], 1.6f * motion->limb_mm, phase, 2 + side);
        move_joint(fetus->pose.knee[side], motion->limb_mm, phase, 4 + side);
        move_joint(fetus->pose.ankle[side], 1.4f * motion->limb_mm, phase, 6 + side);
    }
}

void hs_scene_move(hs_scene_spec *spec, uint32_t frame) {
    const hs_motion_spec *motion = &spec->motion;
    if (!motion->on || frame == 0) return;
    float phase = (float)(6.283185307179586 * fmod((double)frame / (double)motion->period_frames, 1.0));
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        hs_structure *s = &spec->structure[i];
        if (s->kind == HS_STRUCTURE_FETUS) move_fetus(&s->of.fetus, motion, phase);
        if (s->kind == HS_STRUCTURE_CLOUD)
            for (int a = 0; a < 3; a++)
                s->of.cloud.centre[a] += motion->cloud_drift_mm[a] * swing(phase, 0.7f * (float)i);
    }
}
