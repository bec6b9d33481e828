/* SPDX-License-Identifier: MIT */
/* Checks of the values that a plugin takes and refuses. */
#include "validate/checks/check.h"

enum { MAX_OUTSIDE = 16 };

static v_params params; /* too large for the stack */

static v_rig *open_with_params(v_run *run) {
    v_rig *r = v_rig_standard(run);
    v_params_read(&r->s, &params);
    if (params.count == 0) v_skip(run, "the plugin has no parameters");
    return r;
}

/* begin with one value returns `expected`. */
static void try_value(v_rig *r, const char *key, uint32_t id, double value, sv_status expected) {
    const sv_param_value list = {.id = id, .value = value};
    const sv_plugin *p = r->s.plugin;
    const sv_status status = v_begin(p, &r->stage, &list, 1);
    V_EXPECT(r->s.run, status == expected, "begin with %s = %.17g: %s, expected %s (%s)", key, value,
             v_status(status), v_status(expected), p->last_error(p));
}

void check_param_in_range(v_run *run) {
    v_rig *r = open_with_params(run);
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->flags & SV_PARAM_REACTIVATE) continue;
        try_value(r, p->key, p->id, p->min_value, SV_OK);
        try_value(r, p->key, p->id, p->max_value, SV_OK);
        try_value(r, p->key, p->id, p->default_value, SV_OK);
        for (uint32_t k = 0; k < 4 * run->level; k++)
            try_value(r, p->key, p->id, v_param_random(&r->s, p), SV_OK);
    }
}

/* ---- what must be refused */
/* Values beside the parameter's own, up to MAX_OUTSIDE; returns how many. */
static uint32_t outside(const v_subject *s, const sv_param_info *p, double out[MAX_OUTSIDE]) {
    uint32_t n = 0;
    const double range = p->max_value - p->min_value + 1.0;
    out[n++] = p->max_value + range;
    out[n++] = p->min_value - range;
    out[n++] = nextafter(p->max_value, (double)INFINITY);
    out[n++] = nextafter(p->min_value, -(double)INFINITY);
    out[n++] = (double)NAN;
    out[n++] = (double)INFINITY;
    out[n++] = -(double)INFINITY;
    out[n++] = 1e300;
    if (p->type != SV_PARAM_FLOAT && p->max_value > p->min_value) out[n++] = p->min_value + 0.5 * p->step;
    for (uint32_t k = 0; k < v_param_values(p) && n < MAX_OUTSIDE; k++) /* what an enum has left out */
        if (!v_param_has(s, p, p->min_value + k * p->step)) out[n++] = p->min_value + k * p->step;
    return n;
}

static void refuse_in_activate(v_rig *r, const sv_param_info *p) {
    double values[MAX_OUTSIDE];
    const uint32_t count = outside(&r->s, p, values);
    const sv_plugin *plugin = r->s.plugin;
    for (uint32_t k = 0; k < count; k++) {
        const sv_param_value list = {.id = p->id, .value = values[k]};
        sv_format format = r->stage.format;
        format.values = &list;
        format.value_count = 1;
        v_where(r->s.run, "activate with %s = %g", p->key, values[k]);
        const sv_status status = plugin->activate(plugin, &format);
        V_EXPECT(r->s.run, status == SV_ERR_PARAM_RANGE,
                 "activate with %s = %.17g: %s, expected SV_ERR_PARAM_RANGE", p->key, values[k],
                 v_status(status));
    }
}

void check_param_out_of_range(v_run *run) {
    static const uint32_t nobody[] = {0, 0xfffffff0u, UINT32_MAX};
    double values[MAX_OUTSIDE];
    v_rig *r = open_with_params(run);
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->flags & SV_PARAM_REACTIVATE) continue;
        const uint32_t count = outside(&r->s, p, values);
        for (uint32_t k = 0; k < count; k++) try_value(r, p->key, p->id, values[k], SV_ERR_PARAM_RANGE);
    }
    for (size_t i = 0; i < sizeof nobody / sizeof *nobody; i++)
        try_value(r, "an id that no parameter has", nobody[i], 0.0, SV_ERR_PARAM_ID);
    (void)v_rig_frame(r, NULL, 0);
    v_deactivate(&r->s, r->s.plugin);
    for (uint32_t i = 0; i < params.count; i++)
        if (params.info[i].flags & SV_PARAM_REACTIVATE) refuse_in_activate(r, &params.info[i]);
    v_activate(&r->s, r->s.plugin, &r->stage);
}

