/* SPDX-License-Identifier: MIT */
#include "eval/eval_compare.h"

#include "guarded/guarded.h"
#include "loop/clipper.h"
#include "plugin/loader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SEED_STEP = 1000 }; /* so that none is another scene's own, or this one's: those are small numbers */

/* "PATH [KEY=VALUE]...", parted by blanks. */
static bool parse_method(hs_eval_method *m, const char *text, hs_error *err) {
    char *next = NULL;
    if (strlen(text) >= sizeof m->text)
        return hs_fail(err, HS_ERR_USAGE, "--compare: longer than %zu characters", sizeof m->text - 1);
    (void)snprintf(m->label, sizeof m->label, "%.255s", text);
    (void)snprintf(m->text, sizeof m->text, "%s", text);
    const char *path = strtok_r(m->text, " ", &next);
    if (!path) return hs_fail(err, HS_ERR_USAGE, "--compare: '%s' names no library", text);
    if (strcmp(path, "-") == 0)
        hs_plugin_default_path(m->path, sizeof m->path);
    else
        (void)snprintf(m->path, sizeof m->path, "%.1023s", path);
    for (const char *set; (set = strtok_r(NULL, " ", &next)) != NULL;) {
        if (m->set_count >= HS_EVAL_MAX_SETS)
            return hs_fail(err, HS_ERR_USAGE, "--compare: more than %u settings", HS_EVAL_MAX_SETS);
        m->sets[m->set_count++] = set;
    }
    return true;
}

/* Where the knob stands: as set, else at its default. */
static double knob_position(const hs_eval_method *m) {
    double position = m->knob.info.default_value;
    for (uint32_t i = 0; i < m->values.count; i++)
        if (m->values.at[i].id == m->knob.info.id) position = m->values.at[i].value;
    return position;
}

static bool open_method(hs_eval_method *m, const char *text, const hs_guard_options *guard, hs_error *err) {
    if (!parse_method(m, text, err) ||
        !hs_guarded_open(&m->plugin, m->path, NULL, SV_LOG_ERROR, guard, err) ||
        !hs_eval_values_parse(&m->values, &m->plugin, m->sets, m->set_count, err))
        return false;
    hs_eval_knob_spread(&m->knob, &m->plugin, 31);
    return true;
}

/* The method on the open case: at its own setting, then over its knob. */
static bool measure(hs_eval_method *m, hs_eval_case *c, uint32_t index, uint32_t seed, hs_error *err) {
    hs_measures at[HS_EVAL_MAX_LINE];
    sv_status outcome;
    hs_eval_knob here = m->knob;
    here.count = 1;
    here.value[0] = here.exists ? knob_position(m) : 0;
    if (!hs_eval_case_measure(c, &m->values, &here, at, &outcome, err)) return false;
    m->no_surface += !hs_outcome_clips(outcome);
    m->of[HS_METHOD_ABS][index][seed] = at[0].of[HS_MEASURE_ABS];
    m->map_crc[index][seed] = hs_eval_map_crc(&c->table, c->map);
    m->of[HS_METHOD_CUT][index][seed] = at[0].of[HS_MEASURE_FETUS_CUT];
    m->of[HS_METHOD_LEFT][index][seed] = at[0].of[HS_MEASURE_OCCLUDER_LEFT];
    m->of[HS_METHOD_BEST][index][seed] = at[0].of[HS_MEASURE_ABS];
    if (!hs_eval_case_measure(c, &m->values, &m->knob, at, &outcome, err)) return false;
    for (uint32_t i = 0; i < m->knob.count; i++)
        m->of[HS_METHOD_BEST][index][seed] =
            fminf(m->of[HS_METHOD_BEST][index][seed], at[i].of[HS_MEASURE_ABS]);
    const hs_error *failure = hs_loop_plugin_error(c->loop);
    return failure->code == HS_OK || hs_fail(err, failure->code, "%s", failure->text);
}

