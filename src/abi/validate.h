/* SPDX-License-Identifier: MIT */
/* What the host hands over, checked once at the ABI's edge: SV_OK, or an error that names the field
 * and its value. */
#ifndef SV_VALIDATE_H
#define SV_VALIDATE_H

#include "frame/pipeline.h"

sv_status sv_validate_format(sv_diag *diag, const sv_format *format);
sv_status sv_validate_frame(sv_diag *diag, const sv_pipeline *pipeline, const sv_frame *frame);
/* Values that do not go together, in a frame of this pipeline. */
sv_status sv_validate_values(sv_diag *diag, const sv_pipeline *pipeline, const sv_values *values);
sv_status sv_validate_slab(sv_diag *diag, const sv_pipeline *pipeline, const sv_slab *slab);
sv_status sv_validate_result(sv_diag *diag, const char *call, const sv_pipeline *pipeline,
                             const sv_result *result);

#endif
