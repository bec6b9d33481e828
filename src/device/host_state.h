/* SPDX-License-Identifier: MIT */
/* What is the host's of a process, kept while an OpenCL runtime starts and compiles in it. */
#pragma once

#include "smartvis/author_runtime.h"

#include <fenv.h>

typedef struct {
    sva_handlers handlers; /* of signals, which LLVM takes */
    fenv_t floats;         /* of this thread: traps, rounding mode, flags */
} sv_host_state;

/* Until sv_host_state_put_back no floating-point exception traps, and numbers are rounded as C does by
 * default. Threads that the runtime starts meanwhile inherit that: kernels compute 0 / 0 and discard it. */
void sv_host_state_keep(sv_host_state *state);
void sv_host_state_put_back(const sv_host_state *state);
