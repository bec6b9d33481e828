/* SPDX-License-Identifier: MIT */
#include "guarded/serve_frame.h"

#include "plugin/plugin_ext.h"

/* begin and the slabs. Returns the first error, or SV_OK. */
static sv_status give(hs_server *server, sv_frame *frame) {
    const hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    frame->values = block->value_count ? block->values : NULL;
    frame->value_count = block->value_count;
    hs_server_enter(server, "begin", 0, 0);
    sv_status status = instance->begin(instance, frame);
    for (uint32_t i = 0; hs_status_is_success(status) && i < block->slab_count; i++) {
        sv_slab slab;
        hs_carrier_slab(&server->carrier, i, &slab);
        hs_server_enter(server, "slab", i + 1u, block->slab_count);
        status = instance->slab(instance, &slab);
    }
    return hs_status_is_success(status) ? SV_OK : status;
}

/* The extensions that the host reads after a frame, behind its commands. */
static void follow(hs_server *server, sv_status status) {
    hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    if (status >= SV_OK && (block->follow & HS_GUARD_POINTS)) {
        hs_server_enter(server, "points", 0, 0);
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
    hs_server_enter(server, "confidence", 0, 0);
    block->confidence = ext->write(instance, map, object, 0);
    if (block->confidence != SV_OK) (void)hs_server_keep(server, SV_ERR_INTERNAL);
}

/* Waits for the queue, which a failed frame may still use, too. The name of a call that failed stays in the
 * block. */
static sv_status finish(hs_server *server, sv_status status) {
    hs_error err = {0};
    if (hs_status_is_success(status)) hs_server_enter(server, "the queue", 0, 0);
    if (hs_carrier_finish(&server->carrier, &err) || !hs_status_is_success(status)) return status;
    return hs_server_fail(server, SV_ERR_OPENCL, err.text);
}

sv_status hs_server_frame(hs_server *server) {
    hs_error err = {0};
    sv_result result;
    sv_frame frame = server->block->frame;
    const sv_plugin *instance = server->plugin.instance;
    if (!hs_carrier_begin(&server->carrier, &frame, &err))
        return hs_server_fail(server, SV_ERR_OPENCL, err.text);
    sv_status status = give(server, &frame);
    if (status == SV_OK) {
        if (!hs_carrier_result(&server->carrier, &result, &err))
            return hs_server_fail(server, SV_ERR_OPENCL, err.text);
        hs_server_enter(server, "end", 0, 0);
        status = instance->end(instance, &result);
    }
    (void)hs_server_keep(server, status);
    follow(server, status);
    return finish(server, status);
}

sv_status hs_server_adjust(hs_server *server) {
    hs_error err = {0};
    sv_result result;
    const hs_guard_block *block = server->block;
    const sv_plugin *instance = server->plugin.instance;
    if (!hs_carrier_result(&server->carrier, &result, &err))
        return hs_server_fail(server, SV_ERR_OPENCL, err.text);
    hs_server_enter(server, "adjust", 0, 0);
    const sv_status status = instance->adjust(instance, block->values, block->value_count, &result);
    (void)hs_server_keep(server, status);
    follow(server, status);
    return finish(server, status);
}

sv_status hs_server_follow(hs_server *server) {
    follow(server, SV_OK);
    return finish(server, SV_OK);
}
