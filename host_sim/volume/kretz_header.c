/* SPDX-License-Identifier: MIT */
/* The items of a KRETZFILE, and what they say of its grey volume, checked. */
#include "core/input_file.h"
#include "volume/kretz_parts.h"
#include "volume/volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_BYTES 8u

static uint32_t u16_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8;
}

bool hs_kretz_items_read(const hs_kretz_items *items, uint64_t offset, void *out, size_t bytes,
                         hs_error *err) {
    const char *reason = hs_input_read_at(items->file, &offset, out, bytes);
    return !reason || hs_fail(err, HS_ERR_INPUT, "%s: byte %" PRIu64 ": cannot be read: %s", items->path,
                              offset, reason);
}

/* True for the first item of a geometry or of voxels that was written with the high byte first. */
static bool is_swapped(const uint8_t header[HEADER_BYTES]) {
    static const uint8_t groups[] = {0xC0, 0xC1, 0xC2, 0xC3, 0xD0, 0xD6};
    if (header[1] != 0x00 || header[2] > 0x0F || header[3] == 0x00) return false;
    return header[0] != 0x00 && memchr(groups, header[0], sizeof groups) != NULL;
}

bool hs_kretz_items_next(hs_kretz_items *items, hs_kretz_item *item, bool *more, hs_error *err) {
    uint8_t header[HEADER_BYTES];
    const uint64_t left = items->end - items->at;
    *more = false;
    if (left == 0 || (left == 1 && items->padded)) return true;
    if (left < HEADER_BYTES)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: byte %" PRIu64 ": %" PRIu64 " bytes are left, an item's header needs %u",
                       items->path, items->at, left, HEADER_BYTES);
    if (!hs_kretz_items_read(items, items->at, header, HEADER_BYTES, err)) return false;
    item->group = (uint16_t)u16_at(header);
    item->element = (uint16_t)u16_at(header + 2);
    item->bytes = u16_at(header + 4) | u16_at(header + 6) << 16;
    item->offset = items->at + HEADER_BYTES;
    if (item->group == 0xFFFF && item->element == 0xFFFF) return true;
    if (is_swapped(header))
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: byte %" PRIu64 ": item (%04X,%04X): its bytes are swapped, expected the low one "
                       "of a number first",
                       items->path, items->at, item->group, item->element);
    if (item->bytes > left - HEADER_BYTES)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: byte %" PRIu64 ": item (%04X,%04X) has %" PRIu32 " bytes, but %" PRIu64
                       " are left",
                       items->path, items->at, item->group, item->element, item->bytes, left - HEADER_BYTES);
    if (++items->count > HS_KRETZ_MAX_ITEMS)
        return hs_fail(err, HS_ERR_INPUT, "%s: more than %u items", items->path, HS_KRETZ_MAX_ITEMS);
    items->at = item->offset + item->bytes;
    return *more = true;
}

void hs_kretz_items_close(hs_kretz_items *items) {
    if (items->file) (void)fclose(items->file);
    *items = (hs_kretz_items){0};
}

#define MM        1e3 /* lengths are in metres */
#define PI        3.14159265358979323846
#define BANK_BITS 0x0F00u /* of an element: 0 grey, 1 colour flow, 2 power Doppler */
#define PROBE     0x10u   /* bit of the type: grey in probe geometry */

/* The items that are used. Numbers come first. */
typedef enum {
    SAMPLES,
    LINES,
    PLANES,
    TYPE,
    PITCH,
    START,
    AXIS,
    CARTESIAN_MM,
    NUMBERS,
    PHI = NUMBERS,
    THETA,
    VOXELS,
    SEQUENCE,
    COMPRESSED,
    FIELDS
} field;

static const struct {
    uint16_t group, element; /* of the grey bank */
    uint8_t bytes;           /* of a number: 2 and 4 unsigned, 8 float64; 0: an array */
    bool banked;             /* other banks have one of their own */
    const char *what;
} fields[FIELDS] = {
    [SAMPLES] = {0xC000, 0x0001, 2, true, "number of samples"},
    [LINES] = {0xC000, 0x0002, 2, true, "number of lines"},
    [PLANES] = {0xC000, 0x0003, 2, true, "number of frames"},
    [TYPE] = {0x0001, 0x0100, 4, false, "type"},
    [PITCH] = {0xC100, 0x0001, 8, true, "radial pitch"},
    [START] = {0xC200, 0x0001, 8, true, "start of the samples"},
    [AXIS] = {0xC200, 0x0002, 8, true, "place of the sweep's axis"},
    [CARTESIAN_MM] = {0x0010, 0x0022, 8, false, "Cartesian spacing"},
    [PHI] = {0xC300, 0x0001, 0, true, "sweep angles"},
    [THETA] = {0xC300, 0x0002, 0, true, "angles in the plane"},
    [VOXELS] = {0xD000, 0x0001, 0, true, "voxels"},
    [SEQUENCE] = {0xD600, 0x0001, 0, true, "voxels of a sequence"},
    [COMPRESSED] = {0x0002, 0x1000, 0, true, "compressed voxels"},
};

