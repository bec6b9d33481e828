/* SPDX-License-Identifier: MIT */
/* A plugin with its values in a scan loop of its own. Two lanes on one source can be compared. */
#ifndef HS_CONSOLE_LANE_H
#define HS_CONSOLE_LANE_H

#include "console/console_offer.h"
#include "console/console_state.h"
#include "loop/loop.h"

/* What a plugin still has to do for a picture that holds; a later one includes those before it. */
typedef enum {
    HS_LANE_NOTHING,
    HS_LANE_ADJUST, /* one value that adjust takes */
    HS_LANE_ASK,    /* begin, slabs, end */
    HS_LANE_CONVERT /* and the slabs before */
} hs_lane_need;

typedef struct {
    const hs_console_offer *offer; /* NULL: no plugin was chosen yet */
    hs_plugin plugin;
    bool has_plugin;
    hs_error failure; /* of opening it */
    sv_param_value values[HS_CONSOLE_VALUES];
    uint32_t count;
    hs_loop *loop;
    uint32_t adjusted; /* index into values of what HS_LANE_ADJUST is about */
    hs_lane_need need;
    hs_frame frame;            /* the last one */
    bool was_adjusted;         /* it came from adjust */
    double activation_ms;      /* of the last activation */
    uint32_t activations;      /* so many there were */
    double ms[HS_STAGE_COUNT]; /* of the last frame's stages; 0 for those it did not need */
} hs_lane;

/* Opens the offered plugin, or another one; its values are the defaults then. The loop must be built anew by
 * hs_lane_build. A plugin that cannot be opened is no failure: `failure` tells. */
void hs_lane_choose(hs_lane *lane, const hs_console_offer *offer, const hs_guard_options *guard);

/* Builds the loop on a source. HS_ERR_INPUT, HS_ERR_DEVICE, HS_ERR_MEMORY: there is no loop then. */
bool hs_lane_build(hs_lane *lane, const hs_cl *cl, const hs_source *source, const hs_loop_options *options,
                   hs_error *err);

/* Takes the values of a state, and activates the plugin anew if one of them needs it. HS_ERR_INPUT names a
 * parameter that the plugin does not have, or a value out of its range: the values are then as they were.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_lane_set(hs_lane *lane, const hs_console_lane *wanted, const hs_loop_options *options, hs_error *err);

/* Does what the lane needs for volume `index`, which is brought first.
 * HS_ERR_DEVICE, or the source's errors. */
bool hs_lane_run(hs_lane *lane, uint32_t index, hs_error *err);

/* At least this is needed at the next run. */
void hs_lane_needs(hs_lane *lane, hs_lane_need need);

/* Why the last frame is not clipped, if the plugin failed; code HS_OK if it did not. */
const hs_error *hs_lane_error(const hs_lane *lane);

void hs_lane_close(hs_lane *lane);

#endif
