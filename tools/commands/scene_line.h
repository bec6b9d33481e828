/* SPDX-License-Identifier: MIT */
/* The command line of `host_sim scenes`. */
#ifndef HS_SCENE_LINE_H
#define HS_SCENE_LINE_H

#include "render/dvr_settings.h"
#include "scene/scene.h"
#include "scene/scene_export.h"

#define HS_SCENE_LINE_SETS 32u

/* What is asked for. Strings are borrowed from argv. */
typedef struct {
    const char *out;
    hs_scene_options options;
    uint32_t frames;
    const char *sets[HS_SCENE_LINE_SETS]; /* PATH=VALUE */
    uint32_t set_count;
    uint32_t random;         /* scenes of a random set; 0: none */
    uint64_t random_seed;    /* of the set */
    hs_vol_spec geometry;    /* of Kretz files */
    hs_dvr_settings drawing; /* of the sheet */
    bool all, hard, list, ranges, json, export, vol, geometry_given, sheet, times, help;
} hs_scene_line;

/* Reads the options; optind is then that of the first scene. HS_ERR_USAGE names option and value. */
bool hs_scene_line_parse(int argc, char **argv, hs_scene_line *line, hs_error *err);

/* Prints all options and the exit codes. */
void hs_scene_line_help(void);

#endif