bool hs_eval_compare_measure(hs_eval_comparison *x, uint32_t index, uint32_t seed, hs_eval_case *c,
                             hs_error *err) {
    const hs_eval_options *o = x->options;
    const hs_eval_request request = {.name = o->cases[index],
                                     .size = o->size,
                                     .lowres = o->lowres,
                                     .seed = o->seed + (uint64_t)SEED_STEP * seed,
                                     .real = o->real,
                                     .read = o->read};
    if (!hs_eval_case_open(c, &x->cl, &x->method[0].plugin, &x->method[0].values, &request, err))
        return false;
    hs_measures unclipped;
    hs_eval_measure_map(&c->table, NULL, &unclipped);
    x->unclipped[index][seed] = unclipped.of[HS_MEASURE_ABS];
    (void)snprintf(x->name[index], sizeof x->name[index], "%.63s",
                   hs_source_volume(&c->from.source, 0)->name);
    (void)snprintf(x->doubt[index], sizeof x->doubt[index], "%s", c->from.doubt);
    bool ok = true;
    for (uint32_t m = 0; ok && m < x->count; m++)
        ok = (m == 0 || hs_eval_case_replace(c, &x->cl, &x->method[m].plugin, &x->method[m].values, err)) &&
             measure(&x->method[m], c, index, seed, err);
    if (!ok) hs_eval_case_close(c);
    return ok;
}

double hs_eval_method_mean(const hs_eval_comparison *x, uint32_t method, hs_method_measure measure) {
    double sum = 0;
    uint32_t known = 0;
    for (uint32_t i = 0; i < x->options->case_count; i++)
        for (uint32_t s = 0; s < x->seeds; s++) {
            const double of = (double)x->method[method].of[measure][i][s];
            if (isnan(of)) continue; /* no ray of the case has it */
            sum += of;
            known++;
        }
    return known ? sum / known : (double)NAN;
}

hs_eval_difference hs_eval_compare_case(const hs_eval_comparison *x, uint32_t method, uint32_t against,
                                        uint32_t index) {
    double sum = 0, squares = 0;
    for (uint32_t s = 0; s < x->seeds; s++)
        sum += (double)x->method[method].of[HS_METHOD_ABS][index][s] -
               (double)x->method[against].of[HS_METHOD_ABS][index][s];
    hs_eval_difference d = {.mean = sum / x->seeds, .spread = NAN};
    for (uint32_t s = 0; s < x->seeds; s++) {
        const double off = (double)x->method[method].of[HS_METHOD_ABS][index][s] -
                           (double)x->method[against].of[HS_METHOD_ABS][index][s] - d.mean;
        squares += off * off;
    }
    if (x->seeds > 1) d.spread = sqrt(squares / (x->seeds - 1));
    d.exceeds = fabs(d.mean) > d.spread;
    return d;
}

/* Insertion: equal ones keep the order in which they were given. */
void hs_eval_compare_rank(hs_eval_comparison *x) {
    for (uint32_t i = 0; i < x->count; i++) {
        uint32_t at = i;
        const double mean = hs_eval_method_mean(x, i, HS_METHOD_ABS);
        for (; at > 0 && hs_eval_method_mean(x, x->rank[at - 1], HS_METHOD_ABS) > mean; at--)
            x->rank[at] = x->rank[at - 1];
        x->rank[at] = i;
    }
}

static bool open_all(hs_eval_comparison *x, hs_error *err) {
    const hs_eval_options *o = x->options;
    for (; x->count < o->compare_count; x->count++)
        if (!open_method(&x->method[x->count], o->compare[x->count], &o->guard, err)) return false;
    return hs_cl_open(&x->cl, err);
}

bool hs_eval_compare_open(hs_eval_comparison *x, const hs_eval_options *options, hs_error *err) {
    *x = (hs_eval_comparison){.options = options, .seeds = options->seeds};
    if (options->compare_count > HS_EVAL_MAX_METHODS)
        return hs_fail(err, HS_ERR_USAGE, "--compare: given more than %u times", HS_EVAL_MAX_METHODS);
    if (open_all(x, err)) return true;
    (void)hs_eval_compare_close(x, err);
    return false;
}

bool hs_eval_compare_close(hs_eval_comparison *x, hs_error *err) {
    bool ok = true;
    for (uint32_t m = 0; m < HS_EVAL_MAX_METHODS; m++)
        if (x->method[m].plugin.instance) ok = hs_guarded_close(&x->method[m].plugin, err) && ok;
    hs_cl_close(&x->cl);
    return ok;
}
