/* SPDX-License-Identifier: MIT */
#include "smartvis/lengths.h"
#include "volume/fan_fit.h"
#include "volume/levels.h"

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

/* How far before the face of the volume that has the probe a place lies, mm. */
static double before_face(const hs_volume *v, const double place[3]) {
    const double n[3] = {v->nx, v->ny, v->nz};
    const int axis = 2 - (int)v->probe / 2, is_high = (int)v->probe % 2;
    return is_high ? place[axis] - n[axis] * v->spacing[axis] : 0.0 - place[axis];
}

void hs_course_take_said(hs_volume *v) {
    v->course.kind = HS_BEAMS_FAN;
    memcpy(v->course.apex, v->apex, sizeof v->apex);
    v->course.face = fmax(before_face(v, v->apex), 0.0);
}

void hs_course_words(const hs_volume *v, char *out, size_t bytes) {
    const hs_course *c = &v->course;
    char probe[64], fit[48] = "";
    (void)snprintf(probe, sizeof probe, "nobody says where the probe was: %s is assumed",
                   hs_probe_name(v->probe));
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

enum { DARK = 12 }; /* levels of noise */

void hs_course_find_noise(hs_volume *v) {
    const uint32_t n[3] = {v->nx, v->ny, v->nz}, edge[3] = {n[0] / 8, n[1] / 8, n[2] / 8};
    uint32_t found = 0, alike = 0;
    const uint8_t level = v->voxels[0];
    for (uint32_t corner = 0; corner < HS_CORNERS; corner++) {
        uint8_t least = 255, most = 0;
        for (uint32_t z = 0; z < edge[2]; z++)
            for (uint32_t y = 0; y < edge[1]; y++) {
                const size_t at_z = corner & 4u ? n[2] - 1 - z : z, at_y = corner & 2u ? n[1] - 1 - y : y;
                const uint8_t *row =
                    v->voxels + (at_z * n[1] + at_y) * n[0] + (corner & 1u ? n[0] - edge[0] : 0);
                for (uint32_t x = 0; x < edge[0]; x++) {
                    least = row[x] < least ? row[x] : least;
                    most = row[x] > most ? row[x] : most;
                }
            }
        found += least < most && most <= DARK;
        alike += least == level && most == level;
    }
    v->course.noisy = found >= HS_CORNERS_ENOUGH;
    v->course.blank = alike == HS_CORNERS && level != 0 && !v->zeros_guessed;
}

static bool doubts_size(const hs_volume *v, char *out, size_t bytes) {
    const uint32_t count[3] = {v->nx, v->ny, v->nz};
    const double wide = sv_lengths_widest(count, v->spacing);
    char question[SV_LENGTHS_TEXT_BYTES];
    return !v->beams && v->course.kind == HS_BEAMS_FAN && sv_lengths_doubts_fan(wide, v->course.face) &&
           sv_lengths_tell_fan(wide, before_face(v, v->course.apex), question, sizeof question) &&
           hs_spacing_words(question, out, bytes);
}

/* Where no fan fits, but one would. */
static bool doubts_shape(const hs_volume *v, char *out, size_t bytes) {
    const double *own = v->spacing, *fits = v->course.fits;
    int differ = 0, axis = 0;
    for (int k = 0; k < 3; k++) {
        if (fits[k] == own[k]) continue;
        differ++;
        axis = k;
    }
    if (fits[0] > 0.0 && differ == 1)
        return snprintf(out, bytes,
                        "As a fan this fits with %.4g mm along %c, not %.4g: is the spacing right? --spacing "
                        "%.4g,%.4g,%.4g",
                        fits[axis], "xyz"[axis], own[axis], fits[0], fits[1], fits[2]) > 0;
    if (fits[0] > 0.0)
        return snprintf(out, bytes,
                        "As a fan this fits with %.4g x %.4g x %.4g mm: is the spacing right? --spacing "
                        "%.4g,%.4g,%.4g",
                        fits[0], fits[1], fits[2], fits[0], fits[1], fits[2]) > 0;
    return v->course.fits_none &&
           snprintf(
               out, bytes,
               "From %s no fan fits what was scanned: is the probe there, and the spacing right? --spacing "
               "X,Y,Z says it (mm).",
               hs_probe_name(v->probe)) > 0;
}

void hs_course_question(const hs_volume *v, char *out, size_t bytes) {
    const hs_course *c = &v->course;
    out[0] = '\0';
    if (c->fits[0] > 0.0 && doubts_shape(v, out, bytes)) return; /* of wrong lengths the face is a guess */
    if (doubts_size(v, out, bytes)) return;
    if (c->asked_count == 0 && c->noisy)
        (void)snprintf(out, bytes,
                       "Its corners hold dark noise: if nothing was scanned there, say so by --window "
                       "LOW,HIGH with LOW above it.");
    if (c->asked_count == 0 && !c->noisy && !doubts_shape(v, out, bytes) && c->blank)
        (void)snprintf(out, bytes,
                       "Its corners hold one grey level, and count as scanned: if nothing was scanned there, "
                       "--padding auto says so.");
    if (c->asked_count == 0) return;
    const char *first = hs_probe_name(c->asked[0]);
    if (c->asked_count == 1)
        (void)snprintf(out, bytes, "The scan narrows towards %s: is the probe there? --probe %s", first,
                       first);
    else
        (void)snprintf(out, bytes, "The scan narrows towards %s and %s alike: where is the probe? --probe %s",
                       first, hs_probe_name(c->asked[1]), first);
}
