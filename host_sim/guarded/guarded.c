/* SPDX-License-Identifier: MIT */
#include "guarded/guarded.h"

#include "guarded/guarded_instance.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* -------------------------------------------------------------------------------------------- facts -- */

static void end_text(char *text, size_t bytes) {
    text[bytes - 1] = '\0';
}

/* A descriptor of the copied facts, with pointers to its texts. */
static void tell(hs_guard_told *told, hs_guard_descriptor *facts) {
    end_text(facts->id, sizeof facts->id);
    end_text(facts->name, sizeof facts->name);
    end_text(facts->vendor, sizeof facts->vendor);
    end_text(facts->version, sizeof facts->version);
    end_text(facts->summary, sizeof facts->summary);
    if (facts->extension_count > HS_GUARD_EXTENSIONS) facts->extension_count = HS_GUARD_EXTENSIONS;
    for (uint32_t i = 0; i < facts->extension_count; i++) {
        end_text(facts->extension[i], sizeof facts->extension[i]);
        told->extensions[i] = facts->extension[i];
    }
    told->extensions[facts->extension_count] = NULL;
    told->descriptor = facts->numbers;
    told->descriptor.size = sizeof told->descriptor;
    told->descriptor.id = facts->id;
    told->descriptor.name = facts->name;
    told->descriptor.vendor = facts->vendor;
    told->descriptor.version = facts->version;
    told->descriptor.summary = facts->summary;
    told->descriptor.extensions = told->extensions;
}

/* Copies what the child found out, and makes it safe to read. */
static bool take_facts(hs_guard *guard, hs_error *err) {
    hs_guard_facts *facts = &guard->facts;
    *facts = guard->block->facts;
    if (facts->plugin_count == 0 || facts->plugin_count > HS_MAX_PLUGINS ||
        facts->chosen >= facts->plugin_count)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: its process tells of %u plugins", guard->path,
                       facts->plugin_count);
    for (uint32_t i = 0; i < facts->plugin_count; i++) tell(&guard->told[i], &facts->plugin[i]);
    for (uint32_t i = 0; i < facts->param_count && i < HS_MAX_PARAMS; i++) {
        hs_guard_param *param = &facts->param[i];
        end_text(param->key, sizeof param->key);
        end_text(param->label, sizeof param->label);
        end_text(param->unit, sizeof param->unit);
        end_text(param->help, sizeof param->help);
        end_text(param->group, sizeof param->group);
    }
    return true;
}

/* --------------------------------------------------------------------------------------- open, close -- */

static void show(const hs_guard *guard, hs_plugin *plugin) {
    *plugin = (hs_plugin){.abi_major = guard->facts.abi_major,
                          .abi_minor = guard->facts.abi_minor,
                          .count = guard->facts.plugin_count,
                          .instance = &guard->instance,
                          .log_level = guard->log_level};
    memcpy(plugin->path, guard->path, sizeof plugin->path);
    for (uint32_t i = 0; i < plugin->count; i++) plugin->descriptor[i] = &guard->told[i].descriptor;
}

bool hs_guarded_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                     const hs_guard_options *options, hs_error *err) {
    char found[1024]; /* as a name may mean another file in the child's folders */
    *plugin = (hs_plugin){0};
    hs_plugin_find(path, found, sizeof found);
    if (!hs_guard_wanted(options, found)) return hs_plugin_open(plugin, path, id, log_level, err);
    hs_guard *guard = calloc(1, sizeof *guard);
    if (!guard) return hs_fail(err, HS_ERR_MEMORY, "guard: no memory");
    guard->options = *options;
    guard->way = (hs_handover){SV_CARRIER_HOST, true};
    guard->log_level = log_level;
    guard->has_id = id != NULL;
    (void)snprintf(guard->path, sizeof guard->path, "%s", found);
    (void)snprintf(guard->id, sizeof guard->id, "%s", id ? id : "");
    if (hs_guard_link_create(guard, err) && hs_guard_start(guard, err) && take_facts(guard, err)) {
        hs_guarded_instance(guard);
        show(guard, plugin);
        return true;
    }
    hs_guard_link_destroy(guard);
    free(guard);
    return false;
}

bool hs_is_guarded(const hs_plugin *plugin) {
    return plugin && plugin->instance && hs_guarded_is_one(plugin->instance);
}

static hs_guard *guard_of(const hs_plugin *plugin) {
    return hs_is_guarded(plugin) ? hs_guard_of(plugin->instance) : NULL;
}

bool hs_guarded_close(hs_plugin *plugin, hs_error *err) {
    hs_guard *guard = guard_of(plugin);
    hs_error ended = {0};
    if (guard) {
        hs_guarded_end(guard);
        ended = guard->ended;
    }
    hs_plugin_close(plugin);
    return ended.code == HS_OK || hs_fail(err, ended.code, "%s", ended.text);
}

/* ------------------------------------------------------------------------------------ memory, route -- */

void hs_guarded_route(const hs_plugin *plugin, hs_handover way) {
    hs_guard *guard = guard_of(plugin);
    if (guard) guard->way = way;
}

void *hs_guarded_memory(const hs_plugin *plugin, size_t bytes, hs_error *err) {
    hs_guard *guard = guard_of(plugin);
    if (guard->slabs) (void)munmap(guard->slabs, guard->slabs_bytes);
    guard->slabs = NULL;
    guard->slabs_bytes = bytes;
    if (ftruncate(guard->slabs_fd, 0) != 0 || ftruncate(guard->slabs_fd, (off_t)bytes) != 0) {
        (void)hs_fail(err, HS_ERR_MEMORY, "guard: no %zu bytes for slabs: %s", bytes, strerror(errno));
        return NULL;
    }
    void *at = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, guard->slabs_fd, 0);
    if (at == MAP_FAILED) {
        (void)hs_fail(err, HS_ERR_MEMORY, "guard: cannot map %zu bytes of slabs: %s", bytes, strerror(errno));
        return NULL;
    }
    guard->slabs = at;
    return at;
}

const char *hs_guarded_call(const hs_plugin *plugin, const char *call) {
    const hs_guard *guard = guard_of(plugin);
    return guard && guard->call[0] ? guard->call : call;
}

bool hs_guarded_lives(const hs_plugin *plugin) {
    const hs_guard *guard = guard_of(plugin);
    return !guard || guard->child.pid != 0;
}

const hs_error *hs_guarded_ended(const hs_plugin *plugin) {
    static const hs_error none = {0};
    const hs_guard *guard = guard_of(plugin);
    return guard ? &guard->ended : &none;
}

uint32_t hs_guarded_restarts(const hs_plugin *plugin) {
    const hs_guard *guard = guard_of(plugin);
    return guard ? guard->restarts : 0;
}
