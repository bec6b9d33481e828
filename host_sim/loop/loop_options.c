/* SPDX-License-Identifier: MIT */
#include "loop/loop_options.h"

#include <math.h>

const char *hs_setting_key(hs_setting setting) {
    static const char *const keys[HS_SETTING_COUNT] = {"dvr", "convert", "smartvis"};
    return keys[setting];
}

const char *hs_setting_label(hs_setting setting) {
    static const char *const labels[HS_SETTING_COUNT] = {"DVR", "DVR + scan conversion",
                                                         "DVR + scan conversion + plugin"};
    return labels[setting];
}

const char *hs_stage_label(hs_stage stage) {
    static const char *const labels[HS_STAGE_COUNT] = {"upload", "scan conversion", "plugin", "DVR",
                                                       "whole loop"};
    return labels[stage];
}

void hs_loop_defaults(hs_loop_options *options) {
    *options = (hs_loop_options){.frames = 100, .slab_slices = 16, .carrier = SV_CARRIER_BUFFER};
    hs_dvr_defaults(&options->dvr);
}

void hs_loop_for_pictures(hs_loop_options *options, hs_look look) {
    options->dvr.look = look;
    /* Tissue has half the intensity of bone: without a gain the thesis' pictures are dim. */
    options->dvr.exposure = look == HS_LOOK_THESIS ? 1.5f : 1.0f;
}

double hs_loop_yaw(const hs_loop_options *options, uint32_t index) {
    if (options->frames < 2) return options->yaw;
    return options->yaw + options->orbit * ((double)index / (options->frames - 1) - 0.5);
}

bool hs_loop_check_options(const hs_loop_options *o, hs_error *err) {
    if (o->frames < 1) return hs_fail(err, HS_ERR_USAGE, "frames: 0, expected 1 or more");
    if (o->slab_slices < 1) return hs_fail(err, HS_ERR_USAGE, "slab: 0 slices, expected 1 or more");
    if (o->carrier < SV_CARRIER_HOST || o->carrier > SV_CARRIER_IMAGE)
        return hs_fail(err, HS_ERR_USAGE, "carrier: %u is none of 1 (host), 2 (buffer), 3 (image)",
                       o->carrier);
    if (o->own_queue && o->carrier != SV_CARRIER_HOST)
        return hs_fail(err, HS_ERR_USAGE, "own queue: needs carrier host, got %s",
                       o->carrier == SV_CARRIER_BUFFER ? "buffer" : "image");
    if (!isfinite(o->yaw) || !isfinite(o->pitch) || !isfinite(o->orbit))
        return hs_fail(err, HS_ERR_USAGE, "camera: yaw %g, pitch %g, orbit %g must be finite", o->yaw,
                       o->pitch, o->orbit);
    if (!(o->zoom >= 0.0 && o->zoom <= HS_LOOP_MAX_ZOOM))
        return hs_fail(err, HS_ERR_USAGE, "camera: zoom %g, expected 0 .. %g", o->zoom, HS_LOOP_MAX_ZOOM);
    return true;
}
