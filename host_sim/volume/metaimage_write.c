/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_write.h"

#include "core/output_file.h"
#include "core/paths.h"
#include "volume/metaimage_parts.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { DEFLATE_BYTES = 1 << 16 };

struct hs_metaimage_stream {
    hs_error *err;
    hs_metaimage_format format;
    hs_pose pose;
    uint64_t bytes, left; /* of the elements, and of those what is to come */
    uint64_t in_file;     /* what became of them */
    char *path;
    hs_output_file file;
    z_stream zlib;
    bool zlib_ready;
    uint8_t room[DEFLATE_BYTES];
};

static bool check_format(const char *path, const hs_metaimage_format *f, uint64_t *bytes, hs_error *err) {
    if ((unsigned)f->type >= HS_MET_TYPES)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementType %d is not known", path, (int)f->type);
    if (f->dims != 3 && f->dims != 4)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: NDims is %" PRIu32 ", expected 3 or 4", path, f->dims);
    *bytes = hs_met_type_bytes(f->type);
    for (uint32_t axis = 0; axis < f->dims; axis++) {
        if (f->size[axis] == 0 || *bytes > SIZE_MAX / 2 / f->size[axis])
            return hs_fail(err, HS_ERR_OUTPUT, "%s: DimSize along axis %" PRIu32 " is %" PRIu32, path, axis,
                           f->size[axis]);
        *bytes *= f->size[axis];
        if (axis < 3 && (!isfinite(f->spacing[axis]) || f->spacing[axis] <= 0.0))
            return hs_fail(err, HS_ERR_OUTPUT,
                           "%s: ElementSpacing along axis %" PRIu32 " is %g, expected above 0 mm", path, axis,
                           f->spacing[axis]);
    }
    return true;
}

/* ------------------------------------------------------------------------------------------ the header -- */

/* One axis' direction after the other: the columns of ours. The axis of time is apart from the others. */
static void write_pose(FILE *f, const hs_metaimage_stream *s) {
    const uint32_t dims = s->format.dims;
    (void)fprintf(f, "TransformMatrix =");
    for (uint32_t axis = 0; axis < dims; axis++)
        for (uint32_t k = 0; k < dims; k++) {
            const bool spatial = axis < 3 && k < 3;
            (void)fprintf(f, " %.17g",
                          spatial     ? s->pose.direction[k * 3 + axis] + 0.0
                          : axis == k ? 1.0
                                      : 0.0);
        }
    (void)fprintf(f, "\nOffset =");
    for (uint32_t k = 0; k < dims; k++) (void)fprintf(f, " %.17g", k < 3 ? s->pose.origin[k] + 0.0 : 0.0);
    (void)fprintf(f, "\nCenterOfRotation =");
    for (uint32_t k = 0; k < dims; k++) (void)fprintf(f, " 0");
    char letters[4] = "???";
    if (s->pose.stated) hs_pose_letters(&s->pose, letters);
    (void)fprintf(f, "\nAnatomicalOrientation = %s%s\n", letters, dims == 4 ? "?" : "");
    if (!s->pose.stated && !hs_pose_is_identity(&s->pose))
        (void)fprintf(f, "ITK_FileNotes = " HS_MET_UNPLACED "\n");
}

static void write_fields(FILE *f, const hs_metaimage_stream *s) {
    (void)fprintf(f, "Kinds = domain domain domain list\n");
    for (uint32_t i = 0; s->format.fields && i < s->format.size[3]; i++) {
        const hs_frame_fields *said = &s->format.fields[i];
        for (uint32_t t = 0; t < said->transform_count; t++) {
            const hs_frame_transform *transform = &said->transforms[t];
            (void)fprintf(f, "Seq_Frame%04" PRIu32 "_%sTransform =", i, transform->name);
            for (int k = 0; k < 16; k++) (void)fprintf(f, " %.17g", transform->matrix[k]);
            (void)fprintf(f, "\nSeq_Frame%04" PRIu32 "_%sTransformStatus = %s\n", i, transform->name,
                          transform->status[0] ? transform->status : "OK");
        }
        if (said->has_time) (void)fprintf(f, "Seq_Frame%04" PRIu32 "_Timestamp = %.17g\n", i, said->time);
        (void)fprintf(f, "Seq_Frame%04" PRIu32 "_ImageStatus = %s\n", i, said->invalid ? "INVALID" : "OK");
    }
}

/* Writes the text. Its length does not depend on `compressed`, so that it can be written again when that is
 * known. */
static bool write_header(const hs_metaimage_stream *s, uint64_t compressed) {
    const hs_metaimage_format *a = &s->format;
    FILE *f = s->file.file;
    (void)fprintf(f,
                  "ObjectType = Image\nNDims = %" PRIu32 "\nBinaryData = True\nBinaryDataByteOrderMSB = %s\n",
                  a->dims, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? "True" : "False");
    (void)fprintf(f, "CompressedData = %s\n", a->compress ? "True" : "False");
    if (a->compress) (void)fprintf(f, "CompressedDataSize = %-20" PRIu64 "\n", compressed);
    write_pose(f, s);
    if (!a->spacing_unsaid) {
        (void)fprintf(f, "ElementSpacing =");
        for (uint32_t axis = 0; axis < a->dims; axis++)
            (void)fprintf(f, " %.17g", axis < 3 ? a->spacing[axis] : 1.0);
        (void)fprintf(f, "\n");
    }
    (void)fprintf(f, "DimSize =");
    for (uint32_t axis = 0; axis < a->dims; axis++) (void)fprintf(f, " %" PRIu32, a->size[axis]);
    (void)fprintf(f, "\n");
    if (a->dims == 4) write_fields(f, s);
    (void)fprintf(f, "ElementType = %s\nElementDataFile = LOCAL\n", hs_met_type_name(a->type));
    return !ferror(f) ||
           hs_fail(s->err, HS_ERR_OUTPUT, "%s: the header cannot be written: %s", s->path, strerror(errno));
}

