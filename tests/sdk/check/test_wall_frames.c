/* SPDX-License-Identifier: MIT */
/*
 * Method wall from frame to frame (docs/surface.md, step 10): a share that wanders around its limit does not
 * make the answer flicker, in both layouts of the work. A first frame, and one that continues nothing, are
 * answered as if there had been no other.
 * Requirement: R9.
 */
#include "ref/ref_wall.h"
#include "support/rig.h"
#include "support/wall_fixture.h"

enum { FRAMES = 28, FRONT = 4, GAP_LAYERS = 5, BONES = 3 };
static const float spacing[3] = {1.875f, 1.875f, 1.0f}; /* a layer of 2 mm is two slices */

/* The share of what is dark that lies in the gap, in frame n: it falls from 0.345 to 0.255, and every other
 * frame has 0.015 more. */
static double share_of(uint32_t n) {
    return 0.345 - 0.09 * n / (FRAMES - 1) + (n % 2 ? 0.0075 : -0.0075);
}

/* A wall, a gap of five dark layers, bone, and dark layers in the fetus: so many that the gap has the share.
 * As layers are whole, some of the columns have one more. */
static uint8_t *volume_of(double share) {
    uint8_t *volume = unit_memory((size_t)PIXELS * N);
    const double elsewhere = GAP_LAYERS / share - GAP_LAYERS;
    for (uint32_t i = 0; i < PIXELS; i++) {
        const uint32_t more = i % N < (elsewhere - floor(elsewhere)) * N;
        const uint32_t gap = FRONT + GAP_LAYERS, bone = gap + BONES, end = bone + (uint32_t)elsewhere + more;
        for (uint32_t z = 0; z < N; z++) {
            const uint32_t layer = z / 2;
            volume[(size_t)z * PIXELS + i] = layer < FRONT  ? MUSCLE
                                             : layer < gap  ? FLUID
                                             : layer < bone ? BONE
                                             : layer < end  ? FLUID
                                                            : MUSCLE;
        }
    }
    return volume;
}

/* What the definition says after the outcome `last`. */
static sv_wall_outcome defined(const uint8_t *volume, sv_wall_outcome last, float *depth,
                               sv_wall_facts *facts) {
    static float confidence[PIXELS];
    sv_wall_settings settings = sv_wall_settings_default();
    sv_wall_outcome outcome;
    settings.last = last;
    const sv_wall_volume v = {.voxels = volume,
                              .width = N,
                              .height = N,
                              .slices = N,
                              .spacing_mm = {(double)spacing[0], (double)spacing[1], (double)spacing[2]}};
    assert_true(sv_wall_surface(&v, &settings, depth, confidence, &outcome, facts));
    return outcome;
}

/* Runs the frame with unsure=clip; only what it leaves behind counts. */
static void run_unsure(rig *r, uint32_t n) {
    const sv_param_value clip = {rig_param(r, "unsure"), 0, rig_enum(r, "unsure", "clip")};
    const rig_format f = {.width = N, .height = N, .slices = N, .slab_slices = 16};
    uint8_t *volume = volume_of(share_of(n));
    stage *t = rig_stage(r, &f, volume);
    rig_result out = rig_result_make(N, N);
    assert_int_equal(rig_frame(r, t, &clip, 1, &out), SV_OK);
}

/* Runs the frame on an active plugin, and compares it with the definition after `last`. */
static sv_wall_outcome run_frame(rig *r, uint32_t n, uint32_t flags, sv_wall_outcome last) {
    static float depth[PIXELS];
    uint8_t *volume = volume_of(share_of(n));
    const rig_format f = {.width = N, .height = N, .slices = N, .slab_slices = 16};
    stage *t = rig_stage(r, &f, volume);
    rig_result out = rig_result_make(N, N);
    sv_wall_facts facts;
    const sv_wall_outcome expected = defined(volume, last, depth, &facts);
    t->frame_flags = flags;
    const sv_status status = rig_frame(r, t, NULL, 0, &out);
    sv_confidence_report report = {.size = sizeof report};
    const sv_ext_confidence *ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_int_equal(ext->read(r->plugin, NULL, &report), SV_OK);
    assert_int_equal(status, expected == SV_WALL_SURFACE ? SV_OK : SV_NO_SURFACE);
    assert_int_equal(report.reason, expected); /* by the same numbers */
    assert_memory_equal(out.depth, depth, sizeof depth);
    if (expected != SV_WALL_SURFACE) {
        assert_true(fabs((double)report.wanted - facts.wanted) < 1e-6);
        assert_true(report.found < report.wanted);
    }
    return expected;
}

