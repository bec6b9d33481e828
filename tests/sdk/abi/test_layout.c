/* SPDX-License-Identifier: MIT */
/*
 * The ABI's layout and numbers on a 64-bit machine (LP64), pinned. A line that fails here is a broken ABI:
 * append fields, never move them; add numbers, never change them. A new minor version adds lines and changes
 * the sizes only.
 */
#include <CL/cl.h> /* before the header on purpose: its tags must be OpenCL's own types */

#include "smartvis/confidence.h"
#include "smartvis/needs.h"
#include "smartvis/points.h"
#include "smartvis/spline.h"
#include "smartvis/timing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#if UINTPTR_MAX == UINT64_MAX
#define AT(type, field, offset) _Static_assert(offsetof(type, field) == (offset), #type "." #field " moved")
#define SIZE(type, bytes)       _Static_assert(sizeof(type) == (bytes), #type " changed its size")

AT(sv_host, size, 0);
AT(sv_host, abi_minor, 4);
AT(sv_host, host_data, 8);
AT(sv_host, name, 16);
AT(sv_host, version, 24);
AT(sv_host, log, 32);
AT(sv_host, get_extension, 40);
SIZE(sv_host, 48);

AT(sv_param_info, size, 0);
AT(sv_param_info, id, 4);
AT(sv_param_info, type, 8);
AT(sv_param_info, flags, 12);
AT(sv_param_info, key, 16);
AT(sv_param_info, label, 24);
AT(sv_param_info, unit, 32);
AT(sv_param_info, help, 40);
AT(sv_param_info, min_value, 48);
AT(sv_param_info, max_value, 56);
AT(sv_param_info, display_min, 64);
AT(sv_param_info, display_max, 72);
AT(sv_param_info, default_value, 80);
AT(sv_param_info, step, 88);
AT(sv_param_info, group, 96);
AT(sv_param_info, depends_on, 104);
AT(sv_param_info, reserved, 108);
AT(sv_param_info, depends_values, 112);
SIZE(sv_param_info, 120);

/* Arrays of these cross the boundary, so they can never grow. */
AT(sv_param_value, id, 0);
AT(sv_param_value, reserved, 4);
AT(sv_param_value, value, 8);
SIZE(sv_param_value, 16);

AT(sv_format, size, 0);
AT(sv_format, width, 4);
AT(sv_format, height, 8);
AT(sv_format, slices, 12);
AT(sv_format, max_slab_slices, 16);
AT(sv_format, voxel_type, 20);
AT(sv_format, carrier, 24);
AT(sv_format, padding_value, 28);
AT(sv_format, tiles_x, 32);
AT(sv_format, tile_w, 36);
AT(sv_format, tile_h, 40);
AT(sv_format, row_pitch, 44);
AT(sv_format, spacing_mm, 48);
AT(sv_format, flags, 60);
AT(sv_format, context, 64);
AT(sv_format, device, 72);
AT(sv_format, queue, 80);
AT(sv_format, host_memory, 88);
AT(sv_format, host_memory_bytes, 96);
AT(sv_format, values, 104);
AT(sv_format, value_count, 112);
AT(sv_format, reserved, 116);
SIZE(sv_format, 120);

AT(sv_scanned, first, 0);
AT(sv_scanned, end, 2);
SIZE(sv_scanned, 4);

AT(sv_frame, size, 0);
AT(sv_frame, flags, 4);
AT(sv_frame, index, 8);
AT(sv_frame, time_ns, 16);
AT(sv_frame, values, 24);
AT(sv_frame, value_count, 32);
AT(sv_frame, reserved, 36);
AT(sv_frame, scanned, 40);
AT(sv_frame, scanned_object, 48);
AT(sv_frame, scanned_offset, 56);
AT(sv_frame, probe_rotation, 64);
AT(sv_frame, probe_side, 100);
AT(sv_frame, beams, 112);
AT(sv_frame, beam_apex_mm, 116);
AT(sv_frame, beam_sweep_mm, 128);
AT(sv_frame, reserved_beams, 132);
SIZE(sv_frame, 136);
_Static_assert(SV_FRAME_SIZE_1_0 == 64, "what a host of 1.0 hands over");

