/* SPDX-License-Identifier: MIT */
#include "loop/source_options.h"

#include "base/cli.h"

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
    const char *rest = strchr(text, ',');
    char first[64];
    double ends[2];
    if (!rest || (size_t)(rest - text) >= sizeof first)
        return hs_fail(err, HS_ERR_USAGE, "--spacing: '%s', expected X,Y,Z (mm)", text);
    memcpy(first, text, (size_t)(rest - text));
    first[rest - text] = '\0';
    if (!hs_cli_number("--spacing", first, 1e-6, 1e6, &read->spacing[0], err) ||
        !hs_cli_pair("--spacing", rest + 1, "X,Y,Z (mm)", 1e-6, 1e6, ends, err))
        return false;
    read->spacing[1] = ends[0];
    read->spacing[2] = ends[1];
    return (read->has_spacing = true);
}
