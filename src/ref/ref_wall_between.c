/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

/* The cell beside that of a ray, on the side where the ray lies; at the border the cell itself. */
static size_t cell_beside(uint32_t ray, uint32_t cells) {
    const uint32_t own = ray / 2;
    if (ray % 2) return own + 1 < cells ? own + 1 : own;
    return own > 0 ? own - 1 : own;
}

uint32_t sv_wall_cost_at(const sv_wall_layout *l, const uint32_t *costs, uint32_t x, uint32_t y, uint32_t z) {
    const size_t row = (size_t)l->cells[0] * l->layers, column = l->layers;
    const size_t own_x = x / 2 * column, beside_x = cell_beside(x, l->cells[0]) * column;
    const size_t own_y = y / 2 * row, beside_y = cell_beside(y, l->cells[1]) * row;
    const uint32_t own = costs[own_y + own_x + z], across = costs[own_y + beside_x + z];
    const uint32_t down = costs[beside_y + own_x + z], both = costs[beside_y + beside_x + z];
    return (9 * own + 3 * (across + down) + both + 8) / 16;
}

float sv_wall_confidence(const sv_wall_layout *l, float cost, float level) {
    const float ratio = (cost + level * level) / l->half_confidence_cost;
    return 1.0f / (1.0f + ratio * ratio);
}
