/* SPDX-License-Identifier: MIT */
/*
 * The sparse maps that methods of reconstruction work on. All definitions take the status map (!= 0: initial
 * point), a depth per pixel (read at initial points only) and give a surface. None needs OpenCL, none is
 * fast; without an initial point the surface is 0. They return false if memory runs out.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    const uint8_t *status;
    const double *depth;
    uint32_t width, height;
} sv_ref_map;

/* What passes over a map came to. */
typedef struct {
    uint32_t passes;   /* iterations done */
    uint32_t unfilled; /* pixels still without a value; they are 0 in the result */
} sv_ref_fill;
