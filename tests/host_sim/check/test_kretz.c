/* SPDX-License-Identifier: MIT */
/* What the Kretz reader makes of good files: items in any order, banks, sequences, Cartesian files, and what
 * the writer wrote. */
#include "support/kretz_files.h"
#include "volume/kretz.h"

#include <math.h>

#define CLOSE(a, b) assert_true(fabs((a) - (b)) < 1e-12)

static void expect_good(const hs_volume *v) {
    const hs_beams *b = v->beams;
    assert_non_null(b);
    assert_int_equal(b->samples, KRETZ_SAMPLES);
    assert_int_equal(b->lines, KRETZ_LINES);
    assert_int_equal(b->planes, KRETZ_PLANES);
    CLOSE(b->pitch, 0.5);
    CLOSE(b->start, 10.0);
    CLOSE(b->axis, -5.0);
    for (int j = 0; j < KRETZ_LINES; j++) CLOSE(b->theta[j], 0.35 * (j - 1));
    for (int k = 0; k < KRETZ_PLANES; k++) CLOSE(b->phi[k], 0.5 * k - 0.25);
    for (int n = 0; n < KRETZ_VOXELS; n++) assert_int_equal(b->voxels[n], n + 1);
}

static void items_come_in_any_order(void **state) {
    for (uint32_t turn = 0; turn < kretz_good().count; turn++) {
        kretz_plan plan = kretz_good(), turned = plan;
        for (uint32_t i = 0; i < plan.count; i++) turned.item[i] = plan.item[(i * 7 + turn) % plan.count];
        turned.no_end = turn % 2;
        kretz_file("order.vol", &turned);
        hs_volume v = kretz_volume("order.vol", NULL);
        expect_good(&v);
        assert_string_equal(v.name, "order.vol");
    }
}

static void other_banks_and_what_follows_the_end_do_not_matter(void **state) {
    kretz_plan plan = kretz_good();
    kretz_add(&plan, (kretz_item){0xC000, 0x0101, KRETZ_U16, 1, {77}, NULL});
    kretz_add(&plan, (kretz_item){0xC100, 0x0201, KRETZ_F64, 1, {NAN}, NULL});
    kretz_add(&plan, (kretz_item){0xD000, 0x0101, KRETZ_BYTES, 5, {200}, NULL});
    kretz_add(&plan, (kretz_item){0xD000, 0x0201, KRETZ_BYTES, 7, {200}, NULL});
    kretz_add(&plan, (kretz_item){0x4711, 0x0815, KRETZ_BYTES, 3, {0}, NULL});
    kretz_add(&plan, (kretz_item){0xFFFF, 0xFFFF, KRETZ_BYTES, 0, {0}, NULL});
    kretz_add(&plan, (kretz_item){0xC000, 0x0001, KRETZ_U16, 1, {99}, NULL});
    kretz_file("banks.vol", &plan);
    hs_volume v = kretz_volume("banks.vol", NULL);
    expect_good(&v);
}

/* Angles from high to low, and steps of different length, stay with their voxels. */
static void tables_may_descend_and_be_uneven(void **state) {
    kretz_plan plan = kretz_good();
    kretz_find(&plan, 0xC300, 0x0001)->value[0] = 1.8;
    kretz_find(&plan, 0xC300, 0x0001)->value[1] = 1.3;
    kretz_find(&plan, 0xC300, 0x0002)->value[1] = 1.3;
    kretz_file("descending.vol", &plan);
    hs_volume v = kretz_volume("descending.vol", NULL);
    CLOSE(v.beams->phi[0], 0.25);
    CLOSE(v.beams->phi[1], -0.25);
    CLOSE(v.beams->theta[0], -0.35);
    CLOSE(v.beams->theta[1], -0.25);
    CLOSE(v.beams->theta[2], 0.35);
    for (int n = 0; n < KRETZ_VOXELS; n++) assert_int_equal(v.beams->voxels[n], n + 1);
}

static void cartesian_files_are_volumes(void **state) {
    for (int form = 0; form < 3; form++) { /* C100 in metres, (0010,0022) in mm, both */
        kretz_plan plan = kretz_good();
        const uint16_t groups[] = {0xC200, 0xC200, 0xC300, 0xC300}, elements[] = {1, 2, 1, 2};
        for (int i = 0; i < 4; i++) kretz_drop(&plan, groups[i], elements[i]);
        kretz_find(&plan, 0x0001, 0x0100)->value[0] = 1;
        if (form > 0) kretz_add(&plan, (kretz_item){0x0010, 0x0022, KRETZ_F64, 1, {0.5}, NULL});
        if (form == 1) kretz_drop(&plan, 0xC100, 0x0001);
        kretz_find(&plan, 0xD000, 0x0001)->value[0] = 0;
        kretz_file("cartesian.vol", &plan);
        const hs_kretz_options inner = {.padding = HS_PADDING_NONE};
        hs_volume v = kretz_volume("cartesian.vol", form == 2 ? &inner : NULL);
        assert_null(v.beams);
        assert_int_equal(v.nx, 4);
        assert_int_equal(v.ny, 3);
        assert_int_equal(v.nz, 2);
        for (int a = 0; a < 3; a++) CLOSE(v.spacing[a], 0.5);
        assert_int_equal(v.voxels[0], form == 2 ? 1 : 0); /* the border's zero was not scanned */
        for (int n = 1; n < KRETZ_VOXELS; n++) assert_int_equal(v.voxels[n], n);
    }
}

