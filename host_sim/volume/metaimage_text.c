/* SPDX-License-Identifier: MIT */
/* The text of a MetaImage header, told from files of other formats by what is in it and not by its name. */
#include "core/input_file.h"
#include "core/system.h"
#include "volume/metaimage_parts.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

/* Where a NIfTI header has its size and its mark; Analyze 7.5 has the size alone. */
enum { NIFTI1_SIZE = 348, NIFTI1_MARK = 344, NIFTI2_SIZE = 540, NIFTI2_MARK = 4, DICOM_MARK = 128 };

static bool holds(const uint8_t *head, size_t bytes, size_t at, const char *mark, size_t length) {
    return bytes >= at + length && memcmp(head + at, mark, length) == 0;
}

/* A 32-bit number at the start, in either byte order. */
static bool starts_with(const uint8_t *head, size_t bytes, uint32_t number) {
    if (bytes < 4) return false;
    const uint32_t little =
        head[0] | (uint32_t)head[1] << 8 | (uint32_t)head[2] << 16 | (uint32_t)head[3] << 24;
    const uint32_t big = head[3] | (uint32_t)head[2] << 8 | (uint32_t)head[1] << 16 | (uint32_t)head[0] << 24;
    return little == number || big == number;
}

static bool is_nifti(const uint8_t *head, size_t bytes) {
    if (starts_with(head, bytes, NIFTI1_SIZE))
        return holds(head, bytes, NIFTI1_MARK, "n+1", 4) || holds(head, bytes, NIFTI1_MARK, "ni1", 4);
    return starts_with(head, bytes, NIFTI2_SIZE) &&
           (holds(head, bytes, NIFTI2_MARK, "n+2", 4) || holds(head, bytes, NIFTI2_MARK, "ni2", 4));
}

/* The first bytes of what is compressed; 0 if they cannot be had. */
static size_t inflate_head(const uint8_t *head, size_t bytes, uint8_t *out, size_t room) {
    z_stream zlib = {0};
    if (inflateInit2(&zlib, 15 + 32) != Z_OK) return 0;
    zlib.next_in = (z_const Bytef *)head;
    zlib.avail_in = (uInt)bytes;
    zlib.next_out = out;
    zlib.avail_out = (uInt)room;
    (void)inflate(&zlib, Z_SYNC_FLUSH);
    (void)inflateEnd(&zlib);
    return room - zlib.avail_out;
}

/* A DICOM file without its preamble starts with an element of group 2 or 8, little endian, whose value
 * representation is in capitals. */
static bool is_bare_dicom(const uint8_t *head, size_t bytes) {
    return bytes >= 8 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0 && head[4] >= 'A' &&
           head[4] <= 'Z' && head[5] >= 'A' && head[5] <= 'Z';
}

static bool ends_with(const char *path, const char *ending) {
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && strcasecmp(path + n - m, ending) == 0;
}

static const char python_reads[] = "'smartvis clip' of the Python package reads it";
static const char save_as[] = "save it as one of these", fetch[] = "fetch the file itself";
static const char packed[] = "a file compressed as a whole", unpack[] = "unpack it first";

/* What a file is by its first bytes, as in "FILE: is FORMAT", and what helps. */
static const struct {
    const char *mark;
    size_t bytes;
    const char *format, *how;
} marks[] = {
#define MARK(mark, format, how)                                                                              \
    { mark, sizeof(mark) - 1, format, how }
    MARK("NRRD", "an NRRD file", python_reads),
    MARK("# vtk", "a VTK file", python_reads),
    MARK("II*\0", "a TIFF file", python_reads),
    MARK("MM\0*", "a TIFF file", python_reads),
    MARK("II+\0", "a TIFF file", python_reads),
    MARK("MM\0+", "a TIFF file", python_reads),
    MARK("\x89PNG", "a picture", "one file has all slices of a volume"),
    MARK("\xff\xd8\xff", "a picture", "one file has all slices of a volume"),
    MARK("BM", "a picture", "one file has all slices of a volume"),
    MARK("\x89HDF", "an HDF5 file", save_as),
    MARK("\x93NUMPY", "an array of NumPy", save_as),
    MARK("%PDF", "a PDF document", fetch),
    MARK("\xff\xfe", "text in UTF-16", "save it as plain text"),
    MARK("\xfe\xff", "text in UTF-16", "save it as plain text"),
    MARK("\xef\xbb\xbf", "text with a byte order mark", "save it without one"),
    MARK("BZh", packed, unpack),
    MARK("\xfd"
         "7zXZ",
         packed, unpack),
    MARK("7z\xbc\xaf", packed, unpack),
    MARK("\x28\xb5\x2f\xfd", packed, unpack),
    MARK("Rar!", packed, unpack),
    MARK("PK\3\4", packed, unpack),
    MARK("KRETZFILE", "a Kretz file", "labels and maps come in no other format"),
    MARK("\0\5\x16\7", "what macOS keeps beside a file", "the file itself is called so without ._ in front"),
    MARK("version https://git-lfs", "a pointer of Git LFS", "'git lfs pull' brings the file"),
};

