/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "core/cli.h"
#include "core/options.h"
#include "core/text.h"
#include "guarded/guard_options.h"
#include "guarded/guarded.h"
#include "plugin/loader_param.h"
#include "smartvis/lookup.h"

#include <stdio.h>
#include <string.h>

#define MAX_SETS  64u
#define MAX_NAMES 64u /* of an enum; one with more is shown as a range */

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

/* "0 .. 1.5" or, for an enum, all its names. */
static void range_text(const hs_plugin *plugin, const sv_param_info *info, char *out, size_t bytes) {
    const uint32_t names = hs_plugin_enum_count(info);
    char low[HS_ENUM_NAME], high[HS_ENUM_NAME];
    double value;
    size_t used = 0;
    if (names == 0 || names > MAX_NAMES) {
        hs_plugin_value_text(plugin, info, info->min_value, low, sizeof low);
        hs_plugin_value_text(plugin, info, info->max_value, high, sizeof high);
        (void)snprintf(out, bytes, "%s .. %s", low, high);
        return;
    }
    for (uint32_t i = 0; i < names && used < bytes; i++)
        if (hs_plugin_enum_at(plugin, info, i, &value, low, sizeof low))
            used += (size_t)snprintf(out + used, bytes - used, "%s%s", used ? " | " : "", low);
}

/* What to print of a plugin. */
typedef struct {
    const char *path;
    const char *sets[MAX_SETS];
    uint32_t set_count;
    bool all;
    hs_guard_options guard;
} list_line;

static void print_parameter(const hs_plugin *plugin, const sv_param_info *info) {
    char flags[64], range[256], value[64];
    flag_names(info->flags, flags, sizeof flags);
    range_text(plugin, info, range, sizeof range);
    hs_plugin_value_text(plugin, info, info->default_value, value, sizeof value);
    hs_print(stdout, "  %-16s %s%s%s%s\n", info->key, info->label, flags[0] ? " (" : "", flags,
             flags[0] ? ")" : "");
    hs_print(stdout, "  %-16s %s, %s%s%s, default %s\n", "", type_name(info->type), range,
             info->unit[0] ? " " : "", info->unit, value);
    hs_print(stdout, "  %-16s %s\n", "", info->help);
}

static bool read_parameter(const hs_plugin *plugin, uint32_t index, sv_param_info *info, hs_error *err) {
    const sv_plugin *p = plugin->instance;
    *info = (sv_param_info){.size = sizeof *info};
    if (!hs_plugin_check(plugin, p->param_info(p, index, info), "param_info", err)) return false;
    return (info->key && info->label && info->unit && info->help && info->group) ||
           hs_fail(err, HS_ERR_PLUGIN, "%s: parameter %u: key, label, unit, help or group is NULL",
                   plugin->path, index);
}

/* The parameters of one group, in the plugin's order: those that matter with these values, or all of them. */
static bool print_group(const hs_plugin *plugin, const char *group, const list_line *line,
                        const sv_param_value *values, uint32_t *left_out, hs_error *err) {
    const sv_plugin *p = plugin->instance;
    bool headed = false;
    for (uint32_t i = 0; i < hs_plugin_param_count(plugin); i++) {
        sv_param_info info;
        if (!read_parameter(plugin, i, &info, err)) return false;
        if (strcmp(info.group, group) != 0) continue;
        if (!line->all && !sv_lookup_matters(p, &info, values, line->set_count)) {
            ++*left_out;
            continue;
        }
        if (!headed && group[0]) hs_print(stdout, "%s\n", group);
        headed = true;
        print_parameter(plugin, &info);
    }
    if (headed) (void)printf("\n");
    return true;
}

/* True if no parameter before `index` is of this group. */
static bool is_first_of(const sv_plugin *p, uint32_t index, const char *group) {
    for (uint32_t i = 0; i < index; i++) {
        sv_param_info info;
        if (sv_lookup_index(p, i, &info) && info.group && strcmp(info.group, group) == 0) return false;
    }
    return true;
}

static void print_names(const char *what, uint32_t bits, uint32_t first, const char *const *names,
                        uint32_t count) {
    const char *between = " ";
    hs_print(stdout, "  %-14s", what);
    for (uint32_t i = 0; i < count; i++) {
        if (!(bits >> (first + i) & 1u)) continue;
        hs_print(stdout, "%s%s", between, names[i]);
        between = ", ";
    }
    hs_print(stdout, "%s\n", bits ? "" : " none");
}

static void print_capabilities(const sv_descriptor *d) {
    static const char *const carriers[] = {"host memory", "OpenCL buffer", "OpenCL image"};
    static const char *const voxels[] = {"8 bits", "16 bits"};
    static const char *const queues[] = {"its own", "the host's"};
    static const char *const features[] = {"scanned ranges", "padding value", "adjust", "the probe's place"};
    print_names("slabs in", d->carriers, SV_CARRIER_HOST, carriers, 3);
    print_names("voxels of", d->voxel_types, SV_VOXEL_U8, voxels, 2);
    print_names("on a queue of", d->queues, 0, queues, 2);
    print_names("makes use of", d->features, 0, features, 4);
    hs_print(stdout, "  %-14s", "extensions");
    for (uint32_t i = 0; d->extensions && d->extensions[i]; i++)
        hs_print(stdout, "%s%s", i ? ", " : " ", d->extensions[i]);
    hs_print(stdout, "%s\n\n", d->extensions && d->extensions[0] ? "" : " none");
}

