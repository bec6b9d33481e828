/* SPDX-License-Identifier: MIT */
#include "loop/loop.h"

#include "core/progress.h"
#include "loop/loop_state.h"
#include "loop/lowres.h"
#include "loop/plugin_side.h"

#include <math.h>
#include <stdlib.h>

double hs_loop_yaw(const hs_loop_options *options, uint32_t index) {
    if (options->frames < 2) return options->yaw;
    return options->yaw + options->orbit * ((double)index / (options->frames - 1) - 0.5);
}

/* HS_ERR_USAGE names the option that is out of range, and its value. hs_dvr_create checks the renderer's. */
static bool hs_loop_check_options(const hs_loop_options *o, hs_error *err) {
    if (o->frames < 1) return hs_fail(err, HS_ERR_USAGE, "frames: 0, expected 1 or more");
    if (o->slab_slices < 1) return hs_fail(err, HS_ERR_USAGE, "slab: 0 slices, expected 1 or more");
    if (o->carrier < SV_CARRIER_HOST || o->carrier > SV_CARRIER_IMAGE)
        return hs_fail(err, HS_ERR_USAGE, "carrier: %u is none of 1 (host), 2 (buffer), 3 (image)",
                       o->carrier);
    if (o->own_queue && o->carrier != SV_CARRIER_HOST)
        return hs_fail(err, HS_ERR_USAGE, "own queue: needs carrier host, got %s",
                       o->carrier == SV_CARRIER_BUFFER ? "buffer" : "image");
    if (!isfinite(o->yaw) || !isfinite(o->pitch) || !isfinite(o->roll) || !isfinite(o->orbit))
        return hs_fail(err, HS_ERR_USAGE, "camera: yaw %g, pitch %g, roll %g, orbit %g must be finite",
                       o->yaw, o->pitch, o->roll, o->orbit);
    if (!(o->zoom >= 0.0 && o->zoom <= HS_LOOP_MAX_ZOOM))
        return hs_fail(err, HS_ERR_USAGE, "camera: zoom %g, expected 0 .. %g", o->zoom, HS_LOOP_MAX_ZOOM);
    return true;
}

/* Frame `index`'s camera, with the smallest box. */
static void look(const hs_loop_options *o, const hs_volume *volume, uint32_t index, hs_camera *camera) {
    hs_camera_look_from(camera, volume, o->from, hs_loop_yaw(o, index), o->pitch);
    hs_camera_roll(camera, volume, o->roll);
}

void hs_loop_camera(const hs_loop *loop, uint32_t index, hs_camera *camera) {
    if (loop->in_frame && index == loop->current) {
        *camera = loop->camera;
        return;
    }
    look(&loop->options, hs_source_shape(loop->source), index, camera);
    hs_camera_merge_box(camera, &loop->box);
}

void hs_loop_window(const hs_loop *loop, uint32_t index, hs_camera *window, float *share) {
    const hs_loop_options *o = &loop->options;
    hs_camera facing;
    hs_loop_camera(loop, index, window);
    const double box = window->extent;
    if (o->turnable) {
        hs_camera_look_from(&facing, hs_source_shape(loop->source), o->from, 0.0, 0.0);
        window->extent = facing.extent;
    }
    if (o->zoom > 0.0) window->extent /= o->zoom;
    *share = (float)(window->extent / box);
}

/* One box that holds the volume in every view of the run. */
static hs_camera find_box(const hs_volume *volume, const hs_loop_options *o) {
    hs_camera box;
    look(o, volume, 0, &box);
    if (o->turnable) hs_camera_hold_all(&box, volume);
    for (uint32_t i = 1; i < o->frames && o->orbit != 0; i++) {
        hs_camera view;
        look(o, volume, i, &view);
        hs_camera_merge_box(&box, &view);
    }
    return box;
}

uint32_t hs_loop_lowres(const hs_source *source, const hs_loop_options *options) {
    const hs_volume *volume = hs_source_shape(source);
    return hs_lowres_across(volume, options->lowres, find_box(volume, options).extent);
}

/* The low-resolution grid has cubic voxels over the loop's box; its slabs are textures of about as many tiles
 * in x as in y, with rows that start at multiples of 64 bytes (an image has no pitch of its own). */