/* Activates the plugin in a layout of the work. */
static void begin(rig *r, const char *strategy) {
    uint8_t *volume = volume_of(share_of(0));
    const rig_format f = {.width = N,
                          .height = N,
                          .slices = N,
                          .slab_slices = 16,
                          .fixed = {{rig_param(r, "method"), 0, rig_enum(r, "method", "wall")},
                                    {rig_param(r, "strategy"), 0, rig_enum(r, "strategy", strategy)}}};
    stage *t = rig_stage(r, &f, volume);
    memcpy(t->format.spacing_mm, spacing, sizeof spacing);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
}

/* Counts how often the answer changes. `flags`: of every frame. */
static uint32_t changes(rig *r, uint32_t flags, bool backwards) {
    uint32_t count = 0;
    sv_wall_outcome last = SV_WALL_EMPTY;
    for (uint32_t i = 0; i < FRAMES; i++) {
        const uint32_t n = backwards ? FRAMES - 1 - i : i;
        const sv_wall_outcome now = run_frame(r, n, flags, flags ? SV_WALL_EMPTY : last);
        count += i > 0 && now != last;
        last = now;
    }
    return count;
}

static void answers_do_not_flicker(void **state) {
    static const char *const layouts[] = {"single", "rays"};
    rig *r = *state;
    for (int k = 0; k < 2; k++) { /* it falls, and it rises */
        begin(r, layouts[k]);
        const uint32_t with = changes(r, 0, k == 1), without = changes(r, SV_FRAME_DISCONTINUITY, k == 1);
        r->plugin->deactivate(r->plugin);
        print_message("%s: %u changes, without memory %u\n", layouts[k], with, without);
        assert_int_equal(with, 1);
        assert_true(without >= 5);
    }
}

/* The frame of 0.29 is doubtful by itself, and keeps the surface of the one before. A discontinuity and a new
 * activation forget that. */
static void first_frames_remember_nothing(void **state) {
    enum { HIGH = 1, NEAR = 16 };
    rig *r = *state;
    assert_true(share_of(HIGH) > 0.32 && share_of(NEAR) > 0.28 && share_of(NEAR) < 0.295);
    begin(r, "single");
    assert_int_equal(run_frame(r, NEAR, 0, SV_WALL_EMPTY), SV_WALL_DOUBTFUL);
    assert_int_equal(run_frame(r, HIGH, 0, SV_WALL_DOUBTFUL), SV_WALL_SURFACE);
    assert_int_equal(run_frame(r, NEAR, 0, SV_WALL_SURFACE), SV_WALL_SURFACE);
    assert_int_equal(run_frame(r, NEAR, SV_FRAME_DISCONTINUITY, SV_WALL_EMPTY), SV_WALL_DOUBTFUL);
    assert_int_equal(run_frame(r, HIGH, 0, SV_WALL_DOUBTFUL), SV_WALL_SURFACE);
    r->plugin->deactivate(r->plugin);
    begin(r, "single");
    assert_int_equal(run_frame(r, NEAR, 0, SV_WALL_EMPTY), SV_WALL_DOUBTFUL);
    /* What was clipped although doubtful is remembered as doubtful. */
    run_unsure(r, NEAR);
    assert_int_equal(run_frame(r, NEAR, 0, SV_WALL_DOUBTFUL), SV_WALL_DOUBTFUL);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(answers_do_not_flicker), RIG_TEST(first_frames_remember_nothing))
