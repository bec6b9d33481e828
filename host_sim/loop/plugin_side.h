/* SPDX-License-Identifier: MIT */
/* A plugin's side of a host: its slabs in the way that it takes them, and its share of a frame. */
#pragma once

#include "loop/clipper.h"

typedef struct {
    hs_handover handover; /* as wanted; hs_side_fit: as the plugin takes it */
    bool fixed;           /* a plugin that takes slabs in another way only is refused */
    hs_fan fan;           /* hs_side_fit: how it is told what was scanned */
    hs_error refused;     /* ... and why it must not be activated; code HS_OK: it may be */
} hs_side_way;

/* What the plugin takes decides how slabs go to it. NULL: there is none. */
void hs_side_fit(hs_side_way *way, const hs_plugin *plugin);

/*
 * Makes the slabs of `layout` and activates the plugin with them, guarded or not. Of `asked`, own_queue and
 * refused are those of the way. `gaps`: hs_slabs_create. On failure, the errors of hs_slabs_create,
 * hs_clipper_create and hs_guarded_memory, what was made is left in *slabs, for the caller to destroy.
 */
bool hs_side_create(const hs_cl *cl, const hs_plugin *plugin, const hs_side_way *way,
                    const hs_slab_layout *layout, bool gaps, const hs_clipper_options *asked,
                    hs_slabs **slabs, hs_clipper **clipper, hs_error *err);
