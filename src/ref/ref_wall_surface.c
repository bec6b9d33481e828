/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Clamps an index to 0 .. count - 1. */
static size_t inside(int64_t at, size_t count) {
    return at < 0 ? 0 : at >= (int64_t)count ? count - 1 : (size_t)at;
}

/* Weighted sums along one axis. Beyond the border the cell at the border counts. */
static void blur_along(const uint32_t *from, uint32_t *to, size_t blocks, size_t count, size_t stride,
                       const uint32_t *weights, uint32_t reach) {
    for (size_t block = 0; block < blocks; block++, from += count * stride)
        for (size_t at = 0; at < count; at++)
            for (size_t i = 0; i < stride; i++) {
                uint32_t sum = weights[0] * from[at * stride + i];
                for (uint32_t k = 1; k <= reach; k++)
                    sum += weights[k] * (from[inside((int64_t)at - k, count) * stride + i] +
                                         from[inside((int64_t)at + k, count) * stride + i]);
                *to++ = sum;
            }
}

/* The lateral Gaussian, rounded half up at its end only: so the order of the axes does not matter. */
static void blur(const sv_wall_layout *l, uint32_t *costs, uint32_t *rows) {
    const size_t all = (size_t)l->cells[0] * l->cells[1] * l->layers;
    const uint32_t one = SV_WALL_KERNEL_ONE * SV_WALL_KERNEL_ONE / (SV_WALL_FINE_COST_ONE / SV_WALL_COST_ONE);
    blur_along(costs, rows, l->cells[1], l->cells[0], l->layers, l->kernel_x, l->reach_x);
    blur_along(rows, costs, 1, l->cells[1], (size_t)l->cells[0] * l->layers, l->kernel_y, l->reach_y);
    for (size_t i = 0; i < all; i++) costs[i] = (costs[i] + one / 2) / one;
}

/* Planes of rays: the surface and the ends of the range that the knob moves it in, which are filtered, and
 * what the surface costs. */
enum { NEAR, LAYER, FAR, FILTERED = SV_WALL_PLACES, COST = FILTERED, PLANES };

/* Returns how far behind `inside`, whose cost is below the limit, the cost crosses the limit, in layers. */
static float crossing(uint32_t inside, uint32_t outside, uint32_t limit) {
    return (float)(limit - inside) / (float)(outside - inside);
}

/* Finds the minimum of a ray; of several equal ones the nearest to the viewer. LAYER is the mean of the
 * layers around it whose cost is within `average_margin` of the minimum, weighting each by how far it is
 * below that limit. NEAR and FAR are the ends of the layers around it within `knob_margin`. */
static void find_minimum(const sv_wall_layout *l, const uint32_t *cost, float to[PLANES]) {
    const uint32_t layers = l->layers, margin = l->average_margin;
    uint32_t best = 0;
    for (uint32_t i = 1; i < layers; i++)
        if (cost[i] < cost[best]) best = i;
    const uint32_t limit = cost[best] + margin, edge = cost[best] + l->knob_margin;
    uint32_t weight = margin, sum = margin * best, near = best, far = best;
    for (uint32_t i = best; i > 0 && cost[i - 1] < limit; i--) {
        weight += limit - cost[i - 1];
        sum += (limit - cost[i - 1]) * (i - 1);
    }
    for (uint32_t i = best + 1; i < layers && cost[i] < limit; i++) {
        weight += limit - cost[i];
        sum += (limit - cost[i]) * i;
    }
    while (near > 0 && cost[near - 1] < edge) near--;
    while (far + 1 < layers && cost[far + 1] < edge) far++;
    const float place = weight ? (float)sum / (float)weight : (float)best;
    const float before = near > 0 ? crossing(cost[near], cost[near - 1], edge) : 0.0f;
    const float behind = far + 1 < layers ? crossing(cost[far], cost[far + 1], edge) : 0.0f;
    to[NEAR] = fminf((float)near - before, place);
    to[LAYER] = place;
    to[FAR] = fmaxf((float)far + behind, place);
    to[COST] = (float)cost[best] / SV_WALL_FINE_COST_ONE;
}

