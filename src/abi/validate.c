/* SPDX-License-Identifier: MIT */
#include "abi/abi.h"

#include "quantise.h"
#include "smartvis/probe.h"

#include <math.h>
#include <stdio.h>

enum { MAX_SIDE = 8192 };

#define BLAME(diag, status, ...) return sv_blame_host(diag, status, __VA_ARGS__)

static sv_status check_side(sv_diag *diag, const char *field, uint32_t value, uint32_t maximum) {
    if (value >= 1 && value <= maximum) return SV_OK;
    BLAME(diag, SV_ERR_FORMAT, "activate: %s is %u, expected 1 to %u", field, value, maximum);
}

static sv_status check_texture(sv_diag *diag, const sv_format *f) {
    if (f->tiles_x < 1 || f->tiles_x > MAX_SIDE)
        BLAME(diag, SV_ERR_FORMAT, "activate: tiles_x is %u, expected 1 to %d", f->tiles_x, MAX_SIDE);
    if (f->tile_w < f->width || f->tile_w > 2 * MAX_SIDE)
        BLAME(diag, SV_ERR_FORMAT, "activate: tile_w is %u, expected at least the width, %u, at most %d",
              f->tile_w, f->width, 2 * MAX_SIDE);
    if (f->tile_h < f->height || f->tile_h > 2 * MAX_SIDE)
        BLAME(diag, SV_ERR_FORMAT, "activate: tile_h is %u, expected at least the height, %u, at most %d",
              f->tile_h, f->height, 2 * MAX_SIDE);
    if (f->carrier != SV_CARRIER_IMAGE && f->row_pitch < (uint64_t)f->tiles_x * f->tile_w)
        BLAME(diag, SV_ERR_FORMAT, "activate: row_pitch is %u bytes, a row of %u tiles of %u needs %llu",
              f->row_pitch, f->tiles_x, f->tile_w, (unsigned long long)f->tiles_x * f->tile_w);
    return SV_OK;
}

static sv_status check_spacing(sv_diag *diag, const sv_format *f) {
    const float *mm = f->spacing_mm;
    const bool unknown = mm[0] == 0.0f && mm[1] == 0.0f && mm[2] == 0.0f;
    const bool known =
        isfinite(mm[0]) && isfinite(mm[1]) && isfinite(mm[2]) && mm[0] > 0.0f && mm[1] > 0.0f && mm[2] > 0.0f;
    if (unknown || known) return SV_OK;
    BLAME(diag, SV_ERR_FORMAT,
          "activate: spacing_mm is %g, %g, %g, expected finite numbers, all above 0 or all 0 (unknown)",
          (double)mm[0], (double)mm[1], (double)mm[2]);
}

static sv_status check_objects(sv_diag *diag, const sv_format *f, bool planned) {
    const int given = (f->context != NULL) + (f->device != NULL) + (f->queue != NULL);
    if (given != 0 && given != 3)
        BLAME(diag, SV_ERR_ARGUMENT, "activate: %d of context, device and queue given, expected all or none",
              given);
    if (f->carrier < SV_CARRIER_HOST || f->carrier > SV_CARRIER_IMAGE)
        BLAME(diag, SV_ERR_ARGUMENT, "activate: carrier is %u, expected 1, 2 or 3", f->carrier);
    if (f->carrier != SV_CARRIER_HOST && given == 0 && !planned)
        BLAME(diag, SV_ERR_FORMAT, "activate: carrier %u needs the host's context, device and queue",
              f->carrier);
    if ((f->host_memory != NULL) != (f->host_memory_bytes > 0))
        BLAME(diag, SV_ERR_ARGUMENT, "activate: host_memory is %s, host_memory_bytes is %llu",
              f->host_memory ? "given" : "NULL", (unsigned long long)f->host_memory_bytes);
    return SV_OK;
}

