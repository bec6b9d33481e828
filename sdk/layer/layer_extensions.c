/* SPDX-License-Identifier: MIT */
/* Calls of extensions: [control] or [frame] as those of the instance, and judged as those are. Their
 * functions are given the plugin's own instance. */
#include "layer/layer.h"

#include "smartvis/lookup.h"

/* What the header of an extension asks of one call. */
typedef struct {
    ly_instance *i;
    const char *name;
    bool entered;
    sv_status due; /* the error that the plugin owes, and by which of its rules */
    rule_name owed;
    char why[200];
} call;

/* The host has got it wrong in this way, if nothing was wrong before. */
static void blame(call *c, bool wrong, sv_status due, rule_name host, rule_name owed, const char *why) {
    if (!wrong || !c->entered || c->due != SV_OK || ly_is_lost(c->i)) return;
    c->due = due;
    c->owed = owed;
    (void)snprintf(c->why, sizeof c->why, "%s", why);
    rule_tell(&c->i->called, host, "%s: %s", c->name, why);
}

static call enter(const sv_plugin *plugin, const char *name) {
    call c = {.i = ly_of(plugin), .name = name};
    c.entered = ly_enter(c.i, name);
    return c;
}

static void need_state(call *c, bool frame) {
    blame(c, c->i->shadow.state == SVA_INACTIVE, SV_ERR_STATE, RULE_host_states, RULE_call_states,
          "the instance is inactive");
    blame(c, frame && !c->i->has_frame, SV_ERR_STATE, RULE_host_states, RULE_call_states,
          "no frame has been finished");
}

/* A report of the oldest size is filled as far as it goes. */
static void need_report(call *c, const uint32_t *out) {
    blame(c, !out, SV_ERR_ARGUMENT, RULE_host_result, RULE_null_arguments, "out is NULL");
    if (out && *out < sizeof *out && c->entered)
        rule_tell(&c->i->called, RULE_host_sizes, "%s: out.size is %u", c->name, *out);
}

/* True if the plugin is not asked. */
static bool is_stopped(const call *c) {
    return !c->entered || (c->i->stops && c->i->stopped != SV_OK);
}

static void judge(call *c, sv_status status) {
    const rule_sink *to = &c->i->called;
    const char *name = sv_lookup_status(status);
    RULE_EXPECT(to, RULE_frame_outcome, name && status <= SV_OK, "%s: returns %s (%d)", c->name,
                name ? name : "a status that nobody knows", (int)status);
    if (ly_is_lost(c->i)) return;
    RULE_EXPECT(to, c->owed, c->due == SV_OK || status < SV_OK, "%s: returns %s, and %s was due: %s", c->name,
                name, sv_lookup_status(c->due), c->why);
    ly_check_reason(c->i, c->name, status);
}

/* Behind the plugin's call, if it was made. What the host gets. */
static sv_status leave(call *c, sv_status status) {
    ly_instance *i = c->i;
    if (c->entered && !is_stopped(c)) judge(c, status);
    if (c->entered && i->stopped != SV_OK) status = i->stopped = c->due != SV_OK ? c->due : i->stopped;
    if (!c->entered) status = SV_ERR_STATE;
    ly_leave(i, c->entered);
    return status;
}
#define ASK(c, expression)                                                                                   \
    (is_stopped(&(c)) ? SV_OK : (ly_foretell((c).i, (c).name, (c).due, (c).why), (expression)))

static void check_map(const call *c, sv_status status, const float *map) {
    const sv_format *f = &c->i->shadow.format;
    if (status == SV_OK && map && c->entered && c->due == SV_OK && !ly_is_lost(c->i))
        rule_confidence(&c->i->called, map, f->width, f->height, c->name);
}

static sv_status SV_CALL ly_confidence_read(const sv_plugin *plugin, float *map, sv_confidence_report *out) {
    call c = enter(plugin, "confidence read");
    need_state(&c, true);
    if (out) need_report(&c, &out->size);
    const sv_status status = ASK(c, c.i->inner_confidence->read(c.i->inner, map, out));
    check_map(&c, status, map);
    return leave(&c, status);
}

static uint32_t SV_CALL ly_confidence_offered(const sv_plugin *plugin) {
    call c = enter(plugin, "confidence offered");
    const uint32_t offered = c.i->inner_confidence->offered(c.i->inner);
    if (offered > 1)
        rule_tell(&c.i->asked, RULE_confidence, "confidence offered: returns %u, expected 0 or 1", offered);
    ly_leave(c.i, c.entered);
    return offered;
}

