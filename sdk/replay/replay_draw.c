/* SPDX-License-Identifier: MIT */
#include "replay/replay.h"

#include "core/paths.h"
#include "loop/loop.h"
#include "loop/view.h"
#include "picture/picture_draw.h"
#include "show/loop_pictures.h"

#include <stdio.h>
#include <stdlib.h>

#define MAX_STRETCH   20.0f               /* of spacings against each other */
#define SQUARE_VOXELS (UINT64_C(1) << 24) /* that a picture may have beside four times those of the frame */

/* The recorded volume is camera-aligned already. The loop's pictures are square, so that it lies in the
 * middle of a square of `side` rays. */
typedef struct {
    const rp_frame *frame;
    uint32_t side, left, top;
    hs_volume volume;
    float *depth;
    uint8_t *status;
} easel;

/* The voxel as the host's renderer wants it: 0 is not scanned, and nothing else is 0. */
static uint8_t voxel_of(const rp_frame *frame, size_t ray, uint32_t z, uint8_t value) {
    const sv_scanned all = {0, UINT16_MAX}, range = frame->ranges ? frame->ranges[ray] : all;
    if (value == frame->format.padding_value || z < range.first || z >= range.end) return 0;
    return value ? value : 1;
}

/* A recording may say anything: what no scan has is not drawn, for its pictures would take the memory and the
 * time of many. */
static bool is_drawn(const sv_format *f, uint32_t side, hs_error *err) {
    const float *mm = f->spacing_mm;
    const float lateral = mm[0] > mm[1] ? mm[0] : mm[1], least = mm[0] < mm[1] ? mm[0] : mm[1];
    const uint64_t voxels = (uint64_t)f->width * f->height * f->slices;
    if (mm[2] > 0.0f && !(lateral <= MAX_STRETCH * mm[2] && mm[2] <= MAX_STRETCH * least))
        return hs_fail(err, HS_ERR_INPUT, "pictures: spacing_mm is %g, %g, %g: no scan is stretched so much",
                       (double)mm[0], (double)mm[1], (double)mm[2]);
    return (uint64_t)side * side * f->slices <= SQUARE_VOXELS + 4 * voxels ||
           hs_fail(err, HS_ERR_INPUT, "pictures: they are square, and %u x %u rays are not nearly", f->width,
                   f->height);
}

static bool set_up(easel *e, hs_error *err) {
    const sv_format *f = &e->frame->format;
    const size_t slice = (size_t)f->width * f->height;
    e->side = f->width > f->height ? f->width : f->height;
    if (!is_drawn(f, e->side, err)) return false;
    e->left = (e->side - f->width) / 2;
    e->top = (e->side - f->height) / 2;
    if (!hs_volume_init(&e->volume, e->side, e->side, f->slices, err)) return false;
    hs_volume_scanned_from(&e->volume, HS_PROBE_LOW_Z);
    (void)snprintf(e->volume.name, sizeof e->volume.name, "frame %u", e->frame->number);
    for (int a = 0; a < 3 && f->spacing_mm[2] > 0.0f; a++)
        e->volume.spacing[a] = (double)f->spacing_mm[a == 1 ? 0 : a]; /* pixels are square */
    e->depth = calloc((size_t)e->side * e->side, sizeof *e->depth);
    e->status = calloc((size_t)e->side * e->side, 1);
    if (!e->depth || !e->status)
        return hs_fail(err, HS_ERR_MEMORY, "pictures: no memory for %u rays", e->side);
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            const size_t ray = (size_t)y * f->width + x, to = (size_t)(y + e->top) * e->side + x + e->left;
            e->depth[to] = e->frame->depth[ray];
            e->status[to] = e->frame->status[ray];
            for (uint32_t z = 0; z < f->slices; z++)
                e->volume.voxels[(size_t)z * e->side * e->side + to] =
                    voxel_of(e->frame, ray, z, e->frame->voxels[z * slice + ray]);
        }
    return true;
}

/* The picture with rays that start at the recorded frame's map. */
static bool draw_result(const easel *e, const hs_cl *cl, const hs_loop_options *o, hs_view *view,
                        hs_error *err) {
    cl_int code;
    const size_t bytes = (size_t)e->side * e->side * sizeof *e->depth;
    hs_start_depths start = {
        .width = e->side, .height = e->side, .slices = e->frame->format.slices, .share = 1.0f};
    hs_screen *screen = hs_screen_create(cl, &o->dvr, err);
    hs_device_volume *volume = screen ? hs_device_volume_create(cl, &e->volume, err) : NULL;
    bool ok = volume != NULL;
    if (ok) {
        start.depth =
            clCreateBuffer(cl->context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, bytes, e->depth, &code);
        ok = hs_cl_check(code, "clCreateBuffer (the map)", err) && hs_screen_prepare(screen, volume, err) &&
             hs_screen_render(screen, volume, &view->maps.camera, &start, false, err) &&
             hs_screen_read(screen, view->result, err);
    }
    if (start.depth) (void)clReleaseMemObject(start.depth);
    hs_device_volume_destroy(volume);
    hs_screen_destroy(screen);
    return ok;
}

/* The frame's own maps take the place of those of a loop without a plugin. */
static void put_maps(easel *e, hs_view *view) {
    free(view->maps.depth);
    free(view->maps.status);
    view->maps.depth = e->depth;
    view->maps.status = e->status;
    e->depth = NULL;
    e->status = NULL;
    view->maps.width = view->maps.height = e->side;
    view->maps.slices = e->frame->format.slices;
    view->maps.frame.outcome = e->frame->outcome;
    view->maps.frame.clipped = e->frame->outcome == SV_OK || e->frame->outcome == SV_PARTIAL;
}

static bool draw(easel *e, const hs_cl *cl, const char *title, const char *folder, hs_error *err) {
    const hs_volume *volumes[] = {&e->volume};
    const hs_source source = {.volumes = volumes, .count = 1};
    char text[100];
    hs_view view = {0};
    hs_loop_options o;
    hs_loop_defaults(&o);
    hs_loop_for_pictures(&o, HS_LOOK_LIT);
    o.frames = 1;
    o.lowres = e->side;
    hs_loop *loop = hs_loop_create(cl, &source, NULL, &o, err);
    bool ok = loop && hs_loop_view(loop, 0, &view, err);
    if (ok) {
        const bool clips = e->frame->outcome == SV_OK || e->frame->outcome == SV_PARTIAL;
        ok = !clips || draw_result(e, cl, &o, &view, err);
        put_maps(e, &view);
    }
    ok = ok && hs_loop_write_pictures(&view, folder, title,
                                      hs_frame_note(&view.maps.frame, NULL, text, sizeof text), 0, err);
    hs_view_free(&view);
    hs_loop_destroy(loop);
    return ok;
}

bool rp_draw(const rp_options *o, const rp_report *report, hs_error *err) {
    char title[400];
    easel e = {.frame = &report->drawn};
    hs_cl cl;
    if (!report->drawn.voxels)
        return hs_fail(err, HS_ERR_INPUT, "%s: there is no frame %s with voxels and a map to draw", o->file,
                       o->frame == RP_LAST ? "at all" : "of that number");
    (void)snprintf(title, sizeof title, "%s: frame %u, played to %.200s", o->file, report->drawn.number,
                   o->plugin);
    if (!hs_path_make_folder(o->out, err) || !hs_cl_open(&cl, err)) return false;
    const bool ok = set_up(&e, err) && draw(&e, &cl, title, o->out, err);
    hs_volume_free(&e.volume);
    free(e.depth);
    free(e.status);
    hs_cl_close(&cl);
    hs_picture_finish();
    return ok;
}
