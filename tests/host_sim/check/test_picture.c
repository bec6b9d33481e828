/* SPDX-License-Identifier: MIT */
/* hs_picture: colours, scaling, files, and where and how each kind of map is drawn. */
#include "picture/picture.h"
#include "picture/picture_draw.h"
#include "show/picture_map.h"
#include "smartvis_plugin.h"
#include "support/metaimage_files.h"

#include <math.h>
#include <png.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

static int teardown(void **state) {
    hs_picture_finish();
    const int left = files_count();
    return files_teardown(state) || left;
}

static void free_picture(void *picture) {
    hs_picture_free(picture);
}

/* It is kept for the test. */
static hs_picture blank(uint32_t width, uint32_t height, uint32_t colour) {
    hs_picture *p = unit_memory(sizeof *p);
    must(hs_picture_init(p, width, height, colour, &err));
    unit_keep(free_picture, p);
    return *p;
}

static uint32_t pixel(const hs_picture *p, uint32_t x, uint32_t y) {
    assert_true(x < p->width && y < p->height);
    return p->pixels[(size_t)y * p->width + x];
}

/* CIE 1976 lightness of an sRGB colour (IEC 61966-2-1, D65 white). */
static double lightness(uint32_t colour) {
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    double y = 0.0;
    for (int c = 0; c < 3; c++) {
        const double v = (colour >> (16 - 8 * c) & 255) / 255.0;
        y += weight[c] * (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
    }
    return y > 216.0 / 24389.0 ? 116.0 * cbrt(y) - 16.0 : y * 24389.0 / 27.0;
}

/* Viridis is made so that equal steps look equal: its lightness rises along a straight line. 2.5 of 100 is
 * about the smallest difference that is seen side by side; the published map itself stays within 2. */
static void viridis_is_perceptually_uniform(void **state) {
    assert_int_equal(hs_colour_viridis(0.0), 0x440154);
    assert_int_equal(hs_colour_viridis(1.0), 0xfde725);
    const double low = lightness(0x440154), high = lightness(0xfde725);
    double before = 0.0;
    for (int i = 0; i <= 64; i++) { /* steps of 1.2 in lightness: above what rounding to 8 bit does */
        const double l = lightness(hs_colour_viridis(i / 64.0));
        assert_true(l > before);
        assert_true(fabs(l - (low + (high - low) * i / 64.0)) < 2.5);
        before = l;
    }
    assert_int_equal(hs_colour_viridis(-5.0), 0x440154);
    assert_int_equal(hs_colour_viridis(7.0), 0xfde725);
    assert_int_equal(hs_colour_viridis(NAN), 0x440154);
}

static void the_diverging_map_is_white_in_the_middle(void **state) {
    assert_int_equal(hs_colour_diverging(0.0), 0xf7f7f7);
    for (int i = 1; i <= 100; i++) {
        const uint32_t red = hs_colour_diverging(i / 100.0), blue = hs_colour_diverging(-i / 100.0);
        assert_true((red >> 16) > (red & 255));
        assert_true((blue & 255) > (blue >> 16));
        assert_true(lightness(red) < lightness(hs_colour_diverging((i - 1) / 100.0)));
        assert_true(lightness(blue) < lightness(hs_colour_diverging(-(i - 1) / 100.0)));
    }
}

static void a_picture_has_limits(void **state) {
    static const uint32_t bad[][2] = {{0, 5}, {5, 0}, {16385, 1}, {1, UINT32_MAX}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        hs_picture p;
        must_not(hs_picture_init(&p, bad[i][0], bad[i][1], 0, &err), HS_ERR_INPUT, "");
        assert_null(p.pixels);
        hs_picture_free(&p);
    }
}

/* Kept for the test. */
static hs_image gray_image(const uint8_t *gray, uint32_t width, uint32_t height) {
    const size_t pixels = (size_t)width * height;
    uint8_t *rgba = unit_memory(pixels * 4);
    for (size_t i = 0; i < pixels * 4; i++) rgba[i] = gray[i / 4];
    return (hs_image){rgba, width, height};
}

static void blit_scales_and_clips(void **state) {
    static const uint8_t gray[6] = {0, 100, 200, 10, 110, 210}, black[4] = {0};
    const hs_image image = gray_image(gray, 3, 2);
    hs_picture p = blank(9, 6, 0x123456);
    hs_picture_blit(&p, 0, 0, 9, 6, &image, HS_SCALE_NEAREST); /* 3 x 3 pixels for each */
    for (uint32_t y = 0; y < 6; y++)
        for (uint32_t x = 0; x < 9; x++)
            assert_int_equal(pixel(&p, x, y), gray[y / 3 * 3 + x / 3] * 0x010101);

    /* Bilinear by 3: target pixel 1, 4, 7 are the sources' centres, between them thirds of the way, edges
     * repeated. */
    hs_picture_blit(&p, 0, 0, 9, 6, &image, HS_SCALE_SMOOTH);
    static const int top[9] = {0, 0, 33, 67, 100, 133, 167, 200, 200};
    for (uint32_t x = 0; x < 9; x++) {
        assert_true(abs((int)(pixel(&p, x, 0) & 255) - top[x]) <= 1); /* weights are 256ths */
        assert_true(abs((int)(pixel(&p, x, 5) & 255) - top[x] - 10) <= 1);
    }
    assert_int_equal(pixel(&p, 4, 1), 0x646464);

    for (size_t i = 0; i < 54; i++) p.pixels[i] = 7;
    hs_picture_blit(&p, -2, -1, 3, 2, &image, HS_SCALE_NEAREST); /* only its last pixel is inside */
    assert_int_equal(pixel(&p, 0, 0), 210 * 0x010101);
    assert_int_equal(pixel(&p, 1, 0), 7);
    hs_picture_blit(&p, 8, 5, UINT32_MAX / 2, 1, &(hs_image){black, 1, 1}, HS_SCALE_NEAREST);
    assert_int_equal(pixel(&p, 8, 5), 0);
    static const uint8_t rgba[4] = {1, 2, 3, 0};
    hs_picture_blit(&p, 3, 3, 1, 1, &(hs_image){rgba, 1, 1}, HS_SCALE_SMOOTH);
    assert_int_equal(pixel(&p, 3, 3), 0x010203); /* alpha does not count */
}

/* Where it becomes smaller every pixel is the mean of what it covers, parts of pixels included. */
static void a_smaller_picture_does_not_alias(void **state) {
    static const uint8_t gray[6] = {0, 90, 240, 30, 120, 60};
    const hs_image image = gray_image(gray, 3, 2);
    hs_picture p = blank(16, 16, 0);
    hs_picture_blit(&p, 0, 0, 2, 1, &image, HS_SCALE_SMOOTH);
    /* Columns 0 .. 1.5 and 1.5 .. 3 of both rows: (0 + 30 + (90 + 120) / 2) / 3, (240 + 60 + 105) / 3. */
    assert_int_equal(pixel(&p, 0, 0), 45 * 0x010101);
    assert_int_equal(pixel(&p, 1, 0), 135 * 0x010101);
    /* A board of single black and white pixels is grey, at every size below its own. */
    static uint8_t board[64 * 64];
    for (uint32_t i = 0; i < 64 * 64; i++) board[i] = (i + i / 64) % 2 ? 255 : 0;
    const hs_image cells_image = gray_image(board, 64, 64);
    for (uint32_t side = 1; side <= 16; side++) {
        const double cells = 64.0 / side * 64.0 / side; /* in a pixel: at most one more of either colour */
        hs_picture_blit(&p, 0, 0, side, side, &cells_image, HS_SCALE_SMOOTH);
        for (uint32_t i = 0; i < side * side; i++)
            assert_true(fabs((double)(pixel(&p, i % side, i / side) & 255) - 127.5) <= 127.5 / cells + 0.5);
    }
}

static void a_saved_png_reads_back(void **state) {
    hs_error err = {0};
    const char *const path = files_path("a.png");
    hs_picture p = blank(37, 11, 0);
    for (uint32_t i = 0; i < 37 * 11; i++) p.pixels[i] = i * 2654435761u & 0xffffff;
    assert_true(hs_picture_save(&p, path, &err));
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_int_equal(image.width, 37);
    assert_int_equal(image.height, 11);
    image.format = PNG_FORMAT_RGB;
    uint8_t rgb[37 * 11 * 3];
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    for (uint32_t i = 0; i < 37 * 11; i++)
        assert_int_equal((uint32_t)rgb[3 * i] << 16 | (uint32_t)rgb[3 * i + 1] << 8 | rgb[3 * i + 2],
                         p.pixels[i]);

    /* A disk that fills up: a message, and the earlier file as it was. */
    const struct rlimit small = {100, RLIM_INFINITY};
    struct rlimit limit;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){small.rlim_cur, limit.rlim_max}), 0);
    assert_false(hs_picture_save(&p, path, &err));
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    unit_told(err, HS_ERR_OUTPUT, path);
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(&image, path));
    png_image_free(&image);
    assert_int_equal(unlink(path), 0);
}

