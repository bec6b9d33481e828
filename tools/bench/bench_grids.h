/* SPDX-License-Identifier: MIT */
/* Times the renderer of a probe's volume in turns in both grids that it could sample: the Cartesian copy, as
 * the host does, and the probe's own (tools/bench/cl/probe_grid.cl). */
#ifndef BENCH_GRIDS_H
#define BENCH_GRIDS_H

#include "bench/bench_picture.h"
#include "bench/bench_times.h"

/* One camera, clipped at a plane or not. Milliseconds of a picture of 512 x 512 in the thesis' look. */
typedef struct {
    const char *label;
    bench_times copy, probe;             /* both leap over the empty bricks of the copy */
    bench_times copy_walks, probe_walks; /* neither leaps */
    double difference;                   /* of the two pictures: mean of the colours' differences, of 255 */
} bench_grid_view;

typedef struct {
    char volume[256];
    uint32_t samples, lines, planes, voxels[3];
    bench_grid_view view[BENCH_VIEWS];
    bench_times making; /* the copy, from the samples */
} bench_grids_result;

/* Samples `scene` (a built-in one or a file, of `size` voxels an axis) by a probe of 400 samples, lines and
 * planes. HS_ERR_* of whatever fails; HS_ERR_FAILED if the two grids do not give one picture. */
bool bench_grids_run(const hs_cl *cl, const char *scene, uint32_t size, uint32_t frames,
                     bench_grids_result *out, hs_error *err);

/* The table, with ratios of medians and of minima, and after how many pictures the copy has paid. */
void bench_print_grids(const bench_grids_result *result);

#endif
