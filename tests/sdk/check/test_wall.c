/* SPDX-License-Identifier: MIT */
/*
 * Method wall against its definition (docs/surface.md): on scenes, on any volume, by any split into slabs,
 * with ranges, padding and spacing, at any knob position, in both layouts of the work. Everything up to the
 * layers is integer arithmetic, so on a device that divides exactly the maps are the same bits.
 */
#include "ref/ref_wall.h"
#include "scene/scene.h"
#include "support/rig.h"
#include "support/surfaces.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct {
    uint32_t width, height, slices, slab_slices;
    int32_t padding;
    float spacing_mm[3]; /* zeros: unknown */
    const sv_scanned *scanned;
} shape;

/* Knob positions: that of the frame, then those that it is moved to. Few, because the definitions take most
 * of the time, and one more position runs no other code. */
static const double places[] = {0.5, 0.0, 0.5, 1.5};
enum { PLACES = sizeof places / sizeof *places };

/* The definition's maps at every position; outcome and facts are the same at all of them. */
typedef struct {
    float *depth[PLACES], *confidence;
    bool clip_doubtful;
    sv_wall_outcome outcome;
    sv_wall_facts facts;
} expected;

static bool clips(const expected *e) {
    return e->outcome == SV_WALL_SURFACE || (e->outcome == SV_WALL_DOUBTFUL && e->clip_doubtful);
}

static expected expect(const shape *s, const uint8_t *volume, bool clip_doubtful) {
    const size_t count = (size_t)s->width * s->height;
    const sv_ref_volume v = {volume,    s->width,   s->height,
                             s->slices, s->padding, (const sv_ref_range *)s->scanned};
    const double mm[3] = {(double)s->spacing_mm[0], (double)s->spacing_mm[1], (double)s->spacing_mm[2]};
    sv_wall_settings settings = sv_wall_settings_default();
    settings.clip_doubtful = clip_doubtful;
    expected e = {.clip_doubtful = clip_doubtful, .confidence = calloc(count, sizeof(float))};
    for (size_t n = 0; n < PLACES; n++) {
        e.depth[n] = calloc(count, sizeof(float));
        assert_true(e.depth[n] && e.confidence);
        if (n > 0 && places[n] == places[0]) /* moving the knob back gives the same map */
            memcpy(e.depth[n], e.depth[0], count * sizeof(float));
        else {
            settings.q = places[n];
            assert_true(
                sv_wall_surface_padded(&v, mm, &settings, e.depth[n], e.confidence, &e.outcome, &e.facts));
        }
    }
    return e;
}

static void expected_free(expected *e) {
    for (size_t n = 0; n < PLACES; n++) free(e->depth[n]);
    free(e->confidence);
}

static double largest_difference(const float *a, const float *b, size_t count) {
    double worst = 0.0;
    for (size_t i = 0; i < count; i++) {
        assert_true(isfinite(a[i]));
        worst = fmax(worst, fabs((double)a[i] - (double)b[i]));
    }
    return worst;
}

