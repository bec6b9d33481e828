/* SPDX-License-Identifier: MIT */
/* Checks of how parameters describe themselves. */
#include "validate/checks/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_PARAMS = 1024, MOST_TEXT = 1000 };

typedef struct {
    v_subject s;
    uint32_t count;
    sv_param_info info[MOST_PARAMS];
} table;

/* As it is reported, whatever that is. */
static table *read_table(v_run *run) {
    static table t;
    v_open(run, &t.s);
    v_where(run, "param_count");
    const uint32_t count = t.s.plugin->param_count(t.s.plugin);
    t.count = count < MOST_PARAMS ? count : MOST_PARAMS;
    for (uint32_t i = 0; i < t.count; i++) {
        t.info[i] = (sv_param_info){.size = sizeof t.info[i]};
        v_where(run, "param_info(%u)", i);
        const sv_status status = t.s.plugin->param_info(t.s.plugin, i, &t.info[i]);
        V_EXPECT(run, status == SV_OK, "param_info(%u): %s, and param_count is %u", i, v_status(status),
                 count);
    }
    return &t;
}

void check_param_ids(v_run *run) {
    table *t = read_table(run);
    const uint32_t count = t->s.plugin->param_count(t->s.plugin);
    for (uint32_t i = 0; i < t->count; i++) {
        V_EXPECT(run, t->info[i].id != 0, "the id of parameter %u is 0", i);
        for (uint32_t k = 0; k < i; k++)
            V_EXPECT(run, t->info[k].id != t->info[i].id, "parameters %u and %u have one id, %u", k, i,
                     t->info[i].id);
    }
    V_EXPECT(run, count <= MOST_PARAMS, "param_count is %u, and no host takes more than %d", count,
             MOST_PARAMS);
    v_close(&t->s);
}

static bool is_key(const char *key) {
    return key[0] && strlen(key) <= 63 && strspn(key, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(key);
}

void check_param_strings(v_run *run) {
    table *t = read_table(run);
    for (uint32_t i = 0; i < t->count; i++) {
        const sv_param_info *p = &t->info[i];
        const struct {
            const char *field, *text;
        } list[] = {
            {"key", p->key}, {"label", p->label}, {"unit", p->unit}, {"help", p->help}, {"group", p->group}};
        for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
            V_EXPECT(run, list[k].text, "parameter %u: %s is NULL", i, list[k].field);
            V_EXPECT(run, v_is_text(list[k].text, MOST_TEXT),
                     "parameter %u: %s is not UTF-8 text without control characters", i, list[k].field);
        }
        V_EXPECT(run, is_key(p->key), "parameter %u: the key '%s' is not [a-z0-9_]+ of at most 63 bytes", i,
                 p->key);
        for (uint32_t k = 0; k < i; k++)
            V_EXPECT(run, strcmp(t->info[k].key, p->key) != 0, "parameters %u and %u have one key, %s", k, i,
                     p->key);
    }
    v_close(&t->s);
}

/* On the grid min_value + n * step. */
static bool is_on_step(const sv_param_info *p, double value) {
    const double n = (value - p->min_value) / p->step;
    return n == floor(n);
}

void check_param_ranges(v_run *run) {
    table *t = read_table(run);
    for (uint32_t i = 0; i < t->count; i++) {
        const sv_param_info *p = &t->info[i];
        const char *key = p->key ? p->key : "";
        V_EXPECT(run, p->type <= SV_PARAM_ENUM, "parameter %u, %s: type is %u, expected 0 to 3", i, key,
                 p->type);
        V_EXPECT(run, isfinite(p->min_value) && isfinite(p->max_value) && p->min_value <= p->max_value,
                 "parameter %u, %s: the hard range is %g to %g", i, key, p->min_value, p->max_value);
        V_EXPECT(run, p->default_value >= p->min_value && p->default_value <= p->max_value,
                 "parameter %u, %s: the default is %g, the hard range %g to %g", i, key, p->default_value,
                 p->min_value, p->max_value);
        V_EXPECT(run,
                 p->display_min >= p->min_value && p->display_min <= p->display_max &&
                     p->display_max <= p->max_value,
                 "parameter %u, %s: the display range is %g to %g, the hard range %g to %g", i, key,
                 p->display_min, p->display_max, p->min_value, p->max_value);
        V_EXPECT(run, isfinite(p->step) && p->step >= 0.0, "parameter %u, %s: step is %g", i, key, p->step);
        if (p->type == SV_PARAM_FLOAT) continue;
        V_EXPECT(run, p->step > 0.0, "parameter %u, %s: step is %g, and its type is not float", i, key,
                 p->step);
        V_EXPECT(run, is_on_step(p, p->default_value) && is_on_step(p, p->max_value),
                 "parameter %u, %s: the default %g or the greatest value %g is not %g + n * %g", i, key,
                 p->default_value, p->max_value, p->min_value, p->step);
        V_EXPECT(run,
                 p->type != SV_PARAM_BOOL || (p->min_value == 0.0 && p->max_value == 1.0 && p->step == 1.0),
                 "parameter %u, %s: a bool of %g to %g in steps of %g", i, key, p->min_value, p->max_value,
                 p->step);
    }
    v_close(&t->s);
}

