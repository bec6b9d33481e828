/* SPDX-License-Identifier: MIT */
#include "page/page_html.h"

#include "picture/picture.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK         3072u /* bytes that become base64 at once: a multiple of three */
#define PHOTO_QUALITY 88    /* of 100: from here on more bytes show no more */

static const char head[] =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n"
    "body{font:16px/1.5 system-ui,sans-serif;color:#1c2024;background:#fff;max-width:70rem;margin:0 "
    "auto;padding:1rem}\n"
    "h1{font-size:1.7rem;line-height:1.2}h2{margin-top:2.5rem;border-bottom:1px solid "
    "#d5d9de;padding-bottom:.3rem}\n"
    "p{max-width:46rem}\n"
    ".row{display:flex;flex-wrap:wrap;gap:1rem}\n"
    "figure{margin:0;flex:1 1 13rem;min-width:0}\n"
    "img{width:100%;height:auto;display:block;border-radius:4px;background:#000}\n"
    "figcaption{font-size:.9rem;color:#4a5058;margin-top:.3rem}\n"
    ".wide{overflow-x:auto}\n"
    "table{border-collapse:collapse;margin:1rem 0}\n"
    "th,td{padding:.3rem .55rem;text-align:right;border-bottom:1px solid #e3e6ea;white-space:nowrap;\n"
    "font-variant-numeric:tabular-nums}\n"
    "tr:first-child>*{white-space:normal;vertical-align:bottom}\n"
    "th:first-child,td:first-child{text-align:left}tr:first-child>*{border-bottom:2px solid "
    "#9aa1a9;font-weight:600}\n"
    "pre{overflow-x:auto;background:#f4f5f7;padding:.8rem;font-size:.8rem;line-height:1.35}\n"
    "summary{cursor:pointer;color:#0b5cad}\n"
    ".plot{display:block;width:100%;min-width:30rem;max-width:50rem;height:auto;margin:1rem 0}\n"
    ".slider{flex:1 1 13rem;max-width:22rem}.slider input{display:block;width:100%;margin:.4rem 0}.slider "
    "figure[hidden]{display:none}\n"
    "@media print{.slider input{display:none}h2,figure,svg{break-inside:avoid}}\n"
    "</style>\n<title>";

/* Writes unless something failed before. */
static void put_bytes(hs_page *page, const void *data, size_t bytes) {
    if (page->error.code == HS_OK) (void)hs_output_write(&page->output, data, bytes, &page->error);
}

static void put(hs_page *page, const char *markup) {
    put_bytes(page, markup, strlen(markup));
}

/* Text with the characters that HTML reads as markup replaced. */
static void put_text(hs_page *page, const char *text) {
    for (const char *c = text; *c; c++) {
        switch (*c) {
        case '&':
            put(page, "&amp;");
            break;
        case '<':
            put(page, "&lt;");
            break;
        case '>':
            put(page, "&gt;");
            break;
        case '"':
            put(page, "&quot;");
            break;
        default:
            put_bytes(page, c, 1);
            break;
        }
    }
}

void hs_page_open(hs_page *page, const char *path, const char *title) {
    *page = (hs_page){0};
    if (!hs_output_open(&page->output, path, &page->error)) return;
    put(page, head);
    put_text(page, title);
    put(page, "</title>\n</head>\n<body>\n<h1>");
    put_text(page, title);
    put(page, "</h1>\n");
}

void hs_page_heading(hs_page *page, int level, const char *text) {
    put(page, level == 2 ? "<h2>" : "<h3>");
    put_text(page, text);
    put(page, level == 2 ? "</h2>\n" : "</h3>\n");
}

void hs_page_text(hs_page *page, const char *text) {
    put(page, "<p>");
    put_text(page, text);
    put(page, "</p>\n");
}

void hs_page_row_begin(hs_page *page) {
    put(page, "<div class=\"row\">\n");
}

void hs_page_row_end(hs_page *page) {
    put(page, "</div>\n");
}

/* One group of 1 to 3 bytes as four characters (RFC 4648, section 4). */
static void base64_group(const unsigned char *bytes, size_t count, char out[4]) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned value = (unsigned)bytes[0] << 16 | (count > 1 ? (unsigned)bytes[1] << 8 : 0u) |
                           (count > 2 ? (unsigned)bytes[2] : 0u);
    out[0] = digits[value >> 18 & 63];
    out[1] = digits[value >> 12 & 63];
    out[2] = count > 1 ? digits[value >> 6 & 63] : '=';
    out[3] = count > 2 ? digits[value & 63] : '=';
}

