/* SPDX-License-Identifier: MIT */
#include "core/progress.h"
#include "core/system.h"
#include "guard/child.h"
#include "guarded/guard_block.h"
#include "guarded/serve_carrier.h"
#include "plugin/capabilities.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    hs_guard_block *block; /* with the maps behind it */
    hs_plugin plugin;
    hs_carrier carrier;
    bool active;
} server_state;

/* Notes the call that is made next, for whoever tells how this process ended. `step` of `steps`, or 0 of
 * 0. */
static void enter_call(server_state *server, const char *call, uint32_t step, uint32_t steps) {
    hs_guard_block *block = server->block;
    hs_child_look_around();
    (void)snprintf(block->call, sizeof block->call, "%s", call);
    block->step = step;
    block->steps = steps;
    atomic_store(&block->since_ns, (uint64_t)(hs_now() * 1e9));
}

/* Keeps a failure's reason for the other side. Returns the status. */
static sv_status fail_with(server_state *server, sv_status status, const char *reason) {
    (void)snprintf(server->block->last_error, sizeof server->block->last_error, "%s", reason);
    return status;
}

/* Keeps the plugin's own reason; nothing if the status is no error. */
static sv_status keep_reason(server_state *server, sv_status status) {
    const sv_plugin *instance = server->plugin.instance;
    if (status == SV_OK) return status;
    const char *reason = instance->last_error(instance);
    return fail_with(server, status, reason ? reason : "");
}

/* As much of a text as there is room for. NULL and a text without an end are the plugin's faults: the first
 * leaves an empty one, the second may crash, which is what this process is for. */
static void keep(char *out, size_t bytes, const char *text) {
    (void)snprintf(out, bytes, "%s", text ? text : "");
}

static void describe(hs_guard_descriptor *out, const sv_descriptor *d) {
    out->numbers = *d;
    keep(out->id, sizeof out->id, d->id);
    keep(out->name, sizeof out->name, d->name);
    keep(out->vendor, sizeof out->vendor, d->vendor);
    keep(out->version, sizeof out->version, d->version);
    keep(out->summary, sizeof out->summary, d->summary);
    out->extension_count = 0;
    for (uint32_t i = 0; d->extensions && d->extensions[i] && i < HS_GUARD_EXTENSIONS; i++)
        keep(out->extension[out->extension_count++], sizeof out->extension[0], d->extensions[i]);
}

static void describe_param(hs_guard_param *out, const sv_plugin *instance, uint32_t index) {
    sv_param_info info = {.size = sizeof info};
    out->status = instance->param_info(instance, index, &info);
    out->numbers = info;
    out->texts = 0;
    if (out->status != SV_OK) return;
    const char *const texts[] = {info.key, info.label, info.unit, info.help, info.group};
    for (uint32_t i = 0; i < 5; i++) out->texts |= (texts[i] ? 1u : 0u) << i;
    keep(out->key, sizeof out->key, info.key);
    keep(out->label, sizeof out->label, info.label);
    keep(out->unit, sizeof out->unit, info.unit);
    keep(out->help, sizeof out->help, info.help);
    keep(out->group, sizeof out->group, info.group);
}

static uint32_t find_extensions(const sv_plugin *instance) {
    const sv_ext_points *points = instance->get_extension(instance, SV_EXT_POINTS);
    return (hs_plugin_timing(instance) ? HS_GUARD_HAS_TIMING : 0u) |
           (hs_plugin_confidence(instance) ? HS_GUARD_HAS_CONFIDENCE : 0u) |
           (points && SV_HAS(points, write) && points->write ? HS_GUARD_HAS_POINTS : 0u) |
           (hs_plugin_needs(instance) ? HS_GUARD_HAS_NEEDS : 0u);
}

