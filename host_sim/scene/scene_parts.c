/* SPDX-License-Identifier: MIT */
/* Structures and artefacts of a scene file. The tables are the schema (docs/scenes.md). */
#include "scene/scene_json.h"
#include "scene/scene_spec.h"

#include <math.h>
#include <string.h>

bool hs_scene_read_tissue(const hs_json *v, const hs_json_field *f, void *to) {
    uint32_t word;
    (void)f;
    if (!hs_json_word(v, hs_tissue_names, HS_TISSUE_COUNT, &word)) return false;
    *(hs_tissue *)to = (hs_tissue)word;
    return true;
}

/* At least two. */
static bool read_points(const hs_json *v, const hs_json_field *f, void *to) {
    hs_points *out = to;
    if (!hs_json_is_array(v, 2, HS_SCENE_MAX_POINTS)) return false;
    out->count = (uint32_t)json_array_size(v->value);
    for (uint32_t i = 0; i < out->count; i++) {
        hs_json point;
        double p[3];
        hs_json_element(v, i, &point);
        if (!hs_json_numbers(&point, 3, f->min, f->max, p)) return false;
        for (int a = 0; a < 3; a++) out->p[i][a] = (float)p[a];
    }
    return true;
}

static const hs_json_field attenuation_fields[] = {
    FIELD(hs_attenuation_spec, tgc_db_cm_mhz, FLOAT, 0, 5, true),
};
static const hs_json_field edge_fields[] = {
    FIELD(hs_edge_spec, max_loss_db, FLOAT, 0, 60, true),
};
static const hs_json_field reverberation_fields[] = {
    FIELD(hs_reverberation_spec, count, UINT, 1, 20, true),
    FIELD(hs_reverberation_spec, spacing_mm, FLOAT, 0, 100, false),
    FIELD(hs_reverberation_spec, loss_db, FLOAT, 0, 60, true),
};
static const hs_json_field haze_fields[] = {
    FIELD(hs_haze_spec, level_db, FLOAT, -60, 0, false),
    FIELD(hs_haze_spec, decay_db_mm, FLOAT, 0.05, 20, false),
    FIELD(hs_haze_spec, patch_db, FLOAT, 0, 20, false),
    FIELD(hs_haze_spec, patch_mm, FLOAT, 1, 60, false),
};
static const hs_json_field corner_fields[] = {
    FIELD(hs_corner_spec, direction_deg, FLOAT, -360, 360, false),
    FIELD(hs_corner_spec, start_mm, FLOAT, -200, 200, false),
    FIELD(hs_corner_spec, width_mm, FLOAT, 1, 200, false),
    FIELD(hs_corner_spec, loss_db, FLOAT, 0, 60, false),
};
static const hs_json_field slice_fields[] = {
    FIELD(hs_slice_spec, elevation_mm, FLOAT, 0, 6, false),
    FIELD(hs_slice_spec, focus_mm, FLOAT, 0, 400, false),
    FIELD(hs_slice_spec, rayleigh_mm, FLOAT, 1, 10000, false),
};
static const hs_json_field far_band_fields[] = {
    FIELD(hs_far_band_spec, gap_mm, FLOAT, 0, 20, true),
    FIELD(hs_far_band_spec, thickness_mm, FLOAT, 0.1, 20, true),
    FIELD(hs_far_band_spec, level_db, FLOAT, -60, 20, true),
    FIELD(hs_far_band_spec, direction, FLOAT, -1, 1, true),
    FIELD(hs_far_band_spec, angle_deg, FLOAT, 1, 180, true),
};
static const hs_json_field speckle_fields[] = {
    FIELD(hs_speckle_spec, axial_mm, FLOAT, 0, 5, true),
    FIELD(hs_speckle_spec, lateral_mm, FLOAT, 0, 5, true),
    FIELD(hs_speckle_spec, focus_mm, FLOAT, 0, 400, true),
    FIELD(hs_speckle_spec, rayleigh_mm, FLOAT, 1, 10000, true),
};
static const hs_json_field side_lobe_fields[] = {
    FIELD(hs_side_lobe_spec, level_db, FLOAT, -80, 0, true),
    FIELD(hs_side_lobe_spec, width_mm, FLOAT, 0.5, 60, true),
};
static const hs_json_field noise_fields[] = {
    FIELD(hs_noise_spec, level_db, FLOAT, -120, 0, true),
};
static const hs_json_field fan_fields[] = {
    FIELD(hs_fan_spec, azimuth_deg, FLOAT, 5, 170, true),
    FIELD(hs_fan_spec, sweep_deg, FLOAT, 5, 170, true),
    FIELD(hs_fan_spec, azimuth_radius_mm, FLOAT, 0, 400, true),
    FIELD(hs_fan_spec, sweep_radius_mm, FLOAT, 0, 400, true),
    FIELD(hs_fan_spec, depth_mm, FLOAT, 5, 800, true),
};

