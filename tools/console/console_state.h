/* SPDX-License-Identifier: MIT */
/* What a page of the console wants to see. It is sent whole, so the newest one holds and nothing else is
 * needed. */
#ifndef HS_CONSOLE_STATE_H
#define HS_CONSOLE_STATE_H

#include "render/camera.h"
#include "render/dvr_settings.h"

enum {
    HS_CONSOLE_KEY = 64,      /* bytes of a parameter's key */
    HS_CONSOLE_VALUES = 96,   /* parameters of a lane */
    HS_CONSOLE_LANES = 2,     /* settings side by side */
    HS_CONSOLE_PATH = 1024,   /* bytes of a file's path in its folder */
    HS_CONSOLE_PICTURE = 1024 /* pixels of a picture's side, at most; 16 at least */
};

/* What can be drawn; lane 1 has a result and a depthmap of its own. */
typedef enum {
    HS_CONSOLE_RESULT,
    HS_CONSOLE_FULL,
    HS_CONSOLE_TRUTH,
    HS_CONSOLE_DEPTH,
    HS_CONSOLE_ACROSS, /* the slices of slice_pixels.h */
    HS_CONSOLE_ALONG,
    HS_CONSOLE_DEEP,
    HS_CONSOLE_OTHER, /* the result of lane 1 */
    HS_CONSOLE_VIEWS
} hs_console_view;

/* "result", "full", "truth", "depthmap", "across", "along", "deep", "other". */
const char *hs_console_view_name(hs_console_view view);

typedef struct {
    char key[HS_CONSOLE_KEY];
    double value;
} hs_console_value;

/* A plugin and its parameters; those that are not named have their defaults. */
typedef struct {
    bool used;
    uint32_t plugin; /* index among those that the console offers */
    uint32_t count;
    hs_console_value values[HS_CONSOLE_VALUES];
} hs_console_lane;

/* Where volumes come from: a built-in scene, or a file of the list. */
typedef struct {
    char scene[16];             /* "": a file */
    uint32_t size, volumes;     /* of a scene: voxels per axis, volumes of its motion */
    uint32_t folder;            /* of a file: index among the folders of the command line */
    char path[HS_CONSOLE_PATH]; /* its path in there */
    hs_from from;
} hs_console_source;

typedef struct {
    uint64_t serial; /* the page's own count, told back */
    hs_console_source source;
    double yaw, pitch, zoom; /* degrees; hs_loop_options.zoom */
    uint32_t views;          /* bits 1 << HS_CONSOLE_* */
    uint32_t picture, draft; /* pixels of a picture's side, at rest and under way */
    bool hurried;            /* a hand is on a knob: drafts */
    bool playing;
    double speed;        /* volumes a second */
    uint32_t index;      /* the volume while it does not play */
    double cross[3];     /* where the slices lie, 0 .. 1 of the picture's window: right, down, away */
    hs_dvr_settings dvr; /* but for the picture's size */
    hs_console_lane lane[HS_CONSOLE_LANES]; /* lane 0 is always used */
} hs_console_state;

#endif
