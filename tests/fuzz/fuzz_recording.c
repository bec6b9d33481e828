/* SPDX-License-Identifier: MIT */
/*
 * A recording of any bytes, read to its end; and one whose parts are whole and hold anything, played into a
 * plugin that reads all that it is promised (every_carrier.c). The input's first byte says which. What asks
 * for much is played in a child, as sv_replay plays it, and ends within its bounds. Parts are written as u8
 * type, u16 length and contents; the rest of a file is made here, for a fuzzer finds no checksums.
 */
#include "fuzz/fuzz_bytes.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/memory_file.h"
#include "replay/replay.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_FILE = 1 << 20, MAX_VOXELS = 1 << 16, MAX_TEXTURE = 1 << 22, MAX_PARTS = 200 };

/* Parts with their checksums. Returns the bytes of the file. */
static size_t make_file(fuzz_bytes *b, uint8_t *file) {
    static const rec_header header = REC_HEADER;
    size_t size = sizeof header;
    memcpy(file, &header, sizeof header);
    for (int n = 0; n < MAX_PARTS && b->left > 0; n++) {
        uint32_t head[2] = {fuzz_u8(b) % 7u, (uint32_t)fuzz_u8(b) | (uint32_t)fuzz_u8(b) << 8};
        if (head[1] > b->left) head[1] = (uint32_t)b->left;
        if (size + head[1] + 12 > MAX_FILE) break;
        memcpy(file + size, head, sizeof head);
        fuzz_take(b, file + size + 8, head[1]);
        const uint32_t sum = rec_sum(head[0], file + size + 8, head[1]);
        memcpy(file + size + 8 + head[1], &sum, sizeof sum);
        size += head[1] + 12u;
    }
    return size;
}

/* Reads all of it; true if what it asks for is small. */
static bool read_all(const char *path) {
    static rec_item item;
    char error[1500] = "";
    bool small = true;
    int there = -1;
    uint64_t sum = 0;
    rec_reader *r = rec_reader_open(path, error, sizeof error);
    while (r && (there = rec_reader_next(r, &item, error, sizeof error)) == 1) {
        const sv_format *f = &item.format;
        for (size_t i = 0; i < item.bytes; i++) sum += item.data[i];
        FUZZ_HOLDS(item.bytes == 0 || item.data);
        if (item.type != REC_CALL || item.kind != RC_ACTIVATE || !item.sound) continue;
        small = small && (uint64_t)f->width * f->height * (f->slices + 1u) <= MAX_VOXELS &&
                ((uint64_t)f->row_pitch + f->tiles_x * (uint64_t)f->tile_w) * f->tile_h * f->slices <=
                    MAX_TEXTURE;
    }
    FUZZ_HOLDS(there == 0 || error[0]);
    FUZZ_HOLDS(sum <= UINT64_MAX / 2);
    rec_reader_close(r);
    return small;
}

static int play(void *path) {
    rp_options o = {.file = path, .plugin = FUZZ_PLUGIN, .frame = RP_LAST, .out = "/nowhere", .seconds = 5};
    rp_report *report = calloc(1, sizeof *report);
    hs_error err = {0};
    if (!report) abort();
    /* The fuzzer counts what is executed in it, and reads that when it would be gone. */
    static void *kept;
    if (!kept) kept = dlopen(FUZZ_PLUGIN, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    FUZZ_HOLDS(kept);
    hs_guard_defaults(&o.guard);
    o.guard.choice = HS_GUARD_OFF;
    o.guard.memory_bytes = UINT64_C(256) << 20;
    if (!rp_play(&o, report, &err)) FUZZ_HOLDS(err.code != HS_OK && err.code != HS_ERR_PLUGIN && err.text[0]);
    rp_frame_free(&report->drawn);
    free(report);
    return 0;
}

/* In a minute and 2 GiB, as many as libFuzzer lets its own process have. */
static void play_in_child(char *path) {
    struct rusage used;
    int status = -1;
    const pid_t child = fork();
    if (child == 0) {
        (void)alarm(60);
        _exit(play(path));
    }
    FUZZ_HOLDS(child > 0 && wait4(child, &status, 0, &used) == child && status == 0);
    FUZZ_HOLDS(used.ru_maxrss < 2 << 20);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_bytes b = {data, size};
    memory_file file;
    if (fuzz_u8(&b) % 2) {
        uint8_t *bytes = malloc(MAX_FILE);
        if (!bytes) abort();
        memory_file_open(&file, bytes, make_file(&b, bytes));
        free(bytes);
        if (read_all(file.path))
            (void)play(file.path);
        else
            play_in_child(file.path);
    } else {
        memory_file_open(&file, b.at, b.left);
        (void)read_all(file.path);
    }
    memory_file_close(&file);
    return 0;
}
