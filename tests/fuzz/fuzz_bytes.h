/* SPDX-License-Identifier: MIT */
/* An input taken piece by piece; behind its end everything is 0. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_bytes;

static inline void fuzz_take(fuzz_bytes *b, void *out, size_t size) {
    const size_t n = size < b->left ? size : b->left;
    memset(out, 0, size);
    memcpy(out, b->at, n);
    b->at += n;
    b->left -= n;
}

static inline uint8_t fuzz_u8(fuzz_bytes *b) {
    uint8_t value;
    fuzz_take(b, &value, sizeof value);
    return value;
}

static inline uint32_t fuzz_u32(fuzz_bytes *b) {
    uint32_t value;
    fuzz_take(b, &value, sizeof value);
    return value;
}

static inline uint64_t fuzz_u64(fuzz_bytes *b) {
    uint64_t value;
    fuzz_take(b, &value, sizeof value);
    return value;
}

static inline double fuzz_double(fuzz_bytes *b) {
    double value;
    fuzz_take(b, &value, sizeof value);
    return value;
}

/* Overwrites `count` words of 32 bits of a struct, each at a place and with a value from the input. */
static inline void fuzz_words(fuzz_bytes *b, void *object, size_t size, unsigned count) {
    for (unsigned i = 0; i < count; i++) {
        const size_t place = fuzz_u8(b) % (size / sizeof(uint32_t));
        const uint32_t value = fuzz_u32(b);
        memcpy((uint8_t *)object + place * sizeof value, &value, sizeof value);
    }
}
