/* SPDX-License-Identifier: MIT */
/* The picture of the one knob a user turns: the same frame for several positions of it. */
#ifndef HS_LOOP_KNOB_H
#define HS_LOOP_KNOB_H

#include "loop/loop.h"

/*
 * Writes knob.png: the result of frame `index` for six positions of the plugin's primary parameter, from one
 * end of its display range to the other. Writes nothing if the plugin has no such parameter.
 */
bool hs_loop_write_knob(hs_loop *loop, const hs_plugin *plugin, const hs_loop_options *options,
                        uint32_t index, const char *folder, const char *title, hs_error *err);

#endif
