/* SPDX-License-Identifier: MIT */
#include "core/progress.h"
#include "core/text.h"
#include "guarded/in_child.h"
#include "plugin/loader_param.h"
#include "replay/replay.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lines of a log, one behind the other. */
enum { LINES_BYTES = 1 << 16 };
typedef struct {
    char text[LINES_BYTES];
    size_t used;
} lines;

typedef struct {
    const rp_options *o;
    rp_report *report;
    hs_plugin plugin;
    rp_hand hand;
    rec_item item; /* of the recording */
    sv_param_value sets[RP_MAX_SETS], values[REC_MAX_VALUES + RP_MAX_SETS];
    bool other, guarded; /* another plugin than the recorded one; its logs and states are not seen */
    struct {
        uint32_t there, here;
    } ids[REC_MAX_VALUES]; /* of a parameter of the recorded plugin, and of this one; 0: it has none */
    uint32_t id_count;
    bool played; /* the call under way was made here, too */
    bool active;
    sv_status status;
    bool has_voxels;      /* the frame has them */
    double began, spared; /* seconds; the first activate compiles, whatever the recording asks for */
    double longest;       /* of the activates behind it, which may compile, too */
    lines here, there;
    uint64_t frame_index;
    rp_frame frame; /* under way, if it is to be drawn */
} player;

/* ---- what differs */
static void differ(player *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void differ(player *p, const char *format, ...) {
    rp_report *r = p->report;
    if (r->differences++ >= RP_MAX_TOLD) return;
    char *to = r->told[r->differences - 1];
    const size_t room = sizeof r->told[0];
    int used = 0;
    if (r->frames > 0)
        used = snprintf(to, room, "frame %u (the host's %" PRIu64 "): ", r->frames - 1, p->frame_index);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(to + used, room - (size_t)used, format, args);
    va_end(args);
}

/* Every number in a line of severity debug or info counts as the same: most are times. */
static void add_line(lines *l, int32_t severity, const char *text) {
    const bool numbers = severity >= SV_LOG_WARNING;
    const size_t length = strlen(text);
    if (l->used + length + 16 >= LINES_BYTES) return;
    l->used += (size_t)sprintf(l->text + l->used, "%d ", (int)severity);
    for (size_t i = 0; i < length; i++) {
        const bool digit = strchr("0123456789.", text[i]) != NULL;
        if (numbers || !digit)
            l->text[l->used++] = text[i] == '\n' ? ' ' : text[i];
        else if (l->text[l->used - 1] != '#')
            l->text[l->used++] = '#';
    }
    l->text[l->used++] = '\n';
    l->text[l->used] = '\0';
}

static void hear(void *ear, int32_t severity, const char *text) {
    player *p = ear;
    add_line(&p->here, severity, text);
}

/* The first line that is another one. */
static void compare_lines(player *p, const char *call) {
    const char *a = p->here.text, *b = p->there.text;
    p->here.text[p->here.used] = p->there.text[p->there.used] = '\0';
    while (!p->guarded && (*a || *b)) {
        const size_t here = strcspn(a, "\n"), there = strcspn(b, "\n");
        p->report->lines++;
        if (here != there || memcmp(a, b, here) != 0) {
            differ(p, "%s: the log has \"%.*s\", recorded is \"%.*s\"", call, here < 120 ? (int)here : 120, a,
                   there < 120 ? (int)there : 120, b);
            break;
        }
        a += here + (a[here] != '\0');
        b += there + (b[there] != '\0');
    }
    p->here.used = p->there.used = 0;
}

/* ---- values */
/* The id that a recorded parameter has here: by its key, if the plugin is another one. 0: it has none. */
static uint32_t id_here(const player *p, uint32_t id) {
    if (!p->other) return id;
    for (uint32_t i = 0; i < p->id_count; i++)
        if (p->ids[i].there == id) return p->ids[i].here;
    return 0;
}

/* What passes once for all values of the recording. */
static void learn_ids(player *p) {
    p->id_count = p->item.param_count;
    for (uint32_t i = 0; i < p->id_count; i++) {
        sv_param_info info = {.size = sizeof info};
        p->ids[i].there = p->item.params[i].id;
        p->ids[i].here = hs_plugin_find_param(&p->plugin, p->item.params[i].key, &info) ? info.id : 0;
    }
}

/* The recorded list without what is set on the command line, and that behind it: a repeated id's last value
 * counts. `activating`: only what activate reads. */
static uint32_t list_values(player *p, bool activating) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->item.value_count; i++) {
        const uint32_t id = id_here(p, p->item.values[i].id);
        bool set = id == 0;
        for (uint32_t s = 0; s < p->o->set_count; s++) set |= p->sets[s].id == id;
        if (!set) p->values[count++] = (sv_param_value){.id = id, .value = p->item.values[i].value};
    }
    for (uint32_t s = 0; s < p->o->set_count; s++)
        if (hs_plugin_is_fixed(p->plugin.instance, p->sets[s].id) == activating)
            p->values[count++] = p->sets[s];
    return count;
}

