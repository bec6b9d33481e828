/* SPDX-License-Identifier: MIT */
#include "show/scene_sheet.h"

#include "loop/view.h"
#include "picture/picture.h"
#include "picture/picture_draw.h"
#include "render/dvr.h"
#include "show/picture_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CELL = 384, GAP = 12, CAPTION = 26, HEADER = 44, COLUMNS = 4, ROWS = 3, RENDER = 512 };

#define NEAR_COLOUR 0x35c3ffu
#define FAR_COLOUR  0xffa630u

typedef struct {
    hs_picture *out;
    const hs_scene_data *data;
    hs_dvr_settings settings;
    uint8_t *rgba; /* RENDER^2 pixels of 4 bytes: one cell being drawn */
    uint8_t *mip;  /* RENDER^2 */
    hs_error *err;
} sheet;

static int32_t cell_x(int column) {
    return GAP + column * (CELL + GAP);
}

static int32_t cell_y(int row) {
    return HEADER + row * (CELL + CAPTION + GAP) + CAPTION;
}

static bool caption(sheet *s, int column, int row, const char *text) {
    return hs_picture_text(s->out, cell_x(column), cell_y(row) - 8, 15, HS_COLOUR_TEXT, HS_ALIGN_LEFT, CELL,
                           text, s->err);
}

static void put(sheet *s, uint32_t x, uint32_t y, uint32_t colour) {
    uint8_t *p = s->rgba + 4 * ((size_t)y * RENDER + x);
    p[0] = (uint8_t)(colour >> 16);
    p[1] = (uint8_t)(colour >> 8);
    p[2] = (uint8_t)colour;
    p[3] = 255;
}

static bool place(sheet *s, int column, int row, const char *text) {
    const hs_image image = {s->rgba, RENDER, RENDER, 4};
    hs_picture_blit(s->out, cell_x(column), cell_y(row), CELL, CELL, &image, HS_SCALE_SMOOTH);
    return caption(s, column, row, text);
}

static uint32_t grey(uint8_t v) {
    return (uint32_t)v * 0x010101u;
}

/* The map's or slice's index of a pixel of the cell. */
static uint32_t at(uint32_t pixel, uint32_t n) {
    return pixel * n / RENDER;
}

/* A slice that holds the beam's direction, with z to the right (sagittal) or down (transverse). */
static bool draw_slice(sheet *s, int column, bool sagittal, double where, const char *text) {
    const hs_volume *v = &s->data->full;
    uint32_t fixed = (uint32_t)(where * (sagittal ? v->nx : v->ny));
    for (uint32_t j = 0; j < RENDER; j++)
        for (uint32_t i = 0; i < RENDER; i++) {
            uint32_t x = sagittal ? fixed : at(i, v->nx), y = sagittal ? at(j, v->ny) : fixed;
            uint32_t z = at(sagittal ? i : j, v->nz);
            size_t pixel = (size_t)y * v->nx + x;
            uint32_t colour = grey(v->voxels[(size_t)z * v->nx * v->ny + pixel]);
            if (s->data->label[pixel] && (float)z == s->data->near_end[pixel]) colour = NEAR_COLOUR;
            if (s->data->label[pixel] && (float)z == s->data->far_end[pixel]) colour = FAR_COLOUR;
            put(s, i, j, colour);
        }
    return place(s, column, 1, text);
}

