/* SPDX-License-Identifier: MIT */
#include "show/picture_slices.h"

#include "picture/picture.h"
#include "picture/picture_draw.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIMMED     0.4 /* of what is removed */
#define MAX_LAYERS 16  /* that a thick slice is averaged over */
#define BAND_SHARE 0.4 /* of the band's colour in a pixel of it */

/* Which of the box' axes run right and down, and which one the slice stands on. */
static const int right_axis[HS_SLICE_PLANES] = {0, 2, 0}, down_axis[HS_SLICE_PLANES] = {2, 1, 1};

/* The place (a, b) of a slice's square, both 0 .. 1. */
static void box_of(const hs_slice_scene *s, hs_slice_plane p, double a, double b, double box[3]) {
    const int right = right_axis[p], down = down_axis[p];
    for (int k = 0; k < 3; k++) box[k] = s->at[k];
    box[right] = s->low[right] + a * s->side[right];
    box[down] = s->low[down] + b * s->side[down];
}

/* The nearest voxel; 0 outside the volume. */
static uint8_t voxel_at(const hs_slice_scene *s, const hs_box_map *map, const double box[3]) {
    const hs_volume *v = s->volume;
    uint32_t at[3];
    return hs_box_map_voxel(map, v, box, at) ? v->voxels[((size_t)at[2] * v->ny + at[1]) * v->nx + at[0]] : 0;
}

/* The places over which a pixel is averaged, along the axis that the slice stands on. */
typedef struct {
    int axis, count;
    double first, step; /* of the box, from the slice on */
} layers;

static layers layers_of(const hs_slice_scene *s, hs_slice_plane p) {
    const hs_camera *c = &s->maps->camera;
    const double *pitch = s->volume->spacing, fine = fmin(fmin(pitch[0], pitch[1]), pitch[2]);
    layers l = {.axis = 3 - right_axis[p] - down_axis[p], .count = 1};
    const double thick = s->thick_mm / (l.axis == 2 ? c->depth_extent : c->extent);
    l.count = (int)fmin(fmax(ceil(s->thick_mm / fine), 1.0), MAX_LAYERS);
    l.step = thick / l.count;
    l.first = 0.5 * l.step - 0.5 * thick;
    return l;
}

/* The mean over the layers that lie in the volume's box. */
static uint8_t level_at(const hs_slice_scene *s, const hs_box_map *map, const layers *l,
                        const double box[3]) {
    uint32_t sum = 0, count = 0;
    for (int i = 0; i < l->count; i++) {
        double place[3] = {box[0], box[1], box[2]};
        place[l->axis] += l->first + i * l->step;
        if (place[l->axis] < 0.0 || place[l->axis] > 1.0) continue;
        sum += voxel_at(s, map, place);
        count++;
    }
    return count > 0 ? (uint8_t)((sum + count / 2) / count) : 0;
}

/* A map of the low-resolution volume at a place of the box. */
static double map_at(const hs_slice_scene *s, const float *map, double u, double v) {
    return hs_map_at(map, s->maps->width, s->maps->height, u * s->maps->width - 0.5,
                     v * s->maps->height - 0.5);
}

/* Where a ray of the box starts, 0 .. 1 of its depth; negative where nothing is clipped. */
static double start_at(const hs_slice_scene *s, double u, double v) {
    const double depth = map_at(s, s->maps->depth, u, v);
    return depth > 0.0 && isfinite(depth) ? (depth + 0.5) / s->maps->slices : -1.0;
}

static void set_pixel(uint8_t *rgba, uint32_t colour) {
    for (int c = 0; c < 3; c++) rgba[c] = (uint8_t)(colour >> (16 - 8 * c));
}

static bool is_in_band(const hs_slice_scene *s, const double box[3], double start) {
    if (!s->maps->confidence || !(s->band_mm > 0.0) || start < 0.0) return false;
    const double reach =
        s->band_mm * (1.0 - map_at(s, s->maps->confidence, box[0], box[1])) / s->maps->camera.depth_extent;
    return fabs(box[2] - start) < reach;
}

static uint32_t mixed(uint32_t level, uint32_t colour, double share) {
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8)
        out |= (uint32_t)(level * (1.0 - share) + (colour >> shift & 255u) * share) << shift;
    return out;
}

static bool is_in_crop(const hs_slice_scene *s, const hs_box_map *m, const double box[3]) {
    bool in = true;
    for (int k = 0; k < 3; k++) {
        const double index = m->origin[k] + box[0] * m->du[k] + box[1] * m->dv[k] + box[2] * m->dw[k];
        const double half = 0.5 * s->volume->spacing[k], mm = index * s->volume->spacing[k];
        in = in && mm >= s->crop->low[k] - half && mm <= s->crop->high[k] + half;
    }
    return in;
}

