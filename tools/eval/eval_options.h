/* SPDX-License-Identifier: MIT */
/* What is asked of an evaluation. */
#ifndef HS_EVAL_OPTIONS_H
#define HS_EVAL_OPTIONS_H

#include "guarded/guard_options.h"
#include "render/dvr_settings.h"

#define HS_EVAL_MAX_CASES 32u
#define HS_EVAL_MAX_SETS  32u

/* Shard `index` (0 .. count - 1) of `count` takes every count-th setting; 0 of 1 takes all. */
typedef struct {
    uint32_t index, count;
} hs_eval_shard;

/* What the command line asks for. Strings are borrowed. */
typedef struct {
    const char *out;        /* folder */
    const char *plugin;     /* NULL: smartvis.so beside the executable */
    hs_guard_options guard; /* of every plugin */
    const char *cases[HS_EVAL_MAX_CASES];
    uint32_t case_count;
    const char *sets[HS_EVAL_MAX_SETS]; /* key=value */
    uint32_t set_count;
    uint32_t size, lowres;
    uint64_t seed;
    const char *real;   /* the volume of the scene "real"; NULL: none */
    const char *beside; /* see hs_eval_beside_open */
    bool coarse;        /* a fifth of the positions on every axis */
    bool merge;         /* computes nothing: the shards' files must make the spaces whole */
    hs_eval_shard shard;
    uint32_t check;                         /* settings to measure the direct way, too */
    uint32_t frames;                        /* of a measurement of speed; 0: none */
    const char *compare[HS_EVAL_MAX_CASES]; /* "library[ key=value]..." */
    uint32_t compare_count;
    uint32_t seeds; /* of a comparison */
    hs_look look;   /* of pictures; measures use the thesis' */
    float light[2]; /* hs_dvr_settings */
} hs_eval_options;

#endif
