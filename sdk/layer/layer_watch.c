/* SPDX-License-Identifier: MIT */
/* Samples of what lies in memory, and the slots that hold them. */
#define CL_TARGET_OPENCL_VERSION 120
#include "layer/layer_watch.h"

/* ---- open, close */
static ly_watch *ly_watch_open(const sv_format *format) {
    const size_t line = format->width < LY_MAX_LINE ? format->width : LY_MAX_LINE;
    const size_t all = line * format->slices; /* lines of a volume, one a slice */
    ly_watch *w = all > 0 ? calloc(1, sizeof *w) : NULL;
    if (!w) return NULL;
    w->format = *format;
    w->rays = (size_t)format->width * format->height;
    if (!format->queue) w->lent = malloc(5 * w->rays + (size_t)2 * SV_BAND_BYTES);
    /* Commands of the host's queue cost more than copies. */
    const size_t rows = format->queue ? 1 : LY_OWN_BYTES / all;
    w->rows = rows < format->height ? (uint32_t)rows : format->height;
    if (w->rows < 1) w->rows = 1;
    w->row_step = format->height / w->rows;
    w->samples = ((all + LY_MAX_LINE) * w->rows + 7) / 8 * 8;
    w->bytes = ly_stats_at(w) + sizeof(sv_stats);
    w->max_places = format->slices * w->rows + 1;
    const size_t fit = LY_MAX_BYTES / (w->bytes + w->samples), wanted = format->queue ? LY_SLOTS : 1;
    w->slot_count = (uint32_t)(fit < wanted ? fit : wanted);
    bool whole = fit > 0;
    for (uint32_t n = 0; n < w->slot_count; n++) {
        ly_slot *s = &w->slots[n];
        cl_int code = CL_SUCCESS;
        s->block = malloc(w->bytes);
        s->kept = malloc(w->samples);
        s->places = calloc(w->max_places, sizeof *s->places);
        if (format->queue)
            s->device = clCreateBuffer(format->context, CL_MEM_READ_WRITE, w->bytes, NULL, &code);
        whole = whole && s->block && s->kept && s->places && code == CL_SUCCESS;
    }
    if (whole) return w;
    ly_watch_close(w);
    return NULL;
}

/* The objects of a frame are the layer's, too, until its end has returned. */
static void release_slot(ly_slot *s) {
    for (uint32_t n = 0; s && n < s->count; n++) {
        if (s->places[n].object) (void)clReleaseMemObject(s->places[n].object);
        s->places[n].object = NULL;
    }
}

void ly_watch_close(ly_watch *w) {
    if (!w) return;
    release_slot(w->now);
    for (int n = 0; n < LY_SLOTS; n++) {
        if (w->slots[n].done) { /* it reads into the block */
            (void)clWaitForEvents(1, &w->slots[n].done);
            (void)clReleaseEvent(w->slots[n].done);
        }
        if (w->slots[n].device) (void)clReleaseMemObject(w->slots[n].device);
        free(w->slots[n].block);
        free(w->slots[n].kept);
        free(w->slots[n].places);
    }
    free(w->lent);
    free(w);
}

/* ---- samples */
static void copy_lines(const ly_place *p, uint8_t *to) {
    for (size_t n = 0; n < p->lines; n++) memcpy(to + n * p->bytes, p->memory + n * p->pitch, p->bytes);
}

/* Takes a place up and its first sample. */
static void add(ly_watch *w, ly_place p) {
    ly_slot *s = w->now;
    if (s->count == w->max_places || s->used + p.bytes * p.lines > w->samples) return;
    p.at = s->used;
    s->used += p.bytes * p.lines;
    if (p.object && clRetainMemObject(p.object) != CL_SUCCESS) return;
    s->places[s->count++] = p;
    if (p.memory)
        copy_lines(&p, s->kept + p.at);
    else
        ly_fetch(w, s, &p, p.at);
}