/* Of text, whatever spaces it begins with; NULL: none that is known. */
static const char *markup_of(const uint8_t *head, size_t bytes) {
    static const char *const begins[][2] = {{"<!doctype html", "a web page"},
                                            {"<html", "a web page"},
                                            {"<VTKFile", "a file in VTK's XML format"},
                                            {"<?xml", "XML"},
                                            {"{", "JSON"}};
    size_t at = 0;
    while (at < bytes && isspace(head[at])) at++;
    for (size_t i = 0; i < sizeof begins / sizeof *begins; i++) {
        const size_t length = strlen(begins[i][0]);
        if (bytes - at >= length && strncasecmp((const char *)head + at, begins[i][0], length) == 0)
            return begins[i][1];
    }
    return NULL;
}

/* The format that the first bytes are of, and what helps; NULL: none that is known. */
static const char *format_of(const char *path, const uint8_t *head, size_t bytes, const char **how) {
    *how = python_reads;
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
        if (holds(head, bytes, 0, marks[i].mark, marks[i].bytes)) {
            *how = marks[i].how;
            return marks[i].format;
        }
    if (is_nifti(head, bytes)) return "a NIfTI file";
    if (starts_with(head, bytes, NIFTI1_SIZE) && ends_with(path, ".hdr")) return "an Analyze file";
    if (holds(head, bytes, DICOM_MARK, "DICM", 4) || is_bare_dicom(head, bytes)) {
        *how = "'smartvis clip' of the Python package reads it, or a folder with its series";
        return "a DICOM file";
    }
    *how = fetch;
    return holds(head, bytes, 4, "ftyp", 4) ? "a video" : markup_of(head, bytes);
}

/* True, with HS_ERR_INPUT, if there is nothing, or the first bytes are those of something else, also
 * compressed: the message names it and says what helps. */
static bool is_foreign(const char *path, const char *head_text, size_t bytes, hs_error *err) {
    const uint8_t *head = (const uint8_t *)head_text;
    const bool empty = bytes == 0;
    uint8_t inner[NIFTI2_SIZE];
    if (bytes >= 2 && head[0] == 0x1f && head[1] == 0x8b) {
        bytes = inflate_head(head, bytes, inner, sizeof inner);
        head = inner;
    }
    const char *how, *format = format_of(path, head, bytes, &how);
    if (!format && (empty || head == inner)) {
        format = empty ? "empty" : packed;
        how = empty ? "copy it anew" : unpack;
    }
    return format && !hs_fail(err, HS_ERR_INPUT, "%s: is %s; host_sim reads MetaImage (.mha, .mhd): %s", path,
                              format, how);
}

enum { FIRST_BYTES = 1 << 16, MAX_BYTES = 1 << 24 }; /* of a header; a long sequence needs many */

#define NAME(id, name) {name, HS_MET_F_##id},
static const struct {
    const char *name;
    hs_met_field id;
} names[] = {HS_MET_FIELDS(NAME){"Rotation", HS_MET_F_TRANSFORM},
             {"Orientation", HS_MET_F_TRANSFORM},
             {"Position", HS_MET_F_OFFSET},
             {"Origin", HS_MET_F_OFFSET}};

static const char frame_prefix[] = "Seq_Frame";

