/* SPDX-License-Identifier: MIT */
/* The parts of the ABI's edge: the parameters, the checks of what the host hands over, and the extensions. */
#ifndef SV_ABI_H
#define SV_ABI_H

#include "device/diag.h"
#include "frame/pipeline.h"
#include "method/values.h"

#include <stdbool.h>

/* ---- parameters: one table that describes them, and the checks of what the host sends (params.c) */

uint32_t sv_params_count(void);
sv_status sv_params_info(sv_diag *diag, uint32_t index, sv_param_info *out);
sv_status sv_params_text(sv_diag *diag, uint32_t id, double value, char *out, uint32_t bytes);

void sv_params_defaults(sv_values *values);

/* Writes a list of values over `values`, all or none. `call` names the ABI call for messages. Only parameters
 * with all of `required` flags may be in the list; those with SV_PARAM_REACTIVATE may be in any list if they
 * keep the value they have in `values`. */
sv_status sv_params_apply(sv_diag *diag, const char *call, const sv_param_value *list, uint32_t count,
                          uint32_t required, bool activating, sv_values *values);

/* ---- what the host hands over: SV_OK, or an error that names the field and its value (validate.c) */

/* `planned`: the format is one to be, and its OpenCL objects may still be missing. */
sv_status sv_validate_format(sv_diag *diag, const sv_format *format, bool planned);
sv_status sv_validate_frame(sv_diag *diag, const sv_pipeline *pipeline, const sv_frame *frame);
/* Refuses values that do not go together in a frame of this pipeline. */
sv_status sv_validate_values(sv_diag *diag, const sv_pipeline *pipeline, const sv_values *values);
sv_status sv_validate_slab(sv_diag *diag, const sv_pipeline *pipeline, const sv_slab *slab);
sv_status sv_validate_result(sv_diag *diag, const char *call, const sv_pipeline *pipeline,
                             const sv_result *result);

/* ---- extensions that the plugin offers (extensions.c) */

/* Their ids, ended by NULL, for the descriptor. */
extern const char *const sv_extension_ids[];

/* The const table of an extension, or NULL for an unknown id. */
const void *sv_extension(const char *id);

#endif