/* The fields of the header that were found. */
typedef struct {
    hs_kretz_items *items;
    hs_kretz_item item[FIELDS];
    bool there[FIELDS];
    double value[NUMBERS];
    bool other_bank; /* voxels of another bank were met */
} found;

/* "<path>: (C000,0001) number of samples" starts every message about a field. */
#define CONTEXT    "%s: (%04X,%04X) %s"
#define ARGS(f, w) (f)->items->path, fields[w].group, fields[w].element, fields[w].what

static uint64_t little_endian(const uint8_t *bytes, unsigned count) {
    uint64_t value = 0;
    for (unsigned i = count; i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

static double float64_of(uint64_t bits) {
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static field field_of(const hs_kretz_item *item, unsigned *bank) {
    for (int w = 0; w < FIELDS; w++) {
        const unsigned mask = fields[w].banked ? BANK_BITS : 0u;
        if (item->group != fields[w].group || (item->element & ~mask) != fields[w].element) continue;
        *bank = (item->element & mask) >> 8;
        return (field)w;
    }
    return FIELDS;
}

static bool take_number(found *f, field w, const hs_kretz_item *item, hs_error *err) {
    uint8_t bytes[8];
    if (item->bytes != fields[w].bytes)
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " has %" PRIu32 " bytes, expected %u", ARGS(f, w),
                       item->bytes, fields[w].bytes);
    if (!hs_kretz_items_read(f->items, item->offset, bytes, item->bytes, err)) return false;
    const uint64_t bits = little_endian(bytes, item->bytes);
    const double value = item->bytes == 8 ? float64_of(bits) : (double)bits;
    /* A NaN is not equal to itself, but it is refused later on, too. */
    if (f->there[w] && !(value == f->value[w]))
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " is given twice, as %.9g and as %.9g", ARGS(f, w),
                       f->value[w], value);
    f->value[w] = value;
    return true;
}

static bool take(found *f, const hs_kretz_item *item, hs_error *err) {
    unsigned bank = 0;
    const field w = field_of(item, &bank);
    if (w == FIELDS) return true;
    if (bank > 0) {
        f->other_bank |= w == VOXELS || w == SEQUENCE || w == COMPRESSED;
        return true;
    }
    if (w < NUMBERS) {
        if (!take_number(f, w, item, err)) return false;
    } else if (f->there[w] && w != COMPRESSED) {
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " are given twice", ARGS(f, w));
    }
    f->item[w] = *item;
    f->there[w] = true;
    return true;
}

static bool check_size(const found *f, hs_kretz_header *h, hs_error *err) {
    const double minimum = h->cartesian ? 1.0 : 2.0;
    uint64_t count = 1;
    for (int a = 0; a < 3; a++) {
        const field w = (field)(SAMPLES + a);
        if (!f->there[w]) return hs_fail(err, HS_ERR_INPUT, CONTEXT " is missing", ARGS(f, w));
        if (f->value[w] < minimum || f->value[w] > HS_VOLUME_MAX_AXIS)
            return hs_fail(err, HS_ERR_INPUT, CONTEXT " is %.0f, expected %.0f .. %u", ARGS(f, w),
                           f->value[w], minimum, HS_VOLUME_MAX_AXIS);
        h->size[a] = (uint32_t)f->value[w];
        count *= h->size[a];
    }
    return count < HS_VOLUME_MAX_VOXELS ||
           hs_fail(err, HS_ERR_INPUT,
                   "%s: %" PRIu32 " x %" PRIu32 " x %" PRIu32 " are %" PRIu64
                   " voxels, expected less than %" PRIu64,
                   f->items->path, h->size[0], h->size[1], h->size[2], count, HS_VOLUME_MAX_VOXELS);
}