/* True if the device divides float32 exactly: then every operation of the definition has one right answer. */
static bool is_exact(const rig *r) {
    cl_device_fp_config config = 0;
    assert_int_equal(clGetDeviceInfo(r->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof config, &config, NULL), 0);
    return (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}

/* Checks `adjust` after a frame at q = 0.5: it gives the definition's maps, and a larger q lies nowhere
 * behind a smaller one. */
static void check_knob(rig *r, const shape *s, const expected *e, double bound) {
    const size_t count = (size_t)s->width * s->height;
    float *last = malloc(count * sizeof *last);
    rig_result out = rig_result_make(s->width, s->height);
    assert_non_null(last);
    for (size_t n = 1; n < PLACES; n++) {
        const sv_param_value q = {rig_param(r, "q"), 0, places[n]};
        const sv_result result = {.size = sizeof result, .depth = out.depth};
        assert_true(r->plugin->adjust(r->plugin, &q, 1, &result) >= SV_OK);
        if (r->queue) assert_int_equal(clFinish(r->queue), CL_SUCCESS);
        const double error = largest_difference(out.depth, e->depth[n], count);
        if (error > bound) fail_msg("q %g: error %g slices", places[n], error);
        for (size_t i = 0; n > 1 && i < count; i++) assert_true(out.depth[i] <= last[i]);
        memcpy(last, out.depth, count * sizeof *last);
    }
    rig_result_free(&out);
    free(last);
}

/* Runs a frame in which all was scanned, and lets the next one forget it: blocks that are outside of the scan
 * from then on must not be seen. */
static void scan_all(rig *r, stage *t, const shape *s, rig_result *out) {
    const size_t count = (size_t)s->width * s->height;
    for (size_t i = 0; i < count; i++) t->ranges[i] = (sv_scanned){0, (uint16_t)s->slices};
    assert_true(rig_frame(r, t, NULL, 0, out) >= SV_OK);
    memcpy(t->ranges, s->scanned, count * sizeof *t->ranges);
    t->frame_flags = SV_FRAME_DISCONTINUITY;
}

/* Compares one layout of the work. With strategy rays a work item has a ray, with all others a row. */
static void compare_layout(rig *r, const shape *s, const uint8_t *volume, const expected *e,
                           const char *strategy, const char *what) {
    const size_t count = (size_t)s->width * s->height;
    const double bound = is_exact(r) ? 0.0 : s->slices * 16.0 * 0x1p-24;
    const rig_format f = {.width = s->width,
                          .height = s->height,
                          .slices = s->slices,
                          .slab_slices = s->slab_slices,
                          .padding = s->padding,
                          .scanned = s->scanned,
                          .extra_w = 3,
                          .fixed = {{rig_param(r, "method"), 0, rig_enum(r, "method", "wall")},
                                    {rig_param(r, "strategy"), 0, rig_enum(r, "strategy", strategy)}},
                          .fixed_count = 2};
    stage *t = rig_stage(r, &f, volume);
    memcpy(t->format.spacing_mm, s->spacing_mm, sizeof s->spacing_mm);
    rig_result out = rig_result_make(s->width, s->height);
    float *confidence = calloc(count, sizeof *confidence);
    sv_confidence_report report = {.size = sizeof report};
    const sv_ext_confidence *ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_true(confidence && ext);
    const sv_status active = r->plugin->activate(r->plugin, &t->format);
    if (active != SV_OK) fail_msg("%s: %s", what, r->last_log);
    if (s->scanned) scan_all(r, t, s, &out);
    const sv_param_value unsure = {rig_param(r, "unsure"), 0, e->clip_doubtful};
    const sv_status status = rig_frame(r, t, &unsure, 1, &out);
    assert_int_equal(ext->read(r->plugin, confidence, &report), SV_OK);
    check_knob(r, s, e, bound);
    r->plugin->deactivate(r->plugin);
    const double depth_error = largest_difference(out.depth, e->depth[0], count);
    const double confidence_error = largest_difference(confidence, e->confidence, count);
    print_message(
        "%-24s %-6s %3u x %3u x %3u, slabs of %2u: error %.1e slices, confidence %.1e; T %u, %u of %u rays "
        "begin in the wall%s\n",
        what, strategy, s->width, s->height, s->slices, s->slab_slices, depth_error, confidence_error,
        e->facts.threshold, e->facts.wall_rays, e->facts.rays, clips(e) ? "" : ", no surface");
    assert_int_equal(status, clips(e) ? SV_OK : SV_NO_SURFACE);
    assert_true(depth_error <= bound);
    for (size_t i = 0; i < count; i++) assert_true(confidence[i] >= 0.0f && confidence[i] <= 1.0f);
    assert_true(confidence_error <= (bound > 0.0 ? 1e-6 : 0.0));
    assert_true(fabs((double)report.fluid_threshold * 255.0 - e->facts.threshold) < 1e-3);
    assert_int_equal(report.reason, e->outcome); /* by the same numbers */
    const double share = e->outcome == SV_WALL_NO_FETUS ? e->facts.fetus : e->facts.gap_share;
    if (e->outcome == SV_WALL_SURFACE || e->outcome == SV_WALL_EMPTY) {
        assert_true(report.found == 0.0f && report.wanted == 0.0f);
    } else {
        assert_true(fabs((double)report.found - share) <= 0.001);
        assert_true(report.found < report.wanted);
    }
    const bool tries = e->outcome == SV_WALL_DOUBTFUL && !e->clip_doubtful;
    assert_int_equal(report.try_id, tries ? unsure.id : 0);
    assert_int_equal(report.try_value, tries);
    if (e->outcome == SV_WALL_SURFACE) {
        assert_int_equal(report.rays, e->facts.rays);
        assert_int_equal(report.open_rays, e->facts.wall_rays);
    }
    rig_stage_free(t);
    rig_result_free(&out);
    free(confidence);
}

/* Compares both layouts, and a doubtful surface with and without clipping there. Returns true if there is a
 * surface. */
static bool compare(rig *r, const shape *s, const uint8_t *volume, const char *what) {
    static const char *const layouts[] = {"single", "rays"};
    bool surface = false;
    for (int clip = 0; clip < 2 && !surface; clip++) {
        expected e = expect(s, volume, clip);
        for (size_t n = 0; n < sizeof layouts / sizeof *layouts; n++)
            compare_layout(r, s, volume, &e, layouts[n], what);
        surface = clips(&e);
        expected_free(&e);
        if (e.outcome != SV_WALL_DOUBTFUL) break;
    }
    return surface;
}

/* The nine scenes; a bladder; a fetus whose tissue fades, so that little of what is dark lies in front of it.
 */
static void test_scenes(void **state) {
    static const char *const names[] = {"E01", "E02", "E03", "E04", "M01", "M02",
                                        "M03", "D01", "D02", "H09", "R9_7"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        hs_scene_data data;
        hs_error err = {0};
        assert_true(hs_scene_generate(names[n], 96, 1, &data, &err));
        const shape s = {.width = 96, .height = 96, .slices = 96, .slab_slices = 16};
        assert_true(compare(*state, &s, data.full.voxels, names[n]));
        if (n == 1) {
            const uint32_t lengths[] = {96, 1, 7};
            for (size_t i = 0; i < 3; i++) {
                shape other = s;
                other.slab_slices = lengths[i];
                assert_true(compare(*state, &other, data.full.voxels, "other slabs"));
            }
        }
        hs_scene_free(&data);
    }
}

/* Sizes that are no multiple of anything, and volumes that are no scans. */
static void test_any_volume(void **state) {
    static const shape shapes[] = {
        {75, 40, 61, 9, 0, {0}, NULL}, {171, 33, 171, 16, 0, {0}, NULL}, {17, 130, 40, 40, -1, {0}, NULL},
        {1, 1, 1, 1, 0, {0}, NULL},    {3, 5, 2, 1, 0, {0}, NULL},       {40, 40, 200, 16, 255, {0}, NULL},
        {64, 48, 1, 1, -1, {0}, NULL}, {1, 1, 90, 16, -1, {0}, NULL},    {90, 90, 30, 16, 7, {0}, NULL}};
    static const char *const kinds[] = {"noise", "extremes", "layers", "sparse"};
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++)
        for (int kind = 0; kind < RIG_KIND_COUNT; kind++) {
            const shape *s = &shapes[n];
            uint8_t *volume = rig_volume((rig_kind)kind, s->width, s->height, s->slices, 77 + (uint32_t)n);
            (void)compare(*state, s, volume, kinds[kind]);
            free(volume);
        }
}

