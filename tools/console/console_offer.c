/* SPDX-License-Identifier: MIT */
#include "console/console_offer.h"

#include <stdio.h>

static hs_console_offer *add(hs_console_offers *offers, const char *library, const char *path,
                             hs_error *err) {
    if (offers->count == HS_CONSOLE_OFFERS) {
        (void)hs_fail(err, HS_ERR_USAGE, "%s: more than %d plugins", path, HS_CONSOLE_OFFERS);
        return NULL;
    }
    hs_console_offer *offer = &offers->offer[offers->count++];
    *offer = (hs_console_offer){.library = library};
    (void)snprintf(offer->path, sizeof offer->path, "%s", path);
    return offer;
}

static bool add_plugins(hs_console_offers *offers, const char *library, const char *path,
                        const hs_plugin *plugin, hs_error *err) {
    for (uint32_t i = 0; i < plugin->count; i++) {
        const sv_descriptor *d = plugin->descriptor[i];
        hs_console_offer *offer = add(offers, library, path, err);
        if (!offer) return false;
        (void)snprintf(offer->id, sizeof offer->id, "%s", d->id);
        (void)snprintf(offer->name, sizeof offer->name, "%s", d->name);
        (void)snprintf(offer->version, sizeof offer->version, "%s", d->version);
        offer->first = i == 0;
    }
    return true;
}

bool hs_console_offer_library(hs_console_offers *offers, const char *library, hs_error *err) {
    char path[1024];
    hs_plugin plugin;
    hs_error failure = {0}, closed = {0};
    if (library)
        (void)snprintf(path, sizeof path, "%s", library);
    else
        hs_plugin_default_path(path, sizeof path);
    if (hs_guarded_open(&plugin, path, NULL, SV_LOG_WARNING, &offers->guard, &failure)) {
        const bool ok = add_plugins(offers, library, path, &plugin, err);
        (void)hs_guarded_close(&plugin, &closed); /* what it does when it ends is told when it is used */
        return ok;
    }
    hs_console_offer *offer = add(offers, library, path, err);
    if (!offer) return false;
    offer->failure = failure;
    (void)snprintf(offer->name, sizeof offer->name, "%.120s", path);
    return true;
}
