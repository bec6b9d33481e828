/* SPDX-License-Identifier: MIT */
/* Random scenes: the same seed gives the same file on every machine, every number lies in its range,
 * every share is kept, every scene opens and has an exact truth. */
#include "scene/scene_draw.h"
#include "support/scene_fixture.h"

#include <jansson.h>
#include <zlib.h>

/* Whole numbers make the text, so its sum is the same everywhere. It changes when the table or the
 * drawing does: then the scenes of a seed are others, and figures that were measured on them are to be
 * measured again. */
static void a_seed_is_a_text(void **state) {
    uLong crc = 0;
    for (uint32_t i = 0; i < 200; i++) {
        const hs_scene_drawn seven = {false, 7, i}, eight = {false, 8, i};
        char *text = hs_scene_draw(&seven), *again = hs_scene_draw(&seven), *other = hs_scene_draw(&eight);
        assert_string_equal(text, again);
        assert_string_not_equal(text, other);
        crc = crc32_z(crc, (const Bytef *)text, strlen(text));
        free(text);
        free(again);
        free(other);
    }
    assert_int_equal((uint32_t)crc, 0xa9f0544eu);
}

/* What a drawn number may be: on the steps of its range, both ends included and reached. */
static void numbers_lie_in_their_ranges(void **state) {
    for (int id = 0; id < HS_RANGE_COUNT; id++) {
        const hs_scene_range *r = &hs_scene_ranges[id];
        int32_t low = INT32_MAX, high = INT32_MIN;
        assert_true(r->step > 0 && r->low <= r->high && (r->high - r->low) % r->step == 0);
        for (uint64_t key = 1; key < 3000; key++) {
            const int32_t v = hs_range_draw(hs_random_key(key, 0), (hs_range_id)id, 0);
            assert_true(v >= r->low && v <= r->high && (v - r->low) % r->step == 0);
            low = v < low ? v : low;
            high = v > high ? v : high;
        }
        assert_int_equal(low, r->low);
        assert_int_equal(high, r->high);
    }
}

static bool holds(const json_t *root, const char *list, const char *type) {
    size_t i;
    json_t *one;
    json_array_foreach(json_object_get(root, list), i, one) {
        if (strcmp(json_string_value(json_object_get(one, "type")), type) == 0) return true;
    }
    return false;
}

/* Of a thousand scenes; three standard deviations of a share of p are 300 sqrt(p (1 - p) / 1000)
 * percent. A kind of scene that excludes another takes a little from its share. */
static void shares_are_kept(void **state) {
    enum { SCENES = 1000, SHARES = 9 };
    static const struct {
        const char *list, *type;
        double low, high; /* percent */
    } expected[SHARES] = {
        {"structures", "bladder", 8, 15},     {"structures", "nuchal_cord", 4, 11},
        {"structures", "cord", 37, 50},       {"structures", "cloud", 37, 50},
        {"artefacts", "haze", 60, 75},        {"artefacts", "slice_thickness", 55, 65},
        {"artefacts", "dark_corner", 30, 40}, {"artefacts", "edge_shadow", 76, 84},
        {"artefacts", "side_lobes", 35, 45},
    };
    double found[SHARES] = {0}, fetuses[3] = {0}, turned = 0.0, touching = 0.0;
    for (uint32_t s = 0; s < SCENES; s++) {
        const hs_scene_drawn scene = {false, 3, s};
        char *text = hs_scene_draw(&scene);
        json_t *root = json_loads(text, 0, NULL), *one;
        size_t i, count = 0;
        assert_non_null(root);
        for (int k = 0; k < SHARES; k++) found[k] += holds(root, expected[k].list, expected[k].type);
        bool touches = false;
        json_array_foreach(json_object_get(root, "structures"), i, one) {
            count += strcmp(json_string_value(json_object_get(one, "type")), "fetus") == 0;
            touches = touches || json_number_value(json_object_get(one, "gap_mm")) < 0.0;
        }
        assert_true(count <= 2);
        fetuses[count] += 1.0;
        touching += touches;
        turned += json_object_get(root, "camera_deg") != NULL;
        json_decref(root);
        free(text);
    }
    for (int k = 0; k < SHARES; k++) {
        printf("%s: %.1f %%\n", expected[k].type, 100.0 * found[k] / SCENES);
        assert_true(found[k] * 100.0 / SCENES >= expected[k].low &&
                    found[k] * 100.0 / SCENES <= expected[k].high);
    }
    printf("no fetus %.1f %%, twins %.1f %%, turned %.1f %%, touching %.1f %%\n", fetuses[0] / 10.0,
           fetuses[2] / 10.0, turned / 10.0, touching / 10.0);
    assert_near(fetuses[0] / SCENES, 0.05, 0.021);
    assert_near(fetuses[2] / SCENES, 0.053, 0.022);
    assert_near(turned / SCENES, 0.165, 0.036);
    assert_true(touching > 0.2 * SCENES && touching < 0.4 * SCENES);
}

/* Every one can be opened, its gaps found, and made; the truth is exact. Frames, threads and sizes do
 * not matter to it. */
static void random_scenes_are_scenes(void **state) {
    for (uint32_t i = 0; i < 16; i++) {
        hs_error err = {0};
        const char *const name = unit_text("R11_%u", i);
        hs_scene *scene = hs_scene_open(name, &err);
        if (!scene) fail_msg("%s", err.text);
        assert_string_equal(hs_scene_name(scene), name);
        hs_scene_close(scene);
        hs_scene_data d = make_scene(name, 40, 2, 0, 0);
        for (size_t p = 0; p < (size_t)40 * 40; p++) check_scene_pixel(&d, p);
    }
}

/* Solids, labels and admissible depths are those of the scene without them; the volume is another one. */
static void greys_change_the_echoes_alone(void **state) {
    enum { SIDE = 40 };
    hs_scene_data plain = make_scene("R11_3", SIDE, 2, 0, 0);
    hs_scene_data greys = make_scene("G11_3", SIDE, 2, 0, 0);
    assert_memory_equal(plain.tissue, greys.tissue, (size_t)SIDE * SIDE * SIDE);
    assert_memory_equal(plain.near_end, greys.near_end, sizeof *plain.near_end * SIDE * SIDE);
    assert_memory_equal(plain.far_end, greys.far_end, sizeof *plain.far_end * SIDE * SIDE);
    assert_memory_equal(plain.label, greys.label, sizeof *plain.label * SIDE * SIDE);
    assert_memory_not_equal(plain.full.voxels, greys.full.voxels, (size_t)SIDE * SIDE * SIDE);
}

static void names_are_read_strictly(void **state) {
    static const char *const good[] = {"R0_0", "R7_3", "G7_3", "R18446744073709551_99999"};
    static const char *const bad[] = {"R7",        "R_1",   "R7_",  "R-1_2", "R7_03", "R07_3",
                                      "R7_100000", "R7_3 ", "r7_3", "R7_3x", "g7_3",  "S7_3"};
    hs_scene_drawn s;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_true(hs_scene_drawn_name(good[i], &s) && s.greys == (i == 2));
    assert_int_equal(s.seed, 18446744073709551u);
    assert_int_equal(s.number, 99999);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (hs_scene_drawn_name(bad[i], &s)) fail_msg("'%s' is taken for a random scene", bad[i]);
}

UNIT_MAIN(NULL, NULL, a_seed_is_a_text, numbers_lie_in_their_ranges, shares_are_kept,
          random_scenes_are_scenes, greys_change_the_echoes_alone, names_are_read_strictly)
