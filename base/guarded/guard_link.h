/* SPDX-License-Identifier: MIT */
/* The host's side of a guard: its child, the memory they share, and one message at a time. */
#pragma once

#include "guard/child.h"
#include "guarded/guard_block.h"
#include "guarded/guard_options.h"
#include "smartvis_plugin.h"

/* The instance's own copy of a descriptor, with pointers into the facts. */
typedef struct {
    sv_descriptor descriptor;
    const char *extensions[HS_GUARD_EXTENSIONS + 1];
} hs_guard_told;

typedef struct {
    sv_plugin instance; /* what the host calls; plugin_data is the guard */
    hs_guard_options options;
    hs_child child;
    uint32_t number;     /* of the last order */
    uint32_t slab_count; /* of the frame under way; the block's is for the child */
    uint32_t restarts;

    hs_guard_block *block; /* shared; the child may write anything into it at any time */
    intptr_t block_shared;
    uint8_t *slabs; /* shared, read-only for the child */
    size_t slabs_bytes;
    intptr_t slabs_shared, slabs_reader;

    char path[1024], id[256]; /* what was opened */
    bool has_id;
    int32_t log_level;
    hs_guard_facts facts; /* a copy, checked */
    hs_guard_told told[HS_MAX_PLUGINS];

    hs_handover way;
    bool active;
    bool lost_frame; /* a new child has not seen the frame before */
    sv_format format;
    sv_param_value *values; /* of the format, owned */
    size_t pixels;
    bool offered; /* the confidence */

    uint32_t habit;   /* what the host asked for after the frame before: it comes with the next */
    uint32_t settled; /* what the last message brought of that */

    char last_error[1024], call[64];
    hs_error ended; /* the first time that a child ended of itself */
} hs_guard;

/* The guard behind an instance. */
static inline hs_guard *hs_guard_of(const sv_plugin *instance) {
    return instance->plugin_data;
}

/* Makes the shared memory. HS_ERR_MEMORY. */
bool hs_guard_link_create(hs_guard *guard, hs_error *err);
void hs_guard_link_destroy(hs_guard *guard);

/* A map of the last message, behind the block; as many pixels as the format has. */
void *hs_guard_map_of(const hs_guard *guard, hs_guard_map map);

/* Starts a child and has it open the library. HS_ERR_PLUGIN. */
bool hs_guard_start(hs_guard *guard, hs_error *err);

/* One order and its reply. `limit` is the seconds that each call of the plugin may take. Whatever happens to
 * the child, the status says it (SV_ERR_INTERNAL), and guard->last_error and guard->call tell more. */
sv_status hs_guard_ask(hs_guard *guard, hs_guard_op op, double limit);

/* A failure of the guard's own, as a call would report it. */
sv_status hs_guard_refuse(hs_guard *guard, sv_status status, const char *call, const char *reason);

/* True if there is a child, or a new one could be started and brought to where the old one was. Else
 * guard->last_error says why not. */
bool hs_guard_revive(hs_guard *guard);

/* Ends the child if there is one. */
void hs_guard_end_child(hs_guard *guard);

/* Sends the saved format to the child. */
sv_status hs_guard_activate(hs_guard *guard);

/* sv_plugin.get_extension of a guarded instance. */
const void *hs_guarded_extension(const sv_plugin *plugin, const char *id);
