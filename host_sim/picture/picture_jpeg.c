/* SPDX-License-Identifier: MIT */
/* Renderings as JPEG: speckle does not compress without loss, and a page holds many of them. */
#include "picture/picture.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

bool hs_picture_load(hs_picture *out, const char *path, hs_error *err) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    *out = (hs_picture){0};
    if (!png_image_begin_read_from_file(&image, path))
        return hs_fail(err, HS_ERR_INPUT, "%s: cannot read the picture: %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    if (!hs_picture_init(out, image.width, image.height, 0, err)) {
        png_image_free(&image);
        return false;
    }
    const size_t count = (size_t)image.width * image.height;
    uint8_t *rgb = malloc(count * 3);
    bool ok = rgb || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for the picture", path);
    if (ok && !png_image_finish_read(&image, NULL, rgb, 0, NULL))
        ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot read the picture: %s", path, image.message);
    for (size_t i = 0; ok && i < count; i++)
        out->pixels[i] = (uint32_t)rgb[3 * i] << 16 | (uint32_t)rgb[3 * i + 1] << 8 | rgb[3 * i + 2];
    free(rgb);
    png_image_free(&image);
    if (!ok) hs_picture_free(out);
    return ok;
}

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
