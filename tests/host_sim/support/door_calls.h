/* SPDX-License-Identifier: MIT */
/* A host of the machine's library, calls that must come out well, or as they should, and what they make. */
#pragma once

#include "door/smartvis_host.h"
#include "support/unit.h"

static svh_host *host; /* the test opens and closes it */
static svh_error told = {.size = sizeof told};

#define door_must(call)                                                                                      \
    do {                                                                                                     \
        if ((call) != SVH_OK) fail_msg("%s: %s", #call, told.text);                                          \
    } while (0)

#define door_must_not(call, expected, words)                                                                 \
    do {                                                                                                     \
        if ((call) != (expected)) fail_msg("%s is not %d", #call, (int)(expected));                          \
        assert_int_equal(told.code, expected);                                                               \
        if (!strstr(told.text, words)) fail_msg("'%s' does not say '%s'", told.text, words);                 \
    } while (0)

/* Objects that end with the test. */
static void free_clipper(void *clipper) {
    svh_clipper_free(clipper);
}

static void free_volume(void *volume) {
    svh_volume_free(volume);
}

static svh_clipper *clipper_of(const char *path) {
    svh_clipper *clipper;
    door_must(svh_clipper_open(host, path, NULL, &clipper, &told));
    unit_keep(free_clipper, clipper);
    return clipper;
}
