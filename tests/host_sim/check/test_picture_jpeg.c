/* SPDX-License-Identifier: MIT */
/* Renderings as JPEG: what a page shows must be the picture, and smaller. */
#include "picture/picture.h"
#include "support/unit.h"

#include <turbojpeg.h>
#include <unistd.h>

enum { WIDTH = 97, HEIGHT = 50 };

/* Smooth, with all three channels different. */
static uint32_t colour_at(uint32_t x, uint32_t y) {
    return (x * 255 / WIDTH) << 16 | (y * 255 / HEIGHT) << 8 | ((x + y) * 255 / (WIDTH + HEIGHT));
}

static hs_picture make(void) {
    hs_picture p;
    must(hs_picture_init(&p, WIDTH, HEIGHT, 0, &err));
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) p.pixels[i] = colour_at(i % WIDTH, i / WIDTH);
    return p;
}

static void a_png_is_loaded_as_it_was_saved(void **state) {
    char path[] = "/tmp/sv_jpeg_XXXXXX";
    hs_error err = {0};
    hs_picture p = make(), q;
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_true(hs_picture_save(&p, path, &err));
    assert_true(hs_picture_load(&q, path, &err));
    assert_int_equal(q.width, WIDTH);
    assert_int_equal(q.height, HEIGHT);
    assert_memory_equal(q.pixels, p.pixels, sizeof(uint32_t) * WIDTH * HEIGHT);
    hs_picture_free(&q);
    /* Half a file, no picture, no file: each named, and nothing left behind. */
    assert_int_equal(truncate(path, 200), 0);
    assert_false(hs_picture_load(&q, path, &err));
    unit_told(err, HS_ERR_INPUT, path);
    assert_null(q.pixels);
    assert_int_equal(truncate(path, 0), 0);
    err = (hs_error){0};
    assert_false(hs_picture_load(&q, path, &err));
    assert_int_equal(unlink(path), 0);
    err = (hs_error){0};
    assert_false(hs_picture_load(&q, path, &err));
    assert_int_equal(err.code, HS_ERR_INPUT);
    (void)close(file);
    hs_picture_free(&p);
}

static void a_jpeg_shows_the_picture(void **state) {
    hs_picture p = make();
    uint8_t *data[2];
    size_t bytes[2];
    must(hs_picture_jpeg(&p, 88, &data[0], &bytes[0], &err));
    must(hs_picture_jpeg(&p, 30, &data[1], &bytes[1], &err));
    assert_true(bytes[1] < bytes[0] && bytes[0] < WIDTH * HEIGHT);
    static uint8_t rgb[3 * WIDTH * HEIGHT];
    tjhandle handle = tjInitDecompress();
    assert_non_null(handle);
    int width, height, sampling, space;
    assert_int_equal(tjDecompressHeader3(handle, data[0], bytes[0], &width, &height, &sampling, &space), 0);
    assert_true(width == WIDTH && height == HEIGHT);
    assert_int_equal(tjDecompress2(handle, data[0], bytes[0], rgb, WIDTH, 0, HEIGHT, TJPF_RGB, 0), 0);
    uint64_t off = 0;
    for (uint32_t i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const uint32_t colour = colour_at(i / 3 % WIDTH, i / 3 / WIDTH);
        off += (uint64_t)abs((int)rgb[i] - (int)(colour >> (16 - 8 * (i % 3)) & 255));
    }
    assert_true((double)off / (3 * WIDTH * HEIGHT) < 2.0); /* levels: quality 88 of a smooth picture */
    assert_int_equal(tjDestroy(handle), 0);
    for (int i = 0; i < 2; i++) free(data[i]);
    hs_picture_free(&p);
}

/* The library's own failure must come back as an error: a side of more than 65500 pixels. */
static void an_impossible_jpeg_is_refused(void **state) {
    static uint32_t pixel = 0;
    uint8_t *data;
    size_t bytes;
    const hs_picture p = {.width = 1, .height = 70000, .pixels = &pixel};
    must_not(hs_picture_jpeg(&p, 88, &data, &bytes, &err), HS_ERR_FAILED, "1 x 70000");
    assert_null(data);
}

UNIT_MAIN(NULL, NULL, a_png_is_loaded_as_it_was_saved, a_jpeg_shows_the_picture,
          an_impossible_jpeg_is_refused)
