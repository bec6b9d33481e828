/*
 * Cost volume, along the rays: slices to bins while the slabs come, then the fluid level, and what every ray
 * came to.
 *
 * Bins lie as label, row, column (rows padded to 16), so that a vector is one label of 16 neighbouring rays.
 */
#ifndef SV_METHOD_COST_CLH
#include "method_cost.clh"
#endif

/* Sum and number of the scanned voxels of the bin under way, for 16 rays. */
typedef struct {
    ushort16 sum, count;
} bin_t;

static uchar16 bin_mean(const bin_t *b) {
    /* Exact: the quotient of two integers below 2^16 is never rounded up to a whole number. */
    const ushort16 least = max(b->count, (ushort16)(1));
    const float16 quotient = convert_float16(b->sum + b->count / (ushort)2) / convert_float16(least);
    const uchar16 mean = max(convert_uchar16(convert_int16(quotient)), (uchar16)(1));
    return select((uchar16)(0), mean, convert_char16(b->count != (ushort16)(0)));
}

/* 16 voxels from column x on; beyond the row's width they are `padding`. */
static uchar16 load_voxels(__global const uchar *row, uint x, uint width, uchar padding) {
    if (x + SV_LANES <= width) return vload16(0, row + x);
    uchar lanes[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) lanes[i] = x + i < width ? row[x + i] : padding;
    return vload16(0, lanes);
}

/* One work item per row of rays. `padding` above 255: every voxel was scanned. `partial`: sums, then counts,
 * of the bins that a slab left unfinished. */
__kernel void cost_bins(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint slices,
                        uint padding, cost_layout l, __global ushort *restrict partial,
                        __global uchar *restrict bins) {
    const uint y = (uint)get_global_id(0);
    const size_t plane = (size_t)l.padded_width * l.height;
    __global const uchar *texture = slab + slab_offset + (size_t)y * row_pitch;
    for (uint x = 0; x < l.padded_width; x += SV_LANES) {
        const size_t at = (size_t)y * l.padded_width + x;
        bin_t b = {(ushort16)(0), (ushort16)(0)};
        if (first_slice > 0) {
            b.sum = vload16(0, partial + at);
            b.count = vload16(0, partial + plane + at);
        }
        uint bin = first_slice * l.labels / slices;
        uint end = ((bin + 1) * slices + l.labels - 1) / l.labels; /* the first slice of the next bin */
        for (uint i = 0; i < slice_count; i++) {
            __global const uchar *row =
                texture + (size_t)(i / tiles_x) * tile_h * row_pitch + i % tiles_x * tile_w;
            const ushort16 v = convert_ushort16(load_voxels(row, x, l.width, (uchar)padding));
            const ushort16 scanned = as_ushort16(v != (ushort16)((ushort)padding));
            b.sum += v & scanned;
            b.count += scanned & (ushort16)(1);
            if (first_slice + i + 1 < end) continue;
            vstore16(bin_mean(&b), 0, bins + bin * plane + at);
            b.sum = b.count = (ushort16)(0);
            bin++;
            end = ((bin + 1) * slices + l.labels - 1) / l.labels;
        }
        vstore16(b.sum, 0, partial + at);
        vstore16(b.count, 0, partial + plane + at);
    }
}

/* One work item per row of cells: the histogram of the bins on its middle row. */
__kernel void cost_survey(cost_layout l, __global const uchar *restrict bins,
                          __global uint *restrict histograms) {
    const uint cell_row = (uint)get_global_id(0);
    const size_t plane = (size_t)l.padded_width * l.height;
    __global const uchar *row = bins + (size_t)middle_row(&l, cell_row) * l.padded_width;
    uint counts[256];
    for (uint i = 0; i < 256; i++) counts[i] = 0;
    for (uint bin = 0; bin < l.labels; bin++)
        for (uint x = 0; x < l.width; x++) counts[row[bin * plane + x]]++;
    for (uint i = 0; i < 256; i++) histograms[cell_row * 256 + i] = counts[i];
}

/* One work item: a quarter of the way from the mean of the dark class to that of the bright one. */
__kernel void cost_level(cost_layout l, __global const uint *restrict histograms,
                         __global uint *restrict info) {
    uint counts[256];
    ulong all = 0, total = 0;
    for (uint i = 0; i < 256; i++) {
        counts[i] = 0;
        for (uint row = 0; row < l.cells_y; row++) counts[i] += histograms[row * 256 + i];
        if (i == 0) continue;
        all += counts[i];
        total += (ulong)i * counts[i];
    }
    ulong split = all > 0 ? total / all : 0, dark = 0, bright = 0;
    for (uint turn = 0; turn < 32; turn++) {
        ulong count = 0, sum = 0;
        for (uint i = 1; i <= split; i++) {
            count += counts[i];
            sum += (ulong)i * counts[i];
        }
        dark = count > 0 ? sum / count : 0;
        bright = all > count ? (total - sum) / (all - count) : split;
        const ulong next = (dark + bright) / 2;
        if (next == split) break;
        split = next;
    }
    const uint level = (uint)(dark + (bright > dark ? (bright - dark) / 4 : 0));
    info[SV_COST_INFO_LEVEL] = max(level, 1u);
}