/* ---- calls */
/* Where the plugin has put the depth of a ray. */
static const void *played_at(const player *p, size_t ray) {
    const uint32_t width = p->hand.format.width;
    return (const char *)p->hand.depth + ray / width * p->hand.row + ray % width * sizeof(float);
}

static float depth_of(const void *at) {
    float depth;
    memcpy(&depth, at, sizeof depth);
    return depth;
}

static void keep_slab(player *p) {
    const rec_item *it = &p->item;
    const size_t slice = (size_t)p->frame.format.width * p->frame.format.height;
    if (!p->frame.voxels || !it->voxels) return;
    memcpy(p->frame.voxels + it->slab.first_slice * slice, it->data, it->bytes);
}

/* Begins to keep the frame if it may be the one that is drawn. */
static void keep_frame(player *p) {
    const sv_format *f = &p->hand.format;
    rp_frame_free(&p->frame);
    if (!p->o->out || !p->active || (p->o->frame != RP_LAST && p->o->frame != p->report->frames - 1)) return;
    p->frame = (rp_frame){.number = p->report->frames - 1, .format = *f};
    p->frame.voxels = calloc((size_t)f->width * f->height, f->slices);
    if (p->item.ranges && p->item.data && (p->frame.ranges = malloc(p->item.bytes)))
        memcpy(p->frame.ranges, p->item.data, p->item.bytes);
}

static void keep_maps(player *p) {
    const sv_format *f = &p->hand.format;
    const size_t rays = (size_t)f->width * f->height;
    if (!p->frame.voxels || !p->has_voxels || !p->hand.depth) return;
    free(p->frame.depth);
    free(p->frame.status);
    p->frame.outcome = p->status == SV_OK && p->hand.stats.rays ? p->hand.stats.outcome : p->status;
    p->frame.depth = malloc(rays * sizeof(float));
    p->frame.status = malloc(rays);
    if (!p->frame.depth || !p->frame.status) return;
    for (size_t i = 0; i < rays; i++) {
        const float depth = depth_of(played_at(p, i));
        p->frame.depth[i] = isfinite(depth) ? depth : 0.0f; /* it is drawn */
    }
    memcpy(p->frame.status, p->hand.status, rays);
    rp_frame_free(&p->report->drawn);
    p->report->drawn = p->frame;
    p->frame = (rp_frame){0};
}

/* The plugin's activation follows what happens here, not what was recorded: its memory is freed behind it. */
static void end_activation(player *p) {
    if (p->active) p->plugin.instance->deactivate(p->plugin.instance);
    p->active = false;
    rp_hand_release(&p->hand);
}

static bool play_activate(player *p, hs_error *err) {
    const sv_plugin *in = p->plugin.instance;
    if (p->active) differ(p, "activate: an activation lasts here that had ended there");
    end_activation(p);
    if (!rp_hand_format(&p->hand, p->o, &p->item, err)) return false;
    sv_format format = p->hand.format;
    format.value_count = list_values(p, true);
    format.values = format.value_count ? p->values : NULL;
    const double start = hs_now();
    p->status = in->activate(in, &format);
    const double took = hs_now() - start;
    if (p->spared == 0.0)
        p->spared = took;
    else
        p->longest = fmax(p->longest, took);
    p->active = hs_status_is_success(p->status);
    return true;
}

static bool play_begin(player *p, hs_error *err) {
    const sv_plugin *in = p->plugin.instance;
    sv_frame frame;
    if (p->report->frames++ == 0) p->report->fresh = (p->item.frame.flags & SV_FRAME_DISCONTINUITY) != 0;
    p->frame_index = p->item.frame.index;
    p->has_voxels = true;
    if (!rp_hand_frame(&p->hand, &p->item, &frame, err)) return false;
    frame.value_count = list_values(p, false);
    frame.values = frame.value_count ? p->values : NULL;
    keep_frame(p);
    p->status = in->begin(in, &frame);
    return true;
}

static bool play_slab(player *p, hs_error *err) {
    const sv_plugin *in = p->plugin.instance;
    sv_slab slab;
    p->has_voxels = p->has_voxels && p->item.voxels;
    if (!rp_hand_slab(&p->hand, &p->item, &slab, err)) return false;
    keep_slab(p);
    if (p->item.voxels) p->report->voxel_bytes += p->item.bytes;
    p->status = in->slab(in, &slab);
    return true;
}

