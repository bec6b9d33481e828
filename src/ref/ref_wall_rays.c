/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_rays.h"

#include <stdlib.h>

/* Products and shares of probabilities and costs, rounded half up. */
static uint32_t share(uint32_t value, uint32_t probability) {
    return (uint32_t)(((uint64_t)value * probability + SV_WALL_SURE / 2) / SV_WALL_SURE);
}

bool sv_wall_ray_create(const sv_wall_layout *l, sv_wall_ray *ray) {
    const size_t n = (size_t)l->slices + 1;
    *ray = (sv_wall_ray){malloc(n), malloc(n * sizeof(uint32_t)), malloc(n * sizeof(uint32_t)),
                         malloc(n * sizeof(uint32_t))};
    if (ray->tissue && ray->begun && ray->later && ray->distance) return true;
    sv_wall_ray_destroy(ray);
    return false;
}

void sv_wall_ray_destroy(sv_wall_ray *ray) {
    free(ray->tissue);
    free(ray->begun);
    free(ray->later);
    free(ray->distance);
    *ray = (sv_wall_ray){0};
}

/* Front to back: the fetus begins where the brightest that a run has shown so far makes it likely, unless it
 * has begun. */
static void fetus_begins(const sv_wall_scan *s, size_t pixel, const sv_wall_run *first, sv_wall_ray *ray) {
    const size_t plane = (size_t)s->layout->width * s->layout->height;
    const uint32_t end = sv_wall_end(s->volume, pixel);
    uint32_t before = SV_WALL_SURE, now = SV_WALL_SURE; /* that it has not begun: before this run, so far */
    uint8_t most = 0;
    for (uint32_t z = 0; z < s->layout->slices; z++) {
        if (z >= sv_wall_first(s->volume, pixel) && z < end && ray->tissue[z]) {
            const uint8_t bright = s->bright[z * plane + pixel];
            const bool at_first = first->touches && z < first->end;
            if (bright > most) most = bright;
            now = before - share(before, (at_first ? s->evidence->first : s->evidence->other)[most]);
        } else {
            before = now;
            most = 0;
        }
        ray->begun[z] = SV_WALL_SURE - now;
    }
    ray->begun[s->layout->slices] = SV_WALL_SURE - now;
}

/* Back to front: what each stretch of fluid of at least a gap leaves to the run behind it, and how far the
 * fluid is. */
static void fluid_behind(const sv_wall_scan *s, size_t pixel, const sv_wall_run *first, sv_wall_ray *ray) {
    const sv_wall_layout *l = s->layout;
    const uint32_t start = sv_wall_first(s->volume, pixel), end = sv_wall_end(s->volume, pixel);
    for (uint32_t z = 0; z <= l->slices; z++) ray->later[z] = 0;
    for (uint32_t z = 0; z < l->slices; z++) ray->distance[z] = UINT32_MAX;
    for (uint32_t z = end; z > start;) {
        uint32_t run_end = z;
        while (z > start && ray->tissue[z - 1]) z--;
        const uint32_t run = z;
        while (z > start && !ray->tissue[z - 1]) z--;
        const bool open_front = z == start && first->begin == run;
        if (run - z < l->gap) continue;
        for (uint32_t i = open_front ? 0 : z; i < run; i++) ray->distance[i] = 0;
        if (z == start) continue;
        const uint32_t gained = ray->begun[run_end - 1] - ray->begun[run > 0 ? run - 1 : 0];
        for (uint32_t i = 0; run < run_end && i < z; i++) ray->later[i] += gained;
    }
    for (uint32_t z = 1; z < l->slices; z++)
        if (ray->distance[z - 1] != UINT32_MAX && ray->distance[z - 1] + 1 < ray->distance[z])
            ray->distance[z] = ray->distance[z - 1] + 1;
    for (uint32_t z = l->slices - 1; z > 0; z--)
        if (ray->distance[z] != UINT32_MAX && ray->distance[z] + 1 < ray->distance[z - 1])
            ray->distance[z - 1] = ray->distance[z] + 1;
}

/* The first stretch of fluid of at least a gap, [begin, end): where the surface belongs if no fetus is seen.
 * An open front, or no fluid at all, begins at 0. */
static void first_fluid(const sv_wall_scan *s, size_t pixel, const sv_wall_run *first, const sv_wall_ray *ray,
                        uint32_t *begin, uint32_t *end) {
    const uint32_t scan_end = sv_wall_end(s->volume, pixel);
    *begin = 0;
    *end = first->begin;
    if (!first->touches) return;
    for (uint32_t z = first->end; z < scan_end;) {
        const uint32_t from = z;
        while (z < scan_end && !ray->tissue[z]) z++;
        if (z - from >= s->layout->gap) {
            *begin = from;
            *end = z;
            return;
        }
        while (z < scan_end && ray->tissue[z]) z++;
    }
}

bool sv_wall_costs(const sv_wall_scan *s, size_t pixel, sv_wall_ray *ray, uint32_t *away, uint32_t *wrong) {
    const sv_wall_layout *l = s->layout;
    const uint32_t start = sv_wall_first(s->volume, pixel), end = sv_wall_end(s->volume, pixel);
    if (start == end) return false;
    sv_wall_tissue(s->volume, l, s->threshold, pixel, ray->tissue);
    sv_wall_run first;
    if (!sv_wall_first_run(s->volume, l, pixel, ray->tissue, &first))
        first = (sv_wall_run){.begin = end, .end = end, .touches = end - start < l->gap};
    fetus_begins(s, pixel, &first, ray);
    fluid_behind(s, pixel, &first, ray);
    uint32_t fluid_begin, fluid_end;
    first_fluid(s, pixel, &first, ray, &fluid_begin, &fluid_end);
    const uint32_t none = SV_WALL_SURE - ray->begun[l->slices];
    const uint32_t in_first = first.touches && first.end > first.begin ? ray->begun[first.end - 1] : 0;
    for (uint32_t i = 0; i < l->labels; i++) {
        const uint32_t z = i * l->step;
        const uint32_t far = ray->distance[z] < l->far ? ray->distance[z] : l->far;
        const uint32_t cost = (far * l->rate + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS;
        away[i] = cost < SV_WALL_ONE ? cost : SV_WALL_ONE;
        wrong[i] = share(l->cut, ray->begun[z]) + share(l->left, ray->later[z]);
        if (first.touches && z < first.end) {
            const uint32_t skin = z + l->skin < first.end ? z + l->skin : first.end - 1;
            wrong[i] += share(l->left, in_first - ray->begun[skin]);
        }
        if (z < fluid_begin || z >= fluid_end) wrong[i] += share(l->other, none);
    }
    return true;
}
