/* SPDX-License-Identifier: MIT */
/* picture/canvas.h by Windows' own means: GDI draws white text on black, which is blended in the text's
 * colour. */
#include "core/system.h"
#include "picture/canvas.h"

#include <math.h>
#include <stdlib.h>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

struct hs_canvas {
    hs_picture *picture;
    HDC device;
    HFONT font;
    bool failed;
};

hs_canvas *hs_draw_begin(hs_picture *picture) {
    static hs_canvas none = {.failed = true};
    hs_canvas *on = malloc(sizeof *on);
    if (!on) return &none;
    *on = (hs_canvas){picture, CreateCompatibleDC(NULL), NULL, false};
    on->failed = !on->device;
    return on;
}

bool hs_draw_end(hs_canvas *on, hs_error *err) {
    const bool failed = on->failed;
    if (on->picture) {
        (void)DeleteDC(on->device);
        (void)DeleteObject(on->font);
        free(on);
    }
    return !failed || hs_fail(err, HS_ERR_MEMORY, "picture: Windows cannot draw its text");
}

void hs_draw_box(hs_canvas *on, double x, double y, double width, double height, uint32_t colour) {
    if (on->failed) return;
    const double right = fmin(round(x + width), on->picture->width),
                 bottom = fmin(round(y + height), on->picture->height);
    for (double row = fmax(round(y), 0.0); row < bottom; row += 1.0)
        for (double column = fmax(round(x), 0.0); column < right; column += 1.0)
            on->picture->pixels[(size_t)row * on->picture->width + (size_t)column] = colour;
}

void hs_canvas_size(hs_canvas *on, double size) {
    if (on->failed) return;
    HFONT font = CreateFontW((int)-round(size), 0, 0, 0, FW_NORMAL, FALSE, FALSE, FALSE, DEFAULT_CHARSET,
                             OUT_TT_PRECIS, CLIP_DEFAULT_PRECIS, ANTIALIASED_QUALITY,
                             DEFAULT_PITCH | FF_SWISS, L"DejaVu Sans");
    on->failed = !font || !SelectObject(on->device, font);
    (void)DeleteObject(on->font); /* which is not selected any more */
    on->font = font;
}

/* The text's size; its characters in `wide`, at most as many as it has bytes. */
static SIZE measure(const hs_canvas *on, const char *text, wchar_t wide[SYS_PATH], int *count) {
    SIZE size = {0, 0};
    *count = MultiByteToWideChar(CP_UTF8, 0, text, -1, wide, SYS_PATH) - 1;
    if (*count > 0) (void)GetTextExtentPoint32W(on->device, wide, *count, &size);
    return size;
}

double hs_canvas_width(hs_canvas *on, const char *text) {
    wchar_t wide[SYS_PATH];
    int count;
    return on->failed ? 0.0 : measure(on, text, wide, &count).cx;
}

/* Draws over the picture's pixels from (x, y) on by what the text covers of each. */
static void blend(const hs_picture *picture, int x, int y, SIZE size, const uint32_t *cover,
                  uint32_t colour) {
    for (int j = 0; j < size.cy; j++)
        for (int i = 0; i < size.cx; i++) {
            const int to_x = x + i, to_y = y + j;
            const uint32_t part = cover[j * size.cx + i] & 255;
            if (part == 0 || to_x < 0 || to_y < 0 || to_x >= (int)picture->width ||
                to_y >= (int)picture->height)
                continue;
            uint32_t *pixel = &picture->pixels[(size_t)to_y * picture->width + (size_t)to_x], out = 0;
            for (unsigned shift = 0; shift < 24; shift += 8)
                out |= (((colour >> shift & 255) * part + (*pixel >> shift & 255) * (255 - part) + 127) / 255)
                       << shift;
            *pixel = out;
        }
}

void hs_canvas_text(hs_canvas *on, double x, double y, uint32_t colour, const char *text) {
    wchar_t wide[SYS_PATH];
    void *cover;
    int count;
    if (on->failed) return;
    const SIZE size = measure(on, text, wide, &count);
    if (size.cx <= 0 || size.cy <= 0) return;
    const BITMAPINFO shape = {
        .bmiHeader = {sizeof shape.bmiHeader, size.cx, -size.cy, 1, 32}}; /* from the top */
    HBITMAP bitmap = CreateDIBSection(on->device, &shape, DIB_RGB_COLORS, &cover, NULL, 0);
    TEXTMETRICW metric = {0};
    on->failed = !bitmap;
    if (!bitmap) return;
    HGDIOBJ before = SelectObject(on->device, bitmap);
    (void)SetTextColor(on->device, RGB(255, 255, 255));
    (void)SetBkColor(on->device, RGB(0, 0, 0));
    (void)GetTextMetricsW(on->device, &metric);
    (void)TextOutW(on->device, 0, 0, wide, count);
    (void)GdiFlush();
    blend(on->picture, (int)round(x), (int)round(y) - metric.tmAscent, size, cover, colour);
    (void)SelectObject(on->device, before);
    (void)DeleteObject(bitmap);
}

void hs_picture_finish(void) {}
