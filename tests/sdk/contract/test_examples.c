/* SPDX-License-Identifier: MIT */
/*
 * What the example plugins compute: known volumes give known depths, the one with kernels equals the one on
 * the CPU bit for bit over layouts, carriers, padding and scanned ranges. And what author_cl.h says of
 * kernels that do not build. What else author.h refuses, sv_validate tries on both, and the tests of the
 * plugin, which stands on it, hold its words.
 */
#include "programs/shared_programs.h"
#include "support/rig.h"

enum { WIDTH = 19, HEIGHT = 13, SLICES = 22, RAYS = WIDTH * HEIGHT };

typedef struct {
    rig cpu, kernels;
    rig_result a, b;
} examples;

static int open_examples(void **state) {
    static examples e;
    char path[1024];
    const char *build = getenv("SV_BUILD_DIR");
    (void)snprintf(path, sizeof path, "%s/examples/first_edge.so", build ? build : ".");
    rig_open(&e.cpu, path);
    (void)snprintf(path, sizeof path, "%s/examples/kernel_edge.so", build ? build : ".");
    rig_open(&e.kernels, path);
    e.a = rig_result_make(WIDTH, HEIGHT);
    e.b = rig_result_make(WIDTH, HEIGHT);
    *state = &e;
    return 0;
}

static int close_examples(void **state) {
    examples *e = *state;
    rig_close(&e->cpu);
    rig_close(&e->kernels);
    return 0;
}

static rig_format plain(void) {
    return (rig_format){.width = WIDTH,
                        .height = HEIGHT,
                        .slices = SLICES,
                        .slab_slices = 5,
                        .own_queue = true,
                        .padding = SV_NO_PADDING};
}

/* One frame of an activation, with ranges (NULL: without). The outcome. */
static sv_status run(rig *r, const rig_format *f, const uint8_t *volume, const sv_scanned *ranges,
                     const sv_param_value *values, uint32_t count, rig_result *out) {
    rig_format how = *f;
    how.scanned = ranges;
    how.voxel_mm = 1.5f;
    const sv_status status = rig_run(r, &how, volume, values, count, out);
    if (status < SV_OK) fail_msg("%d: %s", status, r->last_log);
    return status;
}

/* ---- known answers */

static void assert_depth(const examples *e, uint32_t ray, double expected) {
    if ((double)e->a.depth[ray] != expected)
        fail_msg("ray %u: depth %g, expected %g", ray, (double)e->a.depth[ray], expected);
}

static uint8_t *layers(uint32_t near, uint32_t far) {
    uint8_t *volume = unit_memory(SLICES * RAYS);
    for (uint32_t i = 0; i < SLICES * RAYS; i++) {
        const uint32_t z = i / RAYS;
        volume[i] = z < near || z >= far ? 150 : 10;
    }
    return volume;
}

static void set_ray(uint8_t *volume, uint32_t ray, uint8_t value) {
    for (uint32_t z = 0; z < SLICES; z++) volume[z * RAYS + ray] = value;
}

/* Fluid in slices 6 .. 13: from its end (13.5) to its beginning (5.5). */
static void depth_follows_q(void **state) {
    examples *e = *state;
    const rig_format f = plain();
    uint8_t *volume = layers(6, 14);
    static const double at[] = {0.0, 0.25, 0.5, 1.0};
    for (size_t n = 0; n < sizeof at / sizeof *at; n++) {
        const sv_param_value q = {rig_param(&e->cpu, "q"), 0, at[n]};
        assert_int_equal(run(&e->cpu, &f, volume, NULL, &q, 1, &e->a), SV_OK);
        for (uint32_t i = 0; i < RAYS; i++) {
            assert_depth(e, i, 13.5 - 8.0 * at[n]);
            assert_int_equal(e->a.status[i], SV_POINT_INITIAL);
        }
        assert_int_equal(e->a.stats.points, RAYS);
        assert_int_equal(e->a.stats.rays, RAYS);
    }
}

