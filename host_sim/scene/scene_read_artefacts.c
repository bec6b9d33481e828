/* SPDX-License-Identifier: MIT */
#include "scene/scene_read_artefacts.h"

#include "scene/scene_fields.h"

#include <string.h>

static const hs_json_field attenuation_fields[] = {
    OTHER("type", true),
    FIELD(hs_attenuation_spec, tgc_db_cm_mhz, FLOAT, 0, 5, true),
};
static const hs_json_field edge_fields[] = {
    OTHER("type", true),
    FIELD(hs_edge_spec, max_loss_db, FLOAT, 0, 60, true),
};
static const hs_json_field reverberation_fields[] = {
    OTHER("type", true),
    FIELD(hs_reverberation_spec, count, UINT, 1, 20, true),
    FIELD(hs_reverberation_spec, spacing_mm, FLOAT, 0, 100, false),
    FIELD(hs_reverberation_spec, loss_db, FLOAT, 0, 60, true),
};
static const hs_json_field haze_fields[] = {
    OTHER("type", true),
    FIELD(hs_haze_spec, level_db, FLOAT, -60, 0, false),
    FIELD(hs_haze_spec, decay_db_mm, FLOAT, 0.05, 20, false),
    FIELD(hs_haze_spec, patch_db, FLOAT, 0, 20, false),
    FIELD(hs_haze_spec, patch_mm, FLOAT, 1, 60, false),
};
static const hs_json_field corner_fields[] = {
    OTHER("type", true),
    FIELD(hs_corner_spec, direction_deg, FLOAT, -360, 360, false),
    FIELD(hs_corner_spec, start_mm, FLOAT, -200, 200, false),
    FIELD(hs_corner_spec, width_mm, FLOAT, 1, 200, false),
    FIELD(hs_corner_spec, loss_db, FLOAT, 0, 60, false),
};
static const hs_json_field slice_fields[] = {
    OTHER("type", true),
    FIELD(hs_slice_spec, elevation_mm, FLOAT, 0, 6, false),
    FIELD(hs_slice_spec, focus_mm, FLOAT, 0, 400, false),
    FIELD(hs_slice_spec, rayleigh_mm, FLOAT, 1, 10000, false),
};
static const hs_json_field far_band_fields[] = {
    OTHER("type", true),
    FIELD(hs_far_band_spec, gap_mm, FLOAT, 0, 20, true),
    FIELD(hs_far_band_spec, thickness_mm, FLOAT, 0.1, 20, true),
    FIELD(hs_far_band_spec, level_db, FLOAT, -60, 20, true),
    FIELD(hs_far_band_spec, direction, VEC3, -1, 1, true),
    FIELD(hs_far_band_spec, angle_deg, FLOAT, 1, 180, true),
};
static const hs_json_field speckle_fields[] = {
    OTHER("type", true),
    FIELD(hs_speckle_spec, axial_mm, FLOAT, 0, 5, true),
    FIELD(hs_speckle_spec, lateral_mm, FLOAT, 0, 5, true),
    FIELD(hs_speckle_spec, focus_mm, FLOAT, 0, 400, true),
    FIELD(hs_speckle_spec, rayleigh_mm, FLOAT, 1, 10000, true),
};
static const hs_json_field side_lobe_fields[] = {
    OTHER("type", true),
    FIELD(hs_side_lobe_spec, level_db, FLOAT, -80, 0, true),
    FIELD(hs_side_lobe_spec, width_mm, FLOAT, 0.5, 60, true),
};
static const hs_json_field noise_fields[] = {
    OTHER("type", true),
    FIELD(hs_noise_spec, level_db, FLOAT, -120, 0, true),
};
static const hs_json_field fan_fields[] = {
    OTHER("type", true),
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
            return hs_json_read(object, artefact_kinds[i].fields, artefact_kinds[i].count, settings);
        }
    return hs_json_fail(&type,
                        "is '%.40s', expected attenuation, edge_shadow, reverberation, haze, dark_corner, "
                        "slice_thickness, far_band, speckle, side_lobes, noise or fan",
                        name);
}

void hs_scene_artefact_defaults(hs_scene_spec *spec) {
    spec->haze = (hs_haze_spec){.level_db = -18.0f, .decay_db_mm = 1.5f, .patch_db = 6.0f, .patch_mm = 8.0f};
    spec->corner =
        (hs_corner_spec){.direction_deg = 45.0f, .start_mm = 15.0f, .width_mm = 30.0f, .loss_db = 20.0f};
    spec->slice = (hs_slice_spec){.elevation_mm = 1.2f, .focus_mm = 60.0f, .rayleigh_mm = 25.0f};
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
