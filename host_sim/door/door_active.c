/* SPDX-License-Identifier: MIT */
/* A plugin active for the grid of a view, and for what only activation reads. */
#include "door/door_clipper.h"
#include "loop/plugin_side.h"
#include "plugin/loader_param.h"

#include <stdlib.h>
#include <string.h>

void door_spacing(const svh_volume *volume, const svh_view *view, float out[3]) {
    const bool unsaid = volume->volume.spacing_unsaid;
    out[0] = out[1] = unsaid ? 0.0f : (float)(view->box[0] / view->n[0]);
    out[2] = unsaid ? 0.0f : (float)(view->box[1] / view->n[2]);
}

void door_deactivate(svh_clipper *clipper) {
    svh_host *const host = clipper->host;
    const bool active = clipper->slabs != NULL;
    if (active) (void)clFinish(host->cl.queue); /* nothing may run on what goes now */
    hs_clipper_destroy(clipper->clipper);
    hs_slabs_destroy(clipper->slabs);
    free(clipper->fixed);
    free(clipper->depth);
    free(clipper->confidence);
    clipper->clipper = NULL;
    clipper->slabs = NULL;
    clipper->fixed = NULL;
    clipper->fixed_count = 0;
    clipper->depth = clipper->confidence = NULL;
    clipper->has_before = false;
    clipper->volume = NULL;
    if (!active) return;
    host->on_device--;
    host->ended++;
    door_rest_device(host);
}

sv_param_value *door_fixed(const svh_clipper *clipper, uint32_t *count, hs_error *err) {
    sv_param_value *fixed = hs_memory(clipper->value_count + 1u, sizeof *fixed, "settings", err);
    *count = 0;
    for (uint32_t i = 0; fixed && i < clipper->value_count; i++)
        if (hs_plugin_is_fixed(clipper->plugin.instance, clipper->values[i].id))
            fixed[(*count)++] = clipper->values[i];
    return fixed;
}

bool door_same(const double *a, const double *b, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(a[i] <= b[i] && a[i] >= b[i])) return false;
    return true;
}

static bool same_fixed(const svh_clipper *clipper, const sv_param_value *fixed, uint32_t count) {
    if (count != clipper->fixed_count) return false;
    for (uint32_t i = 0; i < count; i++)
        if (fixed[i].id != clipper->fixed[i].id || !door_same(&fixed[i].value, &clipper->fixed[i].value, 1))
            return false;
    return true;
}

/* True if the plugin is active for such volumes. */
static bool is_active_for(const svh_clipper *clipper, const svh_volume *volume, const svh_view *view,
                          const sv_param_value *fixed, uint32_t count) {
    float spacing[3];
    bool same = true;
    door_spacing(volume, view, spacing);
    for (int a = 0; a < 3; a++)
        same &= spacing[a] <= clipper->spacing_mm[a] && spacing[a] >= clipper->spacing_mm[a];
    return clipper->clipper && memcmp(clipper->n, view->n, sizeof clipper->n) == 0 && same &&
           clipper->gaps == (volume->volume.beams != NULL) && same_fixed(clipper, fixed, count);
}

static bool make_maps(svh_clipper *clipper, hs_error *err) {
    const size_t rays = (size_t)clipper->n[0] * clipper->n[1];
    clipper->depth = hs_memory(rays, sizeof *clipper->depth, "depthmap", err);
    clipper->confidence = hs_memory(rays, sizeof *clipper->confidence, "confidence", err);
    return clipper->depth && clipper->confidence;
}

/* What the plugin says against it shows in the first frame: its clipper is not active then. */
static bool activate(svh_clipper *clipper, svh_volume *volume, const svh_view *view, const hs_camera *camera,
                     hs_error *err) {
    const hs_cl *cl = &clipper->host->cl;
    const hs_slab_layout layout = door_layout(view);
    hs_device_volume *source = door_bring(volume, err);
    hs_side_way way = {.handover = {SV_CARRIER_BUFFER, false}};
    hs_clipper_options asked = {
        .want_confidence = true, .values = clipper->values, .value_count = clipper->value_count};
    if (!source) return false;
    memcpy(clipper->n, view->n, sizeof clipper->n);
    door_spacing(volume, view, clipper->spacing_mm);
    memcpy(asked.spacing_mm, clipper->spacing_mm, sizeof asked.spacing_mm);
    clipper->gaps = volume->volume.beams != NULL;
    hs_side_fit(&way, &clipper->plugin);
    const bool made =
        make_maps(clipper, err) && hs_side_create(cl, &clipper->plugin, &way, &layout, clipper->gaps, &asked,
                                                  &clipper->slabs, &clipper->clipper, err);
    clipper->host->on_device += clipper->slabs != NULL;
    return made && hs_slabs_prepare(clipper->slabs, source, camera, err);
}

bool door_activate(svh_clipper *clipper, svh_volume *volume, const svh_view *view, const hs_camera *camera,
                   hs_error *err) {
    uint32_t count;
    sv_param_value *fixed = door_fixed(clipper, &count, err);
    if (!fixed) return false;
    if (is_active_for(clipper, volume, view, fixed, count)) {
        free(fixed);
        return true;
    }
    door_deactivate(clipper);
    clipper->fixed = fixed;
    clipper->fixed_count = count;
    if (activate(clipper, volume, view, camera, err)) return true;
    door_deactivate(clipper);
    return false;
}
