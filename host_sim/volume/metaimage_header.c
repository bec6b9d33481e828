/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_header.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_HEADER_BYTES = 65536, SHOWN_BYTES = 64 };

/* The fields that are used. All others are skipped unseen. */
typedef enum {
    F_OBJECT_TYPE,
    F_NDIMS,
    F_DIM_SIZE,
    F_ELEMENT_TYPE,
    F_ELEMENT_SPACING,
    F_ELEMENT_SIZE,
    F_CHANNELS,
    F_BINARY,
    F_BINARY_MSB,
    F_ELEMENT_MSB,
    F_COMPRESSED,
    F_COMPRESSED_SIZE,
    F_HEADER_SIZE,
    F_DATA_FILE,
    F_COUNT
} field_id;

static const char *const field_names[F_COUNT] = {"ObjectType",
                                                 "NDims",
                                                 "DimSize",
                                                 "ElementType",
                                                 "ElementSpacing",
                                                 "ElementSize",
                                                 "ElementNumberOfChannels",
                                                 "BinaryData",
                                                 "BinaryDataByteOrderMSB",
                                                 "ElementByteOrderMSB",
                                                 "CompressedData",
                                                 "CompressedDataSize",
                                                 "HeaderSize",
                                                 "ElementDataFile"};

/* One used field as it stands in the text; line 0: it is missing. */
typedef struct {
    const char *value;
    unsigned line;
} field;

typedef struct {
    const char *path;
    field fields[F_COUNT];
    hs_error *err;
} parser;

static const struct {
    const char *name;
    hs_met_type type;
    uint32_t bytes;
} element_types[] = {
    {"MET_CHAR", HS_MET_CHAR, 1},
    {"MET_UCHAR", HS_MET_UCHAR, 1},
    {"MET_SHORT", HS_MET_SHORT, 2},
    {"MET_USHORT", HS_MET_USHORT, 2},
    {"MET_INT", HS_MET_INT, 4},
    {"MET_UINT", HS_MET_UINT, 4},
    {"MET_LONG", HS_MET_INT, 4},
    {"MET_ULONG", HS_MET_UINT, 4}, /* 4 bytes in a file, on any machine */
    {"MET_LONG_LONG", HS_MET_LONG_LONG, 8},
    {"MET_ULONG_LONG", HS_MET_ULONG_LONG, 8},
    {"MET_FLOAT", HS_MET_FLOAT, 4},
    {"MET_DOUBLE", HS_MET_DOUBLE, 8},
};

/* Makes a value fit for a one-line message. */
static const char *shown(const char *value, char out[SHOWN_BYTES]) {
    size_t n = 0;
    for (; value[n] && n + 1 < SHOWN_BYTES; n++) out[n] = isprint((unsigned char)value[n]) ? value[n] : '?';
    out[n] = '\0';
    if (value[n]) memcpy(out + SHOWN_BYTES - 4, "...", 4);
    return out;
}

/* "<file>:<line>: <Field> is '<value>', expected <expected>" */
static bool bad_value(const parser *p, field_id id, const char *expected) {
    char text[SHOWN_BYTES];
    return hs_fail(p->err, HS_ERR_INPUT, "%s:%u: %s is '%s', expected %s", p->path, p->fields[id].line,
                   field_names[id], shown(p->fields[id].value, text), expected);
}

static bool missing(const parser *p, field_id id) {
    return hs_fail(p->err, HS_ERR_INPUT, "%s: %s is missing", p->path, field_names[id]);
}

/* True at the end of a value. */
static bool at_end(const char *text) {
    while (isspace((unsigned char)*text)) text++;
    return *text == '\0';
}

/* Reads a decimal number without sign. */
static bool read_unsigned(const char **text, uint64_t *out) {
    const char *s = *text;
    while (isspace((unsigned char)*s)) s++;
    if (!isdigit((unsigned char)*s)) return false;
    char *end;
    errno = 0;
    *out = strtoull(s, &end, 10);
    *text = end;
    return errno == 0 && (*end == '\0' || isspace((unsigned char)*end));
}

/* True, False, 1 or 0, as MetaIO has it: the first letter tells. */
static bool get_bool(const parser *p, field_id id, bool absent, bool *out) {
    *out = absent;
    if (p->fields[id].line == 0) return true;
    const char *v = p->fields[id].value;
    const bool yes = strcasecmp(v, "true") == 0 || strcmp(v, "1") == 0 || strcasecmp(v, "t") == 0;
    const bool no = strcasecmp(v, "false") == 0 || strcmp(v, "0") == 0 || strcasecmp(v, "f") == 0;
    *out = yes;
    return yes || no || bad_value(p, id, "True or False");
}

/* Collects the used fields of the text, which ends with the line of ElementDataFile; *end is where that line
 * ends. The text is cut into strings in place. */