/* The text of a PNG file; libpng stops at a chunk whose sum is wrong. */
static void software_of(const char *path, char *out, size_t bytes) {
    png_textp texts;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    const int count = png_get_text(png, info, &texts, NULL);
    *out = '\0';
    if (count == 1) (void)snprintf(out, bytes, "%s=%s", texts[0].key, texts[0].text);
    png_destroy_read_struct(&png, &info, NULL);
    (void)fclose(file);
}

static void a_png_names_its_software(void **state) {
    hs_error err = {0};
    const char *const path = files_path("a.png");
    char text[100];
    hs_picture p = blank(5, 3, 0);
    assert_true(hs_picture_save(&p, path, &err));
    software_of(path, text, sizeof text);
    assert_string_equal(text, "");
    hs_picture_software("SmartVis 1.2.3+abcdef");
    const bool saved = hs_picture_save(&p, path, &err);
    hs_picture_software("");
    assert_true(saved);
    software_of(path, text, sizeof text);
    assert_string_equal(text, "Software=SmartVis 1.2.3+abcdef");
    assert_int_equal(unlink(path), 0);
}

static void a_place_that_cannot_be_written_is_named(void **state) {
    hs_error err = {0};
    hs_picture p = blank(4, 4, 0);
    const char *const path = files_path("absent/a.png");
    assert_false(hs_picture_save(&p, path, &err));
    unit_told(err, HS_ERR_OUTPUT, path);
    assert_non_null(strstr(err.text, "No such file or directory"));
    err = (hs_error){0};
    assert_false(hs_picture_save(&p, "/dev/full", &err)); /* a device is not replaced by a file */
    assert_non_null(strstr(err.text, "/dev/full: cannot be written: exists and is not a regular file"));
}

