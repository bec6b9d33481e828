/* SPDX-License-Identifier: MIT */
/*
 * The confidence of a frame's surface (smartvis.confidence/1), on its way to the renderer. It travels as the
 * depthmap does: enqueued behind the frame's commands, or copied to the device from the host's memory, and
 * settled by the same wait. A map that does not come, or holds what is no confidence, costs the picture
 * nothing but the wider window.
 */
#pragma once

#include "plugin/loader.h"
#include "render/host_kernels.h"

typedef struct hs_confidence_map hs_confidence_map;

/* Memory for the maps (width x height) of an active plugin; none if `plugin` is NULL or gives no confidence.
 * `own_queue`: the plugin writes to host memory. `cl` and `plugin` must outlive it. NULL with
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
hs_confidence_map *hs_confidence_map_create(const hs_cl *cl, const hs_plugin *plugin, uint32_t width,
                                            uint32_t height, bool own_queue, hs_error *err);
void hs_confidence_map_destroy(hs_confidence_map *map);

/* For every frame, between the plugin's last call and the wait for it: if the map is wanted, asks for it and
 * enqueues its check. A plugin that refuses is no failure, see hs_confidence_map_error. HS_ERR_DEVICE. */
bool hs_confidence_map_ask(hs_confidence_map *map, bool wanted, hs_error *err);

/* After that wait: true if the map was asked for, came, and holds confidences only. */
bool hs_confidence_map_settle(hs_confidence_map *map);

/* The values, 0 .. 1, float32 on the device, rows top to bottom; owned by the map, NULL if it has none. */
cl_mem hs_confidence_map_values(const hs_confidence_map *map);

/* The first failure to give a usable confidence; code HS_OK if there was none. Owned by the map. */
const hs_error *hs_confidence_map_error(const hs_confidence_map *map);
