/* SPDX-License-Identifier: MIT */
/* Finds the stream of items in a file: at its start, or in an element of a DICOM file. Of such a file's
 * elements tags, types and lengths are read, and no text. */
#include "core/input_file.h"
#include "volume/kretz_parts.h"

#include <inttypes.h>
#include <string.h>

#define PREAMBLE     128u /* bytes before "DICM" */
#define UNDEFINED    UINT32_MAX
#define MAX_ELEMENTS 65536u
#define META         0x0002u /* group of the file's own description: its types are always told */
#define DELIMITERS   0xFFFEu /* group of what nested elements begin and end with; without a type */
#define ITEM         0xE000u
#define PRIVATE      0x7FE1u
#define SYNTAX       0x0010u /* element of META: the transfer syntax */
#define SYNTAX_BYTES 64u

typedef struct {
    uint32_t group, element;
    uint32_t header, bytes; /* lengths of header and value */
    bool unknown;           /* its type is UN: elements in it have no types */
} element;

typedef struct {
    hs_kretz_items *items;
    uint64_t at;
    uint32_t count;
    bool begun;       /* behind the file's own description */
    uint32_t depth;   /* sequences and items that are open: those whose length is not told */
    uint32_t untyped; /* from this depth on elements have no types; UNDEFINED: nowhere */
    char syntax[SYNTAX_BYTES + 1];
    element stream; /* holds the volume; its group is 0 before it was found */
    uint64_t begin; /* of that volume */
} walk;

#define CONTEXT    "%s: byte %" PRIu64 ": element (%04X,%04X)"
#define ARGS(w, e) (w)->items->path, (w)->at, (e)->group, (e)->element

static uint32_t number(const uint8_t *bytes, int count) {
    uint32_t value = 0;
    while (count-- > 0) value = value << 8 | bytes[count];
    return value;
}

bool hs_kretz_is_dicom(const uint8_t *head, size_t bytes) {
    return bytes >= HS_KRETZ_HEAD_BYTES && memcmp(head + PREAMBLE, "DICM", 4) == 0;
}

/* Types whose length has 32 bits, behind two bytes that mean nothing. */
static bool is_long_type(const uint8_t *type) {
    static const char types[] = "OBODOFOLOVOWSQSVUCUNURUTUV";
    for (const char *t = types; *t; t += 2)
        if (memcmp(t, type, 2) == 0) return true;
    return false;
}

static bool is_letter(uint8_t byte) {
    return byte >= 'A' && byte <= 'Z';
}

/* Delimiters end an item or a sequence, but for the one that begins an item. */
static bool ends_level(const element *e) {
    return e->group == DELIMITERS && e->element != ITEM;
}

/* Behind the file's own description the transfer syntax says how all that follows is written. */
static bool begin_data(walk *w, hs_error *err) {
    static const char standard[] = "1.2.840.10008.1.2";
    const size_t length = sizeof standard - 1;
    const char *rest = strncmp(w->syntax, standard, length) == 0 ? w->syntax + length : "unknown";
    w->begun = true;
    if (*rest == '\0') w->untyped = 0;
    return *rest == '\0' || strcmp(rest, ".1") == 0 || strcmp(rest, ".5") == 0 ||
           strncmp(rest, ".4.", 3) == 0 ||
           hs_fail(err, HS_ERR_INPUT,
                   "%s: (0002,0010) transfer syntax is '%s', expected implicit or explicit little endian; "
                   "'smartvis clip' of the Python package reads others",
                   w->items->path, w->syntax);
}

static bool read_typed(const walk *w, const uint8_t head[12], uint64_t left, element *e, hs_error *err) {
    if (!is_letter(head[4]) || !is_letter(head[5]))
        return hs_fail(err, HS_ERR_INPUT, CONTEXT ": its type is %02X %02X hex, expected two capital letters",
                       ARGS(w, e), head[4], head[5]);
    e->unknown = memcmp(head + 4, "UN", 2) == 0;
    e->header = is_long_type(head + 4) ? 12 : 8;
    e->bytes = e->header == 12 ? number(head + 8, 4) : number(head + 6, 2);
    return left >= e->header ||
           hs_fail(err, HS_ERR_INPUT, CONTEXT ": %" PRIu64 " bytes are left, its header needs 12", ARGS(w, e),
                   left);
}

static bool read_header(walk *w, element *e, hs_error *err) {
    uint8_t head[12] = {0};
    const uint64_t left = w->items->end - w->at;
    if (left < 8)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: byte %" PRIu64 ": %" PRIu64 " bytes are left, an element's header needs 8",
                       w->items->path, w->at, left);
    if (!hs_kretz_items_read(w->items, w->at, head, left < 12 ? 8 : 12, err)) return false;
    *e = (element){
        .group = number(head, 2), .element = number(head + 2, 2), .header = 8, .bytes = number(head + 4, 4)};
    if (!w->begun && e->group != META && !begin_data(w, err)) return false;
    return e->group == DELIMITERS || w->depth >= w->untyped || read_typed(w, head, left, e, err);
}

