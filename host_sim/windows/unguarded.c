/* SPDX-License-Identifier: MIT */
/* What guarded/guarded.h offers on Windows so far: a plugin lives in this process. */
#include "guarded/guarded.h"

bool hs_guarded_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                     const hs_guard_options *options, hs_error *err) {
    if (options->choice == HS_GUARD_ON)
        return hs_fail(err, HS_ERR_USAGE, "--guard: there is none on this system");
    return hs_plugin_open(plugin, path, id, log_level, err);
}

bool hs_guarded_close(hs_plugin *plugin, hs_error *err) {
    hs_plugin_close(plugin);
    return !plugin->complaint[0] || hs_fail(err, HS_ERR_PLUGIN, "%s", plugin->complaint);
}

bool hs_is_guarded(const hs_plugin *plugin) {
    (void)plugin;
    return false;
}

void hs_guarded_route(const hs_plugin *plugin, hs_handover way) {
    (void)plugin;
    (void)way;
}

void *hs_guarded_memory(const hs_plugin *plugin, size_t bytes, hs_error *err) {
    (void)hs_fail(err, HS_ERR_FAILED, "%s: %zu bytes of a guard that is not there", plugin->path, bytes);
    return NULL;
}
