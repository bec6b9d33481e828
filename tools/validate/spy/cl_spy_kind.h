/* SPDX-License-Identifier: MIT */
/* The kinds of OpenCL calls that the spy tells apart. */
#ifndef CL_SPY_KIND_H
#define CL_SPY_KIND_H

typedef enum {
    SPY_QUERY,   /* clGet...Info, clSetKernelArg, clFlush: nothing is made, nothing waits */
    SPY_ENQUEUE, /* clEnqueue... */
    SPY_CREATE,  /* clCreate... */
    SPY_RETAIN,  /* clRetain... */
    SPY_RELEASE, /* clRelease... */
    SPY_BUILD,   /* clBuildProgram, clCompileProgram, clLinkProgram */
    SPY_WAIT,    /* clFinish, clWaitForEvents */
    SPY_KINDS
} spy_kind;

#endif
