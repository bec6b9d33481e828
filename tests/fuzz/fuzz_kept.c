/* SPDX-License-Identifier: MIT */
/*
 * Files of compiled kernels (smartvis/author_kept.h), which a runtime runs as they are. Bytes from anywhere
 * are taken only if they are a whole file of the key that is asked for; a good file that was changed in any
 * way never is.
 */
#include "fuzz/fuzz_bytes.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/memory_file.h"
#include "smartvis/author_kept.h"

static const char key[] = "a device\n-DOPTIONS";
enum { MOST = 4096, HEAD = sizeof(sva_kept_head) + sizeof key };

/* As sva_kept_read takes it: what is read is what was there, and no more. */
static size_t take(const uint8_t *data, size_t size, unsigned mode) {
    memory_file m;
    size_t bytes = 0, got = 0;
    memory_file_open(&m, data, size);
    (void)fchmod(m.file, mode);
    (void)lseek(m.file, 0, SEEK_SET);
    unsigned char *all = sva_kept_load(m.file, &got);
    memory_file_close(&m);
    FUZZ_HOLDS(!all == (size == 0 || (mode & 022) != 0));
    if (!all) return 0;
    FUZZ_HOLDS(got == size && memcmp(all, data, size) == 0);
    const size_t at = sva_kept_find(all, got, key, sizeof key, &bytes);
    FUZZ_HOLDS(at == 0 ? bytes == 0 : at == HEAD && bytes > 0 && at + bytes == size);
    FUZZ_HOLDS(at == 0 || memcmp(all + sizeof(sva_kept_head), key, sizeof key) == 0);
    free(all);
    return at;
}

/* A good file of bytes of the input; how many it has. */
static size_t make(fuzz_bytes *b, uint8_t file[MOST]) {
    const size_t bytes = 1 + fuzz_u32(b) % (MOST - HEAD);
    sva_kept_head head = {.magic = SVA_KEPT_MAGIC, .key_bytes = sizeof key, .bytes = bytes};
    fuzz_take(b, file + HEAD, bytes);
    head.sum = sva_kept_sum(SVA_KEPT_SUM, file + HEAD, bytes);
    memcpy(file, &head, sizeof head);
    memcpy(file + sizeof head, key, sizeof key);
    return HEAD + bytes;
}

/* Bytes are changed, and the file is cut or has more. */
static size_t change(fuzz_bytes *b, uint8_t file[MOST], size_t size) {
    for (unsigned n = fuzz_u8(b) % 8; n > 0; n--) file[fuzz_u32(b) % size] = fuzz_u8(b);
    const uint8_t how = fuzz_u8(b);
    return how < 128 ? size : how < 192 ? fuzz_u32(b) % size : size + fuzz_u32(b) % (MOST - size + 1);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static uint8_t good[MOST], bad[MOST];
    fuzz_bytes b = {data, size};
    const uint8_t what = fuzz_u8(&b);
    const unsigned mode = what & 2 ? 0600 : what & 0177;
    if (what & 1) {
        (void)take(b.at, b.left, mode);
        return 0;
    }
    const size_t bytes = make(&b, good);
    FUZZ_HOLDS(take(good, bytes, 0600) == HEAD);
    memcpy(bad, good, sizeof bad);
    const size_t left = change(&b, bad, bytes);
    if (left != bytes || memcmp(bad, good, bytes) != 0) FUZZ_HOLDS(take(bad, left, mode) == 0);
    return 0;
}