static int by_value(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The median of a ray and its eight neighbours. Beyond the border the ray at the border counts. */
static float median_of(const sv_wall_layout *l, const float *map, uint32_t x, uint32_t y) {
    const int64_t dx = l->median_step[0], dy = l->median_step[1];
    float values[9];
    for (int i = 0; i < 9; i++) {
        const size_t row = inside(y + (i / 3 - 1) * dy, l->rows);
        values[i] = map[row * l->columns + inside(x + (i % 3 - 1) * dx, l->columns)];
    }
    qsort(values, 9, sizeof *values, by_value);
    return values[4];
}

/* Two neighbouring rays and their weights. */
typedef struct {
    uint32_t low, high;
    float low_weight, high_weight;
} pair;

/* Returns the rays around pixel i. Beyond the outermost rays their value counts. Both weights are quotients
 * of integers, so that the mirrored pixel has the same ones. */
static pair between(uint32_t i, uint32_t pixels, uint32_t rays) {
    const int64_t at = (int64_t)(2 * (uint64_t)i + 1) * rays - pixels, width = 2 * (int64_t)pixels;
    if (at <= 0) return (pair){0, 0, 1.0f, 0.0f};
    const uint32_t ray = (uint32_t)(at / width);
    if (ray + 1 >= rays) return (pair){rays - 1, rays - 1, 1.0f, 0.0f};
    const int64_t rest = at % width;
    return (pair){ray, ray + 1, (float)(width - rest) / (float)width, (float)rest / (float)width};
}

/* Bilinear interpolation. The four products are added in an order that neither mirroring nor transposing
 * changes. */
static void interpolate(const sv_wall_layout *l, const float *rays, float scale, float *map) {
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            const pair u = between(x, l->width, l->columns), v = between(y, l->height, l->rows);
            const float *top = rays + (size_t)v.low * l->columns,
                        *bottom = rays + (size_t)v.high * l->columns;
            const float a = u.low_weight * v.low_weight * top[u.low],
                        b = u.high_weight * v.low_weight * top[u.high];
            const float c = u.low_weight * v.high_weight * bottom[u.low];
            const float d = u.high_weight * v.high_weight * bottom[u.high];
            *map++ = scale * ((a + d) + (b + c));
        }
}

/* Filters every plane by the median of a ray and its neighbours. */
static void median_filter(const sv_wall_layout *l, const float *layers, float *filtered) {
    const size_t count = (size_t)l->columns * l->rows;
    if (!l->median) memcpy(filtered, layers, FILTERED * count * sizeof *filtered);
    for (uint32_t plane = 0; l->median && plane < FILTERED; plane++)
        for (uint32_t y = 0; y < l->rows; y++)
            for (uint32_t x = 0; x < l->columns; x++)
                filtered[plane * count + (size_t)y * l->columns + x] =
                    median_of(l, layers + plane * count, x, y);
}

/* Computes the confidence of every ray's surface at `places`, which costs `costs`. */
static void find_confidence(const sv_wall_scan *s, const float *costs, const float *places, float *of_rays) {
    const sv_wall_layout *l = s->layout;
    const size_t count = (size_t)l->columns * l->rows;
    for (size_t ray = 0; ray < count; ray++) {
        const uint8_t level = s->blocks->relative[(size_t)places[ray] * count + ray];
        of_rays[ray] = sv_wall_confidence(l, costs[ray], (float)level / SV_WALL_TISSUE);
    }
}

static void find_own_fluid(const sv_wall_scan *s, const uint16_t *shown, const float *places, bool *own) {
    const size_t count = (size_t)s->layout->columns * s->layout->rows;
    for (size_t ray = 0; ray < count; ray++) own[ray] = sv_wall_has_fluid(s, ray, places[ray], shown[ray]);
}

/* Interpolates the confidence of rays to pixels. The four rounded weights of a pixel may add up to a little
 * more than 1. */
