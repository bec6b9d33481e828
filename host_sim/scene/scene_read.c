/* SPDX-License-Identifier: MIT */
/* A scene file to hs_scene_spec. The tables are the schema (docs/scenes.md). */
#include "scene/scene_json.h"
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

#include <string.h>

static const hs_json_field top_fields[] = {
    FIELD(hs_scene_spec, name, TEXT, 0, 64, true),
    FIELD(hs_scene_spec, title, TEXT, 0, 512, true),
    OTHER("kind", false),
    FIELD(hs_scene_spec, seed, WHOLE, 1, 9e15, true),
    FIELD(hs_scene_spec, extent_mm, FLOAT, 20, 400, false),
    FIELD(hs_scene_spec, camera_deg, FLOAT, -360, 360, false),
    FIELD(hs_scene_spec, lead_mm, FLOAT, 0, 200, false),
    FIELD(hs_scene_spec, frequency_mhz, FLOAT, 0.5, 20, false),
    OTHER("display", false),
    OTHER("tissues", false),
    OTHER("sac", false),
    OTHER("layers", false),
    OTHER("structures", true),
    OTHER("artefacts", true),
    OTHER("motion", false),
};

static const hs_json_field display_fields[] = {
    FIELD(hs_scene_spec, dynamic_range_db, FLOAT, 20, 120, false),
    FIELD(hs_scene_spec, gain_db, FLOAT, -60, 60, false),
    FIELD(hs_scene_spec, specular_db, FLOAT, -60, 60, false),
    FIELD(hs_scene_spec, specular_power, FLOAT, 0, 16, false),
};

static const hs_json_field tissue_fields[] = {
    FIELD(hs_tissue_properties, echo_db, FLOAT, -150, 20, false),
    FIELD(hs_tissue_properties, attenuation_db_cm_mhz, FLOAT, 0, 40, false),
    FIELD(hs_tissue_properties, impedance_mrayl, FLOAT, 0.1, 10, false),
    FIELD(hs_tissue_properties, speed_m_s, FLOAT, 300, 6000, false),
};

static const hs_json_field sac_fields[] = {
    NAMED("centre_mm", hs_sac_spec, centre, FLOAT, -400, 800, true),
    NAMED("radii_mm", hs_sac_spec, radii, FLOAT, 1, 400, true),
    NAMED("rotation_deg", hs_sac_spec, rotation, FLOAT, -360, 360, false),
    FIELD(hs_sac_spec, roughness_mm, FLOAT, 0, 20, false),
    FIELD(hs_sac_spec, roughness_scale_mm, FLOAT, 1, 400, false),
};

static const hs_json_field motion_fields[] = {
    FIELD(hs_motion_spec, period_frames, FLOAT, 2, 100000, true),
    FIELD(hs_motion_spec, drift_mm, FLOAT, -50, 50, false),
    FIELD(hs_motion_spec, limb_mm, FLOAT, 0, 20, false),
    FIELD(hs_motion_spec, cloud_drift_mm, FLOAT, -50, 50, false),
};

static bool read_tissues(const hs_json *object, hs_scene_spec *spec) {
    hs_json_field names[HS_TISSUE_COUNT];
    for (int i = 0; i < HS_TISSUE_COUNT; i++) names[i] = (hs_json_field)OTHER(hs_tissue_names[i], false);
    if (!hs_json_read(object, names, HS_TISSUE_COUNT, NULL)) return false;
    for (int i = 0; i < HS_TISSUE_COUNT; i++) {
        hs_json tissue;
        if (hs_json_member(object, hs_tissue_names[i], &tissue) &&
            !hs_json_read(&tissue, tissue_fields, HS_COUNT(tissue_fields), &spec->tissue[i]))
            return false;
    }
    return true;
}

static const hs_json_field layers_fields[] = {
    FIELD(hs_layers_spec, undulation_mm, FLOAT, 0, 50, false),
    FIELD(hs_layers_spec, boundary_db, FLOAT, -80, 0, false),
    OTHER("list", true),
};
typedef struct {
    hs_tissue tissue;
    float thickness_mm;
} layer;
static const hs_json_field layer_fields[] = {
    OWN("tissue", layer, tissue, hs_scene_read_tissue, 0, 0, true),
    FIELD(layer, thickness_mm, FLOAT, 0, 200, true),
};

static bool read_layers(const hs_json *object, hs_layers_spec *layers) {
    if (!hs_json_read(object, layers_fields, HS_COUNT(layers_fields), layers)) return false;
    hs_json list;
    if (!hs_json_member(object, "list", &list) || !hs_json_is_array(&list, 0, HS_SCENE_MAX_LAYERS))
        return false;
    layers->count = (uint32_t)json_array_size(list.value);
    for (uint32_t i = 0; i < layers->count; i++) {
        hs_json item;
        layer l = {HS_TISSUE_WALL, 0.0f};
        hs_json_element(&list, i, &item);
        if (!hs_json_read(&item, layer_fields, HS_COUNT(layer_fields), &l)) return false;
        layers->tissue[i] = l.tissue;
        layers->thickness_mm[i] = l.thickness_mm;
    }
    return true;
}