static sv_status SV_CALL ly_confidence_write(const sv_plugin *plugin, float *map, struct _cl_mem *object,
                                             uint64_t offset) {
    call c = enter(plugin, "confidence write");
    need_state(&c, true);
    blame(&c, (map != NULL) == (object != NULL), SV_ERR_ARGUMENT, RULE_host_result, RULE_null_arguments,
          map ? "both map and object are given" : "neither map nor object is given");
    const sv_status status = ASK(c, c.i->inner_confidence->write(c.i->inner, map, object, offset));
    check_map(&c, c.i->shadow.format.queue ? SV_ERR_STATE : status, map); /* else it is there later */
    return leave(&c, status);
}

static sv_status SV_CALL ly_needs_of(const sv_plugin *plugin, const sv_format *format,
                                     const sv_param_value *values, uint32_t count,
                                     const sv_needs_device *device, sv_needs *out) {
    call c = enter(plugin, "needs of");
    sv_status due = SV_OK;
    if (c.entered) due = ly_due_needs(c.i, format, values, count, device, out);
    if (due != SV_OK)
        blame(&c, true, due,
              due == SV_ERR_SIZE ? RULE_host_sizes
              : format           ? RULE_host_format
                                 : RULE_host_result,
              due == SV_ERR_SIZE ? RULE_struct_sizes : RULE_null_arguments, c.i->shadow.reason);
    return leave(&c, ASK(c, c.i->inner_needs->of(c.i->inner, format, values, count, device, out)));
}

static sv_status SV_CALL ly_points_write(const sv_plugin *plugin, sv_points_report *out) {
    call c = enter(plugin, "points write");
    need_state(&c, true);
    need_report(&c, out ? &out->size : NULL);
    return leave(&c, ASK(c, c.i->inner_points->write(c.i->inner, out)));
}

static sv_status SV_CALL ly_timing_enable(const sv_plugin *plugin, uint32_t on) {
    call c = enter(plugin, "timing enable");
    need_state(&c, false);
    return leave(&c, ASK(c, c.i->inner_timing->enable(c.i->inner, on)));
}

static sv_status SV_CALL ly_timing_stage_times(const sv_plugin *plugin, sv_stage_times *out) {
    call c = enter(plugin, "timing stage_times");
    need_state(&c, true);
    need_report(&c, out ? &out->size : NULL);
    return leave(&c, ASK(c, c.i->inner_timing->stage_times(c.i->inner, out)));
}

/* True if the descriptor names the extension. */
static bool is_announced(const ly_instance *i, const char *id) {
    const char *const *known = i->inner->descriptor->extensions;
    for (; known && *known; known++)
        if (strcmp(*known, id) == 0) return true;
    return false;
}

static const void *SV_CALL ly_get_extension(const sv_plugin *plugin, const char *id) {
    ly_instance *i = ly_of(plugin);
    const void *table = i->inner->get_extension(i->inner, id);
    if (!table || !id) return NULL;
    if (!is_announced(i, id)) {
        rule_tell(&i->asked, RULE_extensions,
                  "get_extension: there is a table for \"%.60s\", which the descriptor does not name", id);
        return NULL;
    }
    if (strcmp(id, SV_EXT_CONFIDENCE) == 0) return &i->confidence;
    if (strcmp(id, SV_EXT_NEEDS) == 0) return &i->needs;
    if (strcmp(id, SV_EXT_POINTS) == 0) return &i->points;
    if (strcmp(id, SV_EXT_TIMING) == 0) return &i->timing;
    ly_log(i, SV_LOG_INFO, "get_extension: the layer does not know \"%.60s\" and leaves it out", id);
    return NULL;
}

/* The plugin's table of an extension, and a copy in `own` for the host, of the plugin's size at most. */
static const void *find_table(const ly_instance *i, const char *id, void *own, uint32_t bytes) {
    const uint32_t *table = is_announced(i, id) ? i->inner->get_extension(i->inner, id) : NULL;
    if (table) *(uint32_t *)own = *table < bytes ? *table : bytes;
    return table;
}

void ly_fill_extensions(ly_instance *i) {
    i->api.get_extension = ly_get_extension;
    i->confidence = (sv_ext_confidence){0, 0, ly_confidence_read, ly_confidence_offered, ly_confidence_write};
    i->needs = (sv_ext_needs){0, 0, ly_needs_of};
    i->points = (sv_ext_points){0, 0, ly_points_write};
    i->timing = (sv_ext_timing){0, 0, ly_timing_enable, ly_timing_stage_times};
    i->inner_confidence = find_table(i, SV_EXT_CONFIDENCE, &i->confidence, sizeof i->confidence);
    i->inner_needs = find_table(i, SV_EXT_NEEDS, &i->needs, sizeof i->needs);
    i->inner_points = find_table(i, SV_EXT_POINTS, &i->points, sizeof i->points);
    i->inner_timing = find_table(i, SV_EXT_TIMING, &i->timing, sizeof i->timing);
}