sv_status sv_validate_format(sv_diag *diag, const sv_format *f, bool planned) {
    if (!f) BLAME(diag, SV_ERR_ARGUMENT, "activate: format is NULL");
    if (f->size < sizeof *f)
        BLAME(diag, SV_ERR_SIZE, "activate: format.size is %u, expected at least %zu", f->size, sizeof *f);
    sv_status status = check_side(diag, "width", f->width, MAX_SIDE);
    if (status == SV_OK) status = check_side(diag, "height", f->height, MAX_SIDE);
    if (status == SV_OK) status = check_side(diag, "slices", f->slices, MAX_SIDE);
    if (status == SV_OK) status = check_side(diag, "max_slab_slices", f->max_slab_slices, f->slices);
    if (status != SV_OK) return status;
    if (f->voxel_type != SV_VOXEL_U8)
        BLAME(diag, SV_ERR_FORMAT, "activate: voxel_type is %u, this plugin reads SV_VOXEL_U8 (%d) only",
              f->voxel_type, SV_VOXEL_U8);
    if (f->padding_value < SV_NO_PADDING || f->padding_value > 255)
        BLAME(diag, SV_ERR_FORMAT, "activate: padding_value is %d, expected -1 (none) or 0 to 255",
              f->padding_value);
    if (f->flags & ~(uint32_t)SV_FORMAT_SCANNED)
        BLAME(diag, SV_ERR_ARGUMENT, "activate: flags is 0x%x, only 0x%x (SV_FORMAT_SCANNED) is known",
              f->flags, (unsigned)SV_FORMAT_SCANNED);
    status = check_spacing(diag, f);
    if (status == SV_OK) status = check_objects(diag, f, planned);
    return status == SV_OK ? check_texture(diag, f) : status;
}

/* SV_OK if `object` is a memory object of this type in the host's context. An image, too, has a size, and a
 * kernel would take it for a buffer; and a runtime need not notice an object of another context. */
static sv_status check_object(sv_diag *diag, const sv_pipeline *p, const char *field, cl_mem object,
                              cl_mem_object_type wanted, sv_status status) {
    cl_mem_object_type type = 0;
    cl_context context = NULL;
    cl_int code = clGetMemObjectInfo(object, CL_MEM_TYPE, sizeof type, &type, NULL);
    if (code == CL_SUCCESS) code = clGetMemObjectInfo(object, CL_MEM_CONTEXT, sizeof context, &context, NULL);
    const char *name = wanted == CL_MEM_OBJECT_BUFFER ? "buffer" : "2D image";
    if (code != CL_SUCCESS) BLAME(diag, status, "%s is no %s: %s (%d)", field, name, sv_clx_name(code), code);
    if (type != wanted) BLAME(diag, status, "%s is no %s: its type is 0x%x", field, name, type);
    if (context != p->queue.device->context)
        BLAME(diag, status, "%s is of another context than the format's", field);
    return SV_OK;
}

/* SV_OK if `object` is a buffer that holds `needed` bytes from `offset` on. */
static sv_status check_ranges_object(sv_diag *diag, const sv_pipeline *p, const sv_frame *f,
                                     uint64_t needed) {
    size_t bytes = 0;
    const sv_status status = check_object(diag, p, "begin: scanned_object", f->scanned_object,
                                          CL_MEM_OBJECT_BUFFER, SV_ERR_ARGUMENT);
    if (status != SV_OK) return status;
    const cl_int code = clGetMemObjectInfo(f->scanned_object, CL_MEM_SIZE, sizeof bytes, &bytes, NULL);
    if (code != CL_SUCCESS)
        BLAME(diag, SV_ERR_ARGUMENT, "begin: clGetMemObjectInfo: %s (%d)", sv_clx_name(code), code);
    if (f->scanned_offset % 4 || f->scanned_offset > bytes || needed > bytes - f->scanned_offset)
        BLAME(diag, SV_ERR_ARGUMENT,
              "begin: scanned_offset is %llu, the ranges need %llu of the buffer's %zu bytes, from a "
              "multiple of 4 on",
              (unsigned long long)f->scanned_offset, (unsigned long long)needed, bytes);
    return SV_OK;
}

static sv_status check_ranges(sv_diag *diag, const sv_pipeline *p, const sv_frame *f) {
    const sv_config *c = &p->config;
    const int given = (f->scanned != NULL) + (f->scanned_object != NULL);
    if (given != (c->ranged ? 1 : 0))
        BLAME(diag, SV_ERR_ARGUMENT, "begin: %d of scanned and scanned_object given, expected %s", given,
              c->ranged ? "exactly one: the format has SV_FORMAT_SCANNED"
                        : "none: the format is without SV_FORMAT_SCANNED");
    if (!f->scanned_object) return SV_OK;
    if (p->queue.device->owned)
        BLAME(diag, SV_ERR_ARGUMENT,
              "begin: scanned_object needs the host's context, and activate was given none");
    return check_ranges_object(diag, p, f, (uint64_t)c->width * c->height * sizeof(sv_scanned));
}

