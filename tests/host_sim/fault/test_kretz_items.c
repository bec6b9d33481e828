/* SPDX-License-Identifier: MIT */
/*
 * Kretz files that are wrong as a stream of items, whatever the items say: cut, too long, swapped, of another
 * format, with too many items; and large ones. Beside each stands the file that just does not break the rule.
 * Run under ASan.
 */
#include "support/kretz_files.h"
#include "volume/kretz_parts.h"

#include <sys/stat.h>
#include <unistd.h>

/* Bytes behind the end are not read; without the item that ends the stream they are an item's. */
static void what_follows_the_end_is_not_read(void **state) {
    for (int ended = 0; ended < 2; ended++) {
        size_t bytes;
        kretz_plan plan = kretz_good();
        plan.no_end = ended == 0;
        uint8_t *file = kretz_bytes_of(&plan, &bytes), *more = unit_memory(bytes + 5);
        memcpy(more, file, bytes);
        files_write("more.vol", NULL, more, bytes + 5);
        if (ended) {
            kretz_volume("more.vol", NULL);
        } else {
            kretz_refused("more.vol", "5 bytes are left, an item's header needs 8");
        }
    }
}

/* The good file, cut after every one of its bytes. What ends behind the voxels is whole. */
static void every_cut_is_noticed(void **state) {
    size_t bytes;
    const kretz_plan plan = kretz_good();
    uint8_t *file = kretz_bytes_of(&plan, &bytes);
    for (size_t n = 0; n < bytes; n++) {
        files_write("cut.vol", NULL, file, n);
        if (n == bytes - 8) {
            kretz_volume("cut.vol", NULL);
        } else {
            kretz_refused("cut.vol", n < 16 ? "the first 16 bytes" : "");
        }
    }
}

static void lengths_beyond_the_file_are_refused(void **state) {
    static const uint32_t lengths_to_try[] = {0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 25, 33};
    size_t bytes;
    const kretz_plan plan = kretz_good();
    uint8_t *file = kretz_bytes_of(&plan, &bytes);
    const size_t at = bytes - 8 - KRETZ_VOXELS - 4; /* the length of the voxels */
    for (size_t i = 0; i < sizeof lengths_to_try / sizeof lengths_to_try[0]; i++) {
        for (int b = 0; b < 4; b++) file[at + (size_t)b] = (uint8_t)(lengths_to_try[i] >> 8 * b);
        files_write("long.vol", NULL, file, bytes);
        kretz_refused("long.vol", lengths_to_try[i] == 25 ? "are left, an item's header needs 8"
                                                          : "item (D000,0001) has");
    }
}

static void swapped_numbers_are_named(void **state) {
    kretz_plan plan = kretz_good();
    *kretz_find(&plan, 0xC000, 1) = (kretz_item){0x00C0, 0x0100, KRETZ_U16, 1, {0x0400}, NULL};
    kretz_file("swapped.vol", &plan);
    kretz_refused("swapped.vol", "item (00C0,0100): its bytes are swapped");
    plan = kretz_good();
    kretz_add(&plan, (kretz_item){0x00C0, 0x0001, KRETZ_U16, 1, {0x0400}, NULL}); /* just another item */
    kretz_file("swapped.vol", &plan);
    kretz_volume("swapped.vol", NULL);
}

static void other_files_are_named(void **state) {
    files_write("m.vol", "KRETZFILE 1.1   and more", NULL, 0);
    kretz_refused("m.vol", "the first 16 bytes are not 'KRETZFILE 1.0'");
    files_write("m.vol", "KRETZFILE 1.0  ", NULL, 0);
    kretz_refused("m.vol", "the first 16 bytes");
    kretz_refused("missing.vol", "No such file");
    assert_int_equal(mkfifo(files_path("pipe.vol"), 0600), 0);
    kretz_refused("pipe.vol", "not a regular file");
}

static void items_are_counted(void **state) {
    const size_t maximum = HS_KRETZ_MAX_ITEMS;
    for (int extra = 0; extra < 2; extra++) {
        size_t bytes;
        kretz_plan plan = kretz_good();
        plan.no_end = true;
        uint8_t *good = kretz_bytes_of(&plan, &bytes);
        const size_t items = maximum - plan.count + (size_t)extra;
        uint8_t *file = unit_memory(bytes + 8 * items);
        memcpy(file, good, bytes);
        files_write("many.vol", NULL, file, bytes + 8 * items);
        if (extra) {
            kretz_refused("many.vol", "more than 65536 items");
        } else {
            kretz_volume("many.vol", NULL);
        }
    }
}

/* Voxels behind 4 GB, in a file with a hole: offsets have 64 bits. */
static void large_files_are_read(void **state) {
    size_t bytes;
    kretz_plan plan = kretz_good();
    uint8_t *file = kretz_bytes_of(&plan, &bytes);
    const uint8_t head[8] = {0x11, 0x47, 0x15, 0x08, 0xF0, 0xFF, 0xFF, 0xFF}; /* an unknown item of 4 GB */
    const uint64_t hole = UINT64_C(0xFFFFFFF0);
    FILE *f = fopen(files_path("large.vol"), "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(file, 1, 16, f), 16);
    assert_int_equal(fwrite(head, 1, 8, f), 8);
    assert_int_equal(fseeko(f, (off_t)hole, SEEK_CUR), 0);
    assert_int_equal(fwrite(file + 16, 1, bytes - 16, f), bytes - 16);
    assert_int_equal(fclose(f), 0);
    hs_volume v = kretz_volume("large.vol", NULL);
    assert_int_equal(v.beams->voxels[KRETZ_VOXELS - 1], KRETZ_VOXELS);
    assert_int_equal(unlink(files_path("large.vol")), 0);
}

/* A file that becomes shorter between opening and reading. */
static void a_shrinking_file_is_an_error(void **state) {
    const kretz_plan plan = kretz_good();
    kretz_file("shrinks.vol", &plan);
    hs_error err = {0};
    hs_volume v = {0};
    hs_kretz *kretz = hs_kretz_open(files_path("shrinks.vol"), NULL, &err);
    assert_non_null(kretz);
    assert_int_equal(truncate(files_path("shrinks.vol"), 100), 0);
    assert_false(hs_kretz_read(kretz, 0, &v, &err));
    unit_told(err, HS_ERR_INPUT, "it became shorter");
    assert_null(v.voxels);
    hs_kretz_close(kretz);
}

UNIT_MAIN(files_setup, files_teardown, what_follows_the_end_is_not_read, every_cut_is_noticed,
          lengths_beyond_the_file_are_refused, swapped_numbers_are_named, other_files_are_named,
          items_are_counted, large_files_are_read, a_shrinking_file_is_an_error)
