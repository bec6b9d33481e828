/* SPDX-License-Identifier: MIT */
#include "scene/scene_fetus.h"

#include "scene/scene_fetus_head.h"
#include "scene/scene_fetus_limbs.h"

#include <string.h>

const hs_fetus_pose hs_fetus_resting = {
    .elbow = {{-21.0f, 10.0f, -7.0f}, {21.0f, 11.0f, -6.0f}},
    .hand = {{-7.0f, 1.0f, -19.0f}, {9.0f, -5.0f, -18.0f}},
    .knee = {{-15.0f, 21.0f, -18.0f}, {16.0f, 23.0f, -17.0f}},
    .ankle = {{3.0f, 40.0f, -19.0f}, {-4.0f, 44.0f, -14.0f}},
};

hs_solid_frame hs_fetus_frame(const hs_fetus_spec *fetus) {
    hs_solid_frame frame = {.scale = fetus->scale};
    memcpy(frame.origin, fetus->position, sizeof frame.origin);
    hs_rotation(fetus->rotation, frame.axis);
    return frame;
}

static const float neck_pivot[3] = {0.0f, -15.0f, 4.0f};

void hs_fetus_head_frame(const hs_solid_frame *body, const float turn_deg[3], hs_solid_frame *head) {
    float turn[9];
    hs_rotation(turn_deg, turn);
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 3; i++) {
            float sum = 0.0f;
            for (int k = 0; k < 3; k++) sum += turn[3 * row + k] * body->axis[3 * k + i];
            head->axis[3 * row + i] = sum;
        }
    head->scale = body->scale;
    /* The pivot stays where it is: origin = pivot in the scene - turned pivot. */
    float pivot[3], turned[3];
    hs_frame_point(body, neck_pivot, pivot);
    memset(head->origin, 0, sizeof head->origin);
    hs_frame_point(head, neck_pivot, turned);
    for (int i = 0; i < 3; i++) head->origin[i] = pivot[i] - turned[i];
}

static void skin(hs_solid_list *list, const hs_solid_frame *f, float blend, const float c[3],
                 const float r[3]) {
    hs_solid_ellipsoid(list, f, HS_PART_SKIN, HS_TISSUE_SOFT, blend, c, r);
}

static void bone(hs_solid_list *list, const hs_solid_frame *f, const float a[3], float ra, const float b[3],
                 float rb) {
    hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, a, ra, b, rb);
}

static void trunk_skin(hs_solid_list *list, const hs_solid_frame *f) {
    static const float bodies[][6] = {
        {0, 2, 5, 16.5f, 17, 12.5f},                             /* chest */
        {0, 19, 4, 15.5f, 15, 13},                               /* abdomen */
        {0, 33, 7, 13, 10, 10.5f},                               /* pelvis */
        {-14, -7, 5, 6, 6, 6},                                   /* shoulders */
        {14, -7, 5, 6, 6, 6},        {-7.5f, 38, 8, 7.5f, 7, 8}, /* buttocks */
        {7.5f, 38, 8, 7.5f, 7, 8},
    };
    for (size_t i = 0; i < sizeof bodies / sizeof bodies[0]; i++)
        skin(list, f, 6.0f, bodies[i], bodies[i] + 3);
    static const float neck[2][3] = {{0, -21, 4}, {0, -10, 5}};
    hs_solid_cone(list, f, HS_PART_SKIN, HS_TISSUE_SOFT, 5.0f, neck[0], 7.0f, neck[1], 8.0f);
}

/* Vertebrae as short tubes with gaps between them, following the back's curve. */
static void spine(hs_solid_list *list, const hs_solid_frame *f) {
    const int count = 24;
    for (int i = 0; i < count; i++) {
        float t = ((float)i + 0.5f) / (float)count, u = 2.0f * t - 1.0f;
        float a[3] = {0, -19.0f + 58.0f * t, 13.2f - 4.5f * u * u};
        float body[3] = {a[0], a[1], a[2] - 2.6f};
        bone(list, f, body, 0.85f, body, 0.85f);
        for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
            float arch[3] = {1.7f * side, a[1], a[2]};
            bone(list, f, arch, 0.75f, arch, 0.75f);
        }
    }
}

static void trunk_bones(hs_solid_list *list, const hs_solid_frame *f) {
    static const float cage_centre[3] = {0, 3, 5}, cage_radii[3] = {14.0f, 17, 10.3f};
    hs_solid_ribs(list, f, cage_centre, cage_radii, 1.1f, 3.0f, -0.35f, 14.0f);
    static const float sternum[2][3] = {{0, -6, -5.2f}, {0, 7, -6.6f}};
    bone(list, f, sternum[0], 1.1f, sternum[1], 0.9f);
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float clavicle[2][3] = {{2.0f * side, -8.5f, -3.0f}, {12.5f * side, -9.5f, 2.0f}};
        bone(list, f, clavicle[0], 0.8f, clavicle[1], 0.8f);
        const float ilium[2][3] = {{10.5f * side, 27.5f, 3.5f}, {5.0f * side, 34.0f, 11.0f}};
        bone(list, f, ilium[0], 1.2f, ilium[1], 1.1f);
        const float scapula[2][3] = {{11.0f * side, -5.0f, 14.0f}, {9.0f * side, 5.0f, 15.5f}};
        bone(list, f, scapula[0], 0.9f, scapula[1], 0.7f);
    }
}

void hs_fetus_solids(hs_solid_list *list, const hs_solid_frame *frame, const hs_fetus_pose *pose) {
    hs_solid_frame head;
    hs_fetus_head_frame(frame, pose->head_turn_deg, &head);
    trunk_skin(list, frame);
    trunk_bones(list, frame);
    spine(list, frame);
    hs_fetus_head(list, &head);
    hs_fetus_limbs(list, frame, pose);
}