static bool play_result(player *p, hs_error *err) {
    const sv_plugin *in = p->plugin.instance;
    sv_result result;
    if (!rp_hand_result(&p->hand, &p->item, &result, err)) return false;
    const uint32_t count = p->item.kind == RC_ADJUST ? list_values(p, false) : 0;
    p->status = p->item.kind == RC_ADJUST ? in->adjust(in, count ? p->values : NULL, count, &result)
                                          : in->end(in, &result);
    if (!rp_hand_collect(&p->hand, err)) return false;
    if (p->status >= SV_OK) keep_maps(p);
    return true;
}

static bool play_call(player *p, hs_error *err) {
    const bool frames = p->item.kind >= RC_BEGIN;
    const double start = hs_now();
    bool ok = true;
    /* A frame of an activation that was refused here alone has nobody to go to. */
    p->played = p->item.sound && (!frames || p->active);
    p->report->left_out += !p->item.sound;
    if (!p->played) return true;
    p->here.used = p->there.used = 0;
    p->status = SV_OK;
    p->report->calls++;
    hs_child_goes_on();
    switch (p->item.kind) {
    case RC_ACTIVATE:
        ok = play_activate(p, err);
        break;
    case RC_DEACTIVATE:
        end_activation(p);
        break;
    case RC_BEGIN:
        ok = play_begin(p, err);
        break;
    case RC_SLAB:
        ok = play_slab(p, err);
        break;
    case RC_END:
    case RC_ADJUST:
        ok = play_result(p, err);
        break;
    default: /* create and destroy are made around all of it */
        p->played = false;
    }
    if (frames) p->report->ms += 1e3 * (hs_now() - start);
    return ok;
}

/* ---- what came of it */
static void compare_depths(player *p) {
    const sv_format *f = &p->hand.format;
    const size_t rays = (size_t)f->width * f->height;
    uint32_t apart = 0;
    size_t first = 0;
    float largest = 0.0f;
    p->report->maps++;
    for (size_t i = rays; i-- > 0;) {
        const void *const here = played_at(p, i), *const there = p->item.data + i * sizeof(float);
        if (memcmp(here, there, sizeof(float)) == 0) continue;
        apart++;
        first = i;
        largest = fmaxf(largest, fabsf(depth_of(here) - depth_of(there)));
    }
    if (apart == 0) return;
    const float a = depth_of(played_at(p, first)), b = depth_of(p->item.data + first * sizeof(float));
    differ(
        p,
        "%s: %u of %zu depths are others, by up to %g slices; the first is ray (%zu, %zu): %g, recorded %g",
        rc_names[p->item.kind], apart, rays, (double)largest, first % f->width, first / f->width, (double)a,
        (double)b);
}

static void compare_results(player *p) {
    const size_t rays = (size_t)p->hand.format.width * p->hand.format.height;
    const sv_stats *here = &p->hand.stats, *there = &p->item.found;
    const char *call = rc_names[p->item.kind];
    if (p->item.stats && p->hand.format.width > 0 &&
        (here->outcome != there->outcome || here->rays != there->rays || here->points != there->points ||
         here->unfilled != there->unfilled))
        differ(p, "%s: %s, %u rays, %u points, %u without a surface; recorded %s, %u, %u, %u", call,
               hs_status_name(here->outcome), here->rays, here->points, here->unfilled,
               hs_status_name(there->outcome), there->rays, there->points, there->unfilled);
    if (p->item.maps == 0 || !p->item.data || !p->hand.depth) return;
    compare_depths(p);
    if (p->item.maps == 2 && memcmp(p->hand.status, p->item.data + rays * sizeof(float), rays) != 0)
        differ(p, "%s: the status map is another one", call);
}

/* A guard makes the calls of a frame all at once, in end: what begin and slab came to is not seen, nor are
 * lines. Without voxels, only calls that fail are the same. */
