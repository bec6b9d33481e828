/* SPDX-License-Identifier: MIT */
/* Wrong plugins: parameters, how they describe themselves, and which values are taken. */
#include "wrong_base.h"

static volatile unsigned asked; /* for texts */

#include <math.h>

enum { REPEATED = 5000 };

/* ---- descriptions */
static uint32_t count(const sv_plugin *plugin) {
    if (WRONG_IS(param_id_repeated)) return REPEATED;
    if (WRONG_IS(param_count_endless)) return UINT32_MAX;
    return sva_param_count(plugin);
}

static void spoil_info(uint32_t index, sv_param_info *out) {
    if (WRONG_IS(param_id_repeated)) out->id = SIDE;
    if (WRONG_IS(param_id_zero) && index == 1) out->id = 0;
    if (WRONG_IS(param_label_null) && index == 1) out->label = NULL;
    if (WRONG_IS(param_key_blank) && index == 1) out->key = "a level\x1b[31m";
    if (WRONG_IS(default_out_of_range) && index == 1) out->default_value = 1.5;
    if (WRONG_IS(range_nan) && index == 1) out->min_value = (double)NAN;
    if (WRONG_IS(step_zero) && index == 2) out->step = 0.0;
    if (WRONG_IS(two_primaries) && index == 1) out->flags |= SV_PARAM_PRIMARY;
    if (WRONG_IS(depends_on_itself) && index == 2) {
        out->depends_on = GAP;
        out->depends_values = 1;
    }
    if (WRONG_IS(info_overruns)) memset((char *)out + out->size, 0, 16);
}

static sv_status info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    const int any = WRONG_IS(param_count_endless) || WRONG_IS(info_any_index);
    uint32_t known = index;
    if (WRONG_IS(param_id_repeated)) known = index < REPEATED ? SIDE - 1 : index;
    if (any && index >= PARAMS) known = 1;
    const sv_status status = sva_param_info(plugin, known, out);
    if (status == SV_OK) spoil_info(index, out);
    return status;
}

/* ---- texts */
static sv_status text(const sv_plugin *plugin, uint32_t id, double value, char *out, uint32_t bytes) {
    if (WRONG_IS(text_of_default) && id == LEVEL) value = 0.2;
    if (WRONG_IS(enum_of_one_name) && id == SIDE) value = 0.0;
    const sv_status status = sva_param_text(plugin, id, value, out, bytes);
    if (status != SV_OK) return status;
    if (WRONG_IS(enum_without_names) && id == SIDE) out[0] = '\0';
    if (WRONG_IS(text_without_nul)) memset(out + strlen(out), 'x', bytes - strlen(out));
    if (WRONG_IS(text_disturbs)) asked++;
    if (WRONG_IS(text_overruns)) memcpy(out, "a text of some length", sizeof "a text of some length");
    return SV_OK;
}

/* ---- values */
/* The frame without the values that the base would refuse, or SV_OK's opposite where it must refuse more. */
static sv_status begin(const sv_plugin *plugin, const sv_frame *frame) {
    sva *a = wrong_self(plugin);
    sv_param_value kept[64];
    uint32_t n = 0;
    if (!frame || frame->size < SV_FRAME_SIZE_1_0 || !frame->values || frame->value_count > 64)
        return sva_begin(plugin, frame);
    for (uint32_t i = 0; i < frame->value_count; i++) {
        const sv_param_value v = frame->values[i];
        const sva_param *p = sva_find(a, v.id);
        const int beyond = p && (v.value < p->min_value || v.value > p->max_value);
        const int between = p && p->type == SV_PARAM_INT && !beyond && v.value != floor(v.value);
        const int fixed = p && (p->flags & SV_PARAM_REACTIVATE) != 0;
        int known = 0;
        for (uint32_t k = 0; k < n; k++) known |= kept[k].id == v.id;
        if (WRONG_IS(accepts_beyond) && beyond) continue;
        if (WRONG_IS(accepts_nan) && isnan(v.value)) continue;
        if (WRONG_IS(accepts_between_steps) && between) continue;
        if (WRONG_IS(accepts_unknown_id) && !p) continue;
        if (WRONG_IS(accepts_fixed) && fixed) continue;
        if (WRONG_IS(first_value_counts) && known) continue;
        if (WRONG_IS(refuses_maximum) && p && v.value == p->max_value && a->state != SVA_INACTIVE)
            return sva_blame(a, SV_ERR_PARAM_RANGE, "begin: %s is %g", p->key, v.value);
        kept[n++] = v;
    }
    sv_frame changed;
    memset(&changed, 0, sizeof changed);
    memcpy(&changed, frame, frame->size < sizeof changed ? frame->size : sizeof changed);
    changed.values = kept;
    changed.value_count = n;
    return sva_begin(plugin, &changed);
}

static sv_status activate(const sv_plugin *plugin, const sv_format *format) {
    sva *a = wrong_self(plugin);
    const sv_status status = sva_activate(plugin, format);
    if (status != SV_OK || !WRONG_IS(pair_fails)) return status;
    if (sva_value(a, SIDE) != 2.0 || sva_value(a, DROP) == 0.0) return SV_OK;
    sva_release(a);
    return sva_error(a, SV_ERR_INTERNAL, "activate: side and drop do not go together");
}

static sv_status adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t n,
                        const sv_result *result) {
    sva *a = wrong_self(plugin);
    const sv_status status = sva_adjust(plugin, values, n, result);
    if (status < 0 || !WRONG_IS(adjust_ignores_value)) return status;
    return sva_adjust(&a->api, NULL, 0, result);
}

static sv_status end(const sv_plugin *plugin, const sv_result *result) {
    const sva *a = wrong_self(plugin);
    const sv_status status = sva_end(plugin, result);
    if (status < 0) return status;
    if (WRONG_IS(text_disturbs)) result->depth[0] += (float)(asked % 7);
    if (WRONG_IS(three_fail) && sva_value(a, Q) != 0.25 && sva_value(a, LEVEL) != 0.2 &&
        sva_value(a, GAP) != 1.0)
        result->depth[0] = NAN;
    if (WRONG_IS(one_setting_wrong) && sva_value(a, SIDE) == 1.0) result->depth[0] = NAN;
    return status;
}

static void misbehave(sv_plugin *api) {
    api->end = end;
    api->param_count = count;
    api->param_info = info;
    api->param_text = text;
    api->activate = activate;
    api->begin = begin;
    api->adjust = adjust;
}
WRONG_ENTRY(wrong_method, misbehave);