static bool split_lines(parser *p, char *text, size_t bytes, size_t *end) {
    size_t at = 0;
    for (unsigned line = 1; at < bytes; line++) {
        char *start = text + at;
        char *newline = memchr(start, '\n', bytes - at);
        const size_t length = newline ? (size_t)(newline - start) : bytes - at;
        at += length + (newline ? 1 : 0);
        if (memchr(start, '\0', length))
            return hs_fail(p->err, HS_ERR_INPUT, "%s:%u: holds a zero byte: this is no MetaImage header",
                           p->path, line);
        start[length] = '\0';
        if (at_end(start)) continue;
        char *mark = start + strcspn(start, "=:");
        if (*mark == '\0')
            return hs_fail(p->err, HS_ERR_INPUT,
                           "%s:%u: expected 'Field = value': this is no MetaImage header", p->path, line);
        char *value = mark + 1;
        for (*mark = '\0'; mark > start && isspace((unsigned char)mark[-1]);) *--mark = '\0';
        while (isspace((unsigned char)*start)) start++;
        while (isspace((unsigned char)*value)) value++;
        for (size_t n = strlen(value); n > 0 && isspace((unsigned char)value[n - 1]); n--)
            value[n - 1] = '\0';
        for (int id = 0; id < F_COUNT; id++) {
            if (strcmp(start, field_names[id]) != 0) continue;
            if (p->fields[id].line != 0)
                return hs_fail(p->err, HS_ERR_INPUT, "%s:%u: %s is given a second time, first in line %u",
                               p->path, line, field_names[id], p->fields[id].line);
            p->fields[id] = (field){value, line};
        }
        *end = at;
        if (p->fields[F_DATA_FILE].line != 0) return true;
    }
    if (bytes == MAX_HEADER_BYTES)
        return hs_fail(p->err, HS_ERR_INPUT, "%s: ElementDataFile is missing in the first %d bytes", p->path,
                       MAX_HEADER_BYTES);
    return missing(p, F_DATA_FILE);
}

static bool check_dims(const parser *p, hs_met_header *h) {
    uint64_t dims = 0;
    if (p->fields[F_NDIMS].line == 0) return missing(p, F_NDIMS);
    const char *text = p->fields[F_NDIMS].value;
    if (!read_unsigned(&text, &dims) || !at_end(text) || (dims != 3 && dims != 4))
        return bad_value(p, F_NDIMS, "3 (a volume; or 4 with a last DimSize of 1)");
    if (p->fields[F_DIM_SIZE].line == 0) return missing(p, F_DIM_SIZE);
    h->dim_line = p->fields[F_DIM_SIZE].line;
    text = p->fields[F_DIM_SIZE].value;
    uint64_t voxels = 1;
    for (uint64_t axis = 0; axis < dims; axis++) {
        uint64_t n = 0;
        const bool is_number = read_unsigned(&text, &n);
        if (axis == 3) {
            if (!is_number || n != 1) return bad_value(p, F_DIM_SIZE, "a fourth size of 1");
            continue;
        }
        if (!is_number || n < 1 || n > HS_VOLUME_MAX_AXIS)
            return bad_value(p, F_DIM_SIZE, "one number per dimension, each 1 .. 2048");
        h->size[axis] = (uint32_t)n;
        voxels *= n;
    }
    if (!at_end(text)) return bad_value(p, F_DIM_SIZE, "as many numbers as NDims");
    if (voxels > HS_VOLUME_MAX_VOXELS) return bad_value(p, F_DIM_SIZE, "at most 2147483648 voxels in all");
    return true;
}

static bool check_spacing(const parser *p, hs_met_header *h) {
    for (int axis = 0; axis < 3; axis++) h->spacing[axis] = 1.0;
    const field_id id = p->fields[F_ELEMENT_SPACING].line != 0 ? F_ELEMENT_SPACING : F_ELEMENT_SIZE;
    if (p->fields[id].line == 0) return true;
    const char *text = p->fields[id].value;
    for (int axis = 0; axis < 3; axis++) {
        char *end;
        const double mm = strtod(text, &end);
        if (end == text || !isfinite(mm) || mm <= 0.0) return bad_value(p, id, "three numbers above 0 (mm)");
        h->spacing[axis] = mm;
        text = end;
    }
    return true;
}

static bool check_type(const parser *p, hs_met_header *h) {
    if (p->fields[F_ELEMENT_TYPE].line == 0) return missing(p, F_ELEMENT_TYPE);
    const char *value = p->fields[F_ELEMENT_TYPE].value;
    for (size_t i = 0; i < sizeof element_types / sizeof *element_types; i++) {
        if (strcmp(value, element_types[i].name) != 0) continue;
        h->type = element_types[i].type;
        h->type_name = element_types[i].name;
        h->element_bytes = element_types[i].bytes;
        return true;
    }
    return bad_value(p, F_ELEMENT_TYPE,
                     "MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_UINT, MET_INT, MET_ULONG, MET_LONG, "
                     "MET_ULONG_LONG, MET_LONG_LONG, MET_FLOAT or MET_DOUBLE");
}

