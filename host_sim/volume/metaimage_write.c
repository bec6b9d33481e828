/* SPDX-License-Identifier: MIT */
#include "volume/metaimage_write.h"

#include "volume/metaimage_stream.h"

#include <inttypes.h>
#include <string.h>

bool hs_metaimage_write(const char *path, const hs_metaimage_array *array, hs_error *err) {
    static const hs_met_type types[] = {
        [HS_ARRAY_U8] = HS_MET_UCHAR, [HS_ARRAY_U16] = HS_MET_USHORT, [HS_ARRAY_F32] = HS_MET_FLOAT};
    if ((unsigned)array->type > HS_ARRAY_F32)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementType %d is not known", path, (int)array->type);
    if (array->dims != 2 && array->dims != 3)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: NDims is %" PRIu32 ", expected 2 or 3", path, array->dims);
    if (!array->data) return hs_fail(err, HS_ERR_OUTPUT, "%s: ElementDataFile: no data given", path);
    hs_metaimage_format format = {.type = types[array->type],
                                  .dims = array->dims,
                                  .size = {array->size[0], array->size[1], array->size[2]},
                                  .pose = array->pose,
                                  .compress = array->compress};
    memcpy(format.spacing, array->spacing, sizeof format.spacing);
    hs_metaimage_stream *stream = hs_metaimage_stream_open(path, &format, err);
    if (!stream) return false;
    uint64_t bytes = hs_met_type_bytes(format.type);
    for (uint32_t axis = 0; axis < format.dims; axis++) bytes *= format.size[axis];
    if (hs_metaimage_stream_write(stream, array->data, bytes)) return hs_metaimage_stream_close(stream);
    hs_metaimage_stream_discard(stream);
    return false;
}
