/* SPDX-License-Identifier: MIT */
#include "scene/scene_ranges.h"

#include "scene/scene_random.h"

#define SHARE(key, percent, what)                                                                            \
    { key, "%", 100 * (percent), 100 * (percent), 100, what }

const hs_range hs_scene_ranges[HS_RANGE_COUNT] = {
    [HS_RANGE_NO_FETUS] = SHARE("share_no_fetus", 5, "a scan without a fetus"),
    [HS_RANGE_BARE] = SHARE("share_bare", 6, "nothing lies before the fetus"),
    [HS_RANGE_TWINS] =
        SHARE("share_twins", 6, "two fetuses; more often than they are born, so that a set has some"),
    [HS_RANGE_LATERAL] = SHARE("share_lateral_camera", 9, "the camera looks from the side of the beams"),
    [HS_RANGE_FRONTAL] = SHARE("share_frontal_camera", 9, "the probe sees a profile, the camera the face"),
    [HS_RANGE_FROM_BEHIND] = SHARE("share_from_behind", 12, "the fetus turns its back, as in M03 and D02"),
    [HS_RANGE_CONTACT] = SHARE("share_contact", 25, "an occluder touches the fetus over some area"),
    [HS_RANGE_LIMB_CONTACT] =
        SHARE("share_limb_contact", 12, "what protrudes most of the fetus touches the wall"),
    [HS_RANGE_LIMB_FORWARD] =
        SHARE("share_limb_forward", 40, "a hand or knee is stretched to the probe, as in E02 to E04"),
    [HS_RANGE_BLADDER] =
        SHARE("share_bladder", 12, "a bladder before the uterus: a full one is asked for early scans"),
    [HS_RANGE_NUCHAL] =
        SHARE("share_nuchal_cord", 8, "a cord round the neck: so many at 10 to 14 weeks [14]"),
    [HS_RANGE_CORD] = SHARE("share_cord", 45, "a cord across the fluid"),
    [HS_RANGE_CLOUD] = SHARE("share_cloud", 45, "particles in the fluid"),
    [HS_RANGE_SOFT] = SHARE("share_soft_edge", 60, "an occluder with a soft edge"),
    [HS_RANGE_HAZE] = SHARE("share_haze", 70, "haze behind the wall"),
    [HS_RANGE_THICK] = SHARE("share_slice_thickness", 60, "a thick slice"),
    [HS_RANGE_CORNER] =
        SHARE("share_dark_corner", 35, "a corner without contact, the lower right one most often"),
    [HS_RANGE_EDGE] = SHARE("share_edge_shadow", 80, "edge shadows"),
    [HS_RANGE_REVERBERATION] = SHARE("share_reverberation", 60, "bands behind the wall"),
    [HS_RANGE_SIDE_LOBES] = SHARE("share_side_lobes", 40, "haze beside strong interfaces"),
    [HS_RANGE_FREQUENCY] = {"frequency_mhz", "MHz", 250, 500, 25, "abdominal 3D probes"},
    [HS_RANGE_DYNAMIC] = {"dynamic_range_db", "dB", 5500, 6500, 100, "around the nine cases' 60"},
    [HS_RANGE_GAIN] = {"gain_db", "dB", 200, 900, 50, "the nine cases have 6 or 8"},
    [HS_RANGE_TGC] = {"tgc_db_cm_mhz", "dB / (cm MHz)", 13, 23, 1, "the nine cases have 0.16 to 0.21"},
    [HS_RANGE_FAT] = {"fat_mm", "mm", 300, 1400, 50, "thin to thick abdominal walls"},
    [HS_RANGE_MUSCLE] = {"muscle_mm", "mm", 400, 900, 50, "the nine cases have 7"},
    [HS_RANGE_UNDULATION] = {"undulation_mm", "mm", 0, 300, 25, "the nine cases have 1.5"},
    [HS_RANGE_SAC_X] = {"sac_x_mm", "mm", 5000, 6200, 100, "radius; the nine cases have 52 or 57"},
    [HS_RANGE_SAC_Y] = {"sac_y_mm", "mm", 5800, 6800, 100, "radius; the nine cases have 59 or 62"},
    [HS_RANGE_SAC_Z] = {"sac_z_mm", "mm", 3600, 4600, 100, "radius; the nine cases have 38"},
    [HS_RANGE_ROUGHNESS] = {"roughness_mm", "mm", 50, 300, 25, "height of the wall's bumps"},
    [HS_RANGE_SCALE] = {"scale", "", 66, 100, 2, "59 to 90 mm from crown to rump, 12 to 14 weeks"},
    [HS_RANGE_TWIN_SCALE] = {"twin_scale", "", 52, 66, 2, "two of them have room in the volume"},
    [HS_RANGE_PLACE] = {"place_mm", "mm", -600, 600, 50, "of the fetus, from the middle, in x and in y"},
    [HS_RANGE_NOD] = {"nod_deg", "degrees", -1200, 1200, 100, "about x and about z"},
    [HS_RANGE_TURN] = {"turn_deg", "degrees", -3500, 3500, 100, "about y; from behind: 180 more"},
    [HS_RANGE_CAMERA] = {"camera_deg", "degrees", 5500, 9500, 500,
                         "about y, to either side: far off the beams"},
    [HS_RANGE_JOINT] = {"joint_mm", "mm", -300, 300, 25, "of every joint, along every axis, at scale 1"},
    [HS_RANGE_FORWARD] = {"forward_mm", "mm", 400, 1600, 50, "a stretched limb, at scale 1"},
    [HS_RANGE_GAP] = {"gap_mm", "mm", 200, 3000, 25,
                      "fluid before the fetus where it is thinnest: hardly any to plenty"},
    [HS_RANGE_OVERLAP] = {"overlap_mm", "mm", 100, 500, 25, "how far what touches presses in"},
    [HS_RANGE_OCCLUDERS] = {"occluders", "", 100, 300, 100, "folds of placenta or uterus"},
    [HS_RANGE_ASIDE] = {"aside_mm", "mm", -1800, 1800, 50, "of an occluder, from the middle, in x and in y"},
    [HS_RANGE_ACROSS] = {"across_mm", "mm", 1400, 3000, 50, "radius of an occluder in x and in y"},
    [HS_RANGE_PROTRUSION] = {"protrusion_mm", "mm", 300, 1200, 25,
                             "how far the nearest occluder stands into the sac"},
    [HS_RANGE_BLEND] = {"blend_mm", "mm", 0, 400, 50, "of an occluder into the one before it"},
    [HS_RANGE_BRIGHTNESS] = {"echo_db", "dB", -1200, 600, 50,
                             "of an occluder: dim ones come close to haze, bright ones to bone"},
    [HS_RANGE_SOFT_MM] = {"soft_mm", "mm", 100, 500, 25,
                          "of an occluder's edge: a chorionic plate or a haematoma"},
    [HS_RANGE_LOOPS] = {"loops", "", 100, 200, 100, "of a cord round the neck"},
    [HS_RANGE_CORD_RADIUS] = {"cord_radius_mm", "mm", 200, 350, 10, "the nine cases have 2.8 or 3"},
    [HS_RANGE_PARTICLES] = {"particles", "", 2000, 12000, 100, "the nine cases have 45 to 110"},
    [HS_RANGE_BLADDER_X] = {"bladder_x_mm", "mm", 1800, 3000, 100, "radius in x; in y two thirds of it"},
    [HS_RANGE_BLADDER_Z] = {"bladder_z_mm", "mm", 350, 800, 25, "radius in z"},
    [HS_RANGE_HAZE_LEVEL] = {"haze_level_db", "dB", -1600, -300, 100,
                             "against the wall's echo; -30 to 0 was found in bladders [15]"},
    [HS_RANGE_HAZE_DECAY] = {"haze_decay_db_mm", "dB / mm", 30, 150, 10,
                             "out of sight 5 to 40 mm behind the wall"},
    [HS_RANGE_HAZE_PATCH] = {"haze_patch_db", "dB", 0, 800, 100, "clutter is uneven"},
    [HS_RANGE_ELEVATION] = {"elevation_mm", "mm", 60, 180, 10,
                            "standard deviation: slices 1.5 to 4 mm thick at the focus"},
    [HS_RANGE_THICK_FOCUS] = {"slice_focus_mm", "mm", 4000, 8000, 500, "the lens is fixed"},
    [HS_RANGE_THICK_RAYLEIGH] = {"slice_rayleigh_mm", "mm", 1500, 4000, 100,
                                 "of the order of 4 pi sigma^2 / wavelength"},
    [HS_RANGE_CORNER_LOSS] = {"corner_loss_db", "dB", 800, 3000, 100, "from hardly seen to nothing left"},
    [HS_RANGE_CORNER_TURN] = {"corner_deg", "degrees", 1500, 7500, 500, "0 to the right, 90 down"},
    [HS_RANGE_AXIAL] = {"axial_mm", "mm", 30, 60, 5, "the nine cases have 0.4"},
    [HS_RANGE_LATERAL_MM] = {"lateral_mm", "mm", 50, 100, 5, "the nine cases have 0.6"},
    [HS_RANGE_FOCUS] = {"focus_mm", "mm", 4500, 7500, 500, "the nine cases have 60"},
    [HS_RANGE_NOISE] = {"noise_db", "dB", -7400, -6600, 100, "the nine cases have -67"},
};

int32_t hs_range_draw(uint64_t key, hs_range_id id, uint32_t k) {
    const hs_range *r = &hs_scene_ranges[id];
    const uint64_t count = (uint64_t)((r->high - r->low) / r->step) + 1u;
    const uint64_t bits = hs_random_bits(key, ((uint64_t)id << 8) + k) >> 32;
    return r->low + r->step * (int32_t)(bits * count >> 32);
}

bool hs_range_has(uint64_t key, hs_range_id id) {
    const uint64_t bits = hs_random_bits(key, ((uint64_t)id << 8) + 255u) >> 32;
    return (int32_t)(bits * 10000u >> 32) < hs_scene_ranges[id].low;
}
