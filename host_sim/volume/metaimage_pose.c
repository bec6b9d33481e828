/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_pose.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#define SKEW 1e-3 /* the most by which squared lengths may miss 1, and scalar products 0 */

/* Reads `count` numbers, or as many as `other` if there are no more; *found tells. Nothing may follow. */
static bool read_numbers(const char *value, uint64_t count, uint64_t other, double *out, uint64_t *found) {
    for (*found = 0; *found < count; ++*found) {
        if (*found == other && hs_met_at_end(value)) return true;
        if (!hs_met_number(&value, &out[*found])) return false;
    }
    return hs_met_at_end(value);
}

static double dot(const double *m, int a, int b) {
    return m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b];
}

/* The file lists one axis' direction after the other: the columns of our matrix. In four dimensions the
 * fourth axis must be apart from the others; some programs leave it out. */
static bool read_directions(const hs_met_text *text, uint64_t dims, hs_pose *pose) {
    double file[16] = {0};
    uint64_t found;
    const bool numbers = read_numbers(text->fields[HS_MET_F_TRANSFORM].value, dims * dims, 9, file, &found);
    const uint64_t row = found == 16 ? 4 : 3;
    bool apart = true;
    for (int axis = 0; numbers && axis < 3; axis++) {
        for (int k = 0; k < 3; k++) pose->direction[k * 3 + axis] = file[(uint64_t)axis * row + (uint64_t)k];
        apart = apart && (row == 3 || (file[axis * 4 + 3] == 0 && file[12 + axis] == 0));
    }
    if (!numbers)
        return hs_met_bad_value(text, HS_MET_F_TRANSFORM, dims == 3 ? "9 numbers" : "16 numbers, or 9");
    if (!apart)
        return hs_met_bad_value(text, HS_MET_F_TRANSFORM, "a fourth axis that has no part in the others");
    const double *m = pose->direction;
    bool right = true;
    for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++) right = right && fabs(dot(m, a, b) - (a == b)) <= SKEW;
    return right || hs_met_bad_value(text, HS_MET_F_TRANSFORM,
                                     "three directions of length 1 at right angles to each other");
}

static bool read_offset(const hs_met_text *text, uint64_t dims, hs_pose *pose) {
    double file[4] = {0};
    uint64_t found;
    if (!hs_met_has(text, HS_MET_F_OFFSET)) return true;
    if (!read_numbers(text->fields[HS_MET_F_OFFSET].value, dims, 3, file, &found))
        return hs_met_bad_value(text, HS_MET_F_OFFSET, dims == 3 ? "3 numbers (mm)" : "4 numbers, or 3 (mm)");
    memcpy(pose->origin, file, sizeof pose->origin);
    return true;
}

static bool is_identity(const hs_pose *pose) {
    for (int i = 0; i < 9; i++)
        if (pose->direction[i] != (i % 4 == 0)) return false;
    return true;
}

bool hs_met_pose(const hs_met_text *text, uint64_t dims, hs_pose *pose) {
    const bool has_matrix = hs_met_has(text, HS_MET_F_TRANSFORM);
    const char *letters =
        hs_met_has(text, HS_MET_F_ANATOMICAL) ? text->fields[HS_MET_F_ANATOMICAL].value : "";
    const size_t known = strcspn(letters, "?");
    char spatial[4] = "", own[4];
    hs_pose_default(pose);
    if ((has_matrix && !read_directions(text, dims, pose)) || !read_offset(text, dims, pose)) return false;
    if (known == 0) { /* none, or "???": ITK writes that for every file of four dimensions */
        pose->stated = has_matrix && (*letters == '\0' || !is_identity(pose));
        return true;
    }
    /* In four dimensions the fourth letter says nothing about space. */
    const size_t count = strlen(letters);
    hs_pose lettered = *pose;
    memcpy(spatial, letters, count < 3 ? count : 3);
    if (count < 3 || count > dims || !hs_pose_from_letters(&lettered, spatial))
        return hs_met_bad_value(text, HS_MET_F_ANATOMICAL,
                                "three letters, one of R L, one of A P and one of I S, or ???");
    if (!has_matrix) *pose = lettered;
    pose->stated = true;
    hs_pose_letters(pose, own);
    if (strcasecmp(own, spatial) != 0)
        for (int i = 0; i < 3; i++) pose->contradicted[i] = (char)toupper((unsigned char)spatial[i]);
    return true;
}

bool hs_met_probe(const hs_met_text *text, hs_probe *probe) {
    static const char *const kinds[3] = {"MU", "NF", "AD"};
    static const hs_probe low[3] = {HS_PROBE_LOW_X, HS_PROBE_LOW_Y, HS_PROBE_LOW_Z};
    static const hs_probe high[3] = {HS_PROBE_HIGH_X, HS_PROBE_HIGH_Y, HS_PROBE_HIGH_Z};
    *probe = HS_PROBE_LOW_Z;
    if (!hs_met_has(text, HS_MET_F_ULTRASOUND)) return true;
    const char *value = text->fields[HS_MET_F_ULTRASOUND].value;
    const size_t count = strlen(value);
    bool seen[3] = {false};
    if (count > 0 && strspn(value, "X") == count) return true; /* unknown */
    bool ok = count == 3;
    for (int axis = 0; ok && axis < 3; axis++) {
        int kind = 0;
        while (kind < 3 && !strchr(kinds[kind], value[axis])) kind++;
        ok = kind < 3 && !seen[kind];
        if (ok) seen[kind] = true;
        if (kind == 1) *probe = value[axis] == 'F' ? low[axis] : high[axis];
    }
    return ok || hs_met_bad_value(text, HS_MET_F_ULTRASOUND,
                                  "three letters, one of M U, one of N F and one of A D, or XX");
}
