/* SPDX-License-Identifier: MIT */
/*
 * Kretz volumes in DICOM files: in every little-endian transfer syntax, behind sequences and pictures, they
 * are the volumes of the bare file. What is cut, too long, nested wrongly, of another syntax, twice or not
 * there is refused with file, element and value. The files are made here, byte by byte. Run under ASan.
 */
#include "support/kretz_files.h"
#include "volume/kretz_parts.h"

#define EXPLICIT  "1.2.840.10008.1.2.1"
#define IMPLICIT  "1.2.840.10008.1.2"
#define UNDEFINED UINT32_MAX

/* A DICOM file under way. */
typedef struct {
    uint8_t bytes[4096];
    size_t count;
    bool untyped; /* implicit: no types */
} dicom;

static void put(dicom *d, const void *bytes, size_t count) {
    assert_true(d->count + count <= sizeof d->bytes);
    if (count) memcpy(d->bytes + d->count, bytes, count);
    d->count += count;
}

static void put_number(dicom *d, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++) put(d, &(uint8_t){(uint8_t)(value >> 8 * i)}, 1);
}

/* Tag, type and length: of 16 bits if the type has two letters, of 32 behind "OB" and the like; "" has no
 * type. */
static void put_header(dicom *d, uint32_t tag, const char *type, uint32_t bytes) {
    const bool is_long = strcmp(type, "OB") == 0 || strcmp(type, "SQ") == 0 || strcmp(type, "UN") == 0;
    put_number(d, tag >> 16, 2);
    put_number(d, tag, 2);
    if (d->untyped || !type[0]) {
        put_number(d, bytes, 4);
        return;
    }
    put(d, type, 2);
    if (is_long) put_number(d, 0, 2);
    put_number(d, bytes, is_long ? 4 : 2);
}

static void put_element(dicom *d, uint32_t tag, const char *type, const void *value, size_t bytes) {
    put_header(d, tag, type, (uint32_t)bytes);
    put(d, value, bytes);
}

static void put_text(dicom *d, uint32_t tag, const char *type, const char *text) {
    put_element(d, tag, type, text, strlen(text));
}

/* Preamble, description, a patient. NULL: no transfer syntax is told. */
static dicom dicom_begin(const char *syntax) {
    dicom d = {.count = 128};
    put(&d, "DICM", 4);
    put_element(&d, 0x00020001, "OB", "\0\1", 2);
    if (syntax) put_text(&d, 0x00020010, "UI", syntax);
    d.untyped = syntax && strcmp(syntax, IMPLICIT) == 0;
    put_text(&d, 0x00100010, "PN", "MUSTERFRAU^A");
    return d;
}

static void put_kretz(dicom *d, uint32_t tag, const kretz_plan *plan) {
    size_t bytes;
    uint8_t *file = kretz_bytes_of(plan, &bytes);
    put_header(d, tag, "OB", (uint32_t)(bytes + bytes % 2));
    put(d, file, bytes);
    put(d, "", bytes % 2);
}

static dicom dicom_good(const char *syntax) {
    dicom d = dicom_begin(syntax);
    const kretz_plan plan = kretz_good();
    put_text(&d, 0x7FE10011, "LO", "KRETZ_US");
    put_kretz(&d, 0x7FE11101, &plan);
    put_text(&d, 0x7FE11102, "LO", "more");
    return d;
}

static void write_dicom(const char *name, const dicom *d) {
    files_write(name, NULL, d->bytes, d->count);
}

static void refused(const dicom *d, const char *told) {
    write_dicom("bad.dcm", d);
    kretz_refused("bad.dcm", told);
}

/* The file is known as a Kretz volume, and has that of kretz_good. */
static void is_read(const dicom *d) {
    write_dicom("good.dcm", d);
    assert_true(hs_kretz_is_file(files_path("good.dcm")));
    hs_volume v = kretz_volume("good.dcm", NULL);
    assert_int_equal(hs_beams_count(v.beams), KRETZ_VOXELS);
    for (int i = 0; i < KRETZ_VOXELS; i++) assert_int_equal(v.beams->voxels[i], i + 1);
}

static void every_syntax_is_read(void **state) {
    static const char *const syntaxes[] = {EXPLICIT, IMPLICIT, "1.2.840.10008.1.2.4.50",
                                           "1.2.840.10008.1.2.5"};
    for (size_t i = 0; i < sizeof syntaxes / sizeof *syntaxes; i++) {
        const dicom d = dicom_good(syntaxes[i]);
        is_read(&d);
    }
}

