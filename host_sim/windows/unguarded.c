/* SPDX-License-Identifier: MIT */
/* What guarded/guarded.h offers on Windows so far: a plugin lives in this process. */
#include "guard/child.h"
#include "guarded/guard_block.h"
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

const char *hs_guarded_call(const hs_plugin *plugin, const char *call) {
    (void)plugin;
    return call;
}

bool hs_guarded_lives(const hs_plugin *plugin) {
    (void)plugin;
    return true;
}

const hs_error *hs_guarded_ended(const hs_plugin *plugin) {
    static const hs_error never = {0};
    (void)plugin;
    return &never;
}

int hs_guard_serve(void) {
    return HS_ERR_USAGE;
}

/* Of guard/child.h, what host_sim uses to compile kernels on two sides at once: here it does so on one. */
bool hs_child_fork(hs_child *child, const hs_child_limits *limits, int (*work)(int channel, void *context),
                   void *context, hs_error *err) {
    (void)child;
    (void)limits;
    (void)work;
    (void)context;
    return hs_fail(err, HS_ERR_FAILED, "there is no fork on this system");
}

void hs_child_wait_end(hs_child *child, double seconds) {
    (void)child;
    (void)seconds;
}

void hs_child_close(hs_child *child) {
    (void)child;
}
