/* SPDX-License-Identifier: MIT */
#include "picture/picture.h"

#include "core/input_file.h"
#include "core/output_file.h"

#include <inttypes.h>
#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>
#include <zlib.h>

bool hs_picture_init(hs_picture *picture, uint32_t width, uint32_t height, uint32_t colour, hs_error *err) {
    memset(picture, 0, sizeof *picture);
    if (width == 0 || height == 0 || width > HS_PICTURE_MAX_AXIS || height > HS_PICTURE_MAX_AXIS)
        return hs_fail(err, HS_ERR_INPUT, "picture: size is %" PRIu32 " x %" PRIu32 ", expected 1 .. %u each",
                       width, height, HS_PICTURE_MAX_AXIS);
    const size_t count = (size_t)width * height;
    picture->pixels = malloc(count * sizeof *picture->pixels);
    if (!picture->pixels)
        return hs_fail(err, HS_ERR_MEMORY, "picture: no memory for %" PRIu32 " x %" PRIu32 " pixels", width,
                       height);
    picture->width = width;
    picture->height = height;
    for (size_t i = 0; i < count; i++) picture->pixels[i] = colour;
    return true;
}

void hs_picture_free(hs_picture *picture) {
    free(picture->pixels);
    memset(picture, 0, sizeof *picture);
}

static const char *software = "";

void hs_picture_software(const char *name) {
    software = name;
}

static void put_be32(uint8_t *to, uint32_t value) {
    for (unsigned i = 0; i < 4; i++) to[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Bytes of the chunk that names the software; `to` may be NULL. */
static size_t put_software(uint8_t *to) {
    static const char head[] = "tEXtSoftware"; /* the keyword with its 0 */
    const size_t length = strlen(software), text = 9 + length;
    if (length == 0) return 0;
    if (to) {
        put_be32(to, (uint32_t)text);
        memcpy(to + 4, head, sizeof head);
        for (size_t i = 0; i < length; i++) to[17 + i] = (uint8_t)software[i];
        put_be32(to + 8 + text, (uint32_t)crc32(0, to + 4, (uInt)(4 + text)));
    }
    return 12 + text;
}

enum { PNG_HEAD = 8 + 25 }; /* the signature, and the first chunk */

/* libpng's simple door writes no texts. `data` has room for the chunk. */
static void insert_software(uint8_t *data, size_t *bytes) {
    const size_t more = put_software(NULL);
    memmove(data + PNG_HEAD + more, data + PNG_HEAD, *bytes - PNG_HEAD);
    (void)put_software(data + PNG_HEAD);
    *bytes += more;
}

static bool write_png(const hs_picture *picture, const uint8_t *rgb, uint8_t **data, size_t *bytes,
                      hs_error *err) {
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = picture->width,
                       .height = picture->height,
                       .format = PNG_FORMAT_RGB};
    png_alloc_size_t room = PNG_IMAGE_PNG_SIZE_MAX(image);
    *data = malloc(room + put_software(NULL));
    if (!*data) return hs_fail(err, HS_ERR_MEMORY, "PNG: no memory");
    if (png_image_write_to_memory(&image, *data, &room, 0, rgb, 0, NULL)) {
        insert_software(*data, &room);
        uint8_t *fitting = realloc(*data, room);
        *data = fitting ? fitting : *data;
        *bytes = room;
        return true;
    }
    free(*data);
    *data = NULL;
    return hs_fail(err, HS_ERR_FAILED, "PNG: %s", image.message);
}

bool hs_picture_png(const hs_picture *picture, uint8_t **data, size_t *bytes, hs_error *err) {
    const size_t count = (size_t)picture->width * picture->height;
    *data = NULL;
    *bytes = 0;
    uint8_t *rgb = hs_memory(1, count * 3, "PNG", err);
    if (!rgb) return false;
    for (size_t i = 0; i < count; i++)
        for (unsigned c = 0; c < 3; c++) rgb[i * 3 + c] = (uint8_t)(picture->pixels[i] >> (16 - 8 * c));
    const bool ok = write_png(picture, rgb, data, bytes, err);
    free(rgb);
    return ok;
}

bool hs_picture_save(const hs_picture *picture, const char *path, hs_error *err) {
    uint8_t *data;
    size_t bytes;
    hs_output_file out;
    if (!hs_picture_png(picture, &data, &bytes, err)) return false;
    const bool ok = hs_output_open(&out, path, err);
    if (ok) (void)fwrite(data, 1, bytes, out.file);
    free(data);
    return ok && hs_output_commit(&out, err); /* fails if the writing did */
}

static bool read_png(hs_picture *out, FILE *file, png_image *image, const char *path, hs_error *err) {
    if (!png_image_begin_read_from_stdio(image, file))
        return hs_fail(err, HS_ERR_INPUT, "%s: cannot read the picture: %s", path, image->message);
    image->format = PNG_FORMAT_RGB;
    if (!hs_picture_init(out, image->width, image->height, 0, err)) return false;
    const size_t count = (size_t)image->width * image->height;
    uint8_t *rgb = malloc(count * 3);
    bool ok = rgb || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for the picture", path);
    if (ok && !png_image_finish_read(image, NULL, rgb, 0, NULL))
        ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot read the picture: %s", path, image->message);
    for (size_t i = 0; ok && i < count; i++)
        out->pixels[i] = (uint32_t)rgb[3 * i] << 16 | (uint32_t)rgb[3 * i + 1] << 8 | rgb[3 * i + 2];
    free(rgb);
    if (!ok) hs_picture_free(out);
    return ok;
}

bool hs_picture_load(hs_picture *out, const char *path, hs_error *err) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    uint64_t bytes;
    *out = (hs_picture){0};
    FILE *file = hs_input_open(path, path, &bytes, err);
    if (!file) return false;
    const bool ok = read_png(out, file, &image, path, err);
    png_image_free(&image);
    (void)fclose(file);
    return ok;
}

