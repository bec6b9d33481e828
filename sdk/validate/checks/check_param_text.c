/* SPDX-License-Identifier: MIT */
#include "validate/checks/check.h"

#include "smartvis/lookup.h"

#include <stdlib.h>

/* ----------------------------------------------------------------------------------------------- texts -- */
/* Checks of values as a person reads them. */

enum { ROOM = 512, NAME = 64, MARK = 0xa5, MAX_NAMES = 256 };

static v_params params; /* too large for the stack */

static sv_status ask(v_subject *s, const sv_param_info *p, double value, char *out, uint32_t bytes) {
    v_where(s->run, "param_text of %s = %g into %u bytes", p->key, value, bytes);
    return s->plugin->param_text(s->plugin, p->id, value, out, bytes);
}

/* The text stays within its bytes and ends there. */
static void try_room(v_subject *s, const sv_param_info *p, double value, uint32_t bytes) {
    char room[ROOM + 64];
    memset(room, MARK, sizeof room);
    const sv_status status = ask(s, p, value, room, bytes);
    for (size_t i = bytes; i < sizeof room; i++)
        V_EXPECT(s->run, (unsigned char)room[i] == MARK, "param_text of %s = %g writes behind its %u bytes",
                 p->key, value, bytes);
    if (status != SV_OK) return;
    V_EXPECT(s->run, memchr(room, '\0', bytes), "param_text of %s = %g: no NUL within %u bytes", p->key,
             value, bytes);
    V_EXPECT(s->run, bytes < NAME || rule_is_text(room, ROOM),
             "param_text of %s = %g is not UTF-8 text without control characters", p->key, value);
}

void check_param_text(v_run *run) {
    static const uint32_t sizes[] = {1, 2, 3, 8, NAME, 256, ROOM};
    v_subject *s = &v_rig_open(run)->s;
    v_params_read(s, &params);
    if (params.count == 0) v_skip(run, "the plugin has no parameters");
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        const double values[] = {p->default_value,      p->min_value, p->max_value, v_param_random(s, p),
                                 p->max_value + 1000.0, -1e300,       (double)NAN,  (double)INFINITY};
        for (size_t v = 0; v < sizeof values / sizeof *values; v++)
            for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) try_room(s, p, values[v], sizes[k]);
        char text[NAME];
        const sv_status status = ask(s, p, p->default_value, text, sizeof text);
        V_EXPECT(run, status == SV_OK, "param_text of %s = %g, its default: %s", p->key, p->default_value,
                 v_status(status));
    }
    char text[NAME] = "";
    sv_param_info nobody = {.id = 0xfffffff0u, .key = "an unknown id"};
    V_EXPECT(run, ask(s, &nobody, 0.0, text, sizeof text) == SV_ERR_PARAM_ID,
             "param_text of an unknown id is not SV_ERR_PARAM_ID");
    V_EXPECT(run, ask(s, &params.info[0], 0.0, NULL, sizeof text) < 0, "param_text with out NULL succeeds");
}

/* ---- numbers */
/* How far a text may be from its value: half a step, or a hundredth of the range. */
static double text_tolerance(const sv_param_info *p, double value) {
    const double range = 0.01 * (p->max_value - p->min_value), own = 0.01 * fabs(value);
    if (p->type != SV_PARAM_FLOAT) return 0.49 * p->step;
    const double tolerance = own < range || range == 0.0 ? own : range;
    return tolerance > 0.5 * p->step ? tolerance : 0.5 * p->step;
}

static void try_number(v_subject *s, const sv_param_info *p, double value) {
    char text[NAME], *end = NULL;
    const sv_status status = ask(s, p, value, text, sizeof text);
    V_EXPECT(s->run, status == SV_OK, "param_text of %s = %g: %s", p->key, value, v_status(status));
    const double back = strtod(text, &end);
    if (end == text) {
        v_warn(s->run, "the text of %s = %g, '%s', is no number", p->key, value, text);
        return;
    }
    V_EXPECT(s->run, fabs(back - value) <= text_tolerance(p, value) + 1e-12, "the text of %s = %.9g is '%s'",
             p->key, value, text);
}