AT(sv_slab, size, 0);
AT(sv_slab, first_slice, 4);
AT(sv_slab, slice_count, 8);
AT(sv_slab, reserved, 12);
AT(sv_slab, memory, 16);
AT(sv_slab, object, 24);
AT(sv_slab, offset, 32);
AT(sv_slab, bytes, 40);
SIZE(sv_slab, 48);

AT(sv_stats, size, 0);
AT(sv_stats, outcome, 4);
AT(sv_stats, rays, 8);
AT(sv_stats, points, 12);
AT(sv_stats, unfilled, 16);
SIZE(sv_stats, 20);

AT(sv_result, size, 0);
AT(sv_result, depth_pitch, 4);
AT(sv_result, depth, 8);
AT(sv_result, depth_object, 16);
AT(sv_result, depth_offset, 24);
AT(sv_result, status, 32);
AT(sv_result, stats, 40);
SIZE(sv_result, 48);

AT(sv_descriptor, size, 0);
AT(sv_descriptor, carriers, 4);
AT(sv_descriptor, id, 8);
AT(sv_descriptor, name, 16);
AT(sv_descriptor, vendor, 24);
AT(sv_descriptor, version, 32);
AT(sv_descriptor, summary, 40);
AT(sv_descriptor, voxel_types, 48);
AT(sv_descriptor, queues, 52);
AT(sv_descriptor, features, 56);
AT(sv_descriptor, reserved, 60);
AT(sv_descriptor, extensions, 64);
SIZE(sv_descriptor, 72);

AT(sv_plugin, size, 0);
AT(sv_plugin, reserved, 4);
AT(sv_plugin, descriptor, 8);
AT(sv_plugin, plugin_data, 16);
AT(sv_plugin, destroy, 24);
AT(sv_plugin, activate, 32);
AT(sv_plugin, deactivate, 40);
AT(sv_plugin, begin, 48);
AT(sv_plugin, slab, 56);
AT(sv_plugin, end, 64);
AT(sv_plugin, adjust, 72);
AT(sv_plugin, param_count, 80);
AT(sv_plugin, param_info, 88);
AT(sv_plugin, param_text, 96);
AT(sv_plugin, last_error, 104);
AT(sv_plugin, get_extension, 112);
SIZE(sv_plugin, 120);

AT(sv_stage_times, size, 0);
AT(sv_stage_times, reserved, 4);
AT(sv_stage_times, transfer_ms, 8);
AT(sv_stage_times, profile_ms, 16);
AT(sv_stage_times, threshold_ms, 24);
AT(sv_stage_times, reconstruct_ms, 32);
AT(sv_stage_times, output_ms, 40);
SIZE(sv_stage_times, 48);

AT(sv_ext_timing, size, 0);
AT(sv_ext_timing, reserved, 4);
AT(sv_ext_timing, enable, 8);
AT(sv_ext_timing, stage_times, 16);
SIZE(sv_ext_timing, 24);

AT(sv_points_report, size, 0);
AT(sv_points_report, empty_points, 4);
AT(sv_points_report, passes, 8);
AT(sv_points_report, volume_max, 12);
AT(sv_points_report, bone_threshold, 16);
AT(sv_points_report, sure_points, 20);
SIZE(sv_points_report, 24);

AT(sv_ext_points, size, 0);
AT(sv_ext_points, reserved, 4);
AT(sv_ext_points, write, 8);
SIZE(sv_ext_points, 16);

AT(sv_spline_report, size, 0);
AT(sv_spline_report, points, 4);
AT(sv_spline_report, merge_grid, 8);
AT(sv_spline_report, rank, 12);
AT(sv_spline_report, dropped, 16);
AT(sv_spline_report, condition, 20);
AT(sv_spline_report, residual, 24);
AT(sv_spline_report, reserved, 28);
SIZE(sv_spline_report, 32);

AT(sv_ext_spline, size, 0);
AT(sv_ext_spline, reserved, 4);
AT(sv_ext_spline, report, 8);
SIZE(sv_ext_spline, 16);

