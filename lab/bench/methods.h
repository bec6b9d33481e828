/* SPDX-License-Identifier: MIT */
/* sv_surfaces_bench: variants of the reconstruction methods, their times, their errors and how both are told.
 */
#ifndef METHODS_H
#define METHODS_H

#include "base/error.h"
#include "bench/bench.h"
#include "loop/source.h"
#include "method_list.h"
#include "plugin/loader.h"
#include "render/host_cl.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---------------------------------------------------------------------------------------------- points -- */
/* Initial points for the reconstruction methods: a shallow volume, and the
 * points that the definition finds. */

enum { METHODS_SLICES = 64 };

/* n x n rays of METHODS_SLICES voxels, slice by slice. All arrays are owned. Interval ends in slices; 0 where
 * there is no interval. */
typedef struct {
    uint32_t n, points;
    size_t bytes; /* of the volume */
    uint8_t *voxels, *status;
    uint16_t *near_end, *far_end;
} methods_map;

/* The benchmark's layered volume: 3 % of the rays are points, in patches. HS_ERR_MEMORY. */
bool methods_map_bones(methods_map *map, uint32_t n, hs_error *err);

/* `count` points, 1 .. n * n / 2, anywhere in the map, between two wavy layers. HS_ERR_MEMORY. */
bool methods_map_scattered(methods_map *map, uint32_t n, uint32_t count, hs_error *err);

void methods_map_free(methods_map *map);

/* The points as text, a line "x y near far" each. HS_ERR_OUTPUT names the path. */
bool methods_map_write(const methods_map *map, const char *path, hs_error *err);

/* -------------------------------------------------------------------------------------------- variants -- */
/* The chains that are compared: a reconstruction method with its settings. */

/* True for a method of the list (method_list.h) that starts from initial points. Those that take the volume
 * are the business of sv_bench and of the judge. */
bool methods_on_points(uint32_t method);

/* Settings that a method does not read are 0 here, and keep their defaults. */
typedef struct {
    const char *label; /* for tables: at most 24 characters */
    uint32_t method;   /* SV_METHOD_* */
    uint32_t k;
    uint32_t merge_grid, spline_grid;
    uint32_t reduction;    /* cells of this many by as many pixels; 0: 1 */
    const char *precision; /* NULL: float64, and exact sums in the mean filter */
    bool quick;            /* part of a --quick run */
} methods_variant;

/* Those whose label is not NULL, until methods_variants_complete has given every method of the list that has
 * no variant the one with its default settings. */
enum { METHODS_VARIANTS = 22 + SV_METHOD_END };
extern methods_variant methods_variants[METHODS_VARIANTS];
void methods_variants_complete(void);

const char *methods_variant_precision(const methods_variant *variant);
uint32_t methods_variant_reduction(const methods_variant *variant);

/* True if a setting trades accuracy for time. */
bool methods_variant_approximates(const methods_variant *variant);

/* A variant as the plugin's parameters: those of activate, and all of them for begin. */
enum { METHODS_MAX_VALUES = 9 };
typedef struct {
    sv_param_value fixed[METHODS_MAX_VALUES], all[METHODS_MAX_VALUES];
    uint32_t fixed_count, count;
} methods_values;

/* HS_ERR_PLUGIN or HS_ERR_USAGE if the plugin lacks one of the parameters. */
bool methods_values_make(const hs_plugin *plugin, const methods_variant *variant, methods_values *values,
                         hs_error *err);

/* ----------------------------------------------------------------------------------------- definitions -- */
/* The float64 definitions of the methods on the benchmark's points, and how far a map is from them. */

typedef struct {
    bool known; /* false: the definition was left out, it would take too long */
    double largest, mean;
} methods_error;

/* Operations, roughly, that the scalar definition of this method takes on this map. */
double methods_reference_cost(const methods_map *map, const methods_variant *variant);

/*
 * The surface that the method means, n * n slices, or NULL with HS_ERR_MEMORY. What is an approximation in
 * the variant (coarse grid, fewer steps, float32) is not one here: splines at every pixel, energies at their
 * minimum. Merging counts as part of the method. Owned by the caller.
 */
double *methods_reference_make(const methods_map *map, const methods_variant *variant, float q,
                               hs_error *err);

/* True if both have the same definition. */
bool methods_reference_same(const methods_variant *a, const methods_variant *b);

/* Of `count` depths from the definition's. A depth that is not finite makes both infinite. */
methods_error methods_error_of(const float *depth, const double *reference, size_t count);