/* [child] Asks the open plugin for everything that stays the same. It may crash in any of that. */
static void tell_facts(server_state *server) {
    const hs_plugin *plugin = &server->plugin;
    hs_guard_facts *facts = &server->block->facts;
    facts->abi_major = plugin->abi_major;
    facts->abi_minor = plugin->abi_minor;
    facts->plugin_count = plugin->count;
    facts->chosen = 0;
    enter_call(server, "descriptor", 0, 0);
    for (uint32_t i = 0; i < plugin->count; i++) {
        describe(&facts->plugin[i], plugin->descriptor[i]);
        if (strcmp(plugin->descriptor[i]->id, plugin->instance->descriptor->id) == 0) facts->chosen = i;
    }
    enter_call(server, "param_count", 0, 0);
    facts->param_count = plugin->instance->param_count(plugin->instance);
    for (uint32_t i = 0; i < facts->param_count && i < HS_MAX_PARAMS; i++) {
        enter_call(server, "param_info", i + 1u, facts->param_count);
        describe_param(&facts->param[i], plugin->instance, i);
    }
    enter_call(server, "get_extension", 0, 0);
    facts->extensions = find_extensions(plugin->instance);
}

/* begin and the slabs. Returns the first error, or SV_OK. */
static sv_status give(server_state *server, sv_frame *frame) {
    const hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    frame->values = block->value_count ? block->values : NULL;
    frame->value_count = block->value_count;
    enter_call(server, "begin", 0, 0);
    sv_status status = instance->begin(instance, frame);
    for (uint32_t i = 0; hs_status_is_success(status) && i < block->slab_count; i++) {
        sv_slab slab;
        hs_carrier_slab(&server->carrier, i, &slab);
        enter_call(server, "slab", i + 1u, block->slab_count);
        status = instance->slab(instance, &slab);
    }
    return hs_status_is_success(status) ? SV_OK : status;
}

/* The extensions that the host reads after a frame, behind its commands. */
static void follow(server_state *server, sv_status status) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    if (status >= SV_OK && (block->follow & HS_GUARD_POINTS)) {
        enter_call(server, "points", 0, 0);
        hs_plugin_points(instance, &block->points);
    }
    const bool has_map = status == SV_OK || status == SV_PARTIAL;
    if (!(block->follow & HS_GUARD_CONFIDENCE)) return;
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    block->confidence = SV_ERR_STATE;
    if (!ext || !has_map) return;
    float *map;
    cl_mem object;
    hs_carrier_confidence(&server->carrier, &map, &object);
    enter_call(server, "confidence", 0, 0);
    block->confidence = ext->write(instance, map, object, 0);
    if (block->confidence != SV_OK) (void)keep_reason(server, SV_ERR_INTERNAL);
}

/* Waits for the queue, which a failed frame may still use, too. The name of a call that failed stays in the
 * block. */
static sv_status finish(server_state *server, sv_status status) {
    hs_error err = {0};
    if (hs_status_is_success(status)) enter_call(server, "the queue", 0, 0);
    if (hs_carrier_finish(&server->carrier, &err) || !hs_status_is_success(status)) return status;
    return fail_with(server, SV_ERR_OPENCL, err.text);
}

/* The status of the call, or SV_ERR_INTERNAL if the plugin wrote beyond a map: into the next, or into none.
 */
static sv_status check_bands(server_state *server, const char *call, sv_status status) {
    static const char *const behind[HS_GUARD_MAPS] = {
        "", " into what follows the confidence map", " into what follows the scanned ranges", SV_BAND_STATUS};
    const size_t pixels = server->carrier.pixels;
    int map = 0;
    for (int m = HS_GUARD_MAPS - 1; m >= 0; m--) /* all are whole again, and the first is told */
        if (!sv_band_holds(hs_guard_band(server->block, (hs_guard_map)m, pixels))) map = m + 1;
    if (map == 0 || !hs_status_is_success(status)) return status;
    char reason[128];
    enter_call(server, call, 0, 0); /* it was this call, and not what came behind it */
    (void)snprintf(reason, sizeof reason, SV_BAND_TEXT, call, (unsigned)pixels, behind[map - 1]);
    return fail_with(server, SV_ERR_INTERNAL, reason);
}

/* The frame that the block describes: begin, every slab, end, and what follows it. Results are in the block
 * and the maps when it returns. */