sv_status sv_validate_frame(sv_diag *diag, const sv_pipeline *p, const sv_frame *f) {
    if (!f) BLAME(diag, SV_ERR_ARGUMENT, "begin: frame is NULL");
    char wrong[200];
    if (f->size < SV_FRAME_SIZE_1_0)
        BLAME(diag, SV_ERR_SIZE, "begin: size is %u, expected at least %u", f->size, SV_FRAME_SIZE_1_0);
    if (f->flags & ~(uint32_t)SV_FRAME_DISCONTINUITY)
        BLAME(diag, SV_ERR_ARGUMENT, "begin: flags is 0x%x, only 0x%x (SV_FRAME_DISCONTINUITY) is known",
              f->flags, (unsigned)SV_FRAME_DISCONTINUITY);
    if (!sv_probe_holds(f, wrong, sizeof wrong)) BLAME(diag, SV_ERR_ARGUMENT, "begin: %s", wrong);
    return check_ranges(diag, p, f);
}

sv_status sv_validate_values(sv_diag *diag, const sv_pipeline *p, const sv_values *values) {
    uint32_t weight_initial, weight_filled;
    sv_fill_weights(values->of[SV_PARAM_FILL_WEIGHT], &weight_initial, &weight_filled);
    if (!p->chain.reduced || !sv_method_uses(p->chain.method, SV_PARAM_FILL_WEIGHT) || weight_filled > 0)
        return SV_OK;
    BLAME(diag, SV_ERR_PARAM_RANGE,
          "begin: fill_weight is %g, which leaves pixels empty; with reduction = %u, whose surface is "
          "interpolated, expected at least 0.125",
          values->of[SV_PARAM_FILL_WEIGHT], p->config.reduction);
}

static sv_status check_image(sv_diag *diag, const sv_pipeline *p, const sv_slab *slab) {
    const sv_config *c = &p->config;
    size_t width = 0, height = 0;
    cl_image_format format = {0, 0};
    const sv_status status =
        check_object(diag, p, "slab: object", slab->object, CL_MEM_OBJECT_IMAGE2D, SV_ERR_SLAB_SHAPE);
    if (status != SV_OK) return status;
    cl_int code = clGetImageInfo(slab->object, CL_IMAGE_WIDTH, sizeof width, &width, NULL);
    if (code == CL_SUCCESS)
        code = clGetImageInfo(slab->object, CL_IMAGE_HEIGHT, sizeof height, &height, NULL);
    if (code == CL_SUCCESS)
        code = clGetImageInfo(slab->object, CL_IMAGE_FORMAT, sizeof format, &format, NULL);
    if (code != CL_SUCCESS)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: clGetImageInfo: %s (%d)", sv_clx_name(code), code);
    const size_t tile_rows = (slab->slice_count + c->tiles_x - 1) / c->tiles_x;
    const size_t rows = (tile_rows - 1) * c->tile_h + c->height;
    if (width < (size_t)c->tiles_x * c->tile_w || height < rows)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: the image is %zu x %zu, expected at least %zu x %zu", width,
              height, (size_t)c->tiles_x * c->tile_w, rows);
    if (format.image_channel_order != CL_R || (format.image_channel_data_type != CL_UNORM_INT8 &&
                                               format.image_channel_data_type != CL_UNSIGNED_INT8))
        BLAME(diag, SV_ERR_SLAB_SHAPE,
              "slab: the image's format is 0x%x, 0x%x, expected CL_R with CL_UNORM_INT8 or "
              "CL_UNSIGNED_INT8",
              format.image_channel_order, format.image_channel_data_type);
    return SV_OK;
}

static sv_status check_buffer(sv_diag *diag, const sv_pipeline *p, const sv_slab *slab) {
    size_t bytes = 0;
    const sv_status status =
        check_object(diag, p, "slab: object", slab->object, CL_MEM_OBJECT_BUFFER, SV_ERR_SLAB_SHAPE);
    if (status != SV_OK) return status;
    const cl_int code = clGetMemObjectInfo(slab->object, CL_MEM_SIZE, sizeof bytes, &bytes, NULL);
    if (code != CL_SUCCESS)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: clGetMemObjectInfo: %s (%d)", sv_clx_name(code), code);
    if (slab->offset > bytes || slab->bytes > bytes - slab->offset)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: offset %llu and bytes %llu lie outside the buffer's %zu bytes",
              (unsigned long long)slab->offset, (unsigned long long)slab->bytes, bytes);
    return SV_OK;
}

/* Checks the host's memory on every device, even if slabs are copied there: a host's mistake is not to wait
 * for another device. */
static sv_status check_memory(sv_diag *diag, const sv_config *c, const sv_slab *slab) {
    if (!c->host_memory) return SV_OK;
    const char *start = c->host_memory, *memory = slab->memory;
    if (memory < start || memory > start + c->host_memory_bytes ||
        slab->bytes > (uint64_t)(start + c->host_memory_bytes - memory))
        BLAME(diag, SV_ERR_SLAB_SHAPE,
              "slab: memory does not lie within the %llu bytes of the format's host_memory",
              (unsigned long long)c->host_memory_bytes);
    return SV_OK;
}