/* Frame n holds bytes that count up from 24 n + 1. The single volume beside it is the first. */
static void sequences_have_volumes(void **state) {
    for (int both = 0; both < 2; both++) {
        kretz_plan plan = kretz_good();
        if (!both) kretz_drop(&plan, 0xD000, 0x0001);
        kretz_add(&plan, (kretz_item){0xD600, 0x0001, KRETZ_BYTES, 5 * KRETZ_VOXELS, {1}, NULL});
        kretz_file("four.v00", &plan);
        assert_true(hs_kretz_is_file(files_path("four.v00")));
        hs_error err = {0};
        hs_volume v = {0};
        hs_kretz *kretz = hs_kretz_open(files_path("four.v00"), NULL, &err);
        if (!kretz) fail_msg("%s", err.text);
        assert_int_equal(hs_kretz_count(kretz), 5);
        const uint8_t *memory = NULL;
        for (uint32_t n = 0; n < 5; n++) {
            const uint32_t turn = n * 3 % 5;
            assert_true(hs_kretz_read(kretz, turn, &v, &err));
            for (uint32_t i = 0; i < KRETZ_VOXELS; i++)
                assert_int_equal(v.beams->voxels[i], turn * KRETZ_VOXELS + i + 1);
            assert_true(n == 0 || memory == v.beams->voxels); /* filled again, no new memory */
            memory = v.beams->voxels;
        }
        hs_volume_free(&v);
        hs_kretz_close(kretz);
    }
}

static void files_are_known_by_name_or_content(void **state) {
    const kretz_plan plan = kretz_good();
    kretz_file("scan.dat", &plan);
    files_write("other.dat", "ObjectType = Image\n", NULL, 0);
    assert_true(hs_kretz_is_file(files_path("scan.dat")));
    assert_false(hs_kretz_is_file(files_path("other.dat")));
    assert_true(hs_kretz_is_file("a/b.VOL"));
    assert_true(hs_kretz_is_file("b.v05"));
    assert_false(hs_kretz_is_file("b.v06"));
    assert_false(hs_kretz_is_file("b.mha"));
}

/* A geometry of its own, with `count` volumes of noise, written and read again. */
static void round_trip(uint32_t count, double axis, int descending) {
    double theta[7], phi[5];
    for (int j = 0; j < 7; j++) theta[j] = 0.1 * (j - 3) + (j > 0 && j < 6 ? 0.01 * (j % 3) : 0.0);
    for (int k = 0; k < 5; k++) phi[k] = (descending ? -0.2 : 0.2) * (k - 2);
    const hs_beams written = {.samples = 9,
                              .lines = 7,
                              .planes = 5,
                              .pitch = 0.31,
                              .start = 12.5,
                              .axis = axis,
                              .theta = theta,
                              .phi = phi};
    uint8_t voxels[3][9 * 7 * 5];
    hs_kretz_writer writer;
    hs_error err = {0};
    assert_true(hs_kretz_write_open(&writer, files_path("trip.vol"), &written, count, &err));
    for (uint32_t n = 0; n < count; n++) {
        for (size_t i = 0; i < sizeof voxels[n]; i++)
            voxels[n][i] = (uint8_t)((i + 1) * (n + 37) * 2654435761u >> 9);
        assert_true(hs_kretz_write_volume(&writer, voxels[n], &err));
    }
    if (!hs_kretz_write_commit(&writer, &err)) fail_msg("%s", err.text);
    const hs_kretz_options elsewhere = {.folder = "/usr"};
    assert_null(hs_kretz_open(files_path("trip.vol"), &elsewhere, &err));
    unit_told(err, HS_ERR_INPUT, "it lies outside of the folder that was opened");
    hs_kretz *kretz = hs_kretz_open(files_path("trip.vol"), NULL, &err);
    if (!kretz) fail_msg("%s", err.text);
    assert_int_equal(hs_kretz_count(kretz), count);
    hs_volume v = {0};
    for (uint32_t n = 0; n < count; n++) {
        assert_true(hs_kretz_read(kretz, n, &v, &err));
        assert_memory_equal(v.beams->voxels, voxels[n], sizeof voxels[n]);
    }
    CLOSE(v.beams->pitch, 0.31);
    CLOSE(v.beams->start, 12.5);
    CLOSE(v.beams->axis, axis);
    for (int j = 0; j < 7; j++) CLOSE(v.beams->theta[j], theta[j]);
    for (int k = 0; k < 5; k++) CLOSE(v.beams->phi[k], phi[k]);
    hs_volume_free(&v);
    hs_kretz_close(kretz);
}

static void what_is_written_is_read(void **state) {
    round_trip(1, -4.0, 0);
    round_trip(3, 7.0, 1);
}

static void writer_wants_all_volumes(void **state) {
    double angles[2] = {-0.1, 0.1};
    const hs_beams b = {
        .samples = 2, .lines = 2, .planes = 2, .pitch = 0.5, .start = 1, .theta = angles, .phi = angles};
    const uint8_t voxels[8] = {0};
    const int before = files_count();
    hs_kretz_writer writer;
    must_not(hs_kretz_write_open(&writer, files_path("none.vol"), &b, 0, &err), HS_ERR_OUTPUT, "");
    must(hs_kretz_write_open(&writer, files_path("none.vol"), &b, 2, &err));
    must(hs_kretz_write_volume(&writer, voxels, &err));
    must_not(hs_kretz_write_commit(&writer, &err), HS_ERR_OUTPUT, "");
    assert_int_equal(files_count(), before);
}

UNIT_MAIN(files_setup, files_teardown, items_come_in_any_order,
          other_banks_and_what_follows_the_end_do_not_matter, tables_may_descend_and_be_uneven,
          cartesian_files_are_volumes, sequences_have_volumes, files_are_known_by_name_or_content,
          what_is_written_is_read, writer_wants_all_volumes)
