/* SPDX-License-Identifier: MIT */
/*
 * The results as a plot: time to the right on a logarithmic axis, error upwards on another, a marker a row.
 * Left the largest error against the float64 definition, right the distance from the scenes' ground truth.
 */
#ifndef METHODS_SVG_H
#define METHODS_SVG_H

#include "bench/methods_report.h"

/* HS_ERR_OUTPUT names the path. */
bool methods_write_svg(const methods_report *report, const char *path, hs_error *err);

#endif
