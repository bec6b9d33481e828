/* SPDX-License-Identifier: MIT */
/*
 * Kretz files that are wrong, a row a rule of docs/kretz.md: each is refused with file, item and value.
 * Beside it stands, with nothing told, the file that just does not break the rule: it is read. Run under
 * ASan.
 */
#include "support/kretz_files.h"
#include "volume/kretz_items.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

typedef enum { END, DROP, SET, ADD } edit_kind;

/* What a row does to the good file. */
typedef struct {
    edit_kind kind;
    kretz_item item;
} edit;

typedef struct {
    const char *told; /* NULL: the file is good */
    edit edits[8];
} row;

#define ITEM(group, element, type, ...)                                                                      \
    { group, element, KRETZ_##type, sizeof((double[]){__VA_ARGS__}) / sizeof(double), {__VA_ARGS__}, NULL }
#define BYTES(group, element, count)                                                                         \
    { group, element, KRETZ_BYTES, count, {1}, NULL }
#define WITHOUT(group, element)                                                                              \
    {                                                                                                        \
        DROP, {                                                                                              \
            group, element, KRETZ_U16, 0, {0}, NULL                                                          \
        }                                                                                                    \
    }

static const row sizes[] = {
    {"(C000,0001) number of samples is missing", {WITHOUT(0xC000, 1)}},
    {"(C000,0002) number of lines is missing", {WITHOUT(0xC000, 2)}},
    {"(C000,0003) number of frames is missing", {WITHOUT(0xC000, 3)}},
    {"(C000,0001) number of samples is 0, expected 2 .. 2048", {{SET, ITEM(0xC000, 1, U16, 0)}}},
    {"number of samples is 1,", {{SET, ITEM(0xC000, 1, U16, 1)}, {SET, BYTES(0xD000, 1, 6)}}},
    {NULL, {{SET, ITEM(0xC000, 1, U16, 2)}, {SET, BYTES(0xD000, 1, 12)}}},
    {"number of samples is 2049,", {{SET, ITEM(0xC000, 1, U16, 2049)}, {SET, BYTES(0xD000, 1, 2049 * 6)}}},
    {NULL, {{SET, ITEM(0xC000, 1, U16, 2048)}, {SET, BYTES(0xD000, 1, 2048 * 6)}}},
    {"(C000,0001) number of samples is 65535,",
     {{SET, ITEM(0xC000, 1, U16, 65535)}, {SET, ITEM(0xC000, 2, U16, 65535)}}},
    {"2048 x 2048 x 2048 are 8589934592 voxels",
     {{SET, ITEM(0xC000, 1, U16, 2048)},
      {SET, ITEM(0xC000, 2, U16, 2048)},
      {SET, ITEM(0xC000, 3, U16, 2048)}}},
    {"(C000,0001) number of samples is given twice, as 4 and as 5", {{ADD, ITEM(0xC000, 1, U16, 5)}}},
    {NULL, {{ADD, ITEM(0xC000, 1, U16, 4)}}},
    {"(C000,0001) number of samples has 8 bytes, expected 2", {{SET, ITEM(0xC000, 1, F64, 4)}}},
    {"(C000,0003) number of frames has 4 bytes, expected 2", {{SET, ITEM(0xC000, 3, U32, 2)}}},
    {"(C000,0002) number of lines has 0 bytes, expected 2", {{SET, BYTES(0xC000, 2, 0)}}},
    {"(0001,0100) type has 2 bytes, expected 4", {{SET, ITEM(0x0001, 0x0100, U16, 16)}}},
    {NULL, {WITHOUT(0x0001, 0x0100)}},
};

static const row voxels[] = {
    {"(D000,0001) voxels have 23 bytes, expected 24 (4 x 3 x 2)", {{SET, BYTES(0xD000, 1, 23)}}},
    {"(D000,0001) voxels have 25 bytes, expected 24", {{SET, BYTES(0xD000, 1, 25)}}},
    {"(D000,0001) voxels have 0 bytes", {{SET, BYTES(0xD000, 1, 0)}}},
    {"(D000,0001) voxels are given twice", {{ADD, BYTES(0xD000, 1, 24)}}},
    {NULL, {{ADD, BYTES(0xD000, 0x0101, 24)}}},
    {"(D000,0001) voxels are missing", {WITHOUT(0xD000, 1)}},
    {"the file has Doppler only", {WITHOUT(0xD000, 1), {ADD, BYTES(0xD000, 0x0201, 24)}}},
    {"(0002,1000) compressed voxels are all there is", {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1000, 9)}}},
    {"(D000,0001) voxels are missing", {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1100, 9)}}},
    {NULL, {{ADD, BYTES(0x0002, 0x1000, 9)}}},
    {"(D600,0001) voxels of a sequence have 49 bytes", {{ADD, BYTES(0xD600, 1, 49)}}},
    {"voxels of a sequence have 0 bytes, expected 1 .. 65536 times 24", {{ADD, BYTES(0xD600, 1, 0)}}},
    {NULL, {{ADD, BYTES(0xD600, 1, 48)}}},
    {"(D600,0001) voxels of a sequence are given twice",
     {{ADD, BYTES(0xD600, 1, 48)}, {ADD, BYTES(0xD600, 1, 48)}}},
    {"have 1572888 bytes, expected 1 .. 65536 times 24", {{ADD, BYTES(0xD600, 1, 24 * 65537)}}},
    {NULL, {{ADD, BYTES(0xD600, 1, 24 * 65536)}}},
};

