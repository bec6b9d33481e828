/* SPDX-License-Identifier: MIT */
#include "volume/kretz.h"
#include "volume/kretz_parts.h"

#include <inttypes.h>
#include <string.h>

#define MM        1e3
#define HALF_PI   1.57079632679489661923
#define PROBE     0x10u /* the type: grey, probe geometry */
#define MAX_BYTES UINT32_MAX

static bool put_header(hs_kretz_writer *w, uint16_t group, uint16_t element, uint32_t bytes, hs_error *err) {
    uint8_t header[8];
    const uint64_t fields = group | (uint64_t)element << 16 | (uint64_t)bytes << 32;
    for (int i = 0; i < 8; i++) header[i] = (uint8_t)(fields >> 8 * i);
    return hs_output_write(&w->out, header, sizeof header, err);
}

static bool put_bits(hs_kretz_writer *w, uint64_t bits, unsigned count, hs_error *err) {
    uint8_t bytes[8];
    for (unsigned i = 0; i < count; i++) bytes[i] = (uint8_t)(bits >> 8 * i);
    return hs_output_write(&w->out, bytes, count, err);
}

static bool put_integer(hs_kretz_writer *w, uint16_t group, uint16_t element, uint32_t value, unsigned bytes,
                        hs_error *err) {
    return put_header(w, group, element, bytes, err) && put_bits(w, value, bytes, err);
}

static bool put_float64(hs_kretz_writer *w, double value, hs_error *err) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put_bits(w, bits, sizeof bits, err);
}

static bool put_number(hs_kretz_writer *w, uint16_t group, uint16_t element, double value, hs_error *err) {
    return put_header(w, group, element, 8, err) && put_float64(w, value, err);
}

static bool put_table(hs_kretz_writer *w, uint16_t element, const double *table, uint32_t count,
                      hs_error *err) {
    bool ok = put_header(w, 0xC300, element, 8 * count, err);
    for (uint32_t i = 0; ok && i < count; i++) ok = put_float64(w, table[i] + HALF_PI, err);
    return ok;
}

static bool put_geometry(hs_kretz_writer *w, const hs_beams *b, hs_error *err) {
    return hs_output_write(&w->out, HS_KRETZ_MAGIC, HS_KRETZ_MAGIC_BYTES, err) &&
           put_integer(w, 0x0001, 0x0100, PROBE, 4, err) &&
           put_integer(w, 0xC000, 0x0001, b->samples, 2, err) &&
           put_integer(w, 0xC000, 0x0002, b->lines, 2, err) &&
           put_integer(w, 0xC000, 0x0003, b->planes, 2, err) &&
           put_number(w, 0xC100, 0x0001, b->pitch / MM, err) &&
           put_number(w, 0xC200, 0x0001, b->start / b->pitch, err) &&
           put_number(w, 0xC200, 0x0002, -b->axis / b->pitch, err) &&
           put_table(w, 0x0001, b->phi, b->planes, err) && put_table(w, 0x0002, b->theta, b->lines, err);
}

bool hs_kretz_write_open(hs_kretz_writer *writer, const char *path, const hs_beams *beams, uint32_t count,
                         hs_error *err) {
    *writer = (hs_kretz_writer){.bytes = hs_beams_count(beams), .left = count};
    const uint64_t bytes = (uint64_t)writer->bytes * count;
    if (count == 0 || bytes > MAX_BYTES)
        return hs_fail(err, HS_ERR_OUTPUT,
                       "%s: %" PRIu32 " volumes of %zu bytes, expected 1 .. %" PRIu32 " bytes in all", path,
                       count, writer->bytes, MAX_BYTES);
    if (!hs_output_open(&writer->out, path, err)) return false;
    const uint16_t group = count > 1 ? 0xD600 : 0xD000;
    if (put_geometry(writer, beams, err) && put_header(writer, group, 0x0001, (uint32_t)bytes, err))
        return true;
    hs_kretz_write_discard(writer);
    return false;
}

bool hs_kretz_write_volume(hs_kretz_writer *writer, const uint8_t *voxels, hs_error *err) {
    if (writer->left == 0)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: a volume more than was said", writer->out.path);
    writer->left--;
    return hs_output_write(&writer->out, voxels, writer->bytes, err);
}

bool hs_kretz_write_commit(hs_kretz_writer *writer, hs_error *err) {
    bool ok = writer->left == 0 || hs_fail(err, HS_ERR_OUTPUT, "%s: %" PRIu32 " volumes are missing",
                                           writer->out.path, writer->left);
    ok = ok && put_header(writer, 0xFFFF, 0xFFFF, 0, err);
    if (ok)
        ok = hs_output_commit(&writer->out, err);
    else
        hs_output_discard(&writer->out);
    *writer = (hs_kretz_writer){0};
    return ok;
}

void hs_kretz_write_discard(hs_kretz_writer *writer) {
    hs_output_discard(&writer->out);
    *writer = (hs_kretz_writer){0};
}
