/* SPDX-License-Identifier: MIT */
/*
 * Builds each OpenCL program of a test once. PoCL runs the preprocessor over a source at every
 * clBuildProgram, also if its cache on disk has the result, and tests activate a plugin thousands of times.
 *
 * A shared library that stands before the OpenCL loader (and behind spy/cl_spy.c, which still sees all
 * calls): a program of the same context, source and options as one that was built before is not built again;
 * its kernels are made from that one. Kernels, arguments, buffers and launches are each instance's own as
 * ever. Builds that fail are not kept. One context at a time.
 *
 * A program that is not linked with it can be started with it in LD_PRELOAD, and SV_SHARE_PROGRAMS set: then
 * the first context that builds a program is shared as long as the process lives.
 */
#pragma once

#include <CL/cl.h>

/* From now on programs of this context are shared; ignored while those of another one are. */
void shared_programs_begin(cl_context context);

/* Releases what was kept. To be called before the context's last release; other contexts are ignored. */
void shared_programs_end(cl_context context);

/* From now on every program is compiled with these options, too, and such programs are not shared; NULL: no
 * longer. The text must stay. For kernels that do not build, or compute wrongly. */
void shared_programs_options(const char *options);