/* The box of pixels that differ from the background; 0 0 0 0 if none does. */
static void ink_box(const hs_picture *p, uint32_t box[4]) {
    box[0] = p->width, box[1] = p->height, box[2] = box[3] = 0;
    for (uint32_t y = 0; y < p->height; y++)
        for (uint32_t x = 0; x < p->width; x++) {
            if (pixel(p, x, y) == 0) continue;
            box[0] = x < box[0] ? x : box[0];
            box[1] = y < box[1] ? y : box[1];
            box[2] = x + 1 > box[2] ? x + 1 : box[2];
            box[3] = y + 1 > box[3] ? y + 1 : box[3];
        }
}

static void text_stays_in_its_place(void **state) {
    static const char *const texts[] = {"full volume", "fit me: as long as the picture is wide, and longer",
                                        "caf\xc3\xa9 20 \xc2\xb5m",
                                        "broken \xff\xfe \xed\xa0\x80 \xc0\xaf name"};
    for (size_t i = 0; i < 4; i++) {
        for (int align = HS_ALIGN_LEFT; align <= HS_ALIGN_RIGHT; align++) {
            uint32_t box[4];
            hs_picture p = blank(300, 60, 0);
            must(hs_picture_text(&p, 150, 40, 20, 0xffffff, (hs_align)align, 120, texts[i], &err));
            ink_box(&p, box);
            const uint32_t left = align == HS_ALIGN_LEFT ? 150 : align == HS_ALIGN_CENTRE ? 90 : 30;
            assert_true(box[0] + 2 >= left &&
                        box[2] <= left + 122); /* glyphs may reach over by a pixel or two */
            assert_true(box[1] >= 20 && box[3] <= 46 && box[3] >= 40); /* stands on y = 40 */
            assert_true(box[2] - box[0] >= 60);
        }
    }
}

