/* SPDX-License-Identifier: MIT */
/* Counter-based random numbers: a value depends on its key and its counter only, so any thread may draw any
 * of them in any order (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011). */
#pragma once

#include <stdint.h>

/* A bijection of 64 bits with good avalanche: the finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA
 * 2014). */
static inline uint64_t hs_random_mix(uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* 64 random bits of counter `i` in the stream `key`. */
static inline uint64_t hs_random_bits(uint64_t key, uint64_t i) {
    return hs_random_mix(key + i * 0x9e3779b97f4a7c15u);
}

/* The key of an independent stream. */
static inline uint64_t hs_random_key(uint64_t seed, uint64_t stream) {
    return hs_random_mix(hs_random_mix(seed) ^ (stream * 0xd1342543de82ef95u));
}

/* Uniform in 0 .. 1, 1 excluded. */
static inline float hs_random_unit(uint64_t key, uint64_t i) {
    return (float)(hs_random_bits(key, i) >> 40) * 0x1p-24f;
}
