/* SPDX-License-Identifier: MIT */
/* Scene files: what is wrong with one is told with file and field. */
#include "support/scene_fixture.h"

static void refuse(const char *text, const char *expected) {
    hs_scene_spec spec;
    must_not(hs_scene_read_text("x.json", text, &spec, &err), HS_ERR_INPUT, expected);
}

/* EMPTY_SCENE with `more` as its only structure or artefact. */
static void refuse_part(const char *structure, const char *artefact, const char *expected) {
    char text[2048];
    snprintf(text, sizeof text,
             "{ \"name\": \"t\", \"title\": \"t\", \"seed\": 1,\n"
             "  \"sac\": { \"centre_mm\": [60, 60, 60], \"radii_mm\": [40, 40, 40] },\n"
             "  \"structures\": [\n    %s\n  ],\n"
             "  \"artefacts\": [\n    %s\n  ] }\n",
             structure, artefact);
    refuse(text, expected);
}

static void reads_defaults(void **state) {
    hs_scene_spec spec = empty_spec();
    assert_near(spec.extent_mm, 120.0f, 0.0f);
    assert_near(spec.tissue[HS_TISSUE_BONE].impedance_mrayl, 3.75f, 0.0f);
    assert_int_equal(spec.structure_count, 0);
    assert_false(spec.haze.on || spec.corner.on || spec.slice.on);
    for (int a = 0; a < 3; a++) assert_near(spec.camera_deg[a], 0.0f, 0.0f);
    assert_false(spec.speckle.on || spec.attenuation.on || spec.edge.on || spec.reverberation.on ||
                 spec.far_band.on || spec.side_lobe.on || spec.noise.on || spec.fan.on || spec.motion.on);
}

static void tells_the_line_of_syntax_errors(void **state) {
    refuse("{\n  \"name\": \"t\",\n  nonsense\n}", "x.json:3:");
    refuse("", "x.json:1:");
    refuse("{ \"name\": \"a\",\n \"name\": \"b\" }", "x.json:2:");
    refuse("[]", "scene: is an array, expected an object");
}

static void tells_the_field(void **state) {
    refuse("{ \"name\": \"t\", \"title\": \"t\",\n  \"sead\": 1 }",
           "x.json: sead: is no field of this object");
    refuse("{ \"name\": \"t\", \"title\": \"t\",\n\n  \"seed\": 0 }", "x.json: seed: is 0, expected 1");
    refuse("{ \"name\": \"t\", \"title\": \"t\",\n  \"seed\": 1.5 }",
           "x.json: seed: is a number, expected a whole");
    refuse("{ \"name\": 5 }", "x.json: name: is a number, expected a string");
    refuse("{ \"name\": \"t\", \"title\": \"t\" }", "x.json: scene: has no field 'seed'");
    refuse("{ \"name\": \"t\", \"title\": \"t\", \"seed\": 1, \"structures\": [], \"artefacts\": [] }",
           "has no field 'sac'");
    refuse_part("{ \"type\": \"bird\" }", "", "x.json: structures[0].type: is 'bird', expected occluder");
    refuse_part("{ \"type\": \"fetus\",\n      \"position_mm\": [1, 2] }", "",
                "x.json: structures[0].position_mm: has 2 elements, expected 3");
    refuse_part("{ \"type\": \"fetus\",\n\n      \"position_mm\": [1, 2, \"x\"] }", "",
                "x.json: structures[0].position_mm[2]: is a string, expected a number");
    refuse_part(
        "{ \"type\": \"occluder\", \"tissue\": \"wood\", \"centre_mm\": [1, 2, 3], \"radii_mm\": [1, 1, 1] }",
        "", "x.json: structures[0].tissue: is 'wood', expected one of fluid, wall");
    refuse_part("{ \"type\": \"cord\", \"radius_mm\": 2, \"points_mm\": [[1, 2, 3]] }", "",
                "structures[0].points_mm: has 1 elements, expected 2 .. 32");
    refuse_part("{ \"type\": \"cloud\", \"centre_mm\": [1, 2, 3], \"radii_mm\": [1, 1, 1], \"count\": 3,\n"
                "\"particle_min_mm\": 2,\n \"particle_max_mm\": 1 }",
                "", "x.json: structures[0].particle_max_mm: is 1, expected at least");
    refuse_part("", "{ \"type\": \"noise\", \"level_db\": -60 },\n{ \"type\": \"noise\", \"level_db\": -60 }",
                "x.json: artefacts[1].type: 'noise' is listed twice");
    refuse_part("", "{ \"type\": \"speckle\" }", "artefacts[0]: has no field 'axial_mm'");
    refuse_part("", "{ \"level_db\": 3 }", "artefacts[0]: has no field 'type'");
    refuse_part("",
                "{ \"type\": \"far_band\", \"gap_mm\": 1, \"thickness_mm\": 1, \"level_db\": 0,\n"
                "\"direction\": [0, 0, 0], \"angle_deg\": 20 }",
                "direction is 0, 0, 0");
    refuse_part("", "{ \"type\": \"haze\", \"level_db\": 1 }",
                "artefacts[0].level_db: is 1, expected -60 .. 0");
    refuse_part("", "{ \"type\": \"fog\" }",
                "expected attenuation, edge_shadow, reverberation, haze, dark_corner");
    refuse_part("", "{ \"type\": \"slice_thickness\" }",
                "shapes the point spread of speckle, which is not listed");
    refuse_part("{ \"type\": \"nuchal_cord\", \"radius_mm\": 2, \"loops\": 4 }", "",
                "structures[0].loops: is 4, expected 1 .. 3");
    refuse_part("{ \"type\": \"bladder\", \"centre_mm\": [1, 2, 3] }", "",
                "structures[0]: has no field 'radii_mm'");
    refuse(
        "{ \"name\": \"t\", \"title\": \"t\", \"seed\": 1, \"kind\": \"real\",\n \"camera_deg\": [0, 9, 0],\n"
        "\"structures\": [], \"artefacts\": [] }",
        "x.json: camera_deg: is for synthetic scenes");
    refuse_part("7", "", "x.json: structures[0]: is a number, expected an object");
}