/* A ray alone with another depth, or without one, takes that of its neighbours. */
static void outliers_and_holes(void **state) {
    examples *e = *state;
    const rig_format f = plain();
    const sv_param_value q = {rig_param(&e->cpu, "q"), 0, 0.0};
    uint8_t *volume = layers(6, 14);
    const uint32_t hole = 5 * WIDTH + 7, outlier = 9 * WIDTH + 12;
    set_ray(volume, hole, 10);
    volume[18 * RAYS + outlier] = 150;
    for (uint32_t z = 14; z < 18; z++) volume[z * RAYS + outlier] = 10;
    assert_int_equal(run(&e->cpu, &f, volume, NULL, &q, 1, &e->a), SV_OK);
    for (uint32_t i = 0; i < RAYS; i++) assert_depth(e, i, 13.5);
    assert_int_equal(e->a.status[hole], SV_POINT_NONE);
    assert_int_equal(e->a.status[outlier], SV_POINT_INITIAL);
    assert_int_equal(e->a.stats.points, RAYS - 1);
}

/* Columns 0 .. 5 are fluid all along: pixels further than two columns from an edge have no surface. */
static void a_part_without_surface(void **state) {
    examples *e = *state;
    const rig_format f = plain();
    uint8_t *volume = layers(6, 14);
    for (uint32_t i = 0; i < RAYS; i++)
        if (i % WIDTH < 6) set_ray(volume, i, 10);
    assert_int_equal(run(&e->cpu, &f, volume, NULL, NULL, 0, &e->a), SV_PARTIAL);
    assert_int_equal(e->a.stats.unfilled, 4 * HEIGHT);
    for (uint32_t i = 0; i < RAYS; i++) assert_depth(e, i, i % WIDTH < 4 ? 0.0 : 13.5 - 0.25 * 8.0);
    memset(volume, 150, SLICES * RAYS);
    assert_int_equal(run(&e->cpu, &f, volume, NULL, NULL, 0, &e->a), SV_NO_SURFACE);
    assert_int_equal(e->a.stats.unfilled, RAYS);
    for (uint32_t i = 0; i < RAYS; i++) assert_depth(e, i, 0.0);
}

/* The gap is in millimetres: 8 slices of 1.5 mm are fluid enough for 12 mm, and not for 12.5. */
static void gap_in_millimetres(void **state) {
    examples *e = *state;
    const rig_format f = plain();
    uint8_t *volume = layers(6, 14);
    sv_param_value gap = {rig_param(&e->cpu, "gap"), 0, 12.0};
    assert_int_equal(run(&e->cpu, &f, volume, NULL, &gap, 1, &e->a), SV_OK);
    gap.value = 12.5;
    assert_int_equal(run(&e->cpu, &f, volume, NULL, &gap, 1, &e->a), SV_NO_SURFACE);
}

/* What was not scanned is skipped: with ranges that begin in the fluid no ray has tissue before it, and black
 * voxels of the padding value are no fluid. */
static void only_what_was_scanned(void **state) {
    examples *e = *state;
    rig_format f = plain();
    uint8_t *volume = layers(6, 14);
    sv_scanned ranges[RAYS];
    for (uint32_t i = 0; i < RAYS; i++) ranges[i] = (sv_scanned){0, 14};
    assert_int_equal(run(&e->cpu, &f, volume, ranges, NULL, 0, &e->a), SV_NO_SURFACE);
    for (uint32_t i = 0; i < RAYS; i++) ranges[i] = (sv_scanned){5, 65535};
    assert_int_equal(run(&e->cpu, &f, volume, ranges, NULL, 0, &e->a), SV_OK);
    for (uint32_t i = 0; i < RAYS; i++) ranges[i] = (sv_scanned){6, SLICES};
    assert_int_equal(run(&e->cpu, &f, volume, ranges, NULL, 0, &e->a), SV_NO_SURFACE);
    f.padding = 10;
    assert_int_equal(run(&e->cpu, &f, volume, NULL, NULL, 0, &e->a), SV_NO_SURFACE);
}

/* ---- the two are equal */