/* One work item per row of cells: what its rays came to, and the histogram of their maxima, whose first word
 * counts rays without one. `counts`: scanned rays and rays with a fluid interval, per row of cells. */
__kernel void cost_rays(cost_layout l, __global const uchar *restrict bins,
                        __global const uint *restrict info, __global uchar *restrict rays,
                        __global uint *restrict histograms, __global uint *restrict counts) {
    const uint cell_row = (uint)get_global_id(0);
    const size_t plane = (size_t)l.padded_width * l.height;
    const short16 level = (short16)((short)info[SV_COST_INFO_LEVEL]), labels = (short16)((short)l.labels);
    const uint y1 = min((cell_row + 1) * l.block, l.height);
    uint histogram[256];
    uint scanned_rays = 0, open_rays = 0;
    for (uint i = 0; i < 256; i++) histogram[i] = 0;
    for (size_t at = (size_t)cell_row * l.block * l.padded_width; at < (size_t)y1 * l.padded_width;
         at += SV_LANES) {
        short16 seen = (short16)(0), scanned = seen, run = seen, maximum = seen, first = labels,
                place = labels;
        for (uint bin = 0; bin < l.labels; bin++) {
            const short16 v = convert_short16(vload16(0, bins + bin * plane + at));
            const short16 some = v > (short16)(0), tissue = v > level;
            scanned |= some;
            seen |= tissue;
            run = (run + (short)1) & some & ~tissue & seen;
            const short16 opens = (run == (short16)((short)l.gap)) & (first == labels);
            first = select(first, (short16)((short)(bin + 1 - l.gap)), opens);
            const short16 larger = (first < labels) & tissue & (v > maximum);
            maximum = select(maximum, v, larger);
            place = select(place, (short16)((short)bin), larger);
        }
        vstore16(convert_uchar16(first), 0, rays + SV_COST_FIRST * plane + at);
        vstore16(convert_uchar16(maximum), 0, rays + SV_COST_MAXIMUM * plane + at);
        vstore16(convert_uchar16(place), 0, rays + SV_COST_PLACE * plane + at);
        vstore16(convert_uchar16(scanned & (short16)(1)), 0, rays + SV_COST_SCANNED * plane + at);
        const uint lanes = min((uint)SV_LANES, l.width - min(l.width, (uint)(at % l.padded_width)));
        for (uint i = 0; i < lanes; i++) {
            histogram[rays[SV_COST_MAXIMUM * plane + at + i]]++;
            scanned_rays += rays[SV_COST_SCANNED * plane + at + i];
            open_rays += rays[SV_COST_FIRST * plane + at + i] < l.labels;
        }
    }
    for (uint i = 0; i < 256; i++) histograms[cell_row * 256 + i] = histogram[i];
    counts[2 * cell_row] = scanned_rays;
    counts[2 * cell_row + 1] = open_rays;
}

/* One work item: bone confidence of a maximum by its rank, and whether the frame has a surface. */
__kernel void cost_ranks(cost_layout l, __global const uint *restrict histograms,
                         __global const uint *restrict counts, __global uint *restrict info,
                         __global float *restrict bone, __global uint *restrict record) {
    uint histogram[256];
    uint all = 0, below = 0, scanned = 0, open = 0;
    for (uint i = 0; i < 256; i++) {
        histogram[i] = 0;
        for (uint row = 0; row < l.cells_y; row++) histogram[i] += histograms[row * 256 + i];
        if (i > 0) all += histogram[i];
    }
    bone[0] = 0.0f;
    for (uint i = 1; i < 256; i++) {
        const float rank = ((float)below + 0.5f * (float)histogram[i]) / (float)max(all, 1u);
        bone[i] = min(rank / SV_COST_RANK, 1.0f);
        below += histogram[i];
    }
    for (uint row = 0; row < l.cells_y; row++) {
        scanned += counts[2 * row];
        open += counts[2 * row + 1];
    }
    const bool wanted = surface_wanted(record) && open > 0 && open * SV_COST_EVIDENCE >= scanned;
    info[SV_COST_INFO_RAYS] = scanned;
    info[SV_COST_INFO_OPEN] = open;
    info[SV_COST_INFO_WANTED] = wanted;
    record[SV_REC_PASSES] = wanted;
    record[SV_REC_UNFILLED] = wanted ? 0 : record[SV_REC_RAYS];
    record[SV_REC_OUTCOME] = wanted ? SV_OUTCOME_OK : SV_OUTCOME_NO_SURFACE;
}
