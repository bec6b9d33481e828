/* SPDX-License-Identifier: MIT */
/*
 * What all kernels of the host share. The files are compiled as one source, in the order of their names.
 *
 * A work item handles a packet of LANES neighbouring rays (or voxels) with vector types. On a CPU 16 lanes
 * make the arithmetic wide and share the control flow; on a GPU, whose lanes are the work items themselves, a
 * packet is one ray. The same text serves both: vf is a packet of floats, vi of ints.
 */
#pragma OPENCL FP_CONTRACT OFF

#ifndef LANES
#define LANES 1 /* 16 on CPU devices, else 1 */
#endif
#ifndef BRICK_SHIFT
#define BRICK_SHIFT 3 /* log2 of the brick edge; the host's BRICK_EDGE (device_volume.c) */
#endif

/* clang splits 16 lanes in two on some CPUs unless told that they are meant. */
#if LANES == 16 && defined(__has_attribute)
#if __has_attribute(min_vector_width)
#define WIDE __attribute__((min_vector_width(512)))
#endif
#endif
#ifndef WIDE
#define WIDE
#endif

/* Packets are large: handing them to a function by memory costs more than its work. */
#ifdef SVA_QUICK /* not optimised (smartvis/author_programs.h): each function is compiled once */
#define INLINE static
#else
#define INLINE static inline __attribute__((always_inline))
#endif

#if LANES == 16
typedef float16 vf;
typedef int16 vi;
#define PACKET_W 4 /* rays of a packet: 4 x 4 pixels stay closer together than 16 x 1 */
#define PACKET_H 4
#define TO_VF(v) convert_float16(v)
#define TO_VI(v) convert_int16(v)
/* A comparison of vectors gives -1, one of scalars 1; as masks both must be -1. */
#define MASK(condition) (condition)
#define LANE_X          ((float16)(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3))
#define LANE_Y          ((float16)(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3))
#define STORE(v, p)     store_lanes(v, p)
#define LOAD(p)         load_lanes(p)
#else
typedef float vf;
typedef int vi;
#define PACKET_W        1
#define PACKET_H        1
#define TO_VF(v)        convert_float(v)
#define TO_VI(v)        convert_int(v)
#define MASK(condition) (-(int)(condition))
#define LANE_X          0.0f
#define LANE_Y          0.0f
#define STORE(v, p)     (*(p) = (v))
#define LOAD(p)         (*(p))
#endif

#if LANES == 16
/* Loads and stores of 16 lanes in one piece, wherever they lie: PoCL takes them piece by piece. */
#define LANES_OF(type)                                                                                       \
    typedef struct __attribute__((packed)) {                                                                 \
        type##16 lanes;                                                                                      \
    } packed_##type;                                                                                         \
    INLINE __attribute__((overloadable)) void store_lanes(type##16 v, type *p) {                             \
        ((packed_##type *)p)->lanes = v;                                                                     \
    }                                                                                                        \
    INLINE __attribute__((overloadable)) type##16 load_lanes(const type *p) {                                \
        return ((const packed_##type *)p)->lanes;                                                            \
    }
LANES_OF(uchar)
LANES_OF(ushort)
LANES_OF(int)
LANES_OF(uint)
LANES_OF(float)
INLINE __attribute__((overloadable)) uchar16 load_lanes(__global const uchar *p) {
    return ((__global const packed_uchar *)p)->lanes;
}
INLINE void store_bytes(uchar16 v, __global uchar *p) {
    ((__global packed_uchar *)p)->lanes = v;
}
#endif

/* Asks for the byte `ahead` bytes behind p, which need not exist: the processor's own prefetcher ends with
 * every page. */
#define HAS_PREFETCH 0
#if LANES == 16 && defined(__has_builtin)
#if __has_builtin(__builtin_prefetch)
#undef HAS_PREFETCH
#define HAS_PREFETCH 1
#endif
#endif
INLINE void fetch_ahead(__global const uchar *p, size_t ahead) {
#if HAS_PREFETCH
    __builtin_prefetch((const void *)((size_t)p + ahead));
#endif
}

#define MAX_PACKETS 4 /* whose samples are made together */

/* Smallest and largest lane of a vector. */
#if LANES == 16
INLINE float lanes_min(vf v) {
    float8 a = min(v.lo, v.hi);
    float4 b = min(a.lo, a.hi);
    float2 c = min(b.lo, b.hi);
    return min(c.x, c.y);
}
INLINE float lanes_max(vf v) {
    float8 a = max(v.lo, v.hi);
    float4 b = max(a.lo, a.hi);
    float2 c = max(b.lo, b.hi);
    return max(c.x, c.y);
}
#else
INLINE float lanes_min(vf v) {
    return v;
}
INLINE float lanes_max(vf v) {
    return v;
}
#endif

/* Whether all lanes of a mask are set. */
INLINE bool all_lanes(vi mask) {
#if LANES == 16
    int8 a = mask.lo & mask.hi;
    int4 b = a.lo & a.hi;
    int2 c = b.lo & b.hi;
    return (c.x & c.y) != 0;
#else
    return mask != 0;
#endif
}

/* (sum + count / 2) / count in integers, exact whatever the device's float division. */
INLINE vi rounded_mean(vi sum, vi count) {
    vi a = 2 * sum + count, b = 2 * count;
    vi q = TO_VI(TO_VF(a) / TO_VF(b));
    q -= select((vi)(0), (vi)(1), MASK(q * b > a));
    q += select((vi)(0), (vi)(1), MASK(a - q * b >= b));
    return q;
}
