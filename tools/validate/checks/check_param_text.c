/* SPDX-License-Identifier: MIT */
#include "validate/checks/check_param_text.h"

#include "smartvis/lookup.h"
#include "validate/drive/drive_params.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM = 512, NAME = 64, MARK = 0xa5, MOST_NAMES = 256 };

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
    V_EXPECT(s->run, bytes < NAME || v_is_text(room, ROOM),
             "param_text of %s = %g is not UTF-8 text without control characters", p->key, value);
}

void check_param_text(v_run *run) {
    static const uint32_t sizes[] = {1, 2, 3, 8, NAME, 256, ROOM};
    v_subject s;
    v_open(run, &s);
    v_params_read(&s, &params);
    if (params.count == 0) v_skip(run, "the plugin has no parameters");
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        const double values[] = {p->default_value,      p->min_value, p->max_value, v_param_random(run, p),
                                 p->max_value + 1000.0, -1e300,       (double)NAN,  (double)INFINITY};
        for (size_t v = 0; v < sizeof values / sizeof *values; v++)
            for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) try_room(&s, p, values[v], sizes[k]);
        char text[NAME];
        const sv_status status = ask(&s, p, p->default_value, text, sizeof text);
        V_EXPECT(run, status == SV_OK, "param_text of %s = %g, its default: %s", p->key, p->default_value,
                 v_status(status));
    }
    char text[NAME] = "";
    sv_param_info nobody = {.id = 0xfffffff0u, .key = "an unknown id"};
    V_EXPECT(run, ask(&s, &nobody, 0.0, text, sizeof text) == SV_ERR_PARAM_ID,
             "param_text of an unknown id is not SV_ERR_PARAM_ID");
    V_EXPECT(run, ask(&s, &params.info[0], 0.0, NULL, sizeof text) < 0, "param_text with out NULL succeeds");
    v_close(&s);
}

/* ---- numbers */
/* How far a text may be from its value: half a step, or a hundredth of the range. */
static double slack(const sv_param_info *p, double value) {
    const double range = 0.01 * (p->max_value - p->min_value), own = 0.01 * fabs(value);
    if (p->type != SV_PARAM_FLOAT) return 0.49 * p->step;
    const double most = own < range || range == 0.0 ? own : range;
    return most > 0.5 * p->step ? most : 0.5 * p->step;
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
    V_EXPECT(s->run, fabs(back - value) <= slack(p, value) + 1e-12, "the text of %s = %.9g is '%s'", p->key,
             value, text);
}

void check_param_round_trip(v_run *run) {
    v_subject s;
    v_open(run, &s);
    v_params_read(&s, &params);
    uint32_t tried = 0;
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->type == SV_PARAM_ENUM || p->type == SV_PARAM_BOOL) continue;
        try_number(&s, p, p->min_value);
        try_number(&s, p, p->max_value);
        try_number(&s, p, p->default_value);
        for (uint32_t k = 0; k < 4 * run->level; k++, tried++) try_number(&s, p, v_param_random(run, p));
    }
    if (tried == 0) v_skip(run, "the plugin has no parameter that is a number");
    v_close(&s);
}

/* ---- names */
static void try_names(v_subject *s, const sv_param_info *p) {
    static char names[MOST_NAMES][NAME + 1];
    const uint32_t count = v_param_values(p) < MOST_NAMES ? v_param_values(p) : MOST_NAMES;
    for (uint32_t n = 0; n < count; n++) {
        const double value = p->min_value + n * p->step;
        names[n][NAME] = '\0';
        const sv_status status = ask(s, p, value, names[n], NAME);
        V_EXPECT(s->run, status == SV_OK, "param_text of %s = %g: %s", p->key, value, v_status(status));
        V_EXPECT(s->run, names[n][0] && v_is_text(names[n], NAME), "the value %g of %s has no name", value,
                 p->key);
        for (uint32_t k = 0; k < n; k++)
            V_EXPECT(s->run, strcmp(names[k], names[n]) != 0, "two values of %s have the name '%s'", p->key,
                     names[n]);
    }
    for (uint32_t n = 0; n < count && p->type == SV_PARAM_ENUM; n++) {
        double value = -1.0;
        V_EXPECT(s->run,
                 sv_lookup_value(s->plugin, p, names[n], &value) && value == p->min_value + n * p->step,
                 "the name '%s' of %s leads to the value %g, expected %g", names[n], p->key, value,
                 p->min_value + n * p->step);
    }
}

void check_param_enum_names(v_run *run) {
    v_subject s;
    v_open(run, &s);
    v_params_read(&s, &params);
    uint32_t tried = 0;
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->type != SV_PARAM_ENUM && p->type != SV_PARAM_BOOL) continue;
        try_names(&s, p);
        tried++;
    }
    if (tried == 0) v_skip(run, "the plugin has no parameter that is an enum or a bool");
    v_close(&s);
}