/* A text a fifth too long is set smaller, whole: 20 pixels become 16, and its letters are a fifth lower. */
static void a_long_text_is_set_smaller_first(void **state) {
    uint32_t box[2][4];
    for (int i = 0; i < 2; i++) {
        hs_picture p = blank(300, 60, 0);
        const double max_width = i == 0 ? 0.0 : 0.8 * (box[0][2] - box[0][0]);
        must(hs_picture_text(&p, 10, 40, 20, 0xffffff, HS_ALIGN_LEFT, max_width, "lldldldldldl", &err));
        ink_box(&p, box[i]);
    }
    const double wide = box[0][2] - box[0][0], high = box[0][3] - box[0][1];
    assert_true(fabs((box[1][2] - box[1][0]) / wide - 0.8) < 0.04);
    assert_true(fabs((box[1][3] - box[1][1]) - 0.8 * high) <= 1.0); /* whole pixels */
}

static void three_panels_make_1600_pixels(void **state) {
    static uint8_t rgba[3][64 * 64 * 4];
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < sizeof rgba[i]; k++) rgba[i][k] = (uint8_t)(60 * (i + 1));
    hs_panel_item items[3] = {
        {"result", {rgba[0], 64, 64}}, {"full volume", {rgba[1], 64, 64}}, {NULL, {rgba[2], 64, 64}}};
    const hs_caption caption = {"title", "one\ntwo"};
    hs_picture p, bare;
    must(hs_picture_panel(&p, items, 3, 0, &caption, &err));
    assert_int_equal(p.width, 1600);
    for (uint32_t i = 0; i < 3; i++) /* 16 pixels between pictures of 512 */
        for (uint32_t at = 0; at < 512; at += 511)
            assert_int_equal(pixel(&p, 16 + i * 528 + at, 300), 60 * (i + 1) * 0x010101);
    assert_int_equal(pixel(&p, 15, 300), HS_COLOUR_BACKGROUND);
    assert_int_equal(pixel(&p, 16 + 512, 300), HS_COLOUR_BACKGROUND);
    must(hs_picture_panel(&bare, items, 1, 128, &(hs_caption){NULL, NULL}, &err));
    assert_int_equal(bare.width, 160);
    hs_picture_free(&bare);
    hs_picture_free(&p);
}

/* Where entry (x, y) of an 8 x 8 map is drawn: 768 / 8 = 96 pixels each, after a margin of 16 and a title
 * of 44. */
static uint32_t map_pixel(const hs_picture *p, uint32_t x, uint32_t y) {
    return pixel(p, 16 + x * 96 + 48, 44 + y * 96 + 48);
}

static bool is_hatch(uint32_t colour) {
    return colour == HS_COLOUR_NOTHING_A || colour == HS_COLOUR_NOTHING_B;
}

static void a_depthmap_shows_depths_and_what_clips_nothing(void **state) {
    float depth[64];
    for (int i = 0; i < 64; i++) depth[i] = 10.0f + (float)i;
    depth[1] = 0.0f, depth[2] = -4.0f, depth[3] = NAN, depth[4] = INFINITY;
    hs_picture p;
    const hs_caption caption = {"depth", NULL};
    must(hs_picture_depthmap(&p, depth, 8, 8, &caption, &err));
    assert_int_equal(map_pixel(&p, 0, 0), 0x440154); /* the smallest, 10 */
    assert_int_equal(map_pixel(&p, 7, 7), 0xfde725); /* the largest, 73 */
    assert_int_equal(map_pixel(&p, 4, 4), hs_colour_viridis((46.0 - 10.0) / 63.0));
    assert_true(is_hatch(map_pixel(&p, 1, 0)) && is_hatch(map_pixel(&p, 2, 0)));
    assert_int_equal(map_pixel(&p, 3, 0), HS_COLOUR_INVALID);
    assert_int_equal(map_pixel(&p, 4, 0), HS_COLOUR_INVALID);
    hs_picture_free(&p);
    memset(depth, 0, sizeof depth);
    must(hs_picture_depthmap(&p, depth, 8, 8, &caption, &err));
    for (uint32_t i = 0; i < 64; i++) assert_true(is_hatch(map_pixel(&p, i % 8, i / 8)));
    hs_picture_free(&p);
    must_not(hs_picture_depthmap(&p, depth, 0, 8, &caption, &err), HS_ERR_INPUT, "map is 0 x 8");
}

