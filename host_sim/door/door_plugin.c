/* SPDX-License-Identifier: MIT */
/* A plugin: opened, described, set. */
#include "door/door_clipper.h"
#include "guarded/guarded.h"
#include "plugin/loader_param.h"
#include "smartvis/lookup.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The house's own plugin needs no guard. */
static bool open_plugin(svh_clipper *clipper, const char *path, const char *id, hs_error *err) {
    const svh_host *host = clipper->host;
    hs_guard_options guard = host->guard;
    char found[SYS_PATH];
    if (path)
        hs_plugin_find(path, found, sizeof found);
    else if (host->own[0])
        (void)snprintf(found, sizeof found, "%s", host->own);
    else
        hs_plugin_default_path(found, sizeof found);
    if (guard.choice == HS_GUARD_AUTO && host->own[0] && sys_same_file(found, host->own))
        guard.choice = HS_GUARD_OFF;
    const bool guarded = hs_guard_wanted(&guard, found);
    const int32_t level = host->log && !guarded ? INT32_MAX : SV_LOG_WARNING;
    if (!hs_guarded_open(&clipper->plugin, found, id, level, &guard, err)) return false;
    clipper->plugin.ear = host->context;
    clipper->plugin.hears = host->log;
    return true;
}

int32_t svh_clipper_open(svh_host *host, const char *path, const char *id, svh_clipper **out,
                         svh_error *error) {
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, host, out)) return door_leave(NULL, &err, error);
    *out = NULL;
    (void)pthread_mutex_lock(&host->lock);
    svh_clipper *clipper = hs_memory(1, sizeof *clipper, "clipper", &err);
    if (clipper) clipper->host = host;
    if (clipper && open_plugin(clipper, path, id, &err)) {
        *out = clipper;
        host->users++;
    } else
        free(clipper);
    return door_leave(host, &err, error);
}

void svh_clipper_free(svh_clipper *clipper) {
    hs_error ignored = {0}; /* there is nobody to tell any more */
    if (!clipper) return;
    svh_host *const host = clipper->host;
    (void)pthread_mutex_lock(&host->lock);
    door_deactivate(clipper);
    (void)hs_guarded_close(&clipper->plugin, &ignored);
    free(clipper->values);
    free(clipper->marks);
    free(clipper);
    door_let_go(host);
}

int32_t svh_clipper_about(const svh_clipper *clipper, svh_plugin *out, svh_error *error) {
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, out) || !DOOR_FITS(svh_plugin, out, &err))
        return door_leave(NULL, &err, error);
    const sv_descriptor *d = clipper->plugin.instance->descriptor;
    const svh_plugin own = {.features = d->features,
                            .queues = d->queues,
                            .guarded = hs_is_guarded(&clipper->plugin),
                            .parameters = hs_plugin_param_count(&clipper->plugin),
                            .path = clipper->plugin.path,
                            .id = d->id,
                            .name = d->name,
                            .vendor = d->vendor,
                            .version = d->version,
                            .summary = d->summary};
    door_give(out, &own, sizeof own);
    return SVH_OK;
}

/* --------------------------------------------------------------------------------------- parameters -- */

static const char *text_of(const char *text) {
    return text ? text : "";
}

static void describe(const sv_param_info *info, svh_param *out) {
    const svh_param own = {.id = info->id,
                           .type = info->type,
                           .flags = info->flags,
                           .default_value = info->default_value,
                           .min_value = info->min_value,
                           .max_value = info->max_value,
                           .step = info->step,
                           .display_min = info->display_min,
                           .display_max = info->display_max,
                           .key = text_of(info->key),
                           .label = text_of(info->label),
                           .unit = text_of(info->unit),
                           .help = text_of(info->help),
                           .group = text_of(info->group)};
    door_give(out, &own, sizeof own);
}

int32_t svh_param_at(svh_clipper *clipper, uint32_t index, svh_param *out, svh_error *error) {
    sv_param_info info = {.size = sizeof info};
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, out)) return door_leave(NULL, &err, error);
    const sv_plugin *instance = clipper->plugin.instance;
    (void)pthread_mutex_lock(&clipper->host->lock);
    if (DOOR_FITS(svh_param, out, &err)) {
        const uint32_t count = hs_plugin_param_count(&clipper->plugin);
        const sv_status status = index < count ? instance->param_info(instance, index, &info) : SV_OK;
        if (index >= count)
            (void)hs_fail(&err, HS_ERR_USAGE, "%s: no parameter %u, there are %u", clipper->plugin.path,
                          index, count);
        else if (hs_plugin_check(&clipper->plugin, status, "param_info", &err))
            describe(&info, out);
    }
    return door_leave(clipper->host, &err, error);
}

