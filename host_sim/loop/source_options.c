/* SPDX-License-Identifier: MIT */
#include "loop/source_options.h"

#include "core/cli.h"

#include <string.h>

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

bool hs_source_take_either_spacing(void *target, const char *text, hs_error *err) {
    hs_source_files *const files = target;
    return strchr(text, ',') ? hs_source_take_spacing(&files->metaimage, text, err)
                             : hs_cli_number("--spacing", text, 0.01, 100, &files->kretz.spacing, err);
}
