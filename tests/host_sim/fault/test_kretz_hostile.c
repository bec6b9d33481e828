/* SPDX-License-Identifier: MIT */
/*
 * Kretz files that are wrong, a row a rule of docs/kretz.md: each is refused with file, item and value.
 * Beside it stands, with nothing told, the file that just does not break the rule: it is read. What
 * breaks the stream of items itself is in test_kretz_items. Run under ASan.
 * Requirement: R12.
 */
#include "support/kretz_files.h"

#include <math.h>

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

#define CARTESIAN                                                                                            \
    WITHOUT(0xC200, 1), WITHOUT(0xC200, 2), WITHOUT(0xC300, 1), WITHOUT(0xC300, 2), {                        \
        SET, ITEM(0x0001, 0x0100, U32, 1)                                                                    \
    }

static const row rows[] = {
    /* Sizes. */
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
    {"number of lines is 1,", {{SET, ITEM(0xC000, 2, U16, 1)}, {SET, BYTES(0xD000, 1, 8)}}},
    {NULL,
     {{SET, ITEM(0xC000, 2, U16, 2)}, {SET, ITEM(0xC300, 2, F64, 1.2, 1.9)}, {SET, BYTES(0xD000, 1, 16)}}},
    {"number of lines is 2049,", {{SET, ITEM(0xC000, 2, U16, 2049)}}},
    {"number of frames is 1,", {{SET, ITEM(0xC000, 3, U16, 1)}, {SET, BYTES(0xD000, 1, 12)}}},
    {"number of frames is 2049,", {{SET, ITEM(0xC000, 3, U16, 2049)}}},
    /* 2^32 voxels, as many as none in 32 bits; 2^31, one too many; and the most that there can be. */
    {"2048 x 2048 x 1024 are 4294967296 voxels",
     {{SET, ITEM(0xC000, 1, U16, 2048)},
      {SET, ITEM(0xC000, 2, U16, 2048)},
      {SET, ITEM(0xC000, 3, U16, 1024)},
      {SET, BYTES(0xD000, 1, 0)}}},
    {"2048 x 2048 x 512 are 2147483648 voxels, expected less than 2147483648",
     {{SET, ITEM(0xC000, 1, U16, 2048)},
      {SET, ITEM(0xC000, 2, U16, 2048)},
      {SET, ITEM(0xC000, 3, U16, 512)}}},
    {"(D000,0001) voxels have 24 bytes, expected 2143289344 (2048 x 2048 x 511)",
     {{SET, ITEM(0xC000, 1, U16, 2048)},
      {SET, ITEM(0xC000, 2, U16, 2048)},
      {SET, ITEM(0xC000, 3, U16, 511)}}},
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
    /* Voxels. */
    {"(D000,0001) voxels have 23 bytes, expected 24 (4 x 3 x 2)", {{SET, BYTES(0xD000, 1, 23)}}},
    {"(D000,0001) voxels have 25 bytes, expected 24", {{SET, BYTES(0xD000, 1, 25)}}},
    {"(D000,0001) voxels have 0 bytes", {{SET, BYTES(0xD000, 1, 0)}}},
    {"(D000,0001) voxels are given twice", {{ADD, BYTES(0xD000, 1, 24)}}},
    {NULL, {{ADD, BYTES(0xD000, 0x0101, 24)}}},
    {"(D000,0001) voxels are missing", {WITHOUT(0xD000, 1)}},
    {"the file has Doppler only", {WITHOUT(0xD000, 1), {ADD, BYTES(0xD000, 0x0201, 24)}}},
    {"(0002,1000) compressed voxels are all there is", {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1000, 9)}}},
    {"the file has Doppler only", {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1100, 9)}}},
    {"the file has Doppler only", {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1200, 9)}}},
    {"(0002,1000) compressed voxels are all there is",
     {WITHOUT(0xD000, 1), {ADD, BYTES(0x0002, 0x1000, 9)}, {ADD, BYTES(0xD000, 0x0101, 24)}}},
    {NULL, {{ADD, BYTES(0x0002, 0x1000, 9)}}},
    {"(D600,0001) voxels of a sequence have 49 bytes", {{ADD, BYTES(0xD600, 1, 49)}}},
    {"voxels of a sequence have 0 bytes, expected 1 .. 65536 times 24", {{ADD, BYTES(0xD600, 1, 0)}}},
    {NULL, {{ADD, BYTES(0xD600, 1, 48)}}},
    {NULL, {{ADD, BYTES(0xD600, 1, 24)}}},
    {NULL, {WITHOUT(0xD000, 1), {ADD, BYTES(0xD600, 1, 48)}}},
    {"have 47 bytes, expected 1 .. 65536 times 24", {WITHOUT(0xD000, 1), {ADD, BYTES(0xD600, 1, 47)}}},
    {"(D000,0001) voxels have 23 bytes", {{SET, BYTES(0xD000, 1, 23)}, {ADD, BYTES(0xD600, 1, 48)}}},
    {"(D600,0001) voxels of a sequence are given twice",
     {{ADD, BYTES(0xD600, 1, 48)}, {ADD, BYTES(0xD600, 1, 48)}}},
    {"have 1572888 bytes, expected 1 .. 65536 times 24", {{ADD, BYTES(0xD600, 1, 24 * 65537)}}},
    {NULL, {{ADD, BYTES(0xD600, 1, 24 * 65536)}}},
    /* Tables of angles. */
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
    {"(C300,0001) sweep angles span 1e-300, expected at least 0.01",
     {{SET, ITEM(0xC300, 1, F64, 0, 1e-300)}}},
    {"(C300,0001) sweep angles span 0.0099,", {{SET, ITEM(0xC300, 1, F64, 0, 0.0099)}}},
    {NULL, {{SET, ITEM(0xC300, 1, F64, 0, 0.01)}}},
    {NULL, {{SET, ITEM(0xC300, 1, F64, 1.8, 1.3)}}},
    {"(C300,0001) sweep angles have 0 bytes, expected 16", {{SET, BYTES(0xC300, 1, 0)}}},
    {"(C300,0001) sweep angles: angle 1 is nan", {{SET, ITEM(0xC300, 1, F64, 1.3, NAN)}}},
    {"(C300,0002) angles in the plane: angle 2 is inf", {{SET, ITEM(0xC300, 2, F64, 1.2, 1.5, INFINITY)}}},
    {"(C300,0002) angles in the plane span 0,", {{SET, ITEM(0xC300, 2, F64, 1.2, 1.5, 1.2)}}},
    {"(C300,0002) angles in the plane span 3.15,", {{SET, ITEM(0xC300, 2, F64, 0.0, 1.5, 3.15)}}},
    {NULL, {{SET, ITEM(0xC300, 2, F64, 0.0, 1.5, 3.14)}}},
    {"(C300,0001) sweep angles span 3.14159,", {{SET, ITEM(0xC300, 1, F64, 0.0, 3.14159265358979323846)}}},
    {NULL, {{SET, ITEM(0xC300, 1, F64, 0.0, 3.1415926)}}},
    {"(C300,0001) sweep angles span 3.15,", {{SET, ITEM(0xC300, 1, F64, 0.0, 3.15)}}},
    {NULL, {{SET, ITEM(0xC300, 1, F64, 0.0, 3.14)}}},
    {"(C300,0001) sweep angles span 80, expected at least 0.01 and less than pi radians",
     {{SET, ITEM(0xC300, 1, F64, 50, 130)}}},
    /* Lengths. */
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
    {NULL, {{SET, ITEM(0xC200, 2, F64, 2000)}}},
    {"(C200,0002) place of the sweep's axis is 1000.5 mm, expected -1000 .. 1000 mm",
     {{SET, ITEM(0xC200, 1, F64, 2000)}, {SET, ITEM(0xC200, 2, F64, -2001)}}},
    {"(C200,0002) place of the sweep's axis is 1000 mm, at or behind",
     {{SET, ITEM(0xC200, 1, F64, 2000)}, {SET, ITEM(0xC200, 2, F64, -2000)}}},
    /* On the outer lines, at 0.35 rad, the samples start at 10 cos(0.35) = 9.3937 mm. */
    {"(C200,0002) place of the sweep's axis is 9.4 mm, at or behind the samples' start at 9.393",
     {{SET, ITEM(0xC200, 2, F64, -18.8)}}},
    {NULL, {{SET, ITEM(0xC200, 2, F64, -18.78)}}},
    {"at or behind the samples' start at 0 mm",
     {{SET, ITEM(0xC200, 1, F64, 0)}, {SET, ITEM(0xC200, 2, F64, 0)}}},
    /* Cartesian files. */
    {NULL, {CARTESIAN}},
    {"(C100,0001) radial pitch is missing", {CARTESIAN, WITHOUT(0xC100, 1)}},
    {NULL, {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 0.5)}}},
    {NULL, {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, 0.5)}}},
    {"(0010,0022) Cartesian spacing is given twice, as 0.5 and as 0.6",
     {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, 0.5)}, {ADD, ITEM(0x0010, 0x0022, F64, 0.6)}}},
    {"(0010,0022) Cartesian spacing is 5.01 mm, expected 0.01 .. 5 mm",
     {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 5.01)}}},
    {NULL, {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 5)}}},
    {"(0010,0022) Cartesian spacing is 0.0099 mm",
     {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 0.0099)}}},
    {NULL, {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, 0.01)}}},
    {"(0010,0022) Cartesian spacing is 0.6 mm, but (C100,0001) says 0.5 mm",
     {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, 0.6)}}},
    {"(0010,0022) Cartesian spacing is nan mm", {CARTESIAN, {ADD, ITEM(0x0010, 0x0022, F64, NAN)}}},
    {"(0010,0022) Cartesian spacing is -1 mm",
     {CARTESIAN, WITHOUT(0xC100, 1), {ADD, ITEM(0x0010, 0x0022, F64, -1)}}},
    {"(C000,0001) number of samples is 0, expected 1 .. 2048", {CARTESIAN, {SET, ITEM(0xC000, 1, U16, 0)}}},
    {NULL, {CARTESIAN, {SET, ITEM(0xC000, 1, U16, 1)}, {SET, BYTES(0xD000, 1, 6)}}},
    /* Texts of any length are passed over. */
    {NULL, {WITHOUT(0x0110, 2)}},
    {NULL, {{SET, BYTES(0x0110, 2, 0)}}},
    {NULL, {{ADD, BYTES(0x0110, 1, 70000)}, {ADD, BYTES(0x0120, 1, 1)}, {ADD, BYTES(0x0150, 0xFFFF, 4097)}}},
    {NULL, {{ADD, BYTES(0x0110, 2, 12)}}},
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

static void each_rule_is_held(void **state) {
    for (const row *r = rows; r < rows + sizeof rows / sizeof *rows; r++) {
        const kretz_plan plan = plan_of(r);
        kretz_file("row.vol", &plan);
        if (r->told) {
            kretz_refused("row.vol", r->told);
            continue;
        }
        hs_volume v = kretz_volume("row.vol", NULL);
        assert_true(hs_volume_count(&v) > 0);
    }
}

static void a_text_is_no_longer_than_the_file(void **state) {
    size_t bytes;
    const kretz_plan plan = kretz_good();
    uint8_t *file = kretz_bytes_of(&plan, &bytes);
    hs_error err = {0};
    file[20] = 0xFF; /* the length of the first item, a text: its two low bytes */
    file[21] = 0xFF;
    files_write("text.vol", NULL, file, bytes);
    assert_null(hs_kretz_open(files_path("text.vol"), NULL, &err));
    unit_told(err, HS_ERR_INPUT, "item (0110,0002) has 65535 bytes, but");
    assert_null(strstr(err.text, "MUSTER"));
}

UNIT_MAIN(files_setup, files_teardown, each_rule_is_held, a_text_is_no_longer_than_the_file)
