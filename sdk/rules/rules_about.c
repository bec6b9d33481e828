/* SPDX-License-Identifier: MIT */
/* Judges of how a plugin describes itself. */
#include "rules/rules.h"

#include <math.h>
#include <string.h>

enum { MAX_EXTENSIONS = 256 };

void rule_entry(const rule_sink *to, const sv_entry *e) {
    RULE_EXPECT(to, RULE_entry_whole, e->abi_major == SV_ABI_MAJOR, "entry.abi_major is %u, expected %u",
                e->abi_major, SV_ABI_MAJOR);
    RULE_EXPECT(to, RULE_entry_whole, e->size >= sizeof *e, "entry.size is %u, expected at least %zu",
                e->size, sizeof *e);
    RULE_EXPECT(to, RULE_entry_whole, e->count >= 1 && e->count <= RULE_MAX_PLUGINS,
                "entry.count is %u, expected 1 to %d", e->count, RULE_MAX_PLUGINS);
    RULE_EXPECT(to, RULE_entry_whole, e->descriptor && e->create, "entry.%s is NULL",
                e->descriptor ? "create" : "descriptor");
}

static void rule_texts(const rule_sink *to, uint32_t index, const sv_descriptor *d) {
    const struct {
        const char *field, *text;
    } list[] = {{"id", d->id},
                {"name", d->name},
                {"vendor", d->vendor},
                {"version", d->version},
                {"summary", d->summary}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        RULE_EXPECT(to, RULE_descriptors, list[i].text, "descriptor %u: %s is NULL", index, list[i].field);
        RULE_EXPECT(to, RULE_descriptors, rule_is_text(list[i].text, RULE_MAX_TEXT),
                    "descriptor %u: %s is not UTF-8 text of at most %d bytes without control characters",
                    index, list[i].field, RULE_MAX_TEXT);
        RULE_EXPECT(to, RULE_descriptors, i > 1 || list[i].text[0], "descriptor %u: %s is empty", index,
                    list[i].field);
    }
}

static void rule_bits(const rule_sink *to, uint32_t index, const sv_descriptor *d) {
    const struct {
        const char *field;
        uint32_t value, known, needed;
    } list[] = {{"carriers", d->carriers,
                 SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) | SV_BIT(SV_CARRIER_IMAGE),
                 SV_BIT(SV_CARRIER_HOST)},
                {"voxel_types", d->voxel_types, SV_BIT(SV_VOXEL_U8) | SV_BIT(SV_VOXEL_U16), 0},
                {"queues", d->queues, SV_QUEUE_OWN | SV_QUEUE_HOST, 0},
                {"features", d->features,
                 SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST | SV_FEATURE_PROBE, 0},
                {"reserved", d->reserved, 0, 0}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        RULE_EXPECT(to, RULE_descriptors, (list[i].value & ~list[i].known) == 0,
                    "descriptor %u: %s is 0x%x, only 0x%x is known", index, list[i].field, list[i].value,
                    list[i].known);
        RULE_EXPECT(to, RULE_descriptors, (list[i].value & list[i].needed) == list[i].needed,
                    "descriptor %u: %s is 0x%x, expected it to hold 0x%x", index, list[i].field,
                    list[i].value, list[i].needed);
    }
    RULE_EXPECT(to, RULE_descriptors, d->voxel_types && d->queues,
                "descriptor %u: %s is 0: nobody can use the plugin", index,
                d->queues ? "voxel_types" : "queues");
    RULE_EXPECT(to, RULE_descriptors, d->queues & SV_QUEUE_HOST || d->carriers == SV_BIT(SV_CARRIER_HOST),
                "descriptor %u: carriers is 0x%x, but OpenCL objects need SV_QUEUE_HOST", index, d->carriers);
}

static void rule_extensions(const rule_sink *to, uint32_t index, const sv_descriptor *d) {
    RULE_EXPECT(to, RULE_descriptors, d->extensions, "descriptor %u: extensions is NULL", index);
    for (uint32_t i = 0; d->extensions[i]; i++) {
        RULE_EXPECT(to, RULE_descriptors, i < MAX_EXTENSIONS,
                    "descriptor %u: extensions has no NULL among its first %d entries", index,
                    MAX_EXTENSIONS);
        RULE_EXPECT(to, RULE_descriptors,
                    rule_is_text(d->extensions[i], RULE_MAX_TEXT) && strchr(d->extensions[i], '/'),
                    "descriptor %u: extension %u is not of the form name/revision", index, i);
    }
}

