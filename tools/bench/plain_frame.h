/* SPDX-License-Identifier: MIT */
/* The whole frame in plain C, one of the yardsticks (plain_volume.h). */
#ifndef PLAIN_FRAME_H
#define PLAIN_FRAME_H

#include "bench/bench_team.h"
#include "bench/plain_volume.h"

typedef struct {
    uint8_t fluid_level; /* T_L as a grey level: tissue lies above it */
    uint8_t bone_drop;   /* a ray is bone if its maximum is above (maximum of the volume) - bone_drop */
    uint32_t k;          /* window of the mean filter, odd */
    float q;
} plain_settings;

/* The plugin's work: ray profiles, offset threshold, initial points, mean filter of both ends to
 * completion with weights 2 : 1, S(q). All voxels count as scanned. */
typedef struct plain_frame plain_frame;

/* `team` must outlive it. NULL with HS_ERR_MEMORY, or HS_ERR_USAGE if a window's sums do not fit 32 bits with
 * 10 fraction bits. */
plain_frame *plain_frame_create(bench_team *team, uint32_t width, uint32_t height, uint32_t slices,
                                const plain_settings *settings, hs_error *err);
void plain_frame_destroy(plain_frame *frame);

/* One frame, between bench_team_ready and _rest. depth: width * height slices; status: width * height bytes,
 * SV_POINT_*. Returns the passes of the mean filter, 0 if there is no initial point. */
uint32_t plain_frame_run(plain_frame *frame, const plain_volume *volume, float *depth, uint8_t *status);

#endif
