/* SPDX-License-Identifier: MIT */
#include "scene/scene_read_structures.h"

#include "scene/scene_fetus.h"
#include "scene/scene_fields.h"

#include <math.h>
#include <string.h>

static const hs_json_field occluder_fields[] = {
    OTHER("type", true),
    FIELD(hs_occluder_spec, tissue, TISSUE, 0, 0, true),
    NAMED("centre_mm", hs_occluder_spec, centre, VEC3, -400, 800, true),
    NAMED("radii_mm", hs_occluder_spec, radii, VEC3, 0.2, 400, true),
    NAMED("rotation_deg", hs_occluder_spec, rotation, VEC3, -360, 360, false),
    FIELD(hs_occluder_spec, blend_mm, FLOAT, 0, 50, false),
    FIELD(hs_occluder_spec, echo_db, FLOAT, -40, 20, false),
    FIELD(hs_occluder_spec, soft_mm, FLOAT, 0, 20, false),
    FIELD(hs_occluder_spec, gap_mm, FLOAT, -20, 60, false),
};

static const hs_json_field cord_fields[] = {
    OTHER("type", true),
    NAMED("points_mm", hs_cord_spec, points, POINTS, -400, 800, true),
    FIELD(hs_cord_spec, radius_mm, FLOAT, 0.3, 20, true),
    FIELD(hs_cord_spec, twist_mm, FLOAT, 1, 400, false),
};

static const hs_json_field cloud_fields[] = {
    OTHER("type", true),
    NAMED("centre_mm", hs_cloud_spec, centre, VEC3, -400, 800, true),
    NAMED("radii_mm", hs_cloud_spec, radii, VEC3, 0.5, 400, true),
    FIELD(hs_cloud_spec, count, UINT, 1, 1000, true),
    FIELD(hs_cloud_spec, particle_min_mm, FLOAT, 0.1, 20, true),
    FIELD(hs_cloud_spec, particle_max_mm, FLOAT, 0.1, 20, true),
};

static const hs_json_field fetus_fields[] = {
    OTHER("type", true),
    NAMED("position_mm", hs_fetus_spec, position, VEC3, -400, 800, true),
    NAMED("rotation_deg", hs_fetus_spec, rotation, VEC3, -360, 360, false),
    FIELD(hs_fetus_spec, scale, FLOAT, 0.1, 5, false),
    FIELD(hs_fetus_spec, gap_mm, FLOAT, -20, 60, false),
    NAMED("head_turn_deg", hs_fetus_spec, pose.head_turn_deg, VEC3, -180, 180, false),
    NAMED("right_elbow", hs_fetus_spec, pose.elbow[0], VEC3, -100, 100, false),
    NAMED("left_elbow", hs_fetus_spec, pose.elbow[1], VEC3, -100, 100, false),
    NAMED("right_hand", hs_fetus_spec, pose.hand[0], VEC3, -100, 100, false),
    NAMED("left_hand", hs_fetus_spec, pose.hand[1], VEC3, -100, 100, false),
    NAMED("right_knee", hs_fetus_spec, pose.knee[0], VEC3, -100, 100, false),
    NAMED("left_knee", hs_fetus_spec, pose.knee[1], VEC3, -100, 100, false),
    NAMED("right_ankle", hs_fetus_spec, pose.ankle[0], VEC3, -100, 100, false),
    NAMED("left_ankle", hs_fetus_spec, pose.ankle[1], VEC3, -100, 100, false),
};

static const hs_json_field nuchal_fields[] = {
    OTHER("type", true),
    FIELD(hs_nuchal_spec, fetus, UINT, 0, HS_SCENE_MAX_STRUCTURES - 1, false),
    FIELD(hs_nuchal_spec, loops, UINT, 1, HS_SCENE_MAX_LOOPS, false),
    FIELD(hs_nuchal_spec, radius_mm, FLOAT, 0.3, 20, true),
    FIELD(hs_nuchal_spec, twist_mm, FLOAT, 1, 400, false),
    FIELD(hs_nuchal_spec, slack_mm, FLOAT, 0, 20, false),
};