static bool read_kind(const hs_json *value, hs_scene_spec *spec) {
    static const char *const kinds[] = {"synthetic", "real"};
    uint32_t kind;
    const bool ok = hs_json_word(value, kinds, 2, &kind);
    spec->real = kind == 1;
    return ok;
}

static void set_defaults(hs_scene_spec *spec) {
    memset(spec, 0, sizeof *spec);
    spec->extent_mm = 120.0f;
    spec->frequency_mhz = 3.5f;
    spec->dynamic_range_db = 60.0f;
    spec->gain_db = 8.0f;
    spec->specular_db = 6.0f;
    spec->specular_power = 2.0f;
    spec->sac.roughness_scale_mm = 40.0f;
    spec->layers.boundary_db = -25.0f;
    memcpy(spec->tissue, hs_tissue_defaults, sizeof spec->tissue);
    spec->haze = (hs_haze_spec){.level_db = -18.0f, .decay_db_mm = 1.5f, .patch_db = 6.0f, .patch_mm = 8.0f};
    spec->corner =
        (hs_corner_spec){.direction_deg = 45.0f, .start_mm = 15.0f, .width_mm = 30.0f, .loss_db = 20.0f};
    spec->slice = (hs_slice_spec){.elevation_mm = 1.2f, .focus_mm = 60.0f, .rayleigh_mm = 25.0f};
}

/* On every system: for Windows, what begins with "NUL." is a device, too, and "a " is "a". */
static bool is_file_name(const char *name) {
    static const char *const devices[] = {"CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$", "COM", "LPT"};
    size_t stem = strcspn(name, ".");
    while (stem > 0 && name[stem - 1] == ' ') stem--;
    for (size_t i = 0; i < HS_COUNT(devices); i++) {
        const size_t length = strlen(devices[i]);
        const bool port =
            i + 2 >= HS_COUNT(devices) && stem == length + 1 && name[length] >= '0' && name[length] <= '9';
        if ((stem == length || port) && strncasecmp(name, devices[i], length) == 0) return false;
    }
    return stem > 0 && !strpbrk(name, "/\\:*?\"<>|") && !strchr(" .", name[strlen(name) - 1]);
}

/* The name becomes part of file names. */
static bool check_name(const hs_json *root, const char *name) {
    hs_json at;
    return is_file_name(name) ||
           (hs_json_member(root, "name", &at) &&
            hs_json_fail(&at, "is '%.63s', expected a part of a file's name on every system", name));
}

static bool read_scene(const hs_json *root, hs_scene_spec *spec) {
    hs_json part;
    set_defaults(spec);
    if (!hs_json_read(root, top_fields, HS_COUNT(top_fields), spec) || !check_name(root, spec->name))
        return false;
    if (hs_json_member(root, "kind", &part) && !read_kind(&part, spec)) return false;
    if (hs_json_member(root, "lead_mm", &part) && (!spec->real || spec->lead_mm >= spec->extent_mm))
        return hs_json_fail(&part, "is %g, expected less than extent_mm, %g, in a scene of kind real",
                            (double)spec->lead_mm, (double)spec->extent_mm);
    if (spec->real && hs_json_member(root, "camera_deg", &part))
        return hs_json_fail(&part, "is for synthetic scenes");
    if (hs_json_member(root, "display", &part) &&
        !hs_json_read(&part, display_fields, HS_COUNT(display_fields), spec))
        return false;
    if (hs_json_member(root, "tissues", &part) && !read_tissues(&part, spec)) return false;
    if (hs_json_member(root, "sac", &part)) {
        if (!hs_json_read(&part, sac_fields, HS_COUNT(sac_fields), &spec->sac)) return false;
    } else if (spec->real) { /* all is fluid until the given volume says otherwise */
        for (int a = 0; a < 3; a++) spec->sac.radii[a] = 100.0f * spec->extent_mm;
    } else {
        return hs_json_fail(root, "has no field 'sac'");
    }
    if (hs_json_member(root, "layers", &part) && !read_layers(&part, &spec->layers)) return false;
    if (hs_json_member(root, "structures", &part) && !hs_scene_read_structures(&part, spec)) return false;
    if (hs_json_member(root, "artefacts", &part) && !hs_scene_read_artefacts(&part, spec)) return false;
    spec->motion.on = hs_json_member(root, "motion", &part);
    return !spec->motion.on || hs_json_read(&part, motion_fields, HS_COUNT(motion_fields), &spec->motion);
}

bool hs_scene_read_text(const char *path, const char *text, hs_scene_spec *spec, hs_error *err) {
    json_error_t bad;
    json_t *value = json_loads(text, JSON_REJECT_DUPLICATES, &bad);
    if (!value)
        return hs_fail(err, HS_ERR_INPUT, "%s:%d: column %d: not JSON: %s", path, bad.line, bad.column,
                       bad.text);
    const hs_json_file file = {path, "scene", err};
    const hs_json root = {.file = &file, .value = value};
    bool ok = read_scene(&root, spec);
    json_decref(value);
    return ok;
}
