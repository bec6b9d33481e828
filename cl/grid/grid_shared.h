/* SPDX-License-Identifier: MIT */
/* Membrane and plate: what their kernels and the C side both need to know. */
#ifndef SV_GRID_SHARED_H
#define SV_GRID_SHARED_H

/* Steps of the membrane's and the plate's solver. */
#define SV_MAX_SOLVER_STEPS 96

/* Weight of a point in the membrane and the plate, against 1 for the smoothness. */
#define SV_MIN_DATA_WEIGHT 1e-3
#define SV_MAX_DATA_WEIGHT 10.0

/* A level of the pyramid; by value, 32-bit members only. `offset` counts pixels from the start of level 0. */
typedef struct {
    unsigned int width, height, offset;
    unsigned int pixels; /* of all levels */
    float tension, bending;
} sv_grid_level;

#endif
