/* SPDX-License-Identifier: MIT */
/* Numbers that are nearly what a definition says; a failure names what was looked at. Behind cmocka's
 * includes. */
#pragma once

#include <math.h>

/* Fails unless `found` lies within `tolerance` of `expected`; NaN fails. */
#define assert_near(found, expected, tolerance)                                                              \
    do {                                                                                                     \
        const double found_ = (found), expected_ = (expected);                                               \
        if (!(fabs(found_ - expected_) <= (tolerance)))                                                      \
            fail_msg("%s is %.9g, expected %s = %.9g", #found, found_, #expected, expected_);                \
    } while (0)
