/* SPDX-License-Identifier: MIT */
/*
 * The door of the definitions' shared library, libsmartvis_definitions.so: plain arrays and numbers, for
 * callers in other languages. C callers use the headers of the definitions themselves.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SV_DEFINITION __attribute__((visibility("default")))

/*
 * The surface that a method which starts from points means, in float64, at every pixel: width * height slices
 * into `surface`. `method`: a value of the parameter of that name. `status` (not 0: an initial point) and
 * `depth` (slices, read there only): width * height each. `kernel`, `merge_grid`: the parameters of these
 * names; all others are the plugin's defaults, a spline is taken at every pixel. False: there is no such
 * method, it takes the volume, or memory ran out.
 */
SV_DEFINITION bool sv_define_surface(const char *method, const uint8_t *status, const double *depth,
                                     uint32_t width, uint32_t height, uint32_t kernel, uint32_t merge_grid,
                                     double *surface);

/* Constant `index` of the definition of wall (wall_layout.h, sv_wall_settings), with its value in *value; the
 * last two, clip_doubtful and median, are 0 or 1. NULL: there are not so many. */
SV_DEFINITION const char *sv_define_wall_constant(uint32_t index, double *value);

/*
 * The surface of method wall in a volume of size[0] x size[1] x size[2] voxels, x fastest; of every ray the
 * slices first .. end - 1 were scanned. `beams`: SV_BEAMS_*; `told`: what a frame tells of them,
 * probe_rotation, beam_apex_mm and beam_sweep_mm, zeros if nobody knows. `constants`: a value for every one
 * of sv_define_wall_constant. `depth` and `confidence` get a number a ray (ref_wall.h); `facts`: outcome,
 * threshold, rays, wall_rays, gap_share, wall, spread, fetus of sv_wall_facts. False: `text` says what does
 * not hold, or that memory ran out.
 */
SV_DEFINITION bool sv_define_wall(uint32_t beams, const uint8_t *voxels, const uint16_t *first,
                                  const uint16_t *end, const uint32_t size[3], const double spacing_mm[3],
                                  const float told[13], const double *constants, float *depth,
                                  float *confidence, double facts[8], char *text, size_t bytes);
