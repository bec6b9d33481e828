/* SPDX-License-Identifier: MIT */
/*
 * A frame behind the guard has an end, whatever its process says of the call under way: guard_link.c with a
 * clock and a child of this test's own, which says at every look that the next call has just begun.
 */
#include "guarded/guard_link.h"
#include "support/unit.h"

enum { SLABS = 5, LOOKS = 1000 };
static const double LIMIT = 2.0, STEP = 0.5;

static double clock_s;
static int looks, kills;
static hs_guard_block *shared;

static double read_clock(void) {
    return clock_s;
}
static hs_child_news look_at_child(hs_child *child, double seconds) {
    assert_true(++looks < LOOKS);
    clock_s += STEP;
    atomic_store(&shared->since_ns, (uint64_t)((clock_s - 0.1 * STEP) * 1e9));
    return HS_CHILD_NOTHING;
}
static void kill_child(hs_child *child, hs_child_fate why, double seconds) {
    assert_int_equal(why, HS_CHILD_LATE);
    kills++;
}

#define hs_now        read_clock
#define hs_child_wait look_at_child
#define hs_child_kill kill_child
#include "../../../base/guarded/guard_link.c" /* NOLINT(bugprone-suspicious-include) */

static void a_frame_ends(void **state) {
    static hs_guard guard;
    hs_guard_reply reply;
    shared = guard.block = unit_memory(sizeof *shared);
    guard.slab_count = SLABS;
    clock_s = 100.0;
    assert_false(await(&guard, (hs_guard_order){.op = HS_GUARD_FRAME}, LIMIT, &reply));
    assert_int_equal(kills, 1);
    /* As many calls as a frame has, each with its limit: begin, the slabs, end and what follows. */
    const double took = clock_s - 100.0;
    assert_true(took >= SLABS * LIMIT && took <= (SLABS + EXTRA_CALLS) * LIMIT + STEP);
}

UNIT_MAIN(NULL, NULL, a_frame_ends)
