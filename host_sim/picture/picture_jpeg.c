/* SPDX-License-Identifier: MIT */
#include "picture/picture_jpeg.h"

#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

bool hs_picture_jpeg(const hs_picture *picture, int quality, uint8_t **data, size_t *bytes, hs_error *err) {
    /* Bytes of a pixel in memory are blue, green, red, unused on a little-endian machine. */
    static const uint32_t probe = 1;
    const int order = *(const uint8_t *)&probe == 1 ? TJPF_BGRX : TJPF_XRGB;
    unsigned char *jpeg = NULL; /* turbojpeg's own memory */
    unsigned long length = 0;
    *data = NULL;
    *bytes = 0;
    tjhandle handle = tjInitCompress();
    if (!handle) return hs_fail(err, HS_ERR_MEMORY, "JPEG: %s", tjGetErrorStr2(NULL));
    bool ok = tjCompress2(handle, (const unsigned char *)picture->pixels, (int)picture->width, 0,
                          (int)picture->height, order, &jpeg, &length, TJSAMP_420, quality,
                          TJFLAG_ACCURATEDCT) == 0;
    if (!ok)
        (void)hs_fail(err, HS_ERR_FAILED, "JPEG: %u x %u pixels: %s", picture->width, picture->height,
                      tjGetErrorStr2(handle));
    if (ok) {
        *data = malloc(length);
        ok = *data || hs_fail(err, HS_ERR_MEMORY, "JPEG: no memory for %lu bytes", length);
    }
    if (ok) {
        memcpy(*data, jpeg, length);
        *bytes = length;
    }
    tjFree(jpeg);
    (void)tjDestroy(handle);
    return ok;
}
