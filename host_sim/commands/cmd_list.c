/* SPDX-License-Identifier: MIT */
#include "commands/cmd_list.h"

#include "base/cli.h"
#include "plugin/loader_param.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

#define MAX_NAMES 64u /* of an enum; one with more is shown as a range */

static const char help_text[] =
    "Usage: host_sim list [--plugin PATH]\n"
    "Prints every plugin of a library and its parameters; needs no OpenCL device.\n"
    "\n"
    "  --plugin PATH   library to load [smartvis.so beside host_sim]\n"
    "  --help          this text\n"
    "\n"
    "Flags: primary = the one knob a user sees; expert = for advanced users;\n"
    "       reactivate = read at activation only; adjust = may change without a new volume\n"
    "\n";

static const char *type_name(uint32_t type) {
    static const char *const names[] = {"float", "int", "bool", "enum"};
    return type <= SV_PARAM_ENUM ? names[type] : "unknown type";
}

static void flag_names(uint32_t flags, char *out, size_t bytes) {
    static const char *const names[] = {"primary", "expert", "reactivate", "adjust"};
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t bit = 0; bit < 4 && used < bytes; bit++)
        if (flags & (1u << bit))
            used += (size_t)snprintf(out + used, bytes - used, "%s%s", used ? ", " : "", names[bit]);
}

/* A value as the plugin itself words it. */
static void value_text(const sv_plugin *p, const sv_param_info *info, double value, char *out,
                       uint32_t bytes) {
    if (p->param_text(p, info->id, value, out, bytes) != SV_OK) (void)snprintf(out, bytes, "%g", value);
}

/* "0 .. 1.5" or, for an enum, all its names. */
static void range_text(const hs_plugin *plugin, const sv_param_info *info, char *out, size_t bytes) {
    const uint32_t names = hs_plugin_enum_count(info);
    char low[HS_ENUM_NAME], high[HS_ENUM_NAME];
    double value;
    size_t used = 0;
    if (names == 0 || names > MAX_NAMES) {
        value_text(plugin->instance, info, info->min_value, low, sizeof low);
        value_text(plugin->instance, info, info->max_value, high, sizeof high);
        (void)snprintf(out, bytes, "%s .. %s", low, high);
        return;
    }
    for (uint32_t i = 0; i < names && used < bytes; i++) {
        if (!hs_plugin_enum_at(plugin, info, i, &value, low, sizeof low))
            (void)snprintf(low, sizeof low, "%g", value);
        used += (size_t)snprintf(out + used, bytes - used, "%s%s", used ? " | " : "", low);
    }
}

static void print_parameter(const hs_plugin *plugin, const sv_param_info *info) {
    char flags[64], range[256], value[64];
    flag_names(info->flags, flags, sizeof flags);
    range_text(plugin, info, range, sizeof range);
    value_text(plugin->instance, info, info->default_value, value, sizeof value);
    (void)printf("  %-16s %s%s%s%s\n", info->key, info->label, flags[0] ? " (" : "", flags,
                 flags[0] ? ")" : "");
    (void)printf("  %-16s %s, %s%s%s, default %s\n", "", type_name(info->type), range,
                 info->unit[0] ? " " : "", info->unit, value);
    (void)printf("  %-16s %s\n", "", info->help);
}

static bool print_plugin(const char *path, const sv_descriptor *d, hs_error *err) {
    hs_plugin plugin;
    if (!hs_plugin_open(&plugin, path, d->id, SV_LOG_WARNING, err)) return false;
    const sv_plugin *p = plugin.instance;
    const uint32_t count = p->param_count(p);
    (void)printf("%s %s: %s\n  %s\n  vendor %s; %u parameters\n\n", d->id, d->version, d->name, d->summary,
                 d->vendor, count);
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++) {
        sv_param_info info = {.size = sizeof info};
        ok = hs_plugin_check(&plugin, p->param_info(p, i, &info), "param_info", err);
        if (ok && (!info.key || !info.label || !info.unit || !info.help))
            ok = hs_fail(err, HS_ERR_PLUGIN, "%s: parameter %u: key, label, unit or help is NULL", path, i);
        if (ok) print_parameter(&plugin, &info);
    }
    (void)printf("\n");
    hs_plugin_close(&plugin);
    return ok;
}

static bool print_library(const char *path, hs_error *err) {
    hs_plugin first;
    if (!hs_plugin_open(&first, path, NULL, SV_LOG_WARNING, err)) return false;
    const sv_entry *entry = first.entry;
    (void)printf("%s: ABI %u.%u, %u plugin%s\n\n", path, entry->abi_major, entry->abi_minor, entry->count,
                 entry->count == 1 ? "" : "s");
    bool ok = true;
    for (uint32_t i = 0; ok && i < entry->count; i++) ok = print_plugin(path, entry->descriptor(i), err);
    hs_plugin_close(&first);
    return ok;
}

int hs_cmd_list(int argc, char **argv) {
    static const struct option options[] = {
        {"plugin", required_argument, NULL, 'p'}, {"help", no_argument, NULL, 'h'}, {0}};
    char path[1024];
    hs_error err = {0};
    hs_plugin_default_path(path, sizeof path);
    optind = 1;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", options, NULL)) != -1;) {
        if (option == 'h') {
            (void)printf("%s%s", help_text, hs_exit_codes_help);
            return HS_OK;
        }
        if (option != 'p') {
            (void)hs_fail(&err, HS_ERR_USAGE, "%s: %s", argv[optind - 1],
                          option == ':' ? "needs a value" : "not an option of this command");
            return hs_cli_fail("list", &err);
        }
        (void)snprintf(path, sizeof path, "%s", optarg);
    }
    if (!hs_cli_no_more(argc, argv, optind, &err) || !print_library(path, &err))
        return hs_cli_fail("list", &err);
    return HS_OK;
}