static void compare(examples *e, const rig_format *f, const uint8_t *volume, const sv_scanned *ranges,
                    const sv_param_value *values, uint32_t count, const char *what) {
    rig_format own = *f;
    own.own_queue = true;
    own.carrier = SV_CARRIER_HOST;
    const sv_status expected = run(&e->cpu, &own, volume, ranges, values, count, &e->a);
    memset(e->b.depth, 0x5a, RAYS * sizeof(float));
    memset(e->b.status, 0x5a, RAYS);
    const sv_status found = run(&e->kernels, f, volume, ranges, values, count, &e->b);
    if (found != expected || memcmp(&e->a.stats, &e->b.stats, sizeof e->a.stats) != 0)
        fail_msg("%s: outcome %d, expected %d", what, found, expected);
    for (uint32_t i = 0; i < RAYS; i++)
        if (e->a.depth[i] != e->b.depth[i] || e->a.status[i] != e->b.status[i])
            fail_msg("%s: ray %u: depth %g, expected %g", what, i, (double)e->b.depth[i],
                     (double)e->a.depth[i]);
}

static void kernels_equal_the_cpu(void **state) {
    examples *e = *state;
    static const uint32_t slabs[] = {1, 5, SLICES};
    const uint32_t q = rig_param(&e->cpu, "q"), level = rig_param(&e->cpu, "level");
    const uint32_t gap = rig_param(&e->cpu, "gap");
    sv_scanned ranges[RAYS];
    char what[80];
    for (uint32_t n = 0; n < 24; n++) {
        const uint32_t k = n % 6; /* layouts are few: each compiles its kernels anew */
        uint8_t *volume = rig_volume((rig_kind)(n / 6 % RIG_KIND_COUNT), WIDTH, HEIGHT, SLICES, 100 + n);
        const rig_format f = {.width = WIDTH,
                              .height = HEIGHT,
                              .slices = SLICES,
                              .slab_slices = slabs[k % 3],
                              .tiles_x = 1 + k % 3,
                              .extra_w = k,
                              .extra_h = k % 2,
                              .extra_pitch = 7 - k,
                              .own_queue = k<2, .carrier = k> 3 ? SV_CARRIER_BUFFER : SV_CARRIER_HOST,
                              .padding = k % 2 ? 0 : SV_NO_PADDING};
        const sv_param_value values[] = {
            {q, 0, (double)(n % 11) / 10.0}, {level, 0, (double)n / 24.0}, {gap, 0, (double)(n % 6)}};
        for (uint32_t i = 0; i < RAYS; i++)
            ranges[i] = (sv_scanned){(uint16_t)((i * 7 + n) % 5), (uint16_t)(SLICES - i * 3 % 9)};
        (void)snprintf(what, sizeof what, "volume %u", n);
        compare(e, &f, volume, n / 6 % 2 ? ranges : NULL, values, 3, what);
    }
}

/* ---- refusals of author_cl.h */

static void refused(const rig *r, sv_status status, sv_status expected, const char *text) {
    const char *reason = r->plugin->last_error(r->plugin);
    if (status != expected || !strstr(reason, text) || !strstr(r->last_log, text))
        fail_msg("status %d, expected %d; last_error '%s', log '%s', expected '%s'", status, expected, reason,
                 r->last_log, text);
}

/* A build error names file and line of the kernel, in the reason and in the log, which gets a line at a time
 * (support/rig.c holds that). */
static void build_errors_name_lines(void **state) {
    examples *e = *state;
    const rig *r = &e->kernels;
    const rig_format f = plain();
    uint8_t *volume = layers(6, 14);
    stage *t = rig_stage(r, &f, volume);
    shared_programs_options("-Dsorted=1"); /* no name for an array */
    const unsigned lines = r->log_lines;
    const sv_status status = r->plugin->activate(r->plugin, &t->format);
    shared_programs_options(NULL);
    refused(r, status, SV_ERR_BUILD, rig_is_cpu(r) ? "edge.cl:22:11" : "error");
    assert_true(r->log_lines > lines + 2);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    r->plugin->deactivate(r->plugin);
}

UNIT_MAIN(open_examples, close_examples, depth_follows_q, outliers_and_holes, a_part_without_surface,
          gap_in_millimetres, only_what_was_scanned, kernels_equal_the_cpu, build_errors_name_lines)
