/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

/* The sine of an angle, SV_WALL_SINE_BITS, linear between the entries of its table. */
static int64_t sine(const uint32_t *tables, int32_t angle) {
    const uint32_t size = (uint32_t)(angle < 0 ? -angle : angle);
    const uint32_t part = (1u << SV_WALL_ANGLE_BITS) / SV_WALL_SINE_STEPS;
    const uint32_t *at = tables + SV_WALL_SINES + size / part;
    const int64_t value = at[0] + (int64_t)(at[1] - at[0]) * (size % part) / part;
    return angle < 0 ? -value : value;
}

static int64_t cosine(const uint32_t *tables, int32_t angle) {
    return sine(tables, (1 << SV_WALL_ANGLE_BITS) - (angle < 0 ? -angle : angle));
}

static int32_t angle_of(uint32_t i, uint32_t count, int32_t step) {
    return (2 * (int32_t)i + 1 - (int32_t)count) * step / 2;
}

/* A beam: sample k lies at from + k * step along every axis. Samples before the first one would lie behind
 * the sweep's axis. */
typedef struct {
    int64_t from[3], step[3];
    uint32_t first;
} beam;

static beam beam_of(const sv_wall_grid *g, const uint32_t *tables, uint32_t line, uint32_t plane) {
    const int32_t th = angle_of(line, g->lines, g->line_angle),
                  ph = angle_of(plane, g->planes, g->plane_angle);
    const int64_t across = sine(tables, th), along = cosine(tables, th);
    const int64_t side = sine(tables, ph), ahead = cosine(tables, ph);
    const int to_position = SV_WALL_VECTOR_BITS + SV_WALL_MM_BITS - SV_WALL_POSITION_BITS;
    beam b = {.first = 0};
    for (int a = 0; a < 3; a++) {
        const int64_t plane_way = (g->y[a] * side + g->z[a] * ahead) >> SV_WALL_SINE_BITS;
        const int64_t way = (g->x[a] * across + plane_way * along) >> SV_WALL_SINE_BITS;
        b.from[a] = g->axis[a] + ((way * g->first - plane_way * g->sweep) >> to_position);
        b.step[a] = (way * g->step) >> to_position;
    }
    while (b.first < g->samples &&
           (((int64_t)g->first + (int64_t)b.first * g->step) * along >> SV_WALL_SINE_BITS) <= g->sweep)
        b.first++;
    return b;
}

/* Where sample k of a beam lies along an axis of `count` blocks: the nearer one of the two blocks around it,
 * the other one, and the weight of that. */
typedef struct {
    size_t nearer, other;
    uint32_t weight; /* of SV_WALL_PART_ONE, at most half of that */
} between;

/* False: it does not lie in the volume. */
static bool find_blocks(int64_t at, uint32_t count, between *out) {
    const int64_t one = 1 << SV_WALL_POSITION_BITS, last = (count - 1) * one;
    if (at < -one / 2 || at >= last + one / 2) return false;
    const int64_t inside = at < 0      ? 0
                           : at < last ? at
                                       : last - 1; /* the outermost block reaches to its side */
    const size_t low = (size_t)(inside >> SV_WALL_POSITION_BITS);
    const uint32_t part = (uint32_t)(inside % one) * SV_WALL_PART_ONE >> SV_WALL_POSITION_BITS;
    const bool up = part >= SV_WALL_PART_ONE / 2;
    *out = (between){low + up, low + !up, up ? SV_WALL_PART_ONE - part : part};
    return true;
}

/* The level at sample k of a beam, linear between the eight blocks around it and rounded half up; 0 if the
 * nearest was not scanned. Another one that was not counts as the nearest. Black was not scanned. */
