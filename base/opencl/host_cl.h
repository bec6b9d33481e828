/* SPDX-License-Identifier: MIT */
/* A host's OpenCL device, context and in-order queue, shared by all that it does and by the plugin. */
#pragma once

#include "core/error.h"

#include <CL/cl.h>
#include <stdint.h>

typedef struct {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue; /* in-order, with profiling */
    cl_program program;     /* the machine's kernels (render/host_kernels.h), or NULL */
    uint32_t lanes;         /* rays or voxels a work item of those kernels handles: 16 on CPUs, else 1 */
    char device_name[256];
    bool is_cpu; /* the device is a CPU: it shares the host's memory */
    bool quick;  /* the program was compiled without optimisation (smartvis/author_programs.h) */
} hs_cl;

/* Opens the device that smartvis/device.h finds. False with HS_ERR_DEVICE and what to do about it; `cl` is
 * all zero then. */
bool hs_cl_open_bare(hs_cl *cl, hs_error *err);

/* Waits for the queue and releases everything. Safe on a zeroed struct. */
void hs_cl_close(hs_cl *cl);

/* True on CL_SUCCESS; else records HS_ERR_DEVICE with the call's name, the code's name and its number. */
bool hs_cl_check(cl_int code, const char *call, hs_error *err);

/* True if the device has 2D images of one channel of 8 bits (CL_R, CL_UNORM_INT8); else HS_ERR_DEVICE. It may
 * have images and none of these (PoCL 7.1). */
bool hs_cl_check_images(const hs_cl *cl, hs_error *err);
