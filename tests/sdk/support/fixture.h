/* SPDX-License-Identifier: MIT */
/* An instance with a small volume at hand, for tests of the calls themselves: contract and faults. */
#pragma once

#include "support/rig.h"

enum { FIXTURE_WIDTH = 21, FIXTURE_HEIGHT = 18, FIXTURE_SLICES = 14, FIXTURE_SLAB = 6, FIXTURE_SLABS = 3 };
enum { FIXTURE_RAYS = FIXTURE_WIDTH * FIXTURE_HEIGHT };

typedef struct {
    rig r;
    rig_format how;
    uint8_t *volume;
    stage *textures;      /* of FIXTURE_SLABS slabs, the last one short */
    rig_result out, good; /* good: what a frame with default values must give */
} fixture;

/* cmocka: *state is a fixture, inactive; or active with host memory and the host's queue. */
int fixture_setup(void **state);
int fixture_setup_active(void **state);
int fixture_teardown(void **state);
#define FIXTURE_TEST(function) cmocka_unit_test_setup_teardown(function, fixture_setup, fixture_teardown)
#define FIXTURE_TEST_ACTIVE(function)                                                                        \
    cmocka_unit_test_setup_teardown(function, fixture_setup_active, fixture_teardown)

/* Another way of handing the same volume over; the instance must be inactive. */
void fixture_change(fixture *f, rig_format how);
void fixture_use(fixture *f, rig_format how); /* and activates */

sv_status fixture_activate(fixture *f);
sv_status fixture_begin(fixture *f); /* default values */
sv_status fixture_slab(fixture *f, uint32_t n);
sv_status fixture_slabs(fixture *f);           /* all of them */
void fixture_feed(fixture *f, uint32_t slabs); /* begin and so many slabs, which succeed */
sv_result fixture_result(fixture *f);
sv_status fixture_end(fixture *f); /* and clFinish of the host's queue */

/* A whole frame gives the good maps: whatever was done before did no harm. And one of an activation. */
void fixture_frame_is_good(fixture *f);
void fixture_works(fixture *f);

/* `status` is `expected`, and last_error and the host's log both hold `text` (a field and its value). */
void fixture_refused(fixture *f, sv_status status, sv_status expected, const char *text);
