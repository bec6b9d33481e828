/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_foreign.h"

#include <stdint.h>
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

bool hs_met_is_foreign(const char *path, const char *head_text, size_t bytes, hs_error *err) {
    const uint8_t *head = (const uint8_t *)head_text;
    uint8_t inner[NIFTI2_SIZE];
    const char *format = NULL;
    const char *how = "open it in 3D Slicer and save it as .mha, or with Python's SimpleITK: "
                      "WriteImage(ReadImage('in'), 'out.mha')";
    if (bytes >= 2 && head[0] == 0x1f && head[1] == 0x8b) {
        bytes = inflate_head(head, bytes, inner, sizeof inner);
        head = inner;
    }
    if (holds(head, bytes, 0, "NRRD", 4))
        format = "an NRRD file";
    else if (is_nifti(head, bytes))
        format = "a NIfTI file";
    else if (starts_with(head, bytes, NIFTI1_SIZE) && ends_with(path, ".hdr"))
        format = "an Analyze file";
    else if (holds(head, bytes, DICOM_MARK, "DICM", 4) || is_bare_dicom(head, bytes)) {
        format = "a DICOM file";
        how = "load its series in 3D Slicer and save the volume as .mha";
    } else if (holds(head, bytes, 0, "KRETZFILE", 9)) {
        format = "a Kretz file";
        how = "labels and maps come in no other format";
    }
    return format && !hs_fail(err, HS_ERR_INPUT, "%s: is %s; host_sim reads MetaImage (.mha, .mhd): %s", path,
                              format, how);
}