AT(sv_confidence_report, size, 0);
AT(sv_confidence_report, fluid_threshold, 4);
AT(sv_confidence_report, rays, 8);
AT(sv_confidence_report, open_rays, 12);
AT(sv_confidence_report, reason, 16);
AT(sv_confidence_report, found, 20);
AT(sv_confidence_report, wanted, 24);
AT(sv_confidence_report, try_id, 28);
AT(sv_confidence_report, try_value, 32);
SIZE(sv_confidence_report, 36);

AT(sv_ext_confidence, size, 0);
AT(sv_ext_confidence, reserved, 4);
AT(sv_ext_confidence, read, 8);
AT(sv_ext_confidence, offered, 16);
AT(sv_ext_confidence, write, 24);
SIZE(sv_ext_confidence, 32);

AT(sv_entry, abi_major, 0);
AT(sv_entry, abi_minor, 4);
AT(sv_entry, size, 8);
AT(sv_entry, count, 12);
AT(sv_entry, descriptor, 16);
AT(sv_entry, create, 24);
SIZE(sv_entry, 32);

AT(sv_needs_device, flags, 4);
AT(sv_needs_device, compute_units, 8);
SIZE(sv_needs_device, 16);
AT(sv_needs, commands, 4);
AT(sv_needs, adjust_commands, 8);
AT(sv_needs, device_bytes, 16);
AT(sv_needs, largest_buffer, 24);
AT(sv_needs, host_bytes, 32);
SIZE(sv_needs, 40);
AT(sv_ext_needs, of, 8);
SIZE(sv_ext_needs, 16);
#endif

/* A status travels in log files and other people's tables: the numbers are pinned, on every machine. */
#define NUMBER(name, value) _Static_assert((name) == (value), #name " changed its number")
NUMBER(SV_ABI_MAJOR, 1);
_Static_assert(sizeof(sv_status) == 4 && (sv_status)-1 < 0, "a status is a signed 32-bit number");
NUMBER(SV_OK, 0);
NUMBER(SV_NO_SURFACE, 1);
NUMBER(SV_PARTIAL, 2);
NUMBER(SV_ERR_INTERNAL, -1);
NUMBER(SV_ERR_ARGUMENT, -10);
NUMBER(SV_ERR_SIZE, -11);
NUMBER(SV_ERR_FORMAT, -12);
NUMBER(SV_ERR_PARAM_ID, -13);
NUMBER(SV_ERR_PARAM_RANGE, -14);
NUMBER(SV_ERR_PARAM_FIXED, -15);
NUMBER(SV_ERR_UNKNOWN_ID, -16);
NUMBER(SV_ERR_STATE, -20);
NUMBER(SV_ERR_SLAB_ORDER, -21);
NUMBER(SV_ERR_SLAB_MISSING, -22);
NUMBER(SV_ERR_SLAB_SHAPE, -23);
NUMBER(SV_ERR_NO_DEVICE, -30);
NUMBER(SV_ERR_BUILD, -31);
NUMBER(SV_ERR_OPENCL, -32);
NUMBER(SV_ERR_SELF_TEST, -33);
NUMBER(SV_ERR_NO_MEMORY, -40);
NUMBER(SV_LOG_DEBUG, 0);
NUMBER(SV_LOG_INFO, 1);
NUMBER(SV_LOG_WARNING, 2);
NUMBER(SV_LOG_ERROR, 3);
NUMBER(SV_LOG_HOST_MISBEHAVING, 4);
NUMBER(SV_LOG_PLUGIN_MISBEHAVING, 5);
NUMBER(SV_PARAM_FLOAT, 0);
NUMBER(SV_PARAM_INT, 1);
NUMBER(SV_PARAM_BOOL, 2);
NUMBER(SV_PARAM_ENUM, 3);
NUMBER(SV_PARAM_PRIMARY, 1);
NUMBER(SV_PARAM_EXPERT, 2);
NUMBER(SV_PARAM_REACTIVATE, 4);
NUMBER(SV_PARAM_ADJUST, 8);
NUMBER(SV_VOXEL_U8, 1);
NUMBER(SV_VOXEL_U16, 2);
NUMBER(SV_CARRIER_HOST, 1);
NUMBER(SV_CARRIER_BUFFER, 2);
NUMBER(SV_CARRIER_IMAGE, 3);
NUMBER(SV_NO_PADDING, -1);
NUMBER(SV_FORMAT_SCANNED, 1);
NUMBER(SV_FRAME_DISCONTINUITY, 1);
NUMBER(SV_FRAME_SAME_VOLUME, 2);
NUMBER(SV_BEAMS_UNKNOWN, 0);
NUMBER(SV_BEAMS_PARALLEL, 1);
NUMBER(SV_BEAMS_FAN, 2);
NUMBER(SV_QUEUE_OWN, 1);
NUMBER(SV_QUEUE_HOST, 2);
NUMBER(SV_FEATURE_SCANNED, 1);
NUMBER(SV_FEATURE_PADDING, 2);
NUMBER(SV_FEATURE_ADJUST, 4);
NUMBER(SV_FEATURE_PROBE, 8);
NUMBER(SV_NEEDS_CPU, 1);
NUMBER(SV_NEEDS_UNIFIED, 2);
NUMBER(SV_NEEDS_DOUBLES, 4);
NUMBER(SV_BIT(SV_CARRIER_IMAGE), 8);
NUMBER(SV_POINT_NONE, 0);
NUMBER(SV_POINT_INITIAL, 1);
NUMBER(SV_POINT_EMPTY, 2);