void check_param_round_trip(v_run *run) {
    v_subject *s = &v_rig_open(run)->s;
    v_params_read(s, &params);
    uint32_t tried = 0;
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->type == SV_PARAM_ENUM || p->type == SV_PARAM_BOOL) continue;
        try_number(s, p, p->min_value);
        try_number(s, p, p->max_value);
        try_number(s, p, p->default_value);
        for (uint32_t k = 0; k < 4 * run->level; k++, tried++) try_number(s, p, v_param_random(s, p));
    }
    if (tried == 0) v_skip(run, "the plugin has no parameter that is a number");
}

/* ---- names */
static void try_names(v_subject *s, const sv_param_info *p) {
    static char names[MAX_NAMES][NAME + 1];
    const uint32_t count = v_param_values(p) < MAX_NAMES ? v_param_values(p) : MAX_NAMES;
    for (uint32_t n = 0; n < count; n++) {
        const double value = p->min_value + n * p->step;
        names[n][0] = names[n][NAME] = '\0';
        if (value != p->min_value && value != p->max_value && !v_param_has(s, p, value)) continue;
        const sv_status status = ask(s, p, value, names[n], NAME);
        V_EXPECT(s->run, status == SV_OK, "param_text of %s = %g: %s", p->key, value, v_status(status));
        V_EXPECT(s->run, names[n][0] && rule_is_text(names[n], NAME), "the value %g of %s has no name", value,
                 p->key);
        for (uint32_t k = 0; k < n; k++)
            V_EXPECT(s->run, strcmp(names[k], names[n]) != 0, "two values of %s have the name '%s'", p->key,
                     names[n]);
    }
    for (uint32_t n = 0; n < count && p->type == SV_PARAM_ENUM; n++) {
        double value = -1.0;
        if (names[n][0] == '\0') continue;
        V_EXPECT(s->run,
                 sv_lookup_value(s->plugin, p, names[n], &value) && value == p->min_value + n * p->step,
                 "the name '%s' of %s leads to the value %g, expected %g", names[n], p->key, value,
                 p->min_value + n * p->step);
    }
}

void check_param_enum_names(v_run *run) {
    v_subject *s = &v_rig_open(run)->s;
    v_params_read(s, &params);
    uint32_t tried = 0;
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->type != SV_PARAM_ENUM && p->type != SV_PARAM_BOOL) continue;
        try_names(s, p);
        tried++;
    }
    if (tried == 0) v_skip(run, "the plugin has no parameter that is an enum or a bool");
}

/* ----------------------------------------------------------------------------------------------- pairs -- */
/*
 * Every pair of values of two parameters is tried, and many pairs at once: a row of values for all
 * parameters covers a pair of every two of them. If a row fails, the pair that is to blame is looked for
 * among its values.
 */

enum { MAX_KNOBS = 24, MAX_VALUES = 12 };

typedef struct {
    const sv_param_info *info;
    uint32_t count;
    double value[MAX_VALUES];
} knob;

typedef struct {
    v_rig *r;
    uint32_t count;
    knob knobs[MAX_KNOBS];
    bool covered[MAX_KNOBS][MAX_VALUES][MAX_KNOBS][MAX_VALUES];
} search;

/* How many pairs that no row has had this value would make with the others' values. */
static uint32_t gain_of(const search *s, const uint32_t *row, uint32_t at, uint32_t value) {
    uint32_t gain = 0;
    for (uint32_t k = 0; k < s->count; k++)
        if (k != at) gain += !s->covered[k][row[k]][at][value];
    return gain;
}

/* A row with the values of parameters `a` and `b`; the others, from random ones on, take in turn the value
 * that covers most. */
static void make_row(const search *s, uint32_t a, uint32_t b, uint32_t *row) {
    for (uint32_t k = 0; k < s->count; k++)
        if (k != a && k != b) row[k] = v_random(s->r->s.run, s->knobs[k].count);
    for (uint32_t k = 0; k < s->count; k++)
        for (uint32_t v = 0; k != a && k != b && v < s->knobs[k].count; v++)
            if (gain_of(s, row, k, v) > gain_of(s, row, k, row[k])) row[k] = v;
}

static void cover(search *s, const uint32_t *row) {
    for (uint32_t a = 0; a < s->count; a++)
        for (uint32_t b = 0; b < s->count; b++) s->covered[a][row[a]][b][row[b]] = true;
}