/* Tissue, fluid and bone in layers of up to `longest` slices, the same for patches of rays but for their
 * ends: thin tissue, narrow fluid, rays that begin in fluid. */
static uint8_t *layered_noise(uint32_t width, uint32_t height, uint32_t slices, uint32_t longest,
                              uint32_t patch_side, uint32_t seed) {
    static const uint8_t levels[] = {4, 80, 8, 120, 12, 204}; /* a quarter more at most */
    const size_t plane = (size_t)width * height;
    uint8_t *volume = malloc(plane * slices);
    uint32_t own = seed * 2654435761u + 1;
    assert_non_null(volume);
    for (size_t i = 0; i < plane; i++) {
        uint32_t patch =
            (uint32_t)(i % width / patch_side * 7919 + i / width / patch_side * 104729 + seed + 1) *
            2654435761u;
        if (patch == 0) patch = 1;
        for (uint32_t n = 0; n < 4; n++) (void)surface_random(&patch);
        for (uint32_t z = 0, layer = surface_random(&patch) % 2; z < slices; layer++) {
            const uint8_t level = levels[layer % 6];
            const uint32_t length = 1 + surface_random(&patch) % longest + surface_random(&own) % 3;
            for (uint32_t n = 0; n < length && z < slices; n++, z++)
                volume[z * plane + i] = (uint8_t)(level + surface_random(&own) % (level / 4 + 1));
        }
    }
    return volume;
}

