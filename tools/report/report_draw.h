/* SPDX-License-Identifier: MIT */
/* What the pictures of a case are drawn with: loops over its volume, and files in its folder. */
#ifndef HS_REPORT_DRAW_H
#define HS_REPORT_DRAW_H

#include "eval/eval_case.h"
#include "eval/eval_study.h"
#include "loop/view.h"
#include "picture/picture.h"

#define HS_EVAL_PICTURE      256u  /* pixels per side on the page */
#define HS_EVAL_GHOST_SLICES 10.0f /* low-resolution slices: s and w of the ghosted pictures */
#define HS_EVAL_ERROR_LIMIT  40.0f /* steps: where the colours of the error picture end */

/* A loop over a case's volume. The case's own loop must be gone: a plugin's instance serves one at a time. */
typedef struct {
    const hs_eval_options *options; /* how pictures look */
    const hs_cl *cl;
    const hs_plugin *plugin;
    const hs_eval_case *c;
    const hs_eval_values *values;
    uint32_t pixels; /* of the picture's sides */
    float ghost;     /* steps before the surface that are ghosted (s = w); 0: a hard cut */
} hs_eval_drawing;
hs_loop *hs_eval_draw_loop(const hs_eval_drawing *drawing, hs_error *err);

/* The rendering as a square picture of HS_EVAL_PICTURE pixels, its ghosting as `drawing` says; `view` may be
 * NULL, else the caller frees it. */
bool hs_eval_draw_result(const hs_eval_drawing *drawing, const char *folder, const char *name, hs_view *view,
                         hs_error *err);

bool hs_eval_save_picture(const hs_picture *picture, const char *folder, const char *name, hs_error *err);

/* A square picture of four bytes a pixel. */
bool hs_eval_save_rgba(const uint8_t *rgba, uint32_t side, const char *folder, const char *name,
                       hs_error *err);

/* The errors alone, in the legend's colours: the page sets them beside the renderings. */
bool hs_eval_save_errors(const float *error, uint32_t width, uint32_t height, const char *folder,
                         const char *name, hs_error *err);

#endif
