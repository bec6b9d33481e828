/* SPDX-License-Identifier: MIT */
#include "validate/checks/check_state.h"

#include "validate/drive/drive_frame.h"

#include <stdio.h>
#include <string.h>

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
    v_rig r;
    v_map good;
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
        m->now = status < 0 ? IDLE : m->slabs == m->r.stage.slab_count ? COMPLETE : MIDWAY;
    }
    if (c == END) m->now = status >= 0 ? FINISHED : IDLE;
}

static sv_status make(machine *m, call c) {
    const sv_plugin *p = m->r.s.plugin;
    v_stage *st = &m->r.stage;
    switch (c) {
    case ACTIVATE:
        v_where(m->r.s.run, "activate when %s", state_names[m->now]);
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
    v_run *run = m->r.s.run;
    const sv_status wanted = expected[m->now][c], status = make(m, c);
    const bool fits = wanted == SV_OK ? status >= 0 : status == wanted;
    V_EXPECT(run, fits, "%s when %s: %s, expected %s", call_names[c], state_names[m->now], v_status(status),
             v_status(wanted));
    if (status >= 0 && (c == END || c == ADJUST)) {
        v_map map;
        v_collect(&m->r.stage, status, &map);
        v_map_expect(run, &m->good, &map, "%s after other calls gives another map", call_names[c]);
    } else if (m->r.stage.device) {
        (void)clFinish(m->r.stage.device->queue);
    }
    follow(m, c, status);
}

/* From a fresh activation, or none, by right calls. */
static void enter(machine *m, state wanted) {
    if (m->now != INACTIVE) v_deactivate(&m->r.s, m->r.s.plugin);
    m->now = INACTIVE;
    while (m->now != wanted)
        try_call(m, (call)(m->now < MIDWAY ? (call)m->now : m->now == MIDWAY ? SLAB : END));
}

static void open_machine(v_run *run, machine *m) {
    memset(m, 0, sizeof *m);
    v_rig_standard(run, &m->r);
    v_frame(&m->r.s, m->r.s.plugin, &m->r.stage, NULL, 0, &m->good);
    m->now = FINISHED;
}

static void close_machine(machine *m) {
    if (m->now == INACTIVE) v_activate(&m->r.s, m->r.s.plugin, &m->r.stage);
    v_map_free(&m->good);
    v_rig_close(&m->r);
}

/* deactivate of an inactive instance and destroy of an active one are the host's errors, and no accidents. */
static void try_ends(machine *m) {
    const sv_plugin *p = m->r.s.plugin, *other = v_another(&m->r.s);
    enter(m, INACTIVE);
    v_where(m->r.s.run, "deactivate when inactive");
    p->deactivate(p);
    v_activate(&m->r.s, other, &m->r.stage);
    v_map map;
    v_frame(&m->r.s, other, &m->r.stage, NULL, 0, &map);
    v_map_free(&map);
    const uint32_t lines = m->r.s.host.lines;
    v_where(m->r.s.run, "destroy when active");
    other->destroy(other);
    if (m->r.s.host.lines == lines || m->r.s.host.severity != SV_LOG_HOST_MISBEHAVING)
        v_warn(m->r.s.run, "destroy of an active instance does not tell the host (SV_LOG_HOST_MISBEHAVING)");
}

void check_call_states(v_run *run) {
    machine m;
    open_machine(run, &m);
    for (int in = INACTIVE; in < STATES; in++)
        for (int c = ACTIVATE; c < CALLS; c++) {
            if ((state)in == MIDWAY && m.r.stage.slab_count < 2) continue;
            enter(&m, (state)in);
            try_call(&m, (call)c);
            if (m.now != INACTIVE) { /* whatever happened, the next frame is good */
                try_call(&m, BEGIN);
                while (m.now != COMPLETE) try_call(&m, SLAB);
                try_call(&m, END);
            }
        }
    try_ends(&m);
    close_machine(&m);
}

/* ---- at random */
/* Mostly what leads on, so that every state is reached; else anything. */
static call choose(v_run *run, const machine *m) {
    static const call next[STATES] = {ACTIVATE, BEGIN, SLAB, SLAB, END, ADJUST};
    return v_random(run, 10) < 7 ? next[m->now] : (call)v_random(run, CALLS);
}

void check_state_walk(v_run *run) {
    machine m;
    const uint32_t steps = 100 * run->level;
    open_machine(run, &m);
    for (uint32_t i = 0; i < steps; i++) {
        if (m.now != INACTIVE && v_random(run, 60) == 0) {
            v_deactivate(&m.r.s, m.r.s.plugin);
            m.now = INACTIVE;
        }
        try_call(&m, choose(run, &m));
    }
    v_note(run, "%u calls", steps);
    close_machine(&m);
}
