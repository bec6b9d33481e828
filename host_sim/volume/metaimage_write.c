/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_write.h"

#include "base/output_file.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { DEFLATE_BYTES = 1 << 16 };

static const struct {
    const char *name;
    size_t bytes;
} array_types[] = {
    [HS_ARRAY_U8] = {"MET_UCHAR", 1}, [HS_ARRAY_U16] = {"MET_USHORT", 2}, [HS_ARRAY_F32] = {"MET_FLOAT", 4}};

/* What is written where. */
typedef struct {
    const hs_metaimage_array *array;
    uint64_t data_bytes;
    bool local;            /* one .mha */
    char *data_path;       /* the data file; NULL if local */
    const char *data_name; /* as ElementDataFile says it */
} plan;

static bool check_array(const char *path, const hs_metaimage_array *a, uint64_t *data_bytes, hs_error *err) {
    if ((unsigned)a->type > HS_ARRAY_F32)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementType %d is not known", path, (int)a->type);
    if (a->dims != 2 && a->dims != 3)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: NDims is %" PRIu32 ", expected 2 or 3", path, a->dims);
    uint64_t bytes = array_types[a->type].bytes;
    for (uint32_t axis = 0; axis < a->dims; axis++) {
        if (a->size[axis] == 0 || bytes > SIZE_MAX / 2 / a->size[axis])
            return hs_fail(err, HS_ERR_OUTPUT, "%s: DimSize along axis %" PRIu32 " is %" PRIu32, path, axis,
                           a->size[axis]);
        bytes *= a->size[axis];
        if (!isfinite(a->spacing[axis]) || a->spacing[axis] <= 0.0)
            return hs_fail(err, HS_ERR_OUTPUT,
                           "%s: ElementSpacing along axis %" PRIu32 " is %g, expected above 0 mm", path, axis,
                           a->spacing[axis]);
    }
    if (!a->data) return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementDataFile: no data given", path);
    *data_bytes = bytes;
    return true;
}

static bool has_ending(const char *path, const char *ending) {
    const size_t n = strlen(path), m = strlen(ending);
    return n > m && path[n - m - 1] != '/' && strcmp(path + n - m, ending) == 0;
}

/* Decides between .mha and .mhd; fills everything but data_bytes. */
static bool make_plan(plan *p, const char *path, hs_error *err) {
    p->local = has_ending(path, ".mha");
    p->data_name = "LOCAL";
    if (p->local) return true;
    if (!has_ending(path, ".mhd"))
        return hs_fail(err, HS_ERR_OUTPUT, "%s: the name should end in .mha or .mhd", path);
    const size_t stem = strlen(path) - strlen(".mhd");
    p->data_path = malloc(stem + sizeof ".zraw");
    if (!p->data_path) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory to write the file", path);
    memcpy(p->data_path, path, stem);
    strcpy(p->data_path + stem, p->array->compress ? ".zraw" : ".raw");
    const char *slash = strrchr(p->data_path, '/');
    p->data_name = slash ? slash + 1 : p->data_path;
    /* Such a name would not read back as the same file. */
    if (strpbrk(p->data_name, "\r\n%"))
        return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementDataFile cannot hold a line break or '%%'", path);
    return true;
}

/* Deflates the whole array into the file. */
static bool write_compressed(hs_output_file *out, const plan *p, uint64_t *written, hs_error *err) {
    z_stream zlib = {0};
    uint8_t *room = malloc(DEFLATE_BYTES);
    if (!room || deflateInit(&zlib, Z_DEFAULT_COMPRESSION) != Z_OK) {
        free(room);
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for zlib", out->path);
    }
    const uint8_t *data = p->array->data;
    uint64_t left = p->data_bytes;
    bool ok = true, ended = false;
    *written = 0;
    while (ok && !ended) {
        if (zlib.avail_in == 0 && left > 0) {
            const uint64_t n = left < (1u << 30) ? left : 1u << 30; /* zlib counts in 32 bit */
            zlib.next_in = (z_const Bytef *)(data + (p->data_bytes - left));
            zlib.avail_in = (uInt)n;
            left -= n;
        }
        zlib.next_out = room;
        zlib.avail_out = DEFLATE_BYTES;
        const int code = deflate(&zlib, left == 0 ? Z_FINISH : Z_NO_FLUSH);
        ended = code == Z_STREAM_END;
        if (code == Z_STREAM_ERROR) ok = hs_fail(err, HS_ERR_OUTPUT, "%s: zlib: %s", out->path, zError(code));
        const size_t n = DEFLATE_BYTES - zlib.avail_out;
        ok = ok && hs_output_write(out, room, n, err);
        *written += n;
    }
    (void)deflateEnd(&zlib);
    free(room);
    return ok;
}