static bool draw_maps(sheet *s) {
    const hs_volume *v = &s->data->full;
    float widest = 1.0f;
    for (size_t i = 0; i < (size_t)v->nx * v->ny; i++)
        if (s->data->label[i]) widest = fmaxf(widest, s->data->far_end[i] - s->data->near_end[i]);
    for (uint32_t j = 0; j < RENDER; j++)
        for (uint32_t i = 0; i < RENDER; i++)
            put(s, i, j, hs_colour_label(s->data->label[(size_t)at(j, v->ny) * v->nx + at(i, v->nx)]));
    if (!place(s, 3, 0, "Label map: fetus orange, sac only blue")) return false;
    for (uint32_t j = 0; j < RENDER; j++)
        for (uint32_t i = 0; i < RENDER; i++) {
            size_t pixel = (size_t)at(j, v->ny) * v->nx + at(i, v->nx);
            float width = s->data->far_end[pixel] - s->data->near_end[pixel];
            put(s, i, j,
                s->data->label[pixel] ? hs_colour_viridis((double)(width / widest)) : HS_COLOUR_NO_VALUE);
        }
    char text[96];
    snprintf(text, sizeof text, "Width of the interval: 0 (dark) .. %.0f slices", (double)widest);
    return place(s, 3, 1, text);
}

/* Bars of all grey levels; the zeros' bar is cut where it is higher than twice the rest. */
static bool draw_histogram(sheet *s) {
    uint32_t bins[256] = {0}, highest = 1;
    for (size_t i = 0; i < hs_volume_count(&s->data->full); i++) bins[s->data->full.voxels[i]]++;
    for (int g = 2; g < 256; g++) highest = bins[g] > highest ? bins[g] : highest;
    for (uint32_t j = 0; j < RENDER; j++)
        for (uint32_t i = 0; i < RENDER; i++) {
            const uint32_t level = i / 2,
                           height = (uint32_t)fmin(0.5 * RENDER * bins[level] / highest, RENDER);
            const bool threshold = i == 81; /* 40.5 */
            put(s, i, j, RENDER - j <= height ? 0xc9ced6u : threshold ? FAR_COLOUR : HS_COLOUR_NO_VALUE);
        }
    return place(s, 0, 2, "Histogram 0 .. 255, with T_L");
}

static bool draw_facts(sheet *s) {
    const hs_volume *v = &s->data->full;
    size_t pixels = (size_t)v->nx * v->ny, labels[3] = {0}, zeros = 0;
    for (size_t i = 0; i < pixels; i++) labels[s->data->label[i]]++;
    for (size_t i = 0; i < hs_volume_count(v); i++) zeros += v->voxels[i] == 0;
    char line[3][128];
    snprintf(line[0], sizeof line[0], "%u x %u x %u voxels of %.3g mm", v->nx, v->ny, v->nz, v->spacing[0]);
    snprintf(line[1], sizeof line[1], "not scanned: %.1f %%",
             100.0 * (double)zeros / (double)hs_volume_count(v));
    snprintf(line[2], sizeof line[2], "rays: fetus %.1f %%, sac only %.1f %%",
             100.0 * (double)labels[2] / (double)pixels, 100.0 * (double)labels[1] / (double)pixels);
    bool ok = caption(s, 1, 2, "Facts");
    for (int i = 0; i < 3; i++)
        ok = ok && hs_picture_text(s->out, cell_x(1), cell_y(2) + 24 + 26 * i, 16, HS_COLOUR_TEXT,
                                   HS_ALIGN_LEFT, 2 * CELL, line[i], s->err);
    return ok &&
           hs_picture_text(s->out, cell_x(1), cell_y(2) + 122, 14, NEAR_COLOUR, HS_ALIGN_LEFT, CELL,
                           "near end of the interval", s->err) &&
           hs_picture_text(s->out, cell_x(1), cell_y(2) + 144, 14, FAR_COLOUR, HS_ALIGN_LEFT, CELL,
                           "far end of the interval", s->err);
}

typedef enum { RESULT_FULL, RESULT_TRUTH, RESULT_MIP } rendered;

