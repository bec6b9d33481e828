/* SPDX-License-Identifier: MIT */
/* How the time of a plugin's frame grows with voxels: exponents, and whether there is a step at some size. */
#include "bench/bench_results.h"

#include <math.h>
#include <stdio.h>

enum { MAX_SIZES = 7, GROWTH_SLAB = 32 };

/* A frame's least processor time at a size: other programs on the machine change it least. */
typedef struct {
    const char *what;
    uint32_t count, side[MAX_SIZES]; /* voxels an axis */
    double ms[MAX_SIZES], wall[MAX_SIZES];
} series;

/* The slope of log ms over log count, by least squares over the sizes from `first` on. */
static double exponent(const series *s, uint32_t first) {
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (uint32_t i = first; i < s->count; i++) {
        const double x = 3.0 * log((double)s->side[i]), y = log(s->ms[i]);
        n += 1.0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* Each size's exponent from the one before it. */
static void print_series(const series *s) {
    printf("\n%s: least milliseconds of processor time (and by the wall clock)\n", s->what);
    for (uint32_t i = 0; i < s->count; i++) {
        const double local =
            i ? log(s->ms[i] / s->ms[i - 1]) / (3.0 * log((double)s->side[i] / s->side[i - 1])) : 0.0;
        printf("%5u^%d %10.3f (%9.3f) %8.3f ns each", s->side[i], 3, s->ms[i], s->wall[i],
               1e6 * s->ms[i] / pow(s->side[i], 3));
        if (i) printf("   exponent %.2f", local);
        printf("\n");
    }
    printf("exponent over all: %.2f; of the larger half: %.2f\n", exponent(s, 0), exponent(s, s->count / 2));
}

/* ---------------------------------------------------------------------------------------------- voxels -- */

static bool time_size(const bench_plugin_setup *setup, const char *method, uint32_t n, double *ms,
                      double *wall, hs_error *err) {
    const bench_plugin_setup own = {.plugin = setup->plugin,
                                    .cl = setup->cl,
                                    .team = setup->team,
                                    .frames = setup->frames,
                                    .values = setup->values,
                                    .value_count = setup->value_count,
                                    .method = method};
    const bench_variant variant = {n, 23, GROWTH_SLAB, BENCH_PLACE_OWN};
    bench_plugin_result result;
    bench_slabs slabs;
    if (!bench_slabs_create(&slabs, n, GROWTH_SLAB, err)) return false;
    const bool ok = bench_plugin_run(&own, &slabs, &variant, NULL, &result, err);
    *ms = result.processor.min;
    *wall = result.times[BENCH_FRAME].min;
    bench_slabs_destroy(&slabs);
    return ok;
}

/* Powers of two and between them; and neighbours, which tell what odd sides and started vectors cost. */
static const uint32_t sides[2][MAX_SIZES] = {{64, 96, 128, 192, 256, 384, 512},
                                             {120, 127, 128, 129, 133, 144, 160}};

static bool run_voxels(const bench_plugin_setup *setup, const char *method, int which, hs_error *err) {
    char what[64];
    series s = {.what = what, .count = MAX_SIZES};
    (void)snprintf(what, sizeof what, "a frame of %s, by voxels", method);
    for (uint32_t i = 0; i < s.count; i++) {
        s.side[i] = sides[which][i];
        if (!time_size(setup, method, s.side[i], &s.ms[i], &s.wall[i], err)) return false;
    }
    print_series(&s);
    return true;
}

bool bench_growth_run(const bench_plugin_setup *setup, hs_error *err) {
    static const char *const methods[] = {"mean", "wall"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        for (int which = 0; which < 2 && bench_plugin_has_method(setup->plugin, methods[i]); which++)
            if (!run_voxels(setup, methods[i], which, err)) return false;
    return true;
}