static const row tables[] = {
    {"(C300,0001) sweep angles are missing", {WITHOUT(0xC300, 1)}},
    {"(C300,0002) angles in the plane are missing", {WITHOUT(0xC300, 2)}},
    {"(C300,0002) angles in the plane are missing", {WITHOUT(0xC300, 1), WITHOUT(0xC300, 2)}},
    {"(C300,0001) sweep angles have 24 bytes, expected 16 (8 for each of 2 frames)",
     {{SET, ITEM(0xC300, 1, F64, 1.3, 1.5, 1.8)}}},
    {"(C300,0002) angles in the plane have 16 bytes, expected 24", {{SET, ITEM(0xC300, 2, F64, 1.3, 1.5)}}},
    {"(C300,0001) sweep angles have 15 bytes, expected 16", {{SET, BYTES(0xC300, 1, 15)}}},
    {"(C300,0001) sweep angles are given twice", {{ADD, ITEM(0xC300, 1, F64, 1.3, 1.8)}}},
    {"(C300,0002) angles in the plane: angle 1 is nan", {{SET, ITEM(0xC300, 2, F64, 1.2, NAN, 1.9)}}},
    {"(C300,0001) sweep angles: angle 0 is -inf", {{SET, ITEM(0xC300, 1, F64, -INFINITY, 1.9)}}},
    {"angle 1 is 1.2 after 1.2: they should ascend", {{SET, ITEM(0xC300, 2, F64, 1.2, 1.2, 1.9)}}},
    {"angle 2 is 1.9 after 2: they should ascend", {{SET, ITEM(0xC300, 2, F64, 1.2, 2.0, 1.9)}}},
    {"angle 1 is 2 after 1.9: they should descend", {{SET, ITEM(0xC300, 2, F64, 1.9, 2.0, 1.2)}}},
    {NULL, {{SET, ITEM(0xC300, 2, F64, 1.2, 1.2000001, 1.9)}}},
    {NULL, {{SET, ITEM(0xC300, 2, F64, 1.9, 1.3, 1.2)}}},
    {"(C300,0001) sweep angles span 0,", {{SET, ITEM(0xC300, 1, F64, 1.3, 1.3)}}},
    {"(C300,0001) sweep angles span 3.15,", {{SET, ITEM(0xC300, 1, F64, 0.0, 3.15)}}},
    {NULL, {{SET, ITEM(0xC300, 1, F64, 0.0, 3.14)}}},
    {"(C300,0001) sweep angles span 80, expected more than 0 and less than pi radians",
     {{SET, ITEM(0xC300, 1, F64, 50, 130)}}},
};