int32_t svh_param_name(svh_clipper *clipper, uint32_t id, double value, char name[64], svh_error *error) {
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, name)) return door_leave(NULL, &err, error);
    const sv_plugin *instance = clipper->plugin.instance;
    (void)pthread_mutex_lock(&clipper->host->lock);
    memset(name, 0, 64); /* a NUL stands behind, whatever the plugin writes */
    if (instance->param_text(instance, id, value, name, 63) != SV_OK || name[63] != '\0')
        (void)hs_fail(&err, HS_ERR_USAGE, "%s: parameter %u has no name for %g", clipper->plugin.path, id,
                      value);
    return door_leave(clipper->host, &err, error);
}

static bool set(svh_clipper *clipper, sv_param_value value, hs_error *err) {
    for (uint32_t i = 0; i < clipper->value_count; i++)
        if (clipper->values[i].id == value.id) {
            clipper->values[i] = value;
            return true;
        }
    sv_param_value *more = realloc(clipper->values, (clipper->value_count + 1u) * sizeof *more);
    if (!more) return hs_fail(err, HS_ERR_MEMORY, "settings: no memory for %u", clipper->value_count + 1u);
    clipper->values = more;
    more[clipper->value_count++] = value;
    return true;
}

int32_t svh_set(svh_clipper *clipper, const char *setting, svh_error *error) {
    sv_param_value value = {0};
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper, setting)) return door_leave(NULL, &err, error);
    (void)pthread_mutex_lock(&clipper->host->lock);
    if (hs_plugin_parse_param(&clipper->plugin, setting, &value, &err)) (void)set(clipper, value, &err);
    return door_leave(clipper->host, &err, error);
}

int32_t svh_set_number(svh_clipper *clipper, uint32_t id, double value, svh_error *error) {
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, clipper)) return door_leave(NULL, &err, error);
    (void)pthread_mutex_lock(&clipper->host->lock);
    (void)set(clipper, (sv_param_value){.id = id, .value = value}, &err);
    return door_leave(clipper->host, &err, error);
}

void svh_reset(svh_clipper *clipper) {
    if (!clipper) return;
    (void)pthread_mutex_lock(&clipper->host->lock);
    clipper->value_count = 0;
    (void)pthread_mutex_unlock(&clipper->host->lock);
}

/* -------------------------------------------------------------------------------------------- needs -- */

static bool device_of(svh_host *host, sv_needs_device *out, hs_error *err) {
    cl_uint units = 0;
    *out = (sv_needs_device){.size = sizeof *out};
    if (!door_open_device(host, err)) return false;
    const cl_int code =
        clGetDeviceInfo(host->cl.device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    out->flags = host->cl.is_cpu ? SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES : 0;
    out->compute_units = units;
    return hs_cl_check(code, "clGetDeviceInfo(CL_DEVICE_MAX_COMPUTE_UNITS)", err);
}

static bool ask_needs(svh_clipper *clipper, const svh_volume *volume, const svh_view *view, uint64_t *bytes,
                      hs_error *err) {
    const sv_plugin *instance = clipper->plugin.instance;
    const sv_ext_needs *ext = hs_plugin_needs(instance);
    const hs_slab_layout l = door_layout(view);
    const bool ranges = hs_plugin_fan(instance->descriptor) == HS_FAN_RANGES;
    sv_needs needs = {.size = sizeof needs};
    sv_needs_device device;
    *bytes = 2 * (uint64_t)l.width * l.height * l.slices;
    if (!ext) return true;
    sv_format format = {.size = sizeof format,
                        .width = l.width,
                        .height = l.height,
                        .slices = l.slices,
                        .max_slab_slices = l.slab_slices,
                        .voxel_type = SV_VOXEL_U8,
                        .carrier = SV_CARRIER_HOST,
                        .padding_value = SV_NO_PADDING,
                        .tiles_x = l.tiles_x,
                        .tile_w = l.tile_w,
                        .tile_h = l.tile_h,
                        .row_pitch = l.row_pitch,
                        .flags = ranges ? SV_FORMAT_SCANNED : 0};
    door_spacing(volume, view, format.spacing_mm);
    sv_param_value *fixed = door_fixed(clipper, &format.value_count, err);
    format.values = format.value_count ? fixed : NULL;
    const bool ok = fixed && device_of(clipper->host, &device, err) &&
                    hs_plugin_check(&clipper->plugin,
                                    ext->of(instance, &format, clipper->value_count ? clipper->values : NULL,
                                            clipper->value_count, &device, &needs),
                                    "needs", err);
    free(fixed);
    *bytes = needs.device_bytes + needs.host_bytes;
    return ok;
}

int32_t svh_needs(svh_clipper *clipper, const svh_volume *volume, const svh_view *view, uint64_t *bytes,
                  svh_error *error) {
    hs_error err = {0};
    svh_view own;
    if (!DOOR_GIVEN(&err, clipper, volume, view, bytes)) return door_leave(NULL, &err, error);
    (void)pthread_mutex_lock(&clipper->host->lock);
    if (DOOR_TAKE(svh_view, &own, view, &err) && door_check_planned(&own, &err))
        (void)ask_needs(clipper, volume, &own, bytes, &err);
    return door_leave(clipper->host, &err, error);
}
