/* SPDX-License-Identifier: MIT */
/* The fetus as smooth-blended solids in a pose. */
#include "scene/scene_solid.h"

#include <math.h>
#include <string.h>

hs_solid_frame hs_fetus_frame(const hs_fetus_spec *fetus) {
    hs_solid_frame frame = hs_frame_at(fetus->position, fetus->rotation);
    frame.scale = fetus->scale;
    return frame;
}

static const float neck_pivot[3] = {0.0f, -15.0f, 4.0f};

/* The frame of the head, turned about the neck. */
static hs_solid_frame head_frame(const hs_solid_frame *body, const float turn_deg[3]) {
    hs_solid_frame head = {.scale = body->scale};
    float turn[9];
    hs_rotation(turn_deg, turn);
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 3; i++) {
            float sum = 0.0f;
            for (int k = 0; k < 3; k++) sum += turn[3 * row + k] * body->axis[3 * k + i];
            head.axis[3 * row + i] = sum;
        }
    /* The pivot stays where it is: origin = pivot in the scene - turned pivot. */
    float pivot[3], turned[3];
    hs_frame_point(body, neck_pivot, pivot);
    hs_frame_point(&head, neck_pivot, turned);
    for (int i = 0; i < 3; i++) head.origin[i] = pivot[i] - turned[i];
    return head;
}

static void skin(hs_solid_list *list, const hs_solid_frame *f, float blend, const float c[3],
                 const float r[3]) {
    hs_solid_ellipsoid(list, f, HS_PART_SKIN, HS_TISSUE_SOFT, blend, c, r);
}

static void skin_tube(hs_solid_list *list, const hs_solid_frame *f, float blend, const float a[3], float ra,
                      const float b[3], float rb) {
    hs_solid_cone(list, f, HS_PART_SKIN, HS_TISSUE_SOFT, blend, a, ra, b, rb);
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
    skin_tube(list, f, 5.0f, neck[0], 7.0f, neck[1], 8.0f);
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

static const float skull_centre[3] = {0.0f, -37.0f, 2.0f};
static const float skull_radii[3] = {14.0f, 15.5f, 17.0f};

static void face_skin(hs_solid_list *list, const hs_solid_frame *f) {
    static const float scalp[3] = {16, 17.5f, 19};
    skin(list, f, 4.0f, skull_centre, scalp);
    static const float parts[][7] = {
        {0, -25, -6.5f, 11.5f, 11, 9, 4.0f},          /* lower face */
        {0, -19.5f, -10.5f, 6, 4.5f, 5, 3.0f},        /* muzzle */
        {-6.8f, -24, -10.5f, 4.6f, 4.8f, 4.4f, 3.0f}, /* cheeks */
        {6.8f, -24, -10.5f, 4.6f, 4.8f, 4.4f, 3.0f},
        {0, -14.6f, -11.2f, 3.6f, 3, 3.4f, 2.5f},        /* chin */
        {-1.9f, -24.2f, -16.2f, 1.6f, 1.4f, 1.7f, 1.0f}, /* wings of the nose */
        {1.9f, -24.2f, -16.2f, 1.6f, 1.4f, 1.7f, 1.0f},
        {0, -24.6f, -18.0f, 1.9f, 1.7f, 2.0f, 1.2f}, /* tip of the nose */
        {-16.0f, -30, 3, 1.7f, 4.8f, 3.2f, 1.5f},    /* ears */
        {16.0f, -30, 3, 1.7f, 4.8f, 3.2f, 1.5f},
    };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        skin(list, f, parts[i][6], parts[i], parts[i] + 3);
    static const float bridge[2][3] = {{0, -30.5f, -14.8f}, {0, -25.5f, -17.2f}};
    skin_tube(list, f, 1.6f, bridge[0], 1.5f, bridge[1], 1.7f);
    static const float lips[2][2][3] = {{{-3.0f, -20.2f, -14.6f}, {3.0f, -20.2f, -14.6f}},
                                        {{-2.5f, -17.6f, -14.2f}, {2.5f, -17.6f, -14.2f}}};
    for (int i = 0; i < 2; i++) skin_tube(list, f, 1.0f, lips[i][0], 1.4f, lips[i][1], 1.4f);
}

/* Orbits are cut wide and filled again by the closed lids, so that their rims stand out. */
static void face_carved(hs_solid_list *list, const hs_solid_frame *f) {
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float orbit[3] = {6.2f * side, -30.2f, -16.4f}, radii[3] = {4.4f, 2.9f, 4.2f};
        hs_solid_ellipsoid(list, f, HS_PART_CARVE, HS_TISSUE_SOFT, 1.5f, orbit, radii);
        const float nostril[3] = {1.2f * side, -23.0f, -18.0f}, small[3] = {0.6f, 0.6f, 0.9f};
        hs_solid_ellipsoid(list, f, HS_PART_CARVE, HS_TISSUE_SOFT, 0.3f, nostril, small);
    }
    static const float mouth[2][3] = {{-3.4f, -18.9f, -16.0f}, {3.4f, -18.9f, -16.0f}};
    hs_solid_cone(list, f, HS_PART_CARVE, HS_TISSUE_SOFT, 0.8f, mouth[0], 0.7f, mouth[1], 0.7f);
}

