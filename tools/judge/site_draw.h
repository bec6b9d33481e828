/* SPDX-License-Identifier: MIT */
/* A case in pictures, drawn by the host's scan loop with the plugin at work. */
#ifndef SITE_DRAW_H
#define SITE_DRAW_H

#include "judge/wall_judge.h"
#include "render/host_cl.h"

#include "eval/eval_case.h"

/* What all pictures are drawn with. Borrowed. */
typedef struct {
    const hs_cl *cl;
    const hs_plugin *plugin;
    const hs_eval_values *values;
} site_pen;

/* What the plugin did. */
typedef struct {
    wall_score score; /* zeros without a truth */
    bool clipped, sure;
    char note[160]; /* why it is not clipped; "" if it is */
} site_drawn;

/* Writes full.png, result.png, truth.png, slices.png, error.png and, with a confidence, confidence.png to a
 * folder that exists. */
bool site_draw(const site_pen *pen, const wall_case *c, const char *folder, site_drawn *out, hs_error *err);

#endif