/* Voxels of other sizes: other windows, labels and cells. */
static void test_spacings(void **state) {
    static const float spacings[][3] = {{1.0f, 1.0f, 1.0f},    {0.9f, 0.9f, 0.9f},   {0.5f, 0.5f, 0.5f},
                                        {0.3f, 0.4f, 0.35f},   {0.15f, 0.2f, 0.12f}, {0.05f, 0.05f, 0.05f},
                                        {0.01f, 3.0f, 0.7f},   {0.9f, 0.9f, 0.2f},   {2.0f, 1.0f, 4.5f},
                                        {20.0f, 20.0f, 20.0f}, {50.0f, 0.7f, 0.7f}};
    uint32_t surfaces = 0;
    for (uint32_t n = 0; n < sizeof spacings / sizeof *spacings; n++) {
        shape s = {.width = 70, .height = 61, .slices = 90, .slab_slices = 16, .padding = SV_NO_PADDING};
        const double longest = 9.0 / (double)spacings[n][2];
        uint8_t *volume = layered_noise(s.width, s.height, s.slices, 10 + (uint32_t)fmin(longest, 30.0),
                                        14 + (uint32_t)fmin(2.5 / (double)spacings[n][1], 36.0), n);
        char what[64];
        memcpy(s.spacing_mm, spacings[n], sizeof s.spacing_mm);
        (void)snprintf(what, sizeof what, "%g, %g, %g mm", (double)s.spacing_mm[0], (double)s.spacing_mm[1],
                       (double)s.spacing_mm[2]);
        surfaces += compare(*state, &s, volume, what);
        free(volume);
    }
    assert_true(surfaces >= 6); /* or the test would prove little */
}

/* Ranges that differ from ray to ray, some of them empty: single blocks whose neighbours were not scanned. */
static sv_scanned *ragged_ranges(uint32_t width, uint32_t height, uint32_t slices, uint32_t seed) {
    sv_scanned *ranges = calloc((size_t)width * height, sizeof *ranges);
    uint32_t random = seed * 2654435761u + 1;
    assert_non_null(ranges);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        const uint32_t first = surface_random(&random) % (slices / 8 + 1);
        const uint32_t end = slices - surface_random(&random) % (slices / 8 + 1);
        if (surface_random(&random) % 19 > 0) ranges[i] = (sv_scanned){(uint16_t)first, (uint16_t)end};
    }
    return ranges;
}

/* Voxels of 1.4 to 2 mm are blocks of their own, which are smoothed: along all axes and along single ones,
 * with ranges and without, padded, in sizes that are no multiple of anything. */
