/* SPDX-License-Identifier: MIT */
/* Pictures side by side, with captions, a title and facts. */
#ifndef HS_PICTURE_PANEL_H
#define HS_PICTURE_PANEL_H

#include "picture/picture.h"

/* One picture of a panel. */
typedef struct {
    const char *caption; /* above it; NULL for none */
    hs_image image;
} hs_panel_item;

/* Title and facts around a picture. NULL for none. */
typedef struct {
    const char *title;  /* one line above */
    const char *footer; /* below; '\n' parts lines */
} hs_caption;

/* `count` (1 .. 8) images of equal size next to each other, each `cell` pixels wide (0: 512, so that three
 * make 1600) and scaled smoothly with its aspect kept. Allocates *out (hs_picture_free it); on failure it is
 * zeroed, with HS_ERR_INPUT if sizes differ. */
bool hs_picture_panel(hs_picture *out, const hs_panel_item *items, uint32_t count, uint32_t cell,
                      const hs_caption *caption, hs_error *err);

#endif
