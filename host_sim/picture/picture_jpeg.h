/* SPDX-License-Identifier: MIT */
/* Renderings as JPEG: speckle does not compress without loss, and a page holds many of them. */
#ifndef HS_PICTURE_JPEG_H
#define HS_PICTURE_JPEG_H

#include "picture/picture.h"

/* A JPEG in memory, which the caller frees: with speckle a sixth of a PNG at quality 88. `quality` is 1 ..
 * 100. On failure *data is NULL, with HS_ERR_MEMORY or HS_ERR_FAILED. Any thread. */
bool hs_picture_jpeg(const hs_picture *picture, int quality, uint8_t **data, size_t *bytes, hs_error *err);

#endif