static void test_single_voxels(void **state) {
    static const struct {
        uint32_t size[3];
        float mm[3];
    } cases[] = {{{70, 61, 66}, {1.5f, 1.5f, 1.5f}},  {{67, 71, 59}, {1.8f, 1.8f, 1.8f}},
                 {{65, 45, 53}, {2.0f, 1.9f, 1.6f}},  {{71, 83, 90}, {1.8f, 0.9f, 0.9f}},
                 {{83, 67, 90}, {0.9f, 1.7f, 0.8f}},  {{90, 75, 55}, {0.8f, 0.9f, 1.9f}},
                 {{33, 64, 100}, {1.4f, 1.5f, 1.0f}}, {{31, 1, 70}, {2.0f, 2.0f, 2.0f}},
                 {{1, 29, 64}, {1.8f, 1.8f, 1.8f}},   {{32, 97, 1}, {1.5f, 1.5f, 1.5f}}};
    uint32_t surfaces = 0;
    for (uint32_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const uint32_t width = cases[n].size[0], height = cases[n].size[1], slices = cases[n].size[2];
        uint8_t *volume = layered_noise(width, height, slices, 10, 9, 40 + n);
        sv_scanned *ranges = ragged_ranges(width, height, slices, n);
        for (int kind = 0; kind < 3; kind++) {
            const shape s = {.width = width,
                             .height = height,
                             .slices = slices,
                             .slab_slices = 7 + 9 * n % 20,
                             .padding = kind == 2 ? 4 : SV_NO_PADDING,
                             .spacing_mm = {cases[n].mm[0], cases[n].mm[1], cases[n].mm[2]},
                             .scanned = kind > 0 ? ranges : NULL};
            surfaces += compare(*state, &s, volume, "blocks of one voxel");
        }
        free(ranges);
        free(volume);
    }
    assert_true(surfaces >= 18);
}

/* No ray begins in a wall: tissue floats in the fluid, or bone begins with the first slice. There the fetus
 * has begun at once. */
static void test_bone_at_once(void **state) {
    const shape s = {.width = 150,
                     .height = 40,
                     .slices = 64,
                     .slab_slices = 16,
                     .padding = SV_NO_PADDING,
                     .spacing_mm = {0.9f, 0.9f, 0.9f}};
    const size_t plane = (size_t)s.width * s.height;
    uint8_t *volume = malloc(plane * s.slices);
    uint32_t random = 7;
    assert_non_null(volume);
    for (size_t i = 0; i < plane * s.slices; i++) {
        const size_t x = i % s.width, z = i / plane;
        const int level = x >= 50 || z >= 48 ? 245 : z >= 8 && z < 16 ? 100 : 5;
        volume[i] = (uint8_t)(level + (int)(surface_random(&random) % 10));
    }
    assert_true(compare(*state, &s, volume, "bone at once"));
    free(volume);
}

static void test_layered_noise(void **state) {
    uint32_t surfaces = 0;
    for (uint32_t n = 0; n < 6; n++) {
        shape s = {
            .width = 50 + 11 * n, .height = 61, .slices = 80 - 7 * n, .slab_slices = 16, .padding = -1};
        for (int axis = 0; axis < 3; axis++) s.spacing_mm[axis] = 0.5f + 0.3f * (float)n;
        uint8_t *volume = layered_noise(s.width, s.height, s.slices, 12, 14, n);
        surfaces += compare(*state, &s, volume, "layered noise");
        free(volume);
    }
    assert_true(surfaces >= 5);
}

/* Unscanned voxels, and only those, hold 0, so ranges, a padding value and both give the same maps. It
 * changes the volume. */
