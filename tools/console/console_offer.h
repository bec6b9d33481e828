/* SPDX-License-Identifier: MIT */
/* The plugins that a page may choose from: those of the libraries on the command line. A page never names a
 * path. */
#ifndef HS_CONSOLE_OFFER_H
#define HS_CONSOLE_OFFER_H

#include "guarded/guarded.h"

enum { HS_CONSOLE_OFFERS = 32 };

typedef struct {
    const char *library; /* as the command line has it; NULL: the default one */
    char path[1024];     /* where that is */
    char id[128];        /* "": the library could not be read, `failure` says why */
    char name[128], version[64];
    bool first; /* of its library: needs no --id */
    hs_error failure;
} hs_console_offer;

typedef struct {
    hs_console_offer offer[HS_CONSOLE_OFFERS];
    uint32_t count;
    hs_guard_options guard;
} hs_console_offers;

/* Adds the plugins of a library (NULL: the default one). A library that cannot be read is offered with its
 * reason, so that a page can say it. HS_ERR_USAGE beyond HS_CONSOLE_OFFERS. */
bool hs_console_offer_library(hs_console_offers *offers, const char *library, hs_error *err);

#endif
