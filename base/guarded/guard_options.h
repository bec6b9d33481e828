/* SPDX-License-Identifier: MIT */
/* When a plugin is guarded, and what its child may take. */
#pragma once

#include "core/options.h"

#include <stddef.h>
#include <stdint.h>

typedef enum {
    HS_GUARD_AUTO, /* every library but the host's own */
    HS_GUARD_ON,
    HS_GUARD_OFF
} hs_guard_choice;

typedef struct {
    hs_guard_choice choice;
    double frame_s;        /* seconds that a call of a frame may take */
    double setup_s;        /* and any other: loading, create, activate */
    uint64_t memory_bytes; /* that the child may take, shared memory not counted */
    uint32_t restarts;     /* children after the first */
} hs_guard_options;

/* Auto, 5 s, 60 s, 4 GiB, 3 restarts. */
void hs_guard_defaults(hs_guard_options *options);

/* True if the library at `path` is to be guarded. */
bool hs_guard_wanted(const hs_guard_options *options, const char *path);

/* The program that serves as the child: by default host_sim beside the running program. NULL: the running
 * one. */
void hs_guard_set_program(const char *path);
const char *hs_guard_program(void);

/* Rows of a table of hs_option; `at` is where the command's options hold an hs_guard_options. */
#define HS_GUARD_ROWS(at)                                                                                    \
    HS_OPTIONS_GROUP(                                                                                        \
        "The guard (the plugin runs in a process of its own; whatever it does, the host goes on):"),         \
        HS_CHOICE("guard", (at) + offsetof(hs_guard_options, choice), HS_GUARD_ON,                           \
                  "any plugin [every library but the host's own]"),                                          \
        HS_CHOICE("no-guard", (at) + offsetof(hs_guard_options, choice), HS_GUARD_OFF, "none"),              \
        HS_TAKEN("guard-time", "S[,S]", at, hs_guard_take_time,                                              \
                 "seconds a call of a frame may take, and any other call [5,60]"),                           \
        HS_TAKEN("guard-memory", "MIB", at, hs_guard_take_memory,                                            \
                 "memory that the plugin's process may take [4096]")
bool hs_guard_take_time(void *guard_options, const char *text, hs_error *err);
bool hs_guard_take_memory(void *guard_options, const char *text, hs_error *err);
