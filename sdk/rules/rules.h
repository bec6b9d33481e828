/* SPDX-License-Identifier: MIT */
/*
 * The rules of smartvis_plugin.h that a program can tell, in one table, and judges that need no more than
 * what lies before them. sv_validate tries a plugin by them; the checking layer (sdk/layer/) watches
 * plugin and host of a real machine by them.
 */
#pragma once

#include "smartvis_plugin.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * RULE(name, who, id, needs, what holds, how to mend it)
 *   who    TRIED: the validator tries it; SEEN: the layer sees it; BOTH
 *   id     kebab-case, stable; rules of hosts begin with "host-"
 *   needs  the validator skips it unless that rule holds; NULL: none. What others need comes before them.
 */
#define RULES(RULE)                                                                                          \
    /* ---- the library */                                                                                   \
    RULE(library_loads, TRIED, "library-loads", NULL,                                                        \
         "The library can be loaded with all its symbols resolved.",                                         \
         "Link it with -Wl,-z,defs, and do nothing in constructors.")                                        \
    RULE(library_symbols, TRIED, "library-symbols", "library-loads",                                         \
         "The library exports smartvis_plugin_entry and nothing else.",                                      \
         "Compile with -fvisibility=hidden, or link with a version script.")                                 \
    RULE(entry_whole, BOTH, "entry-whole", "library-loads",                                                  \
         "The entry has this ABI's major, its size, a count and both functions.",                            \
         "Initialise smartvis_plugin_entry as SVA_ENTRY does.")                                              \
    RULE(descriptors, BOTH, "descriptors", "entry-whole",                                                    \
         "Every descriptor is whole, and there are as many as the entry says.",                              \
         "Fill every field of sv_descriptor; return NULL for an index beyond count.")                        \
    RULE(instance_whole, BOTH, "instance-whole", "descriptors",                                              \
         "create gives whole instances, which can be destroyed at once.",                                    \
         "Fill every function of sv_plugin, and set *out only when the instance is whole.")                  \
    RULE(library_reloads, TRIED, "library-reloads", "instance-whole",                                        \
         "The library can be unloaded and loaded again.",                                                    \
         "Keep nothing in the library that outlives it: threads, handlers, thread-local destructors.")       \
    RULE(library_scan_time, TRIED, "library-scan-time", "library-reloads",                                   \
         "Loading and describing takes less than 0.1 s (a warning).",                                        \
         "Move work from constructors and descriptor into activate.")                                        \
    RULE(descriptor_constant, BOTH, "descriptor-constant", "library-reloads",                                \
         "The descriptors stay as they are.",                                                                \
         "Make them static const; what differs between instances belongs into extensions.")                  \
    /* ---- instances, host and process */                                                                   \
    RULE(create_refusals, BOTH, "create-refusals", "library-reloads",                                        \
         "create refuses unknown ids and NULL, and sets *out to NULL then.",                                 \
         "Compare the whole id, and check the arguments before anything else.")                              \
    RULE(create_without_opencl, TRIED, "create-without-opencl", "library-reloads",                           \
         "create makes no OpenCL call.", "Look for a device in activate.")                                   \
    RULE(extensions, BOTH, "extensions", "library-reloads",                                                  \
         "get_extension gives the same table every time, and NULL for unknown ids.",                         \
         "Compare the whole id, revision included, with the ids of the descriptor's list.")                  \
    RULE(first_frame, TRIED, "first-frame", "library-reloads",                                               \
         "Three frames come out of an activation, in time and without an accident.",                         \
         "Run the plugin with a debugger: sv_validate --in-process --only first-frame.")                     \
    RULE(bare_host, TRIED, "bare-host", "first-frame", "A host without log and get_extension is served.",    \
         "Test both function pointers of sv_host before you call them.")                                     \
    RULE(host_callbacks, BOTH, "host-callbacks", "first-frame",                                              \
         "The host's functions are called as the header says.",                                              \
         "Log one finished line of UTF-8 with a severity of the header, and leave sv_host as it is.")        \
    RULE(process_untouched, BOTH, "process-untouched", "first-frame",                                        \
         "Locale, rounding, folder, umask, signals, descriptors, limits and standard output stay.",          \
         "Leave the process to the host: close and write what you opened, start no processes, print "        \
         "through its log.")                                                                                 \
    /* ---- parameters */                                                                                    \
    RULE(param_ids, BOTH, "param-ids", "library-reloads",                                                    \
         "Parameters are few, and each has an id of its own that is not 0.",                                 \
         "Number the parameters from 1 and never reuse a number.")                                           \
    RULE(param_strings, BOTH, "param-strings", "param-ids",                                                  \
         "Keys, labels, units, helps and groups are texts; keys are [a-z0-9_]+ and unique.",                 \
         "Give every string, \"\" for none.")                                                                \
    RULE(param_ranges, BOTH, "param-ranges", "param-ids",                                                    \
         "Ranges, defaults and steps are finite and fit each other.",                                        \
         "Put default and display range inside the hard range, and both on the steps.")                      \
    RULE(param_dependencies, BOTH, "param-dependencies", "param-ids",                                        \
         "What a parameter depends on is there, and it is not itself.",                                      \
         "Name an int, bool or enum in depends_on, and set a bit of depends_values.")                        \
    RULE(param_flags, BOTH, "param-flags", "param-ids",                                                      \
         "Flags are known; one primary at most; SV_PARAM_ADJUST goes with its feature.",                     \
         "Flag one parameter SV_PARAM_PRIMARY, and announce SV_FEATURE_ADJUST if one is adjustable.")        \
    RULE(param_info_calls, BOTH, "param-info-calls", "param-ids",                                            \
         "param_info writes no further than size, and refuses what does not exist.",                         \
         "Check out, out->size and the index before you write.")                                             \
    RULE(param_text, BOTH, "param-text", "param-ids",                                                        \
         "param_text ends its text with a NUL within the bytes that it was given.",                          \
         "Write with snprintf(out, bytes, ...).")                                                            \
    RULE(param_round_trip, TRIED, "param-round-trip", "param-ids", "The text of a number is that number.",   \
         "Print the value that was asked for, with enough digits for a step, in the locale \"C\".")          \
    RULE(param_enum_names, TRIED, "param-enum-names", "param-ids",                                           \
         "Every value of an enum or a bool has a name of its own.",                                          \
         "Give as many names as there are values, none longer than 63 bytes.")                               \
    RULE(param_in_range, TRIED, "param-in-range", "first-frame",                                             \
         "begin takes every value of the hard range, ends included.",                                        \
         "Refuse only what lies outside of what param_info says.")                                           \
    RULE(param_out_of_range, BOTH, "param-out-of-range", "first-frame",                                      \
         "Values beyond the range, between steps, left out by an enum, NaN and unknown ids are refused.",    \
         "Compare so that NaN fails: !(value >= least && value <= most).")                                   \
    RULE(param_fixed, BOTH, "param-fixed", "first-frame",                                                    \
         "A frame may repeat what activate was given, and not change it.",                                   \
         "Return SV_ERR_PARAM_FIXED if a value flagged SV_PARAM_REACTIVATE differs.")                        \
    RULE(param_repeated, TRIED, "param-repeated", "first-frame", "Of a repeated id the last value counts.",  \
         "Walk through the list from its start and overwrite.")                                              \
    RULE(every_setting, TRIED, "every-setting", "first-frame",                                               \
         "With every value that only activate reads, frames are sound, repeatable, and free of slabs and "   \
         "padding.",                                                                                         \
         "See the checks depth-values, same-frame-same-bits, slab-splits and padding-ignored.")              \
    RULE(param_pairs, TRIED, "param-pairs", "first-frame",                                                   \
         "Any two values that only activate reads go together.",                                             \
         "Make them go together, or make one parameter of them.")                                            \
    RULE(param_fuzz, TRIED, "param-fuzz", "first-frame",                                                     \
         "Frames with random values of random volumes have finite maps.",                                    \
         "Look for divisions and indices that depend on the values.")                                        \
    RULE(adjust_equals_frame, TRIED, "adjust-equals-frame", "first-frame",                                   \
         "adjust gives the map that a frame with the same values gives.",                                    \
         "Keep from the frame what the adjustable values do not change, and compute the rest anew.")         \
    /* ---- frames */                                                                                        \
    RULE(frame_outcome, BOTH, "frame-outcome", "first-frame",                                                \
         "Calls return the header's statuses, and end, statistics and map agree.",                           \
         "Return SV_OK from begin and slab, and write SV_NO_SURFACE's zeros.")                               \
    RULE(depth_values, BOTH, "depth-values", "first-frame",                                                  \
         "Every depth is written, finite and within twice the volume.",                                      \
         "Test for rays without evidence before you divide, and write them as 0.")                           \
    RULE(frame_statistics, BOTH, "frame-statistics", "first-frame",                                          \
         "The statistics and the status map agree with the frame.",                                          \
         "Count this frame's rays, and leave stats.size as it is.")                                          \
    RULE(guard_bands, BOTH, "guard-bands", "first-frame",                                                    \
         "Nothing is written beside the map, the status map and the statistics.",                            \
         "Heed depth_pitch, and write no further than width, height and stats.size.")                        \
    RULE(frame_shapes, TRIED, "frame-shapes", "first-frame",                                                 \
         "Frames of one pixel, one slice, odd and long sides work.",                                         \
         "Look for width - 1, for work sizes that do not divide, and for work on the last row.")             \
    RULE(frame_contents, TRIED, "frame-contents", "first-frame",                                             \
         "Black, white, grey, noisy and striped volumes work.",                                              \
         "Look for counts that can be 0, and histograms with one bin filled.")                               \
    RULE(confidence, BOTH, "confidence", "first-frame",                                                      \
         "The confidence map is within 0 .. 1, and is 0 without a surface.",                                 \
         "Clamp it, and test for NaN before.")                                                               \
    RULE(inputs_unchanged, BOTH, "inputs-unchanged", "first-frame",                                          \
         "Voxels, ranges and structs of the host stay as they are.", "Copy what you must change.")           \
    RULE(reads_within_slab, TRIED, "reads-within-slab", "first-frame",                                       \
         "A slab is read up to its bytes and not beyond.",                                                   \
         "Clamp vector loads at the last row of the last tile.")                                             \
    RULE(padding_ignored, TRIED, "padding-ignored", "first-frame",                                           \
         "Bytes that belong to no slice do not show in the map.",                                            \
         "Use tile_w, tile_h and row_pitch to find a voxel, and width and height to end.")                   \
    RULE(scanned_ranges, TRIED, "scanned-ranges", "first-frame",                                             \
         "Voxels outside of the scanned ranges do not show in the map.",                                     \
         "Skip them, and cut off ranges that end beyond the volume; or do not announce SV_FEATURE_SCANNED.") \
    RULE(padding_value, TRIED, "padding-value", "first-frame",                                               \
         "padding_value marks what was not scanned, if the plugin says so.",                                 \
         "Skip voxels of that value; or do not announce SV_FEATURE_PADDING.")                                \
    RULE(probe, BOTH, "probe", "first-frame",                                                                \
         "Where the probe is counts only if the frame and the plugin say so, and as the header says it.",    \
         "Refuse what sv_probe_holds refuses, and read the fields with sv_probe_of (smartvis/probe.h).")     \
    RULE(same_frame_same_bits, TRIED, "same-frame-same-bits", "first-frame",                                 \
         "The same frame gives the same bits.", "Initialise all memory; sum integers, or in a fixed order.") \
    RULE(frames_independent, TRIED, "frames-independent", "first-frame",                                     \
         "Earlier frames do not show after SV_FRAME_DISCONTINUITY.", "Forget them there and in deactivate.") \
    RULE(slab_splits, TRIED, "slab-splits", "first-frame",                                                   \
         "The map does not depend on how the volume is cut into slabs.",                                     \
         "Carry the state of every ray from slab to slab.")                                                  \
    RULE(carriers, TRIED, "carriers", "first-frame",                                                         \
         "Every carrier and queue that the descriptor offers gives the same map.",                           \
         "Take offset into account; do not offer what activate refuses.")                                    \
    RULE(foreign_objects, BOTH, "foreign-objects", "carriers", "Objects of another context are refused.",    \
         "Compare CL_MEM_CONTEXT with the format's context.")                                                \
    /* ---- what must be refused */                                                                          \
    RULE(call_states, BOTH, "call-states", "first-frame",                                                    \
         "Every call in every state does what the header says.",                                             \
         "Keep a state in the instance and test it first; SV_ERR_STATE changes nothing.")                    \
    RULE(state_walk, TRIED, "state-walk", "call-states",                                                     \
         "Hundreds of calls in a random order do what the header says.",                                     \
         "Run it again with the same --seed and --verbose.")                                                 \
    RULE(slab_refusals, BOTH, "slab-refusals", "first-frame",                                                \
         "Slabs out of order, missing, too long or too small end the frame only.",                           \
         "Check first_slice, slice_count and bytes before you read.")                                        \
    RULE(format_refusals, BOTH, "format-refusals", "first-frame",                                            \
         "Impossible and unknown formats are refused.",                                                      \
         "Check every field of sv_format before you allocate.")                                              \
    RULE(null_arguments, BOTH, "null-arguments", "first-frame",                                              \
         "NULL where something is needed is SV_ERR_ARGUMENT.", "Check pointers first.")                      \
    RULE(struct_sizes, BOTH, "struct-sizes", "first-frame",                                                  \
         "Structs shorter than those of 1.0 are refused, longer ones are taken.",                            \
         "Test size < sizeof, and ignore what lies behind the fields that you know.")                        \
    RULE(reasons, BOTH, "reasons", "first-frame",                                                            \
         "last_error has a reason after an error, and none after a success.",                                \
         "Set it with every error, and clear it when a call begins.")                                        \
    /* ---- OpenCL, memory, threads */                                                                       \
    RULE(frame_path_opencl, TRIED, "frame-path-opencl", "first-frame",                                       \
         "The frame path creates and builds nothing, and does not block.",                                   \
         "Make everything in activate, and enqueue with CL_FALSE.")                                          \
    RULE(frame_path_heap, TRIED, "frame-path-heap", "first-frame", "The frame path allocates nothing.",      \
         "Allocate in activate.")                                                                            \
    RULE(first_launches, TRIED, "first-launches", "first-frame",                                             \
         "activate has launched every kernel as a frame does (a warning).",                                  \
         "Launch each once with its final local size in activate.")                                          \
    RULE(frame_time, TRIED, "frame-time", "first-frame",                                                     \
         "A frame of 128 x 128 x 128 takes 50 ms at most: 20 volumes a second (a warning).",                 \
         "Measure what its parts take (smartvis.timing/1, or a profiler); read every voxel once, slab by "   \
         "slab.")                                                                                            \
    RULE(opencl_balance, TRIED, "opencl-balance", "first-frame",                                             \
         "deactivate leaves no OpenCL object behind, and none of the host's retained.",                      \
         "Release what you created, and nothing else.")                                                      \
    RULE(needs, TRIED, "needs", "first-frame",                                                               \
         "smartvis.needs/1 tells what activate takes and a frame enqueues, and calls no OpenCL for it.",     \
         "Count by the code that makes the buffers and enqueues the commands.")                              \
    RULE(activations, TRIED, "activations", "first-frame", "A hundred activations leave nothing behind.",    \
         "Free in deactivate what activate took; join its threads.")                                         \
    RULE(opencl_faults, TRIED, "opencl-faults", "first-frame",                                               \
         "An OpenCL call that fails once gives an error or the right map.",                                  \
         "Check every return value, and release what was made before.")                                      \
    RULE(heap_faults, TRIED, "heap-faults", "first-frame",                                                   \
         "An allocation that fails once gives an error or the right map.",                                   \
         "Check every pointer, and free what was allocated before.")                                         \
    RULE(instances_interleaved, TRIED, "instances-interleaved", "first-frame",                               \
         "Two instances used in turn do not disturb each other.",                                            \
         "Keep all state in the instance, none in static variables.")                                        \
    RULE(instances_parallel, TRIED, "instances-parallel", "instances-interleaved",                           \
         "Instances on threads of their own do not disturb each other.",                                     \
         "Share nothing between instances, kernels included.")                                               \
    RULE(any_calls, TRIED, "any-calls", "first-frame",                                                       \
         "Calls tagged [any] do not disturb a frame on another thread.",                                     \
         "Let them read constant data only; they leave last_error alone.")                                   \
    /* ---- what only the layer sees */                                                                      \
    RULE(frame_path_time, SEEN, "frame-path-time", NULL,                                                     \
         "begin, slab, end and adjust return within SMARTVIS_CHECK_MS milliseconds.",                        \
         "Enqueue and return; make and compile everything in activate.")                                     \
    RULE(host_create, SEEN, "host-create", NULL,                                                             \
         "create is given a host with its size, a name and a version, and an id.",                           \
         "Fill sv_host, and take the id from a descriptor.")                                                 \
    RULE(host_states, SEEN, "host-states", NULL,                                                             \
         "A call comes in a state that its tag allows, and destroy behind deactivate.",                      \
         "activate; then begin, all slabs, end, and adjust if you like; then deactivate.")                   \
    RULE(host_threads, SEEN, "host-threads", NULL,                                                           \
         "Calls of an instance do not overlap, but for those of any thread.",                                \
         "Order them with a lock, or make all of them on one thread.")                                       \
    RULE(host_sizes, SEEN, "host-sizes", NULL, "Every struct has the size that it was compiled with.",       \
         "Set size to sizeof of the struct.")                                                                \
    RULE(host_reserved, SEEN, "host-reserved", NULL, "Reserved fields are 0.",                               \
         "Initialise structs with {0} and name the fields you set.")                                         \
    RULE(host_format, SEEN, "host-format", NULL,                                                             \
         "A format is possible, and within what the descriptor offers.",                                     \
         "Read the descriptor before activate.")                                                             \
    RULE(host_values, SEEN, "host-values", NULL,                                                             \
         "Values have ids that there are, lie in their ranges, and belong to the call.",                     \
         "Take id, range and flags from param_info.")                                                        \
    RULE(host_frame, SEEN, "host-frame", NULL, "A frame has known flags, and ranges if the format says so.", \
         "Give exactly one of scanned and scanned_object with SV_FORMAT_SCANNED, else neither.")             \
    RULE(host_clock, SEEN, "host-clock", NULL, "time_ns does not run back, but for a discontinuity.",        \
         "Take a monotonic clock, or 0.")                                                                    \
    RULE(host_slabs, SEEN, "host-slabs", NULL,                                                               \
         "Slabs come front to back and whole, each with memory for its slices.",                             \
         "Begin a slab where the one before it ended; bytes reach its last voxel.")                          \
    RULE(host_result, SEEN, "host-result", NULL,                                                             \
         "A result names one place for depths, large enough for a map.",                                     \
         "Give either depth or depth_object, and a depth_pitch of 0 or at least width * 4.")                 \
    RULE(host_objects, SEEN, "host-objects", NULL,                                                           \
         "OpenCL objects are of the format's context, of the right kind, and large enough.",                 \
         "Create them in the context that activate is given.")                                               \
    RULE(host_objects_kept, SEEN, "host-objects-kept", NULL,                                                 \
         "Objects of slabs and ranges stay until end has returned.", "Release them behind that.")            \
    RULE(host_contents, SEEN, "host-contents", NULL,                                                         \
         "Voxels and ranges stay as they are until the commands of their frame have run.",                   \
         "Wait for the queue before you write the next volume there, or take turns.")