static bool make_layout(const hs_loop *loop, hs_slab_layout *layout, hs_error *err) {
    const hs_loop_options *o = &loop->options;
    uint32_t size[3];
    if (!hs_lowres_size(hs_source_shape(loop->source), o->lowres, &loop->box, size, err)) return false;
    layout->width = size[0];
    layout->height = size[1];
    layout->slices = size[2];
    layout->slab_slices = o->slab_slices < layout->slices ? o->slab_slices : layout->slices;
    layout->tiles_x = (uint32_t)ceil(sqrt(layout->slab_slices));
    layout->tile_w = layout->width;
    layout->tile_h = layout->height;
    const uint32_t row = layout->tiles_x * layout->tile_w;
    layout->row_pitch = o->carrier == SV_CARRIER_IMAGE ? row : (row + 63u) / 64u * 64u;
    return true;
}

/* The slabs as the plugin takes them, and the plugin; the loop's own options then say how that is. A plugin
 * that does not take what it must is refused: the loop goes on without it. `gaps`: hs_slabs_create. */
static bool create_clipper(hs_loop *loop, const hs_plugin *plugin, bool gaps, hs_error *err) {
    hs_loop_options *o = &loop->options;
    hs_side_way way = {.handover = {o->carrier, o->own_queue}, .fixed = o->carrier_fixed};
    hs_slab_layout layout;
    hs_side_fit(&way, plugin);
    o->carrier = way.handover.carrier;
    o->own_queue = way.handover.own_queue;
    o->fan = way.fan;
    if (!make_layout(loop, &layout, err)) return false;
    const float across = (float)(loop->box.extent / layout.width);
    const float along = (float)(loop->box.depth_extent / layout.slices);
    const bool unsaid = hs_source_shape(loop->source)->spacing_unsaid;
    const hs_clipper_options asked = {
        .spacing_mm = {unsaid ? 0.0f : across, unsaid ? 0.0f : across, unsaid ? 0.0f : along},
        .want_confidence = o->dvr.ghost_width > 0 && o->dvr.ghost_doubt > 0,
        .values = o->values,
        .value_count = o->value_count};
    return hs_side_create(loop->cl, plugin, &way, &layout, gaps, &asked, &loop->slabs, &loop->clipper, err) &&
           hs_slabs_prepare(loop->slabs, loop->volume, &loop->box, err);
}

static bool create_parts(hs_loop *loop, const hs_plugin *plugin, hs_error *err) {
    const hs_volume *first;
    hs_slab_layout checked;
    loop->crops = loop->source->crops;
    loop->box = find_box(hs_source_shape(loop->source), &loop->options);
    return make_layout(loop, &checked, err) &&
           (loop->screen = hs_screen_create(loop->cl, &loop->options.dvr, err)) &&
           (first = hs_source_bring(loop->source, 0, err)) &&
           (loop->volume = hs_device_volume_create(loop->cl, first, err)) &&
           create_clipper(loop, plugin, first->beams != NULL, err) &&
           hs_screen_prepare(loop->screen, loop->volume, err);
}

bool hs_loop_reactivate(hs_loop *loop, const hs_plugin *plugin, const hs_loop_options *asked, hs_error *err) {
    (void)clFinish(loop->cl->queue); /* nothing may run on what goes now */
    hs_clipper_destroy(loop->clipper);
    hs_slabs_destroy(loop->slabs);
    loop->clipper = NULL;
    loop->slabs = NULL;
    loop->has_before = false;
    loop->options.carrier = asked->carrier;
    loop->options.own_queue = asked->own_queue;
    loop->options.carrier_fixed = asked->carrier_fixed;
    loop->options.values = asked->values;
    loop->options.value_count = asked->value_count;
    return create_clipper(loop, plugin, hs_source_shape(loop->source)->beams != NULL, err);
}

/* A place around the patient needs a volume that says how it lies in him. */
static bool can_look_from(const hs_source *source, const hs_loop_options *options, hs_error *err) {
    const hs_volume *volume = hs_source_shape(source);
    return options->from == HS_FROM_PROBE || volume->pose.stated ||
           hs_fail(err, HS_ERR_INPUT,
                   "%s: does not say how it lies in the patient (TransformMatrix), so "
                   "there is no view %s",
                   volume->name, hs_from_name(options->from));
}

hs_loop *hs_loop_create(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                        const hs_loop_options *options, hs_error *err) {
    if (!hs_loop_check_options(options, err) || !can_look_from(source, options, err)) return NULL;
    hs_loop *loop = hs_memory(1, sizeof *loop, "scan loop", err);
    if (!loop) return NULL;
    loop->cl = cl;
    loop->source = source;
    loop->options = *options;
    if (create_parts(loop, plugin, err)) return loop;
    hs_loop_destroy(loop);
    return NULL;
}

