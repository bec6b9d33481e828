/* SPDX-License-Identifier: MIT */
/* Checks of calls in every state. */
#include "validate/checks/check.h"

/* What the header says of an instance. */
typedef enum { INACTIVE, IDLE, BEGUN, MIDWAY, COMPLETE, FINISHED, STATES } state;
typedef enum { ACTIVATE, BEGIN, SLAB, END, ADJUST, CALLS } call;

static const char *const state_names[STATES] = {"inactive",       "active",   "begun",
                                                "amid its slabs", "complete", "finished"};
static const char *const call_names[CALLS] = {"activate", "begin", "slab", "end", "adjust"};

/* What a call returns in a state; `slab` is the one that comes next, or the first one if none does. */
static const sv_status expected[STATES][CALLS] = {
    [INACTIVE] = {SV_OK, SV_ERR_STATE, SV_ERR_STATE, SV_ERR_STATE, SV_ERR_STATE},
    [IDLE] = {SV_ERR_STATE, SV_OK, SV_ERR_STATE, SV_ERR_STATE, SV_ERR_STATE},
    [BEGUN] = {SV_ERR_STATE, SV_OK, SV_OK, SV_ERR_SLAB_MISSING, SV_ERR_STATE},
    [MIDWAY] = {SV_ERR_STATE, SV_OK, SV_OK, SV_ERR_SLAB_MISSING, SV_ERR_STATE},
    [COMPLETE] = {SV_ERR_STATE, SV_OK, SV_ERR_SLAB_ORDER, SV_OK, SV_ERR_STATE},
    [FINISHED] = {SV_ERR_STATE, SV_OK, SV_ERR_STATE, SV_ERR_STATE, SV_OK},
};

typedef struct {
    v_rig *r;
    state now;
    uint32_t slabs; /* that have come */
} machine;

/* What comes of a call that returned `status`. */
static void follow(machine *m, call c, sv_status status) {
    if (status == SV_ERR_STATE) return; /* a call in the wrong state changes nothing */
    if (c == ACTIVATE && status >= 0) m->now = IDLE;
    if (c == BEGIN) m->now = status >= 0 ? BEGUN : IDLE;
    if (c == BEGIN) m->slabs = 0;
    if (c == SLAB) {
        m->slabs++;
        m->now = status < 0 ? IDLE : m->slabs == m->r->stage.slab_count ? COMPLETE : MIDWAY;
    }
    if (c == END) m->now = status >= 0 ? FINISHED : IDLE;
}

static sv_status make(machine *m, call c) {
    const sv_plugin *p = m->r->s.plugin;
    stage *st = &m->r->stage;
    switch (c) {
    case ACTIVATE:
        v_where(m->r->s.run, "activate when %s", state_names[m->now]);
        return p->activate(p, &st->format);
    case BEGIN:
        return v_begin(p, st, NULL, 0);
    case SLAB:
        return v_slab(p, st, m->now == BEGUN || m->now == MIDWAY ? m->slabs : 0);
    case END:
        return v_end(p, st);
    default:
        return v_adjust(p, st, NULL, 0);
    }
}

/* The call returns what the header says, and after end and adjust the map is the good one. */
static void try_call(machine *m, call c) {
    v_run *run = m->r->s.run;
    const sv_status wanted = expected[m->now][c], status = make(m, c);
    const bool fits = wanted == SV_OK ? status >= 0 : status == wanted;
    V_EXPECT(run, fits, "%s when %s: %s, expected %s", call_names[c], state_names[m->now], v_status(status),
             v_status(wanted));
    if (status >= 0 && (c == END || c == ADJUST)) {
        const v_map map = v_collect(&m->r->stage, status);
        v_map_expect(run, &m->r->good, &map, "%s after other calls gives another map", call_names[c]);
    } else if (m->r->stage.device.queue) {
        (void)clFinish(m->r->stage.device.queue);
    }
    follow(m, c, status);
}

/* Brings the instance into a state by right calls, from a fresh activation or none. */
static void enter(machine *m, state wanted) {
    if (m->now != INACTIVE) v_deactivate(&m->r->s, m->r->s.plugin);
    m->now = INACTIVE;
    while (m->now != wanted)
        try_call(m, (call)(m->now < MIDWAY ? (call)m->now : m->now == MIDWAY ? SLAB : END));
}

/* deactivate of an inactive instance and destroy of an active one are the host's errors, and no accidents. */
static void try_ends(machine *m) {
    const sv_plugin *p = m->r->s.plugin, *other = v_another(&m->r->s);
    enter(m, INACTIVE);
    v_where(m->r->s.run, "deactivate when inactive");
    p->deactivate(p);
    v_activate(&m->r->s, other, &m->r->stage);
    (void)v_frame(&m->r->s, other, &m->r->stage, NULL, 0);
    const uint32_t lines = m->r->s.host.lines;
    v_where(m->r->s.run, "destroy when active");
    other->destroy(other);
    if (m->r->s.host.lines == lines || m->r->s.host.severity != SV_LOG_HOST_MISBEHAVING)
        v_warn(m->r->s.run, "destroy of an active instance does not tell the host (SV_LOG_HOST_MISBEHAVING)");
}

