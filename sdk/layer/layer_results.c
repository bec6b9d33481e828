/* SPDX-License-Identifier: MIT */
/* Results on their way from the plugin, and the commands that fetch samples. */
#define CL_TARGET_OPENCL_VERSION 120
#include "layer/layer_watch.h"

#include <math.h>

void ly_fetch(ly_watch *w, const ly_slot *s, const ly_place *p, size_t to) {
    const size_t target[3] = {to, 0, 0}, none[3] = {0, 0, 0}, region[3] = {p->bytes, p->lines, 1},
                 pixels[3] = {p->bytes, 1, 1};
    cl_command_queue q = w->format.queue;
    const cl_int code =
        p->memory  ? clEnqueueWriteBufferRect(q, s->device, CL_FALSE, target, none, region, p->bytes, 0,
                                              p->pitch, 0, p->memory, 0, NULL, NULL)
        : p->image ? clEnqueueCopyImageToBuffer(q, p->object, s->device, p->origin, pixels, to, 0, NULL, NULL)
                   : clEnqueueCopyBufferRect(q, p->object, s->device, p->origin, target, region, p->pitch, 0,
                                             p->bytes, 0, 0, NULL, NULL);
    if (code != CL_SUCCESS) w->trouble = code;
}

/* With the plugin's own queue: the host's map row by row. */
static float *map_row(const ly_watch *w, const sv_result *r, size_t y) {
    const size_t pitch = r->depth_pitch ? r->depth_pitch : w->format.width * sizeof(float);
    return (float *)(void *)((char *)r->depth + y * pitch);
}

/* Enqueues that every depth becomes `value`. */
static void paint(ly_watch *w, const ly_slot *s, const sv_result *r, float value) {
    cl_command_queue q = w->format.queue;
    const size_t row = w->format.width * sizeof value, region[3] = {row, w->format.height, 1},
                 none[3] = {0, 0, 0};
    const size_t from[3] = {ly_depth_at(w), 0, 0};
    cl_int code = clEnqueueFillBuffer(q, r->depth_object ? r->depth_object : s->device, &value, sizeof value,
                                      r->depth_object ? r->depth_offset : from[0], w->rays * sizeof value, 0,
                                      NULL, NULL);
    if (code == CL_SUCCESS && r->depth)
        code = clEnqueueReadBufferRect(q, s->device, CL_FALSE, from, none, region, row, 0,
                                       r->depth_pitch ? r->depth_pitch : row, 0, r->depth, 0, NULL, NULL);
    if (code != CL_SUCCESS) w->trouble = code;
}

static void paint_memory(const ly_watch *w, const sv_result *r, float value) {
    for (size_t y = 0; y < w->format.height; y++)
        for (size_t x = 0; x < w->format.width; x++) map_row(w, r, y)[x] = value;
}

/* Judges what is in the slot's block. */
void ly_results_judge(ly_instance *i, const ly_slot *s) {
    const ly_watch *w = i->watch;
    const sv_format *f = &w->format;
    char what[64];
    sv_stats stats;
    memcpy(&stats, s->block + ly_stats_at(w), sizeof stats);
    if (stats.size == s->stats_size) stats.size = sizeof stats; /* a later host's may be longer */
    (void)snprintf(what, sizeof what, "%s: frame %llu", rc_names[s->kind], (unsigned long long)s->index);
    const rule_map map = {f->width,
                          f->height,
                          f->slices,
                          (const float *)(const void *)(s->block + ly_depth_at(w)),
                          s->status ? s->block + ly_status_at(w) : NULL,
                          s->stats ? &stats : NULL,
                          s->returned,
                          ly_is_own(w)};
    rule_depths(&i->called, &map, what);
    rule_outcome(&i->called, &map, what);
    if (s->stats) rule_statistics(&i->called, &map);
}

/* What of the results is in the block. */
static void note_results(ly_slot *s, const rc_call *c) {
    s->kind = c->kind;
    s->returned = c->status;
    s->status = c->result->status != NULL;
    s->stats = c->result->stats != NULL;
}

/* Pixels that were not written clip nothing. */
static void mend(const ly_watch *w, const sv_result *r) {
    for (size_t y = 0; y < w->format.height; y++)
        for (size_t x = 0; x < w->format.width; x++)
            if (isnan(map_row(w, r, y)[x])) map_row(w, r, y)[x] = 0.0f;
}

/* Own queue: the results are there. */
static void check_memory(ly_instance *i, const rc_call *c) {
    ly_watch *w = i->watch;
    const sv_result *r = c->result;
    ly_slot *s = w->now;
    const size_t row = w->format.width * sizeof(float);
    const uint32_t seen = atomic_load(&i->seen[RULE_depth_values]);
    for (size_t y = 0; y < w->format.height; y++)
        memcpy(s->block + ly_depth_at(w) + y * row, map_row(w, r, y), row);
    if (r->status) memcpy(s->block + ly_status_at(w), r->status, w->rays);
    if (r->stats) memcpy(s->block + ly_stats_at(w), r->stats, sizeof *r->stats);
    note_results(s, c);
    if (ly_is_lost(i))
        mend(w, r);
    else
        ly_results_judge(i, s);
    if (seen != atomic_load(&i->seen[RULE_depth_values])) mend(w, r);
}

