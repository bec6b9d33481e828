/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_levels.h"

#include <stdlib.h>
#include <string.h>

/* Sums over `reach` neighbours to either side along one axis: `blocks` times `count` values that lie `stride`
 * apart. */
static void sum_along(const uint32_t *from, uint32_t *to, size_t blocks, size_t count, size_t stride,
                      size_t reach) {
    for (size_t block = 0; block < blocks; block++, from += count * stride, to += count * stride)
        for (size_t i = 0; i < stride; i++) {
            uint32_t sum = 0;
            for (size_t at = 0; at < reach && at < count; at++) sum += from[at * stride + i];
            for (size_t at = 0; at < count; at++) {
                if (at + reach < count) sum += from[(at + reach) * stride + i];
                if (at > reach) sum -= from[(at - reach - 1) * stride + i];
                to[at * stride + i] = sum;
            }
        }
}

bool sv_wall_means(const sv_wall_volume *v, const sv_wall_layout *l, uint8_t *means) {
    const size_t plane = (size_t)l->width * l->height, all = plane * l->slices;
    uint32_t *a = calloc(all, sizeof *a), *b = calloc(all, sizeof *b);
    const bool done = a && b;
    if (done) {
        for (size_t i = 0; i < plane; i++)
            for (size_t z = sv_wall_first(v, i); z < sv_wall_end(v, i); z++)
                a[z * plane + i] = v->voxels[z * plane + i];
        sum_along(a, b, (size_t)l->height * l->slices, l->width, 1, l->mean[0]);
        sum_along(b, a, l->slices, l->height, l->width, l->mean[1]);
        sum_along(a, b, 1, l->slices, plane, l->mean[2]);
        const uint32_t box = (2 * l->mean[0] + 1) * (2 * l->mean[1] + 1) * (2 * l->mean[2] + 1);
        for (size_t i = 0; i < all; i++) means[i] = (uint8_t)((b[i] + box / 2) / box);
    }
    free(a);
    free(b);
    return done;
}

static void largest_along(const uint8_t *from, uint8_t *to, size_t blocks, size_t count, size_t stride,
                          size_t reach) {
    for (size_t block = 0; block < blocks; block++, from += count * stride)
        for (size_t at = 0; at < count; at++)
            for (size_t i = 0; i < stride; i++) {
                uint8_t most = 0;
                for (size_t k = at < reach ? 0 : at - reach; k <= at + reach && k < count; k++)
                    if (from[k * stride + i] > most) most = from[k * stride + i];
                *to++ = most;
            }
}

bool sv_wall_brightest(const sv_wall_layout *l, uint8_t *means) {
    uint8_t *rows = calloc((size_t)l->width * l->height, l->slices);
    if (!rows) return false;
    largest_along(means, rows, (size_t)l->height * l->slices, l->width, 1, l->beside[0]);
    largest_along(rows, means, l->slices, l->height, l->width, l->beside[1]);
    free(rows);
    return true;
}

/* The slices [first, end) at which the box around the ray was scanned all over. Beyond the image nothing was.
 */
static void box_range(const sv_wall_volume *v, const sv_wall_layout *l, uint32_t x, uint32_t y,
                      uint32_t *first, uint32_t *end) {
    const uint32_t rx = l->mean[0], ry = l->mean[1];
    *first = *end = 0;
    if (x < rx || y < ry || x + rx >= l->width || y + ry >= l->height) return;
    *end = l->slices;
    for (uint32_t j = y - ry; j <= y + ry; j++)
        for (uint32_t i = x - rx; i <= x + rx; i++) {
            const size_t pixel = (size_t)j * l->width + i;
            if (sv_wall_first(v, pixel) > *first) *first = sv_wall_first(v, pixel);
            if (sv_wall_end(v, pixel) < *end) *end = sv_wall_end(v, pixel);
        }
    *first += l->mean[2];
}

void sv_wall_histogram(const sv_wall_volume *v, const sv_wall_layout *l, const uint8_t *means,
                       uint64_t histogram[256]) {
    const size_t plane = (size_t)l->width * l->height;
    memset(histogram, 0, 256 * sizeof *histogram);
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            uint32_t first, end;
            box_range(v, l, x, y, &first, &end);
            for (size_t z = first; z + l->mean[2] < end; z++)
                histogram[means[z * plane + (size_t)y * l->width + x]]++;
        }
}

/* Lowest smoothed count between the modes of the two classes, and the lower mode. */
static void find_valley(const uint64_t histogram[256], sv_wall_levels *out) {
    uint64_t counts[256], smooth[256];
    memcpy(counts, histogram, sizeof counts);
    for (int turn = 0; turn < 2; turn++) {
        for (int i = 0; i < 256; i++) {
            smooth[i] = 0;
            for (int k = i - SV_WALL_SMOOTH; k <= i + SV_WALL_SMOOTH; k++)
                smooth[i] += counts[k < 0 ? -k - 1 : k > 255 ? 511 - k : k];
        }
        memcpy(counts, smooth, sizeof counts);
    }
    uint32_t dark = 0, bright = out->threshold + 1;
    for (uint32_t i = 0; i <= out->threshold; i++)
        if (smooth[i] > smooth[dark]) dark = i;
    for (uint32_t i = out->threshold + 1; i < 256; i++)
        if (smooth[i] > smooth[bright]) bright = i;
    const uint64_t mode = smooth[dark] < smooth[bright] ? smooth[dark] : smooth[bright];
    uint64_t least = mode;
    for (uint32_t i = dark; i <= bright; i++)
        if (smooth[i] < least) least = smooth[i];
    if (mode == 0) return;
    out->least = least;
    out->mode = mode;
    out->valley = (double)least / (double)mode;
}

sv_wall_levels sv_wall_levels_of(const uint64_t histogram[256]) {
    uint32_t tables[SV_WALL_TABLE_WORDS];
    const uint32_t *root = tables + SV_WALL_ROOTS;
    uint64_t all = 0, total = 0, split = 0;
    sv_wall_tables(tables);
    for (int i = 0; i < 256; i++) {
        all += histogram[i];
        total += histogram[i] * root[i];
    }
    sv_wall_levels out = {.least = 1, .mode = 1, .valley = 1.0};
    if (all == 0) return out;
    uint64_t next = total / all;
    for (int turn = 0; turn < SV_WALL_TURNS && next != split; turn++) {
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
    find_valley(histogram, &out);
    return out;
}

sv_wall_outcome sv_wall_outcome_of(const sv_wall_layout *l, const sv_wall_levels *levels) {
    if (!levels->two) return SV_WALL_EMPTY;
    return levels->least * SV_WALL_PER_MILLE > levels->mode * l->valley ? SV_WALL_NO_FLUID : SV_WALL_SURFACE;
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