void hs_loop_destroy(hs_loop *loop) {
    if (!loop) return;
    (void)clFinish(loop->cl->queue); /* nothing may run on what goes now */
    hs_clipper_destroy(loop->clipper);
    hs_slabs_destroy(loop->slabs);
    hs_device_volume_destroy(loop->volume);
    hs_screen_destroy(loop->screen);
    free(loop->marked);
    free(loop);
}

const hs_loop_options *hs_loop_get_options(const hs_loop *loop) {
    return &loop->options;
}

const hs_slab_layout *hs_loop_layout(const hs_loop *loop) {
    return hs_slabs_layout(loop->slabs);
}

void hs_loop_set_values(hs_loop *loop, const sv_param_value *values, uint32_t count) {
    hs_clipper_set_values(loop->clipper, values, count);
}

void hs_loop_set_marks(hs_loop *loop, const hs_mark *marks, uint32_t count) {
    loop->options.marks = marks;
    loop->options.mark_count = count;
}

const hs_error *hs_loop_plugin_error(const hs_loop *loop) {
    return hs_clipper_error(loop->clipper);
}

const hs_error *hs_loop_confidence_error(const hs_loop *loop) {
    return hs_clipper_confidence_error(loop->clipper);
}

void hs_loop_want(hs_loop *loop, bool status, bool confidence) {
    hs_clipper_want(loop->clipper, status, confidence);
}

void hs_loop_look(hs_loop *loop, double yaw, double pitch, double roll, double zoom) {
    hs_loop_options *o = &loop->options;
    loop->turned |= yaw != o->yaw || pitch != o->pitch || roll != o->roll;
    o->roll = roll;
    o->yaw = yaw;
    o->pitch = pitch;
    o->zoom = zoom;
}

/* ---------------------------------------------------------------------------------------------- frame -- */

/* The volume of frame `index` on the device: a sequence's or a live scan's arrives anew. */
bool hs_loop_bring(hs_loop *loop, uint32_t index, hs_error *err) {
    const uint32_t wanted = index % loop->source->count;
    const bool same_box = loop->crops == loop->source->crops;
    if (wanted == loop->resident && same_box && !loop->options.live) return true;
    const hs_volume *volume = hs_source_bring(loop->source, wanted, err);
    if (!volume) return false;
    loop->resident = wanted;
    loop->crops = loop->source->crops;
    loop->has_before &= same_box;
    return hs_device_volume_replace(loop->volume, volume, err) &&
           hs_screen_prepare(loop->screen, loop->volume, err);
}

static bool wait_for(const hs_loop *loop, const char *stage, hs_error *err) {
    return hs_cl_check(clFinish(loop->cl->queue), stage, err);
}

const hs_start_depths *hs_loop_start(const hs_loop *loop, uint32_t index, const hs_frame *frame,
                                     hs_camera *window, hs_start_depths *out) {
    float share;
    hs_loop_window(loop, index, window, &share);
    if (!frame || !hs_clipper_start(loop->clipper, frame->clipped, frame->has_confidence, out)) return NULL;
    out->share = share;
    return out;
}

bool hs_loop_draw(hs_loop *loop, hs_screen *screen, uint32_t index, const hs_frame *frame, hs_error *err) {
    hs_start_depths start;
    hs_camera window;
    const hs_start_depths *from = hs_loop_start(loop, index, frame, &window, &start);
    return hs_screen_render(screen, loop->volume, &window, from, false, err);
}

#define FRAME_NS UINT64_C(50000000) /* the simulated machine scans 20 volumes a second */

hs_frame_facts hs_loop_facts_alone(const hs_loop *loop, uint32_t index) {
    hs_frame_facts facts = {.index = index};
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    const hs_slab_layout *l = hs_slabs_layout(loop->slabs);
    const uint32_t voxels[3] = {l->width, l->height, l->slices};
    hs_camera_tell(&camera, hs_source_shape(loop->source), voxels, &facts.told);
    return facts;
}

static hs_frame_facts hs_loop_facts_of(hs_loop *loop, uint32_t index) {
    const hs_loop_options *o = &loop->options;
    /* What starts again jumps back in time; an orbit moves the camera with every frame. */
    const bool next = loop->has_before && index == loop->before + 1 && index % loop->source->count != 0;
    const bool again =
        loop->has_before && index >= loop->before && (index == loop->before || loop->source->count == 1);
    hs_frame_facts facts = hs_loop_facts_alone(loop, index);
    facts.time_ns = (index + UINT64_C(1)) * FRAME_NS;
    facts.continues = next || again;
    facts.same_volume = again && !o->live; /* a live scan's volume is a new one, though it looks the same */
    facts.moved = (o->orbit != 0 && o->frames > 1) || loop->turned;
    loop->turned = false;
    loop->has_before = true;
    loop->before = index;
    return facts;
}

