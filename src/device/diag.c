/* SPDX-License-Identifier: MIT */
#include "device/diag.h"

#include <stdarg.h>
#include <stdio.h>

void sv_log(const sv_diag *diag, int32_t severity, const char *text) {
    if (diag->host && diag->host->log) diag->host->log(diag->host, severity, text);
}

sv_status sv_report(sv_diag *diag, int32_t severity, sv_status status, const char *format, ...) {
    va_list args;
    va_start(args, format);
    (void)vsnprintf(diag->last_error, sizeof diag->last_error, format, args);
    va_end(args);
    sv_log(diag, severity, diag->last_error);
    return status;
}
