/* SPDX-License-Identifier: MIT */
/*
 * The door of the definitions' shared library, libsmartvis_definitions.so: plain arrays and numbers, for
 * callers in other languages. C callers use the headers of the definitions themselves.
 */
#pragma once

#include <stdbool.h>
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
