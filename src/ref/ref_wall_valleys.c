/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

/* The sum of the levels in layer z of a ray and of those around it; beyond the border there is nothing. */
static uint32_t sum_around(const sv_wall_blocks *b, size_t ray, uint32_t z) {
    const size_t x = ray % b->columns, y = ray / b->columns, reach = SV_WALL_VALLEY_REACH;
    uint32_t sum = 0;
    for (size_t row = y > reach ? y - reach : 0; row <= y + reach && row < b->rows; row++)
        for (size_t column = x > reach ? x - reach : 0; column <= x + reach && column < b->columns; column++)
            sum += b->levels[(z * (size_t)b->rows + row) * b->columns + column];
    return sum;
}

/* The largest of these sums in layers from .. to - 1, or 0. */
static uint32_t largest_sum(const sv_wall_blocks *b, size_t ray, uint32_t from, uint32_t to) {
    uint32_t largest = 0;
    for (uint32_t z = from; z < to; z++) {
        const uint32_t sum = sum_around(b, ray, z);
        if (sum > largest) largest = sum;
    }
    return largest;
}

void sv_wall_part_valleys(const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    for (size_t ray = 0; l->valley > 0 && ray < plane; ray++) {
        const uint32_t start = b->first[ray];
        uint32_t end = start;
        while (end < b->end[ray] && b->relative[end * plane + ray] > SV_WALL_TISSUE) end++;
        if (end == b->end[ray]) continue; /* no fluid follows */
        const uint32_t far = end > l->full_distance ? end - l->full_distance : 0;
        for (uint32_t z = far > start + l->skin ? far : start + l->skin; z < end; z++) {
            const uint32_t before = largest_sum(b, ray, start, z), behind = largest_sum(b, ray, z + 1, end);
            const uint32_t side = before < behind ? before : behind;
            if (sum_around(b, ray, z) * SV_WALL_VALLEY_ONE < side * l->valley)
                b->relative[z * plane + ray] = SV_WALL_TISSUE;
        }
    }
}