/* A kind of artefact: its table, and where its settings stand in the spec (`on` first). */
static const struct {
    const char *type;
    const hs_json_field *fields;
    size_t count, offset;
} artefact_kinds[] = {
    {"attenuation", attenuation_fields, HS_COUNT(attenuation_fields), offsetof(hs_scene_spec, attenuation)},
    {"edge_shadow", edge_fields, HS_COUNT(edge_fields), offsetof(hs_scene_spec, edge)},
    {"reverberation", reverberation_fields, HS_COUNT(reverberation_fields),
     offsetof(hs_scene_spec, reverberation)},
    {"haze", haze_fields, HS_COUNT(haze_fields), offsetof(hs_scene_spec, haze)},
    {"dark_corner", corner_fields, HS_COUNT(corner_fields), offsetof(hs_scene_spec, corner)},
    {"slice_thickness", slice_fields, HS_COUNT(slice_fields), offsetof(hs_scene_spec, slice)},
    {"far_band", far_band_fields, HS_COUNT(far_band_fields), offsetof(hs_scene_spec, far_band)},
    {"speckle", speckle_fields, HS_COUNT(speckle_fields), offsetof(hs_scene_spec, speckle)},
    {"side_lobes", side_lobe_fields, HS_COUNT(side_lobe_fields), offsetof(hs_scene_spec, side_lobe)},
    {"noise", noise_fields, HS_COUNT(noise_fields), offsetof(hs_scene_spec, noise)},
    {"fan", fan_fields, HS_COUNT(fan_fields), offsetof(hs_scene_spec, fan)},
};

static bool read_artefact(const hs_json *object, hs_scene_spec *spec) {
    hs_json type;
    const char *name;
    if (!hs_json_type(object, &type, &name)) return false;
    for (size_t i = 0; i < HS_COUNT(artefact_kinds); i++)
        if (strcmp(name, artefact_kinds[i].type) == 0) {
            char *settings = (char *)spec + artefact_kinds[i].offset;
            bool *on = (bool *)(void *)settings;
            if (*on) return hs_json_fail(&type, "'%s' is listed twice", name);
            *on = true;
            return hs_json_read_typed(object, artefact_kinds[i].fields, artefact_kinds[i].count, settings);
        }
    return hs_json_fail(&type,
                        "is '%.40s', expected attenuation, edge_shadow, reverberation, haze, dark_corner, "
                        "slice_thickness, far_band, speckle, side_lobes, noise or fan",
                        name);
}

bool hs_scene_read_artefacts(const hs_json *array, hs_scene_spec *spec) {
    if (!hs_json_is_array(array, 0, 2 * HS_COUNT(artefact_kinds))) return false;
    for (size_t i = 0; i < json_array_size(array->value); i++) {
        hs_json object;
        hs_json_element(array, i, &object);
        if (!read_artefact(&object, spec)) return false;
    }
    const float *to = spec->far_band.direction;
    if (spec->far_band.on && to[0] == 0.0f && to[1] == 0.0f && to[2] == 0.0f)
        return hs_json_fail(array, "the far_band's direction is 0, 0, 0");
    if (spec->slice.on && !spec->speckle.on)
        return hs_json_fail(array, "slice_thickness shapes the point spread of speckle, which is not listed");
    return true;
}

static const hs_json_field occluder_fields[] = {
    OWN("tissue", hs_occluder_spec, tissue, hs_scene_read_tissue, 0, 0, true),
    NAMED("centre_mm", hs_occluder_spec, centre, FLOAT, -400, 800, true),
    NAMED("radii_mm", hs_occluder_spec, radii, FLOAT, 0.2, 400, true),
    NAMED("rotation_deg", hs_occluder_spec, rotation, FLOAT, -360, 360, false),
    FIELD(hs_occluder_spec, blend_mm, FLOAT, 0, 50, false),
    FIELD(hs_occluder_spec, echo_db, FLOAT, -40, 20, false),
    FIELD(hs_occluder_spec, soft_mm, FLOAT, 0, 20, false),
    FIELD(hs_occluder_spec, gap_mm, FLOAT, -20, 60, false),
};

static const hs_json_field cord_fields[] = {
    OWN("points_mm", hs_cord_spec, points, read_points, -400, 800, true),
    FIELD(hs_cord_spec, radius_mm, FLOAT, 0.3, 20, true),
    FIELD(hs_cord_spec, twist_mm, FLOAT, 1, 400, false),
};

static const hs_json_field cloud_fields[] = {
    NAMED("centre_mm", hs_cloud_spec, centre, FLOAT, -400, 800, true),
    NAMED("radii_mm", hs_cloud_spec, radii, FLOAT, 0.5, 400, true),
    FIELD(hs_cloud_spec, count, UINT, 1, 1000, true),
    FIELD(hs_cloud_spec, particle_min_mm, FLOAT, 0.1, 20, true),
    FIELD(hs_cloud_spec, particle_max_mm, FLOAT, 0.1, 20, true),
};

