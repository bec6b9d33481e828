/* SPDX-License-Identifier: MIT */
/*
 * The methods of surface reconstruction: constant, stable value, and name, which is the parameter's text and
 * the suffix of the method's table (sv_method_<name>, in method/method_<name>.c) and of its definition's
 * (sv_ref_method_<name>, in ref/ref_<name>.c). In the order of their values. This is the only list of them:
 * the parameter, self-test, tests and benchmarks go through it. Values 3 to 6 are retired and never used
 * again: they were pushpull, membrane, plate and cost.
 */
#pragma once

#define SV_METHODS(X)                                                                                        \
    X(MEAN, 0, mean)                                                                                         \
    X(MINIMUM, 1, minimum)                                                                                   \
    X(SPLINE, 2, spline)                                                                                     \
    X(WALL, 7, wall)

/* SV_METHOD_MEAN, ...; SV_METHOD_END is one more than the last value. */
#define SV_METHOD_VALUE(NAME, value, key) SV_METHOD_##NAME = (value),
enum { SV_METHODS(SV_METHOD_VALUE) SV_METHOD_END };
#undef SV_METHOD_VALUE
