/* SPDX-License-Identifier: MIT */
/* What a check is, and all checks. */
#ifndef V_CHECK_H
#define V_CHECK_H

#include "validate/drive/drive.h"

#include <stddef.h>

typedef struct {
    const char *id;    /* kebab-case, stable */
    const char *needs; /* skipped unless this check passed; NULL: none */
    const char *what;  /* one sentence: what holds */
    const char *mend;  /* one sentence: what to do if it does not */
    void (*run)(v_run *run);
} v_check;

extern const v_check v_checks[];
extern const size_t v_check_count;

/* The check with this id, or NULL. */
const v_check *v_check_find(const char *id);

void check_library_loads(v_run *run);
void check_library_reloads(v_run *run);
void check_library_symbols(v_run *run);
void check_library_scan_time(v_run *run);
void check_entry_whole(v_run *run);
void check_descriptors(v_run *run);
void check_descriptor_constant(v_run *run);

void check_instance_whole(v_run *run);
void check_create_refusals(v_run *run);
void check_create_without_opencl(v_run *run);
void check_extensions(v_run *run);
void check_bare_host(v_run *run);
void check_host_callbacks(v_run *run);
void check_process_untouched(v_run *run);

void check_first_frame(v_run *run);
void check_depth_values(v_run *run);
void check_frame_outcome(v_run *run);
void check_frame_statistics(v_run *run);
void check_guard_bands(v_run *run);
void check_frame_shapes(v_run *run);
void check_frame_contents(v_run *run);
void check_confidence(v_run *run);

void check_param_ids(v_run *run);
void check_param_strings(v_run *run);
void check_param_ranges(v_run *run);
void check_param_dependencies(v_run *run);
void check_param_flags(v_run *run);
void check_param_info_calls(v_run *run);

void check_param_text(v_run *run);
void check_param_round_trip(v_run *run);
void check_param_enum_names(v_run *run);

void check_param_in_range(v_run *run);
void check_param_out_of_range(v_run *run);
void check_param_fixed(v_run *run);
void check_param_repeated(v_run *run);
void check_adjust_equals_frame(v_run *run);
void check_param_fuzz(v_run *run);

void check_param_pairs(v_run *run);

void check_every_setting(v_run *run);

void check_call_states(v_run *run);
void check_state_walk(v_run *run);

void check_same_frame_same_bits(v_run *run);
void check_frames_independent(v_run *run);
void check_slab_splits(v_run *run);
void check_instances_interleaved(v_run *run);
void check_instances_parallel(v_run *run);
void check_any_calls(v_run *run);

void check_inputs_unchanged(v_run *run);
void check_reads_within_slab(v_run *run);
void check_padding_ignored(v_run *run);
void check_scanned_ranges(v_run *run);
void check_padding_value(v_run *run);
void check_carriers(v_run *run);
void check_foreign_objects(v_run *run);

void check_slab_refusals(v_run *run);
void check_format_refusals(v_run *run);
void check_null_arguments(v_run *run);
void check_struct_sizes(v_run *run);
void check_reasons(v_run *run);

void check_frame_path_opencl(v_run *run);
void check_frame_path_heap(v_run *run);
void check_first_launches(v_run *run);
void check_opencl_balance(v_run *run);
void check_opencl_faults(v_run *run);
void check_heap_faults(v_run *run);
void check_activations(v_run *run);

#endif