/* Keeps digits and full stops, behind which zeros may stand. */
static bool read_syntax(walk *w, const element *e, hs_error *err) {
    const uint32_t bytes = e->bytes < SYNTAX_BYTES ? e->bytes : SYNTAX_BYTES;
    if (!hs_kretz_items_read(w->items, w->at + e->header, w->syntax, bytes, err)) return false;
    w->syntax[strspn(w->syntax, "0123456789.")] = '\0';
    return true;
}

/* An element is the volume if it is private, not nested, and begins as a file does. */
static bool look_into(walk *w, const element *e, hs_error *err) {
    uint8_t head[HS_KRETZ_MAGIC_BYTES];
    if (w->depth > 0 || e->group != PRIVATE || e->bytes < sizeof head) return true;
    if (!hs_kretz_items_read(w->items, w->at + e->header, head, sizeof head, err)) return false;
    if (memcmp(head, HS_KRETZ_MAGIC, sizeof head) != 0) return true;
    if (w->stream.group)
        return hs_fail(err, HS_ERR_INPUT,
                       CONTEXT " holds a Kretz volume, and so does (%04X,%04X): expected one", ARGS(w, e),
                       w->stream.group, w->stream.element);
    w->stream = *e;
    w->begin = w->at + e->header;
    return true;
}

/* Begins or ends a sequence or an item whose length is not told. */
static bool nest(walk *w, const element *e, hs_error *err) {
    const bool begins = e->bytes == UNDEFINED;
    if (begins ? ends_level(e) : w->depth == 0)
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " ends what has not begun", ARGS(w, e));
    w->depth = begins ? w->depth + 1 : w->depth - 1;
    if (begins && e->unknown) w->untyped = w->depth;
    if (w->depth < w->untyped) w->untyped = UNDEFINED;
    return true;
}

static bool pass(walk *w, const element *e, hs_error *err) {
    const uint64_t left = w->items->end - w->at - e->header;
    if (++w->count > MAX_ELEMENTS)
        return hs_fail(err, HS_ERR_INPUT, "%s: more than %u elements", w->items->path, MAX_ELEMENTS);
    if (e->bytes != UNDEFINED && e->bytes > left)
        return hs_fail(err, HS_ERR_INPUT, CONTEXT " has %" PRIu32 " bytes, but %" PRIu64 " are left",
                       ARGS(w, e), e->bytes, left);
    if (e->bytes == UNDEFINED || ends_level(e) ? !nest(w, e, err) : !look_into(w, e, err)) return false;
    if (e->group == META && e->element == SYNTAX && !read_syntax(w, e, err)) return false;
    w->at += e->header + (e->bytes == UNDEFINED ? 0 : (uint64_t)e->bytes);
    return true;
}

/* Sets at, end and padded to the stream in the private group 7FE1. */
static bool find_in_dicom(hs_kretz_items *items, hs_error *err) {
    walk w = {.items = items, .at = HS_KRETZ_HEAD_BYTES, .untyped = UNDEFINED};
    element e;
    while (w.at < items->end)
        if (!read_header(&w, &e, err) || !pass(&w, &e, err)) return false;
    if (w.depth > 0)
        return hs_fail(err, HS_ERR_INPUT, "%s: byte %" PRIu64 ": the file ends within a sequence",
                       items->path, w.at);
    if (!w.stream.group)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: a DICOM file, but no element of group 7FE1 begins with 'KRETZFILE 1.0': "
                       "'smartvis clip' of the Python package reads other volumes, or export it as .vol "
                       "from 4D View",
                       items->path);
    items->at = w.begin + HS_KRETZ_MAGIC_BYTES;
    items->end = w.begin + w.stream.bytes;
    items->padded = true;
    return true;
}

static bool find_stream(hs_kretz_items *items, hs_error *err) {
    uint8_t head[HS_KRETZ_HEAD_BYTES] = {0};
    const size_t bytes = items->end < sizeof head ? (size_t)items->end : sizeof head;
    if (!hs_kretz_items_read(items, 0, head, bytes, err)) return false;
    if (bytes >= HS_KRETZ_MAGIC_BYTES && memcmp(head, HS_KRETZ_MAGIC, HS_KRETZ_MAGIC_BYTES) == 0) return true;
    if (hs_kretz_is_dicom(head, bytes)) return find_in_dicom(items, err);
    return hs_fail(err, HS_ERR_INPUT,
                   "%s: the first %u bytes are not 'KRETZFILE 1.0' with three spaces behind it", items->path,
                   HS_KRETZ_MAGIC_BYTES);
}

bool hs_kretz_items_open(hs_kretz_items *items, const char *path, const char *folder, hs_error *err) {
    *items = (hs_kretz_items){.path = path, .at = HS_KRETZ_MAGIC_BYTES};
    items->file = hs_input_open_within((hs_input_bounds){NULL, folder}, path, path, &items->end, err);
    if (!items->file) return false;
    if (find_stream(items, err)) return true;
    hs_kretz_items_close(items);
    return false;
}