static void interpolate_confidence(const sv_wall_layout *l, const float *of_rays, float *confidence) {
    interpolate(l, of_rays, 1.0f, confidence);
    for (size_t i = 0; i < (size_t)l->width * l->height; i++) confidence[i] = fminf(confidence[i], 1.0f);
}

/* Moves a surface in tissue back to the front of that tissue, at most by `full_distance` layers: its
 * neighbours have drawn it out of the fluid. Tissue at the start of the scan has no fluid in front of it. */
static float back_to_fluid(const sv_wall_scan *s, size_t ray, float place) {
    const uint32_t at = (uint32_t)place, start = s->blocks->first[ray];
    if (!sv_wall_is_tissue(s, ray, at)) return place;
    for (uint32_t z = at; z > start && at - z < s->layout->full_distance; z--)
        if (!sv_wall_is_tissue(s, ray, z - 1)) return (float)z;
    return place;
}

/* Moves a surface that lies behind the front of its ray's fetus back to that, at most by twice
 * `full_distance`: its neighbours, which do not see it, have drawn it through. */
static float back_to_front(const sv_wall_layout *l, uint16_t front, float place) {
    const float behind = place - (float)front;
    return behind > 0.0f && behind <= (float)(2 * l->full_distance) ? (float)front : place;
}

/* Moves the surface in its range: to the far end at q = 0, to the near end at q = 1, linear to either side of
 * 0.5. In tissue it goes back to the fluid, and behind the front of the fetus back to that. */
static void apply_knob(const sv_wall_scan *scan, const uint16_t *fronts, float *filtered) {
    const sv_wall_layout *l = scan->layout;
    const size_t count = (size_t)l->columns * l->rows;
    const float part = fabsf(2.0f * l->q - 1.0f);
    const float *const end = filtered + (l->q < 0.5f ? FAR : NEAR) * count;
    float *const place = filtered + LAYER * count;
    for (size_t ray = 0; ray < count; ray++) {
        const float at = place[ray] + part * (end[ray] - place[ray]);
        place[ray] = back_to_front(l, fronts[ray], back_to_fluid(scan, ray, at > 0.0f ? at : 0.0f));
    }
}

/* Finds the minima of all rays in the smoothed costs of cells. False: no memory. */
static bool find_minima(const sv_wall_layout *l, const uint32_t *costs, float *layers) {
    const size_t count = (size_t)l->columns * l->rows;
    uint32_t *const ray = malloc(l->layers * sizeof *ray);
    if (!ray) return false;
    for (uint32_t y = 0; y < l->rows; y++)
        for (uint32_t x = 0; x < l->columns; x++) {
            float of_ray[PLANES];
            for (uint32_t z = 0; z < l->layers; z++) ray[z] = sv_wall_cost_at(l, costs, x, y, z);
            find_minimum(l, ray, of_ray);
            for (size_t plane = 0; plane < PLANES; plane++)
                layers[plane * count + (size_t)y * l->columns + x] = of_ray[plane];
        }
    free(ray);
    return true;
}

/* Takes the least value, or the largest, over `reach` rays to either side along one axis: `groups` lines of
 * `count` values that lie `stride` apart. */
static void extreme_along(const float *from, float *to, size_t groups, size_t count, size_t stride,
                          size_t reach, bool least) {
    for (size_t group = 0; group < groups; group++, from += count * stride)
        for (size_t at = 0; at < count; at++)
            for (size_t i = 0; i < stride; i++) {
                float value = from[at * stride + i];
                for (size_t k = at < reach ? 0 : at - reach; k <= at + reach && k < count; k++)
                    value = least ? fminf(value, from[k * stride + i]) : fmaxf(value, from[k * stride + i]);
                *to++ = value;
            }
}

/* Over a rectangle of rays, in place. `rows` has room for a map. */
static void extreme(const sv_wall_layout *l, const uint32_t reach[2], float *map, float *rows, bool least) {
    extreme_along(map, rows, l->rows, l->columns, 1, reach[0], least);
    extreme_along(rows, map, 1, l->rows, l->columns, reach[1], least);
}

