/* Renderings as JPEG: speckle does not compress without loss, and a page holds many of them. */
#include "hs_picture.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

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

/* libjpeg's way of failing: it must not return from error_exit. */
typedef struct {
    struct jpeg_error_mgr base;
    jmp_buf back;
    char text[JMSG_LENGTH_MAX];
} failure;

static void leave(j_common_ptr info) {
    failure *f = (failure *)(void *)info->err;
    info->err->format_message(info, f->text);
    longjmp(f->back, 1);
}

static void keep_quiet(j_common_ptr info) {
    (void)info; /* warnings are about reading */
}

/* What must survive the jump is in the caller's structs, not in automatic variables. */
static bool compress(struct jpeg_compress_struct *jpeg, failure *f, const hs_picture *picture, uint8_t *row,
                     int quality, unsigned char **data, unsigned long *bytes) {
    if (setjmp(f->back)) return false;
    jpeg_create_compress(jpeg);
    jpeg_mem_dest(jpeg, data, bytes);
    jpeg->image_width = picture->width;
    jpeg->image_height = picture->height;
    jpeg->input_components = 3;
    jpeg->in_color_space = JCS_RGB;
    jpeg_set_defaults(jpeg);
    jpeg_set_quality(jpeg, quality, TRUE);
    jpeg->optimize_coding = TRUE;
    jpeg_start_compress(jpeg, TRUE);
    while (jpeg->next_scanline < picture->height) {
        const uint32_t *pixels = picture->pixels + (size_t)jpeg->next_scanline * picture->width;
        for (uint32_t x = 0; x < picture->width; x++)
            for (unsigned c = 0; c < 3; c++) row[3 * (size_t)x + c] = (uint8_t)(pixels[x] >> (16 - 8 * c));
        (void)jpeg_write_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_compress(jpeg);
    return true;
}

bool hs_picture_jpeg(const hs_picture *picture, int quality, uint8_t **data, size_t *bytes, hs_error *err) {
    struct jpeg_compress_struct jpeg = {0};
    failure f;
    unsigned long length = 0;
    uint8_t *row = malloc((size_t)picture->width * 3);
    *data = NULL;
    *bytes = 0;
    if (!row) return hs_fail(err, HS_ERR_MEMORY, "JPEG: no memory for a row of %u pixels", picture->width);
    jpeg.err = jpeg_std_error(&f.base);
    f.base.error_exit = leave;
    f.base.output_message = keep_quiet;
    bool ok = compress(&jpeg, &f, picture, row, quality, data, &length);
    jpeg_destroy_compress(&jpeg);
    free(row);
    if (!ok) {
        free(*data);
        *data = NULL;
        return hs_fail(err, HS_ERR_FAILED, "JPEG: %u x %u pixels: %s", picture->width, picture->height,
                       f.text);
    }
    *bytes = length;
    return true;
}
