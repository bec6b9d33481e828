/* SPDX-License-Identifier: MIT */
/* Calls of the machine's library that must come out well, or as they should. The test has an error `told`. */
#pragma once

#include "door/smartvis_host.h"
#include "support/unit.h"

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
