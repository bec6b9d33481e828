/* SPDX-License-Identifier: MIT */
#include "device/host_state.h"

void sv_host_state_keep(sv_host_state *state) {
    sva_handlers_keep(&state->handlers);
    (void)fegetenv(&state->floats);
    (void)fesetenv(FE_DFL_ENV);
}

void sv_host_state_put_back(const sv_host_state *state) {
    (void)fesetenv(&state->floats);
    sva_handlers_put_back(&state->handlers);
}
