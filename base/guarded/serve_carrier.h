/* SPDX-License-Identifier: MIT */
/*
 * Slabs and maps as the plugin in the guard's child gets them: the shared memory itself where that is what it
 * takes or the device can use it in place, else OpenCL objects that are filled from it. Results go back the
 * same way.
 */
#pragma once

#include "guarded/guard_block.h"
#include "opencl/host_cl.h"

/* A zeroed struct is closed. */
typedef struct {
    hs_guard_block *block;
    const uint8_t *slabs; /* read-only */
    size_t slabs_bytes, pixels;
    hs_handover way;
    sv_format format;
    hs_cl cl; /* the host's queue, as the plugin sees it; zeroed with a queue of its own */
    bool in_place;
    cl_mem buffer;  /* SV_CARRIER_BUFFER: all slabs */
    cl_mem *images; /* SV_CARRIER_IMAGE: one a slab, made for the longest */
    cl_mem depth, confidence, scanned;
    bool brings_confidence; /* of this frame: it is read back */
} hs_carrier;

/* Maps the slabs and makes the objects, by the block's format and way. Fills in `format` with what the
 * plugin's activate shall get. HS_ERR_DEVICE, HS_ERR_MEMORY; the carrier is closed then. */
bool hs_carrier_open(hs_carrier *carrier, hs_guard_block *block, sv_format *format, hs_error *err);
/* Waits for the queue. Safe on a zeroed struct; zeroes it. */
void hs_carrier_close(hs_carrier *carrier);

/* Before a frame: fills the objects, and the frame's pointers. HS_ERR_DEVICE. */
bool hs_carrier_begin(hs_carrier *carrier, sv_frame *frame, hs_error *err);

/* Slab `index` of the block as the plugin gets it. */
void hs_carrier_slab(const hs_carrier *carrier, uint32_t index, sv_slab *out);

/* Where results go. HS_ERR_DEVICE. */
bool hs_carrier_result(hs_carrier *carrier, sv_result *result, hs_error *err);

/* Where the confidence goes: memory or an object. */
void hs_carrier_confidence(hs_carrier *carrier, float **map, cl_mem *object);

/* After the plugin's last call: brings the results back and waits for the queue. HS_ERR_DEVICE. */
bool hs_carrier_finish(hs_carrier *carrier, hs_error *err);

/* A map in the shared memory. */
void *hs_carrier_map(const hs_carrier *carrier, hs_guard_map map);
