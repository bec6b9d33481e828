/* SPDX-License-Identifier: MIT */
/*
 * A frame of the scan loop allocates nothing, and creates, builds and releases no OpenCL object: volumes that
 * follow each other, both looks, all carriers, stage by stage and in flow; seen through an interposed heap
 * and OpenCL.
 * Requirement: R6.
 */
#include "support/loop_fixture.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

static void frames_take_no_memory(void **state) {
    fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 5};
    f->source.count = 2; /* two volumes in turns */
    for (uint32_t n = 0; n < 6; n++) {
        hs_loop_options o = options_with(&value, 1);
        o.live = true;
        o.carrier = SV_CARRIER_HOST + n % 3;
        o.dvr.look = n & 1 ? HS_LOOK_LIT : HS_LOOK_THESIS;
        o.yaw = n > 2 ? 25 : 0;
        hs_loop *loop = make_loop(f, &o);
        hs_frame frame;
        /* Buffers around the two volumes' memory are made when each comes for the first time. */
        for (uint32_t i = 0; i < 2; i++) must(hs_loop_frame(loop, HS_SETTING_SMARTVIS, i, &frame, &err));
        spy_watch((const void *)&f->cl); /* static: it lies in this program, as the host does */
        heap_spy_watch((const void *)&f->cl);
        spy_reset();
        heap_spy_reset();
        for (uint32_t i = 2; i < FRAMES; i++)
            for (int setting = 0; setting < HS_SETTING_COUNT; setting++)
                must(hs_loop_frame(loop, (hs_setting)setting, i, &frame, &err));
        const uint32_t allocations = heap_spy_works() ? heap_spy_count() : 0;
        assert_true(spy_count(SPY_ENQUEUE) > 0); /* the spy sees the host */
        if (allocations || spy_count(SPY_CREATE) || spy_count(SPY_BUILD) || spy_count(SPY_RELEASE))
            fail_msg("way %u: %u allocations, %u created (%s), %u built, %u released", n, allocations,
                     spy_count(SPY_CREATE), spy_first(SPY_CREATE), spy_count(SPY_BUILD),
                     spy_count(SPY_RELEASE));
        assert_true(frame.clipped);
    }
    f->source.count = 1;
}

UNIT_MAIN(set_up, tear_down, frames_take_no_memory)
