/* SPDX-License-Identifier: MIT */
/* What one page looks at: a source, one or two lanes on it, and a renderer. It follows the page's newest
 * state, and does only what a change of that state needs. */
#ifndef HS_CONSOLE_STAGE_H
#define HS_CONSOLE_STAGE_H

#include "console/console_files.h"
#include "console/console_lane.h"
#include "loop/screen.h"
#include "loop/truth_picture.h"

typedef struct {
    const hs_console_offers *offers;
    const hs_console_files *files;
    hs_cl cl;
    hs_source source;
    bool has_source;
    char path[2][1024]; /* of a file source, at path_used, and of the one that is being opened */
    uint32_t path_used;
    hs_console_state state; /* as it was last applied */
    uint32_t index;         /* the volume that is shown */
    hs_lane lane[HS_CONSOLE_LANES];
    bool told[HS_CONSOLE_LANES]; /* the page knows this lane's parameters: the caller sets it */
    hs_screen *screen;           /* of screen_dvr, its size included */
    hs_dvr_settings screen_dvr;
    hs_truth_picture *truth; /* NULL: the source has none */
    uint64_t scene_epoch;    /* counts what changes every picture: volume, camera, renderer */
    uint64_t clip_epoch;     /* counts frames of the lanes */
    double source_ms;        /* that opening the source took */
} hs_console_stage;

/* Opens the device. `offers` and `files` must outlive it. HS_ERR_DEVICE. The stage
 * must not move in memory. */
bool hs_console_stage_open(hs_console_stage *stage, const hs_console_offers *offers,
                           const hs_console_files *files, hs_error *err);
void hs_console_stage_close(hs_console_stage *stage);

/* True if the state needs another source, which takes a while. */
bool hs_console_stage_changes_source(const hs_console_stage *stage, const hs_console_state *state);

/* Follows the state and shows volume `index`. A failing plugin is no error of it (hs_lane_error).
 * HS_ERR_INPUT: the state cannot be followed, and the stage is as it was, or has no source any more.
 * HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool hs_console_stage_show(hs_console_stage *stage, const hs_console_state *state, uint32_t index,
                           hs_error *err);

/* The loop of lane 0 as a run has it, for what is written to files; its options are those of the command
 * line. */
hs_loop *hs_console_stage_loop(hs_console_stage *stage);

#endif
