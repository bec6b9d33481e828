/* SPDX-License-Identifier: MIT */
/* The values of a frame's parameters, by their ids; abi/params.c describes and checks them. */
#pragma once

#include "method_list.h"

/* Stable ids of the parameters (never reused: 21 and 23 to 25 were data_weight, solver_steps, memory and
 * reduction). They index sv_values. */
enum {
    SV_PARAM_Q = 1,
    SV_PARAM_FLUID_THRESHOLD = 2,
    SV_PARAM_BONE_MODE = 3,
    SV_PARAM_BONE_OFFSET = 4,
    SV_PARAM_BONE_THRESHOLD = 5,
    SV_PARAM_BONE_FRACTION = 6,
    SV_PARAM_KERNEL = 7,
    SV_PARAM_FILL_WEIGHT = 8,
    SV_PARAM_DROP_EMPTY = 9,
    SV_PARAM_SUBSTEPS = 10,
    SV_PARAM_STRATEGY = 11,
    SV_PARAM_MIN_GAP = 12,
    SV_PARAM_EVIDENCE = 13,
    SV_PARAM_METHOD = 14,
    SV_PARAM_PREFILTER = 15,
    SV_PARAM_PREFILTER_PASSES = 16,
    SV_PARAM_PREFILTER_KERNEL = 17,
    SV_PARAM_LAMBDA = 18,
    SV_PARAM_MERGE_GRID = 19,
    SV_PARAM_SPLINE_GRID = 20,
    SV_PARAM_PRECISION = 22,
    SV_PARAM_UNSURE = 26,
    SV_PARAM_PASSES = 27,
    SV_PARAM_ID_END
};

/* Strategies: how the work is laid out on the device. All give the same bits. */
enum { SV_STRATEGY_AUTO = 0, SV_STRATEGY_SINGLE = 1, SV_STRATEGY_BANDS = 2, SV_STRATEGY_RAYS = 3 };

/* Ends of ranges: with these a frame enqueues most. */
enum { SV_MIN_KERNEL = 3, SV_MAX_PREFILTER_PASSES = 16, SV_MAX_PASSES = 1000 };

/* Numbers that the spline's solver computes with. */
enum { SV_PRECISION_FLOAT64 = 0, SV_PRECISION_FLOAT32 = 1 };

/* What is done where fluid in front of the fetus is doubtful. */
enum { SV_UNSURE_KEEP = 0, SV_UNSURE_CLIP = 1 };

/* What may be done to the initial points before. */
enum { SV_PREFILTER_NONE = 0, SV_PREFILTER_MINIMUM = 1 };

/* Values by id; [0] is unused. */
typedef struct {
    double of[SV_PARAM_ID_END];
} sv_values;
