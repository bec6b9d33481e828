/* SPDX-License-Identifier: MIT */
#include "guarded/serve.h"

#include "base/progress.h"
#include "guard/child.h"
#include "guarded/serve_facts.h"
#include "guarded/serve_frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

void hs_server_enter(hs_server *server, const char *call, uint32_t step, uint32_t steps) {
    hs_guard_block *block = server->block;
    (void)snprintf(block->call, sizeof block->call, "%s", call);
    block->step = step;
    block->steps = steps;
    atomic_store(&block->since_ns, (uint64_t)(hs_now() * 1e9));
}

sv_status hs_server_fail(hs_server *server, sv_status status, const char *reason) {
    (void)snprintf(server->block->last_error, sizeof server->block->last_error, "%s", reason);
    return status;
}

sv_status hs_server_keep(hs_server *server, sv_status status) {
    const sv_plugin *instance = server->plugin.instance;
    if (status == SV_OK) return status;
    const char *reason = instance->last_error(instance);
    return hs_server_fail(server, status, reason ? reason : "");
}

static void enter_open(void *context, const char *call) {
    hs_server_enter(context, call, 0, 0);
}

/* What is refused here names the path itself. */
static sv_status open_plugin(hs_server *server) {
    hs_guard_block *block = server->block;
    hs_error err = {0};
    const hs_call_watch watch = {.enter = enter_open, .context = server};
    if (!hs_plugin_open_watched(&server->plugin, block->path, block->has_id ? block->id : NULL,
                                block->log_level, &watch, &err))
        return hs_server_fail(server, SV_ERR_INTERNAL, err.text);
    hs_server_facts(server);
    return SV_OK;
}

static sv_status activate(hs_server *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    hs_error err = {0};
    sv_format format = block->format;
    if (!hs_carrier_open(&server->carrier, block, &format, &err))
        return hs_server_fail(server, err.code == HS_ERR_MEMORY ? SV_ERR_NO_MEMORY : SV_ERR_OPENCL, err.text);
    format.values = format.value_count ? block->values : NULL;
    hs_server_enter(server, "activate", 0, 0);
    const sv_status status = instance->activate(instance, &format);
    server->active = status >= SV_OK;
    if (!server->active) {
        (void)hs_server_keep(server, status);
        hs_carrier_close(&server->carrier);
        return status;
    }
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    block->offered = ext ? ext->offered(instance) : 0;
    return status;
}

static sv_status deactivate(hs_server *server) {
    const sv_plugin *instance = server->plugin.instance;
    if (server->active) {
        hs_server_enter(server, "deactivate", 0, 0);
        instance->deactivate(instance);
        hs_carrier_close(&server->carrier);
    }
    server->active = false;
    return SV_OK;
}

static sv_status read_text(hs_server *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    hs_server_enter(server, "param_text", 0, 0);
    return instance->param_text(instance, block->number, block->value, block->text, block->text_bytes);
}

/* Timing on or off, or the times. */
static sv_status time_stages(hs_server *server, bool read) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_timing *ext = hs_plugin_timing(instance);
    if (!ext) return SV_ERR_STATE;
    hs_server_enter(server, "timing", 0, 0);
    block->times = (sv_stage_times){.size = sizeof block->times};
    return hs_server_keep(server, read ? ext->stage_times(instance, &block->times)
                                       : ext->enable(instance, block->number));
}

static sv_status read_confidence(hs_server *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    if (!ext || !server->active) return SV_ERR_STATE;
    hs_server_enter(server, "confidence", 0, 0);
    block->sure = (sv_confidence_report){.size = sizeof block->sure};
    return hs_server_keep(
        server, ext->read(instance, hs_carrier_map(&server->carrier, HS_GUARD_SURE_MAP), &block->sure));
}

static sv_status read_spline(hs_server *server) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    const sv_ext_spline *ext = hs_plugin_spline(instance);
    if (!ext) return SV_ERR_STATE;
    hs_server_enter(server, "spline", 0, 0);
    block->spline = (sv_spline_report){.size = sizeof block->spline};
    return hs_server_keep(server, ext->report(instance, &block->spline));
}

static sv_status close_plugin(hs_server *server) {
    (void)deactivate(server);
    hs_server_enter(server, "destroy", 0, 0);
    hs_plugin_close(&server->plugin);
    return SV_OK;
}

static sv_status obey(hs_server *server, uint32_t op) {
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
        return hs_server_frame(server);
    case HS_GUARD_ADJUST:
        return hs_server_adjust(server);
    case HS_GUARD_FOLLOW:
        return hs_server_follow(server);
    case HS_GUARD_TEXT:
        return read_text(server);
    case HS_GUARD_TIME:
        return time_stages(server, false);
    case HS_GUARD_TIMES:
        return time_stages(server, true);
    case HS_GUARD_SURE:
        return read_confidence(server);
    case HS_GUARD_SPLINE:
        return read_spline(server);
    case HS_GUARD_CLOSE:
        return close_plugin(server);
    default:
        return SV_ERR_ARGUMENT;
    }
}

/* The shared block, if this process was started by a guard. */
static hs_guard_block *find_block(void) {
    struct stat info;
    const size_t most = hs_guard_map_offset(HS_GUARD_MAPS, (size_t)HS_GUARD_MAX_AXIS * HS_GUARD_MAX_AXIS);
    if (fstat(HS_GUARD_BLOCK_FD, &info) != 0 || info.st_size != (off_t)most) return NULL;
    void *at = mmap(NULL, most, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, HS_GUARD_BLOCK_FD, 0);
    if (at == MAP_FAILED) return NULL;
    hs_guard_block *block = at;
    return block->magic == HS_GUARD_MAGIC ? block : NULL;
}

int hs_guard_serve(void) {
    /* PoCL would otherwise swallow an integer division by zero in the plugin's own code. */
    (void)setenv("POCL_SIGFPE_HANDLER", "0", 0);
    static hs_server server; /* the plugin keeps a pointer into it */
    hs_guard_order order;
    server.block = find_block();
    if (!server.block) {
        (void)fprintf(stderr, "host_sim " HS_GUARD_COMMAND ": is started by host_sim itself\n");
        return HS_ERR_USAGE;
    }
    while (hs_child_receive(HS_CHILD_CHANNEL, &order, sizeof order)) {
        hs_guard_reply reply = {.op = order.op, .number = order.number};
        reply.status = obey(&server, order.op);
        if (!hs_child_send(HS_CHILD_CHANNEL, &reply, sizeof reply) || order.op == HS_GUARD_CLOSE) break;
    }
    /* Not exit: what the plugin left to be done at the end is not done. */
    _exit(0);
}
