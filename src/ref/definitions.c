/* SPDX-License-Identifier: MIT */
#include "ref/definitions.h"

#include "ref/ref_chain.h"

#include <string.h>

bool sv_define_surface(const char *method, const uint8_t *status, const double *depth, uint32_t width,
                       uint32_t height, uint32_t kernel, uint32_t merge_grid, double *surface) {
    sv_ref_settings settings = sv_ref_default_settings;
    settings.kernel = kernel;
    settings.merge_grid = merge_grid;
    const sv_ref_task task = {.map = {status, depth, width, height}, .settings = &settings};
    for (uint32_t m = 0; m < SV_METHOD_END; m++) {
        const sv_ref_method *const definition = sv_ref_method_of(m);
        if (definition && !definition->takes_volume && strcmp(sv_ref_method_name(m), method) == 0)
            return sv_ref_chain(definition, &task, surface);
    }
    return false;
}
