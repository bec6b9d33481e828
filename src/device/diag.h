/* SPDX-License-Identifier: MIT */
/* Failures: the reason of the last one, kept for last_error and told to the host's log; checked OpenCL calls,
 * whose failures carry the call's name and the code's name. */
#ifndef SV_DIAG_H
#define SV_DIAG_H

#include "smartvis_plugin.h"

#include <CL/cl.h>

typedef struct {
    const sv_host *host; /* may be NULL in tests */
    char last_error[512];
} sv_diag;

/* Keeps the reason, logs it with the given severity, and returns `status`. */
sv_status sv_report(sv_diag *diag, int32_t severity, sv_status status, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Reports a failure that is nobody's misbehaviour. */
#define sv_fail(diag, status, ...) sv_report(diag, SV_LOG_ERROR, status, __VA_ARGS__)
/* Reports that the host broke a rule of the header. */
#define sv_blame_host(diag, status, ...) sv_report(diag, SV_LOG_HOST_MISBEHAVING, status, __VA_ARGS__)

/* Writes one line to the host's log, without an error. */
void sv_log(const sv_diag *diag, int32_t severity, const char *text);

/* Name of an OpenCL error code, "CL_INVALID_VALUE". */
const char *sv_clx_name(cl_int code);

/* SV_OK for CL_SUCCESS, else SV_ERR_OPENCL with "what: CL_..., -30". */
sv_status sv_clx_check(sv_diag *diag, cl_int code, const char *what);

#endif