/* Bytes as base64, in blocks of whole groups: only the last group may be short. */
static void put_base64(hs_page *page, const unsigned char *bytes, size_t count) {
    char text[BLOCK / 3 * 4];
    while (count > 0) {
        const size_t block = count < BLOCK ? count : BLOCK;
        size_t length = 0;
        for (size_t i = 0; i < block; i += 3, length += 4)
            base64_group(bytes + i, block - i < 3 ? block - i : 3, text + length);
        put_bytes(page, text, length);
        bytes += block;
        count -= block;
    }
}

/* A file as base64, in blocks whose size is a multiple of three so that only the last is padded. */
static void put_file(hs_page *page, const char *path) {
    unsigned char block[BLOCK];
    FILE *file = fopen(path, "rb");
    if (!file) {
        (void)hs_fail(&page->error, HS_ERR_INPUT, "%s: cannot read the picture: %s", path, strerror(errno));
        return;
    }
    for (size_t got; (got = fread(block, 1, sizeof block, file)) > 0;) put_base64(page, block, got);
    if (ferror(file)) (void)hs_fail(&page->error, HS_ERR_INPUT, "%s: reading the picture failed", path);
    (void)fclose(file);
}

/* A PNG file's picture as JPEG and base64. */
static void put_jpeg(hs_page *page, const char *path) {
    hs_picture picture;
    uint8_t *data = NULL;
    size_t bytes = 0;
    if (!hs_picture_load(&picture, path, &page->error)) return;
    if (hs_picture_jpeg(&picture, PHOTO_QUALITY, &data, &bytes, &page->error)) put_base64(page, data, bytes);
    free(data);
    hs_picture_free(&picture);
}

static void put_figure(hs_page *page, const char *path, const char *alt, const char *caption, bool photo) {
    put(page, "<figure><img alt=\"");
    put_text(page, alt);
    put(page, photo ? "\" src=\"data:image/jpeg;base64," : "\" src=\"data:image/png;base64,");
    if (page->error.code == HS_OK) (photo ? put_jpeg : put_file)(page, path);
    put(page, "\"><figcaption>");
    put_text(page, caption);
    put(page, "</figcaption></figure>\n");
}

void hs_page_picture(hs_page *page, const char *path, const char *alt, const char *caption) {
    put_figure(page, path, alt, caption, false);
}

void hs_page_photo(hs_page *page, const char *path, const char *alt, const char *caption) {
    put_figure(page, path, alt, caption, true);
}

void hs_page_table_begin(hs_page *page) {
    put(page, "<div class=\"wide\"><table>\n");
}

void hs_page_table_row(hs_page *page, const char *const *cells, unsigned count) {
    put(page, "<tr>");
    for (unsigned i = 0; i < count; i++) {
        put(page, i ? "<td>" : "<th>");
        put_text(page, cells[i]);
        put(page, i ? "</td>" : "</th>");
    }
    put(page, "</tr>\n");
}

void hs_page_table_end(hs_page *page) {
    put(page, "</table></div>\n");
}

void hs_page_markup(hs_page *page, const char *markup) {
    put(page, markup);
}

void hs_page_slider_begin(hs_page *page, const char *label, unsigned count, unsigned shown) {
    char range[96];
    page->has_slider = true;
    put(page, "<div class=\"slider\"><label>");
    put_text(page, label);
    (void)snprintf(range, sizeof range,
                   " <input type=\"range\" min=\"0\" max=\"%u\" step=\"1\" value=\"%u\">", count - 1, shown);
    put(page, range);
    put(page, "</label>\n");
}

void hs_page_slider_end(hs_page *page) {
    put(page, "</div>\n");
}

void hs_page_folded(hs_page *page, const char *summary, const char *text) {
    put(page, "<details><summary>");
    put_text(page, summary);
    put(page, "</summary><pre>");
    put_text(page, text);
    put(page, "</pre></details>\n");
}

/* Shows the slider's picture and hides the others; the caption is what a screen reader says of the value. */
static const char slider_script[] =
    "<script>\n"
    "document.querySelectorAll('.slider').forEach(function (slider) {\n"
    "  var input = slider.querySelector('input'), figures = slider.querySelectorAll('figure');\n"
    "  function show() {\n"
    "    figures.forEach(function (figure, i) { figure.hidden = i !== Number(input.value); });\n"
    "    input.setAttribute('aria-valuetext', figures[Number(input.value)].textContent);\n"
    "  }\n"
    "  input.addEventListener('input', show);\n"
    "  show();\n"
    "});\n"
    "</script>\n";

bool hs_page_close(hs_page *page, hs_error *err) {
    if (page->has_slider) put(page, slider_script);
    put(page, "</body>\n</html>\n");
    if (page->error.code == HS_OK) return hs_output_commit(&page->output, err);
    hs_output_discard(&page->output);
    return hs_fail(err, page->error.code, "%s", page->error.text);
}