void rule_descriptors(const rule_sink *to, const sv_entry *entry) {
    const uint32_t count = entry->count < RULE_MAX_PLUGINS ? entry->count : RULE_MAX_PLUGINS;
    for (uint32_t i = 0; i < count; i++) {
        const sv_descriptor *d = entry->descriptor(i);
        RULE_EXPECT(to, RULE_descriptors, d, "descriptor(%u) is NULL, and entry.count is %u", i,
                    entry->count);
        RULE_EXPECT(to, RULE_descriptors, d->size >= sizeof *d,
                    "descriptor %u: size is %u, expected at least %zu", i, d->size, sizeof *d);
        rule_texts(to, i, d);
        rule_bits(to, i, d);
        rule_extensions(to, i, d);
        if (!d->id) return;
        for (uint32_t k = 0; k < i; k++)
            RULE_EXPECT(to, RULE_descriptors, strcmp(entry->descriptor(k)->id, d->id) != 0,
                        "descriptors %u and %u have one id, %s", k, i, d->id);
    }
    RULE_EXPECT(to, RULE_descriptors, !entry->descriptor(entry->count) && !entry->descriptor(UINT32_MAX),
                "descriptor(%u) is not NULL, and entry.count is %u", entry->count, entry->count);
}

void rule_instance(const rule_sink *to, const sv_plugin *p) {
    RULE_EXPECT(to, RULE_instance_whole, p->size >= sizeof *p, "instance.size is %u, expected at least %zu",
                p->size, sizeof *p);
    RULE_EXPECT(to, RULE_instance_whole,
                p->descriptor && p->destroy && p->activate && p->deactivate && p->begin && p->slab &&
                    p->end && p->adjust && p->param_count && p->param_info && p->param_text &&
                    p->last_error && p->get_extension,
                "a function or the descriptor of the instance is NULL");
    RULE_EXPECT(to, RULE_instance_whole, p->reserved == 0, "instance.reserved is %u", p->reserved);
}

void rule_param_ids(const rule_sink *to, const rule_params *params, uint32_t told) {
    for (uint32_t i = 0; i < params->count; i++) {
        RULE_EXPECT(to, RULE_param_ids, params->info[i].id != 0, "the id of parameter %u is 0", i);
        for (uint32_t k = 0; k < i; k++)
            RULE_EXPECT(to, RULE_param_ids, params->info[k].id != params->info[i].id,
                        "parameters %u and %u have one id, %u", k, i, params->info[i].id);
    }
    RULE_EXPECT(to, RULE_param_ids, told <= RULE_MAX_PARAMS,
                "param_count is %u, and no host takes more than %d", told, RULE_MAX_PARAMS);
}

static bool is_key(const char *key) {
    return key[0] && strlen(key) <= 63 && strspn(key, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(key);
}

void rule_param_strings(const rule_sink *to, const rule_params *params) {
    for (uint32_t i = 0; i < params->count; i++) {
        const sv_param_info *p = &params->info[i];
        const struct {
            const char *field, *text;
        } list[] = {
            {"key", p->key}, {"label", p->label}, {"unit", p->unit}, {"help", p->help}, {"group", p->group}};
        for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
            RULE_EXPECT(to, RULE_param_strings, list[k].text, "parameter %u: %s is NULL", i, list[k].field);
            RULE_EXPECT(to, RULE_param_strings, rule_is_text(list[k].text, RULE_MAX_TEXT),
                        "parameter %u: %s is not UTF-8 text without control characters", i, list[k].field);
        }
        RULE_EXPECT(to, RULE_param_strings, is_key(p->key),
                    "parameter %u: the key '%s' is not [a-z0-9_]+ of at most 63 bytes", i, p->key);
        for (uint32_t k = 0; k < i; k++)
            RULE_EXPECT(to, RULE_param_strings, strcmp(params->info[k].key, p->key) != 0,
                        "parameters %u and %u have one key, %s", k, i, p->key);
    }
}

/* On the grid min_value + n * step. */
static bool is_on_step(const sv_param_info *p, double value) {
    const double n = (value - p->min_value) / p->step;
    return n == floor(n);
}

