/* SPDX-License-Identifier: MIT */
#include "volume/kretz_items.h"

#include "volume/metaimage_open.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#define HEADER_BYTES 8u
#define DICOM_MAGIC  128 /* "DICM" stands here in a DICOM file */
#define MOST_AT_ONCE ((size_t)1 << 30)

static uint32_t u16_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8;
}

bool hs_kretz_items_read(const hs_kretz_items *items, uint64_t offset, void *out, size_t bytes,
                         hs_error *err) {
    uint8_t *at = out;
    while (bytes > 0) {
        const size_t most = bytes < MOST_AT_ONCE ? bytes : MOST_AT_ONCE;
        const ssize_t got = pread(fileno(items->file), at, most, (off_t)offset);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            return hs_fail(err, HS_ERR_INPUT, "%s: byte %" PRIu64 ": cannot be read: %s", items->path, offset,
                           got < 0 ? strerror(errno) : "the file became shorter");
        at += got;
        offset += (uint64_t)got;
        bytes -= (size_t)got;
    }
    return true;
}

static bool check_magic(const hs_kretz_items *items, hs_error *err) {
    uint8_t head[DICOM_MAGIC + 4] = {0};
    const size_t bytes = items->end < sizeof head ? (size_t)items->end : sizeof head;
    if (!hs_kretz_items_read(items, 0, head, bytes, err)) return false;
    if (bytes >= HS_KRETZ_MAGIC_BYTES && memcmp(head, HS_KRETZ_MAGIC, HS_KRETZ_MAGIC_BYTES) == 0) return true;
    if (memcmp(head + DICOM_MAGIC, "DICM", 4) == 0)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: a DICOM file, expected KRETZFILE 1.0; export the volume as .vol from 4D View",
                       items->path);
    return hs_fail(err, HS_ERR_INPUT,
                   "%s: the first %u bytes are not 'KRETZFILE 1.0' with three spaces behind it", items->path,
                   HS_KRETZ_MAGIC_BYTES);
}

bool hs_kretz_items_open(hs_kretz_items *items, const char *path, hs_error *err) {
    *items = (hs_kretz_items){.path = path, .at = HS_KRETZ_MAGIC_BYTES};
    items->file = hs_met_open(path, path, &items->end, err);
    if (!items->file) return false;
    if (check_magic(items, err)) return true;
    hs_kretz_items_close(items);
    return false;
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
    if (left == 0) return true;
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