static const sv_param_info *find(const table *t, uint32_t id) {
    for (uint32_t i = 0; i < t->count; i++)
        if (t->info[i].id == id) return &t->info[i];
    return NULL;
}

void check_param_dependencies(v_run *run) {
    table *t = read_table(run);
    for (uint32_t i = 0; i < t->count; i++) {
        const sv_param_info *p = &t->info[i];
        const char *key = p->key ? p->key : "";
        V_EXPECT(run, p->reserved == 0, "parameter %u, %s: reserved is %u", i, key, p->reserved);
        for (uint32_t steps = 0; p->depends_on != 0; steps++) {
            const sv_param_info *on = find(t, p->depends_on);
            V_EXPECT(run, on, "parameter %u, %s: depends_on is %u, and no parameter has that id", i, key,
                     p->depends_on);
            V_EXPECT(run, on->type != SV_PARAM_FLOAT, "parameter %u, %s: depends on %u, a float", i, key,
                     p->depends_on);
            V_EXPECT(run, p->depends_values != 0, "parameter %u, %s: never matters: depends_values is 0", i,
                     key);
            V_EXPECT(run, steps < t->count, "parameter %u, %s: depends on itself", i, key);
            p = on;
        }
    }
    v_close(&t->s);
}

void check_param_flags(v_run *run) {
    table *t = read_table(run);
    const uint32_t known = SV_PARAM_PRIMARY | SV_PARAM_EXPERT | SV_PARAM_REACTIVATE | SV_PARAM_ADJUST;
    uint32_t primaries = 0, adjustable = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        const uint32_t flags = t->info[i].flags;
        V_EXPECT(run, (flags & ~known) == 0, "parameter %u: flags is 0x%x, only 0x%x is known", i, flags,
                 known);
        V_EXPECT(run, !(flags & SV_PARAM_REACTIVATE) || !(flags & SV_PARAM_ADJUST),
                 "parameter %u: only activate reads it, and adjust accepts it", i);
        primaries += (flags & SV_PARAM_PRIMARY) != 0;
        adjustable += (flags & SV_PARAM_ADJUST) != 0;
    }
    V_EXPECT(run, primaries <= 1, "%u parameters are flagged SV_PARAM_PRIMARY, expected at most one",
             primaries);
    V_EXPECT(run, (adjustable > 0) == ((t->s.descriptor->features & SV_FEATURE_ADJUST) != 0),
             "%u parameters are flagged SV_PARAM_ADJUST, and the descriptor says %s", adjustable,
             adjustable ? "that there are none" : "that there are some");
    v_close(&t->s);
}

/* param_info of a struct of another size: the size as of 1.0 is needed, and nothing behind it is written. */
static void try_sizes(v_subject *s) {
    struct {
        sv_param_info info;
        uint8_t behind[64];
    } room;
    const uint32_t sizes[] = {0, 4, sizeof(sv_param_info) - 1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        memset(&room, 0x5a, sizeof room);
        room.info.size = sizes[i];
        v_where(s->run, "param_info into %u bytes", sizes[i]);
        const sv_status status = s->plugin->param_info(s->plugin, 0, &room.info);
        V_EXPECT(s->run, status == SV_ERR_SIZE, "param_info into %u bytes: %s, expected SV_ERR_SIZE",
                 sizes[i], v_status(status));
    }
    memset(&room, 0x5a, sizeof room);
    room.info.size = sizeof room.info;
    v_where(s->run, "param_info");
    (void)s->plugin->param_info(s->plugin, 0, &room.info);
    for (size_t i = 0; i < sizeof room.behind; i++)
        V_EXPECT(s->run, room.behind[i] == 0x5a, "param_info writes behind the %u bytes of its struct",
                 (unsigned)sizeof room.info);
}

void check_param_info_calls(v_run *run) {
    v_subject s;
    v_open(run, &s);
    const uint32_t count = s.plugin->param_count(s.plugin);
    const uint32_t beyond[] = {count, count + 1, UINT32_MAX};
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond && count < UINT32_MAX - 1; i++) {
        sv_param_info info = {.size = sizeof info};
        v_where(run, "param_info(%u)", beyond[i]);
        const sv_status status = s.plugin->param_info(s.plugin, beyond[i], &info);
        V_EXPECT(run, status < 0, "param_info(%u): %s, and param_count is %u", beyond[i], v_status(status),
                 count);
    }
    if (count == 0) v_skip(run, "the plugin has no parameters");
    try_sizes(&s);
    v_where(run, "param_info with out NULL");
    V_EXPECT(run, s.plugin->param_info(s.plugin, 0, NULL) == SV_ERR_ARGUMENT,
             "param_info with out NULL is not SV_ERR_ARGUMENT");
    v_close(&s);
}