/* Colour of an image's pixel. */
static uint32_t image_pixel(const hs_image *image, uint32_t x, uint32_t y) {
    const uint8_t *p = image->data + ((size_t)y * image->width + x) * 4;
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

/* Where pixel `at` of `to` pixels falls among `from` pixels: the two neighbouring centres and the weight of
 * the second, in 256ths. */
typedef struct {
    uint32_t first, second, weight;
} tap;

static tap find_tap(uint32_t at, uint32_t to, uint32_t from, hs_scale scale) {
    if (scale == HS_SCALE_NEAREST) {
        const uint32_t i = (uint32_t)((uint64_t)at * from / to);
        return (tap){i, i, 0};
    }
    const double centre = (at + 0.5) * from / to - 0.5;
    if (centre <= 0.0) return (tap){0, 0, 0};
    const uint32_t i = (uint32_t)centre;
    if (i + 1 >= from) return (tap){from - 1, from - 1, 0};
    return (tap){i, i + 1, (uint32_t)((centre - i) * 256.0 + 0.5)};
}

static uint32_t sample(const hs_image *image, tap tx, tap ty) {
    if (tx.weight == 0 && ty.weight == 0) return image_pixel(image, tx.first, ty.first);
    const uint32_t corner[4] = {
        image_pixel(image, tx.first, ty.first), image_pixel(image, tx.second, ty.first),
        image_pixel(image, tx.first, ty.second), image_pixel(image, tx.second, ty.second)};
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        uint32_t c[4];
        for (int i = 0; i < 4; i++) c[i] = corner[i] >> shift & 255;
        const uint32_t top = c[0] * (256 - tx.weight) + c[1] * tx.weight;
        const uint32_t bottom = c[2] * (256 - tx.weight) + c[3] * tx.weight;
        out |= ((top * (256 - ty.weight) + bottom * ty.weight + 32768) >> 16) << shift;
    }
    return out;
}

/* The mean over columns x0 .. x1 and rows y0 .. y1, in pixels; parts of a pixel count as such. */
static uint32_t area_mean(const hs_image *image, double x0, double x1, double y0, double y1) {
    double sum[3] = {0}, whole = 0;
    for (uint32_t y = (uint32_t)y0; y < y1 && y < image->height; y++) {
        const double high = fmin(y + 1.0, y1) - fmax(y, y0);
        for (uint32_t x = (uint32_t)x0; x < x1 && x < image->width; x++) {
            const double part = high * (fmin(x + 1.0, x1) - fmax(x, x0));
            const uint32_t colour = image_pixel(image, x, y);
            for (unsigned c = 0; c < 3; c++) sum[c] += part * (colour >> (16 - 8 * c) & 255);
            whole += part;
        }
    }
    uint32_t out = 0;
    for (unsigned c = 0; c < 3; c++) out = out << 8 | (uint32_t)(sum[c] / whole + 0.5);
    return out;
}

/* One pixel of the picture: (i, j) of width x height. */
static uint32_t scaled_pixel(const hs_image *image, hs_scale scale, uint32_t i, uint32_t width, uint32_t j,
                             uint32_t height) {
    const double step_x = (double)image->width / width, step_y = (double)image->height / height;
    if (scale == HS_SCALE_SMOOTH && (step_x > 1.0 || step_y > 1.0))
        return area_mean(image, i * step_x, (i + 1.0) * step_x, j * step_y, (j + 1.0) * step_y);
    return sample(image, find_tap(i, width, image->width, scale), find_tap(j, height, image->height, scale));
}

void hs_picture_blit(hs_picture *picture, int32_t x, int32_t y, uint32_t width, uint32_t height,
                     const hs_image *image, hs_scale scale) {
    for (uint32_t j = 0; j < height; j++) {
        const int64_t py = (int64_t)y + j;
        if (py < 0 || py >= picture->height) continue;
        for (uint32_t i = 0; i < width; i++) {
            const int64_t px = (int64_t)x + i;
            if (px < 0 || px >= picture->width) continue;
            picture->pixels[(size_t)py * picture->width + (size_t)px] =
                scaled_pixel(image, scale, i, width, j, height);
        }
    }
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

/* Piecewise linear through `count` colours, t in 0 .. 1. */
static uint32_t interpolate(const uint32_t *colours, unsigned count, double t) {
    if (!(t > 0.0)) return colours[0];
    if (t >= 1.0) return colours[count - 1];
    const double at = t * (count - 1);
    const unsigned i = (unsigned)at;
    const double weight = at - i;
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        const double a = colours[i] >> shift & 255, b = colours[i + 1] >> shift & 255;
        out |= (uint32_t)(a + (b - a) * weight + 0.5) << shift;
    }
    return out;
}

uint32_t hs_colour_viridis(double t) {
    /* Viridis by N. Smith, S. van der Walt and E. Firing (matplotlib 2.0, 2015, CC0), sampled at ninths. */
    static const uint32_t points[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                      0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725};
    return interpolate(points, sizeof points / sizeof *points, t);
}

uint32_t hs_colour_diverging(double t) {
    /* The 11 classes of RdBu by C. Brewer (colorbrewer2.org, Apache 2.0), from blue to red. */
    static const uint32_t points[] = {0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7,
                                      0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};
    return interpolate(points, sizeof points / sizeof *points, (t + 1.0) * 0.5);
}
