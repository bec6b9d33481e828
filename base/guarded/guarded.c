/* SPDX-License-Identifier: MIT */
#include "guarded/guarded.h"

#include "core/system.h"
#include "core/text.h"
#include "guarded/guard_link.h"

#include <errno.h>
#include <stdio.h>
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
    guard->active = hs_status_is_success(status);
    return status;
}

static void guarded_deactivate(const sv_plugin *plugin) {
    hs_guard *guard = hs_guard_of(plugin);
    if (guard->active && guard->child.process)
        (void)hs_guard_ask(guard, HS_GUARD_DEACTIVATE, guard->options.setup_s);
    guard->active = false;
}

/* Ends the child as it is meant to: deactivate, destroy. Nothing may be asked of it after that. */
static void hs_guarded_end(hs_guard *guard) {
    guarded_deactivate(&guard->instance);
    if (guard->child.process) (void)hs_guard_ask(guard, HS_GUARD_CLOSE, guard->options.setup_s);
    hs_guard_end_child(guard);
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
    block->frame = (sv_frame){0}; /* what an older host does not say */
    memcpy(&block->frame, frame, frame->size < sizeof *frame ? frame->size : sizeof *frame);
    block->frame.size = sizeof block->frame;
    block->frame.values = NULL;
    block->frame.scanned = NULL;
    if (guard->lost_frame) block->frame.flags = SV_FRAME_DISCONTINUITY;
    guard->lost_frame = false;
    block->value_count = frame->value_count;
    if (frame->value_count) memcpy(block->values, frame->values, frame->value_count * sizeof *frame->values);
    block->has_scanned = frame->scanned != NULL;
    if (frame->scanned)
        memcpy(hs_guard_map_of(guard, HS_GUARD_SCANNED), frame->scanned,
               guard->pixels * sizeof *frame->scanned);
    guard->slab_count = 0;
    return SV_OK;
}

