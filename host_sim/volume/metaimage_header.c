/* SPDX-License-Identifier: MIT */
/* What a MetaImage header says, checked: sizes, types, encoding, data file, and how the volume lies. */
#include "core/system.h"
#include "volume/metaimage.h"
#include "volume/metaimage_parts.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const struct {
    const char *name;
    uint32_t bytes;
} types[HS_MET_TYPES] = {
    [HS_MET_CHAR] = {"MET_CHAR", 1},
    [HS_MET_UCHAR] = {"MET_UCHAR", 1},
    [HS_MET_SHORT] = {"MET_SHORT", 2},
    [HS_MET_USHORT] = {"MET_USHORT", 2},
    [HS_MET_INT] = {"MET_INT", 4},
    [HS_MET_UINT] = {"MET_UINT", 4},
    [HS_MET_LONG_LONG] = {"MET_LONG_LONG", 8},
    [HS_MET_ULONG_LONG] = {"MET_ULONG_LONG", 8},
    [HS_MET_FLOAT] = {"MET_FLOAT", 4},
    [HS_MET_DOUBLE] = {"MET_DOUBLE", 8},
};

const char *hs_met_type_name(hs_met_type type) {
    return types[type].name;
}

uint32_t hs_met_type_bytes(hs_met_type type) {
    return types[type].bytes;
}

static bool check_dims(const hs_met_text *p, hs_met_header *h) {
    uint64_t dims = 0;
    if (!hs_met_has(p, HS_MET_F_NDIMS)) return hs_met_missing(p, HS_MET_F_NDIMS);
    const char *text = p->fields[HS_MET_F_NDIMS].value;
    if (!hs_met_unsigned(&text, &dims) || !hs_met_at_end(text) || (dims != 3 && dims != 4))
        return hs_met_bad_value(p, HS_MET_F_NDIMS, "3 (a volume) or 4 (a sequence of volumes)");
    if (!hs_met_has(p, HS_MET_F_DIM_SIZE)) return hs_met_missing(p, HS_MET_F_DIM_SIZE);
    h->dim_line = p->fields[HS_MET_F_DIM_SIZE].line;
    text = p->fields[HS_MET_F_DIM_SIZE].value;
    h->dims = (uint32_t)dims;
    h->frames = 1;
    uint64_t voxels = 1;
    for (uint64_t axis = 0; axis < dims; axis++) {
        uint64_t n = 0;
        const bool is_number = hs_met_unsigned(&text, &n);
        if (axis == 3) {
            if (!is_number || n < 1 || n > HS_MET_MAX_FRAMES)
                return hs_met_bad_value(p, HS_MET_F_DIM_SIZE, "a fourth size of 1 .. 100000 volumes");
            h->frames = (uint32_t)n;
            continue;
        }
        if (!is_number || n < 1 || n > HS_VOLUME_MAX_AXIS)
            return hs_met_bad_value(p, HS_MET_F_DIM_SIZE, "one number per dimension, each 1 .. 2048");
        h->size[axis] = (uint32_t)n;
        voxels *= n;
    }
    if (!hs_met_at_end(text)) return hs_met_bad_value(p, HS_MET_F_DIM_SIZE, "as many numbers as NDims");
    (void)snprintf(h->size_text, sizeof h->size_text, dims == 4 ? "%u %u %u %u" : "%u %u %u", h->size[0],
                   h->size[1], h->size[2], h->frames);
    if (voxels > HS_VOLUME_MAX_VOXELS)
        return hs_met_bad_value(p, HS_MET_F_DIM_SIZE, "at most 2147483648 voxels in all");
    return true;
}

static bool check_unit(const hs_met_text *p, hs_met_header *h) {
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"um", 0.001}, {"?", 1.0}};
    h->unit = 1.0;
    if (!hs_met_has(p, HS_MET_F_DISTANCE_UNITS)) return true;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(p->fields[HS_MET_F_DISTANCE_UNITS].value, units[i].name) == 0) {
            h->unit = units[i].mm;
            return true;
        }
    return hs_met_bad_value(p, HS_MET_F_DISTANCE_UNITS, "mm, cm, m, um or ?");
}

