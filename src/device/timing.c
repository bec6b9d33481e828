/* SPDX-License-Identifier: MIT */
#include "device/timing.h"

#include <stdlib.h>
#include <time.h>

double sv_seconds(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

size_t sv_timing_bytes(uint32_t capacity) {
    return capacity * sizeof *((sv_timing *)NULL)->commands;
}

sv_status sv_timing_create(sv_timing *timing, sv_diag *diag, uint32_t capacity) {
    *timing = (sv_timing){.capacity = capacity, .commands = calloc(capacity, sizeof *timing->commands)};
    return timing->commands ? SV_OK
                            : sva_error(diag, SV_ERR_NO_MEMORY, "no memory for %u timing events", capacity);
}

void sv_timing_reset(sv_timing *timing) {
    for (uint32_t i = 0; i < timing->count; i++)
        if (timing->commands[i].event) (void)clReleaseEvent(timing->commands[i].event);
    timing->count = 0;
    timing->complete = false;
}

void sv_timing_destroy(sv_timing *timing) {
    sv_timing_reset(timing);
    free(timing->commands);
    *timing = (sv_timing){0};
}

cl_event *sv_timing_slot(sv_timing *timing, sv_stage stage) {
    if (!timing || !timing->enabled || timing->count == timing->capacity) return NULL;
    timing->commands[timing->count].stage = stage;
    timing->commands[timing->count].event = NULL;
    return &timing->commands[timing->count++].event;
}

sv_status sv_timing_read(const sv_timing *timing, sv_diag *diag, sv_stage_times *out) {
    if (!timing->complete || timing->count == 0)
        return sva_blame(diag, SV_ERR_STATE, "stage_times: no timed frame; enable timing before begin");
    double ms[SV_STAGE_COUNT] = {0};
    for (uint32_t i = 0; i < timing->count; i++) {
        cl_ulong start = 0, end = 0;
        const cl_event event = timing->commands[i].event;
        cl_int code = clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL);
        if (code == CL_SUCCESS)
            code = clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL);
        if (code != CL_SUCCESS) return sva_cl_check(diag, code, "stage_times: clGetEventProfilingInfo");
        ms[timing->commands[i].stage] += (double)(end - start) * 1e-6;
    }
    out->transfer_ms = ms[SV_STAGE_TRANSFER];
    out->profile_ms = ms[SV_STAGE_PROFILE];
    out->threshold_ms = ms[SV_STAGE_THRESHOLD];
    out->reconstruct_ms = ms[SV_STAGE_RECONSTRUCT];
    out->output_ms = ms[SV_STAGE_OUTPUT];
    return SV_OK;
}