static bool no_voxels(const found *f, hs_error *err) {
    if (f->there[COMPRESSED])
        return hs_fail(err, HS_ERR_INPUT,
                       CONTEXT " are all there is; in 4D View, re-save with wavelet compression off",
                       ARGS(f, COMPRESSED));
    return hs_fail(err, HS_ERR_INPUT, CONTEXT " are missing%s", ARGS(f, VOXELS),
                   f->other_bank ? "; the file has Doppler only" : "");
}

/* One volume, or a sequence: then it counts, and a single volume beside it is its first. */
static bool check_voxels(const found *f, hs_kretz_header *h, hs_error *err) {
    const uint64_t volume = (uint64_t)h->size[0] * h->size[1] * h->size[2];
    if (!f->there[VOXELS] && !f->there[SEQUENCE]) return no_voxels(f, err);
    if (f->there[VOXELS] && f->item[VOXELS].bytes != volume)
        return hs_fail(err, HS_ERR_INPUT,
                       CONTEXT " have %" PRIu32 " bytes, expected %" PRIu64 " (%" PRIu32 " x %" PRIu32
                               " x %" PRIu32 ")",
                       ARGS(f, VOXELS), f->item[VOXELS].bytes, volume, h->size[0], h->size[1], h->size[2]);
    h->voxels = f->item[VOXELS].offset;
    h->count = 1;
    if (!f->there[SEQUENCE]) return true;
    const uint64_t bytes = f->item[SEQUENCE].bytes;
    if (bytes == 0 || bytes % volume != 0 || bytes / volume > HS_KRETZ_TIMES)
        return hs_fail(err, HS_ERR_INPUT,
                       CONTEXT " have %" PRIu64 " bytes, expected 1 .. %u times %" PRIu64 " (%" PRIu32
                               " x %" PRIu32 " x %" PRIu32 ")",
                       ARGS(f, SEQUENCE), bytes, HS_KRETZ_TIMES, volume, h->size[0], h->size[1], h->size[2]);
    h->voxels = f->item[SEQUENCE].offset;
    h->count = (uint32_t)(bytes / volume);
    return true;
}

static bool check_range(const found *f, field w, const char *as, double value, double low, double high,
                        hs_error *err) {
    return (value >= low && value <= high) ||
           hs_fail(err, HS_ERR_INPUT, CONTEXT " is %.9g%s, expected %g .. %g mm", ARGS(f, w), value, as, low,
                   high);
}

static bool check_lengths(const found *f, hs_beams *b, hs_error *err) {
    const field needed[] = {PITCH, START, AXIS};
    for (int n = 0; n < 3; n++)
        if (!f->there[needed[n]])
            return hs_fail(err, HS_ERR_INPUT, CONTEXT " is missing", ARGS(f, needed[n]));
    b->pitch = f->value[PITCH] * MM;
    b->start = f->value[START] * b->pitch;
    b->axis = -f->value[AXIS] * b->pitch;
    return check_range(f, PITCH, " mm", b->pitch, HS_KRETZ_MIN_PITCH, HS_KRETZ_MAX_PITCH, err) &&
           check_range(f, START, " mm", b->start, 0.0, HS_KRETZ_MAX_OFFSET, err) &&
           check_range(f, AXIS, " mm", b->axis, -HS_KRETZ_MAX_OFFSET, HS_KRETZ_MAX_OFFSET, err);
}

static bool check_table_bytes(const found *f, field w, uint32_t count, const char *of, hs_error *err) {
    const uint32_t bytes = f->item[w].bytes;
    return bytes == 8 * count ||
           hs_fail(err, HS_ERR_INPUT,
                   CONTEXT " have %" PRIu32 " bytes, expected %" PRIu32 " (8 for each of %" PRIu32 " %s)",
                   ARGS(f, w), bytes, 8 * count, count, of);
}

/* The angles of a table as differences from its middle. */
static bool check_table(const found *f, field w, double *table, uint32_t count, hs_error *err) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(table[i]))
            return hs_fail(err, HS_ERR_INPUT, CONTEXT ": angle %" PRIu32 " is %g", ARGS(f, w), i, table[i]);
    const double first = table[0], last = table[count - 1], span = fabs(last - first);
    if (!(span >= HS_KRETZ_MIN_SPAN && span < PI))
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " span %g, expected at least %g and less than pi radians",
                       ARGS(f, w), span, HS_KRETZ_MIN_SPAN);
    for (uint32_t i = 1; i < count; i++)
        if (last > first ? !(table[i] > table[i - 1]) : !(table[i] < table[i - 1]))
            return hs_fail(err, HS_ERR_INPUT,
                           CONTEXT ": angle %" PRIu32
                                   " is %.9g after %.9g: they should %s from first to last",
                           ARGS(f, w), i, table[i], table[i - 1], last > first ? "ascend" : "descend");
    for (uint32_t i = 0; i < count; i++) table[i] -= 0.5 * (first + last);
    return true;
}

