/* SPDX-License-Identifier: MIT */
/* Scan conversion: source volume and camera -> low-resolution camera-aligned slabs (spec 5). */
#pragma once

#include "render/camera.h"
#include "render/device_volume.h"

/* How a slab lies in its texture; the same words as sv_format. */
typedef struct {
    uint32_t width, height, slices; /* of the whole low-resolution volume */
    uint32_t slab_slices;           /* slices of a full slab; the last may be short */
    uint32_t tiles_x, tile_w, tile_h, row_pitch;
} hs_slab_layout;

/* These three are for layouts that hs_scan_converter_create accepts. Texture bytes of a slab of `slices`
 * slices. */
size_t hs_slab_bytes(const hs_slab_layout *layout, uint32_t slices);
/* Number of slabs, and slices of slab `index`. */
uint32_t hs_slab_count(const hs_slab_layout *layout);
uint32_t hs_slab_length(const hs_slab_layout *layout, uint32_t index);

typedef struct hs_scan_converter hs_scan_converter;

/* NULL with HS_ERR_USAGE (an impossible layout), HS_ERR_DEVICE or HS_ERR_MEMORY. */
hs_scan_converter *hs_scan_converter_create(const hs_cl *cl, const hs_slab_layout *layout, hs_error *err);
void hs_scan_converter_destroy(hs_scan_converter *converter);

/*
 * Enqueues the conversion of slab `index` into `slab`, a buffer of at least hs_slab_bytes(its slices) bytes
 * from `offset` on; does not wait. Tile and pitch padding is not written. `event` (may be NULL) receives the
 * command's event.
 *
 * A low-resolution voxel is the mean of the source over its own box, by samples on a regular grid in it.
 * Sample i of g along an edge of the box stands at (i + 0.5) / g of it. Spans are edges in source voxels.
 *
 * Halved: where every edge spans 2.7 voxels or more (by the coarsest spacing, with a millionth of tolerance),
 * the source is halved once per volume (hs_halved_view.marked), and a sample is trilinear between halved
 * voxels; in the outer half voxel the nearest one counts. g is the edge in halved voxels of the finest
 * spacing over 1.5, rounded, 1 .. 6. All is integer arithmetic: the same bytes on every device. Positions are
 * fixed-point with as many fraction bits as 32-bit sums allow (20 to 22 for 400^3 voxels); a fraction is
 * rounded to 1/256. Intensities are blended within two slices, then between them, both rounded half up to
 * 1/256. This holds for voxels all of whose samples lie in the volume and between eight halved voxels of
 * which all was scanned. A voxel none of whose samples lies in the volume and beside a halved voxel of which
 * some was scanned is 0. All others are means of nearest source voxels, as below, of 2 g samples an edge: so
 * the edge of what was scanned is not blurred.
 *
 * Nearest: where every edge spans 1.5 voxels or more a sample is the nearest source voxel, in integers, too.
 * g is the edge in finest source voxels over 1.5, rounded, 8 at most, 2 at least.
 *
 * Trilinear: elsewhere, and where a box is so long that fewer than 12 fraction bits are left, a sample is
 * trilinear between the source voxels; in the outer half voxel the nearest one counts. g is the same, but 1
 * at least, and 2 at least where the edge is 1.5 voxels or longer. "Half covered", below, then has a
 * tolerance of a thousandth.
 *
 * A source in probe geometry (hs_volume.beams) is sampled where it was scanned, in one step: a sample is
 * linear between the eight echoes around it in radius, line and plane (hs_beams), and its Cartesian copy only
 * says how many samples there are (as for Trilinear). Echoes of 0 count: what was scanned is known. A voxel
 * is scanned if half its samples or more are.
 *
 * Only scanned source voxels (> 0) inside the volume have weight; a voxel less than half covered by them
 * becomes 0 (not scanned), any other their mean, rounded half up, 1 .. 255.
 */
bool hs_scan_convert_slab(hs_scan_converter *converter, const hs_device_volume *source,
                          const hs_camera *camera, uint32_t index, cl_mem slab, size_t offset,
                          cl_event *event, hs_error *err);

/* Makes what conversion needs of the volume beside its voxels, and its memory, ahead of time; does not wait.
 * Otherwise the first slab of a volume does. HS_ERR_DEVICE. */
bool hs_scan_convert_prepare(const hs_scan_converter *converter, const hs_device_volume *source,
                             const hs_camera *camera, hs_error *err);

/* The ranges of one frame on the device. Zeroed: nothing to free. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    cl_mem ranges; /* width * height pairs of 16 bits, first and end, row by row: sv_scanned */
} hs_scanned_rays;

/* Makes the buffer for slabs of this layout. HS_ERR_DEVICE. */
bool hs_scanned_rays_create(hs_scanned_rays *rays, const hs_cl *cl, const hs_slab_layout *layout,
                            hs_error *err);
void hs_scanned_rays_destroy(hs_scanned_rays *rays);

/* Enqueues the search in the slabs that `source` was converted to for `camera`, which say where nothing can
 * have been scanned: slab i begins i * stride bytes from the start of `slabs`. Does not wait. HS_ERR_DEVICE.
 */
bool hs_scanned_rays_find(const hs_scanned_rays *rays, const hs_slab_layout *layout,
                          const hs_device_volume *source, const hs_camera *camera, cl_mem slabs,
                          size_t stride, hs_error *err);