static void add_ranges(ly_watch *w, const sv_frame *f) {
    const ly_slot *s = w->now;
    const size_t row = w->format.width * sizeof(sv_scanned), at = s->row * row;
    if (!f->scanned && !f->scanned_object) return;
    add(w, (ly_place){.memory = f->scanned ? (const uint8_t *)f->scanned + at : NULL,
                      .object = f->scanned_object,
                      .origin = {(size_t)f->scanned_offset + at, 0, 0},
                      .pitch = w->row_step * row,
                      .bytes = row < LY_MAX_LINE ? row : LY_MAX_LINE,
                      .lines = w->rows,
                      .row = s->row,
                      .slice = LY_RANGES,
                      .step = w->row_step});
}

/* A row of voxels of every slice in a column of tiles. */
static void add_row(ly_watch *w, const sv_slab *slab, uint32_t row) {
    const sv_format *f = &w->format;
    const uint32_t tiles = slab->slice_count < f->tiles_x ? slab->slice_count : f->tiles_x;
    const uint32_t tile = (uint32_t)(w->turn % tiles);
    const size_t lines = (slab->slice_count - 1 - tile) / f->tiles_x + 1;
    const size_t at = (size_t)row * f->row_pitch + (size_t)tile * f->tile_w;
    ly_place p = {.memory = slab->memory ? (const uint8_t *)slab->memory + at : NULL,
                  .object = slab->object,
                  .image = f->carrier == SV_CARRIER_IMAGE,
                  .origin = {(size_t)slab->offset + at, 0, 0},
                  .pitch = (size_t)f->tile_h * f->row_pitch,
                  .bytes = f->width < LY_MAX_LINE ? f->width : LY_MAX_LINE,
                  .lines = lines,
                  .row = row,
                  .slice = slab->first_slice + tile,
                  .step = f->tiles_x};
    if (p.image) { /* one line: an image has no pitch to stride by */
        const size_t line = w->turn % lines;
        p.origin[0] = (size_t)tile * f->tile_w;
        p.origin[1] = line * f->tile_h + row;
        p.lines = 1;
        p.slice += (uint32_t)line * f->tiles_x;
    }
    add(w, p);
}

/* Tells of the first byte that differs. */
static void compare(const rule_sink *to, rule_name name, const ly_slot *s, const ly_place *p,
                    const uint8_t *now, size_t pitch, const char *call) {
    const uint8_t *before = (p->memory ? s->kept : s->block) + p->at;
    for (size_t n = 0; n < p->lines; n++) {
        if (memcmp(before + n * p->bytes, now + n * pitch, p->bytes) == 0) continue;
        size_t x = 0;
        while (before[n * p->bytes + x] == now[n * pitch + x]) x++;
        const unsigned long long frame = s->index;
        if (p->slice == LY_RANGES)
            rule_tell(to, name, "%s: frame %llu: the scanned range of ray (%zu, %zu) changed", call, frame,
                      x / sizeof(sv_scanned), p->row + n * p->step);
        else
            rule_tell(to, name, "%s: frame %llu: voxel (%zu, %u) of slice %zu was %u and is %u", call, frame,
                      x, p->row, p->slice + n * p->step, before[n * p->bytes + x], now[n * pitch + x]);
        return;
    }
}

/* What has changed is told once: the sample is taken anew. */
static void compare_memory(ly_instance *i, rule_name name, uint32_t from, const char *call) {
    const ly_slot *s = i->watch->now;
    for (uint32_t n = from; n < s->count; n++) {
        const ly_place *p = &s->places[n];
        if (!p->memory) continue;
        compare(&i->called, name, s, p, p->memory, p->pitch, call);
        copy_lines(p, s->kept + p->at);
    }
}

/* ---- what the host must keep */
/* The layer holds queue and objects of the frame: where it is the only one, the host has let go of them. */
static void check_kept(ly_instance *i, const char *call) {
    const ly_watch *w = i->watch;
    const rule_sink *to = &i->called;
    cl_uint count = 0;
    for (uint32_t n = 0; w->now && n < w->now->count; n++) {
        const ly_place *p = &w->now->places[n];
        cl_uint held = 0;
        for (uint32_t k = 0; k < w->now->count; k++)
            held += p->object && w->now->places[k].object == p->object;
        if (!p->object || clGetMemObjectInfo(p->object, CL_MEM_REFERENCE_COUNT, sizeof count, &count, NULL))
            continue;
        RULE_EXPECT(to, RULE_host_objects_kept, count > held,
                    "%s: the object of %s %u was released before it", call,
                    p->slice == LY_RANGES ? "scanned_object, ray" : "the slab of slice",
                    p->slice == LY_RANGES ? 0 : p->slice);
    }
}