void hs_loop_note_clip(const hs_clip_outcome *clip, hs_frame *frame) {
    frame->clipped = clip->clipped;
    frame->has_confidence = clip->has_confidence;
    frame->doubt = clip->doubt;
    frame->outcome = clip->outcome;
    frame->stats = clip->stats;
    frame->points = clip->points;
}

bool hs_loop_mark(hs_loop *loop, uint32_t index, const hs_clip_outcome *clip, hs_error *err) {
    const hs_loop_options *o = &loop->options;
    loop->asked = index;
    if (!clip->clipped || o->mark_count == 0) return true;
    const hs_slab_layout *l = hs_loop_layout(loop);
    const uint32_t n[3] = {l->width, l->height, l->slices};
    const hs_volume *volume = hs_source_bring(loop->source, loop->resident, err);
    if (!volume) return false;
    if (!loop->marked) loop->marked = calloc((size_t)n[0] * n[1], sizeof *loop->marked);
    if (!loop->marked) return hs_fail(err, HS_ERR_MEMORY, "marks: no memory for %u x %u", n[0], n[1]);
    hs_camera camera;
    hs_loop_camera(loop, index, &camera);
    return hs_clipper_read_depth(loop->clipper, loop->marked, err) &&
           hs_marks_apply(o->marks, o->mark_count, volume, &camera, n, loop->marked, err) &&
           hs_clipper_write_depth(loop->clipper, loop->marked, err);
}

bool hs_loop_ask(hs_loop *loop, uint32_t index, hs_frame *frame, hs_error *err) {
    hs_clip_outcome clip;
    if (!hs_clipper_frame(loop->clipper, hs_loop_facts_of(loop, index), &clip, err) ||
        !hs_loop_mark(loop, index, &clip, err))
        return false;
    hs_loop_note_clip(&clip, frame);
    return true;
}

static bool run_frame(hs_loop *loop, hs_setting setting, bool drawn, uint32_t index, hs_frame *frame,
                      hs_error *err) {
    const double start = hs_now();
    hs_loop_camera(loop, index, &loop->camera);
    loop->current = index;
    loop->in_frame = true;
    if (!hs_loop_bring(loop, index, err) || !wait_for(loop, "clFinish (upload)", err)) return false;
    const double uploaded = hs_now();
    if (setting != HS_SETTING_DVR && (!hs_slabs_convert(loop->slabs, loop->volume, &loop->camera, err) ||
                                      !wait_for(loop, "clFinish (scan conversion)", err)))
        return false;
    const double converted = hs_now();
    if (setting == HS_SETTING_SMARTVIS && !hs_loop_ask(loop, index, frame, err)) return false;
    const double clipped = hs_now();
    if (drawn &&
        (!hs_loop_draw(loop, loop->screen, index, frame, err) || !wait_for(loop, "clFinish (DVR)", err)))
        return false;
    const double end = hs_now();
    frame->ms[HS_STAGE_UPLOAD] = (uploaded - start) * 1e3;
    frame->ms[HS_STAGE_CONVERT] = (converted - uploaded) * 1e3;
    frame->ms[HS_STAGE_PLUGIN] = (clipped - converted) * 1e3;
    frame->ms[HS_STAGE_DVR] = (end - clipped) * 1e3;
    frame->ms[HS_STAGE_LOOP] = (end - start) * 1e3;
    return true;
}

static bool whole_frame(hs_loop *loop, hs_setting setting, bool drawn, uint32_t index, hs_frame *frame,
                        hs_error *err) {
    *frame = (hs_frame){.outcome = SV_OK};
    const bool ok = run_frame(loop, setting, drawn, index, frame, err);
    loop->in_frame = false;
    return ok;
}

bool hs_loop_frame(hs_loop *loop, hs_setting setting, uint32_t index, hs_frame *frame, hs_error *err) {
    return whole_frame(loop, setting, true, index, frame, err);
}

bool hs_loop_frame_undrawn(hs_loop *loop, uint32_t index, hs_frame *frame, hs_error *err) {
    return whole_frame(loop, HS_SETTING_SMARTVIS, false, index, frame, err);
}