void rule_param_ranges(const rule_sink *to, const rule_params *params) {
    for (uint32_t i = 0; i < params->count; i++) {
        const sv_param_info *p = &params->info[i];
        const char *key = p->key ? p->key : "";
        RULE_EXPECT(to, RULE_param_ranges, p->type <= SV_PARAM_ENUM,
                    "parameter %u, %s: type is %u, expected 0 to 3", i, key, p->type);
        RULE_EXPECT(to, RULE_param_ranges,
                    isfinite(p->min_value) && isfinite(p->max_value) && p->min_value <= p->max_value,
                    "parameter %u, %s: the hard range is %g to %g", i, key, p->min_value, p->max_value);
        RULE_EXPECT(to, RULE_param_ranges,
                    p->default_value >= p->min_value && p->default_value <= p->max_value,
                    "parameter %u, %s: the default is %g, the hard range %g to %g", i, key, p->default_value,
                    p->min_value, p->max_value);
        RULE_EXPECT(to, RULE_param_ranges,
                    p->display_min >= p->min_value && p->display_min <= p->display_max &&
                        p->display_max <= p->max_value,
                    "parameter %u, %s: the display range is %g to %g, the hard range %g to %g", i, key,
                    p->display_min, p->display_max, p->min_value, p->max_value);
        RULE_EXPECT(to, RULE_param_ranges, isfinite(p->step) && p->step >= 0.0,
                    "parameter %u, %s: step is %g", i, key, p->step);
        if (p->type == SV_PARAM_FLOAT) continue;
        RULE_EXPECT(to, RULE_param_ranges, p->step > 0.0,
                    "parameter %u, %s: step is %g, and its type is not float", i, key, p->step);
        RULE_EXPECT(to, RULE_param_ranges, is_on_step(p, p->default_value) && is_on_step(p, p->max_value),
                    "parameter %u, %s: the default %g or the greatest value %g is not %g + n * %g", i, key,
                    p->default_value, p->max_value, p->min_value, p->step);
        RULE_EXPECT(to, RULE_param_ranges,
                    p->type != SV_PARAM_BOOL ||
                        (p->min_value == 0.0 && p->max_value == 1.0 && p->step == 1.0),
                    "parameter %u, %s: a bool of %g to %g in steps of %g", i, key, p->min_value, p->max_value,
                    p->step);
    }
}

static const sv_param_info *find(const rule_params *params, uint32_t id) {
    for (uint32_t i = 0; i < params->count; i++)
        if (params->info[i].id == id) return &params->info[i];
    return NULL;
}

void rule_param_dependencies(const rule_sink *to, const rule_params *params) {
    for (uint32_t i = 0; i < params->count; i++) {
        const sv_param_info *p = &params->info[i];
        const char *key = p->key ? p->key : "";
        RULE_EXPECT(to, RULE_param_dependencies, p->reserved == 0, "parameter %u, %s: reserved is %u", i, key,
                    p->reserved);
        for (uint32_t steps = 0; p->depends_on != 0; steps++) {
            const sv_param_info *on = find(params, p->depends_on);
            RULE_EXPECT(to, RULE_param_dependencies, on,
                        "parameter %u, %s: depends_on is %u, and no parameter has that id", i, key,
                        p->depends_on);
            RULE_EXPECT(to, RULE_param_dependencies, on->type != SV_PARAM_FLOAT,
                        "parameter %u, %s: depends on %u, a float", i, key, p->depends_on);
            RULE_EXPECT(to, RULE_param_dependencies, p->depends_values != 0,
                        "parameter %u, %s: never matters: depends_values is 0", i, key);
            RULE_EXPECT(to, RULE_param_dependencies, steps < params->count,
                        "parameter %u, %s: depends on itself", i, key);
            p = on;
        }
    }
}

void rule_param_flags(const rule_sink *to, const rule_params *params, const sv_descriptor *descriptor) {
    const uint32_t known = SV_PARAM_PRIMARY | SV_PARAM_EXPERT | SV_PARAM_REACTIVATE | SV_PARAM_ADJUST;
    uint32_t primaries = 0, adjustable = 0;
    for (uint32_t i = 0; i < params->count; i++) {
        const uint32_t flags = params->info[i].flags;
        RULE_EXPECT(to, RULE_param_flags, (flags & ~known) == 0,
                    "parameter %u: flags is 0x%x, only 0x%x is known", i, flags, known);
        RULE_EXPECT(to, RULE_param_flags, !(flags & SV_PARAM_REACTIVATE) || !(flags & SV_PARAM_ADJUST),
                    "parameter %u: only activate reads it, and adjust accepts it", i);
        primaries += (flags & SV_PARAM_PRIMARY) != 0;
        adjustable += (flags & SV_PARAM_ADJUST) != 0;
    }
    RULE_EXPECT(to, RULE_param_flags, primaries <= 1,
                "%u parameters are flagged SV_PARAM_PRIMARY, expected at most one", primaries);
    RULE_EXPECT(to, RULE_param_flags, (adjustable > 0) == ((descriptor->features & SV_FEATURE_ADJUST) != 0),
                "%u parameters are flagged SV_PARAM_ADJUST, and the descriptor says %s", adjustable,
                adjustable ? "that there are none" : "that there are some");
}