void hs_met_shown(const char *value, char out[HS_MET_SHOWN_BYTES]) {
    size_t n = 0;
    for (; value[n] && n + 1 < HS_MET_SHOWN_BYTES; n++)
        out[n] = isprint((unsigned char)value[n]) ? value[n] : '?';
    out[n] = '\0';
    if (value[n]) memcpy(out + HS_MET_SHOWN_BYTES - 4, "...", 4);
}

bool hs_met_bad(const hs_met_text *text, const hs_met_value *value, const char *expected) {
    char name[HS_MET_SHOWN_BYTES], shown[HS_MET_SHOWN_BYTES];
    hs_met_shown(value->name, name);
    hs_met_shown(value->value, shown);
    return hs_fail(text->err, HS_ERR_INPUT, "%s:%u: %s is '%s', expected %s", text->path, value->line, name,
                   shown, expected);
}

bool hs_met_wrong(const hs_met_text *text, const hs_met_value *value, const char *reason) {
    char name[HS_MET_SHOWN_BYTES];
    hs_met_shown(value->name, name);
    return hs_fail(text->err, HS_ERR_INPUT, "%s:%u: %s: %s", text->path, value->line, name, reason);
}

bool hs_met_bad_value(const hs_met_text *text, hs_met_field id, const char *expected) {
    return hs_met_bad(text, &text->fields[id], expected);
}

bool hs_met_missing(const hs_met_text *text, hs_met_field id) {
    return hs_fail(text->err, HS_ERR_INPUT, "%s: %s is missing", text->path, names[id].name);
}

bool hs_met_has(const hs_met_text *text, hs_met_field id) {
    return text->fields[id].line != 0;
}

bool hs_met_at_end(const char *value) {
    while (isspace((unsigned char)*value)) value++;
    return *value == '\0';
}

bool hs_met_unsigned(const char **value, uint64_t *out) {
    const char *s = *value;
    while (isspace((unsigned char)*s)) s++;
    if (!isdigit((unsigned char)*s)) return false;
    char *end;
    errno = 0;
    *out = strtoull(s, &end, 10);
    *value = end;
    return errno == 0 && (*end == '\0' || isspace((unsigned char)*end));
}

bool hs_met_number(const char **value, double *out) {
    char *end;
    *out = strtod(*value, &end);
    /* Other readers know no hexadecimal numbers: one file would have two spacings. */
    const bool decimal = strcspn(*value, "xX") >= (size_t)(end - *value);
    const bool ok =
        end != *value && decimal && isfinite(*out) && (*end == '\0' || isspace((unsigned char)*end));
    *value = end;
    return ok;
}

bool hs_met_bool(const hs_met_text *text, hs_met_field id, bool absent, bool *out) {
    *out = absent;
    if (!hs_met_has(text, id)) return true;
    const char *v = text->fields[id].value;
    const bool yes = strcasecmp(v, "true") == 0 || strcmp(v, "1") == 0 || strcasecmp(v, "t") == 0;
    const bool no = strcasecmp(v, "false") == 0 || strcmp(v, "0") == 0 || strcasecmp(v, "f") == 0;
    *out = yes;
    return yes || no || hs_met_bad_value(text, id, "True or False");
}

/* Keeps the field if it is a used one. */
static bool keep_field(hs_met_text *t, const hs_met_value *found) {
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(found->name, names[i].name) != 0) continue;
        hs_met_value *field = &t->fields[names[i].id];
        if (field->line != 0)
            return hs_fail(t->err, HS_ERR_INPUT, "%s:%u: %s is given a second time, first in line %u",
                           t->path, found->line, found->name, field->line);
        *field = *found;
        return true;
    }
    if (strncmp(found->name, frame_prefix, strlen(frame_prefix)) != 0) return true;
    if ((t->frame_count & (t->frame_count - 1)) == 0) { /* room doubles whenever it is full */
        hs_met_value *more = realloc(t->frames, (t->frame_count ? 2 * t->frame_count : 1) * sizeof *more);
        if (!more) return hs_fail(t->err, HS_ERR_MEMORY, "%s: no memory to read the header", t->path);
        t->frames = more;
    }
    t->frames[t->frame_count++] = *found;
    return true;
}

