/* SPDX-License-Identifier: MIT */
#include "volume/fan_fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool hs_probe_is_known(const hs_volume *v) {
    bool known = false;
    for (int k = 0; k < 9; k++) known |= v->probe_turn[k] != 0.0;
    return known;
}

void hs_probe_axes(const hs_volume *v, hs_probe face, double out[9]) {
    static const double axes[HS_PROBE_COUNT][9] = {
        [HS_PROBE_LOW_Z] = {1, 0, 0, 0, 1, 0, 0, 0, 1},  [HS_PROBE_HIGH_Z] = {-1, 0, 0, 0, 1, 0, 0, 0, -1},
        [HS_PROBE_LOW_Y] = {1, 0, 0, 0, 0, 1, 0, -1, 0}, [HS_PROBE_HIGH_Y] = {1, 0, 0, 0, 0, -1, 0, 1, 0},
        [HS_PROBE_LOW_X] = {0, 0, 1, 0, 1, 0, -1, 0, 0}, [HS_PROBE_HIGH_X] = {0, 0, -1, 0, 1, 0, 1, 0, 0}};
    memcpy(out, axes[face], sizeof axes[face]);
    if (!hs_pose_is_mirrored(&v->pose)) return;
    for (size_t k = 0; k < 3; k++) out[k * 3] = 0.0 - out[k * 3];
}

void hs_volume_share_beams(hs_volume *v, const hs_volume *found) {
    v->probe = found->probe;
    memcpy(v->probe_turn, found->probe_turn, sizeof v->probe_turn);
    v->course = found->course;
}

void hs_course_words(const hs_volume *v, char *out, size_t bytes) {
    const hs_course *c = &v->course;
    char probe[64] = "nobody says where the probe was", fit[48] = "";
    if (hs_probe_is_known(v))
        (void)snprintf(probe, sizeof probe, "from %s%s", hs_probe_name(v->probe),
                       c->found ? ", which the scan narrows to" : "");
    if (c->misfit > 0.0) (void)snprintf(fit, sizeof fit, ", fitted to within %.1f mm", c->misfit);
    if (c->kind == HS_BEAMS_FAN)
        (void)snprintf(out, bytes, "a fan %s%s: lines from %.0f mm, sweep from %.0f mm before the scan",
                       probe, fit, c->face, c->face - c->sweep);
    else
        (void)snprintf(out, bytes, "%s %s", c->kind == HS_BEAMS_PARALLEL ? "parallel," : "unknown;", probe);
}

void hs_course_question(const hs_volume *v, char *out, size_t bytes) {
    const hs_course *c = &v->course;
    out[0] = '\0';
    if (c->asked_count == 0) return;
    const char *first = hs_probe_name(c->asked[0]);
    if (c->asked_count == 1)
        (void)snprintf(out, bytes, "The scan narrows towards %s: is the probe there? --probe %s", first,
                       first);
    else
        (void)snprintf(out, bytes, "The scan narrows towards %s and %s alike: where is the probe? --probe %s",
                       first, hs_probe_name(c->asked[1]), first);
}