static sv_status run_frame(server_state *server) {
    hs_error err = {0};
    sv_result result;
    sv_frame frame = server->block->frame;
    const sv_plugin *instance = server->plugin.instance;
    if (!hs_carrier_begin(&server->carrier, &frame, &err)) return fail_with(server, SV_ERR_OPENCL, err.text);
    sv_status status = give(server, &frame);
    if (status == SV_OK) {
        if (!hs_carrier_result(&server->carrier, &result, &err))
            return fail_with(server, SV_ERR_OPENCL, err.text);
        enter_call(server, "end", 0, 0);
        status = instance->end(instance, &result);
    }
    (void)keep_reason(server, status);
    follow(server, status);
    return check_bands(server, "end", finish(server, status));
}

/* Moves the last frame's map to other values. */
static sv_status adjust_frame(server_state *server) {
    hs_error err = {0};
    sv_result result;
    const hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    if (!hs_carrier_result(&server->carrier, &result, &err))
        return fail_with(server, SV_ERR_OPENCL, err.text);
    enter_call(server, "adjust", 0, 0);
    const sv_status status = instance->adjust(instance, block->values, block->value_count, &result);
    (void)keep_reason(server, status);
    follow(server, status);
    return check_bands(server, "adjust", finish(server, status));
}

/* What the block's `follow` asks for, of the last frame. */
static sv_status follow_last(server_state *server) {
    follow(server, SV_OK);
    return finish(server, SV_OK);
}

static void enter_open(void *context, const char *call) {
    enter_call(context, call, 0, 0);
}

/* What the plugin says of itself in destroy, too, is the host's to tell. */
static void hear(void *ear, int32_t severity, const char *text) {
    server_state *server = ear;
    (void)text;
    if (severity == SV_LOG_PLUGIN_MISBEHAVING)
        (void)snprintf(server->block->complaint, sizeof server->block->complaint, "%s",
                       server->plugin.complaint);
}

/* What is refused here names the path itself. */
static sv_status open_plugin(server_state *server) {
    hs_guard_block *block = server->block;
    hs_error err = {0};
    const hs_call_watch watch = {.enter = enter_open, .context = server};
    if (!hs_plugin_open_watched(&server->plugin, block->path, block->has_id ? block->id : NULL,
                                block->log_level, &watch, &err))
        return fail_with(server, SV_ERR_INTERNAL, err.text);
    (void)snprintf(block->complaint, sizeof block->complaint, "%s", server->plugin.complaint);
    server->plugin.hears = hear;
    server->plugin.ear = server;
    tell_facts(server);
    return SV_OK;
}

static sv_status activate(server_state *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    hs_error err = {0};
    sv_format format = block->format;
    const size_t bytes = hs_guard_map_offset(HS_GUARD_MAPS, (size_t)format.width * format.height);
    if (!sys_shared_use(block, bytes, true))
        return fail_with(server, SV_ERR_NO_MEMORY, "no memory for the maps");
    if (!hs_carrier_open(&server->carrier, block, &format, &err))
        return fail_with(server, err.code == HS_ERR_MEMORY ? SV_ERR_NO_MEMORY : SV_ERR_OPENCL, err.text);
    for (int map = 0; map < HS_GUARD_MAPS; map++)
        sv_band_make(hs_guard_band(block, (hs_guard_map)map, server->carrier.pixels));
    format.values = format.value_count ? block->values : NULL;
    enter_call(server, "activate", 0, 0);
    const sv_status status = instance->activate(instance, &format);
    server->active = hs_status_is_success(status);
    (void)keep_reason(server, status);
    if (!server->active) {
        if (status > SV_OK) instance->deactivate(instance); /* it believes that it is active */
        hs_carrier_close(&server->carrier);
        return status;
    }
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    block->offered = ext ? ext->offered(instance) : 0;
    return status;
}

static sv_status deactivate(server_state *server) {
    const sv_plugin *instance = server->plugin.instance;
    if (server->active) {
        enter_call(server, "deactivate", 0, 0);
        instance->deactivate(instance);
        hs_carrier_close(&server->carrier);
    }
    server->active = false;
    return SV_OK;
}

static sv_status read_text(server_state *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    enter_call(server, "param_text", 0, 0);
    return instance->param_text(instance, block->number, block->value, block->text, block->text_bytes);
}

/* Timing on or off, or the times. */
static sv_status time_stages(server_state *server, bool read) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_timing *ext = hs_plugin_timing(instance);
    if (!ext) return SV_ERR_STATE;
    enter_call(server, "timing", 0, 0);
    block->times = (sv_stage_times){.size = sizeof block->times};
    return keep_reason(server, read ? ext->stage_times(instance, &block->times)
                                    : ext->enable(instance, block->number));
}

