/* SPDX-License-Identifier: MIT */
#include "support/wall_compare.h"

#include <math.h>

/* Knob positions: that of the frame, then those that it is moved to. */
enum { WALL_PLACES = 4 };

/* The definition's maps, NULL at one position; outcome and facts are the same at all of them. */
typedef struct {
    float *depth[WALL_PLACES], *confidence;
    bool clip_doubtful;
    sv_wall_outcome outcome;
    sv_wall_facts facts;
} wall_expected;

/* Few, because the definitions take most of the time, and one more position runs no other code. Of the second
 * and the last, volumes take turns. */
static const double places[WALL_PLACES] = {0.5, 0.0, 0.5, 1.5};

static bool clips(const wall_expected *e) {
    return e->outcome == SV_WALL_SURFACE || (e->outcome == SV_WALL_DOUBTFUL && e->clip_doubtful);
}

/* By the definition. */
static wall_expected wall_expect(const wall_shape *s, const uint8_t *volume, bool clip_doubtful) {
    const size_t count = (size_t)s->width * s->height;
    const sv_ref_volume v = {volume, s->width, s->height, s->slices, s->padding, s->scanned};
    const double mm[3] = {(double)s->spacing_mm[0], (double)s->spacing_mm[1], (double)s->spacing_mm[2]};
    sv_wall_settings settings = sv_wall_settings_default();
    settings.clip_doubtful = clip_doubtful;
    static size_t turn = 1;
    turn = WALL_PLACES - turn;
    wall_expected e = {.clip_doubtful = clip_doubtful, .confidence = unit_memory(count * sizeof(float))};
    for (size_t n = 0; n < WALL_PLACES; n++) {
        if (n % 2 && n != turn) continue;
        e.depth[n] = unit_memory(count * sizeof(float));
        /* Moving the knob back gives the same map, and so does moving it where nothing is clipped. */
        if (n > 0 && (places[n] == places[0] || !clips(&e)))
            memcpy(e.depth[n], e.depth[0], count * sizeof(float));
        else {
            settings.q = places[n];
            assert_true(sv_wall_surface_padded(&v, mm, s->beams, &settings, e.depth[n], e.confidence,
                                               &e.outcome, &e.facts));
        }
    }
    return e;
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
static void check_knob(rig *r, const wall_shape *s, const wall_expected *e, double bound) {
    const size_t count = (size_t)s->width * s->height;
    float *last = unit_memory(count * sizeof *last);
    rig_result out = rig_result_make(s->width, s->height);
    for (size_t n = 1; n < WALL_PLACES; n++) {
        const sv_param_value q = {rig_param(r, "q"), 0, places[n]};
        const sv_result result = {.size = sizeof result, .depth = out.depth};
        assert_true(r->plugin->adjust(r->plugin, &q, 1, &result) >= SV_OK);
        if (r->queue) assert_int_equal(clFinish(r->queue), CL_SUCCESS);
        const double error = e->depth[n] ? largest_difference(out.depth, e->depth[n], count) : 0.0;
        if (error > bound) fail_msg("q %g: error %g slices", places[n], error);
        for (size_t i = 0; n > 1 && i < count; i++) assert_true(out.depth[i] <= last[i]);
        memcpy(last, out.depth, count * sizeof *last);
    }
}

/* Runs a frame in which all was scanned, and lets the next one forget it: blocks that are outside of the scan
 * from then on must not be seen. */
static void scan_all(rig *r, stage *t, const wall_shape *s, rig_result *out) {
    const size_t count = (size_t)s->width * s->height;
    for (size_t i = 0; i < count; i++) t->ranges[i] = (sv_scanned){0, (uint16_t)s->slices};
    assert_true(rig_frame(r, t, NULL, 0, out) >= SV_OK);
    memcpy(t->ranges, s->scanned, count * sizeof *t->ranges);
    t->frame_flags = SV_FRAME_DISCONTINUITY;
}

/* Compares one layout of the work. With strategy rays a work item has a ray, with all others a row. */
static void compare_layout(rig *r, const wall_shape *s, const uint8_t *volume, const wall_expected *e,
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
                                    {rig_param(r, "strategy"), 0, rig_enum(r, "strategy", strategy)}}};
    stage *t = rig_stage(r, &f, volume);
    memcpy(t->format.spacing_mm, s->spacing_mm, sizeof s->spacing_mm);
    rig_result out = rig_result_make(s->width, s->height);
    if (s->beams) rig_tell(t, s->beams);
    float *confidence = unit_memory(count * sizeof *confidence);
    sv_confidence_report report = {.size = sizeof report};
    const sv_ext_confidence *ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_non_null(ext);
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
}

bool wall_compare_outcome(rig *r, const wall_shape *s, const uint8_t *volume, const char *what,
                          sv_wall_outcome *unasked) {
    static const char *const layouts[] = {"single", "rays"};
    bool surface = false;
    for (int clip = 0; clip < 2 && !surface; clip++) {
        const void *mark = unit_mark();
        const wall_expected e = wall_expect(s, volume, clip);
        for (size_t n = 0; n < sizeof layouts / sizeof *layouts; n++)
            compare_layout(r, s, volume, &e, layouts[n], what);
        surface = clips(&e);
        if (!clip) *unasked = e.outcome;
        unit_return(mark);
        if (e.outcome != SV_WALL_DOUBTFUL && e.outcome != SV_WALL_NO_FLUID) break;
    }
    return surface;
}

bool wall_compare(rig *r, const wall_shape *s, const uint8_t *volume, const char *what) {
    sv_wall_outcome unasked;
    return wall_compare_outcome(r, s, volume, what, &unasked);
}

uint8_t *wall_layered_noise(uint32_t width, uint32_t height, uint32_t slices, uint32_t longest,
                            uint32_t patch_side, uint32_t seed) {
    static const uint8_t levels[] = {4, 80, 8, 120, 12, 204}; /* a quarter more at most */
    const size_t plane = (size_t)width * height;
    uint8_t *volume = unit_memory(plane * slices);
    uint32_t own = seed * 2654435761u + 1;
    for (size_t i = 0; i < plane; i++) {
        uint32_t patch =
            (uint32_t)(i % width / patch_side * 7919 + i / width / patch_side * 104729 + seed + 1) *
            2654435761u;
        if (patch == 0) patch = 1;
        for (uint32_t n = 0; n < 4; n++) (void)unit_random(&patch);
        for (uint32_t z = 0, layer = unit_random(&patch) % 2; z < slices; layer++) {
            const uint8_t level = levels[layer % 6];
            const uint32_t length = 1 + unit_random(&patch) % longest + unit_random(&own) % 3;
            for (uint32_t n = 0; n < length && z < slices; n++, z++)
                volume[z * plane + i] = (uint8_t)(level + unit_random(&own) % (level / 4 + 1));
        }
    }
    return volume;
}