static void skull_bones(hs_solid_list *list, const hs_solid_frame *f) {
    static const float brain[3] = {13.2f, 14.7f, 16.2f};
    hs_solid_ellipsoid(list, f, HS_PART_ORGAN, HS_TISSUE_BRAIN, 0.0f, skull_centre, brain);
    hs_solid_shell(list, f, HS_PART_BONE, HS_TISSUE_BONE, skull_centre, skull_radii, 1.8f);
    static const float midline[2][3] = {{0, -24.0f, -12.5f}, {0, -20.0f, -11.0f}};
    bone(list, f, midline[0], 1.6f, midline[1], 1.8f);
    static const float nasal[2][3] = {{0, -29.5f, -14.6f}, {0, -26.8f, -15.8f}};
    bone(list, f, nasal[0], 0.6f, nasal[1], 0.5f);
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float zygoma[2][3] = {{3.2f * side, -25.6f, -11.5f}, {10.0f * side, -26.5f, -7.0f}};
        bone(list, f, zygoma[0], 0.9f, zygoma[1], 0.9f);
        const float jaw[3][3] = {
            {0, -14.6f, -11.6f}, {6.0f * side, -17.0f, -7.5f}, {9.6f * side, -23.0f, -1.0f}};
        bone(list, f, jaw[0], 0.9f, jaw[1], 0.9f);
        bone(list, f, jaw[1], 0.9f, jaw[2], 0.8f);
    }
}

static void head(hs_solid_list *list, const hs_solid_frame *f) {
    face_skin(list, f);
    face_carved(list, f);
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float lid[3] = {6.0f * side, -30.0f, -11.6f}, radii[3] = {3.4f, 2.6f, 3.0f};
        hs_solid_ellipsoid(list, f, HS_PART_PATCH, HS_TISSUE_SOFT, 0.3f, lid, radii);
    }
    skull_bones(list, f);
}

