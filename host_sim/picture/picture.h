/* SPDX-License-Identifier: MIT */
/*
 * Plain pixels: a picture in memory, images drawn on it to scale, PNG files. All functions may be called from
 * any thread, on different pictures at once. Rows run top to bottom, columns left to right, as the camera
 * sees them.
 */
#pragma once

#include "core/error.h"

#include <stddef.h>
#include <stdint.h>

#define HS_COLOUR_BACKGROUND 0x1b1d20u
#define HS_COLOUR_TEXT       0xe6e6e6u
#define HS_COLOUR_FAINT_TEXT 0xa9adb3u
#define HS_COLOUR_NO_VALUE   0x34373cu /* no value here */
#define HS_COLOUR_INVALID    0xff00ffu /* a value that should not be there, such as NaN */

/* Viridis, for t in 0 .. 1 (clamped): perceptually uniform, lightness grows with t. */
uint32_t hs_colour_viridis(double t);
/* Blue - white - red, for t in -1 .. 1 (clamped); 0 is white. */
uint32_t hs_colour_diverging(double t);

#define HS_PICTURE_MAX_AXIS 16384u /* pixels along one side */

/* A picture. Pixel (x, y) is pixels[y * width + x], 0x00RRGGBB. */
typedef struct {
    uint32_t width, height;
    uint32_t *pixels; /* owned */
} hs_picture;

/* A picture of one colour. HS_ERR_INPUT if a side is 0 or above HS_PICTURE_MAX_AXIS, or HS_ERR_MEMORY. */
bool hs_picture_init(hs_picture *picture, uint32_t width, uint32_t height, uint32_t colour, hs_error *err);
/* Frees the pixels and zeroes the struct. Safe on a zeroed struct. */
void hs_picture_free(hs_picture *picture);

/* What PNG files name as their software, a static text of up to 79 characters: once, before the first. None:
 * nothing. */
void hs_picture_software(const char *name);

/* Writes a PNG (8-bit RGB) under a temporary name and renames it. HS_ERR_OUTPUT names path and reason. */
bool hs_picture_save(const hs_picture *picture, const char *path, hs_error *err);

/* The same PNG in memory, which the caller frees. HS_ERR_MEMORY or HS_ERR_FAILED; *data is NULL then. */
bool hs_picture_png(const hs_picture *picture, uint8_t **data, size_t *bytes, hs_error *err);

/* Reads a PNG of any kind as 8-bit RGB. HS_ERR_INPUT names the path and the reason. */
bool hs_picture_load(hs_picture *out, const char *path, hs_error *err);

/* An image in memory that is borrowed: RGBA, of which alpha is not used (the renderer draws on black). */
typedef struct {
    const uint8_t *data; /* width * height * 4 bytes */
    uint32_t width, height;
} hs_image;

/* How an image is scaled. Nearest keeps pixels as they are. Smooth interpolates linearly between pixel
 * centres, and beyond the outermost centres repeats the edge; where the image becomes smaller, a pixel is the
 * mean of the area it covers. */
typedef enum { HS_SCALE_NEAREST = 0, HS_SCALE_SMOOTH } hs_scale;

/* Where `x` of a text is. */
typedef enum { HS_ALIGN_LEFT = 0, HS_ALIGN_CENTRE, HS_ALIGN_RIGHT } hs_align;

/* Draws `image` over the rectangle (x, y, width, height) of the picture; what lies outside is cut off. */
void hs_picture_blit(hs_picture *picture, int32_t x, int32_t y, uint32_t width, uint32_t height,
                     const hs_image *image, hs_scale scale);

/* A JPEG in memory, which the caller frees: with speckle a sixth of a PNG at quality 88. `quality` is 1 ..
 * 100. On failure *data is NULL, with HS_ERR_MEMORY or HS_ERR_FAILED. Any thread. */
bool hs_picture_jpeg(const hs_picture *picture, int quality, uint8_t **data, size_t *bytes, hs_error *err);
