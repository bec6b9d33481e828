/* SPDX-License-Identifier: MIT */
#include "guarded/guarded_instance.h"

#include "guarded/guarded_ext.h"

#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------- activation -- */

static sv_status guarded_activate(const sv_plugin *plugin, const sv_format *format) {
    hs_guard *guard = hs_guard_of(plugin);
    if (format->width > HS_GUARD_MAX_AXIS || format->height > HS_GUARD_MAX_AXIS || format->context ||
        format->carrier != SV_CARRIER_HOST || format->value_count > HS_GUARD_MAX_VALUES)
        return hs_guard_refuse(guard, SV_ERR_FORMAT, "activate", "the guard does not take this format");
    sv_param_value *values = calloc(format->value_count + 1u, sizeof *values);
    if (!values) return hs_guard_refuse(guard, SV_ERR_NO_MEMORY, "activate", "no memory for the values");
    if (format->value_count) memcpy(values, format->values, format->value_count * sizeof *values);
    free(guard->values);
    guard->values = values;
    guard->format = *format;
    guard->pixels = (size_t)format->width * format->height;
    guard->habit = guard->settled = 0;
    guard->active = false;
    if (!hs_guard_revive(guard)) return SV_ERR_INTERNAL;
    const sv_status status = hs_guard_activate(guard);
    guard->active = status == SV_OK;
    return status;
}

static void guarded_deactivate(const sv_plugin *plugin) {
    hs_guard *guard = hs_guard_of(plugin);
    if (guard->active && guard->child.pid)
        (void)hs_guard_ask(guard, HS_GUARD_DEACTIVATE, guard->options.setup_s);
    guard->active = false;
}

void hs_guarded_end(hs_guard *guard) {
    guarded_deactivate(&guard->instance);
    if (guard->child.pid) (void)hs_guard_ask(guard, HS_GUARD_CLOSE, guard->options.setup_s);
    hs_child_close(&guard->child);
}

static void guarded_destroy(const sv_plugin *plugin) {
    hs_guard *guard = hs_guard_of(plugin);
    hs_guarded_end(guard);
    hs_guard_link_destroy(guard);
    free(guard->values);
    free(guard);
}

/* --------------------------------------------------------------------------------------------- frame -- */

static sv_status guarded_begin(const sv_plugin *plugin, const sv_frame *frame) {
    hs_guard *guard = hs_guard_of(plugin);
    if (!guard->active) return hs_guard_refuse(guard, SV_ERR_STATE, "begin", "not active");
    if (!hs_guard_revive(guard)) return SV_ERR_INTERNAL;
    hs_guard_block *block = guard->block;
    if (frame->value_count > HS_GUARD_MAX_VALUES)
        return hs_guard_refuse(guard, SV_ERR_ARGUMENT, "begin", "more values than the guard takes");
    block->frame = *frame;
    block->frame.values = NULL;
    block->frame.scanned = NULL;
    if (guard->lost_frame) block->frame.flags |= SV_FRAME_DISCONTINUITY;
    guard->lost_frame = false;
    block->value_count = frame->value_count;
    if (frame->value_count) memcpy(block->values, frame->values, frame->value_count * sizeof *frame->values);
    block->has_scanned = frame->scanned != NULL;
    if (frame->scanned)
        memcpy(hs_guard_map_of(guard, HS_GUARD_SCANNED), frame->scanned,
               guard->pixels * sizeof *frame->scanned);
    block->slab_count = 0;
    return SV_OK;
}

static sv_status guarded_slab(const sv_plugin *plugin, const sv_slab *slab) {
    hs_guard *guard = hs_guard_of(plugin);
    hs_guard_block *block = guard->block;
    const uint8_t *memory = slab->memory;
    if (!guard->slabs || memory < guard->slabs || memory > guard->slabs + guard->slabs_bytes ||
        slab->bytes > (uint64_t)(guard->slabs + guard->slabs_bytes - memory) ||
        block->slab_count >= HS_GUARD_MAX_SLABS)
        return hs_guard_refuse(guard, SV_ERR_SLAB_SHAPE, "slab", "not in the guard's memory");
    block->slabs[block->slab_count++] = (hs_guard_slab){.first_slice = slab->first_slice,
                                                        .slice_count = slab->slice_count,
                                                        .offset = (uint64_t)(memory - guard->slabs),
                                                        .bytes = slab->bytes};
    return SV_OK;
}

/* What the host has put where results go: what the plugin does not write stays so. */
static void hand_in(hs_guard *guard, const sv_result *result) {
    hs_guard_block *block = guard->block;
    memcpy(hs_guard_map_of(guard, HS_GUARD_DEPTH), result->depth, guard->pixels * sizeof(float));
    block->want_status = result->status != NULL;
    if (result->status) memcpy(hs_guard_map_of(guard, HS_GUARD_STATUS), result->status, guard->pixels);
    if (result->stats) block->stats = *result->stats;
    block->follow = guard->habit;
    guard->habit = 0;
}