/* Fills the pits of the surface that are narrower than `opening` to either side: its grey opening. In a pit
 * it has most likely left the fluid for the fetus. Rays that were not scanned do not count. `maps` has room
 * for two maps. */
static void fill_pits(const sv_wall_scan *s, bool doubtful, float *filtered, float *maps) {
    const sv_wall_layout *l = s->layout;
    const uint32_t *reach = l->opening[doubtful];
    const size_t count = (size_t)l->columns * l->rows;
    for (size_t plane = 0; plane < FILTERED; plane++) {
        float *const place = filtered + plane * count;
        for (size_t ray = 0; ray < count; ray++)
            maps[ray] = s->blocks->first[ray] < s->blocks->end[ray] ? place[ray] : (float)l->layers;
        extreme(l, reach, maps, maps + count, true);
        extreme(l, reach, maps, maps + count, false);
        for (size_t ray = 0; ray < count; ray++) place[ray] = fminf(place[ray], maps[ray]);
    }
}

/* Adds the blocks of a ray that are as dark as `fluid`. Its surface lies at `place`, before the knob. */
static void count_gap(const sv_wall_scan *s, uint32_t fluid, size_t ray, float place, sv_wall_gaps *gaps) {
    const size_t plane = (size_t)s->layout->columns * s->layout->rows;
    const uint32_t start = s->blocks->first[ray], end = s->blocks->end[ray];
    const uint32_t at = (uint32_t)(back_to_fluid(s, ray, place) + 0.5f);
    uint32_t fluid_dark = 0;
    gaps->rays++;
    gaps->open += !sv_wall_is_tissue(s, ray, start);
    bool holds = false, behind_tissue = false;
    for (uint32_t z = start; z < end; z++) {
        const bool dark = s->blocks->levels[z * plane + ray] <= fluid;
        gaps->dark += dark;
        if (sv_wall_is_tissue(s, ray, z)) {
            if (holds && behind_tissue) gaps->in_gaps += fluid_dark;
            fluid_dark = 0;
            holds = false;
            behind_tissue = behind_tissue || z - start >= s->layout->dim_front ||
                            s->blocks->relative[z * plane + ray] > SV_WALL_DIM_TISSUE;
        } else {
            fluid_dark += dark;
            holds = holds || z == at;
        }
    }
}

static void count_gaps(const sv_wall_scan *s, uint32_t fluid, const float *places, sv_wall_gaps *gaps) {
    *gaps = (sv_wall_gaps){0};
    for (size_t ray = 0; ray < (size_t)s->layout->columns * s->layout->rows; ray++)
        if (s->blocks->first[ray] < s->blocks->end[ray]) count_gap(s, fluid, ray, places[ray], gaps);
}

/* Moves a limit in favour of what was said of the frame before: that the share is above it, or below. */
static uint32_t limit_after(const sv_wall_layout *l, uint32_t limit, bool above, bool below) {
    if (above) return limit > l->hysteresis ? limit - l->hysteresis : 0;
    return below ? limit + l->hysteresis : limit;
}

uint32_t sv_wall_fetus_limit(const sv_wall_layout *l) {
    return limit_after(l, l->seen_share, l->last != SV_WALL_NO_FETUS && l->last != SV_WALL_EMPTY,
                       l->last == SV_WALL_NO_FETUS);
}

uint32_t sv_wall_gap_limit(const sv_wall_layout *l) {
    return limit_after(l, l->gap_share, l->last == SV_WALL_SURFACE,
                       l->last == SV_WALL_DOUBTFUL || l->last == SV_WALL_NO_FLUID || l->last == SV_WALL_OPEN);
}

/* True if enough rays show the fetus by its brightness. */
static bool is_seen(const sv_wall_scan *s, const sv_wall_costs *costs) {
    const uint64_t all = (uint64_t)s->blocks->rays * SV_WALL_PROBABILITY_ONE;
    return costs->fetus * SV_WALL_PER_MILLE >= all * sv_wall_fetus_limit(s->layout);
}

