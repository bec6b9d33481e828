/* SPDX-License-Identifier: MIT */
#include "validate/checks/check_list.h"

#include "validate/checks/check_create.h"
#include "validate/checks/check_frame.h"
#include "validate/checks/check_input.h"
#include "validate/checks/check_library.h"
#include "validate/checks/check_opencl.h"
#include "validate/checks/check_param_info.h"
#include "validate/checks/check_param_pairs.h"
#include "validate/checks/check_param_text.h"
#include "validate/checks/check_param_values.h"
#include "validate/checks/check_refusal.h"
#include "validate/checks/check_repeat.h"
#include "validate/checks/check_settings.h"
#include "validate/checks/check_state.h"

#include <string.h>

/* What others need comes before them. */
const v_check v_checks[] = {
    /* ---- the library */
    {"library-loads", NULL, "The library can be loaded with all its symbols resolved.",
     "Link it with -Wl,-z,defs, and do nothing in constructors.", check_library_loads},
    {"library-symbols", "library-loads", "The library exports smartvis_plugin_entry and nothing else.",
     "Compile with -fvisibility=hidden, or link with a version script.", check_library_symbols},
    {"entry-whole", "library-loads", "The entry has this ABI's major, its size, a count and both functions.",
     "Initialise smartvis_plugin_entry as SVA_ENTRY does.", check_entry_whole},
    {"descriptors", "entry-whole", "Every descriptor is whole, and there are as many as the entry says.",
     "Fill every field of sv_descriptor; return NULL for an index beyond count.", check_descriptors},
    {"instance-whole", "descriptors", "create gives whole instances, which can be destroyed at once.",
     "Fill every function of sv_plugin, and set *out only when the instance is whole.", check_instance_whole},
    {"library-reloads", "instance-whole", "The library can be unloaded and loaded again.",
     "Keep nothing in the library that outlives it: threads, handlers, thread-local destructors.",
     check_library_reloads},
    {"library-scan-time", "library-reloads", "Loading and describing takes less than 0.1 s (a warning).",
     "Move work from constructors and descriptor into activate.", check_library_scan_time},
    {"descriptor-constant", "library-reloads", "The descriptors stay as they are.",
     "Make them static const; what differs between instances belongs into extensions.",
     check_descriptor_constant},
    /* ---- instances, host and process */
    {"create-refusals", "library-reloads", "create refuses unknown ids and NULL, and sets *out to NULL then.",
     "Compare the whole id, and check the arguments before anything else.", check_create_refusals},
    {"create-without-opencl", "library-reloads", "create makes no OpenCL call.",
     "Look for a device in activate.", check_create_without_opencl},
    {"extensions", "library-reloads",
     "get_extension gives the same table every time, and NULL for unknown ids.",
     "Compare the whole id, revision included, with the ids of the descriptor's list.", check_extensions},
    {"first-frame", "library-reloads",
     "Three frames come out of an activation, in time and without an accident.",
     "Run the plugin with a debugger: sv_validate --in-process --only first-frame.", check_first_frame},
    {"bare-host", "first-frame", "A host without log and get_extension is served.",
     "Test both function pointers of sv_host before you call them.", check_bare_host},
    {"host-callbacks", "first-frame", "The host's functions are called as the header says.",
     "Log one finished line of UTF-8 with a severity of the header, and leave sv_host as it is.",
     check_host_callbacks},
    {"process-untouched", "first-frame", "Locale, rounding, folder, umask, signals and standard output stay.",
     "Leave the process to the host; print through its log.", check_process_untouched},
    /* ---- parameters */
    {"param-ids", "library-reloads", "Parameters are few, and each has an id of its own that is not 0.",
     "Number the parameters from 1 and never reuse a number.", check_param_ids},
    {"param-strings", "param-ids",
     "Keys, labels, units, helps and groups are texts; keys are [a-z0-9_]+ and unique.",
     "Give every string, \"\" for none.", check_param_strings},
    {"param-ranges", "param-ids", "Ranges, defaults and steps are finite and fit each other.",
     "Put default and display range inside the hard range, and both on the steps.", check_param_ranges},
    {"param-dependencies", "param-ids", "What a parameter depends on is there, and it is not itself.",
     "Name an int, bool or enum in depends_on, and set a bit of depends_values.", check_param_dependencies},
    {"param-flags", "param-ids",
     "Flags are known; one primary at most; SV_PARAM_ADJUST goes with its feature.",
     "Flag one parameter SV_PARAM_PRIMARY, and announce SV_FEATURE_ADJUST if one is adjustable.",
     check_param_flags},
    {"param-info-calls", "param-ids",
     "param_info writes no further than size, and refuses what does not exist.",
     "Check out, out->size and the index before you write.", check_param_info_calls},
    {"param-text", "param-ids", "param_text ends its text with a NUL within the bytes that it was given.",
     "Write with snprintf(out, bytes, ...).", check_param_text},
    {"param-round-trip", "param-ids", "The text of a number is that number.",
     "Print the value that was asked for, with enough digits for a step, in the locale \"C\".",
     check_param_round_trip},
    {"param-enum-names", "param-ids", "Every value of an enum or a bool has a name of its own.",
     "Give as many names as there are values, none longer than 63 bytes.", check_param_enum_names},
    {"param-in-range", "first-frame", "begin takes every value of the hard range, ends included.",
     "Refuse only what lies outside of what param_info says.", check_param_in_range},
    {"param-out-of-range", "first-frame",
     "Values beyond the range, between steps, NaN and unknown ids are refused.",
     "Compare so that NaN fails: !(value >= least && value <= most).", check_param_out_of_range},
    {"param-fixed", "first-frame", "A frame may repeat what activate was given, and not change it.",
     "Return SV_ERR_PARAM_FIXED if a value flagged SV_PARAM_REACTIVATE differs.", check_param_fixed},
    {"param-repeated", "first-frame", "Of a repeated id the last value counts.",
     "Walk through the list from its start and overwrite.", check_param_repeated},
    {"every-setting", "first-frame",
     "With every value that only activate reads, frames are sound, repeatable, and free of slabs and "
     "padding.",
     "See the checks depth-values, same-frame-same-bits, slab-splits and padding-ignored.",
     check_every_setting},
    {"param-pairs", "first-frame", "Any two values that only activate reads go together.",
     "Make them go together, or make one parameter of them.", check_param_pairs},
    {"param-fuzz", "first-frame", "Frames with random values of random volumes have finite maps.",
     "Look for divisions and indices that depend on the values.", check_param_fuzz},
    {"adjust-equals-frame", "first-frame", "adjust gives the map that a frame with the same values gives.",
     "Keep from the frame what the adjustable values do not change, and compute the rest anew.",
     check_adjust_equals_frame},
    /* ---- frames */
    {"frame-outcome", "first-frame", "Calls return the header's statuses, and end, statistics and map agree.",
     "Return SV_OK from begin and slab, and write SV_NO_SURFACE's zeros.", check_frame_outcome},
    {"depth-values", "first-frame", "Every depth is written, finite and within twice the volume.",
     "Test for rays without evidence before you divide, and write them as 0.", check_depth_values},
    {"frame-statistics", "first-frame", "The statistics and the status map agree with the frame.",
     "Count this frame's rays, and leave stats.size as it is.", check_frame_statistics},
    {"guard-bands", "first-frame", "Nothing is written beside the map, the status map and the statistics.",
     "Heed depth_pitch, and write no further than width, height and stats.size.", check_guard_bands},
    {"frame-shapes", "first-frame", "Frames of one pixel, one slice, odd and long sides work.",
     "Look for width - 1, for work sizes that do not divide, and for work on the last row.",
     check_frame_shapes},
    {"frame-contents", "first-frame", "Black, white, grey, noisy and striped volumes work.",
     "Look for counts that can be 0, and histograms with one bin filled.", check_frame_contents},
    {"confidence", "first-frame", "The confidence map is within 0 .. 1, and is 0 without a surface.",
     "Clamp it, and test for NaN before.", check_confidence},
    {"inputs-unchanged", "first-frame", "Voxels, ranges and structs of the host stay as they are.",
     "Copy what you must change.", check_inputs_unchanged},
    {"reads-within-slab", "first-frame", "A slab is read up to its bytes and not beyond.",
     "Clamp vector loads at the last row of the last tile.", check_reads_within_slab},
    {"padding-ignored", "first-frame", "Bytes that belong to no slice do not show in the map.",
     "Use tile_w, tile_h and row_pitch to find a voxel, and width and height to end.", check_padding_ignored},
    {"scanned-ranges", "first-frame", "Voxels outside of the scanned ranges do not show in the map.",
     "Skip them, and cut off ranges that end beyond the volume; or do not announce SV_FEATURE_SCANNED.",
     check_scanned_ranges},
    {"padding-value", "first-frame", "padding_value marks what was not scanned, if the plugin says so.",
     "Skip voxels of that value; or do not announce SV_FEATURE_PADDING.", check_padding_value},
    {"same-frame-same-bits", "first-frame", "The same frame gives the same bits.",
     "Initialise all memory; sum integers, or in a fixed order.", check_same_frame_same_bits},
    {"frames-independent", "first-frame", "Earlier frames do not show after SV_FRAME_DISCONTINUITY.",
     "Forget them there and in deactivate.", check_frames_independent},
    {"slab-splits", "first-frame", "The map does not depend on how the volume is cut into slabs.",
     "Carry the state of every ray from slab to slab.", check_slab_splits},
    {"carriers", "first-frame", "Every carrier and queue that the descriptor offers gives the same map.",
     "Take offset into account; do not offer what activate refuses.", check_carriers},
    /* ---- what must be refused */
    {"call-states", "first-frame", "Every call in every state does what the header says.",
     "Keep a state in the instance and test it first; SV_ERR_STATE changes nothing.", check_call_states},
    {"state-walk", "call-states", "Hundreds of calls in a random order do what the header says.",
     "Run it again with the same --seed and --verbose.", check_state_walk},
    {"slab-refusals", "first-frame", "Slabs out of order, missing, too long or too small end the frame only.",
     "Check first_slice, slice_count and bytes before you read.", check_slab_refusals},
    {"format-refusals", "first-frame", "Impossible and unknown formats are refused.",
     "Check every field of sv_format before you allocate.", check_format_refusals},
    {"null-arguments", "first-frame", "NULL where something is needed is SV_ERR_ARGUMENT.",
     "Check pointers first.", check_null_arguments},
    {"struct-sizes", "first-frame", "Structs shorter than those of 1.0 are refused, longer ones are taken.",
     "Test size < sizeof, and ignore what lies behind the fields that you know.", check_struct_sizes},
    {"reasons", "first-frame", "last_error has a reason after an error, and none after a success.",
     "Set it with every error, and clear it when a call begins.", check_reasons},
    /* ---- OpenCL, memory, threads */
    {"frame-path-opencl", "first-frame", "The frame path creates and builds nothing, and does not block.",
     "Make everything in activate, and enqueue with CL_FALSE.", check_frame_path_opencl},
    {"frame-path-heap", "first-frame", "The frame path allocates nothing.", "Allocate in activate.",
     check_frame_path_heap},
    {"first-launches", "first-frame", "activate has launched every kernel as a frame does (a warning).",
     "Launch each once with its final local size in activate.", check_first_launches},
    {"opencl-balance", "first-frame",
     "deactivate leaves no OpenCL object behind, and none of the host's retained.",
     "Release what you created, and nothing else.", check_opencl_balance},
    {"activations", "first-frame", "A hundred activations leave nothing behind.",
     "Free in deactivate what activate took; join its threads.", check_activations},
    {"opencl-faults", "first-frame", "An OpenCL call that fails once gives an error or the right map.",
     "Check every return value, and release what was made before.", check_opencl_faults},
    {"heap-faults", "first-frame", "An allocation that fails once gives an error or the right map.",
     "Check every pointer, and free what was allocated before.", check_heap_faults},
    {"instances-interleaved", "first-frame", "Two instances used in turn do not disturb each other.",
     "Keep all state in the instance, none in static variables.", check_instances_interleaved},
    {"instances-parallel", "instances-interleaved",
     "Instances on threads of their own do not disturb each other.",
     "Share nothing between instances, kernels included.", check_instances_parallel},
    {"any-calls", "first-frame", "Calls tagged [any] do not disturb a frame on another thread.",
     "Let them read constant data only; they leave last_error alone.", check_any_calls},
};
const size_t v_check_count = sizeof v_checks / sizeof *v_checks;

const v_check *v_check_find(const char *id) {
    for (size_t i = 0; i < v_check_count; i++)
        if (strcmp(v_checks[i].id, id) == 0) return &v_checks[i];
    return NULL;
}
