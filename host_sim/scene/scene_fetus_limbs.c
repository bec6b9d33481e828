/* SPDX-License-Identifier: MIT */
#include "scene/scene_fetus_limbs.h"

#include <math.h>

static const hs_tissue soft = HS_TISSUE_SOFT;

static void bone(hs_solid_list *list, const hs_solid_frame *f, const float a[3], const float b[3], float from,
                 float to, float radius) {
    float p[3], q[3];
    for (int i = 0; i < 3; i++) {
        p[i] = a[i] + from * (b[i] - a[i]);
        q[i] = a[i] + to * (b[i] - a[i]);
    }
    hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, p, radius, q, radius);
}

static void unit(const float a[3], const float b[3], float out[3]) {
    float length = 0.0f;
    for (int i = 0; i < 3; i++) {
        out[i] = b[i] - a[i];
        length += out[i] * out[i];
    }
    length = sqrtf(length);
    for (int i = 0; i < 3; i++) out[i] = length > 1e-3f ? out[i] / length : i == 1;
}

/* Palm, four fingers and a thumb, spread in the plane of the forearm and the fetus' x axis. */
static void hand(hs_solid_list *list, const hs_solid_frame *f, const float elbow[3], const float wrist[3],
                 float side) {
    float along[3], across[3];
    unit(elbow, wrist, along);
    float dot = along[0] * side;
    float norm = sqrtf(fmaxf(1.0f - dot * dot, 1e-3f));
    for (int i = 0; i < 3; i++) across[i] = ((i == 0 ? side : 0.0f) - dot * along[i]) / norm;
    float palm[3];
    for (int i = 0; i < 3; i++) palm[i] = wrist[i] + 2.6f * along[i];
    hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.5f, wrist, 2.2f, palm, 2.5f);
    for (int k = 0; k < 5; k++) {
        float spread = k < 4 ? ((float)k - 1.5f) * 1.5f : -3.4f; /* the last is the thumb */
        float reach = k < 4 ? 8.0f - 0.5f * fabsf((float)k - 1.2f) : 4.5f;
        float from[3], to[3];
        for (int i = 0; i < 3; i++) {
            from[i] = palm[i] + 0.8f * along[i] + spread * 0.6f * across[i];
            to[i] = wrist[i] + reach * along[i] + spread * 1.25f * across[i];
        }
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 0.5f, from, 1.0f, to, 0.8f);
        bone(list, f, from, to, 0.0f, 0.8f, 0.35f);
    }
}

static void foot(hs_solid_list *list, const hs_solid_frame *f, const float knee[3], const float ankle[3],
                 float side) {
    float along[3];
    unit(knee, ankle, along);
    /* The foot points to the viewer and a little inwards, square to the shin as far as it can. */
    float toe[3] = {-0.5f * side, 0.25f, -1.0f};
    float dot = toe[0] * along[0] + toe[1] * along[1] + toe[2] * along[2];
    float length = 0.0f;
    for (int i = 0; i < 3; i++) {
        toe[i] -= 0.7f * dot * along[i];
        length += toe[i] * toe[i];
    }
    length = sqrtf(length);
    float heel[3], ball[3];
    for (int i = 0; i < 3; i++) {
        heel[i] = ankle[i] + 1.5f * along[i] - 1.5f * toe[i] / length;
        ball[i] = ankle[i] + 2.2f * along[i] + 7.5f * toe[i] / length;
    }
    hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.5f, heel, 2.7f, ball, 2.3f);
    bone(list, f, heel, ball, 0.1f, 0.9f, 0.7f);
    for (int k = 0; k < 5; k++) {
        float tip[3];
        for (int i = 0; i < 3; i++) tip[i] = ball[i] + (2.9f - 0.35f * (float)k) * toe[i] / length;
        tip[0] += ((float)k - 2.0f) * 1.05f * side;
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 0.4f, tip, k ? 0.85f : 1.2f, tip, 0.8f);
    }
}

void hs_fetus_limbs(hs_solid_list *list, const hs_solid_frame *f, const hs_fetus_pose *pose) {
    for (int i = 0; i < 2; i++) {
        float side = i == 0 ? -1.0f : 1.0f;
        const float shoulder[3] = {15.5f * side, -7.0f, 4.0f}, hip[3] = {8.0f * side, 35.0f, 5.0f};
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 3.0f, shoulder, 4.4f, pose->elbow[i], 3.5f);
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.2f, pose->elbow[i], 3.5f, pose->hand[i], 2.5f);
        bone(list, f, shoulder, pose->elbow[i], 0.06f, 0.92f, 1.1f);
        bone(list, f, pose->elbow[i], pose->hand[i], 0.08f, 0.95f, 1.0f);
        hand(list, f, pose->elbow[i], pose->hand[i], side);
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 4.0f, hip, 7.0f, pose->knee[i], 5.0f);
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.5f, pose->knee[i], 4.8f, pose->ankle[i], 3.0f);
        bone(list, f, hip, pose->knee[i], 0.08f, 0.94f, 1.3f);
        bone(list, f, pose->knee[i], pose->ankle[i], 0.06f, 0.95f, 1.1f);
        foot(list, f, pose->knee[i], pose->ankle[i], side);
    }
}
