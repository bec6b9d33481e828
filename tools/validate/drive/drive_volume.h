/* SPDX-License-Identifier: MIT */
/* Volumes to try a plugin on. */
#ifndef DRIVE_VOLUME_H
#define DRIVE_VOLUME_H

#include "smartvis_plugin.h"
#include "validate/drive/drive_run.h"

typedef enum {
    V_LAYERS, /* skin, fluid and fetus, with noise: a frame that has a surface */
    V_OTHER,  /* the same with the fluid elsewhere */
    V_BLACK,
    V_WHITE,
    V_GREY,
    V_NOISE,
    V_STRIPES, /* 0 and 255 in turn along the ray */
    V_KINDS
} v_kind;

typedef struct {
    uint32_t width, height, slices;
    uint8_t *voxels;    /* x runs fastest, then y, then z */
    sv_scanned *ranges; /* of every ray: all of the volume */
} v_volume;

/* By the run's random numbers. */
void v_volume_make(v_run *run, v_volume *v, v_kind kind, uint32_t width, uint32_t height, uint32_t slices);
void v_volume_free(v_volume *v);

/* Ranges that cut a few slices off either end, other ones on every ray. */
void v_volume_narrow(v_volume *v);

/* Every voxel outside its ray's range becomes `value`; -1: noise. */
void v_volume_outside(v_run *run, v_volume *v, int value);

const char *v_kind_name(v_kind kind);

#endif