/* ---- around a call */
static void take_slot(ly_watch *w, uint64_t index) {
    release_slot(w->now);
    w->now = NULL;
    for (uint32_t n = 0; n < w->slot_count && !w->trouble && !w->now; n++)
        if (!w->slots[n].done) w->now = &w->slots[n];
    if (!w->now) return;
    w->now->count = 0;
    w->now->used = 0;
    w->now->index = index;
    w->now->row = (uint32_t)(w->turn * 37 % w->row_step); /* not the same rows every frame */
}

void ly_watch_before(ly_instance *i, const rc_call *c) {
    ly_watch *w = i->watch;
    const char *call = rc_names[c->kind];
    if (!w || w->trouble || !c->sound) return;
    if (c->kind != RC_SLAB) check_kept(i, call);
    if (c->kind == RC_BEGIN) {
        w->turn++;
        take_slot(w, c->frame->index);
        if (w->now) add_ranges(w, c->frame);
    }
    if (c->kind == RC_ADJUST) take_slot(w, i->frame_index);
    if (!w->now) return;
    if (c->kind == RC_SLAB) {
        w->before_slab = w->now->count;
        for (uint32_t n = 0; n < w->rows; n++) add_row(w, c->slab, w->now->row + n * w->row_step);
    }
    if (c->kind == RC_END && ly_is_own(w)) compare_memory(i, RULE_host_contents, 0, call);
    if (c->result) ly_results_before(w, c->result);
}

static void open_watch(ly_instance *i, const rc_call *c) {
    if (i->silent || c->kind != RC_ACTIVATE || !c->sound || c->status < SV_OK) return;
    i->watch = ly_watch_open(c->format);
    if (!i->watch)
        ly_log(i, SV_LOG_INFO, "there is no memory to watch voxels and maps: they are not looked at");
}

void ly_watch_after(ly_instance *i, const rc_call *c) {
    ly_watch *w = i->watch;
    open_watch(i, c);
    if (c->kind == RC_DEACTIVATE) {
        ly_watch_close(w);
        i->watch = NULL;
        return;
    }
    if (!w || !w->now) return;
    const bool well = c->sound && c->status >= SV_OK;
    const bool looks = well && !ly_is_lost(i);
    if (c->kind == RC_SLAB && looks) compare_memory(i, RULE_inputs_unchanged, w->before_slab, "slab");
    if (c->kind == RC_BEGIN && looks) compare_memory(i, RULE_inputs_unchanged, 0, "begin");
    if (c->result && looks && ly_is_own(w)) compare_memory(i, RULE_inputs_unchanged, 0, rc_names[c->kind]);
    if (c->result && c->sound) ly_results_after(i, c);
    if (well && !c->result) return;
    release_slot(w->now);
    w->now = NULL;
}

void ly_watch_harvest(ly_instance *i, bool wait) {
    ly_watch *w = i->watch;
    if (!w) return;
    for (uint32_t n = 0; n < w->slot_count; n++) {
        ly_slot *s = &w->slots[n];
        cl_int status = CL_QUEUED;
        if (!s->done) continue;
        if (wait) (void)clWaitForEvents(1, &s->done);
        (void)clGetEventInfo(s->done, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, NULL);
        if (status > CL_COMPLETE) continue;
        (void)clReleaseEvent(s->done);
        s->done = NULL;
        if (status < CL_COMPLETE) w->trouble = status;
        if (w->trouble || s->muddled || ly_is_lost(i)) continue;
        for (uint32_t k = 0; k < s->count; k++)
            compare(&i->called, RULE_host_contents, s, &s->places[k], s->block + w->samples + s->places[k].at,
                    s->places[k].bytes, "frame");
        ly_results_judge(i, s);
    }
    if (w->trouble == CL_SUCCESS || i->told_trouble) return;
    ly_log(i, SV_LOG_INFO, "a command of the layer's failed with %d: voxels and maps are looked at no more",
           (int)w->trouble);
    i->told_trouble = true;
}