/* The truth is the full volume cut at its surface, so that a cut is drawn as one. */
static bool enqueue(sheet *s, const hs_cl *cl, hs_dvr *dvr, rendered what, hs_device_volume *source,
                    cl_mem to) {
    hs_camera camera;
    hs_start_depths start = {0};
    hs_camera_look(&camera, &s->data->full, 0.0, 0.0);
    if (what == RESULT_MIP) return hs_dvr_mip(dvr, source, &camera, to, NULL, s->err);
    const bool cut = what == RESULT_TRUTH;
    const bool ok = (!cut || hs_truth_surface(cl, s->data, &camera, &start, s->err)) &&
                    hs_dvr_render(dvr, source, &camera, cut ? &start : NULL, to, NULL, NULL, s->err);
    if (start.depth) (void)clReleaseMemObject(start.depth);
    return ok;
}

/* Renders into s->rgba, or the maximum projection into s->mip. */
static bool render(sheet *s, const hs_cl *cl, hs_dvr *dvr, rendered what) {
    const bool mip = what == RESULT_MIP;
    hs_device_volume *source = hs_device_volume_create(cl, &s->data->full, s->err);
    if (!source) return false;
    const size_t bytes = (size_t)RENDER * RENDER * (mip ? 1 : 4);
    cl_mem buffer = NULL;
    bool ok =
        hs_cl_take_buffer(cl, bytes, "picture", &buffer, s->err) && enqueue(s, cl, dvr, what, source, buffer);
    if (ok)
        ok = hs_cl_check(
            clEnqueueReadBuffer(cl->queue, buffer, CL_TRUE, 0, bytes, mip ? s->mip : s->rgba, 0, NULL, NULL),
            "clEnqueueReadBuffer", s->err);
    if (buffer) clReleaseMemObject(buffer);
    hs_device_volume_destroy(source);
    return ok;
}

static bool draw_rendered(sheet *s, const hs_cl *cl) {
    hs_dvr *dvr = hs_dvr_create(cl, &s->settings, s->err);
    if (!dvr) return false;
    bool ok = render(s, cl, dvr, RESULT_FULL) && place(s, 0, 0, "Full volume") &&
              render(s, cl, dvr, RESULT_TRUTH) && place(s, 1, 0, "Ground truth") &&
              render(s, cl, dvr, RESULT_MIP);
    hs_dvr_destroy(dvr);
    if (!ok) return false;
    for (uint32_t i = 0; i < RENDER * RENDER; i++) put(s, i % RENDER, i / RENDER, grey(s->mip[i]));
    return place(s, 2, 0, "Maximum intensity projection");
}

static bool draw_all(sheet *s, const hs_cl *cl, const char *title) {
    return hs_picture_text(s->out, GAP, HEADER - 16, 18, HS_COLOUR_TEXT, HS_ALIGN_LEFT,
                           s->out->width - 2 * GAP, title, s->err) &&
           draw_rendered(s, cl) && draw_slice(s, 0, true, 0.5, "Slice x = 1/2, z to the right") &&
           draw_slice(s, 1, false, 0.3, "Slice y = 3/10, z down") &&
           draw_slice(s, 2, false, 0.55, "Slice y = 11/20, z down") && draw_maps(s) && draw_histogram(s) &&
           draw_facts(s);
}

bool hs_scene_sheet(const hs_cl *cl, const hs_scene_data *data, const char *title, hs_picture *out,
                    hs_error *err) {
    const uint32_t width = GAP + COLUMNS * (CELL + GAP), height = HEADER + ROWS * (CELL + CAPTION + GAP);
    if (!hs_picture_init(out, width, height, HS_COLOUR_BACKGROUND, err)) return false;
    sheet s = {.out = out, .data = data, .err = err};
    hs_dvr_defaults(&s.settings);
    s.settings.look = HS_LOOK_LIT;
    s.settings.width = s.settings.height = RENDER;
    s.rgba = malloc((size_t)RENDER * RENDER * 4);
    s.mip = malloc((size_t)RENDER * RENDER);
    bool ok = s.rgba && s.mip ? draw_all(&s, cl, title) : hs_fail(err, HS_ERR_MEMORY, "%s: no memory", title);
    free(s.rgba);
    free(s.mip);
    if (!ok) hs_picture_free(out);
    return ok;
}