#define MIN_SPACING 1e-6 /* mm: below and above, sizes are no longer numbers in single precision */
#define MAX_SPACING 1e6

static bool read_length(const char **text, double unit, double *mm) {
    const bool is_number = hs_met_number(text, mm);
    *mm *= unit;
    return is_number;
}

/* One number an axis. In four dimensions the last is no length, and some programs leave it out. */
static bool check_spacing(const hs_met_text *p, hs_met_header *h) {
    for (int axis = 0; axis < 3; axis++) h->spacing[axis] = 1.0;
    const hs_met_field id =
        hs_met_has(p, HS_MET_F_ELEMENT_SPACING) ? HS_MET_F_ELEMENT_SPACING : HS_MET_F_ELEMENT_SIZE;
    if (!hs_met_has(p, id)) return true;
    h->spacing_stated = true;
    const char *text = p->fields[id].value;
    double rest;
    for (int axis = 0; axis < 3; axis++)
        if (!read_length(&text, h->unit, &h->spacing[axis]) || h->spacing[axis] < MIN_SPACING ||
            h->spacing[axis] > MAX_SPACING)
            return hs_met_bad_value(p, id, "three numbers above 0 (mm), 1e-6 .. 1e6");
    if (h->dims == 4 && !hs_met_at_end(text) && !hs_met_number(&text, &rest))
        return hs_met_bad_value(p, id, "a fourth number");
    return hs_met_at_end(text) || hs_met_bad_value(p, id, "as many numbers as NDims");
}

static bool check_type(const hs_met_text *p, hs_met_header *h) {
    if (!hs_met_has(p, HS_MET_F_ELEMENT_TYPE)) return hs_met_missing(p, HS_MET_F_ELEMENT_TYPE);
    const char *value = p->fields[HS_MET_F_ELEMENT_TYPE].value;
    /* 4 bytes in a file, on any machine. */
    const char *name = strcmp(value, "MET_LONG") == 0    ? "MET_INT"
                       : strcmp(value, "MET_ULONG") == 0 ? "MET_UINT"
                                                         : value;
    for (int type = 0; type < HS_MET_TYPES; type++) {
        if (strcmp(name, hs_met_type_name((hs_met_type)type)) != 0) continue;
        h->type = (hs_met_type)type;
        h->type_name = hs_met_type_name(h->type);
        h->element_bytes = hs_met_type_bytes(h->type);
        return true;
    }
    return hs_met_bad_value(
        p, HS_MET_F_ELEMENT_TYPE,
        "MET_UCHAR, MET_CHAR, MET_USHORT, MET_SHORT, MET_UINT, MET_INT, MET_ULONG, MET_LONG, "
        "MET_ULONG_LONG, MET_LONG_LONG, MET_FLOAT or MET_DOUBLE");
}

