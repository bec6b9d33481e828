/* SPDX-License-Identifier: MIT */
#include "core/paths.h"
#include "core/system.h"

#include <stdio.h>
#include <string.h>

bool hs_path_beside_program(const char *name, char *out, size_t bytes) {
    char self[SYS_PATH];
    out[0] = '\0';
    if (!sys_program(self, sizeof self)) return false;
    char *slash = strrchr(self, '/');
    if (!slash) return false;
    *slash = '\0';
    const int written = snprintf(out, bytes, "%s/%s", self, name);
    if (written >= 0 && (size_t)written < bytes) return true;
    out[0] = '\0';
    return false;
}