/* activate with these values, a frame, deactivate; other parameters have their defaults. */
static sv_status try_values(search *s, const uint32_t *row, const uint32_t *which, uint32_t count) {
    sv_param_value list[MAX_KNOBS];
    sv_format format = s->r->stage.format;
    const sv_plugin *p = s->r->s.plugin;
    v_map map;
    for (uint32_t i = 0; i < count; i++)
        list[i] = (sv_param_value){s->knobs[which[i]].info->id, 0, s->knobs[which[i]].value[row[which[i]]]};
    format.values = list;
    format.value_count = count;
    v_where(s->r->s.run, "activate with %u values", count);
    sv_status status = p->activate(p, &format);
    if (status < 0) return status;
    status = v_try_frame(p, &s->r->stage, NULL, 0, &map);
    for (uint32_t i = 0; status >= 0 && i < map.width * map.height; i++)
        if (!isfinite(map.depth[i])) status = SV_ERR_INTERNAL;
    v_deactivate(&s->r->s, p);
    return status;
}

/* The row fails: with which pair, with which value alone, or only as a whole? */
static _Noreturn void blame(search *s, const uint32_t *row, sv_status status) {
    char reason[300], text[500] = "";
    v_run *run = s->r->s.run;
    (void)snprintf(reason, sizeof reason, "%s", s->r->s.plugin->last_error(s->r->s.plugin));
    for (uint32_t a = 0; a < s->count; a++)
        for (uint32_t b = 0; b <= a; b++) {
            const uint32_t which[2] = {a, b};
            const sv_status pair = try_values(s, row, which, a == b ? 1 : 2);
            if (pair >= 0) continue;
            const knob *ka = &s->knobs[a], *kb = &s->knobs[b];
            const char *why = s->r->s.plugin->last_error(s->r->s.plugin);
            v_fail(run, "%s = %g%s%s = %g: %s: %s", kb->info->key, kb->value[row[b]],
                   a == b ? " alone, " : " with ", ka->info->key, ka->value[row[a]], v_status(pair),
                   why && why[0] ? why : "a depth is not finite");
        }
    for (uint32_t k = 0, used = 0; k < s->count && used < sizeof text; k++)
        used += (uint32_t)snprintf(text + used, sizeof text - used, " %s=%g", s->knobs[k].info->key,
                                   s->knobs[k].value[row[k]]);
    v_fail(run, "these values fail together, no two of them alone: %s (%s):%s", v_status(status), reason,
           text);
}

/* Returns the rows that it took. */
static uint32_t try_pairs(search *s) {
    uint32_t rows = 0, row[MAX_KNOBS] = {0}, all[MAX_KNOBS];
    for (uint32_t k = 0; k < s->count; k++) all[k] = k;
    for (uint32_t a = 0; a < s->count; a++)
        for (uint32_t b = 0; b < a; b++)
            for (uint32_t i = 0; i < s->knobs[a].count; i++)
                for (uint32_t j = 0; j < s->knobs[b].count; j++) {
                    if (s->covered[a][i][b][j]) continue;
                    row[a] = i;
                    row[b] = j;
                    make_row(s, a, b, row);
                    const sv_status status = try_values(s, row, all, s->count);
                    if (status < 0) blame(s, row, status);
                    cover(s, row);
                    rows++;
                }
    return rows;
}

void check_param_pairs(v_run *run) {
    static search s;
    uint32_t pairs = 0;
    memset(&s, 0, sizeof s);
    s.r = v_rig_standard(run);
    v_deactivate(&s.r->s, s.r->s.plugin);
    v_params_read(&s.r->s, &params);
    for (uint32_t i = 0; i < params.count && s.count < MAX_KNOBS; i++) {
        if (!(params.info[i].flags & SV_PARAM_REACTIVATE)) continue;
        s.knobs[s.count].info = &params.info[i];
        knob *k = &s.knobs[s.count++];
        k->count = v_param_choice(&s.r->s, k->info, k->value, MAX_VALUES);
    }
    if (s.count < 2) v_skip(run, "fewer than two parameters need a new activation");
    for (uint32_t a = 0; a < s.count; a++)
        for (uint32_t b = 0; b < a; b++) pairs += s.knobs[a].count * s.knobs[b].count;
    const uint32_t rows = try_pairs(&s);
    v_note(run, "%u parameters, %u pairs of values, in %u activations", s.count, pairs, rows);
    v_activate(&s.r->s, s.r->s.plugin, &s.r->stage);
}
