/* SPDX-License-Identifier: MIT */
/* Motion: slow drift of the fetus and its particles, and limbs that move by themselves. */
#include "scene/scene_motion.h"

#include <math.h>

static float swing(float phase, float offset) {
    return sinf(phase + offset) - sinf(offset); /* 0 in frame 0 */
}

static void move_joint(float joint[3], float amplitude, float phase, int index) {
    /* Every joint has a direction and a phase of its own, a golden angle apart. */
    float offset = 2.3999632f * (float)index;
    joint[0] += amplitude * 0.5f * swing(phase, offset + 1.0f);
    joint[1] += amplitude * swing(phase, offset);
    joint[2] += amplitude * 0.6f * swing(phase, offset + 2.0f);
}

static void move_fetus(hs_fetus_spec *fetus, const hs_motion_spec *motion, float phase) {
    for (int a = 0; a < 3; a++) fetus->position[a] += motion->drift_mm[a] * swing(phase, 0.0f);
    for (int side = 0; side < 2; side++) {
        move_joint(fetus->pose.elbow[side], motion->limb_mm, phase, side);
        move_joint(fetus->pose.hand[side], 1.6f * motion->limb_mm, phase, 2 + side);
        move_joint(fetus->pose.knee[side], motion->limb_mm, phase, 4 + side);
        move_joint(fetus->pose.ankle[side], 1.4f * motion->limb_mm, phase, 6 + side);
    }
}

void hs_scene_move(hs_scene_spec *spec, uint32_t frame) {
    const hs_motion_spec *motion = &spec->motion;
    if (!motion->on || frame == 0) return;
    float phase = (float)(6.283185307179586 * fmod((double)frame / (double)motion->period_frames, 1.0));
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        hs_structure *s = &spec->structure[i];
        if (s->kind == HS_STRUCTURE_FETUS) move_fetus(&s->of.fetus, motion, phase);
        if (s->kind == HS_STRUCTURE_CLOUD)
            for (int a = 0; a < 3; a++)
                s->of.cloud.centre[a] += motion->cloud_drift_mm[a] * swing(phase, 0.7f * (float)i);
    }
}