/* The tags are OpenCL's own types: no cast either way, or this function does not compile. */
static void test_handles_are_opencl_types(void **state) {
    (void)state;
    sv_format format = {.size = sizeof(format)};
    sv_slab slab = {.size = sizeof(slab)};
    sv_result result = {.size = sizeof(result)};
    int storage = 0;
    /* Never used as handles: only their types and their way through the structs matter here. */
    cl_context context = (cl_context)(void *)&storage;
    cl_device_id device = (cl_device_id)(void *)&storage;
    cl_command_queue queue = (cl_command_queue)(void *)&storage;
    cl_mem memory = (cl_mem)(void *)&storage;
    format.context = context;
    format.device = device;
    format.queue = queue;
    slab.object = memory;
    result.depth_object = memory;
    cl_mem back = slab.object;
    assert_ptr_equal(back, memory);
    assert_int_equal(_Generic(slab.object, cl_mem : 1, default : 0), 1);
    assert_int_equal(_Generic(result.depth_object, cl_mem : 1, default : 0), 1);
    assert_int_equal(_Generic(format.context, cl_context : 1, default : 0), 1);
    assert_int_equal(_Generic(format.device, cl_device_id : 1, default : 0), 1);
    assert_int_equal(_Generic(format.queue, cl_command_queue : 1, default : 0), 1);
}

/* SV_HAS is true from the very byte on at which the field is whole. */
static void test_has_field(void **state) {
    (void)state;
    sv_stats stats = {0};
    const uint32_t end = (uint32_t)(offsetof(sv_stats, points) + sizeof(stats.points));
    for (uint32_t size = 0; size <= sizeof(stats); size++) {
        stats.size = size;
        const sv_stats *reader = &stats;
        assert_int_equal(SV_HAS(reader, points), size >= end);
        assert_int_equal(SV_HAS(reader, size), size >= sizeof(uint32_t));
    }
}

/* Names that other people's binaries look up: as fixed as the numbers above. */
static void test_names(void **state) {
    (void)state;
    assert_string_equal(SV_ENTRY_SYMBOL, "smartvis_plugin_entry");
    assert_string_equal(SV_EXT_TIMING, "smartvis.timing/1");
    assert_string_equal(SV_EXT_POINTS, "smartvis.points/1");
    assert_string_equal(SV_EXT_SPLINE, "smartvis.spline/1");
    assert_string_equal(SV_EXT_CONFIDENCE, "smartvis.confidence/1");
    assert_string_equal(SV_EXT_NEEDS, "smartvis.needs/1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_handles_are_opencl_types),
        cmocka_unit_test(test_has_field),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests_name("layout", tests, NULL, NULL);
}
