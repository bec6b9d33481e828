/* SPDX-License-Identifier: MIT */
/*
 * A page that is open. A thread of its own holds the page's stage and draws; who receives its messages only
 * leaves the newest state for it, in a mailbox with one place. So there is never a queue: what is older than
 * the newest state is never drawn. Frames go out only while the page keeps up: two may be under way that it
 * has not said it has painted.
 */
#ifndef HS_CONSOLE_PAGE_H
#define HS_CONSOLE_PAGE_H

#include "console/console_shared.h"

typedef struct hs_console_page hs_console_page;

/* Starts the page's thread. `shared` and `connection` must outlive it. NULL with HS_ERR_MEMORY or
 * HS_ERR_FAILED. */
hs_console_page *hs_console_page_open(const hs_console_shared *shared, hs_console_send send, void *connection,
                                      hs_error *err);

/* Takes a message of the page; never waits for a picture. What cannot be read is answered with "refused".
 * False: the page sends nothing but nonsense, and should be closed. */
bool hs_console_page_say(hs_console_page *page, const char *text, size_t bytes);

/* Ends the thread, which finishes what it is about. */
void hs_console_page_close(hs_console_page *page);

#endif