/* A volume with an odd number of bytes and without the item that ends it has a byte behind it. */
static void a_padding_byte_is_no_item(void **state) {
    kretz_plan plan = kretz_good();
    plan.no_end = true;
    kretz_add(&plan, (kretz_item){0x0150, 1, KRETZ_BYTES, 1, {1}, NULL});
    dicom d = dicom_begin(EXPLICIT);
    put_kretz(&d, 0x7FE11101, &plan);
    assert_int_equal(d.bytes[d.count - 1], 0);
    is_read(&d);
}

/* A sequence of one item and one text; told: with their lengths. */
static void put_sequence(dicom *d, uint32_t tag, const char *type, bool told, const char *inner) {
    put_header(d, tag, type, told ? 20 : UNDEFINED);
    put_header(d, 0xFFFEE000, "", told ? 12 : UNDEFINED);
    put_header(d, 0x00080100, inner, 4);
    put(d, "CODE", 4);
    if (told) return;
    put_header(d, 0xFFFEE00D, "", 0);
    put_header(d, 0xFFFEE0DD, "", 0);
}

/* Pictures in pieces, sequences with and without lengths, and one of unknown type, in which nothing has a
 * type. */
static void what_lies_before_it_is_passed_over(void **state) {
    for (int untyped = 0; untyped < 2; untyped++) {
        const kretz_plan plan = kretz_good();
        dicom d = dicom_begin(untyped ? IMPLICIT : EXPLICIT);
        put_sequence(&d, 0x00081110, "SQ", true, "SH");
        put_sequence(&d, 0x00081115, "SQ", false, "SH");
        put_sequence(&d, 0x00091001, "UN", false, "");
        put_sequence(&d, 0x00091002, "SQ", false, "SH");
        put_header(&d, 0x7FE00010, "OB", UNDEFINED);
        put_header(&d, 0xFFFEE000, "", 0);
        put_element(&d, 0xFFFEE000, "", "picture", 8);
        put_header(&d, 0xFFFEE0DD, "", 0);
        put_element(&d, 0x7FE11001, "OB", "KRETZFILE 1.1   and more",
                    24); /* of another version, and no volume */
        put_kretz(&d, 0x7FE11101, &plan);
        is_read(&d);
    }
}

/* The good file, cut after every one of its bytes: only behind the volume, or behind all, it is whole. */
static void every_cut_is_noticed(void **state) {
    for (int untyped = 0; untyped < 2; untyped++) {
        const dicom whole = dicom_good(untyped ? IMPLICIT : EXPLICIT);
        const size_t behind_volume = whole.count - 12;
        for (size_t n = 132; n < whole.count; n++) {
            dicom d = whole;
            d.count = n;
            if (n == behind_volume)
                is_read(&d);
            else
                refused(&d, "");
        }
    }
}

static void lengths_beyond_the_file_are_refused(void **state) {
    dicom d = dicom_begin(EXPLICIT);
    put_header(&d, 0x7FE11101, "OB", 0xFFFFFFFE);
    refused(&d, "element (7FE1,1101) has 4294967294 bytes, but 0 are left");
    d = dicom_begin(IMPLICIT);
    put_header(&d, 0x7FE11101, "", 17);
    put(&d, "KRETZFILE 1.0   ", 16);
    refused(&d, "element (7FE1,1101) has 17 bytes, but 16 are left");
    d = dicom_begin(EXPLICIT);
    put(&d, "\x10\0\x20\0OB\0\0", 8);
    refused(&d, "element (0010,0020): 8 bytes are left, its header needs 12");
    put(&d, "\2\0\0\0", 4);
    refused(&d, "element (0010,0020) has 2 bytes, but 0 are left");
    d = dicom_begin(EXPLICIT);
    put(&d, "\x10\0\x20", 3);
    refused(&d, "3 bytes are left, an element's header needs 8");
}

static void wrong_nesting_is_refused(void **state) {
    static const uint32_t ends[] = {0xFFFEE00D, 0xFFFEE0DD};
    for (int i = 0; i < 2; i++) {
        dicom d = dicom_begin(EXPLICIT);
        put_header(&d, ends[i], "", 0);
        refused(&d, ") ends what has not begun");
        d = dicom_begin(EXPLICIT);
        put_header(&d, 0x00081115, "SQ", UNDEFINED);
        put_header(&d, ends[i], "", UNDEFINED);
        refused(&d, ") ends what has not begun");
    }
    dicom d = dicom_begin(EXPLICIT);
    put_header(&d, 0x00081115, "SQ", UNDEFINED);
    refused(&d, "the file ends within a sequence");
    const kretz_plan plan = kretz_good();
    put_header(&d, 0xFFFEE000, "", UNDEFINED);
    put_kretz(&d, 0x7FE11101, &plan);
    put_header(&d, 0xFFFEE00D, "", 0);
    put_header(&d, 0xFFFEE0DD, "", 0);
    refused(&d,
            "no element of group 7FE1 begins with 'KRETZFILE 1.0'"); /* that of a sequence does not count */
}

