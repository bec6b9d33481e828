/* SPDX-License-Identifier: MIT */
#include "support/fixture.h"

int fixture_setup(void **state) {
    fixture *f = unit_memory(sizeof *f);
    rig_open(&f->r, NULL);
    f->volume = rig_volume(RIG_LAYERS, FIXTURE_WIDTH, FIXTURE_HEIGHT, FIXTURE_SLICES, 5);
    f->out = rig_result_make(FIXTURE_WIDTH, FIXTURE_HEIGHT);
    f->good = rig_result_make(FIXTURE_WIDTH, FIXTURE_HEIGHT);
    rig_settings settings = rig_default_settings();
    settings.evidence = rig_param_default(&f->r, "evidence");
    settings.q = (float)rig_param_default(&f->r, "q");
    const sv_ref_volume volume = {f->volume,      FIXTURE_WIDTH, FIXTURE_HEIGHT,
                                  FIXTURE_SLICES, SV_NO_PADDING, NULL};
    rig_expected e = rig_expect(&volume, &settings, false);
    memcpy(f->good.depth, e.depth, FIXTURE_RAYS * sizeof(float));
    memcpy(f->good.status, e.status, FIXTURE_RAYS);
    f->good.stats.points = e.points;
    const bool good = e.outcome == SV_OK && e.points > 0; /* a frame that clips something */
    fixture_change(f, (rig_format){0});
    *state = f;
    return good ? 0 : -1;
}

int fixture_setup_active(void **state) {
    return fixture_setup(state) == 0 && fixture_activate(*state) == SV_OK ? 0 : -1;
}

int fixture_teardown(void **state) {
    fixture *f = *state;
    rig_close(&f->r);
    return unit_end(state);
}

void fixture_change(fixture *f, rig_format how) {
    how.width = FIXTURE_WIDTH;
    how.height = FIXTURE_HEIGHT;
    how.slices = FIXTURE_SLICES;
    how.slab_slices = FIXTURE_SLAB;
    how.padding = SV_NO_PADDING;
    f->how = how;
    f->textures = rig_stage(&f->r, &f->how, f->volume);
    assert_int_equal(f->textures->slab_count, FIXTURE_SLABS);
}

sv_status fixture_activate(fixture *f) {
    return f->r.plugin->activate(f->r.plugin, &f->textures->format);
}

void fixture_use(fixture *f, rig_format how) {
    fixture_change(f, how);
    assert_int_equal(fixture_activate(f), SV_OK);
}

sv_status fixture_begin(fixture *f) {
    const sv_frame frame = {.size = sizeof frame};
    return f->r.plugin->begin(f->r.plugin, &frame);
}

sv_status fixture_slab(fixture *f, uint32_t n) {
    const sv_slab slab = stage_slab(f->textures, n);
    return f->r.plugin->slab(f->r.plugin, &slab);
}

sv_status fixture_slabs(fixture *f) {
    sv_status status = SV_OK;
    for (uint32_t n = 0; status == SV_OK && n < FIXTURE_SLABS; n++) status = fixture_slab(f, n);
    return status;
}

void fixture_feed(fixture *f, uint32_t slabs) {
    assert_int_equal(fixture_begin(f), SV_OK);
    for (uint32_t n = 0; n < slabs; n++) assert_int_equal(fixture_slab(f, n), SV_OK);
}

sv_result fixture_result(fixture *f) {
    return (sv_result){
        .size = sizeof(sv_result), .depth = f->out.depth, .status = f->out.status, .stats = &f->out.stats};
}

sv_status fixture_end(fixture *f) {
    const sv_result result = fixture_result(f);
    const sv_status status = f->r.plugin->end(f->r.plugin, &result);
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
    return status;
}

void fixture_frame_is_good(fixture *f) {
    memset(f->out.depth, 0xAB, FIXTURE_RAYS * sizeof(float));
    memset(f->out.status, 0xAB, FIXTURE_RAYS);
    fixture_feed(f, FIXTURE_SLABS);
    assert_int_equal(fixture_end(f), SV_OK);
    assert_memory_equal(f->out.depth, f->good.depth, FIXTURE_RAYS * sizeof(float));
    assert_memory_equal(f->out.status, f->good.status, FIXTURE_RAYS);
    assert_int_equal(f->out.stats.points, f->good.stats.points);
}

void fixture_works(fixture *f) {
    assert_int_equal(fixture_activate(f), SV_OK);
    fixture_frame_is_good(f);
}

void fixture_refused(fixture *f, sv_status status, sv_status expected, const char *text) {
    const char *reason = f->r.plugin->last_error(f->r.plugin);
    if (status != expected)
        fail_msg("status is %d, expected %d (%s); last_error: '%s'", status, expected, text, reason);
    if (!strstr(reason, text)) fail_msg("last_error is '%s', expected '%s' in it", reason, text);
    if (!strstr(f->r.last_log, text))
        fail_msg("the log's last line is '%s', expected '%s' in it", f->r.last_log, text);
}
