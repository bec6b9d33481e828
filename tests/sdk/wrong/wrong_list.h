/* SPDX-License-Identifier: MIT */
/*
 * Plugins that are wrong on purpose, each in one way: WRONG(id, source, check, what is wrong).
 * CMake compiles wrong_<source>.c once, and links it with the number of each line's fault as
 * <build>/wrong/<id>.so. sv_validate must fail on it by `check`, or warn; no host may crash, hang or show a
 * wrong picture because of it. The same sources without a fault are <build>/wrong/right/<source>.so.
 *
 * One line an entry: CMake and the tests' scripts read this file, too.
 */
/* clang-format off */
#pragma once
#define WRONG_LIST(WRONG) \
    WRONG(crash_in_constructor, library, library-loads, "the library crashes while it is loaded") \
    WRONG(hang_in_constructor, library, library-loads, "the library never finishes loading") \
    WRONG(exit_in_constructor, library, library-loads, "loading the library ends the process with exit code 0") \
    WRONG(undefined_symbol, library, library-loads, "the library calls a function that nobody has") \
    WRONG(slow_to_load, library, library-scan-time, "loading the library takes 0.3 s (a warning)") \
    WRONG(crash_in_destructor, library, library-reloads, "the library crashes while it is unloaded") \
    WRONG(no_symbol, library, library-symbols, "the library exports no smartvis_plugin_entry") \
    WRONG(extra_symbol, library, library-symbols, "the library exports a function beside its entry") \
    WRONG(other_major, library, entry-whole, "the entry's ABI major is 2") \
    WRONG(short_entry, library, entry-whole, "the entry's size is 16 bytes") \
    WRONG(count_zero, library, entry-whole, "the library says that it holds no plugin") \
    WRONG(count_endless, library, entry-whole, "the library says that it holds 2^32 - 1 plugins") \
    WRONG(no_create, library, entry-whole, "the entry's create is NULL") \
    WRONG(descriptor_missing, library, descriptors, "the descriptor of plugin 0 is NULL") \
    WRONG(descriptor_short, library, descriptors, "the descriptor's size is 24 bytes") \
    WRONG(descriptor_beyond_count, library, descriptors, "a descriptor is given for every index") \
    WRONG(no_host_carrier, library, descriptors, "the descriptor lacks SV_CARRIER_HOST") \
    WRONG(unknown_feature, library, descriptors, "the descriptor has a feature that nobody knows") \
    WRONG(no_extension_list, library, descriptors, "the descriptor's list of extensions is NULL") \
    WRONG(one_id_twice, library, descriptors, "two plugins of the library have one id") \
    WRONG(name_not_utf8, library, descriptors, "the plugin's name is not UTF-8") \
    WRONG(descriptor_changes, library, descriptor-constant, "create changes the descriptor") \
    WRONG(takes_any_id, library, create-refusals, "create makes an instance for an id that it does not have") \
    WRONG(null_host_crashes, library, create-refusals, "create reads a host that is NULL") \
    WRONG(out_left_behind, library, create-refusals, "create fails and leaves *out as it was") \
    WRONG(no_instance, library, instance-whole, "create returns SV_OK and no instance") \
    WRONG(short_instance, library, instance-whole, "the instance's size is 8 bytes") \
    WRONG(null_function, library, instance-whole, "the instance's adjust is NULL") \
    WRONG(crash_in_create, library, instance-whole, "create crashes") \
    WRONG(hang_in_create, library, instance-whole, "create never returns") \
    WRONG(param_id_repeated, params, param-ids, "one parameter's id is reported 5000 times") \
    WRONG(param_id_zero, params, param-ids, "a parameter's id is 0") \
    WRONG(param_count_endless, params, param-ids, "there are 2^32 - 1 parameters") \
    WRONG(param_label_null, params, param-strings, "a parameter's label is NULL") \
    WRONG(param_key_blank, params, param-strings, "a parameter's key has a blank and an escape sequence") \
    WRONG(default_out_of_range, params, param-ranges, "a default lies above the hard range") \
    WRONG(range_nan, params, param-ranges, "the least value is NaN") \
    WRONG(step_zero, params, param-ranges, "an int's step is 0") \
    WRONG(depends_on_itself, params, param-dependencies, "a parameter depends on itself") \
    WRONG(two_primaries, params, param-flags, "two parameters are the one that every user sees") \
    WRONG(info_overruns, params, param-info-calls, "param_info writes behind the struct's size") \
    WRONG(info_any_index, params, param-info-calls, "param_info describes parameters that do not exist") \
    WRONG(text_without_nul, params, param-text, "param_text leaves the NUL away") \
    WRONG(text_overruns, params, param-text, "param_text writes more than it was given room for") \
    WRONG(text_of_default, params, param-round-trip, "param_text always tells the default") \
    WRONG(enum_without_names, params, param-enum-names, "an enum's values have no names") \
    WRONG(enum_of_one_name, params, param-enum-names, "all values of an enum have the same name") \
    WRONG(refuses_maximum, params, param-in-range, "the greatest value is refused") \
    WRONG(accepts_beyond, params, param-out-of-range, "values beyond the hard range are accepted") \
    WRONG(accepts_nan, params, param-out-of-range, "NaN is accepted") \
    WRONG(accepts_between_steps, params, param-out-of-range, "an int takes 1.5") \
    WRONG(accepts_unknown_id, params, param-out-of-range, "ids that no parameter has are ignored") \
    WRONG(accepts_fixed, params, param-fixed, "a frame may change what only activate reads") \
    WRONG(first_value_counts, params, param-repeated, "of a repeated id the first value counts") \
    WRONG(one_setting_wrong, params, every-setting, "with one value of an enum the maps are of no use") \
    WRONG(pair_fails, params, param-pairs, "two values that are fine alone fail together") \
    WRONG(three_fail, params, param-fuzz, "three values that are fine in pairs make a depth NaN") \
    WRONG(text_disturbs, params, any-calls, "param_text moves the map of the frame under way") \
    WRONG(adjust_ignores_value, params, adjust-equals-frame, "adjust gives the frame's map again, whatever the value") \
    WRONG(depth_nan, results, depth-values, "one depth is NaN") \
    WRONG(depth_1e30, results, depth-values, "all depths are 1e30") \
    WRONG(depth_infinite, results, depth-values, "one depth is minus infinity") \
    WRONG(depth_far, results, depth-values, "one depth lies beyond twice the volume") \
    WRONG(map_not_written, results, depth-values, "end returns SV_OK and writes no map") \
    WRONG(last_row_missing, results, depth-values, "the last row of the map is not written") \
    WRONG(begin_77, results, frame-outcome, "begin returns a status that nobody knows") \
    WRONG(begin_partial, results, frame-outcome, "begin returns SV_PARTIAL") \
    WRONG(slab_1, results, frame-outcome, "slab returns SV_NO_SURFACE") \
    WRONG(end_77, results, frame-outcome, "end returns and tells an outcome that nobody knows") \
    WRONG(end_minus_77, results, first-frame, "end fails with a status that nobody knows") \
    WRONG(outcome_negative, results, frame-outcome, "end returns SV_OK, and the statistics an error") \
    WRONG(outcomes_differ, results, frame-outcome, "end returns SV_OK, and the statistics SV_PARTIAL") \
    WRONG(depths_without_surface, results, frame-outcome, "the outcome is SV_NO_SURFACE, and the map is not zero") \
    WRONG(rays_wrong, results, frame-statistics, "the statistics count one ray") \
    WRONG(points_unmarked, results, frame-statistics, "the statistics count a point that the status map does not mark") \
    WRONG(unfilled_too_many, results, frame-statistics, "more pixels are without a surface than there are") \
    WRONG(stats_size_changed, results, frame-statistics, "end changes the size of the host's statistics") \
    WRONG(status_map_garbage, results, frame-statistics, "the status map holds 9") \
    WRONG(writes_past_map, results, guard-bands, "end writes one depth behind the map") \
    WRONG(writes_between_rows, results, guard-bands, "end writes one depth behind the last row but one") \
    WRONG(ignores_pitch, results, guard-bands, "end ignores depth_pitch") \
    WRONG(writes_past_stats, results, guard-bands, "end writes behind the statistics") \
    WRONG(confidence_above, results, confidence, "one confidence is 1.001") \
    WRONG(confidence_nan, results, confidence, "one confidence is NaN") \
    WRONG(crash_on_one_pixel, results, frame-shapes, "a frame of one pixel crashes") \
    WRONG(crash_on_black, results, frame-contents, "a black volume crashes") \
    WRONG(writes_into_slab, results, inputs-unchanged, "slab writes into the host's voxels") \
    WRONG(writes_into_ranges, results, inputs-unchanged, "begin writes into the host's scanned ranges") \
    WRONG(reads_past_slab, results, reads-within-slab, "slab reads behind the bytes that it was given") \
    WRONG(reads_padding, results, padding-ignored, "hatched bytes of the texture count") \
    WRONG(ignores_ranges, results, scanned-ranges, "the scanned ranges are ignored, and the feature is announced") \
    WRONG(ignores_padding_value, results, padding-value, "padding_value is ignored, and the feature is announced") \
    WRONG(takes_any_probe, results, probe, "the probe's rotation is taken as it comes") \
    WRONG(reads_past_frame, results, probe, "begin reads the probe behind the frame of a host of 1.0") \
    WRONG(another_map_every_time, results, same-frame-same-bits, "the same frame gives another map every time") \
    WRONG(remembers_frames, results, frames-independent, "the frame before shows in the map, even after a discontinuity") \
    WRONG(depends_on_slabs, results, slab-splits, "the map depends on how the volume is cut into slabs") \
    WRONG(crash_in_activate, life, first-frame, "activate crashes") \
    WRONG(forgets_ray_bytes, life, first-frame, "the method keeps something for every ray and tells no ray_bytes") \
    WRONG(activate_fails, life, first-frame, "activate refuses every format") \
    WRONG(surface_overruns, life, first-frame, "the surface has a value more than there are rays") \
    WRONG(surface_underruns, life, first-frame, "the surface has a value before the first ray's") \
    WRONG(points_overrun, life, first-frame, "the method writes a row behind its status map") \
    WRONG(rays_overrun, life, first-frame, "the method keeps more of a ray than its ray_bytes") \
    WRONG(hang_in_activate, life, first-frame, "activate never returns") \
    WRONG(crash_in_slab, life, first-frame, "slab crashes") \
    WRONG(abort_in_slab, life, first-frame, "slab aborts") \
    WRONG(exit_in_end, life, first-frame, "end ends the process with exit code 0") \
    WRONG(hang_with_value, life, param-fuzz, "end never returns with one value of a parameter") \
    WRONG(hang_in_end, life, first-frame, "end never returns") \
    WRONG(divides_by_zero, life, first-frame, "end divides by zero") \
    WRONG(endless_recursion, life, first-frame, "end calls itself until the stack is full") \
    WRONG(memory_grab, life, first-frame, "end takes all the memory that it gets") \
    WRONG(activate_77, life, first-frame, "activate returns a status that nobody knows") \
    WRONG(activate_partial, life, first-frame, "activate returns SV_PARTIAL") \
    WRONG(takes_any_order, life, slab-refusals, "slab takes slabs in any order") \
    WRONG(takes_missing_slabs, life, slab-refusals, "end takes a volume of which slabs are missing") \
    WRONG(takes_long_slab, life, slab-refusals, "slab takes more slices than max_slab_slices") \
    WRONG(takes_short_memory, life, slab-refusals, "slab takes memory that is too small") \
    WRONG(fails_for_ever, life, slab-refusals, "after a refused slab all later frames fail") \
    WRONG(slab_before_begin, life, call-states, "slab is taken before begin") \
    WRONG(end_twice, life, call-states, "end may be called twice") \
    WRONG(activates_twice, life, call-states, "activate is taken while active") \
    WRONG(ignores_deactivate, life, call-states, "deactivate does nothing") \
    WRONG(lost_after_adjust, life, state-walk, "a begin after an adjust after an adjust is refused") \
    WRONG(takes_any_format, life, format-refusals, "activate takes tiles narrower than the volume") \
    WRONG(takes_unknown_flags, life, format-refusals, "activate takes flags that nobody knows") \
    WRONG(null_frame_crashes, life, null-arguments, "begin reads a frame that is NULL") \
    WRONG(takes_missing_values, life, null-arguments, "begin takes 3 values at NULL for none") \
    WRONG(ignores_sizes, life, struct-sizes, "begin ignores the struct's size") \
    WRONG(refuses_longer_structs, life, struct-sizes, "structs of a later minor are refused") \
    WRONG(no_reason, life, reasons, "an error comes without a reason") \
    WRONG(reason_stays, life, reasons, "last_error tells of an error that has passed") \
    WRONG(any_extension, life, extensions, "there is a table for every extension's id") \
    WRONG(leaks_memory, life, activations, "every activation leaks memory") \
    WRONG(leaks_file, life, activations, "every activation leaks an open file") \
    WRONG(leaks_thread, life, activations, "every activation leaves a thread behind") \
    WRONG(shared_state, life, instances-interleaved, "two instances share their frame's values") \
    WRONG(shared_scratch, life, instances-parallel, "two instances share their scratch memory") \
    WRONG(needs_log, life, bare-host, "a host without a log is not served") \
    WRONG(unknown_severity, life, host-callbacks, "lines are logged with a severity that nobody knows") \
    WRONG(logs_null, life, host-callbacks, "a line of the log is NULL") \
    WRONG(logs_without_end, life, host-callbacks, "slab logs thousands of lines") \
    WRONG(changes_locale, life, process-untouched, "activate changes the process's locale") \
    WRONG(changes_rounding, life, process-untouched, "end leaves another rounding mode behind") \
    WRONG(closes_descriptors, life, process-untouched, "begin closes descriptors 0 to 1023") \
    WRONG(shrinks_files, life, process-untouched, "begin cuts off every file that is open") \
    WRONG(writes_to_files, life, process-untouched, "begin writes to every file that is open") \
    WRONG(takes_signal, life, process-untouched, "activate handles SIGUSR1") \
    WRONG(lowers_limits, life, process-untouched, "activate lowers the limit of open files") \
    WRONG(lowers_hard_limit, life, process-untouched, "activate lowers how far a limit can be raised") \
    WRONG(forks, life, process-untouched, "end comes back twice, from a fork") \
    WRONG(forks_session, life, process-untouched, "end leaves a process in a session of its own behind") \
    WRONG(closes_when_refused, life, slab-refusals, "slab closes descriptors 0 to 1023 when it refuses a slab") \
    WRONG(forks_in_adjust, life, adjust-equals-frame, "adjust with a value leaves a process behind") \
    WRONG(writes_in_adjust, life, inputs-unchanged, "adjust writes into the host's voxels") \
    WRONG(prints, life, process-untouched, "slab prints to the standard output") \
    WRONG(frame_allocates, life, frame-path-heap, "begin allocates memory") \
    WRONG(slow_frames, life, frame-time, "end takes 60 ms, but for every third frame (a warning)") \
    WRONG(ignores_no_memory, life, heap-faults, "activate does not look whether it got its memory") \
    WRONG(create_calls_opencl, opencl, create-without-opencl, "create asks OpenCL for its platforms") \
    WRONG(end_minus_78, opencl, first-frame, "end fails with a status that nobody knows, on the host's queue") \
    WRONG(hang_in_kernel, opencl, first-frame, "a kernel never ends") \
    WRONG(hang_beside_opencl, opencl, first-frame, "slab launches a kernel and never comes back") \
    WRONG(frame_finishes, opencl, frame-path-opencl, "end waits for the host's queue") \
    WRONG(frame_blocks, opencl, frame-path-opencl, "end writes with a blocking call") \
    WRONG(frame_creates_buffer, opencl, frame-path-opencl, "slab makes an OpenCL buffer") \
    WRONG(frame_builds, opencl, frame-path-opencl, "begin builds a program") \
    WRONG(frame_waits_long, opencl, frame-path-opencl, "begin waits for OpenCL for seconds") \
    WRONG(cold_frame, opencl, first-launches, "activate launches no kernel (a warning)") \
    WRONG(leaks_buffer, opencl, opencl-balance, "every activation leaks an OpenCL buffer") \
    WRONG(retains_queue, opencl, opencl-balance, "activate retains the host's queue") \
    WRONG(ignores_opencl_errors, opencl, opencl-faults, "an OpenCL call that fails goes unnoticed") \
    WRONG(crash_on_opencl_error, opencl, opencl-faults, "a buffer that cannot be made is used all the same") \
    WRONG(writes_into_object, opencl, inputs-unchanged, "slab writes into the host's voxels through the queue") \
    WRONG(writes_past_object, opencl, guard-bands, "end writes in front of the map through the queue") \
    WRONG(refuses_buffers, opencl, carriers, "activate refuses a carrier that the descriptor offers") \
    WRONG(carriers_differ, opencl, carriers, "a volume in buffers gives another map than in memory") \
    WRONG(needs_nothing, opencl, needs, "smartvis.needs/1 tells zeros for all that is taken") \
    WRONG(takes_foreign_objects, opencl, foreign-objects, "begin takes ranges in a buffer of another context")