static void other_syntaxes_are_refused(void **state) {
    static const char *const others[] = {"1.2.840.10008.1.2.1.99", "1.2.840.10008.1.2.2",
                                         "1.2.840.10008.1.20", "1.2", ""};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        const char *const told =
            unit_text("(0002,0010) transfer syntax is '%s', expected implicit or", others[i]);
        const dicom d = dicom_good(others[i]);
        refused(&d, told);
    }
    dicom d = dicom_good(NULL);
    refused(&d, "(0002,0010) transfer syntax is ''");
    d = dicom_good("1.2MUSTER");
    refused(&d, "transfer syntax is '1.2', expected");
}

static void one_volume_is_expected(void **state) {
    const kretz_plan plan = kretz_good();
    dicom d = dicom_begin(EXPLICIT);
    refused(&d, "a DICOM file, but no element of group 7FE1 begins with 'KRETZFILE 1.0': 'smartvis clip'");
    put_kretz(&d, 0x7FE01101, &plan); /* not that group */
    refused(&d, "no element of group 7FE1");
    d = dicom_good(EXPLICIT);
    put_kretz(&d, 0x7FE11201, &plan);
    refused(&d, "element (7FE1,1201) holds a Kretz volume, and so does (7FE1,1101): expected one");
    d = dicom_begin(EXPLICIT);
    put_header(&d, 0x00100020, "l0", 0);
    refused(&d, "element (0010,0020): its type is 6C 30 hex, expected two capital letters");
}

/* What is wrong with the volume itself is said as of a bare file. */
static void the_volume_is_checked(void **state) {
    kretz_plan plan = kretz_good();
    kretz_drop(&plan, 0xD000, 1);
    kretz_add(&plan, (kretz_item){0x0002, 0x1000, KRETZ_BYTES, 9, {1}, NULL});
    dicom d = dicom_begin(EXPLICIT);
    put_kretz(&d, 0x7FE11101, &plan);
    refused(
        &d,
        "(0002,1000) compressed voxels are all there is; in 4D View, re-save with wavelet compression off");
    plan = kretz_good();
    plan.no_end = true;
    kretz_find(&plan, 0xD000, 1)->count = 23;
    d = dicom_begin(EXPLICIT);
    put_kretz(&d, 0x7FE11101, &plan);
    refused(&d, "(D000,0001) voxels have 23 bytes, expected 24");
}

/* An item that goes beyond the volume, but not beyond the file, is refused, too. */
static void the_volume_ends_where_its_element_does(void **state) {
    dicom d = dicom_good(EXPLICIT);
    size_t bytes;
    const kretz_plan plan = kretz_good();
    (void)kretz_bytes_of(&plan, &bytes);
    const size_t length = d.count - 12 - bytes - 4;
    d.bytes[length] = (uint8_t)(d.bytes[length] - 10); /* without the end of the stream and two voxels */
    dicom behind = d;
    d.count -= 12 + 10;
    refused(&d, "item (D000,0001) has 24 bytes, but 22 are left");
    refused(&behind, ""); /* what is left of the volume is no element */
}

static void elements_are_counted(void **state) {
    const size_t maximum = 65536;
    for (size_t extra = 0; extra < 2; extra++) {
        const dicom d = dicom_good(IMPLICIT);
        const size_t count = maximum - 6 + extra; /* the good file has six */
        uint8_t *file = unit_memory(d.count + 8 * count);
        memcpy(file, d.bytes, d.count);
        files_write("many.dcm", NULL, file, d.count + 8 * count);
        if (extra) {
            kretz_refused("many.dcm", "more than 65536 elements");
        } else {
            kretz_volume("many.dcm", NULL);
        }
    }
}

UNIT_MAIN(files_setup, files_teardown, every_syntax_is_read, a_padding_byte_is_no_item,
          what_lies_before_it_is_passed_over, every_cut_is_noticed, lengths_beyond_the_file_are_refused,
          wrong_nesting_is_refused, other_syntaxes_are_refused, one_volume_is_expected, the_volume_is_checked,
          the_volume_ends_where_its_element_does, elements_are_counted)
