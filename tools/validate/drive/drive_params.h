/* SPDX-License-Identifier: MIT */
/* A plugin's parameters as checks use them: what it reports, bounded, and values to try. */
#ifndef DRIVE_PARAMS_H
#define DRIVE_PARAMS_H

#include "validate/drive/drive_subject.h"

#define V_MAX_PARAMS 256u

typedef struct {
    uint32_t count;
    sv_param_info info[V_MAX_PARAMS];
} v_params;

/* The parameters that describe themselves well enough to be used; what else is wrong with them, the checks of
 * parameters find. */
void v_params_read(v_subject *s, v_params *params);

/* The distance of two values; 0 for a float without steps. */
double v_param_step(const sv_param_info *info);

/* Number of values of an int, bool or enum; 0 for a float, or if they are more than 10^6. */
uint32_t v_param_values(const sv_param_info *info);

/* A value of the parameter: anywhere in the hard range, an end now and then. */
double v_param_random(v_run *run, const sv_param_info *info);

/* A value that is not the default, or the default if there is no other. */
double v_param_other(const sv_param_info *info);

#endif
