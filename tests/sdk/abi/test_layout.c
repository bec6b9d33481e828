/* SPDX-License-Identifier: MIT */
/*
 * What the dumps in abi/ cannot say of the header: OpenCL's handles pass without a cast, and SV_HAS is true
 * from the right byte on. Offsets, sizes and numbers are held by test_abi_guard.sh and
 * test_layout_targets.sh.
 */
#include <CL/cl.h> /* before the header on purpose: its tags must be OpenCL's own types */

#include "smartvis_plugin.h"

#include "support/unit.h"

_Static_assert(sizeof(sv_status) == 4 && (sv_status)-1 < 0, "a status is a signed 32-bit number");
_Static_assert(SV_BIT(SV_CARRIER_IMAGE) == 8, "the bit of a number");

/* The tags are OpenCL's own types: no cast either way, or this does not compile. */
static void test_handles_are_opencl_types(void **state) {
    sv_format format = {0};
    sv_slab slab = {0};
    sv_result result = {0};
    assert_int_equal(_Generic(slab.object, cl_mem : 1, default : 0), 1);
    assert_int_equal(_Generic(result.depth_object, cl_mem : 1, default : 0), 1);
    assert_int_equal(_Generic(format.context, cl_context : 1, default : 0), 1);
    assert_int_equal(_Generic(format.device, cl_device_id : 1, default : 0), 1);
    assert_int_equal(_Generic(format.queue, cl_command_queue : 1, default : 0), 1);
}

/* SV_HAS is true from the very byte on at which the field is whole. */
static void test_has_field(void **state) {
    sv_stats stats = {0};
    const uint32_t end = (uint32_t)(offsetof(sv_stats, points) + sizeof(stats.points));
    for (uint32_t size = 0; size <= sizeof(stats); size++) {
        stats.size = size;
        const sv_stats *reader = &stats;
        assert_int_equal(SV_HAS(reader, points), size >= end);
        assert_int_equal(SV_HAS(reader, size), size >= sizeof(uint32_t));
    }
}

UNIT_MAIN(NULL, NULL, test_handles_are_opencl_types, test_has_field)
