/* SPDX-License-Identifier: MIT */
/*
 * A format that the device has no room for is refused before anything is allocated, and the error names both
 * numbers. What activate says it needs is what it makes, to the byte.
 */
#include "support/fixture.h"
#include "support/plain_format.h"
#include "support/surfaces.h"
#include "support/unit.h"
#include "validate/spy/cl_spy.h"

#include <inttypes.h>

static void choose(fixture *f, uint32_t carrier, double method) {
    const rig_format how = {
        .carrier = carrier,
        .fixed = {{rig_param(&f->r, "method"), 0, method}, {rig_param(&f->r, "prefilter"), 0, 1.0}}};
    fixture_change(f, how);
}

/* The number behind `word` in the last error. */
static uint64_t number_behind(const fixture *f, const char *word) {
    const char *at = strstr(f->r.plugin->last_error(f->r.plugin), word);
    uint64_t number = 0;
    if (!at || sscanf(at + strlen(word), "%" SCNu64, &number) != 1)
        fail_msg("no number behind '%s': %s", word, f->r.plugin->last_error(f->r.plugin));
    return number;
}

static void the_sum_is_that_of_the_buffers(void **state) {
    fixture *f = *state;
    char line[80];
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method))
        for (uint32_t carrier = SV_CARRIER_HOST; carrier <= SV_CARRIER_IMAGE; carrier++) {
            if (method != surface_next(-1) && carrier != SV_CARRIER_HOST)
                continue; /* methods do not see it */
            choose(f, carrier, method);
            spy_device_memory(1, 0);
            fixture_refused(f, fixture_activate(f), SV_ERR_FORMAT, "bytes on the device, which has 1");
            assert_int_equal(spy_live_bytes(), 0);
            const uint64_t needed = number_behind(f, "needs ");
            spy_device_memory(needed - 1, 0);
            fixture_refused(f, fixture_activate(f), SV_ERR_FORMAT, "bytes on the device, which has ");
            spy_device_memory(needed, 0);
            assert_int_equal(fixture_activate(f), SV_OK);
            assert_int_equal(spy_live_bytes(), needed);
            (void)snprintf(line, sizeof line, " needs %" PRIu64 " bytes on the device, the largest", needed);
            assert_non_null(strstr(f->r.all_logs, line));
            f->r.all_logs[0] = '\0';
            f->r.plugin->deactivate(f->r.plugin);
            assert_int_equal(spy_live_bytes(), 0);
        }
    spy_device_memory(0, 0);
}

static void no_buffer_is_too_large(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    spy_device_memory(0, 1);
    fixture_refused(f, fixture_activate(f), SV_ERR_FORMAT, "bytes, the device allows 1");
    const uint64_t largest = number_behind(f, "a buffer of ");
    spy_device_memory(0, largest - 1);
    fixture_refused(f, fixture_activate(f), SV_ERR_FORMAT, "bytes, the device allows ");
    spy_device_memory(0, largest);
    assert_int_equal(fixture_activate(f), SV_OK);
    fixture_frame_is_good(f);
    spy_device_memory(0, 0);
}

/* The largest that the header allows, in one slab: more than any device has, for real. */
static void the_largest_format(void **state) {
    fixture *f = *state;
    enum { SIDE = 8192 };
    sv_format format = plain_format(SIDE, SIDE, SIDE, 1);
    format.context = f->r.context;
    format.device = f->r.device;
    format.queue = f->r.queue;
    spy_watch(f->r.entry);
    const sv_status status = f->r.plugin->activate(f->r.plugin, &format);
    fixture_refused(f, status, SV_ERR_FORMAT, "activate: a format of 8192 x 8192 x 8192 needs ");
    assert_true(number_behind(f, "needs ") > (uint64_t)SIDE * SIDE * SIDE);
    assert_int_equal(spy_count(SPY_CREATE) + spy_count(SPY_ENQUEUE) + spy_count(SPY_BUILD), 0);
    assert_int_equal(fixture_activate(f), SV_OK);
    fixture_frame_is_good(f);
}

UNIT_MAIN(NULL, NULL, FIXTURE_TEST(the_sum_is_that_of_the_buffers), FIXTURE_TEST(no_buffer_is_too_large),
          FIXTURE_TEST(the_largest_format))
