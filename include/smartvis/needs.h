/* SPDX-License-Identifier: MIT */
/*
 * Extension smartvis.needs/1: what an activation and a frame will take, before there is a device. Tags and
 * rules are those of smartvis_plugin.h.
 */
#ifndef SMARTVIS_NEEDS_H
#define SMARTVIS_NEEDS_H

#include "smartvis_plugin.h"

SMARTVIS_BEGIN_C

#define SV_EXT_NEEDS "smartvis.needs/1"

/* What matters of a device, flags of sv_needs_device. */
enum {
    SV_NEEDS_CPU = 1u << 0,     /* CL_DEVICE_TYPE_CPU */
    SV_NEEDS_UNIFIED = 1u << 1, /* CL_DEVICE_HOST_UNIFIED_MEMORY */
    SV_NEEDS_DOUBLES = 1u << 2  /* cl_khr_fp64 */
};

/* The device to be. */
typedef struct sv_needs_device {
    uint32_t size;
    uint32_t flags;         /* SV_NEEDS_* */
    uint32_t compute_units; /* CL_DEVICE_MAX_COMPUTE_UNITS, >= 1 */
    uint32_t reserved;      /* 0 */
} sv_needs_device;

typedef struct sv_needs {
    uint32_t size;
    uint32_t commands;        /* what begin, all slabs and end enqueue together, at most */
    uint32_t adjust_commands; /* what adjust enqueues, at most; 0: there is nothing to adjust */
    uint32_t reserved;        /* 0 */
    uint64_t device_bytes;    /* buffers from activate to deactivate, all together */
    uint64_t largest_buffer;  /* bytes of the largest of them */
    uint64_t host_bytes;      /* heap memory from activate to deactivate, without the OpenCL runtime's */
} sv_needs;

typedef struct sv_ext_needs {
    uint32_t size;
    uint32_t reserved; /* 0 */

    /* [control] What activate(format) will take on `device`, and a frame with `values`, those of begin. In
     * any state; the instance stays as it is, and OpenCL is not called. context, device and queue of the
     * format may be NULL whatever its carrier; of host_memory counts only whether it is NULL.
     *
     * Counted is a frame in slabs of max_slab_slices, each in an object of its own, with ranges in host
     * memory if the format has SV_FORMAT_SCANNED, and with depths, status map and statistics in host memory.
     * Slabs of one buffer may share commands, and ranges and depths in objects need fewer.
     *
     * Bytes are those between activate and deactivate. While activate runs, a self-test may take some of its
     * own before the rest is there. Threads are not counted: with a CPU as the device, kernels are compiled
     * and run on those of the host and of the runtime, with 512 KiB of stack each. Fills *out as far as
     * out->size goes. Errors are those that activate and begin have for the same, but for memory that a
     * device does not have; SV_ERR_SIZE for `device` or `out`, SV_ERR_ARGUMENT for NULL, unknown flags and no
     * compute units. */
    sv_status(SV_CALL *of)(const sv_plugin *plugin, const sv_format *format, const sv_param_value *values,
                           uint32_t value_count, const sv_needs_device *device, sv_needs *out);
} sv_ext_needs;

SMARTVIS_END_C

#endif
