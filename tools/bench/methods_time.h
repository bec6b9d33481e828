/* SPDX-License-Identifier: MIT */
/* Times one variant's reconstruction in a plugin, in turns with its memory limit and plain C. */
#ifndef METHODS_TIME_H
#define METHODS_TIME_H

#include "bench/bench.h"
#include "bench/methods_map.h"
#include "bench/methods_variant.h"

typedef struct {
    const hs_plugin *plugin;
    bench_team *team;
    float q;
    uint32_t frames; /* timed at most */
    double seconds;  /* a variant that has taken longer ends early, after 3 frames at least */
} methods_setup;

/* Milliseconds. All zero where it does not apply. */
typedef struct {
    bench_times end;         /* wall clock of the plugin's `end`, all events off */
    bench_times reconstruct; /* its stage by smartvis.timing/1, in the frames between; zero without it */
    bench_times memory;      /* two float32 maps read, one written, two threads; its minimum is the limit */
    bench_times plain;       /* mean filter: the same in plain C, two threads */
    uint32_t frames, passes;
    uint32_t control_points; /* splines: after merging, by smartvis.spline/1 */
} methods_times;

/* Activates, times, deactivates. `depth` gets n * n slices. HS_ERR_FAILED if the plugin finds other points
 * than the definition, or no surface: then nothing is timed. HS_ERR_PLUGIN, HS_ERR_MEMORY. */
bool methods_time(const methods_setup *setup, const methods_map *map, const methods_variant *variant,
                  float *depth, methods_times *times, hs_error *err);

#endif