static uint8_t level_at(const sv_wall_blocks *camera, const beam *b, uint32_t k) {
    const uint32_t sides[3] = {camera->columns, camera->rows, camera->layers};
    between at[3];
    uint32_t sum = 0, nearest = 0;
    for (int a = 0; a < 3; a++)
        if (!find_blocks(b->from[a] + k * b->step[a], sides[a], &at[a])) return 0;
    for (uint32_t i = 0; i < 8; i++) {
        size_t block = 0;
        uint32_t weight = 1;
        for (int a = 2; a >= 0; a--) {
            const bool other = i >> a & 1;
            block = block * sides[a] + (other ? at[a].other : at[a].nearer);
            weight *= other ? at[a].weight : SV_WALL_PART_ONE - at[a].weight;
        }
        const uint32_t level = camera->levels[block];
        if (i == 0) nearest = level;
        sum += weight * (level > 0 ? level : nearest);
    }
    const uint32_t one = SV_WALL_PART_ONE * SV_WALL_PART_ONE * SV_WALL_PART_ONE;
    return nearest > 0 ? (uint8_t)((sum + one / 2) / one) : 0;
}

/* A beam was scanned from its first block that is not black to its last. */
bool sv_wall_gather(const sv_wall_blocks *camera, const sv_wall_grid *g, const sv_wall_layout *l,
                    sv_wall_blocks *out) {
    const size_t plane = (size_t)l->columns * l->rows;
    uint32_t tables[SV_WALL_TABLE_WORDS];
    sv_wall_tables(tables);
    if (!sv_wall_blocks_allocate(l, out)) return false;
    for (uint32_t ray = 0; ray < plane; ray++) {
        const beam b = beam_of(g, tables, ray % l->columns, ray / l->columns);
        for (uint32_t k = b.first; k < l->layers; k++) {
            const uint8_t level = level_at(camera, &b, k);
            out->means[k * plane + ray] = out->levels[k * plane + ray] = level;
            if (level == 0) continue;
            if (out->end[ray] == 0) out->first[ray] = (uint16_t)k;
            out->end[ray] = (uint16_t)(k + 1);
        }
        out->rays += out->end[ray] > 0;
    }
    return true;
}

/* The blocks first .. end - 1 of `count` that lie near a position along an axis. */
static void find_near(int64_t at, int32_t near, uint32_t count, uint32_t *first, uint32_t *end) {
    const int64_t low = at - near, high = at + near, one = 1 << SV_WALL_POSITION_BITS;
    *first = low <= 0 ? 0 : (uint32_t)((low + one - 1) >> SV_WALL_POSITION_BITS);
    *end = high < 0 ? 0 : (uint32_t)(high >> SV_WALL_POSITION_BITS) + 1;
    if (*end > count) *end = count;
}

static void mark_sample(const sv_wall_grid *g, const sv_wall_layout *camera, const beam *b, uint32_t k,
                        uint8_t *cells) {
    const uint32_t sides[3] = {camera->columns, camera->rows, camera->layers};
    uint32_t first[3], end[3];
    for (int a = 0; a < 3; a++)
        find_near(b->from[a] + k * b->step[a], g->near[a], sides[a], &first[a], &end[a]);
    for (uint32_t z = first[2]; z < end[2]; z++)
        for (uint32_t y = first[1]; y < end[1]; y++)
            for (uint32_t x = first[0]; x < end[0]; x++)
                cells[((size_t)z * camera->cells[1] + y / 2) * camera->cells[0] + x / 2] |= SV_WALL_FLOATS;
}

void sv_wall_mark_cells(const sv_wall_told *told, const uint8_t *samples, const sv_wall_layout *camera,
                        uint8_t *cells) {
    const sv_wall_layout *l = told->layout;
    const size_t plane = (size_t)l->columns * l->rows;
    uint32_t tables[SV_WALL_TABLE_WORDS];
    sv_wall_tables(tables);
    for (uint32_t ray = 0; ray < plane; ray++) {
        const beam b = beam_of(told->grid, tables, ray % l->columns, ray / l->columns);
        for (uint32_t k = b.first; k < l->layers; k++)
            if (samples[k * plane + ray]) mark_sample(told->grid, camera, &b, k, cells);
    }
}