static const hs_json_field fetus_fields[] = {
    NAMED("position_mm", hs_fetus_spec, position, FLOAT, -400, 800, true),
    NAMED("rotation_deg", hs_fetus_spec, rotation, FLOAT, -360, 360, false),
    FIELD(hs_fetus_spec, scale, FLOAT, 0.1, 5, false),
    FIELD(hs_fetus_spec, gap_mm, FLOAT, -20, 60, false),
    NAMED("head_turn_deg", hs_fetus_spec, pose.head_turn_deg, FLOAT, -180, 180, false),
    NAMED("right_elbow", hs_fetus_spec, pose.elbow[0], FLOAT, -100, 100, false),
    NAMED("left_elbow", hs_fetus_spec, pose.elbow[1], FLOAT, -100, 100, false),
    NAMED("right_hand", hs_fetus_spec, pose.hand[0], FLOAT, -100, 100, false),
    NAMED("left_hand", hs_fetus_spec, pose.hand[1], FLOAT, -100, 100, false),
    NAMED("right_knee", hs_fetus_spec, pose.knee[0], FLOAT, -100, 100, false),
    NAMED("left_knee", hs_fetus_spec, pose.knee[1], FLOAT, -100, 100, false),
    NAMED("right_ankle", hs_fetus_spec, pose.ankle[0], FLOAT, -100, 100, false),
    NAMED("left_ankle", hs_fetus_spec, pose.ankle[1], FLOAT, -100, 100, false),
};

static const hs_json_field nuchal_fields[] = {
    FIELD(hs_nuchal_spec, fetus, UINT, 0, HS_SCENE_MAX_STRUCTURES - 1, false),
    FIELD(hs_nuchal_spec, loops, UINT, 1, HS_SCENE_MAX_LOOPS, false),
    FIELD(hs_nuchal_spec, radius_mm, FLOAT, 0.3, 20, true),
    FIELD(hs_nuchal_spec, twist_mm, FLOAT, 1, 400, false),
    FIELD(hs_nuchal_spec, slack_mm, FLOAT, 0, 20, false),
};

static const hs_json_field bladder_fields[] = {
    NAMED("centre_mm", hs_bladder_spec, centre, FLOAT, -400, 800, true),
    NAMED("radii_mm", hs_bladder_spec, radii, FLOAT, 1, 400, true),
    NAMED("rotation_deg", hs_bladder_spec, rotation, FLOAT, -360, 360, false),
    FIELD(hs_bladder_spec, wall_mm, FLOAT, 0.2, 20, false),
};

/* A kind of structure: its table, and what it is where the file says nothing. A fetus rests with its arms
 * before the chest, and its legs drawn up and crossed. */
static const struct {
    const char *type;
    const hs_json_field *fields;
    size_t count;
    hs_structure start;
} structure_kinds[] = {
    {"occluder",
     occluder_fields,
     HS_COUNT(occluder_fields),
     {HS_STRUCTURE_OCCLUDER, {.occluder = {.gap_mm = NAN}}}},
    {"cord", cord_fields, HS_COUNT(cord_fields), {HS_STRUCTURE_CORD, {.cord = {.twist_mm = 20.0f}}}},
    {"cloud", cloud_fields, HS_COUNT(cloud_fields), {.kind = HS_STRUCTURE_CLOUD}},
    {"fetus",
     fetus_fields,
     HS_COUNT(fetus_fields),
     {HS_STRUCTURE_FETUS,
      {.fetus = {.scale = 1.0f,
                 .gap_mm = NAN,
                 .pose = {.elbow = {{-21.0f, 10.0f, -7.0f}, {21.0f, 11.0f, -6.0f}},
                          .hand = {{-7.0f, 1.0f, -19.0f}, {9.0f, -5.0f, -18.0f}},
                          .knee = {{-15.0f, 21.0f, -18.0f}, {16.0f, 23.0f, -17.0f}},
                          .ankle = {{3.0f, 40.0f, -19.0f}, {-4.0f, 44.0f, -14.0f}}}}}}},
    {"nuchal_cord",
     nuchal_fields,
     HS_COUNT(nuchal_fields),
     {HS_STRUCTURE_NUCHAL_CORD, {.nuchal = {.loops = 1, .twist_mm = 20.0f}}}},
    {"bladder",
     bladder_fields,
     HS_COUNT(bladder_fields),
     {HS_STRUCTURE_BLADDER, {.bladder = {.wall_mm = 3.0f}}}},
};

static bool check_cloud(const hs_json *object, const hs_cloud_spec *cloud) {
    hs_json maximum;
    if (cloud->particle_max_mm >= cloud->particle_min_mm) return true;
    hs_json_member(object, "particle_max_mm", &maximum);
    return hs_json_fail(&maximum, "is %g, expected at least particle_min_mm, %g",
                        (double)cloud->particle_max_mm, (double)cloud->particle_min_mm);
}

static bool read_structure(const hs_json *object, hs_structure *s) {
    hs_json type;
    const char *name;
    if (!hs_json_type(object, &type, &name)) return false;
    for (size_t i = 0; i < HS_COUNT(structure_kinds); i++) {
        if (strcmp(name, structure_kinds[i].type) != 0) continue;
        *s = structure_kinds[i].start;
        return hs_json_read_typed(object, structure_kinds[i].fields, structure_kinds[i].count, &s->of) &&
               (s->kind != HS_STRUCTURE_CLOUD || check_cloud(object, &s->of.cloud));
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
