/* SPDX-License-Identifier: MIT */
/*
 * The chain from the initial points to the surfaces:
 *
 *     ray states -> chain_gather -> points -> [minimum filter] -> points -> method -> surfaces -> S(q)
 */
#pragma once

#include "method/method.h"

typedef struct {
    const sv_method *method;
    bool needs_profile; /* initial points say whether there is a surface at all, whatever it is made of */
    bool direct;        /* the method takes the sums of the points stage: nothing is gathered */
    bool linear;        /* in the depths: one run serves every q */
    bool filtered;      /* the minimum filter comes first */
    sv_map *map;        /* of the frame */
    sv_method_state state, filter; /* of the method, of the pre-filter */
    sv_kernel_set gather;
} sv_chain;

/* True if initial points say whether there is a surface at all: the frame needs ray profiles. */
bool sv_chain_needs_profile(const sv_config *config);

/* True if some frame with this format can need 64-bit sums. */
bool sv_chain_needs_wide(const sv_config *config);

/* Decides what the chain consists of. `map` was initialised and must outlive the chain. Makes nothing. */
void sv_chain_init(sv_chain *chain, sv_map *map);

/* Makes the buffers but for those of the frame's map; then the kernels, and what they need once. */
sv_status sv_chain_buffers(sv_chain *chain);
sv_status sv_chain_build(sv_chain *chain);

/* Releases the chain; a zeroed struct may be passed. */
void sv_chain_destroy(sv_chain *chain);

/* Enqueues everything from the points to the surfaces. `state16`: ray states. `q` counts if the chain
 * is not linear. */
sv_status sv_chain_run(sv_chain *chain, cl_mem state16, float q);
