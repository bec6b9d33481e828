/* SPDX-License-Identifier: MIT */
/* Messages of a page, from text to values. A pure function: nothing is read, opened or kept. docs/console.md
 * has the fields. */
#ifndef HS_CONSOLE_MESSAGE_H
#define HS_CONSOLE_MESSAGE_H

#include "console/console_state.h"

#define HS_CONSOLE_MAX_MESSAGE 16384u /* bytes */

typedef enum {
    HS_CONSOLE_SAYS_STATE, /* what to show from now on */
    HS_CONSOLE_SAYS_SEEN,  /* the page has painted frame `seen` */
    HS_CONSOLE_SAYS_DO     /* something once: */
} hs_console_says;

typedef enum {
    HS_CONSOLE_SNAPSHOT, /* sends `view` as a PNG */
    HS_CONSOLE_WRITE     /* writes results: `write` */
} hs_console_deed;

typedef struct {
    hs_console_says says;
    hs_console_state state;
    uint64_t seen;
    hs_console_deed deed;
    hs_console_view view;
} hs_console_message;

/* Reads `bytes` bytes, which need not end with a NUL. HS_ERR_INPUT names the field, its value and what is
 * expected; *out means nothing then. Any thread. */
bool hs_console_message_read(const char *text, size_t bytes, hs_console_message *out, hs_error *err);

#endif