/* One pixel; what becomes of it. */
static uint8_t fill_pixel(const hs_slice_scene *s, const hs_box_map *map, const layers *l,
                          const double box[3], uint8_t *rgba) {
    for (int k = 0; k < 3; k++)
        if (box[k] < 0.0 || box[k] > 1.0) {
            set_pixel(rgba, HS_COLOUR_BACKGROUND);
            return HS_SLICE_UNSCANNED;
        }
    const uint8_t voxel = level_at(s, map, l, box);
    const double start = start_at(s, box[0], box[1]);
    const bool removed = box[2] < start;
    const uint32_t level = (uint32_t)(voxel * (removed ? DIMMED : 1.0));
    const bool unsure = voxel > 0 && is_in_band(s, box, start);
    set_pixel(rgba, unsure ? mixed(level, HS_SLICE_BAND, BAND_SHARE) : level * 0x010101u);
    return voxel == 0 ? HS_SLICE_UNSCANNED : removed ? HS_SLICE_REMOVED : HS_SLICE_KEPT;
}

/* Where a pixel is removed and a neighbour is kept; two pixels wide, within what was scanned. */
static void draw_line(uint32_t n, uint8_t *rgba, const uint8_t *state) {
    for (uint32_t j = 1; j + 1 < n; j++)
        for (uint32_t i = 1; i + 1 < n; i++) {
            const size_t at = (size_t)j * n + i;
            const bool edge = state[at - 1] == HS_SLICE_KEPT || state[at + 1] == HS_SLICE_KEPT ||
                              state[at - n] == HS_SLICE_KEPT || state[at + n] == HS_SLICE_KEPT;
            for (int k = 0; edge && state[at] == HS_SLICE_REMOVED && k < 4; k++) {
                const size_t to = at + (size_t)(k & 1) + (size_t)(k >> 1) * n;
                if (state[to] != HS_SLICE_UNSCANNED) set_pixel(rgba + 4 * to, HS_SLICE_LINE);
            }
        }
}

void hs_slice_fill(const hs_slice_scene *scene, hs_slice_plane plane, uint32_t cell, uint8_t *rgba,
                   uint8_t *state) {
    const layers l = layers_of(scene, plane);
    hs_box_map map;
    hs_camera_box_map(&scene->maps->camera, scene->volume, &map);
    for (uint32_t j = 0; j < cell; j++)
        for (uint32_t i = 0; i < cell; i++) {
            double box[3];
            const size_t at = (size_t)j * cell + i;
            box_of(scene, plane, (i + 0.5) / cell, (j + 0.5) / cell, box);
            state[at] = fill_pixel(scene, &map, &l, box, rgba + 4 * at);
        }
    draw_line(cell, rgba, state);
    if (!scene->crop) return;
    for (uint32_t j = 0; j < cell; j++)
        for (uint32_t i = 0; i < cell; i++) {
            double box[3];
            box_of(scene, plane, (i + 0.5) / cell, (j + 0.5) / cell, box);
            if (!is_in_crop(scene, &map, box))
                set_pixel(rgba + 4 * ((size_t)j * cell + i), HS_COLOUR_BACKGROUND);
        }
}

#define PLANE_COLOUR 0x56b4e9u /* where the other slices lie */

/* On a page four squares share the width of a column, so letters shrink to half of this. */
enum { SMALL_TEXT = 19, KEY_TEXT = 22, HEAD_TEXT = 25, TITLE_TEXT = 30 };

enum {
    GAP = 16,
    SCALE = 60, /* pixels for the numbers left of a slice */
    TITLE_BAND = 50,
    CAPTION_BAND = 38,
    FOOT = 60, /* the numbers below a slice, and their unit */
    LEGEND = 42,
    FACT_STEP = 31,
    DEFAULT_CELL = 512,
    MAX_TICKS = 6
};

typedef struct {
    const hs_view *view;
    hs_slice_scene scene;
    double depth; /* of the slice at a depth, 0 .. 1 */
    double mm;    /* a square's side: all have one scale */
    uint32_t cell;
} slices;

/* Millimetres along the square's sides. */
static double side_mm(const slices *s, hs_slice_plane p, bool horizontal) {
    const hs_camera *c = &s->view->maps.camera;
    if (p == HS_SLICE_ACROSS) return horizontal ? c->extent : c->depth_extent;
    if (p == HS_SLICE_ALONG) return horizontal ? c->depth_extent : c->extent;
    return c->extent;
}