/* -------------------------------------------------------------------------------------------- the data -- */

static bool start(hs_metaimage_stream *s, const char *path) {
    if (!check_format(path, &s->format, &s->bytes, s->err)) return false;
    if (!hs_path_ends(path, ".mha"))
        return hs_fail(s->err, HS_ERR_OUTPUT, "%s: the name should end in .mha", path);
    s->path = strdup(path);
    s->left = s->bytes;
    if (!s->path) return hs_fail(s->err, HS_ERR_MEMORY, "%s: no memory to write the file", path);
    if (!hs_output_open(&s->file, path, s->err)) return false;
    if (s->format.compress) {
        s->zlib_ready = deflateInit(&s->zlib, Z_DEFAULT_COMPRESSION) == Z_OK;
        if (!s->zlib_ready) return hs_fail(s->err, HS_ERR_MEMORY, "%s: no memory for zlib", path);
    }
    return write_header(s, 0);
}

hs_metaimage_stream *hs_metaimage_stream_open(const char *path, const hs_metaimage_format *format,
                                              hs_error *err) {
    hs_metaimage_stream *s = hs_memory(1, sizeof *s, path, err);
    if (!s) return NULL;
    s->err = err;
    s->format = *format;
    hs_pose_default(&s->pose);
    if (format->pose) s->pose = *format->pose;
    s->format.pose = NULL; /* the caller's may go */
    if (start(s, path)) return s;
    hs_metaimage_stream_discard(s);
    return NULL;
}

/* Deflates what is in the z_stream, and with `flush` Z_FINISH all that it kept. */
static bool deflate_all(hs_metaimage_stream *s, int flush) {
    int code;
    do {
        s->zlib.next_out = s->room;
        s->zlib.avail_out = DEFLATE_BYTES;
        code = deflate(&s->zlib, flush);
        if (code == Z_STREAM_ERROR)
            return hs_fail(s->err, HS_ERR_OUTPUT, "%s: zlib: %s", s->path, zError(code));
        const size_t made = DEFLATE_BYTES - s->zlib.avail_out;
        if (!hs_output_write(&s->file, s->room, made, s->err)) return false;
        s->in_file += made;
    } while (s->zlib.avail_out == 0 || (flush == Z_FINISH && code != Z_STREAM_END));
    return true;
}

bool hs_metaimage_stream_write(hs_metaimage_stream *s, const void *data, uint64_t bytes) {
    if (bytes > s->left)
        return hs_fail(s->err, HS_ERR_OUTPUT, "%s: more data than the %" PRIu64 " bytes of DimSize", s->path,
                       s->bytes);
    s->left -= bytes;
    if (!s->format.compress) {
        s->in_file += bytes;
        return hs_output_write(&s->file, data, (size_t)bytes, s->err);
    }
    for (const uint8_t *at = data; bytes > 0;) {
        const uint64_t n = bytes < (1u << 30) ? bytes : 1u << 30; /* zlib counts in 32 bit */
        s->zlib.next_in = (z_const Bytef *)at;
        s->zlib.avail_in = (uInt)n;
        if (!deflate_all(s, Z_NO_FLUSH)) return false;
        at += n;
        bytes -= n;
    }
    return true;
}

/* The compressed size is known only now, so the text is written again. */
static bool finish(hs_metaimage_stream *s) {
    if (s->format.compress) {
        if (!deflate_all(s, Z_FINISH)) return false;
        rewind(s->file.file);
        if (!write_header(s, s->in_file)) return false;
    }
    return hs_output_commit(&s->file, s->err);
}

bool hs_metaimage_stream_close(hs_metaimage_stream *s) {
    bool ok =
        s->left == 0 || hs_fail(s->err, HS_ERR_OUTPUT, "%s: %" PRIu64 " of %" PRIu64 " bytes are missing",
                                s->path, s->left, s->bytes);
    ok = ok && finish(s);
    hs_metaimage_stream_discard(s);
    return ok;
}

void hs_metaimage_stream_discard(hs_metaimage_stream *s) {
    if (!s) return;
    if (s->zlib_ready) (void)deflateEnd(&s->zlib);
    hs_output_discard(&s->file);
    free(s->path);
    free(s);
}

bool hs_metaimage_write(const char *path, const hs_metaimage_format *format, const void *data,
                        hs_error *err) {
    if (!data) return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementDataFile: no data given", path);
    hs_metaimage_stream *stream = hs_metaimage_stream_open(path, format, err);
    if (!stream) return false;
    if (hs_metaimage_stream_write(stream, data, stream->bytes)) return hs_metaimage_stream_close(stream);
    hs_metaimage_stream_discard(stream);
    return false;
}
