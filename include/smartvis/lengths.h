/* SPDX-License-Identifier: MIT */
/*
 * A helper for plugins and hosts, header-only and optional: the lengths that prenatal scans have, and whether
 * a volume has others. No rule asks for them: a volume may be right all the same. But a spacing in metres, in
 * another order or of another scan is mostly seen by them, and a method that measures in millimetres then
 * finds nothing, or finds it elsewhere.
 */
#ifndef SMARTVIS_LENGTHS_H
#define SMARTVIS_LENGTHS_H

#include "smartvis/probe.h"

#include <stdio.h>

SMARTVIS_BEGIN_C

/* mm. The longest and the shortest side of a volume. */
#define SV_LENGTHS_NARROWEST 30.0
#define SV_LENGTHS_WIDEST    400.0
#define SV_LENGTHS_THINNEST  20.0
#define SV_LENGTHS_UNEVEN    20.0 /* times its shortest side is the longest of a voxel that is doubted */

/* A factor for all lengths leaves a fan a fan. What tells it is the radius at which the lines begin: that of
 * the probe's array and a little more, for a belly some 40 to 80 mm. A small scan of a small radius was
 * halved, perhaps, and a large one of a large radius doubled. Beams that hardly part have any radius, and an
 * array within the body has a very small one. */
#define SV_LENGTHS_SMALL      90.0 /* of the scan at its widest */
#define SV_LENGTHS_LARGE      170.0
#define SV_LENGTHS_LARGEST    250.0
#define SV_LENGTHS_INSIDE     16.0 /* of the radius */
#define SV_LENGTHS_LOW_FACE   42.0
#define SV_LENGTHS_HIGH_FACE  110.0
#define SV_LENGTHS_FLAT_FACE  200.0
#define SV_LENGTHS_TEXT_BYTES 160

static inline double sv_lengths_widest(const uint32_t *count, const double *mm) {
    double wide = 0.0;
    for (int k = 0; k < 3; k++)
        if (count[k] * mm[k] > wide) wide = count[k] * mm[k];
    return wide;
}

/* The unit in which a length would be one of a scan: "in metres"; else "right". */
static inline const char *sv_lengths_unit(double wide) {
    static const double mm[4] = {1e3, 10.0, 1e-3, 1e-6};
    static const char *const names[4] = {"in metres", "in centimetres", "in micrometres", "in nanometres"};
    for (int i = 0; i < 4; i++)
        if (wide * mm[i] >= SV_LENGTHS_NARROWEST && wide * mm[i] <= SV_LENGTHS_WIDEST) return names[i];
    return "right";
}

/* 1 with a question of at most SV_LENGTHS_TEXT_BYTES if no prenatal scan is as large, or if a voxel's sides
 * are very uneven: "the volume is 0.06 mm wide: is its spacing in metres?"; else 0. `count`: voxels along x,
 * y, z; `mm`: from one to the next, above 0. A map, of one voxel along an axis, is never too thin. */
static inline int sv_lengths_doubt(const uint32_t *count, const double *mm, char *text, size_t bytes) {
    const double wide = sv_lengths_widest(count, mm);
    double least = mm[0], most = mm[0];
    int thin = 0, map = 0;
    for (int k = 0; k < 3; k++) {
        if (mm[k] < least) least = mm[k];
        if (mm[k] > most) most = mm[k];
        if (count[k] * mm[k] < count[thin] * mm[thin]) thin = k;
        map |= count[k] == 1;
    }
    if (!(wide >= SV_LENGTHS_NARROWEST && wide <= SV_LENGTHS_WIDEST))
        return snprintf(text, bytes, "the volume is %.3g mm wide: is its spacing %s?", wide,
                        sv_lengths_unit(wide)) > 0;
    if (!(most < SV_LENGTHS_UNEVEN * least))
        return snprintf(text, bytes,
                        "one side of a voxel is %.3g times as long as another: is the spacing right?",
                        most / least) > 0;
    if (map || count[thin] * mm[thin] >= SV_LENGTHS_THINNEST) return 0;
    return snprintf(text, bytes, "the volume is %.3g mm wide and %.3g mm along %c: is the spacing right?",
                    wide, count[thin] * mm[thin], "xyz"[thin]) > 0;
}

/* 1 if a fan whose lines begin at this radius is doubted. */
static inline int sv_lengths_doubts_fan(double wide, double face) {
    return (wide < SV_LENGTHS_SMALL && face > SV_LENGTHS_INSIDE && face < SV_LENGTHS_LOW_FACE) ||
           wide > SV_LENGTHS_LARGEST ||
           (wide > SV_LENGTHS_LARGE && face > SV_LENGTHS_HIGH_FACE && face < SV_LENGTHS_FLAT_FACE);
}

/* The question about it. `before`: how far before the volume its lines meet, which everybody can tell; where
 * the volume begins at the face's rim, that is less than the radius. */
static inline int sv_lengths_tell_fan(double wide, double before, char *text, size_t bytes) {
    return snprintf(text, bytes,
                    "the scan is %.0f mm wide, and its lines meet %.0f mm before the volume: is the spacing "
                    "right?",
                    wide, before) > 0;
}

/* Both, of a volume that begins where the lines do. */
static inline int sv_lengths_doubt_fan(double wide, double face, char *text, size_t bytes) {
    return sv_lengths_doubts_fan(wide, face) && sv_lengths_tell_fan(wide, face, text, bytes);
}

static inline void sv_lengths_of(const sv_format *f, uint32_t *count, double *mm) {
    count[0] = f->width;
    count[1] = f->height;
    count[2] = f->slices;
    for (int k = 0; k < 3; k++) mm[k] = (double)f->spacing_mm[k];
}

/* The same of a format, which is possible. Where its spacing is unknown, nothing is doubted. */
static inline int sv_lengths_doubt_format(const sv_format *format, char *text, size_t bytes) {
    uint32_t count[3];
    double mm[3];
    sv_lengths_of(format, count, mm);
    return mm[2] > 0.0 && sv_lengths_doubt(count, mm, text, bytes);
}

/* The same of a frame's fan. The camera has to look along an axis of the probe: then the volume begins where
 * the scan does. */
static inline int sv_lengths_doubt_frame(const sv_format *format, const sv_frame *frame, char *text,
                                         size_t bytes) {
    uint32_t count[3];
    double mm[3];
    float turn[9], side[3], fan[4];
    sv_lengths_of(format, count, mm);
    sv_probe_of(frame, turn, side);
    if (sv_probe_beams_of(frame, fan, fan + 3) != SV_BEAMS_FAN || !(mm[2] > 0.0)) return 0;
    for (int k = 0; k < 3; k++) {
        const double along = (double)turn[k * 3 + 2], low = -0.5 * mm[k], high = (count[k] - 0.5) * mm[k];
        const double face = along > 0.0 ? low - (double)fan[k] : (double)fan[k] - high;
        if (along * along > 0.998)
            return sv_lengths_doubt_fan(sv_lengths_widest(count, mm), face, text, bytes);
    }
    return 0;
}

SMARTVIS_END_C

#endif
