/* SPDX-License-Identifier: MIT */
/*
 * The confidence of a frame's surface (smartvis.confidence/1), on its way to the renderer. It travels as the
 * depthmap does: enqueued behind the frame's commands, or copied to the device from the host's memory, and
 * settled by the same wait. A map that does not come, or holds what is no confidence, costs the picture
 * nothing but the wider window.
 */
#include "loop/loop_parts.h"

#include <stdlib.h>

static const sv_ext_confidence *find(const hs_clipper *clipper) {
    if (!clipper->active) return NULL;
    const sv_plugin *instance = clipper->plugin->instance;
    const sv_ext_confidence *ext = hs_plugin_confidence(instance);
    return ext && ext->offered(instance) ? ext : NULL;
}

bool hs_clipper_sure_create(hs_clipper *clipper, hs_error *err) {
    clipper->confidence = find(clipper);
    if (!clipper->confidence) return true;
    const size_t bytes = clipper->pixels * sizeof(float);
    cl_int code;
    clipper->sure = clCreateBuffer(clipper->cl->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (confidence)", err)) return false;
    clipper->wrong = clCreateBuffer(clipper->cl->context, CL_MEM_READ_WRITE, sizeof(cl_int), NULL, &code);
    if (!hs_cl_check(code, "clCreateBuffer (confidence's check)", err)) return false;
    clipper->check = clCreateKernel(clipper->cl->program, "check_confidence", &code);
    if (!hs_cl_check(code, "clCreateKernel(check_confidence)", err)) return false;
    clipper->host_sure = calloc(clipper->pixels, sizeof(float));
    return clipper->host_sure ||
           hs_fail(err, HS_ERR_MEMORY, "confidence: no memory for %zu pixels", clipper->pixels);
}

void hs_clipper_sure_destroy(hs_clipper *clipper) {
    if (clipper->check) clReleaseKernel(clipper->check);
    if (clipper->wrong) clReleaseMemObject(clipper->wrong);
    if (clipper->sure) clReleaseMemObject(clipper->sure);
    free(clipper->host_sure);
}

/* Counts the values that are no confidence, in the order of the queue. */
static bool enqueue_check(hs_clipper *clipper, hs_error *err) {
    static const cl_int none = 0;
    const cl_command_queue queue = clipper->cl->queue;
    const cl_int width = (cl_int)clipper->slabs->layout.width;
    const size_t rows = clipper->slabs->layout.height;
    cl_int code =
        clEnqueueFillBuffer(queue, clipper->wrong, &none, sizeof none, 0, sizeof none, 0, NULL, NULL);
    if (!hs_cl_check(code, "clEnqueueFillBuffer (confidence)", err)) return false;
    code = clSetKernelArg(clipper->check, 0, sizeof(cl_mem), &clipper->sure);
    code |= clSetKernelArg(clipper->check, 1, sizeof width, &width);
    code |= clSetKernelArg(clipper->check, 2, sizeof(cl_mem), &clipper->wrong);
    if (!hs_cl_check(code, "clSetKernelArg(check_confidence)", err)) return false;
    code = clEnqueueNDRangeKernel(queue, clipper->check, 1, NULL, &rows, NULL, 0, NULL, NULL);
    if (!hs_cl_check(code, "clEnqueueNDRangeKernel(check_confidence)", err)) return false;
    code = clEnqueueReadBuffer(queue, clipper->wrong, CL_FALSE, 0, sizeof clipper->wrong_count,
                               &clipper->wrong_count, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueReadBuffer (confidence)", err);
}

bool hs_clipper_sure_ask(hs_clipper *clipper, bool *asked, hs_error *err) {
    *asked = false;
    if (!clipper->want_confidence || !clipper->confidence) return true;
    const sv_plugin *instance = clipper->plugin->instance;
    const sv_status status =
        clipper->confidence->write(instance, clipper->own_queue ? clipper->host_sure : NULL,
                                   clipper->own_queue ? NULL : clipper->sure, 0);
    if (status != SV_OK) {
        const char *reason = instance->last_error(instance);
        (void)hs_fail(&clipper->sure_error, HS_ERR_PLUGIN, "%s: confidence: %s (%d): %s",
                      clipper->plugin->path, hs_status_name(status), status,
                      reason && reason[0] ? reason : "the plugin gave no reason");
        return true;
    }
    if (clipper->own_queue) {
        const cl_int code =
            clEnqueueWriteBuffer(clipper->cl->queue, clipper->sure, CL_FALSE, 0,
                                 clipper->pixels * sizeof(float), clipper->host_sure, 0, NULL, NULL);
        if (!hs_cl_check(code, "clEnqueueWriteBuffer (confidence)", err)) return false;
    }
    *asked = enqueue_check(clipper, err);
    return *asked;
}

bool hs_clipper_sure_settle(hs_clipper *clipper, bool asked) {
    if (!asked || clipper->wrong_count == 0) return asked;
    return hs_fail(&clipper->sure_error, HS_ERR_PLUGIN, "%s: confidence: %d of %zu values are not in 0 .. 1",
                   clipper->plugin->path, (int)clipper->wrong_count, clipper->pixels);
}
