/* SPDX-License-Identifier: MIT */
#include "commands/run_value.h"

#include "base/cli.h"

#include <string.h>

bool hs_value_float(const char *option, const char *text, double low, double high, float *out,
                    hs_error *err) {
    double value;
    if (!hs_cli_number(option, text, low, high, &value, err)) return false;
    *out = (float)value;
    return true;
}

bool hs_value_window(const char *text, hs_metaimage_options *read, hs_error *err) {
    double ends[2];
    if (!hs_cli_pair("--window", text, "LOW,HIGH", -1e12, 1e12, ends, err)) return false;
    read->has_window = true;
    read->window_low = ends[0];
    read->window_high = ends[1];
    return ends[0] < ends[1] || hs_fail(err, HS_ERR_USAGE, "--window: %s: LOW must be less than HIGH", text);
}

bool hs_value_scanned(const char *text, char *first, size_t bytes, hs_source_scanned *out, hs_error *err) {
    const char *comma = strchr(text, ',');
    const size_t length = comma ? (size_t)(comma - text) : 0;
    if (length == 0 || length >= bytes || comma[1] == '\0' || strchr(comma + 1, ','))
        return hs_fail(err, HS_ERR_USAGE, "--scanned: '%s', expected two files, FIRST,END", text);
    memcpy(first, text, length);
    first[length] = '\0';
    *out = (hs_source_scanned){first, comma + 1};
    return true;
}

bool hs_value_probe(const char *text, hs_metaimage_options *read, hs_error *err) {
    const char *names[HS_PROBE_COUNT];
    uint32_t index = 0;
    for (int i = 0; i < HS_PROBE_COUNT; i++) names[i] = hs_probe_name((hs_probe)i);
    if (!hs_cli_pick("--probe", text, names, HS_PROBE_COUNT, &index, err)) return false;
    read->has_probe = true;
    read->probe = (hs_probe)index;
    return true;
}

bool hs_value_view(const char *text, hs_loop_options *loop, hs_error *err) {
    const char *names[HS_FROM_COUNT];
    uint32_t index = 0;
    for (int i = 0; i < HS_FROM_COUNT; i++) names[i] = hs_from_name((hs_from)i);
    if (!hs_cli_pick("--view", text, names, HS_FROM_COUNT, &index, err)) return false;
    loop->from = (hs_from)index;
    return true;
}