/* Object, channels, binary, byte order, compression. */
static bool check_encoding(const parser *p, hs_met_header *h) {
    const field *f = p->fields;
    if (f[F_OBJECT_TYPE].line != 0 && strcmp(f[F_OBJECT_TYPE].value, "Image") != 0)
        return bad_value(p, F_OBJECT_TYPE, "Image");
    if (f[F_CHANNELS].line != 0 && strcmp(f[F_CHANNELS].value, "1") != 0)
        return bad_value(p, F_CHANNELS, "1 (gray voxels)");
    bool binary, element_msb;
    if (!get_bool(p, F_BINARY, true, &binary)) return false;
    if (!binary) return bad_value(p, F_BINARY, "True (voxels as text are not read)");
    if (!get_bool(p, F_BINARY_MSB, false, &h->big_endian)) return false;
    if (!get_bool(p, F_ELEMENT_MSB, h->big_endian, &element_msb)) return false;
    if (f[F_BINARY_MSB].line != 0 && element_msb != h->big_endian)
        return bad_value(p, F_ELEMENT_MSB, "the same as BinaryDataByteOrderMSB");
    h->big_endian = element_msb;
    if (!get_bool(p, F_COMPRESSED, false, &h->compressed)) return false;
    h->compressed_size_line = f[F_COMPRESSED_SIZE].line;
    h->has_compressed_size = h->compressed && h->compressed_size_line != 0;
    if (h->has_compressed_size) {
        const char *text = f[F_COMPRESSED_SIZE].value;
        if (!read_unsigned(&text, &h->compressed_size) || !at_end(text))
            return bad_value(p, F_COMPRESSED_SIZE, "a number of bytes");
    }
    return true;
}

/* ElementDataFile and HeaderSize. */
static bool check_data_file(const parser *p, hs_met_header *h) {
    const char *name = p->fields[F_DATA_FILE].value;
    h->data_line = p->fields[F_DATA_FILE].line;
    (void)shown(name, h->data_name);
    h->local = strcmp(name, "LOCAL") == 0 || strcmp(name, "Local") == 0 || strcmp(name, "local") == 0;
    if (*name == '\0' || strncmp(name, "LIST", 4) == 0 || strchr(name, '%'))
        return bad_value(p, F_DATA_FILE, "LOCAL or the name of one file");
    const char *slash = strrchr(p->path, '/');
    const int folder = slash && name[0] != '/' ? (int)(slash - p->path + 1) : 0;
    const int length = h->local
                           ? snprintf(h->data_path, sizeof h->data_path, "%s", p->path)
                           : snprintf(h->data_path, sizeof h->data_path, "%.*s%s", folder, p->path, name);
    if (length < 0 || (size_t)length >= sizeof h->data_path)
        return bad_value(p, F_DATA_FILE, "a shorter path");

    h->header_size = h->local ? h->local_start : 0;
    h->header_size_line = p->fields[F_HEADER_SIZE].line;
    if (h->header_size_line == 0) return true;
    const char *text = p->fields[F_HEADER_SIZE].value;
    uint64_t bytes = 0;
    h->header_from_end = strcmp(text, "-1") == 0;
    if (h->header_from_end)
        return !h->compressed ||
               bad_value(p, F_HEADER_SIZE, "a number of bytes, since CompressedData is True");
    if (!read_unsigned(&text, &bytes) || !at_end(text))
        return bad_value(p, F_HEADER_SIZE, "a number of bytes, or -1");
    if (h->local && bytes > 0 && bytes < h->local_start)
        return bad_value(p, F_HEADER_SIZE,
                         "0, -1 or the length of the text at least, since the data is LOCAL");
    if (bytes > 0) h->header_size = bytes;
    return true;
}

FILE *hs_met_open(const char *path, const char *context, uint64_t *bytes, hs_error *err) {
    const int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat status;
    if (descriptor < 0 || fstat(descriptor, &status) != 0) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", context, strerror(errno));
    } else if (!S_ISREG(status.st_mode)) {
        hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: not a regular file", context);
    } else {
        *bytes = (uint64_t)status.st_size;
        FILE *file = fdopen(descriptor, "rb");
        if (file) return file;
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the file", context);
    }
    if (descriptor >= 0) (void)close(descriptor);
    return NULL;
}

bool hs_met_header_read(const char *path, hs_met_header *header, hs_error *err) {
    memset(header, 0, sizeof *header);
    uint64_t file_bytes = 0;
    FILE *file = hs_met_open(path, path, &file_bytes, err);
    if (!file) return false;
    char *text = malloc(MAX_HEADER_BYTES + 1);
    parser p = {.path = path, .err = err};
    bool ok = text != NULL || hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the header", path);
    if (ok) {
        const size_t bytes = fread(text, 1, MAX_HEADER_BYTES, file);
        size_t end = 0;
        if (ferror(file)) ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
        ok = ok && split_lines(&p, text, bytes, &end);
        header->local_start = end;
        ok = ok && check_dims(&p, header) && check_spacing(&p, header) && check_type(&p, header) &&
             check_encoding(&p, header) && check_data_file(&p, header);
    }
    free(text);
    (void)fclose(file);
    return ok;
}