static const row lengths[] = {
    {"(C100,0001) radial pitch is missing", {WITHOUT(0xC100, 1)}},
    {"(C200,0001) start of the samples is missing", {WITHOUT(0xC200, 1)}},
    {"(C200,0002) place of the sweep's axis is missing", {WITHOUT(0xC200, 2)}},
    {"(C100,0001) radial pitch is nan mm", {{SET, ITEM(0xC100, 1, F64, NAN)}}},
    {"(C100,0001) radial pitch is inf mm", {{SET, ITEM(0xC100, 1, F64, INFINITY)}}},
    {"(C100,0001) radial pitch is 0 mm, expected 0.01 .. 5 mm", {{SET, ITEM(0xC100, 1, F64, 0)}}},
    {"(C100,0001) radial pitch is -0.5 mm", {{SET, ITEM(0xC100, 1, F64, -0.0005)}}},
    {"(C100,0001) radial pitch is 500 mm", {{SET, ITEM(0xC100, 1, F64, 0.5)}}},
    {"(C100,0001) radial pitch is 5.001 mm", {{SET, ITEM(0xC100, 1, F64, 0.005001)}}},
    {NULL, {{SET, ITEM(0xC100, 1, F64, 0.005)}}},
    {"(C100,0001) radial pitch is 0.00999 mm", {{SET, ITEM(0xC100, 1, F64, 0.00000999)}}},
    {NULL, {{SET, ITEM(0xC100, 1, F64, 0.0000101)}}},
    {"(C100,0001) radial pitch is given twice, as 0.0005 and as 0.0006",
     {{ADD, ITEM(0xC100, 1, F64, 0.0006)}}},
    {"(C100,0001) radial pitch has 4 bytes, expected 8", {{SET, ITEM(0xC100, 1, U32, 1)}}},
    {"(C200,0001) start of the samples is nan mm", {{SET, ITEM(0xC200, 1, F64, NAN)}}},
    {"(C200,0001) start of the samples is inf mm", {{SET, ITEM(0xC200, 1, F64, INFINITY)}}},
    {"(C200,0001) start of the samples is -0.05 mm", {{SET, ITEM(0xC200, 1, F64, -0.1)}}},
    {NULL, {{SET, ITEM(0xC200, 1, F64, 0)}}},
    {"(C200,0001) start of the samples is 1000.5 mm", {{SET, ITEM(0xC200, 1, F64, 2001)}}},
    {NULL, {{SET, ITEM(0xC200, 1, F64, 2000)}}},
    {"nan mm, expected -1000 .. 1000 mm", {{SET, ITEM(0xC200, 2, F64, NAN)}}},
    {"(C200,0002) place of the sweep's axis is -inf mm", {{SET, ITEM(0xC200, 2, F64, INFINITY)}}},
    {"(C200,0002) place of the sweep's axis is -1000.5 mm", {{SET, ITEM(0xC200, 2, F64, 2001)}}},
    /* On the outer lines, at 0.35 rad, the samples start at 10 cos(0.35) = 9.3937 mm. */
    {"(C200,0002) place of the sweep's axis is 9.4 mm, at or behind the samples' start at 9.393",
     {{SET, ITEM(0xC200, 2, F64, -18.8)}}},
    {NULL, {{SET, ITEM(0xC200, 2, F64, -18.78)}}},
    {"at or behind the samples' start at 0 mm",
     {{SET, ITEM(0xC200, 1, F64, 0)}, {SET, ITEM(0xC200, 2, F64, 0)}}},
};

#define CARTESIAN                                                                                            \
    WITHOUT(0xC200, 1), WITHOUT(0xC200, 2), WITHOUT(0xC300, 1), WITHOUT(0xC300, 2), {                        \
        SET, ITEM(0x0001, 0x0100, U32, 1)                                                                    \
    }

static const row cartesian[] = {
    {NULL, {CARTESIAN}},
    {"(C100,0001) radial pitch is missing", {CARTESIAN, WITHOUT(0xC100, 1)}},
    {NULL, {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 0.5)}}},
    {"(0010,0022) Cartesian spacing is 0.6 mm, but (C100,0001) says 0.5 mm",
     {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, 0.6)}}},
    {"(0010,0022) Cartesian spacing is nan mm", {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, NAN)}}},
    {"(0010,0022) Cartesian spacing is -1 mm",
     {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, -1)}}},
    {"(C000,0001) number of samples is 0, expected 1 .. 2048", {CARTESIAN, {SET, ITEM(0xC000, 1, U16, 0)}}},
    {NULL, {CARTESIAN, {SET, ITEM(0xC000, 1, U16, 1)}, {SET, BYTES(0xD000, 1, 6)}}},
};

static kretz_plan plan_of(const row *r) {
    kretz_plan plan = kretz_good();
    for (const edit *e = r->edits; e < r->edits + 8 && e->kind != END; e++) {
        if (e->kind == DROP) kretz_drop(&plan, e->item.group, e->item.element);
        if (e->kind == SET) *kretz_find(&plan, e->item.group, e->item.element) = e->item;
        if (e->kind == ADD) kretz_add(&plan, e->item);
    }
    return plan;
}

static void check_rows(const row *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const kretz_plan plan = plan_of(&rows[i]);
        kretz_file("row.vol", &plan);
        if (rows[i].told) {
            kretz_refused("row.vol", rows[i].told);
            continue;
        }
        hs_volume v = kretz_volume("row.vol", NULL);
        assert_true(hs_volume_count(&v) > 0);
        hs_volume_free(&v);
    }
}
#define CHECK(rows) check_rows(rows, sizeof(rows) / sizeof((rows)[0]))

static void sizes_are_checked(void **state) {
    (void)state;
    CHECK(sizes);
}

static void voxels_are_checked(void **state) {
    (void)state;
    CHECK(voxels);
}

static void tables_are_checked(void **state) {
    (void)state;
    CHECK(tables);
}

static void lengths_are_checked(void **state) {
    (void)state;
    CHECK(lengths);
}

static void cartesian_files_are_checked(void **state) {
    (void)state;
    CHECK(cartesian);
}