static sv_status read_confidence(server_state *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    if (!ext || !server->active) return SV_ERR_STATE;
    enter_call(server, "confidence", 0, 0);
    block->confidence_report = (sv_confidence_report){.size = sizeof block->confidence_report};
    return keep_reason(server, ext->read(instance, hs_carrier_map(&server->carrier, HS_GUARD_CONFIDENCE_MAP),
                                         &block->confidence_report));
}

static sv_status tell_needs(server_state *server) {
    hs_guard_needs *needs = &server->block->needs;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_needs *ext = hs_plugin_needs(instance);
    sv_format format = needs->format;
    if (!ext) return SV_ERR_STATE;
    format.values = format.value_count ? needs->fixed : NULL;
    needs->out = (sv_needs){.size = sizeof needs->out};
    enter_call(server, "needs", 0, 0);
    return keep_reason(
        server, ext->of(instance, &format, needs->values, needs->value_count, &needs->device, &needs->out));
}

static sv_status close_plugin(server_state *server) {
    (void)deactivate(server);
    enter_call(server, "destroy", 0, 0);
    hs_plugin_close(&server->plugin);
    return SV_OK;
}

static sv_status obey(server_state *server, uint32_t op) {
    const bool frame = op == HS_GUARD_FRAME || op == HS_GUARD_ADJUST || op == HS_GUARD_FOLLOW;
    if (op != HS_GUARD_OPEN && !server->plugin.instance) return SV_ERR_STATE;
    if (frame && !server->active) return SV_ERR_STATE;
    switch (op) {
    case HS_GUARD_OPEN:
        return open_plugin(server);
    case HS_GUARD_ACTIVATE:
        return activate(server);
    case HS_GUARD_DEACTIVATE:
        return deactivate(server);
    case HS_GUARD_FRAME:
        return run_frame(server);
    case HS_GUARD_ADJUST:
        return adjust_frame(server);
    case HS_GUARD_FOLLOW:
        return follow_last(server);
    case HS_GUARD_TEXT:
        return read_text(server);
    case HS_GUARD_TIME:
        return time_stages(server, false);
    case HS_GUARD_TIMES:
        return time_stages(server, true);
    case HS_GUARD_READ_CONFIDENCE:
        return read_confidence(server);
    case HS_GUARD_NEEDS:
        return tell_needs(server);
    case HS_GUARD_CLOSE:
        return close_plugin(server);
    default:
        return SV_ERR_ARGUMENT;
    }
}

/* The shared block, if this process was started by a guard. */
static hs_guard_block *find_block(void) {
    const size_t bytes = hs_guard_map_offset(HS_GUARD_MAPS, (size_t)HS_GUARD_MAX_AXIS * HS_GUARD_MAX_AXIS);
    hs_guard_block *block = sys_shared_map(hs_child_passed(HS_GUARD_PASSED_BLOCK), bytes, true);
    const bool ours = block && sys_shared_use(block, hs_guard_block_bytes(), true);
    return ours && block->magic == HS_GUARD_MAGIC ? block : NULL;
}

int hs_guard_serve(void) {
    /* PoCL would otherwise swallow an integer division by zero in the plugin's own code. */
    sys_set_default("POCL_SIGFPE_HANDLER", "0");
    static server_state server; /* the plugin keeps a pointer into it */
    hs_guard_order order;
    server.block = find_block();
    if (!server.block) {
        (void)fprintf(stderr, "host_sim " HS_GUARD_COMMAND ": is started by host_sim itself\n");
        return HS_ERR_USAGE;
    }
    while (hs_child_receive(hs_child_passed(0), &order, sizeof order)) {
        hs_guard_reply reply = {.op = order.op, .number = order.number};
        reply.status = obey(&server, order.op);
        hs_child_look_around();
        if (!hs_child_send(hs_child_passed(0), &reply, sizeof reply) || order.op == HS_GUARD_CLOSE) break;
    }
    /* Not exit: what the plugin left to be done at the end is not done. */
    hs_child_leave(0);
}
