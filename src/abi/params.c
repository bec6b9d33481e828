/* SPDX-License-Identifier: MIT */
#include "abi/abi.h"

#include "common/sv_shared.h"
#include "method/method.h"
#include "spline/spline_shared.h"

static const char *const bone_modes[] = {"absolute", "offset", "fraction"};
#define SV_METHOD_KEY(NAME, value, key) [value] = #key,
static const char *const methods[SV_METHOD_END] = {SV_METHODS(SV_METHOD_KEY)};
#undef SV_METHOD_KEY
static const char *const unsure[] = {"keep", "clip"};
static const char *const prefilters[] = {"none", "minimum"};
static const char *const precisions[] = {"float64", "float32"};
static const char *const strategies[] = {"auto", "single", "bands", "rays"};

#define GROUP_SURFACE   "Surface"
#define GROUP_POINTS    "Initial points"
#define GROUP_PREFILTER "Pre-filter"
#define GROUP_METHOD    "Method"
#define GROUP_WORK      "Computation"

/* For parameters that depend on `method`: the methods' tables say for which of them they matter. */
#define BY_METHOD 0

/* The parameters in order of importance, in which a host shows them. An enum's name is NULL where a value is
 * retired. */
const sva_param sv_params[] = {
    {SV_PARAM_Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY | SV_PARAM_ADJUST, "q", "Surface position", "",
     "0.5 is the best guess. Stay between 0 and 1. 0 is at the fetus, 1 at the tissue in front of it; above "
     "1 less is removed.",
     0.0, 1.5, 0.5, 0.05, 0.0, 0.0, GROUP_SURFACE, NULL, 0, 0},
    {SV_PARAM_UNSURE, SV_PARAM_ENUM, 0, "unsure", "If fluid is doubtful", "",
     "What happens where it is doubtful whether there is fluid in front of the fetus: keep removes "
     "nothing; clip tries it, with little confidence.",
     0.0, 1.0, SV_UNSURE_KEEP, 1.0, 0.0, 0.0, GROUP_SURFACE, unsure, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_FLUID_THRESHOLD, SV_PARAM_FLOAT, 0, "fluid_threshold", "Fluid threshold T_L", "",
     "Intensities at or below it are amniotic fluid, above it tissue.", 0.0, 1.0, 40.5 / 255.0, 0.01, 0.05,
     0.4, GROUP_POINTS, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_BONE_MODE, SV_PARAM_ENUM, 0, "bone_mode", "Bone threshold mode", "",
     "How the bone threshold T_B is found: given, below the volume's maximum, or by a share of the rays.",
     0.0, 2.0, 1.0, 1.0, 0.0, 0.0, GROUP_POINTS, bone_modes, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_BONE_OFFSET, SV_PARAM_FLOAT, 0, "bone_offset", "Bone offset", "",
     "Mode offset: T_B = maximum of the volume minus this.", 0.0, 1.0, 0.24, 0.01, 0.0, 0.5, GROUP_POINTS,
     NULL, SV_PARAM_BONE_MODE, SV_BIT(SV_BONE_OFFSET)},
    {SV_PARAM_BONE_THRESHOLD, SV_PARAM_FLOAT, 0, "bone_threshold", "Bone threshold T_B", "",
     "Mode absolute: a ray whose maximum exceeds it gives an initial point.", 0.0, 1.0, 0.74, 0.01, 0.5, 1.0,
     GROUP_POINTS, NULL, SV_PARAM_BONE_MODE, SV_BIT(SV_BONE_ABSOLUTE)},
    {SV_PARAM_BONE_FRACTION, SV_PARAM_FLOAT, 0, "bone_fraction", "Bone fraction", "",
     "Mode fraction: T_B is the highest threshold that at least this share of the rays exceeds.", 0.0, 1.0,
     0.03, 0.01, 0.01, 0.1, GROUP_POINTS, NULL, SV_PARAM_BONE_MODE, SV_BIT(SV_BONE_FRACTION)},
    {SV_PARAM_METHOD, SV_PARAM_ENUM, SV_PARAM_REACTIVATE, "method", "Surface reconstruction", "",
     "wall finds the surface in every ray's own fluid. The others spread depths from initial "
     "points to all pixels. Moving the surface costs next to nothing, but with minimum.",
     0.0, SV_METHOD_END - 1.0, SV_METHOD_WALL, 1.0, 0.0, 0.0, GROUP_SURFACE, methods, 0, 0},
    {SV_PARAM_KERNEL, SV_PARAM_INT, 0, "kernel", "Filter size k", "pixels",
     "Window of the mean filter (larger is smoother) and of the minimum filter, odd.", SV_MIN_KERNEL, 63.0,
     23.0, 2.0, 3.0, 63.0, GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_FILL_WEIGHT, SV_PARAM_FLOAT, SV_PARAM_EXPERT, "fill_weight", "Weight of filled pixels", "",
     "Weight of pixels that an earlier pass filled, against 1 of initial points; rounded to quarters.", 0.0,
     1.0, 0.5, 0.25, 0.0, 0.0, GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_PASSES, SV_PARAM_INT, SV_PARAM_EXPERT, "passes", "Most passes", "",
     "Method minimum: after so many passes pixels without a surface stay so, and are not clipped. 0: passes "
     "go on until there is none.",
     0.0, SV_MAX_PASSES, 0.0, 1.0, 0.0, 20.0, GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_EVIDENCE, SV_PARAM_FLOAT, 0, "evidence", "Evidence wanted", "",
     "Share of the bone rays that must have sure fluid in front of the bone. With less the frame ends "
     "without a surface.",
     0.0, 1.0, 0.5, 0.05, 0.0, 0.0, GROUP_POINTS, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_MIN_GAP, SV_PARAM_FLOAT, SV_PARAM_EXPERT, "min_gap", "Sure gap", "slices",
     "A fluid interval at least this long counts as sure evidence.", 0.0, 64.0, 2.0, 0.5, 0.0, 8.0,
     GROUP_POINTS, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_DROP_EMPTY, SV_PARAM_BOOL, SV_PARAM_EXPERT, "drop_empty", "Drop empty intervals", "",
     "Bone rays without fluid before the bone give no initial point instead of a vote for depth 0.", 0.0, 1.0,
     0.0, 1.0, 0.0, 0.0, GROUP_POINTS, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_PREFILTER, SV_PARAM_ENUM, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "prefilter", "Pre-filter", "",
     "What is done to the initial points first. minimum takes the smallest depth nearby, against outliers "
     "that lie too deep. Every turn of q then reconstructs again.",
     0.0, 1.0, SV_PREFILTER_NONE, 1.0, 0.0, 0.0, GROUP_PREFILTER, prefilters, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_PREFILTER_PASSES, SV_PARAM_INT, SV_PARAM_EXPERT, "prefilter_passes", "Pre-filter passes", "",
     "Passes of the pre-filter.", 0.0, SV_MAX_PREFILTER_PASSES, 1.0, 1.0, 0.0, 8.0, GROUP_PREFILTER, NULL,
     SV_PARAM_PREFILTER, SV_BIT(SV_PREFILTER_MINIMUM)},
    {SV_PARAM_PREFILTER_KERNEL, SV_PARAM_INT, SV_PARAM_EXPERT, "prefilter_kernel", "Pre-filter size",
     "pixels", "Window of the pre-filter, odd.", 3.0, 63.0, 5.0, 2.0, 0.0, 0.0, GROUP_PREFILTER, NULL,
     SV_PARAM_PREFILTER, SV_BIT(SV_PREFILTER_MINIMUM)},
    {SV_PARAM_LAMBDA, SV_PARAM_FLOAT, SV_PARAM_EXPERT, "lambda", "Spline smoothing", "pixels^2",
     "Method spline: 0 passes through the points, larger is smoother.", 0.0, 1e6, 0.0, 1.0, 0.0, 1000.0,
     GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_MERGE_GRID, SV_PARAM_INT, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "merge_grid", "Spline merging",
     "",
     "Method spline: the points of each cell of an N x N grid become one. 0 merges only if there are more "
     "points than the solver takes.",
     0.0, SV_SPLINE_MAX_GRID, 8.0, 1.0, 0.0, 32.0, GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_SPLINE_GRID, SV_PARAM_INT, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "spline_grid",
     "Spline evaluation", "",
     "Method spline: evaluated at the nodes of N x N cells, linear in between. 0: at every pixel.", 0.0,
     256.0, 32.0, 1.0, 0.0, 64.0, GROUP_METHOD, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_PRECISION, SV_PARAM_ENUM, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "precision", "Precision", "",
     "Method spline: float64 where the device has it; float32 is faster and takes at most 64 points.", 0.0,
     1.0, SV_PRECISION_FLOAT64, 1.0, 0.0, 0.0, GROUP_WORK, precisions, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_SUBSTEPS, SV_PARAM_INT, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "substeps", "Samples per slice",
     "", "Samples along a ray per slice, linear in between; 1 samples the slices only.", 1.0, 4.0, 1.0, 1.0,
     0.0, 0.0, GROUP_WORK, NULL, SV_PARAM_METHOD, BY_METHOD},
    {SV_PARAM_STRATEGY, SV_PARAM_ENUM, SV_PARAM_EXPERT | SV_PARAM_REACTIVATE, "strategy", "Work layout", "",
     "How the work is laid out on the device; the result is the same. rays is for GPUs: a work item has a "
     "single ray. With the others it has a row of rays or more. auto chooses by device and size.",
     0.0, 3.0, 0.0, 1.0, 0.0, 0.0, GROUP_WORK, strategies, 0, 0},
};
_Static_assert(sizeof sv_params / sizeof *sv_params == SV_PARAM_COUNT, "abi.h counts the parameters");

uint64_t sv_param_depends_values(const sva_param *param) {
    uint64_t values = 0;
    if (param->depends_on != SV_PARAM_METHOD) return param->depends_values;
    for (uint32_t method = 0; method < SV_METHOD_END; method++)
        if (sv_method_of(method) && sv_method_uses(sv_method_of(method), param->id)) values |= SV_BIT(method);
    return values;
}

sv_values sv_values_of(const double *list) {
    sv_values values = {{0.0}};
    for (uint32_t i = 0; i < SV_PARAM_COUNT; i++) values.of[sv_params[i].id] = list[i];
    return values;
}