static void signed_maps_and_shares_use_their_colours(void **state) {
    float value[64] = {0};
    value[0] = 4.0f, value[1] = -2.0f, value[2] = NAN, value[3] = -4.0f;
    const hs_signed_words words = {"error", "steps", "occluder left", "fetus cut"};
    hs_picture p;
    must(hs_picture_signed(&p, value, 8, 8, 4.0f, &words, &(hs_caption){"error", NULL}, &err));
    assert_int_equal(map_pixel(&p, 0, 0), hs_colour_diverging(1.0));
    assert_int_equal(map_pixel(&p, 1, 0), hs_colour_diverging(-0.5));
    assert_int_equal(map_pixel(&p, 2, 0), HS_COLOUR_NO_VALUE);
    assert_int_equal(map_pixel(&p, 3, 0), hs_colour_diverging(-1.0));
    assert_int_equal(map_pixel(&p, 4, 0), 0xf7f7f7);
    hs_picture_free(&p);
    const hs_share_words shares = {"confidence", "sure", "unsure"};
    float share[64] = {0};
    share[0] = 1.0f, share[1] = 0.25f, share[2] = NAN, share[3] = 1.01f, share[4] = -0.01f;
    must(hs_picture_share(&p, share, 8, 8, &shares, &(hs_caption){"shares", NULL}, &err));
    assert_int_equal(map_pixel(&p, 0, 0), hs_colour_viridis(1.0));
    assert_int_equal(map_pixel(&p, 1, 0), hs_colour_viridis(0.25));
    for (uint32_t i = 2; i < 5; i++) assert_int_equal(map_pixel(&p, i, 0), HS_COLOUR_INVALID);
    assert_int_equal(map_pixel(&p, 5, 0), hs_colour_viridis(0.0));
    hs_picture_free(&p);
}

/* Sizes from 1 x 1 to more than the picture has pixels: drawn without a look outside (ASan), the same each
 * time. */
static void odd_sizes_are_drawn(void **state) {
    static const uint32_t sizes[][2] = {{1, 1},    {1, 500},  {500, 1}, {171, 128},
                                        {1281, 3}, {3000, 2}, {2, 3000}};
    float *depth = unit_memory(sizeof(float) * 171 * 128);
    for (int i = 0; i < 171 * 128; i++) depth[i] = (float)(i % 97) * 1e-3f;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        hs_picture a, b;
        must(hs_picture_depthmap(&a, depth, sizes[i][0], sizes[i][1], &(hs_caption){NULL, "x"}, &err));
        must(hs_picture_depthmap(&b, depth, sizes[i][0], sizes[i][1], &(hs_caption){NULL, "x"}, &err));
        assert_true(a.width <= 1280 + 400 && a.height <= 1280 + 100);
        assert_memory_equal(a.pixels, b.pixels, (size_t)a.width * a.height * sizeof *a.pixels);
        hs_picture_free(&a);
        hs_picture_free(&b);
    }
}

UNIT_MAIN(files_setup, teardown, viridis_is_perceptually_uniform, the_diverging_map_is_white_in_the_middle,
          a_picture_has_limits, blit_scales_and_clips, a_smaller_picture_does_not_alias,
          a_saved_png_reads_back, a_png_names_its_software, a_place_that_cannot_be_written_is_named,
          text_stays_in_its_place, a_long_text_is_set_smaller_first, three_panels_make_1600_pixels,
          a_depthmap_shows_depths_and_what_clips_nothing, signed_maps_and_shares_use_their_colours,
          odd_sizes_are_drawn)