void check_call_states(v_run *run) {
    machine m = {v_rig_good(run), FINISHED, 0};
    for (int in = INACTIVE; in < STATES; in++)
        for (int c = ACTIVATE; c < CALLS; c++) {
            if ((state)in == MIDWAY && m.r->stage.slab_count < 2) continue;
            enter(&m, (state)in);
            try_call(&m, (call)c);
            if (m.now != INACTIVE) { /* whatever happened, the next frame is good */
                try_call(&m, BEGIN);
                while (m.now != COMPLETE) try_call(&m, SLAB);
                try_call(&m, END);
            }
        }
    try_ends(&m);
    if (m.now == INACTIVE) v_activate(&m.r->s, m.r->s.plugin, &m.r->stage);
}

/* ---- at random */
/* Mostly what leads on, so that every state is reached; else anything. */
static call choose(v_run *run, const machine *m) {
    static const call next[STATES] = {ACTIVATE, BEGIN, SLAB, SLAB, END, ADJUST};
    return v_random(run, 10) < 7 ? next[m->now] : (call)v_random(run, CALLS);
}

void check_state_walk(v_run *run) {
    machine m = {v_rig_good(run), FINISHED, 0};
    const uint32_t steps = 100 * run->level;
    for (uint32_t i = 0; i < steps; i++) {
        if (m.now != INACTIVE && v_random(run, 60) == 0) {
            v_deactivate(&m.r->s, m.r->s.plugin);
            m.now = INACTIVE;
        }
        try_call(&m, choose(run, &m));
    }
    v_note(run, "%u calls", steps);
    if (m.now == INACTIVE) v_activate(&m.r->s, m.r->s.plugin, &m.r->stage);
}

/* -------------------------------------------------------------------------------------------- settings -- */
/* Other checks try the plugin as it is by default. This one tries every method that it has, briefly: what a
 * parameter of activate chooses may be another program. */

enum { MAX_VALUES = 64 };

static v_params params;

static void inspect_map(v_run *run, const v_map *map, uint32_t slices, const char *what) {
    v_map_check_depths(run, map, slices, what);
    V_EXPECT(run, map->outcome == SV_OK || map->outcome == SV_PARTIAL || map->outcome == SV_NO_SURFACE,
             "%s: the outcome is %s", what, v_status(map->outcome));
    V_EXPECT(run, map->stats.rays == map->width * map->height && map->stats.unfilled <= map->stats.rays,
             "%s: the statistics say %u of %u rays are without a surface", what, map->stats.unfilled,
             map->stats.rays);
}

static void try_setting(v_rig *r, const sv_param_info *p, double value) {
    v_run *run = r->s.run;
    stage_way way = v_standard_way(&r->s);
    char what[120];
    (void)snprintf(what, sizeof what, "%s = %g", p->key, value);
    way.fixed[0] = (sv_param_value){p->id, 0, value};
    way.fixed_count = 1;
    v_rig_again(r, &way);
    const v_map first = v_rig_frame(r, NULL, 0);
    inspect_map(run, &first, way.slices, what);
    for (int turn = 0; turn < 2; turn++) {
        static const char *const ways[] = {"the same frame again",
                                           "other slabs, padding bytes of 255 and results with a pitch"};
        if (turn == 1) {
            way.hatch = 255;
            way.longest = 3;
            way.pitch = 3;
            v_rig_again(r, &way);
        }
        v_rig_expect(r, &first, "%s: %s give another map", what, ways[turn]);
        const char *place = stage_trespass(&r->stage, STAGE_POISON);
        V_EXPECT(run, !place, "%s: end: surface wrote beyond its rays: %s", what, place);
    }
}

void check_every_setting(v_run *run) {
    uint32_t tried = 0;
    v_rig *r = v_rig_standard(run);
    v_params_read(&r->s, &params);
    for (uint32_t i = 0; i < params.count; i++) {
        double values[MAX_VALUES];
        if (!(params.info[i].flags & SV_PARAM_REACTIVATE)) continue;
        const uint32_t most = params.info[i].type == SV_PARAM_INT ? 3 : MAX_VALUES;
        const uint32_t count = v_param_choice(&r->s, &params.info[i], values, most);
        for (uint32_t n = 0; n < count; n++) {
            if (values[n] == params.info[i].default_value) continue; /* the other checks try that */
            try_setting(r, &params.info[i], values[n]);
            tried++;
        }
    }
    if (tried == 0) v_skip(run, "no parameter needs a new activation");
    v_note(run, "%u values, in two ways each", tried);
}
