/* SPDX-License-Identifier: MIT */
/* Checked OpenCL calls: every failure carries the call's name and the code's name. */
#ifndef SV_CLX_H
#define SV_CLX_H

#include "device/diag.h"

#include <CL/cl.h>

/* Name of an OpenCL error code, "CL_INVALID_VALUE". */
const char *sv_clx_name(cl_int code);

/* SV_OK for CL_SUCCESS, else SV_ERR_OPENCL with "what: CL_..., -30". */
sv_status sv_clx_check(sv_diag *diag, cl_int code, const char *what);

#endif