static const hs_json_field bladder_fields[] = {
    OTHER("type", true),
    NAMED("centre_mm", hs_bladder_spec, centre, VEC3, -400, 800, true),
    NAMED("radii_mm", hs_bladder_spec, radii, VEC3, 1, 400, true),
    NAMED("rotation_deg", hs_bladder_spec, rotation, VEC3, -360, 360, false),
    FIELD(hs_bladder_spec, wall_mm, FLOAT, 0.2, 20, false),
};

static bool read_structure(const hs_json *object, hs_structure *s) {
    hs_json type;
    const char *name;
    if (!hs_json_type(object, &type, &name)) return false;
    if (strcmp(name, "occluder") == 0) {
        s->kind = HS_STRUCTURE_OCCLUDER;
        s->of.occluder.gap_mm = NAN;
        return hs_json_read(object, occluder_fields, HS_COUNT(occluder_fields), &s->of.occluder);
    }
    if (strcmp(name, "cord") == 0) {
        s->kind = HS_STRUCTURE_CORD;
        s->of.cord.twist_mm = 20.0f;
        return hs_json_read(object, cord_fields, HS_COUNT(cord_fields), &s->of.cord);
    }
    if (strcmp(name, "cloud") == 0) {
        s->kind = HS_STRUCTURE_CLOUD;
        hs_cloud_spec *c = &s->of.cloud;
        if (!hs_json_read(object, cloud_fields, HS_COUNT(cloud_fields), c)) return false;
        if (c->particle_max_mm >= c->particle_min_mm) return true;
        hs_json_member(object, "particle_max_mm", &type);
        return hs_json_fail(&type, "is %g, expected at least particle_min_mm, %g", (double)c->particle_max_mm,
                            (double)c->particle_min_mm);
    }
    if (strcmp(name, "fetus") == 0) {
        s->kind = HS_STRUCTURE_FETUS;
        s->of.fetus.scale = 1.0f;
        s->of.fetus.gap_mm = NAN;
        s->of.fetus.pose = hs_fetus_resting;
        return hs_json_read(object, fetus_fields, HS_COUNT(fetus_fields), &s->of.fetus);
    }
    if (strcmp(name, "nuchal_cord") == 0) {
        s->kind = HS_STRUCTURE_NUCHAL_CORD;
        s->of.nuchal = (hs_nuchal_spec){.loops = 1, .twist_mm = 20.0f};
        return hs_json_read(object, nuchal_fields, HS_COUNT(nuchal_fields), &s->of.nuchal);
    }
    if (strcmp(name, "bladder") == 0) {
        s->kind = HS_STRUCTURE_BLADDER;
        s->of.bladder.wall_mm = 3.0f;
        return hs_json_read(object, bladder_fields, HS_COUNT(bladder_fields), &s->of.bladder);
    }
    return hs_json_fail(&type, "is '%.40s', expected occluder, cord, nuchal_cord, cloud, bladder or fetus",
                        name);
}

/* What refers to a fetus needs it. */
static bool check_references(const hs_json *array, const hs_scene_spec *spec) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < spec->structure_count; i++)
        count += spec->structure[i].kind == HS_STRUCTURE_FETUS;
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        const hs_structure *s = &spec->structure[i];
        hs_json at;
        hs_json_element(array, i, &at);
        if (s->kind == HS_STRUCTURE_NUCHAL_CORD && s->of.nuchal.fetus >= count)
            return hs_json_fail(&at, "fetus is %u, but the scene has %u", s->of.nuchal.fetus, count);
        if (s->kind == HS_STRUCTURE_OCCLUDER && !isnan(s->of.occluder.gap_mm) && count == 0)
            return hs_json_fail(&at, "gap_mm is %g, but the scene has no fetus",
                                (double)s->of.occluder.gap_mm);
    }
    return true;
}

bool hs_scene_read_structures(const hs_json *array, hs_scene_spec *spec) {
    if (!hs_json_is_array(array, 0, HS_SCENE_MAX_STRUCTURES)) return false;
    spec->structure_count = (uint32_t)json_array_size(array->value);
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        hs_json object;
        hs_json_element(array, i, &object);
        if (!read_structure(&object, &spec->structure[i])) return false;
    }
    return check_references(array, spec);
}
