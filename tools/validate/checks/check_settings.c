/* SPDX-License-Identifier: MIT */
/* Other checks try the plugin as it is by default. This one tries every method that it has, briefly: what a
 * parameter of activate chooses may be another program. */
#include "validate/checks/check_settings.h"

#include "validate/drive/drive_frame.h"
#include "validate/drive/drive_params.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_VALUES = 64 };

static v_params params;

/* All values, or the ends and the middle where they are many. */
static uint32_t choose_values(const sv_param_info *p, double out[MOST_VALUES]) {
    const uint32_t values = v_param_values(p);
    if (values > 0 && values <= MOST_VALUES && p->type != SV_PARAM_INT) {
        for (uint32_t n = 0; n < values; n++) out[n] = p->min_value + n * p->step;
        return values;
    }
    const uint32_t half = values / 2;
    out[0] = p->min_value;
    out[1] = values > 0 ? p->min_value + (values - 1) * p->step : p->max_value;
    out[2] = values > 0 ? p->min_value + half * p->step : 0.5 * (p->min_value + p->max_value);
    return values > 0 && values < 3 ? values : 3;
}

static void look_at_map(v_run *run, const v_map *map, uint32_t slices, const char *what) {
    for (uint32_t i = 0; i < map->width * map->height; i++)
        V_EXPECT(run, fabsf(map->depth[i]) <= 2.0f * (float)slices,
                 "%s: the depth of ray (%u, %u) is %g in a volume of %u slices", what, i % map->width,
                 i / map->width, (double)map->depth[i], slices);
    V_EXPECT(run, map->outcome == SV_OK || map->outcome == SV_PARTIAL || map->outcome == SV_NO_SURFACE,
             "%s: the outcome is %s", what, v_status(map->outcome));
    V_EXPECT(run, map->stats.rays == map->width * map->height && map->stats.unfilled <= map->stats.rays,
             "%s: the statistics say %u of %u rays are without a surface", what, map->stats.unfilled,
             map->stats.rays);
}

static void try_setting(v_rig *r, const sv_param_info *p, double value) {
    v_run *run = r->s.run;
    v_way way = v_standard_way(&r->s);
    char what[120];
    v_map first, map;
    (void)snprintf(what, sizeof what, "%s = %g", p->key, value);
    way.fixed[0] = (sv_param_value){p->id, 0, value};
    way.fixed_count = 1;
    v_rig_again(r, &way);
    v_frame(&r->s, r->s.plugin, &r->stage, NULL, 0, &first);
    look_at_map(run, &first, way.slices, what);
    for (int turn = 0; turn < 2; turn++) {
        static const char *const ways[] = {"the same frame again",
                                           "other slabs, padding bytes of 255 and results with a pitch"};
        if (turn == 1) {
            way.hatch = 255;
            way.longest = 3;
            way.pitch = 3;
            v_rig_again(r, &way);
        }
        v_frame(&r->s, r->s.plugin, &r->stage, NULL, 0, &map);
        v_map_expect(run, &first, &map, "%s: %s give another map", what, ways[turn]);
        const char *place = v_stage_trespass(&r->stage, V_POISON);
        V_EXPECT(run, !place, "%s: end writes %s", what, place);
    }
    v_map_free(&first);
}

void check_every_setting(v_run *run) {
    v_rig r;
    uint32_t tried = 0;
    v_rig_standard(run, &r);
    v_params_read(&r.s, &params);
    for (uint32_t i = 0; i < params.count; i++) {
        double values[MOST_VALUES];
        if (!(params.info[i].flags & SV_PARAM_REACTIVATE)) continue;
        const uint32_t count = choose_values(&params.info[i], values);
        for (uint32_t n = 0; n < count; n++) {
            if (values[n] == params.info[i].default_value) continue; /* the other checks try that */
            try_setting(&r, &params.info[i], values[n]);
            tried++;
        }
    }
    if (tried == 0) v_skip(run, "no parameter needs a new activation");
    v_note(run, "%u values, in two ways each", tried);
    v_rig_close(&r);
}