/* Object, channels, binary, byte order, compression. */
static bool check_encoding(const hs_met_text *p, hs_met_header *h) {
    const hs_met_value *f = p->fields;
    if (f[HS_MET_F_OBJECT_TYPE].line != 0 && strcmp(f[HS_MET_F_OBJECT_TYPE].value, "Image") != 0)
        return hs_met_bad_value(p, HS_MET_F_OBJECT_TYPE, "Image");
    uint64_t channels = 1;
    const char *number = hs_met_has(p, HS_MET_F_CHANNELS) ? f[HS_MET_F_CHANNELS].value : "1";
    if (!hs_met_unsigned(&number, &channels) || !hs_met_at_end(number) ||
        (channels != 1 && channels != 3 && channels != 4))
        return hs_met_bad_value(p, HS_MET_F_CHANNELS, "1 (gray voxels), or 3 or 4 that are alike");
    h->channels = (uint32_t)channels;
    bool binary, element_msb;
    if (!hs_met_bool(p, HS_MET_F_BINARY, true, &binary)) return false;
    if (!binary) return hs_met_bad_value(p, HS_MET_F_BINARY, "True (voxels as text are not read)");
    if (!hs_met_bool(p, HS_MET_F_BINARY_MSB, false, &h->big_endian)) return false;
    if (!hs_met_bool(p, HS_MET_F_ELEMENT_MSB, h->big_endian, &element_msb)) return false;
    if (f[HS_MET_F_BINARY_MSB].line != 0 && element_msb != h->big_endian)
        return hs_met_bad_value(p, HS_MET_F_ELEMENT_MSB, "the same as BinaryDataByteOrderMSB");
    h->big_endian = element_msb;
    if (!hs_met_bool(p, HS_MET_F_COMPRESSED, false, &h->compressed)) return false;
    h->compressed_size_line = f[HS_MET_F_COMPRESSED_SIZE].line;
    h->has_compressed_size = h->compressed && h->compressed_size_line != 0;
    if (h->has_compressed_size) {
        const char *text = f[HS_MET_F_COMPRESSED_SIZE].value;
        if (!hs_met_unsigned(&text, &h->compressed_size) || !hs_met_at_end(text))
            return hs_met_bad_value(p, HS_MET_F_COMPRESSED_SIZE, "a number of bytes");
    }
    return true;
}

/* True for a file in the header's folder or below it. A header from elsewhere must not make a picture of any
 * file that its reader can read. */
static bool is_near(const char *name) {
    bool near = !sys_is_absolute(name);
    for (const char *part = name; near && part; part = strpbrk(part, sys_separators)) {
        part += part > name;
        near = strncmp(part, "..", 2) != 0 || strcspn(part, sys_separators) != 2;
    }
    return near;
}

/* Checks ElementDataFile and HeaderSize. */
static bool check_data_file(const hs_met_text *p, hs_met_header *h) {
    const char *name = p->fields[HS_MET_F_DATA_FILE].value;
    h->data_line = p->fields[HS_MET_F_DATA_FILE].line;
    hs_met_shown(name, h->data_name);
    h->local = strcmp(name, "LOCAL") == 0 || strcmp(name, "Local") == 0 || strcmp(name, "local") == 0;
    if (strchr(name, '%'))
        return hs_met_bad_value(p, HS_MET_F_DATA_FILE,
                                "a name without %, which MetaImage takes for a pattern of many names");
    if (*name == '\0' || strncmp(name, "LIST", 4) == 0)
        return hs_met_bad_value(p, HS_MET_F_DATA_FILE, "LOCAL or the name of one file");
    if (!is_near(name))
        return hs_met_bad_value(p, HS_MET_F_DATA_FILE, "a file in the header's folder or below");
    const char *slash = strrchr(p->path, '/');
    const int folder = slash ? (int)(slash - p->path + 1) : 0;
    const int length = h->local
                           ? snprintf(h->data_path, sizeof h->data_path, "%s", p->path)
                           : snprintf(h->data_path, sizeof h->data_path, "%.*s%s", folder, p->path, name);
    if (length < 0 || (size_t)length >= sizeof h->data_path)
        return hs_met_bad_value(p, HS_MET_F_DATA_FILE, "a shorter path");

    h->header_size = h->local ? h->local_start : 0;
    h->header_size_line = p->fields[HS_MET_F_HEADER_SIZE].line;
    if (h->header_size_line == 0) return true;
    const char *text = p->fields[HS_MET_F_HEADER_SIZE].value;
    uint64_t bytes = 0;
    h->header_from_end = strcmp(text, "-1") == 0;
    if (h->header_from_end)
        return !h->compressed ||
               hs_met_bad_value(p, HS_MET_F_HEADER_SIZE, "a number of bytes, since CompressedData is True");
    if (!hs_met_unsigned(&text, &bytes) || !hs_met_at_end(text))
        return hs_met_bad_value(p, HS_MET_F_HEADER_SIZE, "a number of bytes, or -1");
    if (h->local && bytes > 0 && bytes < h->local_start)
        return hs_met_bad_value(p, HS_MET_F_HEADER_SIZE,
                                "0, -1 or the length of the text at least, since the data is LOCAL");
    if (bytes > 0) h->header_size = bytes;
    return true;
}