static bool write_data(hs_output_file *out, const plan *p, uint64_t *written, hs_error *err) {
    if (p->array->compress) return write_compressed(out, p, written, err);
    *written = p->data_bytes;
    return hs_output_write(out, p->array->data, (size_t)p->data_bytes, err);
}

/* Writes the text. Its length does not depend on `compressed`, so that it can be
 * written again when that is known. */
static bool write_header(hs_output_file *out, const plan *p, uint64_t compressed, hs_error *err) {
    const hs_metaimage_array *a = p->array;
    const bool volume = a->dims == 3;
    FILE *f = out->file;
    fprintf(f, "ObjectType = Image\nNDims = %" PRIu32 "\nBinaryData = True\nBinaryDataByteOrderMSB = %s\n",
            a->dims, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? "True" : "False");
    fprintf(f, "CompressedData = %s\n", a->compress ? "True" : "False");
    if (a->compress) fprintf(f, "CompressedDataSize = %-20" PRIu64 "\n", compressed);
    fprintf(f, "TransformMatrix = %s\n", volume ? "1 0 0 0 1 0 0 0 1" : "1 0 0 1");
    fprintf(f, "Offset = %s\nCenterOfRotation = %s\n", volume ? "0 0 0" : "0 0", volume ? "0 0 0" : "0 0");
    fprintf(f, "ElementSpacing =");
    for (uint32_t axis = 0; axis < a->dims; axis++) fprintf(f, " %.17g", a->spacing[axis]);
    fprintf(f, "\nDimSize =");
    for (uint32_t axis = 0; axis < a->dims; axis++) fprintf(f, " %" PRIu32, a->size[axis]);
    fprintf(f, "\nElementType = %s\nElementDataFile = %s\n", array_types[a->type].name, p->data_name);
    if (!ferror(f)) return true;
    return hs_fail(err, HS_ERR_OUTPUT, "%s: the header cannot be written: %s", out->path, strerror(errno));
}

/* One .mha: the compressed size is known only when the data is written, so the text is written twice. */
static bool write_local(const char *path, const plan *p, hs_error *err) {
    hs_output_file out;
    uint64_t written = 0;
    if (!hs_output_open(&out, path, err)) return false;
    bool ok = write_header(&out, p, 0, err) && write_data(&out, p, &written, err);
    if (ok && p->array->compress) {
        rewind(out.file);
        ok = write_header(&out, p, written, err);
    }
    if (ok) return hs_output_commit(&out, err);
    hs_output_discard(&out);
    return false;
}

static bool write_pair(const char *path, const plan *p, hs_error *err) {
    hs_output_file data, header;
    uint64_t written = 0;
    if (!hs_output_open(&data, p->data_path, err)) return false;
    bool ok = write_data(&data, p, &written, err) && hs_output_open(&header, path, err);
    if (!ok) {
        hs_output_discard(&data);
        return false;
    }
    ok = write_header(&header, p, written, err) && hs_output_commit(&data, err);
    if (ok) return hs_output_commit(&header, err);
    hs_output_discard(&header);
    hs_output_discard(&data);
    return false;
}

bool hs_metaimage_write(const char *path, const hs_metaimage_array *array, hs_error *err) {
    plan p = {.array = array};
    bool ok = check_array(path, array, &p.data_bytes, err) && make_plan(&p, path, err);
    ok = ok && (p.local ? write_local(path, &p, err) : write_pair(path, &p, err));
    free(p.data_path);
    return ok;
}
