/* What the pictures of a case share; for hs_eval_pictures*.c and the page. */
#ifndef HS_EVAL_DRAW_H
#define HS_EVAL_DRAW_H

#include "hs_eval_study.h"
#include "hs_picture.h"

#define HS_EVAL_PICTURE     256u  /* pixels per side on the page */
#define HS_EVAL_ERROR_LIMIT 40.0f /* steps: where the colours of the error picture end */

/* A loop over the case's volume with pictures of `pixels` a side. The case's own loop must be gone: a
 * plugin's instance serves one at a time. */
hs_loop *hs_eval_draw_loop(hs_eval_study *study, const hs_eval_case *c, const hs_eval_values *values,
                           uint32_t pixels, hs_error *err);

bool hs_eval_save_picture(const hs_picture *picture, const char *folder, const char *name, hs_error *err);

/* A square picture of four bytes a pixel. */
bool hs_eval_save_rgba(const uint8_t *rgba, uint32_t side, const char *folder, const char *name,
                       hs_error *err);

/* The errors alone, in the legend's colours: the page sets them beside the renderings. */
bool hs_eval_save_errors(const float *error, uint32_t width, uint32_t height, const char *folder,
                         const char *name, hs_error *err);

#endif