static bool read_table(const found *f, field w, uint32_t count, double **table, hs_error *err) {
    *table = malloc(count * sizeof **table);
    if (!*table) return hs_fail(err, HS_ERR_MEMORY, CONTEXT ": no memory for %" PRIu32, ARGS(f, w), count);
    if (!hs_kretz_items_read(f->items, f->item[w].offset, *table, count * sizeof **table, err)) return false;
    for (uint32_t i = 0; i < count; i++) {
        uint8_t bytes[8];
        memcpy(bytes, *table + i, sizeof bytes);
        (*table)[i] = float64_of(little_endian(bytes, sizeof bytes));
    }
    return check_table(f, w, *table, count, err);
}

static bool check_beams(const found *f, hs_kretz_header *h, hs_error *err) {
    hs_beams *b = &h->beams;
    b->samples = h->size[0];
    b->lines = h->size[1];
    b->planes = h->size[2];
    if (!check_table_bytes(f, THETA, b->lines, "lines", err) ||
        !check_table_bytes(f, PHI, b->planes, "frames", err) || !check_lengths(f, b, err) ||
        !read_table(f, THETA, b->lines, &b->theta, err) || !read_table(f, PHI, b->planes, &b->phi, err))
        return false;
    const double nearest = b->start * cos(b->theta[0]);
    return nearest > b->axis ||
           hs_fail(err, HS_ERR_INPUT,
                   CONTEXT " is %.9g mm, at or behind the samples' start at %.9g mm on the outer lines",
                   ARGS(f, AXIS), b->axis, nearest);
}

/* C100 in metres, or (0010,0022) in mm. Files were seen with either; both must say the same. */
static bool check_cartesian(const found *f, hs_kretz_header *h, hs_error *err) {
    if (!f->there[PITCH] && !f->there[CARTESIAN_MM])
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " is missing", ARGS(f, PITCH));
    const field w = f->there[PITCH] ? PITCH : CARTESIAN_MM;
    h->spacing = f->there[PITCH] ? f->value[PITCH] * MM : f->value[CARTESIAN_MM];
    if (!check_range(f, w, " mm", h->spacing, HS_KRETZ_MIN_PITCH, HS_KRETZ_MAX_PITCH, err)) return false;
    if (w == CARTESIAN_MM || !f->there[CARTESIAN_MM]) return true;
    return fabs(f->value[CARTESIAN_MM] - h->spacing) <= 1e-6 * h->spacing ||
           hs_fail(err, HS_ERR_INPUT, CONTEXT " is %.9g mm, but (%04X,%04X) says %.9g mm",
                   ARGS(f, CARTESIAN_MM), f->value[CARTESIAN_MM], fields[PITCH].group, fields[PITCH].element,
                   h->spacing);
}

static bool check(const found *f, hs_kretz_header *h, hs_error *err) {
    const bool probe = f->there[TYPE] && ((uint32_t)f->value[TYPE] & PROBE) != 0;
    h->cartesian = !f->there[THETA] && !f->there[PHI];
    if (h->cartesian ? probe : f->there[THETA] != f->there[PHI]) {
        const field w = f->there[THETA] ? PHI : THETA;
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " are missing", ARGS(f, w));
    }
    return check_size(f, h, err) && check_voxels(f, h, err) &&
           (h->cartesian ? check_cartesian(f, h, err) : check_beams(f, h, err));
}

bool hs_kretz_header_read(hs_kretz_items *items, hs_kretz_header *header, hs_error *err) {
    found f = {.items = items};
    hs_kretz_item item;
    bool more = true;
    *header = (hs_kretz_header){0};
    while (more) {
        if (!hs_kretz_items_next(items, &item, &more, err)) return false;
        if (more && !take(&f, &item, err)) return false;
    }
    if (check(&f, header, err)) return true;
    hs_kretz_header_free(header);
    return false;
}

void hs_kretz_header_free(hs_kretz_header *header) {
    free(header->beams.theta);
    free(header->beams.phi);
    *header = (hs_kretz_header){0};
}
