/* SPDX-License-Identifier: MIT */
#include "support/metaimage_files.h"

#include "support/host_fixture.h"

#include <zlib.h>

void files_volume(const char *name, const char *size, const char *type, const char *lines, const void *data,
                  size_t bytes) {
    char text[8192];
    int dims = 1;
    for (const char *c = size; *c; c++) dims += *c == ' ';
    const int length =
        snprintf(text, sizeof text, "NDims = %d\nDimSize = %s\n%sElementType = %s\nElementDataFile = LOCAL\n",
                 dims, size, lines, type);
    assert_true(length > 0 && (size_t)length < sizeof text);
    files_write(name, text, data, bytes);
}

uint8_t *files_deflate(const void *data, size_t bytes, size_t *compressed) {
    uLongf room = compressBound((uLong)bytes);
    uint8_t *out = unit_memory(room);
    assert_int_equal(compress2(out, &room, data, (uLong)bytes, 9), Z_OK);
    *compressed = room;
    return out;
}

void files_gzip(const char *name, const void *data, unsigned bytes) {
    gzFile file = gzopen(files_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(gzwrite(file, data, bytes), (int)bytes);
    assert_int_equal(gzclose(file), Z_OK);
}

hs_volume files_read(const char *name, const hs_metaimage_options *opt) {
    hs_error err = {0};
    hs_volume out;
    if (!hs_metaimage_read(files_path(name), opt, &out, &err)) fail_msg("%s", err.text);
    keep_volume(&out);
    assert_int_equal(err.code, HS_OK);
    return out;
}

void files_refused(const char *name, const char *told) {
    hs_error err = {0};
    hs_volume volume;
    if (hs_metaimage_read(files_path(name), NULL, &volume, &err))
        fail_msg("%s was read, expected '%s'", name, told);
    assert_int_equal(err.code, HS_ERR_INPUT);
    assert_null(volume.voxels);
    assert_int_equal(volume.nx, 0);
    if (!strstr(err.text, files_path(name))) fail_msg("'%s' does not name %s", err.text, name);
    if (told && !strstr(err.text, told)) fail_msg("'%s' does not tell '%s'", err.text, told);
}
