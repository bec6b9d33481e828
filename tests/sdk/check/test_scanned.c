/* SPDX-License-Identifier: MIT */
/*
 * Scanned ranges (sv_frame.scanned): the device against the definition for every layout of work, sampling and
 * way of handing them over; ranges and padding value, the same where both are right; and what begin refuses.
 * Requirement: R4.
 */
#include "support/compare.h"

/* Wider than a vector of 64 rays and no multiple; deeper than a chunk of 254 / substeps slices. */
enum { WIDTH = 85, HEIGHT = 7, SLICES = 300, RAYS = WIDTH * HEIGHT };

typedef struct {
    rig r;
    uint8_t volume[RAYS * SLICES];
    sv_scanned ranges[RAYS];
} scene;

static uint32_t noise(uint32_t *random) {
    *random = *random * 1664525u + 1013904223u;
    return *random >> 24;
}

/* Layers, with bone; ranges of every kind: whole, late, early, one slice, none, empty, and beyond the
 * volume. */
static int setup(void **state) {
    scene *s = unit_memory(sizeof *s);
    rig_open(&s->r, NULL);
    uint32_t random = 4711;
    for (size_t z = 0; z < SLICES; z++)
        for (size_t i = 0; i < RAYS; i++)
            s->volume[z * RAYS + i] = (uint8_t)((z + i) % 23 < 9     ? noise(&random) % 45
                                                : noise(&random) % 9 ? 30 + noise(&random) % 150
                                                                     : 250);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t first = noise(&random) * SLICES / 300, end = first + 1 + noise(&random);
        const sv_scanned kinds[] = {{0, SLICES},
                                    {(uint16_t)first, SLICES},
                                    {(uint16_t)first, (uint16_t)end},
                                    {(uint16_t)first, (uint16_t)(first + 1)},
                                    {40, 40},
                                    {200, 100},
                                    {253, 65535},
                                    {(uint16_t)(254 + i % 3), (uint16_t)(256 + i % 5)}};
        s->ranges[i] = kinds[i % (sizeof kinds / sizeof *kinds)];
    }
    *state = s;
    return 0;
}

static int teardown(void **state) {
    scene *s = *state;
    rig_close(&s->r);
    return unit_end(state);
}

static rig_format format_of(const scene *s) {
    return (rig_format){.width = WIDTH,
                        .height = HEIGHT,
                        .slices = SLICES,
                        .slab_slices = 77,
                        .padding = SV_NO_PADDING,
                        .scanned = s->ranges};
}

static rig_settings settings_of(uint32_t substeps) {
    rig_settings s = rig_default_settings();
    s.substeps = substeps;
    s.evidence = 0.0;
    return s;
}

static void device_is_definition(void **state) {
    scene *s = *state;
    for (uint32_t n = 0; n < 6; n++) {
        rig_format f = format_of(s);
        const uint32_t strategy = 1 + n % 3, substeps = n / 3 % 2 ? 3 : 1;
        f.padding = n % 4 < 2 ? 30 : SV_NO_PADDING;
        f.fixed[0] = (sv_param_value){rig_param(&s->r, "strategy"), 0, strategy};
        f.fixed[1] = (sv_param_value){rig_param(&s->r, "substeps"), 0, substeps};
        const rig_settings settings = settings_of(substeps);
        compare_run(&s->r, &f, s->volume, &settings, "ranges in memory");
        f.scanned_in_buffer = true;
        f.carrier = n % 2 ? SV_CARRIER_BUFFER : SV_CARRIER_IMAGE;
        compare_run(&s->r, &f, s->volume, &settings, "ranges in a buffer");
        if (n > 0) continue;
        f.scanned_in_buffer = false;
        f.carrier = SV_CARRIER_HOST;
        f.own_queue = true;
        compare_run(&s->r, &f, s->volume, &settings, "ranges, own queue");
    }
    (void)compare_print("scanned ranges");
}

/* A volume whose unscanned voxels, and only those, hold 0: ranges, padding value and
 * both give the same bits. */
