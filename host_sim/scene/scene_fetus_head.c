/* SPDX-License-Identifier: MIT */
#include "scene/scene_fetus_head.h"

#include <string.h>

static const float skull_centre[3] = {0.0f, -37.0f, 2.0f};
static const float skull_radii[3] = {14.0f, 15.5f, 17.0f};

static const hs_tissue soft = HS_TISSUE_SOFT;

static void face_skin(hs_solid_list *list, const hs_solid_frame *f) {
    static const float scalp[3] = {16, 17.5f, 19};
    hs_solid_ellipsoid(list, f, HS_PART_SKIN, soft, 4.0f, skull_centre, scalp);
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
        hs_solid_ellipsoid(list, f, HS_PART_SKIN, soft, parts[i][6], parts[i], parts[i] + 3);
    static const float bridge[2][3] = {{0, -30.5f, -14.8f}, {0, -25.5f, -17.2f}};
    hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.6f, bridge[0], 1.5f, bridge[1], 1.7f);
    static const float lips[2][2][3] = {{{-3.0f, -20.2f, -14.6f}, {3.0f, -20.2f, -14.6f}},
                                        {{-2.5f, -17.6f, -14.2f}, {2.5f, -17.6f, -14.2f}}};
    for (int i = 0; i < 2; i++)
        hs_solid_cone(list, f, HS_PART_SKIN, soft, 1.0f, lips[i][0], 1.4f, lips[i][1], 1.4f);
}

/* Orbits are cut wide and filled again by the closed lids, so that their rims stand out. */
static void face_carved(hs_solid_list *list, const hs_solid_frame *f) {
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float orbit[3] = {6.2f * side, -30.2f, -16.4f}, radii[3] = {4.4f, 2.9f, 4.2f};
        hs_solid_ellipsoid(list, f, HS_PART_CARVE, soft, 1.5f, orbit, radii);
        const float nostril[3] = {1.2f * side, -23.0f, -18.0f}, small[3] = {0.6f, 0.6f, 0.9f};
        hs_solid_ellipsoid(list, f, HS_PART_CARVE, soft, 0.3f, nostril, small);
    }
    static const float mouth[2][3] = {{-3.4f, -18.9f, -16.0f}, {3.4f, -18.9f, -16.0f}};
    hs_solid_cone(list, f, HS_PART_CARVE, soft, 0.8f, mouth[0], 0.7f, mouth[1], 0.7f);
}

static void skull(hs_solid_list *list, const hs_solid_frame *f) {
    static const float brain[3] = {13.2f, 14.7f, 16.2f};
    hs_solid_ellipsoid(list, f, HS_PART_ORGAN, HS_TISSUE_BRAIN, 0.0f, skull_centre, brain);
    hs_solid_shell(list, f, HS_PART_BONE, HS_TISSUE_BONE, skull_centre, skull_radii, 1.8f);
    static const float midline[2][3] = {{0, -24.0f, -12.5f}, {0, -20.0f, -11.0f}};
    hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, midline[0], 1.6f, midline[1], 1.8f);
    static const float nasal[2][3] = {{0, -29.5f, -14.6f}, {0, -26.8f, -15.8f}};
    hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, nasal[0], 0.6f, nasal[1], 0.5f);
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float zygoma[2][3] = {{3.2f * side, -25.6f, -11.5f}, {10.0f * side, -26.5f, -7.0f}};
        hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, zygoma[0], 0.9f, zygoma[1], 0.9f);
        const float jaw[3][3] = {
            {0, -14.6f, -11.6f}, {6.0f * side, -17.0f, -7.5f}, {9.6f * side, -23.0f, -1.0f}};
        hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, jaw[0], 0.9f, jaw[1], 0.9f);
        hs_solid_cone(list, f, HS_PART_BONE, HS_TISSUE_BONE, 0.0f, jaw[1], 0.9f, jaw[2], 0.8f);
    }
}

void hs_fetus_head(hs_solid_list *list, const hs_solid_frame *frame) {
    face_skin(list, frame);
    face_carved(list, frame);
    for (float side = -1.0f; side <= 1.0f; side += 2.0f) {
        const float lid[3] = {6.0f * side, -30.0f, -11.6f}, radii[3] = {3.4f, 2.6f, 3.0f};
        hs_solid_ellipsoid(list, frame, HS_PART_PATCH, soft, 0.3f, lid, radii);
    }
    skull(list, frame);
}

void hs_fetus_skull(const hs_solid_frame *head, hs_solid *skull) {
    memset(skull, 0, sizeof *skull);
    skull->shape = HS_SOLID_ELLIPSOID;
    hs_frame_point(head, skull_centre, skull->centre);
    memcpy(skull->axis, head->axis, sizeof skull->axis);
    float largest = 0.0f;
    for (int i = 0; i < 3; i++) {
        skull->radii[i] = head->scale * skull_radii[i];
        if (skull->radii[i] > largest) largest = skull->radii[i];
    }
    for (int i = 0; i < 3; i++) {
        skull->low[i] = skull->centre[i] - largest;
        skull->high[i] = skull->centre[i] + largest;
    }
}
