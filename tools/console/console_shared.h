/* SPDX-License-Identifier: MIT */
/* What all pages of a console share, and how anything gets to one of them. */
#ifndef HS_CONSOLE_SHARED_H
#define HS_CONSOLE_SHARED_H

#include "console/console_files.h"
#include "console/console_offer.h"

#include <stdint.h>

typedef struct {
    hs_console_offers offers;
    hs_console_files files;
    const char *out; /* folder for what is written */
} hs_console_shared;

/* How to send to a page; may block. False: it is gone. Called from the page's thread and that of
 * hs_console_page_say. */
typedef bool (*hs_console_send)(void *connection, bool binary, const uint8_t *data, size_t bytes);

#endif
