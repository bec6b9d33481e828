/* SPDX-License-Identifier: MIT */
/* A known answer, computed on the device by the very kernels a frame uses, and compared with src/ref/. */
#pragma once

#include "frame/pipeline.h"

/*
 * Runs a small volume through each kernel set (narrow, and wide if it is not NULL) with the configuration's
 * structure (samples per slice, padding, strategy). As a side effect every kernel is launched once with its
 * final local size, so that no frame pays for a late compilation. `defaults`: the frame parameters that the
 * test does not set itself. Blocks and allocates. SV_ERR_SELF_TEST if the device is wrong: a status that
 * differs, or a depth that differs by more than 1e-3 slice.
 */
sv_status sv_selftest(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                      const sv_program *wide, const sv_config *config, const sv_values *defaults);

/*
 * Runs a small map through the configuration's method and pre-filter and compares the surface with the
 * definition in the method's table; SV_OK at once for a method that takes the sums of the points stage, which
 * sv_selftest has seen. Blocks and allocates. SV_ERR_SELF_TEST if a status differs, or a depth by more than
 * the table's bound.
 */
sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, const sv_config *config, const sv_values *defaults);
