/* SPDX-License-Identifier: MIT */
/*
 * A whole program's work in a process of its own, for a plugin that may do anything: a benchmark, a replay.
 * The guard proper would stand between its calls and change them; so the work is the child here, and says now
 * and then that it goes on.
 */
#pragma once

#include "guarded/guard_options.h"

/* `work` in a child if the library is to be guarded, else in this process. The child is this program with the
 * same arguments (hs_child_take), comes here on the same way, and does not return. Returns the exit code;
 * HS_ERR_PLUGIN if the child ended otherwise, or said nothing for guard->setup_s: "PATH: crashed: SIGSEGV
 * while DOING (...)". */
int hs_work_in_child(const hs_guard_options *guard, const char *plugin, const char *doing,
                     int (*work)(void *context), void *context, hs_error *err);

/* Work that takes long goes on. Steps of a progress say so, too. */
void hs_child_goes_on(void);
