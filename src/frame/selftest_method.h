/* SPDX-License-Identifier: MIT */
/* The method's part of the self-test. */
#ifndef SV_SELFTEST_METHOD_H
#define SV_SELFTEST_METHOD_H

#include "frame/pipeline.h"

/*
 * Runs a small map through the configuration's method and pre-filter and compares the surface with the
 * definition in the method's table; SV_OK at once for a method that takes the sums of the points stage, which
 * sv_selftest has seen. Blocks and allocates. SV_ERR_SELF_TEST if a status differs, or a depth by more than
 * the table's bound.
 */
sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, const sv_config *config, const sv_values *defaults);

#endif
