/* SPDX-License-Identifier: MIT */
/* The plugin's parameters as the host sees them: one table that describes them, and the checks of
 * what it sends. */
#ifndef SV_PARAMS_H
#define SV_PARAMS_H

#include "device/diag.h"
#include "method/values.h"

#include <stdbool.h>

uint32_t sv_params_count(void);
sv_status sv_params_info(sv_diag *diag, uint32_t index, sv_param_info *out);
sv_status sv_params_text(sv_diag *diag, uint32_t id, double value, char *out, uint32_t bytes);

void sv_params_defaults(sv_values *values);

/* Writes a list of values over `values`, all or none. `call` names the ABI call for messages. Only parameters
 * with all of `required` flags may be in the list; those with SV_PARAM_REACTIVATE may be in any list if they
 * keep the value they have in `values`. */
sv_status sv_params_apply(sv_diag *diag, const char *call, const sv_param_value *list, uint32_t count,
                          uint32_t required, bool activating, sv_values *values);

#endif