/* Ticks at round millimetres along one side. */
static void draw_scale(hs_canvas *on, double x, double y, double length, double mm, bool horizontal) {
    const double step = hs_tick_step(mm, MAX_TICKS);
    char text[32];
    for (double at = 0.0; at <= mm * (1.0 + 1e-9); at += step) {
        const double pixel = at / mm * length;
        (void)snprintf(text, sizeof text, "%.0f", at);
        if (horizontal) {
            hs_draw_box(on, x + pixel, y, 1, 5, HS_COLOUR_FAINT_TEXT);
            hs_draw_text(on, x + pixel, y + 23, SMALL_TEXT, HS_COLOUR_FAINT_TEXT, HS_ALIGN_CENTRE, 0, text);
        } else {
            hs_draw_box(on, x - 5, y + pixel, 5, 1, HS_COLOUR_FAINT_TEXT);
            hs_draw_text(on, x - 9, y + pixel + 7, SMALL_TEXT, HS_COLOUR_FAINT_TEXT, HS_ALIGN_RIGHT, 0, text);
        }
    }
}

/* The other slices' places: two lines, at shares of the slice's sides. */
static void draw_planes(hs_canvas *on, double x, double y, double width, double height, double vertical,
                        double horizontal) {
    hs_draw_box(on, x + vertical * width, y, 1, height, PLANE_COLOUR);
    hs_draw_box(on, x, y + horizontal * height, width, 1, PLANE_COLOUR);
}

static void draw_frame_of(const slices *s, hs_canvas *on, hs_slice_plane p, double x, double y) {
    /* Which way the sides run. */
    static const char *const sides[3] = {"→ right, ↓ depth [mm]", "→ depth, ↓ down [mm]",
                                         "→ right, ↓ down [mm]"};
    const hs_camera *c = &s->view->maps.camera;
    const double n = s->cell, right = side_mm(s, p, true), down = side_mm(s, p, false);
    const double width = n * right / s->mm, height = n * down / s->mm;
    char text[96];
    if (p == HS_SLICE_ACROSS)
        (void)snprintf(text, sizeof text, "Across, %.0f mm down", 0.5 * c->extent);
    else if (p == HS_SLICE_ALONG)
        (void)snprintf(text, sizeof text, "Along, %.0f mm right", 0.5 * c->extent);
    else
        (void)snprintf(text, sizeof text, "%.0f mm deep", s->depth * c->depth_extent);
    hs_draw_text(on, x, y - 9, HEAD_TEXT, HS_COLOUR_TEXT, HS_ALIGN_LEFT, n, text);
    draw_scale(on, x, y + height, width, right, true);
    draw_scale(on, x, y, height, down, false);
    hs_draw_text(on, x + width / 2, y + height + 48, SMALL_TEXT, HS_COLOUR_FAINT_TEXT, HS_ALIGN_CENTRE, n,
                 sides[p]);
    draw_planes(on, x, y, width, height, p == HS_SLICE_ALONG ? s->depth : 0.5,
                p == HS_SLICE_ACROSS ? s->depth : 0.5);
}

static double draw_key(hs_canvas *on, double x, double y, uint32_t colour, double height, const char *text) {
    hs_draw_box(on, x, y - 8 - height / 2, 22, height, colour);
    hs_draw_text(on, x + 30, y, KEY_TEXT, HS_COLOUR_TEXT, HS_ALIGN_LEFT, 0, text);
    return x + 30 + 13.0 * (double)strlen(text) + 24;
}

static void draw_legend(const slices *s, hs_canvas *on, double y) {
    double x = GAP;
    if (hs_view_clip_depth(s->view) >= 0.0) {
        x = draw_key(on, x, y, HS_SLICE_LINE, 4, "clipping surface");
        x = draw_key(on, x, y, 0x606060u, 14, "removed (dimmed)");
    } else {
        x = draw_key(on, x, y, 0xa0a0a0u, 14, "nothing is removed");
    }
    x = draw_key(on, x, y, 0x000000u, 14, "fluid, or not scanned");
    (void)draw_key(on, x, y, PLANE_COLOUR, 2, "the other slices");
}