sv_status sv_validate_slab(sv_diag *diag, const sv_pipeline *p, const sv_slab *slab) {
    const sv_config *c = &p->config;
    if (!slab) BLAME(diag, SV_ERR_ARGUMENT, "slab: slab is NULL");
    if (slab->size < sizeof *slab)
        BLAME(diag, SV_ERR_SIZE, "slab: size is %u, expected at least %zu", slab->size, sizeof *slab);
    if (slab->first_slice != p->next_slice)
        BLAME(diag, SV_ERR_SLAB_ORDER, "slab: first_slice is %u, expected %u", slab->first_slice,
              p->next_slice);
    if (slab->slice_count < 1 || slab->slice_count > c->max_slab_slices)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: slice_count is %u, expected 1 to max_slab_slices, %u",
              slab->slice_count, c->max_slab_slices);
    if (slab->slice_count > c->slices - slab->first_slice)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: slices %u to %u, the volume has %u", slab->first_slice,
              slab->first_slice + slab->slice_count - 1, c->slices);
    if (c->carrier == SV_CARRIER_HOST ? !slab->memory : !slab->object)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: %s is NULL, the format's carrier is %u",
              c->carrier == SV_CARRIER_HOST ? "memory" : "object", c->carrier);
    if (c->carrier == SV_CARRIER_IMAGE) return check_image(diag, p, slab);
    const uint64_t needed = sv_pipeline_slab_bytes(c, slab->slice_count);
    if (slab->bytes < needed)
        BLAME(diag, SV_ERR_SLAB_SHAPE, "slab: bytes is %llu, %u slices need %llu",
              (unsigned long long)slab->bytes, slab->slice_count, (unsigned long long)needed);
    return c->carrier == SV_CARRIER_BUFFER ? check_buffer(diag, p, slab) : check_memory(diag, c, slab);
}

static sv_status check_depth_object(sv_diag *diag, const char *call, const sv_pipeline *p,
                                    const sv_result *r) {
    size_t bytes = 0;
    const uint64_t needed = (uint64_t)p->config.width * p->config.height * sizeof(float);
    char field[32];
    (void)snprintf(field, sizeof field, "%s: depth_object", call);
    const sv_status status =
        check_object(diag, p, field, r->depth_object, CL_MEM_OBJECT_BUFFER, SV_ERR_ARGUMENT);
    if (status != SV_OK) return status;
    const cl_int code = clGetMemObjectInfo(r->depth_object, CL_MEM_SIZE, sizeof bytes, &bytes, NULL);
    if (code != CL_SUCCESS)
        BLAME(diag, SV_ERR_ARGUMENT, "%s: clGetMemObjectInfo: %s (%d)", call, sv_clx_name(code), code);
    if (r->depth_offset % sizeof(float) || r->depth_offset > bytes || needed > bytes - r->depth_offset)
        BLAME(diag, SV_ERR_ARGUMENT, "%s: depth_offset is %llu, the map needs %llu of the buffer's %zu bytes",
              call, (unsigned long long)r->depth_offset, (unsigned long long)needed, bytes);
    return SV_OK;
}

sv_status sv_validate_result(sv_diag *diag, const char *call, const sv_pipeline *p, const sv_result *r) {
    if (!r) BLAME(diag, SV_ERR_ARGUMENT, "%s: result is NULL", call);
    if (r->size < sizeof *r)
        BLAME(diag, SV_ERR_SIZE, "%s: result.size is %u, expected at least %zu", call, r->size, sizeof *r);
    if ((r->depth != NULL) == (r->depth_object != NULL))
        BLAME(diag, SV_ERR_ARGUMENT, "%s: expected exactly one of depth and depth_object, got %s", call,
              r->depth ? "both" : "neither");
    if (r->depth_object && p->queue.device->owned)
        BLAME(diag, SV_ERR_ARGUMENT, "%s: depth_object needs the host's context, and activate was given none",
              call);
    if (r->depth_pitch &&
        (r->depth_pitch % sizeof(float) || r->depth_pitch < p->config.width * sizeof(float)))
        BLAME(diag, SV_ERR_ARGUMENT, "%s: depth_pitch is %u, expected 0 or a multiple of 4 of at least %zu",
              call, r->depth_pitch, p->config.width * sizeof(float));
    if (r->stats && r->stats->size < sizeof *r->stats)
        BLAME(diag, SV_ERR_SIZE, "%s: stats.size is %u, expected at least %zu", call, r->stats->size,
              sizeof *r->stats);
    return r->depth_object ? check_depth_object(diag, call, p, r) : SV_OK;
}
