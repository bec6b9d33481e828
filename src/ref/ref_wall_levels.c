/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <string.h>

/* True if a ray is no farther from the middle of the image than the other ray of its cell. */
static bool is_inner(uint32_t ray, uint32_t rays) {
    return ray < rays / 2 ? ray % 2 == 1 || ray + 1 == rays / 2 : ray % 2 == 0 || ray == rays / 2;
}

void sv_wall_histogram(const sv_wall_blocks *b, uint64_t histogram[256]) {
    const size_t plane = (size_t)b->columns * b->rows;
    memset(histogram, 0, 256 * sizeof *histogram);
    for (uint32_t y = 0; y < b->rows; y++)
        for (uint32_t x = 0; x < b->columns; x++) {
            const size_t ray = (size_t)y * b->columns + x;
            if (!is_inner(x, b->columns) || !is_inner(y, b->rows)) continue;
            for (size_t z = b->first[ray]; z < b->end[ray]; z++) histogram[b->levels[z * plane + ray]]++;
        }
}

sv_wall_levels sv_wall_levels_of(const sv_wall_layout *l, const uint64_t histogram[256]) {
    uint32_t tables[SV_WALL_TABLE_WORDS];
    const uint32_t *root = tables + SV_WALL_ROOTS;
    uint64_t all = 0, total = 0, split = 0;
    sv_wall_tables(tables);
    for (int i = 0; i < 256; i++) {
        all += histogram[i];
        total += histogram[i] * root[i];
    }
    sv_wall_levels out = {0};
    if (all == 0) return out;
    uint64_t next = total / all;
    for (int iteration = 0; iteration < SV_WALL_MAX_ITERATIONS && next != split; iteration++) {
        uint64_t count = 0, sum = 0;
        split = next;
        for (int i = 0; i < 256 && root[i] <= split; i++) {
            count += histogram[i];
            sum += histogram[i] * root[i];
        }
        if (count == 0 || count == all) return out;
        next = (sum / count + (total - sum) / (all - count)) / 2;
    }
    uint64_t count = 0, sum = 0;
    for (uint32_t i = 0; i < 256; i++) {
        if (root[i] <= split) out.threshold = i;
        if (root[i] > split) count += histogram[i];
        if (root[i] > split) sum += i * histogram[i];
    }
    out.two = count > 0 && count < all;
    if (!out.two) return out;
    out.bright = (uint32_t)(SV_WALL_LEVEL_ONE * sum / count);
    out.dark = sv_wall_quantile(histogram, l->dark_rank);
    if (out.dark < SV_WALL_LEVEL_ONE) out.dark = SV_WALL_LEVEL_ONE;
    out.fluid = (sv_wall_quantile(histogram, l->fluid_rank) + SV_WALL_LEVEL_ONE / 2) / SV_WALL_LEVEL_ONE;
    return out;
}

uint32_t sv_wall_quantile(const uint64_t histogram[256], uint32_t rank) {
    uint64_t all = 0, below = 0;
    for (int i = 0; i < 256; i++) all += histogram[i];
    const uint64_t wanted = all * rank; /* per mille */
    for (uint32_t i = 0; i < 256; i++) {
        const uint64_t upto = (below + histogram[i]) * SV_WALL_PER_MILLE;
        if (histogram[i] > 0 && upto >= wanted) {
            const uint64_t part =
                (wanted - below * SV_WALL_PER_MILLE) * SV_WALL_LEVEL_ONE / (histogram[i] * SV_WALL_PER_MILLE);
            const uint64_t level = (uint64_t)i * SV_WALL_LEVEL_ONE + part;
            return level > SV_WALL_LEVEL_ONE / 2 ? (uint32_t)level - SV_WALL_LEVEL_ONE / 2 : 0;
        }
        below += histogram[i];
    }
    return 255 * SV_WALL_LEVEL_ONE;
}
