/* SPDX-License-Identifier: MIT */
/* Checks of how parameters describe themselves. */
#include "validate/checks/check.h"

typedef struct {
    const v_subject *s;
    uint32_t told; /* by param_count */
    rule_params all;
    rule_sink to;
} table;

/* Reads the parameters as they are reported, right or wrong. */
static table *read_table(v_run *run) {
    static table t;
    t.s = &v_rig_open(run)->s;
    v_where(run, "param_count");
    t.to = v_sink(run);
    t.told = t.s->plugin->param_count(t.s->plugin);
    t.all.count = t.told < RULE_MAX_PARAMS ? t.told : RULE_MAX_PARAMS;
    for (uint32_t i = 0; i < t.all.count; i++) {
        t.all.info[i] = (sv_param_info){.size = sizeof t.all.info[i]};
        v_where(run, "param_info(%u)", i);
        const sv_status status = t.s->plugin->param_info(t.s->plugin, i, &t.all.info[i]);
        V_EXPECT(run, status == SV_OK, "param_info(%u): %s, and param_count is %u", i, v_status(status),
                 t.told);
    }
    return &t;
}

/* A check that is a judge of the whole table. */
#define JUDGED(name, ...)                                                                                    \
    void check_##name(v_run *run) {                                                                          \
        const table *t = read_table(run);                                                                    \
        rule_##name(&t->to, &t->all __VA_ARGS__);                                                            \
    }
JUDGED(param_ids, , t->told)
JUDGED(param_strings, )
JUDGED(param_ranges, )
JUDGED(param_dependencies, )
JUDGED(param_flags, , t->s->descriptor)

/* param_info of a struct of another size: the size as of 1.0 is needed, and nothing behind it is written. */
static void try_sizes(v_subject *s) {
    struct {
        sv_param_info info;
        uint8_t behind[64];
    } room;
    const uint32_t sizes[] = {0, 4, sizeof(sv_param_info) - 1};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        memset(&room, 0x5a, sizeof room);
        room.info.size = sizes[i];
        v_where(s->run, "param_info into %u bytes", sizes[i]);
        const sv_status status = s->plugin->param_info(s->plugin, 0, &room.info);
        V_EXPECT(s->run, status == SV_ERR_SIZE, "param_info into %u bytes: %s, expected SV_ERR_SIZE",
                 sizes[i], v_status(status));
    }
    memset(&room, 0x5a, sizeof room);
    room.info.size = sizeof room.info;
    v_where(s->run, "param_info");
    (void)s->plugin->param_info(s->plugin, 0, &room.info);
    for (size_t i = 0; i < sizeof room.behind; i++)
        V_EXPECT(s->run, room.behind[i] == 0x5a, "param_info writes behind the %u bytes of its struct",
                 (unsigned)sizeof room.info);
    room.info.size = sizeof room;
    v_where(s->run, "param_info into a struct of a later minor");
    const sv_status status = s->plugin->param_info(s->plugin, 0, &room.info);
    V_EXPECT(s->run, status == SV_OK, "%s: %s", s->run->report->where, v_status(status));
}

void check_param_info_calls(v_run *run) {
    v_subject *s = &v_rig_open(run)->s;
    const uint32_t count = s->plugin->param_count(s->plugin);
    const uint32_t beyond[] = {count, count + 1, UINT32_MAX};
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond && count < UINT32_MAX - 1; i++) {
        sv_param_info info = {.size = sizeof info};
        v_where(run, "param_info(%u)", beyond[i]);
        const sv_status status = s->plugin->param_info(s->plugin, beyond[i], &info);
        V_EXPECT(run, status < 0, "param_info(%u): %s, and param_count is %u", beyond[i], v_status(status),
                 count);
    }
    if (count == 0) v_skip(run, "the plugin has no parameters");
    try_sizes(s);
    v_where(run, "param_info with out NULL");
    V_EXPECT(run, s->plugin->param_info(s->plugin, 0, NULL) == SV_ERR_ARGUMENT,
             "param_info with out NULL is not SV_ERR_ARGUMENT");
}
