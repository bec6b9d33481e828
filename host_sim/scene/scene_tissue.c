/* SPDX-License-Identifier: MIT */
#include "scene/scene_tissue.h"

/*
 * Attenuation, impedance and speed of sound after Duck, "Physical Properties of Tissue" (1990), chapter 4,
 * and Szabo, "Diagnostic Ultrasound Imaging: Inside Out" (2nd ed., 2014), appendix B. Fetal bone is less
 * mineralised than adult bone, so its impedance and attenuation lie at the lower end of what is given for
 * bone. Echo levels are set against the display: bone near the top, fluid below its range.
 */
const hs_tissue_properties hs_tissue_defaults[HS_TISSUE_COUNT] = {
    [HS_TISSUE_FLUID] = {-70.0f, 0.005f, 1.50f, 1510.0f},
    [HS_TISSUE_WALL] = {-33.0f, 0.55f, 1.65f, 1570.0f},
    [HS_TISSUE_FAT] = {-35.0f, 0.48f, 1.38f, 1450.0f},
    [HS_TISSUE_MUSCLE] = {-33.0f, 0.60f, 1.70f, 1580.0f},
    [HS_TISSUE_PLACENTA] = {-31.0f, 0.50f, 1.65f, 1560.0f},
    [HS_TISSUE_CORD] = {-31.0f, 0.40f, 1.60f, 1550.0f},
    [HS_TISSUE_CLOUD] = {-37.0f, 0.10f, 1.53f, 1520.0f},
    [HS_TISSUE_URINE] = {-70.0f, 0.005f, 1.52f, 1520.0f},
    [HS_TISSUE_SOFT] = {-30.0f, 0.50f, 1.63f, 1550.0f},
    [HS_TISSUE_BRAIN] = {-37.0f, 0.45f, 1.58f, 1540.0f},
    [HS_TISSUE_BONE] = {-9.0f, 6.0f, 3.75f, 2500.0f},
};

const char *const hs_tissue_names[HS_TISSUE_COUNT] = {"fluid", "wall",  "fat",  "muscle", "placenta", "cord",
                                                      "cloud", "urine", "soft", "brain",  "bone"};
