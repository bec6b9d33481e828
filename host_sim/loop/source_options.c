/* SPDX-License-Identifier: MIT */
#include "loop/source_options.h"

#include "base/cli.h"

bool hs_source_take_probe(void *target, const char *text, hs_error *err) {
    const char *names[HS_PROBE_COUNT];
    hs_metaimage_options *const read = target;
    uint32_t index = 0;
    for (int i = 0; i < HS_PROBE_COUNT; i++) names[i] = hs_probe_name((hs_probe)i);
    if (!hs_cli_select("--probe", text, names, HS_PROBE_COUNT, &index, err)) return false;
    read->probe = (hs_probe)index;
    return (read->has_probe = true);
}

bool hs_source_take_spacing(void *target, const char *text, hs_error *err) {
    hs_metaimage_options *const read = target;
    return read->has_spacing =
               hs_cli_numbers("--spacing", text, "X,Y,Z (mm)", 1e-6, 1e6, 3, 3, read->spacing, err);
}