/* Host's queue: enqueues the way of results and second samples into the block. */
static void enqueue_results(ly_watch *w, const rc_call *c) {
    const sv_result *r = c->result;
    ly_slot *s = w->now;
    cl_command_queue q = w->format.queue;
    const size_t row = w->format.width * sizeof(float), pitch = r->depth_pitch ? r->depth_pitch : row;
    const size_t at[3] = {ly_depth_at(w), 0, 0}, none[3] = {0, 0, 0}, region[3] = {row, w->format.height, 1};
    for (uint32_t n = 0; n < s->count; n++) ly_fetch(w, s, &s->places[n], w->samples + s->places[n].at);
    cl_int code = r->depth_object ? clEnqueueCopyBuffer(q, r->depth_object, s->device, r->depth_offset, at[0],
                                                        w->rays * sizeof(float), 0, NULL, NULL)
                                  : clEnqueueWriteBufferRect(q, s->device, CL_FALSE, at, none, region, row, 0,
                                                             pitch, 0, r->depth, 0, NULL, NULL);
    if (code == CL_SUCCESS && r->status)
        code =
            clEnqueueWriteBuffer(q, s->device, CL_FALSE, ly_status_at(w), w->rays, r->status, 0, NULL, NULL);
    if (code == CL_SUCCESS && r->stats)
        code = clEnqueueWriteBuffer(q, s->device, CL_FALSE, ly_stats_at(w), sizeof(sv_stats), r->stats, 0,
                                    NULL, NULL);
    if (code == CL_SUCCESS)
        code = clEnqueueReadBuffer(q, s->device, CL_FALSE, 0, w->bytes, s->block, 0, NULL, &s->done);
    note_results(s, c);
    if (code != CL_SUCCESS) w->trouble = code;
}

/* ---- maps that are lent */
static uint8_t *lent_status(const ly_watch *w) {
    return w->lent + w->rays * sizeof(float) + SV_BAND_BYTES;
}

const sv_result *ly_results_lend(const ly_instance *i, const rc_call *c, sv_result *lent) {
    const ly_watch *w = i->watch;
    const sv_result *r = c->result;
    if (!w || !w->lent || !c->sound || !r || r->size != sizeof *r || !r->depth) return r;
    if (r->depth_pitch != 0 && r->depth_pitch != w->format.width * sizeof(float)) return r;
    *lent = *r;
    lent->depth = memcpy(w->lent, r->depth, w->rays * sizeof(float));
    if (r->status) lent->status = memcpy(lent_status(w), r->status, w->rays);
    sv_band_make(w->lent + w->rays * sizeof(float));
    sv_band_make(lent_status(w) + w->rays);
    return lent;
}

void ly_results_back(ly_instance *i, const rc_call *c, const sv_result *lent) {
    const ly_watch *w = i->watch;
    const char *call = rc_names[c->kind];
    const unsigned rays = (unsigned)w->rays;
    memcpy(c->result->depth, lent->depth, w->rays * sizeof(float));
    if (lent->status) memcpy(c->result->status, lent->status, w->rays);
    RULE_EXPECT(&i->called, RULE_guard_bands, sv_band_holds(w->lent + w->rays * sizeof(float)), SV_BAND_TEXT,
                call, rays, "");
    RULE_EXPECT(&i->called, RULE_guard_bands, sv_band_holds(lent_status(w) + w->rays), SV_BAND_TEXT, call,
                rays, SV_BAND_STATUS);
}

void ly_results_before(ly_watch *w, const sv_result *r) {
    ly_slot *s = w->now;
    if (r->stats) s->stats_size = r->stats->size;
    if (!ly_is_own(w)) {
        paint(w, s, r, NAN);
        return;
    }
    paint_memory(w, r, NAN);
    if (r->status) memset(r->status, 0xff, w->rays);
    if (r->stats)
        memset((char *)r->stats + sizeof r->stats->size, 0xff, sizeof *r->stats - sizeof r->stats->size);
}

void ly_results_after(ly_instance *i, const rc_call *c) {
    ly_watch *w = i->watch;
    if (c->status >= SV_OK && ly_is_own(w)) check_memory(i, c);
    if (c->status >= SV_OK && !ly_is_own(w)) enqueue_results(w, c);
    w->now->muddled = ly_is_lost(i);
    if (c->status >= SV_OK) return;
    /* The NaN of before must not reach a renderer. */
    if (ly_is_own(w))
        paint_memory(w, c->result, 0.0f);
    else
        paint(w, w->now, c->result, 0.0f);
}
