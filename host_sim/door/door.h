/* SPDX-License-Identifier: MIT */
/* What smartvis_host.h's objects are made of: for the sources of this folder. */
#pragma once

#include "core/system.h"
#include "door/door_size.h"
#include "door/smartvis_host.h"
#include "guarded/guard_options.h"
#include "loop/view.h"
#include "opencl/host_cl.h"
#include "plugin/loader.h"
#include "render/device_volume.h"
#include "volume/fan_fit.h"

#include <pthread.h>

struct svh_host {
    pthread_mutex_t lock; /* held by every call that works on an object of this host */
    uint32_t users;       /* its clippers and volumes, and who opened it: the last one ends it */
    hs_cl cl;             /* zeroed: not opened, or at rest */
    uint32_t on_device;   /* volumes, and active plugins, that lie in its context */
    uint32_t ended;       /* active plugins that have ended since it was opened */
    hs_fits fits;
    hs_guard_options guard;
    void (*log)(void *context, int32_t severity, const char *text);
    void *context;
    char own[SYS_PATH]; /* the house's plugin; "": not found beside the library */
};

struct svh_volume {
    svh_host *host;
    hs_volume volume;
    hs_levels levels; /* how its values became levels */
    bool fitted;
    char doubt[HS_DOUBT_BYTES], question[160], beams[160];
    hs_device_volume *on_device; /* NULL until it is needed there */
};

/* Unlocks the host for one of its users, which is gone. */
void door_let_go(svh_host *host);

/* Ends a call: unlocks the host, and hands the error out. */
int32_t door_leave(svh_host *host, const hs_error *err, svh_error *out);

/* HS_ERR_USAGE, which names it, if one of these arguments of the caller is NULL. */
#define DOOR_GIVEN(err, ...)                                                                                 \
    door_check_given(__func__, #__VA_ARGS__, (const void *const[]){__VA_ARGS__},                             \
                     sizeof((const void *const[]){__VA_ARGS__}) / sizeof(void *), err)
bool door_check_given(const char *call, const char *names, const void *const *pointers, size_t count,
                      hs_error *err);

/* By how much directions may miss right angles and length 1: DICOM's are rounded. */
#define DOOR_SKEW 0.05

/* Opens the host's device, unless it is open. */
bool door_open_device(svh_host *host, hs_error *err);

/* After a volume or an active plugin has left the device: closes it now and then, while nothing else lies
 * there. PoCL keeps a part of every program that it reads, some 60 KB for each activated plugin, until the
 * last context has gone. */
void door_rest_device(svh_host *host);

/* A volume of the host's without voxels. NULL: HS_ERR_MEMORY. */
svh_volume *door_volume(svh_host *host, hs_error *err);

/* Hands a volume out that was taken, with what is told of its size and beams; else ends it. */
void door_hand_out(svh_volume *volume, bool taken, svh_volume **out);

/* The camera of a view, with the smallest box; HS_ERR_INPUT for a place around a patient of whom nothing is
 * said. */
bool door_camera(const svh_volume *volume, const svh_view *view, hs_camera *camera, hs_error *err);

/* Where a view says that the probe was. */
hs_told door_told(const svh_view *view);

/* The volume on the device, where it stays. */
hs_device_volume *door_bring(svh_volume *volume, hs_error *err);

/* The slabs' layout of a view's grid: one slab. */
hs_slab_layout door_layout(const svh_view *view);

/* True if the view has a grid: svh_plan was called. */
bool door_check_planned(const svh_view *view, hs_error *err);

/* Marks as the machine has them, in new memory. NULL with HS_ERR_MEMORY or HS_ERR_USAGE (too many). */
hs_mark *door_marks(const svh_mark *marks, uint32_t count, hs_error *err);