/* Adds a bone between two shares, `from` and `to`, of the way from a to b. */
static void long_bone(hs_solid_list *list, const hs_solid_frame *f, const float a[3], const float b[3],
                      float from, float to, float radius) {
    float p[3], q[3];
    for (int i = 0; i < 3; i++) {
        p[i] = a[i] + from * (b[i] - a[i]);
        q[i] = a[i] + to * (b[i] - a[i]);
    }
    bone(list, f, p, radius, q, radius);
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
    skin_tube(list, f, 1.5f, wrist, 2.2f, palm, 2.5f);
    for (int k = 0; k < 5; k++) {
        float spread = k < 4 ? ((float)k - 1.5f) * 1.5f : -3.4f; /* the last is the thumb */
        float reach = k < 4 ? 8.0f - 0.5f * fabsf((float)k - 1.2f) : 4.5f;
        float from[3], to[3];
        for (int i = 0; i < 3; i++) {
            from[i] = palm[i] + 0.8f * along[i] + spread * 0.6f * across[i];
            to[i] = wrist[i] + reach * along[i] + spread * 1.25f * across[i];
        }
        skin_tube(list, f, 0.5f, from, 1.0f, to, 0.8f);
        long_bone(list, f, from, to, 0.0f, 0.8f, 0.35f);
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
    skin_tube(list, f, 1.5f, heel, 2.7f, ball, 2.3f);
    long_bone(list, f, heel, ball, 0.1f, 0.9f, 0.7f);
    for (int k = 0; k < 5; k++) {
        float tip[3];
        for (int i = 0; i < 3; i++) tip[i] = ball[i] + (2.9f - 0.35f * (float)k) * toe[i] / length;
        tip[0] += ((float)k - 2.0f) * 1.05f * side;
        skin_tube(list, f, 0.4f, tip, k ? 0.85f : 1.2f, tip, 0.8f);
    }
}

static void limbs(hs_solid_list *list, const hs_solid_frame *f, const hs_fetus_pose *pose) {
    for (int i = 0; i < 2; i++) {
        float side = i == 0 ? -1.0f : 1.0f;
        const float shoulder[3] = {15.5f * side, -7.0f, 4.0f}, hip[3] = {8.0f * side, 35.0f, 5.0f};
        skin_tube(list, f, 3.0f, shoulder, 4.4f, pose->elbow[i], 3.5f);
        skin_tube(list, f, 1.2f, pose->elbow[i], 3.5f, pose->hand[i], 2.5f);
        long_bone(list, f, shoulder, pose->elbow[i], 0.06f, 0.92f, 1.1f);
        long_bone(list, f, pose->elbow[i], pose->hand[i], 0.08f, 0.95f, 1.0f);
        hand(list, f, pose->elbow[i], pose->hand[i], side);
        skin_tube(list, f, 4.0f, hip, 7.0f, pose->knee[i], 5.0f);
        skin_tube(list, f, 1.5f, pose->knee[i], 4.8f, pose->ankle[i], 3.0f);
        long_bone(list, f, hip, pose->knee[i], 0.08f, 0.94f, 1.3f);
        long_bone(list, f, pose->knee[i], pose->ankle[i], 0.06f, 0.95f, 1.1f);
        foot(list, f, pose->knee[i], pose->ankle[i], side);
    }
}

void hs_fetus_solids(hs_solid_list *list, const hs_fetus_spec *fetus, uint32_t body) {
    const hs_solid_frame frame = hs_fetus_frame(fetus),
                         of_head = head_frame(&frame, fetus->pose.head_turn_deg);
    const size_t before = list->count;
    trunk_skin(list, &frame);
    trunk_bones(list, &frame);
    spine(list, &frame);
    head(list, &of_head);
    limbs(list, &frame, &fetus->pose);
    for (size_t i = before; i < list->count; i++) list->items[i].body = (uint8_t)body;
}

void hs_fetus_skull(const hs_fetus_spec *fetus, hs_solid *skull) {
    const hs_solid_frame body = hs_fetus_frame(fetus), of_head = head_frame(&body, fetus->pose.head_turn_deg);
    *skull = (hs_solid){.shape = HS_SOLID_ELLIPSOID};
    hs_frame_point(&of_head, skull_centre, skull->centre);
    memcpy(skull->axis, of_head.axis, sizeof skull->axis);
    float largest = 0.0f;
    for (int i = 0; i < 3; i++) {
        skull->radii[i] = of_head.scale * skull_radii[i];
        if (skull->radii[i] > largest) largest = skull->radii[i];
    }
    for (int i = 0; i < 3; i++) {
        skull->low[i] = skull->centre[i] - largest;
        skull->high[i] = skull->centre[i] + largest;
    }
}
