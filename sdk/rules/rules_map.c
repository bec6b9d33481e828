/* SPDX-License-Identifier: MIT */
/* Judges of what came out of a frame. */
#include "rules/rules.h"

#include "smartvis/lookup.h"

#include <math.h>

void rule_depths(const rule_sink *to, const rule_map *map, const char *what) {
    const uint32_t rays = map->width * map->height;
    const float limit = 2.0f * (float)map->slices;
    uint32_t bad = 0;
    for (uint32_t i = 0; i < rays; i++) bad += !(fabsf(map->depth[i]) <= limit); /* a loop that is fast */
    for (uint32_t i = 0; i < rays && bad > 0; i++) {
        const float d = map->depth[i];
        RULE_EXPECT(to, RULE_depth_values, !isnan(d),
                    "%s: the depth of ray (%u, %u) is NaN, or was not written", what, i % map->width,
                    i / map->width);
        RULE_EXPECT(to, RULE_depth_values, fabsf(d) <= limit,
                    "%s: the depth of ray (%u, %u) is %g in a volume of %u slices", what, i % map->width,
                    i / map->width, (double)d, map->slices);
    }
}

static bool is_outcome(sv_status status) {
    return status == SV_OK || status == SV_NO_SURFACE || status == SV_PARTIAL;
}

/* Returns a status' name for texts. */
static const char *name_of(sv_status status) {
    const char *name = sv_lookup_status(status);
    return name ? name : "a status that nobody knows";
}

void rule_outcome(const rule_sink *to, const rule_map *map, const char *what) {
    const sv_stats *s = map->stats;
    uint32_t zeros = 0;
    RULE_EXPECT(to, RULE_frame_outcome, map->own_queue ? is_outcome(map->returned) : map->returned == SV_OK,
                "%s: end returns %s (%d), expected %s", what, name_of(map->returned), (int)map->returned,
                map->own_queue ? "an outcome" : "SV_OK, the outcome is in the statistics");
    if (!s) return;
    for (uint32_t i = 0; i < map->width * map->height; i++) zeros += map->depth[i] == 0.0f;
    RULE_EXPECT(to, RULE_frame_outcome, is_outcome(s->outcome),
                "%s: the outcome in the statistics is %s (%d)", what, name_of(s->outcome), (int)s->outcome);
    RULE_EXPECT(to, RULE_frame_outcome, !map->own_queue || s->outcome == map->returned,
                "%s: end returns %s, and the statistics say %s", what, name_of(map->returned),
                name_of(s->outcome));
    RULE_EXPECT(to, RULE_frame_outcome, s->outcome != SV_NO_SURFACE || zeros == map->width * map->height,
                "%s: the outcome is SV_NO_SURFACE, and the map is not all zeros", what);
    RULE_EXPECT(to, RULE_frame_outcome, s->outcome != SV_PARTIAL || zeros > 0,
                "%s: the outcome is SV_PARTIAL, and no depth is 0", what);
}

void rule_statistics(const rule_sink *to, const rule_map *map) {
    const sv_stats *s = map->stats;
    const uint32_t rays = map->width * map->height;
    RULE_EXPECT(to, RULE_frame_statistics, s->size == sizeof *s, "end changes stats.size to %u", s->size);
    RULE_EXPECT(to, RULE_frame_statistics, s->rays == rays, "stats.rays is %u, expected %u", s->rays, rays);
    RULE_EXPECT(to, RULE_frame_statistics, s->points <= rays, "stats.points is %u of %u rays", s->points,
                rays);
    RULE_EXPECT(to, RULE_frame_statistics, s->unfilled <= rays, "stats.unfilled is %u of %u rays",
                s->unfilled, rays);
    RULE_EXPECT(to, RULE_frame_statistics, s->outcome != SV_OK || s->unfilled == 0,
                "the outcome is SV_OK, and stats.unfilled is %u", s->unfilled);
    RULE_EXPECT(to, RULE_frame_statistics, s->outcome != SV_NO_SURFACE || s->unfilled == rays,
                "the outcome is SV_NO_SURFACE, and stats.unfilled is %u of %u", s->unfilled, rays);
    RULE_EXPECT(to, RULE_frame_statistics,
                s->outcome != SV_PARTIAL || (s->unfilled > 0 && s->unfilled < rays),
                "the outcome is SV_PARTIAL, and stats.unfilled is %u of %u", s->unfilled, rays);
    uint32_t marked = 0;
    if (!map->status) return;
    for (uint32_t i = 0; i < rays; i++) {
        RULE_EXPECT(to, RULE_frame_statistics, map->status[i] <= SV_POINT_EMPTY,
                    "the status of ray (%u, %u) is %u, or was not written", i % map->width, i / map->width,
                    map->status[i]);
        marked += map->status[i] != SV_POINT_NONE;
    }
    RULE_EXPECT(to, RULE_frame_statistics, s->points == 0 || s->points == marked,
                "stats.points is %u, and the status map marks %u rays", s->points, marked);
}

void rule_confidence(const rule_sink *to, const float *map, uint32_t width, uint32_t height,
                     const char *what) {
    for (uint32_t i = 0; i < width * height; i++)
        RULE_EXPECT(to, RULE_confidence, map[i] >= 0.0f && map[i] <= 1.0f,
                    "%s: the confidence of ray (%u, %u) is %.9g, expected 0 .. 1", what, i % width, i / width,
                    (double)map[i]);
}