/* Reads `count` numbers, or as many as `other` if there are no more; *found tells. Nothing may follow. */
static bool read_numbers(const char *value, uint64_t count, uint64_t other, double *out, uint64_t *found) {
    for (*found = 0; *found < count; ++*found) {
        if (*found == other && hs_met_at_end(value)) return true;
        if (!hs_met_number(&value, &out[*found])) return false;
    }
    return hs_met_at_end(value);
}

#define SKEW 1e-3

/* The file lists one axis' direction after the other: the columns of our matrix. In four dimensions the
 * fourth axis must be apart from the others; some programs leave it out. */
static bool read_directions(const hs_met_text *text, uint64_t dims, hs_pose *pose) {
    double file[16] = {0};
    uint64_t found;
    const bool numbers = read_numbers(text->fields[HS_MET_F_TRANSFORM].value, dims * dims, 9, file, &found);
    const uint64_t row = found == 16 ? 4 : 3;
    bool apart = true;
    for (int axis = 0; numbers && axis < 3; axis++) {
        for (int k = 0; k < 3; k++) pose->direction[k * 3 + axis] = file[(uint64_t)axis * row + (uint64_t)k];
        apart = apart && (row == 3 || (file[axis * 4 + 3] == 0 && file[12 + axis] == 0));
    }
    if (!numbers)
        return hs_met_bad_value(text, HS_MET_F_TRANSFORM, dims == 3 ? "9 numbers" : "16 numbers, or 9");
    if (!apart)
        return hs_met_bad_value(text, HS_MET_F_TRANSFORM, "a fourth axis that has no part in the others");
    return hs_pose_is_right_angled(pose->direction, SKEW) ||
           hs_met_bad_value(text, HS_MET_F_TRANSFORM,
                            "three directions of length 1 at right angles to each other");
}

static bool read_offset(const hs_met_text *text, uint64_t dims, double unit, hs_pose *pose) {
    double file[4] = {0};
    uint64_t found;
    if (!hs_met_has(text, HS_MET_F_OFFSET)) return true;
    if (!read_numbers(text->fields[HS_MET_F_OFFSET].value, dims, 3, file, &found))
        return hs_met_bad_value(text, HS_MET_F_OFFSET, dims == 3 ? "3 numbers (mm)" : "4 numbers, or 3 (mm)");
    for (int axis = 0; axis < 3; axis++) {
        pose->origin[axis] = file[axis] * unit;
        if (!isfinite(pose->origin[axis])) return hs_met_bad_value(text, HS_MET_F_OFFSET, "smaller numbers");
    }
    return true;
}

/*
 * TransformMatrix, Offset (each with its other names) and AnatomicalOrientation, of a header of `dims` (3 or
 * 4) dimensions. The matrix alone counts, as for ITK and 3D Slicer. It says how the patient lies unless it is
 * the identity, which ITK writes for whatever says nothing, or the letters are ???, or a result of ours says
 * that nobody knew.
 */
