/* SPDX-License-Identifier: MIT */
#include "loop/loop_options.h"

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