/* Cuts a line into field and value; `start` is a string. */
static bool split_line(const hs_met_text *t, char *start, unsigned line, hs_met_value *out) {
    char *mark = start + strcspn(start, "=:");
    if (*mark == '\0')
        return hs_fail(t->err, HS_ERR_INPUT, "%s:%u: expected 'Field = value': this is no MetaImage header",
                       t->path, line);
    char *value = mark + 1;
    for (*mark = '\0'; mark > start && isspace((unsigned char)mark[-1]);) *--mark = '\0';
    while (isspace((unsigned char)*start)) start++;
    while (isspace((unsigned char)*value)) value++;
    for (size_t n = strlen(value); n > 0 && isspace((unsigned char)value[n - 1]); n--) value[n - 1] = '\0';
    *out = (hs_met_value){start, value, line};
    return true;
}

/* Collects the used fields of the text, which ends with the line of ElementDataFile. The text is cut into
 * strings in place. */
static bool split_lines(hs_met_text *t, size_t bytes) {
    size_t at = 0;
    for (unsigned line = 1; at < bytes; line++) {
        char *start = t->text + at;
        char *newline = memchr(start, '\n', bytes - at);
        const size_t length = newline ? (size_t)(newline - start) : bytes - at;
        at += length + (newline ? 1 : 0);
        if (memchr(start, '\0', length))
            return hs_fail(t->err, HS_ERR_INPUT, "%s:%u: holds a zero byte: this is no MetaImage header",
                           t->path, line);
        start[length] = '\0';
        if (hs_met_at_end(start)) continue;
        hs_met_value found;
        if (!split_line(t, start, line, &found) || !keep_field(t, &found)) return false;
        t->bytes = at;
        if (hs_met_has(t, HS_MET_F_DATA_FILE)) return true;
    }
    if (bytes == MAX_BYTES)
        return hs_fail(t->err, HS_ERR_INPUT, "%s: ElementDataFile is missing in the first %d bytes", t->path,
                       MAX_BYTES);
    return hs_met_missing(t, HS_MET_F_DATA_FILE);
}

/* True if more of the file is worth reading: so far it is text, without the last field. */
static bool goes_on(const char *text, size_t bytes) {
    static const char last[] = "ElementDataFile";
    if (memchr(text, '\0', bytes)) return false;
    for (size_t at = 0; at + sizeof last <= bytes; at++) {
        while (at < bytes && isspace((unsigned char)text[at])) at++;
        if (bytes - at >= sizeof last && memcmp(text + at, last, sizeof last - 1) == 0) {
            const char *newline = memchr(text + at, '\n', bytes - at);
            return newline == NULL; /* its line may be cut */
        }
        const char *newline = memchr(text + at, '\n', bytes - at);
        if (!newline) return true;
        at = (size_t)(newline - text);
    }
    return true;
}

/* A piece of the file first, since nearly all headers are short; twice as much until all of the text is
 * there. */
static bool read_bytes(hs_met_text *t, FILE *file, size_t *bytes) {
    *bytes = 0;
    for (size_t room = FIRST_BYTES; room <= MAX_BYTES; room *= 2) {
        char *more = realloc(t->text, room + 1);
        if (!more) return hs_fail(t->err, HS_ERR_MEMORY, "%s: no memory to read the header", t->path);
        t->text = more;
        const size_t got = fread(t->text + *bytes, 1, room - *bytes, file);
        *bytes += got;
        if (ferror(file))
            return hs_fail(t->err, HS_ERR_INPUT, "%s: cannot be read: %s", t->path, strerror(errno));
        if (*bytes < room || !goes_on(t->text, *bytes)) break;
    }
    t->text[*bytes] = '\0';
    return true;
}

bool hs_met_text_read(hs_met_text *text, const char *path, const char *folder, hs_error *err) {
    *text = (hs_met_text){.path = path, .err = err};
    uint64_t file_bytes = 0;
    size_t bytes = 0;
    if (sys_is_folder(path))
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: is a folder; 'smartvis clip' of the Python package reads one with a DICOM series",
                       path);
    FILE *file = hs_input_open_within((hs_input_bounds){NULL, folder}, path, path, &file_bytes, err);
    if (!file) return false;
    const bool ok = read_bytes(text, file, &bytes) && !is_foreign(path, text->text, bytes, err) &&
                    split_lines(text, bytes);
    (void)fclose(file);
    return ok;
}

void hs_met_text_free(hs_met_text *text) {
    free(text->text);
    free(text->frames);
    *text = (hs_met_text){0};
}