static bool check_pose(const hs_met_text *text, uint64_t dims, double unit, hs_pose *pose) {
    const bool has_matrix = hs_met_has(text, HS_MET_F_TRANSFORM);
    const char *letters =
        hs_met_has(text, HS_MET_F_ANATOMICAL) ? text->fields[HS_MET_F_ANATOMICAL].value : "";
    const bool is_unplaced =
        hs_met_has(text, HS_MET_F_NOTES) && strcmp(text->fields[HS_MET_F_NOTES].value, HS_MET_UNPLACED) == 0;
    char spatial[4] = "", own[4];
    hs_pose_default(pose);
    if ((has_matrix && !read_directions(text, dims, pose)) || !read_offset(text, dims, unit, pose))
        return false;
    pose->stated = has_matrix && !hs_pose_is_identity(pose) && *letters != '?' && !is_unplaced;
    if (*letters == '?' || *letters == '\0') return true;
    /* In four dimensions the fourth letter says nothing about space. */
    const size_t count = strlen(letters);
    hs_pose lettered = *pose;
    memcpy(spatial, letters, count < 3 ? count : 3);
    if (count < 3 || count > dims || !hs_pose_from_letters(&lettered, spatial))
        return hs_met_bad_value(text, HS_MET_F_ANATOMICAL,
                                "three letters, one of R L, one of A P and one of I S, or ???");
    hs_pose_letters(pose, own);
    if (strcasecmp(own, spatial) != 0)
        for (int i = 0; i < 3; i++) pose->contradicted[i] = (char)toupper((unsigned char)spatial[i]);
    return true;
}

/* UltrasoundImageOrientation: the axis that runs "far" from the probe, or "near" to it. "MFA" says nothing of
 * a volume: PLUS writes it into all of them, whatever way was swept. */
static bool check_probe(const hs_met_text *text, hs_probe *probe, bool *stated) {
    static const char *const kinds[3] = {"MU", "NF", "AD"};
    static const hs_probe low[3] = {HS_PROBE_LOW_X, HS_PROBE_LOW_Y, HS_PROBE_LOW_Z};
    static const hs_probe high[3] = {HS_PROBE_HIGH_X, HS_PROBE_HIGH_Y, HS_PROBE_HIGH_Z};
    *probe = HS_PROBE_LOW_Z;
    if (!hs_met_has(text, HS_MET_F_ULTRASOUND)) return true;
    const char *value = text->fields[HS_MET_F_ULTRASOUND].value;
    const size_t count = strlen(value);
    bool seen[3] = {false};
    if (strcmp(value, "MFA") == 0 || (count > 0 && strspn(value, "X") == count)) return true; /* unknown */
    bool ok = count == 3;
    for (int axis = 0; ok && axis < 3; axis++) {
        int kind = 0;
        while (kind < 3 && !strchr(kinds[kind], value[axis])) kind++;
        ok = kind < 3 && !seen[kind];
        if (ok) seen[kind] = true;
        if (kind == 1) *probe = value[axis] == 'F' ? low[axis] : high[axis];
    }
    *stated = ok;
    return ok || hs_met_bad_value(text, HS_MET_F_ULTRASOUND,
                                  "three letters, one of M U, one of N F and one of A D, or XX");
}

/* UltrasoundApex, a field of ours, of a volume whose probe is stated. */
static bool check_apex(const hs_met_text *text, hs_met_header *h) {
    uint64_t found;
    if (!hs_met_has(text, HS_MET_F_APEX)) return true;
    h->apex_said = read_numbers(text->fields[HS_MET_F_APEX].value, 3, 3, h->apex, &found) && found == 3;
    return (h->apex_said && h->probe_stated) ||
           hs_met_bad_value(text, HS_MET_F_APEX,
                            "three numbers (mm from the corner), beside UltrasoundImageOrientation");
}

bool hs_met_header_read(const char *path, const char *folder, hs_met_header *header, hs_error *err) {
    hs_met_text text;
    memset(header, 0, sizeof *header);
    bool ok = hs_met_text_read(&text, path, folder, err);
    header->local_start = text.bytes;
    ok = ok && check_dims(&text, header) && check_unit(&text, header) && check_spacing(&text, header) &&
         check_type(&text, header) && check_encoding(&text, header) && check_data_file(&text, header) &&
         check_pose(&text, header->dims, header->unit, &header->pose) &&
         check_probe(&text, &header->probe, &header->probe_stated) && check_apex(&text, header);
    ok = ok &&
         hs_met_kinds(&text, header->dims, header->spacing[2] != 1.0 || header->pose.origin[2] != 0.0) &&
         (hs_met_is_cut(&text, header->dims) || hs_met_frames(&text, header->frames, &header->fields));
    hs_met_text_free(&text);
    return ok;
}