/* What a cube of so many voxels in slabs of 16 slices takes. False if the plugin refuses these values. */
static bool ask_needs(const sv_plugin *p, const sv_param_value *values, uint32_t count, uint32_t side,
                      const sv_needs_device *device, sv_needs *out) {
    sv_param_value fixed[MAX_SETS], own[MAX_SETS];
    uint32_t fixed_count = 0, own_count = 0;
    for (uint32_t i = 0; i < count; i++)
        if (hs_plugin_is_fixed(p, values[i].id))
            fixed[fixed_count++] = values[i];
        else
            own[own_count++] = values[i];
    const sv_format format = {.size = sizeof format,
                              .width = side,
                              .height = side,
                              .slices = side,
                              .max_slab_slices = 16,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 4,
                              .tile_w = side,
                              .tile_h = side,
                              .row_pitch = 4 * side,
                              .values = fixed,
                              .value_count = fixed_count};
    *out = (sv_needs){.size = sizeof *out};
    return hs_plugin_needs(p)->of(p, &format, own, own_count, device, out) == SV_OK;
}

/* What the plugin takes on two kinds of machines, of which neither need be here. */
static void print_needs(const sv_plugin *p, const sv_param_value *values, uint32_t count) {
    static const struct {
        const char *name;
        sv_needs_device facts;
    } devices[] = {{"a CPU of 8 cores",
                    {sizeof(sv_needs_device), SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES, 8, 0}},
                   {"a GPU of 32 units", {sizeof(sv_needs_device), SV_NEEDS_DOUBLES, 32, 0}}};
    sv_needs needs;
    for (size_t i = 0; hs_plugin_needs(p) && i < sizeof devices / sizeof *devices; i++)
        for (uint32_t side = 128; side <= 256; side *= 2)
            if (ask_needs(p, values, count, side, &devices[i].facts, &needs))
                hs_print(stdout, "  %-14s %u^3 on %s: %.1f MiB of buffers, %u commands a frame\n",
                         i == 0 && side == 128 ? "takes for" : "", side, devices[i].name,
                         (double)needs.device_bytes / (1 << 20), needs.commands);
}

static bool print_plugin(const list_line *line, const sv_descriptor *d, hs_error *err) {
    hs_plugin plugin;
    sv_param_value values[MAX_SETS];
    if (!hs_guarded_open(&plugin, line->path, d->id, SV_LOG_WARNING, &line->guard, err)) return false;
    const sv_plugin *p = plugin.instance;
    const uint32_t count = hs_plugin_param_count(&plugin);
    bool ok = true;
    for (uint32_t i = 0; ok && i < line->set_count; i++)
        ok = hs_plugin_parse_param(&plugin, line->sets[i], &values[i], err);
    if (ok) {
        hs_print(stdout, "%s %s: %s\n  %s\n  vendor %s; %u parameters\n", d->id, d->version, d->name,
                 d->summary, d->vendor, count);
        print_capabilities(d);
        print_needs(p, values, line->set_count);
        hs_print(stdout, "%s", hs_plugin_needs(p) ? "\n" : "");
    }
    uint32_t left_out = 0;
    for (uint32_t i = 0; ok && i < count; i++) {
        sv_param_info info;
        ok = read_parameter(&plugin, i, &info, err) &&
             (!is_first_of(p, i, info.group) ||
              print_group(&plugin, info.group, line, values, &left_out, err));
    }
    if (ok && left_out > 0)
        (void)printf("%u more parameters do not matter with these values; --all prints them.\n\n", left_out);
    return hs_guarded_close(&plugin, err) && ok;
}

static bool print_library(const list_line *line, hs_error *err) {
    hs_plugin first;
    if (!hs_guarded_open(&first, line->path, NULL, SV_LOG_WARNING, &line->guard, err)) return false;
    hs_print(stdout, "%s: ABI %u.%u, %u plugin%s\n\n", first.path, first.abi_major, first.abi_minor,
             first.count, first.count == 1 ? "" : "s");
    bool ok = true;
    for (uint32_t i = 0; ok && i < first.count; i++) ok = print_plugin(line, first.descriptor[i], err);
    return hs_guarded_close(&first, err) && ok;
}

static bool take_set(void *target, const char *text, hs_error *err) {
    list_line *const line = target;
    return hs_cli_append("--set", text, line->sets, &line->set_count, MAX_SETS, err);
}

#define AT(field) offsetof(list_line, field)
static const hs_option options[] = {
    HS_TEXT("plugin", "PATH", AT(path), "library to load, a path or a name [smartvis]"),
    HS_TAKEN("set", "KEY=VALUE", 0, take_set,
             "a parameter's value, for what depends on it; repeatable [the defaults]"),
    HS_FLAG("all", AT(all), "all parameters"),
    HS_GUARD_ROWS(AT(guard)),
    HS_OPTIONS_END,
};

static const char usage[] =
    "Usage: host_sim list [--plugin PATH] [--set KEY=VALUE ...] [--all]\n"
    "Prints every plugin of a library, what it can do, and its parameters by groups; needs no "
    "OpenCL device.\n"
    "Parameters that do not matter with the values of the others are left out.\n\n";

static const char flags[] =
    "Flags: primary = the one that every user sees; expert = for advanced users;\n"
    "       reactivate = read at activation only; adjust = may change without a new volume\n\n";

int hs_cmd_list(int argc, char **argv) {
    char path[1024];
    hs_error err = {0};
    int next = argc;
    bool help = false;
    hs_plugin_default_path(path, sizeof path);
    list_line line = {.path = path};
    hs_guard_defaults(&line.guard);
    if (!hs_options_read(argc, argv, options, &line, &next, &help, &err)) return hs_cli_fail("list", &err);
    if (help) return hs_options_help(usage, options, flags);
    if (!hs_cli_no_more(argc, argv, next, &err) || !print_library(&line, &err))
        return hs_cli_fail("list", &err);
    return HS_OK;
}
