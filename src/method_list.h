/* SPDX-License-Identifier: MIT */
/*
 * The methods of surface reconstruction: constant, stable value, and name, which is the parameter's text and
 * the suffix of the method's table (sv_method_<name>, in method/method_<name>.c) and of its definition's
 * (sv_ref_method_<name>, in ref/ref_<name>.c). In the order of their values.
 */
#ifndef SV_METHOD_LIST_H
#define SV_METHOD_LIST_H

#define SV_METHODS(X)                                                                                        \
    X(MEAN, 0, mean)                                                                                         \
    X(MINIMUM, 1, minimum)                                                                                   \
    X(SPLINE, 2, spline)                                                                                     \
    X(PUSHPULL, 3, pushpull)                                                                                 \
    X(MEMBRANE, 4, membrane)                                                                                 \
    X(PLATE, 5, plate)                                                                                       \
    X(COST, 6, cost)                                                                                         \
    X(WALL, 7, wall)

#endif