sv_wall_outcome sv_wall_verdict(const sv_wall_layout *l, const sv_wall_gaps *gaps, bool seen) {
    const uint64_t share = gaps->in_gaps * SV_WALL_PER_MILLE;
    const uint32_t clear =
        limit_after(l, l->clear_share, l->last == SV_WALL_SURFACE, l->last == SV_WALL_NO_FETUS);
    if (!seen && (gaps->dark == 0 || share < gaps->dark * clear)) return SV_WALL_NO_FETUS;
    const uint32_t doubtful =
        limit_after(l, l->doubtful_share, l->last == SV_WALL_SURFACE || l->last == SV_WALL_DOUBTFUL,
                    l->last == SV_WALL_NO_FLUID || l->last == SV_WALL_OPEN);
    if (gaps->dark == 0 || share < gaps->dark * doubtful)
        return gaps->open > 0 && 2 * gaps->open >= gaps->rays ? SV_WALL_OPEN : SV_WALL_NO_FLUID;
    return share < gaps->dark * sv_wall_gap_limit(l) ? SV_WALL_DOUBTFUL : SV_WALL_SURFACE;
}

/* The maps of a surface. `costs`: those `given`, smoothed. `filtered` and `layers` are the planes of rays;
 * `sure` has room for a number a ray. False: no memory. */
static bool finish(const sv_wall_scan *scan, const sv_wall_costs *given, const uint32_t *costs, bool doubtful,
                   float *filtered, float *layers, float *sure, float *depth, float *confidence) {
    const sv_wall_layout *l = scan->layout;
    const size_t count = (size_t)l->columns * l->rows;
    bool *const own = malloc(count * sizeof *own);
    if (!own) return false;
    find_confidence(scan, layers + COST * count, filtered + LAYER * count, sure);
    find_own_fluid(scan, given->shown, filtered + LAYER * count, own);
    /* of `layers`, only what the surface costs is still needed */
    fill_pits(scan, doubtful, filtered, layers);
    const bool done = sv_wall_go_on(scan, costs, layers + COST * count, own, filtered, sure);
    if (done) {
        apply_knob(scan, given->fronts, filtered);
        interpolate_confidence(l, sure, confidence);
        interpolate(l, filtered + LAYER * count, (float)l->depth, depth);
    }
    free(own);
    return done;
}

bool sv_wall_select_surface(const sv_wall_scan *scan, const sv_wall_levels *levels,
                            const sv_wall_costs *given, const sv_wall_outcome *told, float *depth,
                            float *confidence, sv_wall_gaps *gaps, sv_wall_outcome *outcome) {
    const sv_wall_layout *l = scan->layout;
    const size_t count = (size_t)l->columns * l->rows, all = (size_t)l->cells[0] * l->cells[1] * l->layers;
    uint32_t *costs = calloc(all, sizeof *costs), *rows = calloc(all, sizeof *rows);
    float *layers = calloc(PLANES * count, sizeof *layers),
          *filtered = calloc((FILTERED + 1) * count, sizeof *filtered);
    bool done = costs && rows && layers && filtered;
    if (done) {
        memcpy(costs, given->all, all * sizeof *costs);
        blur(l, costs, rows);
        done = find_minima(l, costs, layers);
    }
    if (done) {
        median_filter(l, layers, filtered);
        count_gaps(scan, levels->fluid, filtered + LAYER * count, gaps);
        *outcome = told ? *told : sv_wall_verdict(l, gaps, is_seen(scan, given));
        /* a person who asks for it gets a surface all the same */
        if (*outcome == SV_WALL_NO_FLUID && l->clip_doubtful) *outcome = SV_WALL_DOUBTFUL;
        done = finish(scan, given, costs, *outcome == SV_WALL_DOUBTFUL, filtered, layers,
                      filtered + FILTERED * count, depth, confidence);
    }
    free(costs);
    free(rows);
    free(layers);
    free(filtered);
    return done;
}
