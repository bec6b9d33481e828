/* SPDX-License-Identifier: MIT */
/* A low-resolution volume as slabs, in the carrier in which the plugin gets them. */
#pragma once

#include "plugin/capabilities.h"
#include "render/scan_convert.h"
#include "smartvis_plugin.h"

/* All slabs of a volume, each in memory of its own: the ABI wants a slab unchanged until the frame's commands
 * have run. All functions are called from one thread. */
typedef struct hs_slabs hs_slabs;

/* Bytes of memory that all slabs of a layout lie in. */
size_t hs_slabs_bytes(const hs_slab_layout *layout);

/* Makes the scan converter and the memory of all slabs for `carrier` (SV_CARRIER_*). `fan`: how the plugin is
 * told what was scanned. `gaps`: a ray may leave what was scanned and come back, so beside its range the
 * padding value tells what lies between. `memory`: where the slabs of SV_CARRIER_HOST shall lie
 * (hs_slabs_bytes, aligned to a page; borrowed), or NULL; a device that shares the host's memory then writes
 * them there without a copy. `cl` must outlive it. NULL with HS_ERR_USAGE (a layout or a size that the device
 * does not take), HS_ERR_DEVICE or HS_ERR_MEMORY. */
hs_slabs *hs_slabs_create(const hs_cl *cl, const hs_slab_layout *layout, uint32_t carrier, hs_fan fan,
                          bool gaps, void *memory, hs_error *err);
void hs_slabs_destroy(hs_slabs *slabs);

/* Makes what conversion needs of the volume, and its memory, ahead of time (hs_scan_convert_prepare). */
bool hs_slabs_prepare(hs_slabs *slabs, const hs_device_volume *source, const hs_camera *camera,
                      hs_error *err);

/* Enqueues the conversion of every slab and its way into the carrier, and with HS_FAN_RANGES the search for
 * every ray's scanned range; does not wait. HS_ERR_DEVICE. */
bool hs_slabs_convert(hs_slabs *slabs, const hs_device_volume *source, const hs_camera *camera,
                      hs_error *err);

/* Returns how the slabs lie in the volume; they own it. */
const hs_slab_layout *hs_slabs_layout(const hs_slabs *slabs);
uint32_t hs_slabs_count(const hs_slabs *slabs);

/* Slab `index` (0 .. count - 1) as the plugin gets it. Its memory or object is owned by the slabs. */
void hs_slabs_describe(const hs_slabs *slabs, uint32_t index, sv_slab *out);

/* Fills in the fields of a format that tell how slabs come: size, layout, carrier, for SV_CARRIER_HOST the
 * memory they lie in, and how it is told what was scanned. */
void hs_slabs_describe_format(const hs_slabs *slabs, sv_format *format);

/* Fills in a frame's scanned ranges, if there are any: in host memory for a plugin that cannot reach the
 * host's context (valid when the queue has run), else in a buffer. Owned by the slabs. */
void hs_slabs_describe_frame(const hs_slabs *slabs, bool own_queue, sv_frame *frame);