static void ranges_are_padding(void **state) {
    scene *s = *state;
    for (size_t i = 0; i < RAYS; i++)
        for (uint32_t z = 0; z < SLICES; z++) {
            uint8_t *v = &s->volume[z * RAYS + i];
            const bool scanned = z >= s->ranges[i].first && z < s->ranges[i].end;
            *v = scanned ? (uint8_t)(*v | 1) : 0;
        }
    static const char *const methods[] = {"mean", "spline"};
    for (uint32_t m = 0; m < 2; m++) {
        rig_result out[3];
        for (uint32_t n = 0; n < 3; n++) {
            rig_format f = format_of(s);
            if (n == 0) f.scanned = NULL;
            f.padding = n == 1 ? SV_NO_PADDING : 0;
            f.fixed[0] =
                (sv_param_value){rig_param(&s->r, "method"), 0, rig_enum(&s->r, "method", methods[m])};
            const sv_param_value value = {rig_param(&s->r, "evidence"), 0, 0.0};
            out[n] = rig_result_make(WIDTH, HEIGHT);
            assert_int_equal(rig_run(&s->r, &f, s->volume, &value, 1, &out[n]), SV_OK);
            assert_memory_equal(out[n].depth, out[0].depth, RAYS * sizeof(float));
            assert_memory_equal(out[n].status, out[0].status, RAYS);
        }
    }
}

/* What begin says to a frame whose ranges are not as the format has it; the instance goes on. */
static void wrong_ranges(void **state) {
    scene *s = *state;
    const sv_plugin *p = s->r.plugin;
    const rig_format f = format_of(s);
    stage *t = rig_stage(&s->r, &f, s->volume);
    assert_int_equal(p->activate(p, &t->format), SV_OK);
    const cl_mem small = rig_buffer(&s->r, RAYS * 4 - 1);
    const cl_mem foreign = rig_foreign_buffer(&s->r, (size_t)RAYS * 4);
    const struct {
        const char *part;
        const sv_scanned *scanned;
        cl_mem object;
        uint64_t offset;
    } wrong[] = {{"0 of scanned and scanned_object given, expected 1", NULL, NULL, 0},
                 {"2 of scanned and scanned_object given, expected 1", s->ranges, small, 0},
                 {"scanned_object has 2379 bytes, and 2380 are needed from 0 on", NULL, small, 0},
                 {"scanned_object at offset 2: expected a multiple of 4", NULL, small, 2},
                 {"2380 are needed from 18446744073709551612 on", NULL, small, UINT64_MAX - 3},
                 {"scanned_object is of another context", NULL, foreign, 0}};
    for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        sv_frame frame = stage_frame(t, NULL, 0);
        frame.scanned = wrong[n].scanned;
        frame.scanned_object = wrong[n].object;
        frame.scanned_offset = wrong[n].offset;
        assert_int_equal(p->begin(p, &frame), SV_ERR_ARGUMENT);
        if (!strstr(p->last_error(p), wrong[n].part))
            fail_msg("'%s' in '%s'", wrong[n].part, p->last_error(p));
    }
    rig_result out = rig_result_make(WIDTH, HEIGHT);
    assert_true(rig_frame(&s->r, t, NULL, 0, &out) >= SV_OK);
    p->deactivate(p);

    t->format.flags = 0;
    assert_int_equal(p->activate(p, &t->format), SV_OK);
    const sv_frame unasked = stage_frame(t, NULL, 0);
    assert_int_equal(p->begin(p, &unasked), SV_ERR_ARGUMENT);
    assert_non_null(strstr(p->last_error(p), "expected 0 with the format's flags 0x0"));
    p->deactivate(p);
    t->format.flags = 2;
    assert_int_equal(p->activate(p, &t->format), SV_ERR_ARGUMENT);
    assert_non_null(strstr(p->last_error(p), "flags is 0x2"));
}

#define SCENE_TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)
UNIT_MAIN_OF(NULL, NULL, SCENE_TEST(device_is_definition), SCENE_TEST(ranges_are_padding),
             SCENE_TEST(wrong_ranges))