static void assert_ranges_are_padding(rig *r, uint8_t *volume, const sv_scanned *ranges, uint32_t width,
                                      uint32_t height, uint32_t slices) {
    const size_t plane = (size_t)width * height;
    for (size_t i = 0; i < plane; i++)
        for (uint32_t z = 0; z < slices; z++) {
            uint8_t *v = &volume[z * plane + i];
            *v = z >= ranges[i].first && z < ranges[i].end ? (uint8_t)(*v | 1) : 0;
        }
    const shape told = {width, height, slices, 10, SV_NO_PADDING, {0}, ranges};
    shape both = told, padded = told;
    both.padding = padded.padding = 0;
    padded.scanned = NULL;
    const shape *const all[] = {&told, &both, &padded};
    expected first = expect(&told, volume, false);
    for (size_t n = 0; n < 3; n++) {
        expected e = expect(all[n], volume, false);
        assert_memory_equal(e.depth[0], first.depth[0], plane * sizeof(float));
        assert_true(compare(r, all[n], volume, "ranges or padding"));
        expected_free(&e);
    }
    expected_free(&first);
}

/* A box that is scanned, seen from an edge: around it, before it and behind it nothing was. Rows and vectors
 * of rays have layers of their own, and some have none. */
static void test_turned_box(void **state) {
    enum { W = 133, H = 58, D = 90 };
    static sv_scanned ranges[W * H];
    uint8_t *volume = layered_noise(W, H, D, 24, 14, 9);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            const uint32_t aside = (x > 80 ? x - 80 : 80 - x) / 2, above = y / 6;
            const uint32_t first = 9 + aside + above, end = 85 - above - aside / 3;
            ranges[y * W + x] = (sv_scanned){(uint16_t)D, (uint16_t)D};
            if (y > 5 && y < 49 && aside < 21)
                ranges[y * W + x] = (sv_scanned){(uint16_t)first, (uint16_t)end};
        }
    const float mm[] = {0.3f, 0.7f, 0.9f, 2.0f};
    for (size_t i = 0; i < 4; i++) {
        const shape s = {W, H, D, i % 2 ? 7 : D, SV_NO_PADDING, {mm[i], mm[i], mm[i]}, ranges};
        assert_true(compare(*state, &s, volume, "a turned box"));
    }
    free(volume);
}

/* Ranges of a fan, with rays that were not scanned, with and without a padding value besides. */
static void test_ranges(void **state) {
    enum { W = 70, H = 53, D = 64 };
    static sv_scanned ranges[W * H];
    hs_scene_data data;
    hs_error err = {0};
    assert_true(hs_scene_generate("E01", D, 1, &data, &err));
    uint8_t *volume = layered_noise(W, H, D, 12, 14, 9);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            const uint32_t off = (x > W / 2 ? x - W / 2 : W / 2 - x) / 3 + y / 12;
            ranges[y * W + x] = (sv_scanned){(uint16_t)off, (uint16_t)(D - off / 2)};
            if ((x * 7 + y * 3) % 31 == 0) ranges[y * W + x] = (sv_scanned){9, 9};
            for (uint32_t z = 0; z < D && x < D; z++)
                volume[((size_t)z * H + y) * W + x] = data.full.voxels[((size_t)z * D + y) * D + x];
        }
    const int32_t paddings[] = {SV_NO_PADDING, 0, 4, 255};
    for (size_t i = 0; i < 4; i++) {
        const shape s = {W, H, D, 10, paddings[i], {1.0f, 1.1f, 0.9f}, ranges};
        assert_true(compare(*state, &s, volume, "ranges of a fan"));
    }
    assert_ranges_are_padding(*state, volume, ranges, W, H, D);
    memset(ranges, 0, sizeof ranges);
    const shape none = {W, H, D, 10, SV_NO_PADDING, {0}, ranges};
    assert_false(compare(*state, &none, volume, "nothing was scanned"));
    free(volume);
    hs_scene_free(&data);
}

int main(void) {
    const struct CMUnitTest tests[] = {RIG_TEST(test_scenes),        RIG_TEST(test_spacings),
                                       RIG_TEST(test_single_voxels), RIG_TEST(test_bone_at_once),
                                       RIG_TEST(test_any_volume),    RIG_TEST(test_layered_noise),
                                       RIG_TEST(test_ranges),        RIG_TEST(test_turned_box)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