static void hand_out(hs_guard *guard, const sv_result *result) {
    const hs_guard_block *block = guard->block;
    memcpy(result->depth, hs_guard_map_of(guard, HS_GUARD_DEPTH), guard->pixels * sizeof(float));
    if (result->status) memcpy(result->status, hs_guard_map_of(guard, HS_GUARD_STATUS), guard->pixels);
    if (!result->stats) return;
    *result->stats = block->stats;
    result->stats->size = sizeof *result->stats;
}

/* A frame's or an adjust's one message. */
static sv_status deliver(hs_guard *guard, hs_guard_op op, const sv_result *result) {
    if (!result->depth || result->depth_object || result->depth_pitch)
        return hs_guard_refuse(guard, SV_ERR_ARGUMENT, "end",
                               "the guard writes depths to memory, row by row");
    hand_in(guard, result);
    const uint32_t follow = guard->block->follow;
    const sv_status status = hs_guard_ask(guard, op, guard->options.frame_s);
    guard->settled = guard->child.pid ? follow : 0;
    if (guard->child.pid) hand_out(guard, result);
    return status;
}

static sv_status guarded_end(const sv_plugin *plugin, const sv_result *result) {
    hs_guard *guard = hs_guard_of(plugin);
    if (!guard->active) return hs_guard_refuse(guard, SV_ERR_STATE, "end", "not active");
    return deliver(guard, HS_GUARD_FRAME, result);
}

static sv_status guarded_adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                                const sv_result *result) {
    hs_guard *guard = hs_guard_of(plugin);
    if (!guard->active) return hs_guard_refuse(guard, SV_ERR_STATE, "adjust", "not active");
    if (!guard->child.pid || guard->lost_frame)
        return hs_guard_refuse(guard, SV_ERR_STATE, "adjust", "the frame was lost with the plugin's process");
    if (count > HS_GUARD_MAX_VALUES)
        return hs_guard_refuse(guard, SV_ERR_ARGUMENT, "adjust", "more values than the guard takes");
    guard->block->value_count = count;
    if (count) memcpy(guard->block->values, values, count * sizeof *values);
    return deliver(guard, HS_GUARD_ADJUST, result);
}

/* -------------------------------------------------------------------------------------- parameters -- */

static uint32_t guarded_param_count(const sv_plugin *plugin) {
    return hs_guard_of(plugin)->facts.param_count;
}

static const char *text_at(const hs_guard_param *param, uint32_t bit, const char *text) {
    return param->texts >> bit & 1u ? text : NULL;
}

static sv_status guarded_param_info(const sv_plugin *plugin, uint32_t index, sv_param_info *out) {
    const hs_guard_facts *facts = &hs_guard_of(plugin)->facts;
    if (index >= facts->param_count || index >= HS_MAX_PARAMS) return SV_ERR_ARGUMENT;
    const hs_guard_param *param = &facts->param[index];
    if (out->size < sizeof *out) return SV_ERR_SIZE;
    *out = param->numbers;
    out->size = sizeof *out;
    out->key = text_at(param, 0, param->key);
    out->label = text_at(param, 1, param->label);
    out->unit = text_at(param, 2, param->unit);
    out->help = text_at(param, 3, param->help);
    out->group = text_at(param, 4, param->group);
    return param->status;
}

static sv_status guarded_param_text(const sv_plugin *plugin, uint32_t id, double value, char *out,
                                    uint32_t bytes) {
    hs_guard *guard = hs_guard_of(plugin);
    hs_guard_block *block = guard->block;
    if (!guard->child.pid || bytes == 0) return SV_ERR_STATE;
    const uint32_t most = bytes < sizeof block->text ? bytes : (uint32_t)sizeof block->text;
    block->number = id;
    block->value = value;
    block->text_bytes = most;
    memcpy(block->text, out, most); /* what the plugin leaves as it is */
    const sv_status status = hs_guard_ask(guard, HS_GUARD_TEXT, guard->options.frame_s);
    if (guard->child.pid) memcpy(out, block->text, most);
    return status;
}

static const char *guarded_last_error(const sv_plugin *plugin) {
    return hs_guard_of(plugin)->last_error;
}

void hs_guarded_instance(hs_guard *guard) {
    guard->instance = (sv_plugin){.size = sizeof(sv_plugin),
                                  .descriptor = &guard->told[guard->facts.chosen].descriptor,
                                  .plugin_data = guard,
                                  .destroy = guarded_destroy,
                                  .activate = guarded_activate,
                                  .deactivate = guarded_deactivate,
                                  .begin = guarded_begin,
                                  .slab = guarded_slab,
                                  .end = guarded_end,
                                  .adjust = guarded_adjust,
                                  .param_count = guarded_param_count,
                                  .param_info = guarded_param_info,
                                  .param_text = guarded_param_text,
                                  .last_error = guarded_last_error,
                                  .get_extension = hs_guarded_extension};
}

bool hs_guarded_is_one(const sv_plugin *instance) {
    return instance->destroy == guarded_destroy;
}