static sv_status guarded_slab(const sv_plugin *plugin, const sv_slab *slab) {
    hs_guard *guard = hs_guard_of(plugin);
    const uint8_t *memory = slab->memory;
    if (!guard->slabs || memory < guard->slabs || memory > guard->slabs + guard->slabs_bytes ||
        slab->bytes > (uint64_t)(guard->slabs + guard->slabs_bytes - memory) ||
        guard->slab_count >= HS_GUARD_MAX_SLABS)
        return hs_guard_refuse(guard, SV_ERR_SLAB_SHAPE, "slab", "not in the guard's memory");
    guard->block->slabs[guard->slab_count++] = (hs_guard_slab){.first_slice = slab->first_slice,
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
    guard->settled = guard->child.process ? follow : 0;
    if (guard->child.process) hand_out(guard, result);
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
    if (!guard->child.process || guard->lost_frame)
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
    if (!guard->child.process || bytes == 0) return SV_ERR_STATE;
    const uint32_t room = bytes < sizeof block->text ? bytes : (uint32_t)sizeof block->text;
    block->number = id;
    block->value = value;
    block->text_bytes = room;
    memcpy(block->text, out, room); /* what the plugin leaves as it is */
    const sv_status status = hs_guard_ask(guard, HS_GUARD_TEXT, guard->options.frame_s);
    if (guard->child.process) memcpy(out, block->text, room);
    return status;
}

static const char *guarded_last_error(const sv_plugin *plugin) {
    return hs_guard_of(plugin)->last_error;
}

/* Fills in guard->instance; the facts must be there. */
static void hs_guarded_instance(hs_guard *guard) {
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

/* True for an instance that a guard made. */
static bool hs_guarded_is_one(const sv_plugin *instance) {
    return instance->destroy == guarded_destroy;
}

/* -------------------------------------------------------------------------------------------- facts -- */

static void end_text(char *text, size_t bytes) {
    text[bytes - 1] = '\0';
}

/* A descriptor of the copied facts, with pointers to its texts. */
static void tell(hs_guard_told *told, hs_guard_descriptor *facts) {
    end_text(facts->id, sizeof facts->id);
    end_text(facts->name, sizeof facts->name);
    end_text(facts->vendor, sizeof facts->vendor);
    end_text(facts->version, sizeof facts->version);
    end_text(facts->summary, sizeof facts->summary);
    if (facts->extension_count > HS_GUARD_EXTENSIONS) facts->extension_count = HS_GUARD_EXTENSIONS;
    for (uint32_t i = 0; i < facts->extension_count; i++) {
        end_text(facts->extension[i], sizeof facts->extension[i]);
        told->extensions[i] = facts->extension[i];
    }
    told->extensions[facts->extension_count] = NULL;
    told->descriptor = facts->numbers;
    told->descriptor.size = sizeof told->descriptor;
    told->descriptor.id = facts->id;
    told->descriptor.name = facts->name;
    told->descriptor.vendor = facts->vendor;
    told->descriptor.version = facts->version;
    told->descriptor.summary = facts->summary;
    told->descriptor.extensions = told->extensions;
}

/* Copies what the child found out, and makes it safe to read. */
static bool take_facts(hs_guard *guard, hs_error *err) {
    hs_guard_facts *facts = &guard->facts;
    *facts = guard->block->facts;
    if (facts->plugin_count == 0 || facts->plugin_count > HS_MAX_PLUGINS ||
        facts->chosen >= facts->plugin_count)
        return hs_fail(err, HS_ERR_PLUGIN, "%s: its process tells of %u plugins", guard->path,
                       facts->plugin_count);
    for (uint32_t i = 0; i < facts->plugin_count; i++) tell(&guard->told[i], &facts->plugin[i]);
    for (uint32_t i = 0; i < facts->param_count && i < HS_MAX_PARAMS; i++) {
        hs_guard_param *param = &facts->param[i];
        end_text(param->key, sizeof param->key);
        end_text(param->label, sizeof param->label);
        end_text(param->unit, sizeof param->unit);
        end_text(param->help, sizeof param->help);
        end_text(param->group, sizeof param->group);
    }
    return true;
}

/* --------------------------------------------------------------------------------------- open, close -- */

static void show(const hs_guard *guard, hs_plugin *plugin) {
    *plugin = (hs_plugin){.abi_major = guard->facts.abi_major,
                          .abi_minor = guard->facts.abi_minor,
                          .count = guard->facts.plugin_count,
                          .instance = &guard->instance,
                          .log_level = guard->log_level};
    memcpy(plugin->path, guard->path, sizeof plugin->path);
    for (uint32_t i = 0; i < plugin->count; i++) plugin->descriptor[i] = &guard->told[i].descriptor;
}

bool hs_guarded_open(hs_plugin *plugin, const char *path, const char *id, int32_t log_level,
                     const hs_guard_options *options, hs_error *err) {
    char found[1024]; /* as a name may mean another file in the child's folders */
    *plugin = (hs_plugin){0};
    hs_plugin_find(path, found, sizeof found);
    if (!hs_guard_wanted(options, found)) return hs_plugin_open(plugin, path, id, log_level, err);
    hs_guard *guard = hs_memory(1, sizeof *guard, "guard", err);
    if (!guard) return false;
    guard->options = *options;
    guard->way = (hs_handover){SV_CARRIER_HOST, true};
    guard->log_level = log_level;
    guard->has_id = id != NULL;
    (void)snprintf(guard->path, sizeof guard->path, "%s", found);
    (void)snprintf(guard->id, sizeof guard->id, "%s", id ? id : "");
    if (hs_guard_link_create(guard, err) && hs_guard_start(guard, err) && take_facts(guard, err)) {
        hs_guarded_instance(guard);
        show(guard, plugin);
        return true;
    }
    hs_guard_link_destroy(guard);
    free(guard);
    return false;
}

bool hs_is_guarded(const hs_plugin *plugin) {
    return plugin && plugin->instance && hs_guarded_is_one(plugin->instance);
}

static hs_guard *guard_of(const hs_plugin *plugin) {
    return hs_is_guarded(plugin) ? hs_guard_of(plugin->instance) : NULL;
}

bool hs_guarded_close(hs_plugin *plugin, hs_error *err) {
    hs_guard *guard = guard_of(plugin);
    hs_error ended = {0};
    char path[sizeof plugin->path];
    (void)snprintf(path, sizeof path, "%s", plugin->path);
    if (guard) {
        hs_guarded_end(guard);
        ended = guard->ended;
        end_text(guard->block->complaint, sizeof guard->block->complaint);
        (void)hs_text_escape(plugin->complaint, sizeof plugin->complaint, guard->block->complaint, 0);
    }
    hs_plugin_close(plugin);
    if (ended.code != HS_OK) return hs_fail(err, ended.code, "%s", ended.text);
    return !plugin->complaint[0] || hs_fail(err, HS_ERR_PLUGIN, "%s: %s", path, plugin->complaint);
}

/* ------------------------------------------------------------------------------------ memory, route -- */

void hs_guarded_route(const hs_plugin *plugin, hs_handover way) {
    hs_guard *guard = guard_of(plugin);
    if (guard) guard->way = way;
}

void *hs_guarded_memory(const hs_plugin *plugin, size_t bytes, hs_error *err) {
    hs_guard *guard = guard_of(plugin);
    sys_shared_unmap(guard->slabs, guard->slabs_bytes);
    guard->slabs = NULL;
    guard->slabs_bytes = bytes;
    void *at = sys_shared_resize(guard->slabs_shared, bytes)
                   ? sys_shared_map(guard->slabs_shared, bytes, true)
                   : NULL;
    if (!at || !sys_shared_use(at, bytes, true)) {
        (void)hs_fail(err, HS_ERR_MEMORY, "guard: no %zu bytes for slabs: %s", bytes, strerror(errno));
        sys_shared_unmap(at, bytes);
        return NULL;
    }
    guard->slabs = memset(at, 0, bytes);
    return at;
}

const char *hs_guarded_call(const hs_plugin *plugin, const char *call) {
    const hs_guard *guard = guard_of(plugin);
    return guard && guard->call[0] ? guard->call : call;
}

bool hs_guarded_lives(const hs_plugin *plugin) {
    const hs_guard *guard = guard_of(plugin);
    return !guard || guard->child.process != 0;
}

const hs_error *hs_guarded_ended(const hs_plugin *plugin) {
    static const hs_error none = {0};
    const hs_guard *guard = guard_of(plugin);
    return guard ? &guard->ended : &none;
}

uint32_t hs_guarded_restarts(const hs_plugin *plugin) {
    const hs_guard *guard = guard_of(plugin);
    return guard ? guard->restarts : 0;
}