typedef enum {
#define RULE_NAME(name, who, id, needs, what, mend) RULE_##name,
    RULES(RULE_NAME)
#undef RULE_NAME
        RULE_COUNT
} rule_name;

typedef struct {
    const char *id;
    const char *what; /* one sentence: what holds */
    const char *mend; /* one sentence: what to do if it does not */
    bool tried, seen; /* by the validator, by the layer */
} rule;

extern const rule rules[RULE_COUNT];

/* True for a rule that binds the host. */
bool rule_is_hosts(rule_name name);

/* Where a broken rule is told. `text` says call, field and value, and is valid during the call, which need
 * not come back. */
typedef struct {
    void (*broken)(void *context, rule_name name, const char *text);
    void *context;
} rule_sink;

void rule_tell(const rule_sink *to, rule_name name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Tells of the rule and leaves the judge unless `holds`. */
#define RULE_EXPECT(to, name, holds, ...)                                                                    \
    do {                                                                                                     \
        if (!(holds)) {                                                                                      \
            rule_tell(to, name, __VA_ARGS__);                                                                \
            return;                                                                                          \
        }                                                                                                    \
    } while (0)

/* True if `text` is UTF-8 of at most `max_bytes` bytes without control characters. */
bool rule_is_text(const char *text, size_t max_bytes);

/* ------------------------------------------------------------------------------------------- judges -- */
/* A judge tells of the first thing that is wrong. */

enum { RULE_MAX_PLUGINS = 4096, RULE_MAX_PARAMS = 1024, RULE_MAX_TEXT = 1000 };

void rule_entry(const rule_sink *to, const sv_entry *entry);
void rule_descriptors(const rule_sink *to, const sv_entry *entry); /* the entry is whole */
void rule_instance(const rule_sink *to, const sv_plugin *plugin);

/* Parameters as they are reported; `info` has the first of `count`. */
typedef struct {
    uint32_t count;
    sv_param_info info[RULE_MAX_PARAMS];
} rule_params;
void rule_param_ids(const rule_sink *to, const rule_params *params, uint32_t told);
void rule_param_strings(const rule_sink *to, const rule_params *params);
void rule_param_ranges(const rule_sink *to, const rule_params *params);
void rule_param_dependencies(const rule_sink *to, const rule_params *params);
void rule_param_flags(const rule_sink *to, const rule_params *params, const sv_descriptor *descriptor);

/* What came out of a frame. Before it every depth was NaN, and every status 0xff. */
typedef struct {
    uint32_t width, height, slices;
    const float *depth;    /* row by row */
    const uint8_t *status; /* the same; NULL: not asked for */
    const sv_stats *stats; /* NULL: not asked for */
    sv_status returned;    /* by end or adjust */
    bool own_queue;
} rule_map;
void rule_depths(const rule_sink *to, const rule_map *map, const char *what);
void rule_outcome(const rule_sink *to, const rule_map *map, const char *what);
void rule_statistics(const rule_sink *to, const rule_map *map);
void rule_confidence(const rule_sink *to, const float *map, uint32_t width, uint32_t height,
                     const char *what);
