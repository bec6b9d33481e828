/* SPDX-License-Identifier: MIT */
/* One page with a method on every case in pictures, and on volumes that nothing hides. */
#ifndef SITE_PAGE_H
#define SITE_PAGE_H

#include "judge/site_set.h"

/* What the page shows. Borrowed. */
typedef struct {
    const site_list *sites;
    const char *const *volumes; /* MetaImage files that nothing hides */
    uint32_t volume_count;
    const char *plugin, *settings; /* "key=value", parted by spaces */
    const char *out;               /* folder: index.html, and a folder of pictures per case */
} site_page;

/* For every case: full volume, result and truth, drawn in light; slices with the surface, its confidence, and
 * the error of every ray. Then the first case of every site bare, without a fetus and with a bladder, and
 * three views of every volume. */
bool site_page_write(const site_page *page, hs_error *err);

#endif