static int by_value(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

double hs_view_clip_depth(const hs_view *view) {
    const size_t rays = (size_t)view->maps.width * view->maps.height;
    float *depth = malloc(rays * sizeof *depth);
    size_t count = 0;
    for (size_t i = 0; depth && i < rays; i++)
        if (view->maps.depth[i] > 0.0f && isfinite(view->maps.depth[i])) depth[count++] = view->maps.depth[i];
    double median = -1.0;
    if (count > 0) {
        qsort(depth, count, sizeof *depth, by_value);
        median = ((double)depth[count / 2] + 0.5) / view->maps.slices * view->maps.camera.depth_extent;
    }
    free(depth);
    return median;
}

static bool draw_slices(const slices *s, hs_picture *out, double top, hs_error *err) {
    const size_t pixels = (size_t)s->cell * s->cell;
    uint8_t *rgba = calloc(pixels, 4);
    uint8_t *state = calloc(pixels, sizeof *state);
    const bool ok =
        (rgba && state) || hs_fail(err, HS_ERR_MEMORY, "slices: no memory for %zu pixels", pixels);
    for (int p = 0; ok && p < 3; p++) {
        const hs_image image = {.data = rgba, .width = s->cell, .height = s->cell};
        const double x = GAP + s->cell + SCALE + p * (double)(s->cell + SCALE + GAP);
        hs_slice_fill(&s->scene, (hs_slice_plane)p, s->cell, rgba, state);
        hs_picture_blit(out, (int32_t)x, (int32_t)top, s->cell, s->cell, &image, HS_SCALE_NEAREST);
        hs_canvas *on = hs_draw_begin(out);
        draw_frame_of(s, on, (hs_slice_plane)p, x, top);
        if (!hs_draw_end(on, err)) {
            free(rgba);
            free(state);
            return false;
        }
    }
    free(rgba);
    free(state);
    return ok;
}

/* Slices through the middle of the picture, in squares that begin with the box. */
static hs_slice_scene scene_of(const hs_view *view, double depth, double mm) {
    const hs_camera *c = &view->maps.camera;
    return (hs_slice_scene){.volume = view->volume,
                            .maps = &view->maps,
                            .at = {0.5, 0.5, depth},
                            .side = {mm / c->extent, mm / c->extent, mm / c->depth_extent}};
}

bool hs_picture_slices(hs_picture *out, const hs_view *view, uint32_t cell, const hs_caption *caption,
                       hs_error *err) {
    slices s = {.view = view, .cell = cell ? cell : DEFAULT_CELL};
    const double clip = hs_view_clip_depth(view);
    *out = (hs_picture){0};
    s.mm = fmax(view->maps.camera.extent, view->maps.camera.depth_extent);
    s.depth = clip >= 0.0 ? fmin(clip / view->maps.camera.depth_extent, 1.0) : 0.5;
    s.scene = scene_of(view, s.depth, s.mm);
    const uint32_t top = (caption->title ? TITLE_BAND : GAP) + CAPTION_BAND,
                   facts = hs_draw_line_count(caption->footer);
    const uint32_t width = GAP + s.cell + 3 * (SCALE + s.cell + GAP) + GAP / 2; /* of the last number */
    if (s.cell > HS_PICTURE_MAX_AXIS / 4)
        return hs_fail(err, HS_ERR_INPUT, "slices: a picture is %" PRIu32 " pixels wide, expected at most %u",
                       s.cell, HS_PICTURE_MAX_AXIS / 4);
    if (!hs_picture_init(out, width, top + s.cell + FOOT + LEGEND + facts * FACT_STEP + GAP / 2,
                         HS_COLOUR_BACKGROUND, err))
        return false;
    const hs_image result = {.data = view->result, .width = view->width, .height = view->height};
    hs_picture_blit(out, GAP, (int32_t)top, s.cell, s.cell, &result, HS_SCALE_SMOOTH);
    hs_canvas *on = hs_draw_begin(out);
    if (caption->title)
        hs_draw_text(on, GAP, TITLE_BAND - 14, TITLE_TEXT, HS_COLOUR_TEXT, HS_ALIGN_LEFT, width - 2.0 * GAP,
                     caption->title);
    hs_draw_text(on, GAP, top - 9, HEAD_TEXT, HS_COLOUR_TEXT, HS_ALIGN_LEFT, s.cell,
                 view->maps.frame.clipped ? "Result" : "Result: not clipped");
    draw_scale(on, GAP, top + s.cell, s.cell, view->picture_mm, true);
    draw_legend(&s, on, top + s.cell + FOOT + 26);
    hs_draw_text(on, GAP + s.cell / 2.0, top + s.cell + 48, SMALL_TEXT, HS_COLOUR_FAINT_TEXT, HS_ALIGN_CENTRE,
                 s.cell, "→ right, ↓ down [mm]");
    hs_draw_lines(on, GAP, top + s.cell + FOOT + LEGEND + 20, FACT_STEP, KEY_TEXT, HS_COLOUR_FAINT_TEXT,
                  width - 2.0 * GAP, caption->footer);
    if (hs_draw_end(on, err) && draw_slices(&s, out, top, err)) return true;
    hs_picture_free(out);
    return false;
}
