/* SPDX-License-Identifier: MIT */
/* What a loop is made of: for the sources of this folder that work on it. */
#pragma once

#include "loop/clipper.h"
#include "loop/loop_options.h"
#include "loop/screen.h"
#include "loop/slabs.h"
#include "loop/source.h"

struct hs_loop {
    const hs_cl *cl;
    const hs_source *source;
    hs_loop_options options;
    hs_camera box; /* one box for the whole run: the format is fixed at activation */
    hs_slabs *slabs;
    hs_clipper *clipper;
    hs_screen *screen;
    hs_device_volume *volume;
    uint32_t resident; /* index into source->volumes of the volume on the device */
    uint32_t crops;    /* source->crops of that volume */
    bool has_before;   /* the plugin has had a frame: number `before` */
    uint32_t before;
    bool turned;    /* the camera, since that frame */
    uint32_t asked; /* the frame that the plugin's last map is of */
    float *marked;  /* that map with the marks; NULL until there are some */
    bool in_frame;  /* number `current` is under way: its camera is found once */
    uint32_t current;
    hs_camera camera;
};

/* Frame `index` on its own: it continues nothing. */
hs_frame_facts hs_loop_facts_alone(const hs_loop *loop, uint32_t index);

/* Applies the marks to the map of frame `index`, which a call came to. */
bool hs_loop_mark(hs_loop *loop, uint32_t index, const hs_clip_outcome *clip, hs_error *err);

/* What a call of the plugin came to, as part of a frame. */
void hs_loop_note_clip(const hs_clip_outcome *clip, hs_frame *frame);

/* Where the rays of frame `index` start, for its window: NULL is the full volume, as for `frame` NULL. */
const hs_start_depths *hs_loop_start(const hs_loop *loop, uint32_t index, const hs_frame *frame,
                                     hs_camera *window, hs_start_depths *out);