/* The good file, cut after every one of its bytes. What ends behind the voxels is whole. */
static void every_cut_is_noticed(void **state) {
    (void)state;
    size_t bytes;
    const kretz_plan plan = kretz_good();
    uint8_t *file = kretz_bytes_of(&plan, &bytes);
    for (size_t n = 0; n < bytes; n++) {
        files_write("cut.vol", NULL, file, n);
        if (n == bytes - 8) {
            hs_volume v = kretz_volume("cut.vol", NULL);
            hs_volume_free(&v);
        } else {
            kretz_refused("cut.vol", n < 16 ? "the first 16 bytes" : "");
        }
    }
    free(file);
}

static void lengths_beyond_the_file_are_refused(void **state) {
    (void)state;
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
    free(file);
}

static void swapped_numbers_are_named(void **state) {
    (void)state;
    kretz_plan plan = kretz_good();
    *kretz_find(&plan, 0xC000, 1) = (kretz_item){0x00C0, 0x0100, KRETZ_U16, 1, {0x0400}, NULL};
    kretz_file("swapped.vol", &plan);
    kretz_refused("swapped.vol", "item (00C0,0100): its bytes are swapped");
    plan = kretz_good();
    kretz_add(&plan, (kretz_item){0x00C0, 0x0001, KRETZ_U16, 1, {0x0400}, NULL}); /* just another item */
    kretz_file("swapped.vol", &plan);
    hs_volume v = kretz_volume("swapped.vol", NULL);
    hs_volume_free(&v);
}

static void other_files_are_named(void **state) {
    (void)state;
    uint8_t dicom[200] = {0};
    static const uint8_t mark[4] = {'D', 'I', 'C', 'M'};
    memcpy(dicom + 128, mark, sizeof mark);
    files_write("d.vol", NULL, dicom, sizeof dicom);
    kretz_refused("d.vol", "a DICOM file");
    files_write("m.vol", "KRETZFILE 1.1   and more", NULL, 0);
    kretz_refused("m.vol", "the first 16 bytes are not 'KRETZFILE 1.0'");
    files_write("m.vol", "KRETZFILE 1.0  ", NULL, 0);
    kretz_refused("m.vol", "the first 16 bytes");
    kretz_refused("missing.vol", "No such file");
    assert_int_equal(mkfifo(files_path("pipe.vol"), 0600), 0);
    kretz_refused("pipe.vol", "not a regular file");
}

static void items_are_counted(void **state) {
    (void)state;
    const size_t most = HS_KRETZ_MAX_ITEMS;
    for (int extra = 0; extra < 2; extra++) {
        size_t bytes;
        kretz_plan plan = kretz_good();
        plan.no_end = true;
        uint8_t *good = kretz_bytes_of(&plan, &bytes);
        const size_t items = most - plan.count + (size_t)extra;
        uint8_t *file = calloc(bytes + 8 * items, 1);
        assert_non_null(file);
        memcpy(file, good, bytes);
        files_write("many.vol", NULL, file, bytes + 8 * items);
        if (extra) {
            kretz_refused("many.vol", "more than 65536 items");
        } else {
            hs_volume v = kretz_volume("many.vol", NULL);
            hs_volume_free(&v);
        }
        free(file);
        free(good);
    }
}

/* Voxels behind 4 GB, in a file with a hole: offsets have 64 bits. */
static void large_files_are_read(void **state) {
    (void)state;
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
    hs_volume_free(&v);
    assert_int_equal(unlink(files_path("large.vol")), 0);
    free(file);
}

/* A file that becomes shorter between opening and reading. */
static void a_shrinking_file_is_an_error(void **state) {
    (void)state;
    const kretz_plan plan = kretz_good();
    kretz_file("shrinks.vol", &plan);
    hs_error err = {0};
    hs_volume v = {0};
    hs_kretz *kretz = hs_kretz_open(files_path("shrinks.vol"), NULL, &err);
    assert_non_null(kretz);
    assert_int_equal(truncate(files_path("shrinks.vol"), 100), 0);
    assert_false(hs_kretz_read(kretz, 0, &v, &err));
    assert_int_equal(err.code, HS_ERR_INPUT);
    assert_non_null(strstr(err.text, "the file became shorter"));
    assert_null(v.voxels);
    hs_kretz_close(kretz);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_checked),
        cmocka_unit_test(voxels_are_checked),
        cmocka_unit_test(tables_are_checked),
        cmocka_unit_test(lengths_are_checked),
        cmocka_unit_test(cartesian_files_are_checked),
        cmocka_unit_test(every_cut_is_noticed),
        cmocka_unit_test(lengths_beyond_the_file_are_refused),
        cmocka_unit_test(swapped_numbers_are_named),
        cmocka_unit_test(other_files_are_named),
        cmocka_unit_test(items_are_counted),
        cmocka_unit_test(large_files_are_read),
        cmocka_unit_test(a_shrinking_file_is_an_error),
    };
    return cmocka_run_group_tests(tests, files_setup, files_teardown);
}