/* ----------------------------------------------------------------------------------------------- times -- */
/* Times one variant's reconstruction in a plugin, in turns with its memory limit and plain C. */

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

/* ---------------------------------------------------------------------------------------------- scenes -- */
/* How far the pictures of a method are from those of a scene's ground truth. */

/* Voxels an axis of the scenes, pixels across their maps and pictures. */
enum { METHODS_SCENES = 3, METHODS_SCENE_SIZE = 128 };
extern const char *const methods_scene_names[METHODS_SCENES];

/* One scene with the depths at which rays through its ground truth end. Zeroed: nothing to free. */
typedef struct {
    hs_source source;
    float *truth;     /* termination depths of the truth, slices; size * size */
    double unclipped; /* difference of the full volume's, slices */
} methods_scene;

/* Makes the scene and its truth. HS_ERR_INPUT, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool methods_scene_open(methods_scene *scene, const hs_cl *cl, const char *name, hs_error *err);
void methods_scene_close(methods_scene *scene);

/*
 * One frame of the host's scan loop with the variant: the mean of |termination depth - that of the
 * truth| over the rays that cross the sac or meet the fetus (labels 1 and 2), slices. Seen from the
 * probe, with as many map and picture pixels as the volume has. A variant that finds no surface
 * clips nothing: *clipped is false.
 */
bool methods_scene_difference(const methods_scene *scene, const hs_cl *cl, const hs_plugin *plugin,
                              const methods_variant *variant, double *slices, bool *clipped, hs_error *err);

/* --------------------------------------------------------------------------------------------- results -- */
/* The results of sv_surfaces_bench. */

enum { METHODS_SPLINES = 6, METHODS_ROWS = BENCH_SIZES * METHODS_VARIANTS };
extern const uint32_t methods_spline_points[METHODS_SPLINES]; /* of the fit in the number of points */

/* One variant at one size. */
typedef struct {
    const methods_variant *variant;
    uint32_t n, points; /* pixels across; initial points */
    methods_times times;
    methods_error error; /* against float64 */
} methods_row;

/* One variant's pictures, means of slices. */
typedef struct {
    bool known;
    double slices[METHODS_SCENES];
    bool clipped[METHODS_SCENES];
} methods_truth_row;

typedef struct {
    bench_machine machine;
    methods_row rows[METHODS_ROWS];
    uint32_t row_count;
    methods_row splines[METHODS_SPLINES]; /* unmerged, every pixel, at the smallest size */
    uint32_t spline_count;
    methods_truth_row truth[METHODS_VARIANTS];
    double unclipped[METHODS_SCENES];
} methods_report;

/* A row's time, ms: the reconstruct stage, or `end` if the plugin has no stage times. */
double methods_row_ms(const methods_row *row);

/* The truth of a row's variant, or NULL. */
const methods_truth_row *methods_row_truth(const methods_report *report, const methods_row *row);

/* Mean over the scenes. */
double methods_truth_mean(const methods_truth_row *truth);

/* ------------------------------------------------------------------------------------------------ fits -- */
/* Exponents of how cost grows, and the Pareto front. */

typedef struct {
    double exponent; /* b of the least-squares line log y = a + b log x */
    double factor;   /* largest ratio of a value to the line, or of the line to a value: 1 is a perfect fit */
    uint32_t count;  /* of values; with fewer than two nothing is fitted */
} methods_fit;

/* best[i]: no other point is at least as good in both, and better in one (smaller is better). */
void methods_pareto(const double *x, const double *y, uint32_t count, bool *best);

/* ------------------------------------------------------------------------------------------------- CSV -- */
/* The results as CSV: a line a row; what is not known is empty. */

/* HS_ERR_OUTPUT names the path. */
bool methods_write_csv(const methods_report *report, const char *path, hs_error *err);

/* ---------------------------------------------------------------------------------------------- tables -- */
/* The results as tables on standard output. */

/* The head before the first row of its kind, then a line each as they come in. */
void methods_print_head(const char *what);
void methods_print_row(const methods_row *row);
void methods_print_truth(const methods_report *report);
void methods_print_fits(const methods_report *report);

/* ------------------------------------------------------------------------------------------------ plot -- */
/*
 * The results as a plot: time to the right on a logarithmic axis, error upwards on another, a marker a row.
 * Left the largest error against the float64 definition, right the distance from the scenes' ground truth.
 */

/* HS_ERR_OUTPUT names the path. */
bool methods_write_svg(const methods_report *report, const char *path, hs_error *err);

#endif
