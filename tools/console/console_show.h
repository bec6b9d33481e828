/* SPDX-License-Identifier: MIT */
/* What a page's thread does with a state: the stage follows it, and its pictures go to the page. */
#ifndef HS_CONSOLE_SHOW_H
#define HS_CONSOLE_SHOW_H

#include "console/console_message.h"
#include "console/console_shared.h"

typedef struct hs_console_show hs_console_show;

/* Sends what there is to choose from. The device is opened for the first frame. NULL without memory, or if
 * the page is gone. */
hs_console_show *hs_console_show_open(const hs_console_shared *shared, hs_console_send send,
                                      void *connection);
void hs_console_show_close(hs_console_show *show);

/* Draws what has changed, and sends it: pictures, then the frame's text. False: the page is gone. What cannot
 * be shown is answered with "refused". */
bool hs_console_show_frame(hs_console_show *show, const hs_console_state *state, uint32_t index,
                           uint64_t frame);

/* A snapshot, or results on the disk. False: the page is gone. */
bool hs_console_show_deed(hs_console_show *show, const hs_console_message *deed);

#endif
