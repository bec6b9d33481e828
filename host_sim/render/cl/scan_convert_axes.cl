/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion from the halved volume along its axes, as a camera sees that looks straight from the probe:
 * what neighbouring samples share is computed once. The bytes are those of convert_halved's packets
 * (scan_convert_halved.cl), for it is the same arithmetic in the same order: along x, along y, then along z.
 */
#define WEIGHT_BITS 8     /* of a position between two voxels: a sample's weights add up to 1 << 8 */
#define BLOCK       LANES /* edge of what a work item of convert_halved makes; the host's (scan_convert.c) */

#if LANES == 16
#define LANE_BYTES convert_char16(LANE_INDEX)
#define AXES_SPAN  32 /* voxels of a row that so many samples may lie between */

/* Positions along an axis: between voxel `at` and the next one, in parts of 1 << WEIGHT_BITS. */
typedef struct {
    int start, step, bits;
} steps;

/* Returns where sample i lies, rounded to the nearest part of a voxel. */
INLINE int parts_to(steps s, int i) {
    return (s.start + i * s.step + (1 << (s.bits - WEIGHT_BITS - 1))) >> (s.bits - WEIGHT_BITS);
}

INLINE int voxel_before(steps s, int i) {
    return parts_to(s, i) >> WEIGHT_BITS;
}

INLINE int part_behind(steps s, int i) {
    return parts_to(s, i) & ((1 << WEIGHT_BITS) - 1);
}

/* A block of samples of which all lie between voxels. */
typedef struct {
    __global const uchar *halved;
    int4 dims;
    steps x, y, z;
    int width, height;        /* samples that are wanted */
    ushort16 index, fraction; /* along x; the index counts from the first sample's voxel */
} axes_block;

/* 16 samples along x: means times 1 << WEIGHT_BITS, the least of the voxels that they lie between, and the
 * bits that any of these have. */
typedef struct {
    ushort16 mean;
    uchar16 least, any;
} line16;

/* Picks 16 voxels and their neighbours out of AXES_SPAN. */
INLINE void pick_voxels(__global const uchar *from, ushort16 index, ushort16 *first, ushort16 *second) {
#if defined(__AVX512BW__) && defined(__clang__)
    /* one instruction, which clang does not find */
    typedef uchar bytes32 __attribute__((ext_vector_type(32)));
    typedef ushort words32 __attribute__((ext_vector_type(32)));
    typedef short shorts32 __attribute__((vector_size(64)));
    typedef struct __attribute__((packed)) {
        bytes32 v;
    } unaligned32;
    words32 words = __builtin_convertvector(((__global const unaligned32 *)from)->v, words32), both;
    ((ushort16 *)&both)[0] = index;
    ((ushort16 *)&both)[1] = index + (ushort)1;
    const shorts32 picked =
        __builtin_ia32_permvarhi512(__builtin_astype(words, shorts32), __builtin_astype(both, shorts32));
    *first = ((const ushort16 *)&picked)[0];
    *second = ((const ushort16 *)&picked)[1];
#else
    for (int i = 0; i < LANES; i++) {
        const ushort at = ((const ushort *)&index)[i];
        ((ushort *)first)[i] = from[at];
        ((ushort *)second)[i] = from[at + 1];
    }
#endif
}

INLINE line16 line_at(const axes_block *b, int y, int z) {
    long total = (long)b->dims.x * b->dims.y * b->dims.z;
    long wanted = ((long)z * b->dims.y + y) * b->dims.x + voxel_before(b->x, 0);
    long from = min(wanted, total - AXES_SPAN); /* not beyond the last voxel */
    ushort16 index = min(b->index + (ushort)(wanted - from), (ushort16)(AXES_SPAN - 2)), first, second;
    pick_voxels(b->halved + from, index, &first, &second);
    return (line16){(first << (ushort)WEIGHT_BITS) + (second - first) * b->fraction,
                    convert_uchar16(min(first, second)), convert_uchar16(first | second)};
}

/* Lines of a slice of the halved volume, mixed along y. */
typedef struct {
    int z; /* -1: none */
    line16 line[BLOCK];
} plane16;

INLINE uint16 mix_words(ushort16 first, ushort16 second, int part) {
    uint16 a = convert_uint16(first), b = convert_uint16(second);
    return ((a << WEIGHT_BITS) + (b - a) * (uint)part + (1u << (WEIGHT_BITS - 1))) >> WEIGHT_BITS;
}

INLINE void fill_plane(const axes_block *b, int z, plane16 *p) {
    int last = -1;
    line16 upper, lower;
    if (p->z == z) return;
    p->z = z;
    for (int i = 0; i < b->height; i++) {
        int y = voxel_before(b->y, i);
        if (y != last) {
            upper = last >= 0 && y == last + 1 ? lower : line_at(b, y, z);
            lower = line_at(b, y + 1, z);
            last = y;
        }
        p->line[i] = (line16){convert_ushort16(mix_words(upper.mean, lower.mean, part_behind(b->y, i))),
                              min(upper.least, lower.least), upper.any | lower.any};
    }
}

/* Returns the packets of a row of them that have a lane set, a bit each. */
INLINE uint packets_of(uchar16 lanes) {
    uint4 four = as_uint4(lanes);
    ulong2 all = as_ulong2(lanes);
    if ((all.x | all.y) == 0) return 0;
    return (uint)(four.x != 0) | (uint)(four.y != 0) << 1 | (uint)(four.z != 0) << 2 |
           (uint)(four.w != 0) << 3;
}

/* Makes the voxels of a slice of the block, `to`: its first row. Returns the packets, a bit each and four in
 * a row, in which some voxel lies at an edge of what was scanned. */
INLINE uint convert_axes(const axes_block *b, int slice, plane16 planes[2], __global uchar *to,
                         int row_pitch) {
    int z = voxel_before(b->z, slice), part = part_behind(b->z, slice);
    uint edges = 0;
    plane16 *near = planes + z % 2, *far = planes + (z + 1) % 2;
    fill_plane(b, z, near);
    fill_plane(b, z + 1, far);
    for (int i = 0; i < b->height; i++, to += row_pitch) {
        uint16 sum = mix_words(near->line[i].mean, far->line[i].mean, part);
        uchar16 least = min(near->line[i].least, far->line[i].least),
                any = near->line[i].any | far->line[i].any;
        uchar16 whole = as_uchar16(least >= (uchar16)(HALVED_MIN));
        uchar16 unsure =
            ~whole & as_uchar16(any != (uchar16)(0)) & as_uchar16(LANE_BYTES < (char16)((char)b->width));
        uchar16 bytes = convert_uchar16((sum + (1u << (WEIGHT_BITS - 1))) >> WEIGHT_BITS) & whole;
        edges |= packets_of(unsure) << (i / PACKET_H * (BLOCK / PACKET_W));
        if (b->width == BLOCK) {
            store_bytes(bytes, to);
            continue;
        }
        for (int x = 0; x < b->width; x++) to[x] = ((const uchar *)&bytes)[x];
    }
    return edges;
}
#endif
