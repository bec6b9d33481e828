/* SPDX-License-Identifier: MIT */
/*
 * For plugins with OpenCL kernels, on top of smartvis/author.h: device, program, objects, slabs and results.
 * Include <CL/cl.h> (1.2 or later) before this header. In a method with kernels
 *
 *   sva.own      is an sva_cl, or begins with one
 *   activate     calls sva_cl_open, and last sva_cl_rehearse
 *   deactivate   is sva_cl_close, or calls it
 *   begin        is sva_cl_begin, or calls it
 *   slab         calls sva_cl_slab, which launches a kernel on the slab
 *   finish       calls sva_cl_launch for what fills sva_cl.depth and sva_cl.points, on every ray
 *   output       is sva_cl_output
 *
 * Carriers: SV_CARRIER_HOST and SV_CARRIER_BUFFER. Queues: the host's, where nothing blocks, and an own one.
 * Kernels run over WIDTH x HEIGHT work items. Their source has sva_cl_prelude before it.
 *
 *   author_device.h       the functions: the part to read
 *   author_rehearsal.h    sva_cl_rehearse
 */
#ifndef SMARTVIS_AUTHOR_CL_H
#define SMARTVIS_AUTHOR_CL_H

#include "smartvis/author_device.h"
#include "smartvis/author_rehearsal.h"

#endif
