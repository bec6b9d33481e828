/* SPDX-License-Identifier: MIT */
#include "render/dvr_settings.h"

#include <math.h>

const char *hs_look_key(hs_look look) {
    static const char *const keys[HS_LOOK_COUNT] = {"thesis", "lit"};
    return keys[look];
}

void hs_dvr_defaults(hs_dvr_settings *settings) {
    const hs_dvr_settings defaults = {
        .width = 512,
        .height = 512,
        .threshold_low = 40.5f / 255.0f,
        .threshold_high = 0.45f,
        .step = 1.0f,
        .termination = 0.95f,
        .ghost_offset = 0.0f,
        .ghost_width = 0.0f,
        .ghost_doubt = 2.0f,
        .skin = {1.0f, 0.85f, 0.72f},
        .exposure = 1.0f,
        .skip_empty = true,
        .look = HS_LOOK_THESIS,
        .light = {-35.0f, 40.0f},
    };
    *settings = defaults;
}

bool hs_dvr_check_settings(const hs_dvr_settings *s, hs_error *err) {
    const struct {
        const char *name;
        double value, low, high;
    } fields[] = {
        {"width", s->width, 1, HS_DVR_MAX_PICTURE},
        {"height", s->height, 1, HS_DVR_MAX_PICTURE},
        {"threshold_low", s->threshold_low, 0, 1},
        {"threshold_high", s->threshold_high, (double)s->threshold_low + 1e-6, 2},
        {"step", s->step, 0.01, 100},
        {"termination", s->termination, 1e-3, INFINITY},
        {"ghost_offset", s->ghost_offset, -(double)HS_DVR_MAX_STEPS, HS_DVR_MAX_STEPS},
        {"ghost_width", s->ghost_width, 0, HS_DVR_MAX_STEPS},
        {"ghost_doubt", s->ghost_doubt, 0, HS_DVR_MAX_DOUBT},
        {"skin[0]", s->skin[0], 0, 1},
        {"skin[1]", s->skin[1], 0, 1},
        {"skin[2]", s->skin[2], 0, 1},
        {"exposure", s->exposure, 0.1, 10},
        {"look", s->look, 0, HS_LOOK_COUNT - 1},
        {"light[0]", s->light[0], -180, 180},
        {"light[1]", s->light[1], -90, 90},
    };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (fields[i].value >= fields[i].low && fields[i].value <= fields[i].high) continue;
        return hs_fail(err, HS_ERR_USAGE, "renderer: %s is %g, expected %g .. %g", fields[i].name,
                       fields[i].value, fields[i].low, fields[i].high);
    }
    return true;
}

bool hs_dvr_check_start(const hs_start_depths *depths, hs_error *err) {
    if (!depths || !depths->depth) return true;
    if (depths->width == 0 || depths->height == 0 || depths->slices == 0 ||
        depths->width > HS_DVR_MAX_PICTURE || depths->height > HS_DVR_MAX_PICTURE) {
        return hs_fail(err, HS_ERR_USAGE,
                       "renderer: depthmap of %u x %u pixels for %u slices, expected 1 .. %u", depths->width,
                       depths->height, depths->slices, (unsigned)HS_DVR_MAX_PICTURE);
    }
    const uint64_t bytes = (uint64_t)depths->width * depths->height * sizeof(float);
    return hs_cl_check_size(depths->depth, bytes, "start depths", err) &&
           (!depths->confidence || hs_cl_check_size(depths->confidence, bytes, "the confidence", err));
}