static void compare_return(player *p) {
    const rec_item *it = &p->item;
    const bool delivers = it->kind == RC_END || it->kind == RC_ADJUST;
    const char *call = rc_names[it->kind];
    p->report->recorded_ms += it->kind >= RC_BEGIN ? (double)it->ns * 1e-6 : 0.0;
    if (!p->played) return;
    const bool hidden = p->guarded && (it->kind == RC_BEGIN || it->kind == RC_SLAB);
    const bool open = delivers && !p->has_voxels && it->returned >= SV_OK && p->status >= SV_OK;
    /* Of a host's queue end returns SV_OK, of a plugin's own the outcome, which the statistics have, too. */
    const bool alike = delivers && it->returned >= SV_OK && p->status >= SV_OK &&
                       (it->returned == SV_OK || p->status == SV_OK);
    p->report->maps_kept |= it->maps > 0;
    if (!hidden && !open && !alike && p->status != it->returned)
        differ(p, "%s: %s, recorded %s%s%s", call, hs_status_name(p->status), hs_status_name(it->returned),
               it->reason[0] ? ": " : "", it->reason);
    else if (delivers && p->has_voxels && p->status >= SV_OK && it->returned >= SV_OK)
        compare_results(p);
    if (it->kind == RC_ACTIVATE && it->returned < SV_OK) end_activation(p); /* no frame of it follows */
    compare_lines(p, call);
    p->played = false;
}

/* ---- all of it */
static void meet_plugin(player *p) {
    rp_report *r = p->report;
    (void)hs_text_escape(r->id, sizeof r->id, p->item.id, 0);
    (void)hs_text_escape(r->version, sizeof r->version, p->item.version, 0);
    p->other = strcmp(p->item.id, p->plugin.instance->descriptor->id) != 0;
    if (p->other) learn_ids(p);
}

static bool is_in_time(const player *p, hs_error *err) {
    const bool activates = p->item.type == REC_CALL && p->item.kind == RC_ACTIVATE;
    const double seconds = hs_now() - p->began - p->spared;
    return seconds + (activates ? p->longest : 0.0) <= p->o->seconds ||
           hs_fail(err, HS_ERR_INPUT,
                   "%s: has been played for %.1f s, and a recording of this size may take %.1f: --seconds "
                   "allows more",
                   p->o->file, seconds, p->o->seconds);
}

static bool play_items(player *p, rec_reader *reader, hs_error *err) {
    char wrong[1500];
    int there;
    p->began = hs_now();
    while ((there = rec_reader_next(reader, &p->item, wrong, sizeof wrong)) == 1) {
        if (!is_in_time(p, err)) return false;
        if (p->item.type == REC_PLUGIN) meet_plugin(p);
        if (p->item.type == REC_CALL && !play_call(p, err)) return false;
        if (p->item.type == REC_RETURN) compare_return(p);
        if (p->item.type == REC_LOG && p->played && p->item.severity >= 0)
            add_line(&p->there, p->item.severity, p->item.text);
        if (p->item.type == REC_LOG && p->o->verbose)
            hs_print(stdout, "recorded line, severity %d: %s\n", (int)p->item.severity, p->item.text);
    }
    return there == 0 || hs_fail(err, HS_ERR_INPUT, "%s", wrong);
}

static bool parse_sets(player *p, hs_error *err) {
    for (uint32_t i = 0; i < p->o->set_count; i++)
        if (!hs_plugin_parse_param(&p->plugin, p->o->sets[i], &p->sets[i], err)) return false;
    return true;
}

bool rp_play(const rp_options *o, rp_report *report, hs_error *err) {
    char wrong[1500];
    rec_reader *reader = rec_reader_open(o->file, wrong, sizeof wrong);
    if (!reader) return hs_fail(err, HS_ERR_INPUT, "%s", wrong);
    player *p = calloc(1, sizeof *p);
    hs_guard_options guard = o->guard;
    if (guard.choice == HS_GUARD_AUTO) guard.choice = HS_GUARD_OFF; /* all of this is in a child, then */
    const int32_t level = o->verbose ? SV_LOG_DEBUG : SV_LOG_PLUGIN_MISBEHAVING + 1;
    bool ok = p || hs_fail(err, HS_ERR_MEMORY, "no memory");
    if (ok && hs_guarded_open(&p->plugin, o->plugin, o->id, level, &guard, err)) {
        p->o = o;
        p->report = report;
        p->hand.plugin = &p->plugin;
        p->guarded = hs_is_guarded(&p->plugin);
        p->plugin.hears = hear;
        p->plugin.ear = p;
        ok = parse_sets(p, err) && play_items(p, reader, err);
        end_activation(p);
        p->plugin.hears = NULL;
        rp_hand_close(&p->hand);
        rp_frame_free(&p->frame);
        hs_error ended = {0};
        p->plugin.complaint[0] = '\0'; /* lines are compared */
        if (!hs_guarded_close(&p->plugin, &ended) && ok) ok = hs_fail(err, ended.code, "%s", ended.text);
    } else {
        ok = false;
    }
    free(p);
    rec_reader_close(reader);
    return ok;
}

void rp_frame_free(rp_frame *frame) {
    free(frame->voxels);
    free(frame->ranges);
    free(frame->depth);
    free(frame->status);
    *frame = (rp_frame){0};
}
