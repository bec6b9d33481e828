/* SPDX-License-Identifier: MIT */
/*
 * Structs of callers that were compiled with another smartvis_host.h. One of an older is shorter: what it
 * lacks counts as 0, and is not written. One of a newer is longer: what lies behind this version's fields is
 * neither read nor written. One that ends before what 1.0 had is refused.
 */
#pragma once

#include "core/error.h"

#include <stdint.h>
#include <string.h>

/* The size of a struct whose last field is, or was, `last`. */
#define DOOR_UP_TO(type, last)                                                                               \
    ((offsetof(type, last) + sizeof(((type *)NULL)->last) + _Alignof(type) - 1) / _Alignof(type) *           \
     _Alignof(type))

/* What they were in 1.0. A field that is added begins behind that, also where it would fit into padding. */
#define DOOR_1_0_svh_error   DOOR_UP_TO(svh_error, text)
#define DOOR_1_0_svh_options DOOR_UP_TO(svh_options, context)
#define DOOR_1_0_svh_voxels  DOOR_UP_TO(svh_voxels, mirrored)
#define DOOR_1_0_svh_file    DOOR_UP_TO(svh_file, probe_said)
#define DOOR_1_0_svh_about   DOOR_UP_TO(svh_about, beams)
#define DOOR_1_0_svh_view    DOOR_UP_TO(svh_view, beam_sweep_mm)
#define DOOR_1_0_svh_plugin  DOOR_UP_TO(svh_plugin, summary)
#define DOOR_1_0_svh_param   DOOR_UP_TO(svh_param, group)
#define DOOR_1_0_svh_frame   DOOR_UP_TO(svh_frame, mark_count)
#define DOOR_1_0_svh_result  DOOR_UP_TO(svh_result, why)
#define DOOR_1_0_svh_mesh    DOOR_UP_TO(svh_mesh, triangles)

static inline uint32_t door_size_of(const void *given) {
    uint32_t size;
    memcpy(&size, given, sizeof size);
    return size;
}

/* HS_ERR_USAGE if a struct ends before what it had at least. */
static inline bool door_check_size(const void *given, size_t least, const char *what, hs_error *err) {
    return door_size_of(given) >= least || hs_fail(err, HS_ERR_USAGE, "%s: size is %u, expected at least %zu",
                                                   what, door_size_of(given), least);
}

/* The caller's struct as this version has it. */
static inline bool door_take(void *ours, size_t bytes, const void *given, size_t least, const char *what,
                             hs_error *err) {
    if (!door_check_size(given, least, what, err)) return false;
    const uint32_t size = (uint32_t)bytes, theirs = door_size_of(given);
    memset(ours, 0, bytes);
    memcpy(ours, given, theirs < bytes ? theirs : bytes);
    memcpy(ours, &size, sizeof size);
    return true;
}

/* Back into the caller's struct, which keeps its size. */
static inline void door_give(void *given, const void *ours, size_t bytes) {
    const uint32_t theirs = door_size_of(given);
    memcpy(given, ours, theirs < bytes ? theirs : bytes);
    memcpy(given, &theirs, sizeof theirs);
}

#define DOOR_TAKE(type, ours, given, err) door_take(ours, sizeof(type), given, DOOR_1_0_##type, #type, err)
#define DOOR_FITS(type, given, err)       door_check_size(given, DOOR_1_0_##type, #type, err)
