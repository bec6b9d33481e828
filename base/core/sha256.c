/* SPDX-License-Identifier: MIT */
#include "core/sha256.h"

#include "core/input_file.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 64, ROUNDS = 64, WORDS = 8, LENGTH_AT = 56, READ_AT_ONCE = BLOCK * 512 };

/* The first 32 bits of the fractional parts of the cube roots of the first 64 primes. */
static const uint32_t constants[ROUNDS] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

/* Of the square roots of the first 8 primes. */
static const uint32_t start[WORDS] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};

static uint32_t turned(uint32_t x, unsigned by) {
    return x >> by | x << (32u - by);
}

static void schedule(const uint8_t block[BLOCK], uint32_t w[ROUNDS]) {
    for (int i = 0; i < 16; i++) {
        const uint8_t *b = block + (ptrdiff_t)4 * i;
        w[i] = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
    }
    for (int i = 16; i < ROUNDS; i++) {
        const uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + (turned(a, 7) ^ turned(a, 18) ^ a >> 3) + w[i - 7] +
               (turned(b, 17) ^ turned(b, 19) ^ b >> 10);
    }
}

static void take_block(uint32_t state[WORDS], const uint8_t block[BLOCK]) {
    uint32_t w[ROUNDS], s[WORDS];
    schedule(block, w);
    memcpy(s, state, sizeof s);
    for (int i = 0; i < ROUNDS; i++) {
        const uint32_t e = s[4], a = s[0];
        const uint32_t first = s[7] + (turned(e, 6) ^ turned(e, 11) ^ turned(e, 25)) +
                               ((e & s[5]) ^ (~e & s[6])) + constants[i] + w[i];
        const uint32_t second =
            (turned(a, 2) ^ turned(a, 13) ^ turned(a, 22)) + ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
        memmove(s + 1, s, 7 * sizeof *s);
        s[4] += first;
        s[0] = first + second;
    }
    for (int i = 0; i < WORDS; i++) state[i] += s[i];
}

/* The last bytes, a one, zeros, and the length in bits: one block or two. */
static void finish(uint32_t state[WORDS], const uint8_t *rest, size_t bytes, uint64_t total) {
    uint8_t last[2 * BLOCK] = {0};
    const size_t size = bytes < LENGTH_AT ? BLOCK : 2 * BLOCK;
    if (bytes > 0) memcpy(last, rest, bytes);
    last[bytes] = 0x80;
    for (unsigned i = 0; i < 8; i++) last[size - 1 - i] = (uint8_t)(total * 8u >> 8u * i);
    for (size_t at = 0; at < size; at += BLOCK) take_block(state, last + at);
}

bool hs_sha256_file(const char *path, char text[HS_SHA256_TEXT], hs_error *err) {
    uint64_t bytes = 0, at = 0;
    uint32_t state[WORDS];
    uint8_t data[READ_AT_ONCE];
    size_t count = 0;
    const char *why = NULL;
    FILE *file = hs_input_open(path, path, &bytes, err);
    if (!file) return false;
    memcpy(state, start, sizeof state);
    while (!why && at < bytes) { /* only the last read is no whole number of blocks */
        count = bytes - at < READ_AT_ONCE ? (size_t)(bytes - at) : READ_AT_ONCE;
        why = hs_input_read_at(file, &at, data, count);
        for (size_t i = 0; !why && i + BLOCK <= count; i += BLOCK) take_block(state, data + i);
    }
    (void)fclose(file);
    if (why) return hs_fail(err, HS_ERR_INPUT, "%s: %s", path, why);
    finish(state, data + (count - count % BLOCK), count % BLOCK, bytes);
    for (int i = 0; i < WORDS; i++) (void)snprintf(text + (ptrdiff_t)8 * i, 9, "%08x", (unsigned)state[i]);
    return true;
}