/* Every byte of a real scene file in turn left out, doubled, or made something else: a scene or an error with
 * a text, never a crash (the sanitizers look on). */
static void survives_broken_files(void **state) {
    static char text[16384], broken[16400];
    const char *folder = getenv("SV_SOURCE_DIR");
    char path[1024];
    snprintf(path, sizeof path, "%s/data/scenes/M03.json", folder ? folder : ".");
    FILE *file = fopen(path, "rb");
    if (!file) skip();
    size_t length = fread(text, 1, sizeof text - 1, file), refused = 0, variants = 0;
    fclose(file);
    assert_true(length > 1000 && length < sizeof text - 1);
    const char put[] = {'0', '-', '"', '[', '}', '\\'};
    for (size_t i = 0; i < length; i++)
        for (size_t v = 0; v < 2 + sizeof put; v++, variants++) {
            size_t kept = v == 0 ? 0 : v == 1 ? 2 : 1;
            memcpy(broken, text, i);
            for (size_t k = 0; k < kept; k++) broken[i + k] = v < 2 ? text[i] : put[v - 2];
            memcpy(broken + i + kept, text + i + 1, length - i - 1);
            broken[length - 1 + kept] = '\0';
            hs_scene_spec spec;
            hs_error err = {0};
            if (hs_scene_read_text(path, broken, &spec, &err)) continue;
            refused++;
            unit_told(err, HS_ERR_INPUT, "M03.json:");
        }
    printf("%zu of %zu broken files refused\n", refused, variants);
    assert_true(refused > variants / 2);
}

static void names_missing_files_and_bad_options(void **state) {
    hs_error err = {0};
    assert_null(hs_scene_open("/nowhere/at/all.json", &err));
    assert_non_null(strstr(err.text, "/nowhere/at/all.json: cannot be read"));
    memset(&err, 0, sizeof err);
    assert_null(hs_scene_open("Z99", &err));
    assert_non_null(strstr(err.text, "Z99.json"));
    memset(&err, 0, sizeof err);
    hs_scene_data data;
    hs_scene *scene = hs_scene_open("D01", &err);
    assert_false(hs_scene_frame(scene, &(hs_scene_options){.size = 31}, &data, &err));
    hs_scene_close(scene);
    unit_told(err, HS_ERR_USAGE, "size is 31, expected 32 .. 512");
    memset(&err, 0, sizeof err);
    scene = hs_scene_open("real", &err);
    assert_false(hs_scene_frame(scene, &(hs_scene_options){.size = 64}, &data, &err));
    hs_scene_close(scene);
    assert_non_null(strstr(err.text, "needs a volume"));
    assert_null(data.full.voxels);
}

UNIT_MAIN(NULL, NULL, reads_defaults, tells_the_line_of_syntax_errors, tells_the_field, survives_broken_files,
          names_missing_files_and_bad_options)