void check_param_fixed(v_run *run) {
    uint32_t tried = 0;
    v_rig *r = open_with_params(run);
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        const double other = v_param_other(p);
        if (!(p->flags & SV_PARAM_REACTIVATE)) continue;
        try_value(r, p->key, p->id, p->default_value, SV_OK);
        if (other != p->default_value) try_value(r, p->key, p->id, other, SV_ERR_PARAM_FIXED);
        tried++;
    }
    if (tried == 0) v_skip(run, "no parameter needs a new activation");
}

/* ---- which value counts */
void check_param_repeated(v_run *run) {
    v_rig *r = open_with_params(run);
    for (uint32_t i = 0, tried = 0; i < params.count && tried < 2 + run->level; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->flags & SV_PARAM_REACTIVATE) continue;
        const sv_param_value list[] = {{p->id, 0, p->default_value}, {p->id, 0, v_param_other(p)}};
        const v_map last = v_rig_frame(r, list + 1, 1);
        const v_map both = v_rig_frame(r, list, 2);
        v_map_expect(run, &last, &both, "%s given twice: not the last value counts", p->key);
        tried++;
    }
}

/* adjust to `value` gives the frame that begin with it would have given. */
static void try_adjust(v_rig *r, const sv_param_info *p, double value) {
    const sv_param_value list = {.id = p->id, .value = value};
    const sv_plugin *plugin = r->s.plugin;
    const v_map wanted = v_rig_frame(r, &list, 1);
    const v_map first = v_rig_frame(r, NULL, 0);
    memset(r->stage.pages, 77, r->stage.page_bytes); /* behind a frame its voxels may be gone */
    const sv_status status = v_adjust(plugin, &r->stage, &list, 1);
    V_EXPECT(r->s.run, status >= 0, "adjust of %s to %g: %s: %s", p->key, value, v_status(status),
             plugin->last_error(plugin));
    v_map adjusted = v_collect(&r->stage, status);
    v_map_expect(r->s.run, &wanted, &adjusted, "adjust of %s to %g gives another map than a frame with it",
                 p->key, value);
    const sv_status back = v_adjust(plugin, &r->stage, NULL, 0);
    V_EXPECT(r->s.run, back >= 0, "adjust without values: %s", v_status(back));
    adjusted = v_collect(&r->stage, back);
    v_stage_fill(&r->stage, &r->volume);
    v_map_expect(r->s.run, &first, &adjusted, "adjust back from %s = %g does not give the frame's map",
                 p->key, value);
}

void check_adjust_equals_frame(v_run *run) {
    v_rig *r = open_with_params(run);
    if (!(r->s.descriptor->features & SV_FEATURE_ADJUST))
        v_skip(run, "the descriptor has no SV_FEATURE_ADJUST");
    const sv_plugin *plugin = r->s.plugin;
    for (uint32_t i = 0; i < params.count; i++) {
        const sv_param_info *p = &params.info[i];
        if (p->flags & SV_PARAM_ADJUST) {
            try_adjust(r, p, v_param_other(p));
            try_adjust(r, p, v_param_random(&r->s, p));
            continue;
        }
        const sv_param_value list = {.id = p->id, .value = v_param_other(p)};
        (void)v_rig_frame(r, NULL, 0);
        const sv_status status = v_adjust(plugin, &r->stage, &list, 1);
        V_EXPECT(run, status < 0, "adjust takes %s, which is not flagged SV_PARAM_ADJUST: %s", p->key,
                 v_status(status));
    }
}

/* ---- any values together */
void check_param_fuzz(v_run *run) {
    uint32_t done = 0, turns = 12 * run->level;
    v_rig *r = open_with_params(run);
    for (uint32_t turn = 0; turn < turns; turn++) {
        sv_param_value list[V_MAX_PARAMS];
        uint32_t count = 0;
        v_map map;
        for (uint32_t i = 0; i < params.count; i++)
            if (!(params.info[i].flags & SV_PARAM_REACTIVATE) && v_random(run, 3) > 0)
                list[count++] =
                    (sv_param_value){params.info[i].id, 0, v_param_random(&r->s, &params.info[i])};
        v_rig_fill(r, (v_kind)v_random(run, V_KINDS));
        const sv_status status = v_try_frame(r->s.plugin, &r->stage, list, count, &map);
        V_EXPECT(run, status >= 0 || status == SV_ERR_PARAM_RANGE, "random values, frame %u: %s: %s", turn,
                 v_status(status), r->s.plugin->last_error(r->s.plugin));
        if (status < 0) continue; /* values that are fine alone may exclude each other */
        char what[48];
        (void)snprintf(what, sizeof what, "random values, frame %u", turn);
        v_map_check_depths(run, &map, r->stage.format.slices, what);
        done++;
    }
    v_note(run, "%u frames with random values, %u of them refused", turns, turns - done);
}
