/* SPDX-License-Identifier: MIT */
#include "volume/volume.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEGREES_PER_RADIAN 57.295779513082321
#define WORTH_SAYING       1.0 /* degrees from the closest direction */

/* For each world axis its two ends, named by where an axis comes from and by where it runs to. */
static const struct {
    char from;
    const char *to;
} ends[3][2] = {
    {{'R', "left"}, {'L', "right"}}, {{'A', "back"}, {'P', "front"}}, {{'I', "head"}, {'S', "feet"}}};

void hs_pose_default(hs_pose *pose) {
    *pose = (hs_pose){.direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

bool hs_pose_is_identity(const hs_pose *pose) {
    for (int i = 0; i < 9; i++)
        if (pose->direction[i] != (i % 4 == 0)) return false;
    return true;
}

bool hs_pose_is_mirrored(const hs_pose *pose) {
    const double *d = pose->direction;
    return d[0] * (d[4] * d[8] - d[5] * d[7]) - d[1] * (d[3] * d[8] - d[5] * d[6]) +
               d[2] * (d[3] * d[7] - d[4] * d[6]) <
           0;
}

static double dot(const double *m, int a, int b) {
    return m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b];
}

bool hs_pose_is_right_angled(const double direction[9], double skew) {
    for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++)
            if (!(fabs(dot(direction, a, b) - (a == b)) <= skew)) return false;
    return true;
}

void hs_pose_world(const hs_pose *pose, const double spacing[3], const double index[3], double world[3]) {
    for (int k = 0; k < 3; k++) {
        world[k] = pose->origin[k];
        for (int axis = 0; axis < 3; axis++)
            world[k] += pose->direction[k * 3 + axis] * spacing[axis] * index[axis];
    }
}

/* The world axis that index axis `axis` is closest to; *end is 0 if it runs in its positive sense. */
static int closest(const hs_pose *pose, int axis, int *end) {
    int best = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(pose->direction[k * 3 + axis]) > fabs(pose->direction[best * 3 + axis])) best = k;
    *end = pose->direction[best * 3 + axis] < 0;
    return best;
}

bool hs_pose_doubt(const hs_pose *pose, char out[HS_DOUBT_BYTES]) {
    if (!pose->contradicted[0]) return false;
    (void)snprintf(
        out, HS_DOUBT_BYTES,
        "AnatomicalOrientation says %s instead: only TransformMatrix counts, as in ITK and 3D Slicer.",
        pose->contradicted);
    return true;
}

void hs_pose_letters(const hs_pose *pose, char letters[4]) {
    for (int axis = 0; axis < 3; axis++) {
        int end;
        const int world = closest(pose, axis, &end);
        letters[axis] = ends[world][end].from;
    }
    letters[3] = '\0';
}

bool hs_pose_from_letters(hs_pose *pose, const char *letters) {
    double direction[9] = {0};
    bool seen[3] = {false};
    if (strlen(letters) != 3) return false;
    for (int axis = 0; axis < 3; axis++) {
        const char letter = (char)toupper((unsigned char)letters[axis]);
        int world = -1;
        for (int k = 0; k < 3; k++)
            for (int end = 0; end < 2; end++)
                if (ends[k][end].from == letter) {
                    world = k;
                    direction[k * 3 + axis] = end ? -1.0 : 1.0;
                }
        if (world < 0 || seen[world]) return false;
        seen[world] = true;
    }
    memcpy(pose->direction, direction, sizeof direction);
    return true;
}

void hs_pose_words(const hs_pose *pose, char *out, size_t bytes) {
    size_t at = 0;
    if (bytes) out[0] = '\0';
    for (int axis = 0; axis < 3; axis++) {
        int end;
        const int world = closest(pose, axis, &end);
        const double along = fmin(fabs(pose->direction[world * 3 + axis]), 1.0);
        const double off = acos(along) * DEGREES_PER_RADIAN;
        char tail[40] = "";
        if (off > WORTH_SAYING) (void)snprintf(tail, sizeof tail, " (%.0f degrees off)", off);
        const int length = snprintf(out + at, bytes - at, "%s%c to the %s%s", axis ? ", " : "", "xyz"[axis],
                                    ends[world][end].to, tail);
        if (length < 0 || (size_t)length >= bytes - at) return;
        at += (size_t)length;
    }
}

void hs_pose_ends(const double first[3], const double second[3], const char *out[2]) {
    const double *const directions[2] = {first, second};
    int taken = -1;
    for (int i = 0; i < 2; i++) {
        double best = -1.0;
        for (int k = 0, not_this = taken; k < 3; k++) {
            const double along = directions[i][k];
            if (k == not_this || fabs(along) <= best) continue;
            best = fabs(along);
            taken = k;
            out[i] = ends[k][along < 0.0].to;
        }
    }
}

const char *hs_probe_name(hs_probe probe) {
    static const char *const names[HS_PROBE_COUNT] = {"-z", "+z", "-y", "+y", "-x", "+x"};
    return names[probe];
}
