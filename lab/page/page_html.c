/* SPDX-License-Identifier: MIT */
#include "page/page_html.h"

#include "core/input_file.h"
#include "core/system.h"
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
    ":root{color-scheme:light dark;--ink:#1c2024;--quiet:#4a5058;--ground:#fff;--line:#d5d9de;"
    "--shade:#f4f5f7;--link:#0b5cad}\n"
    "@media screen and (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--quiet:#aab2bb;--ground:#16181b;"
    "--line:#3b4048;--shade:#22252a;--link:#7ab8f5}}\n"
    "body{font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--ground);max-width:70rem;"
    "margin:0 auto;padding:1rem}\n"
    "h1{font-size:1.7rem;line-height:1.2}h2{margin-top:2.5rem;border-bottom:1px solid var(--line);"
    "padding-bottom:.3rem}\n"
    "h3{margin:1.5rem 0 .3rem}p{max-width:46rem}a,summary{color:var(--link)}\n"
    "nav ul{columns:14rem;padding-left:1.2rem}\n"
    ".row{display:flex;flex-wrap:wrap;gap:1rem;margin:1rem 0}\n"
    "figure{margin:0;flex:1 1 13rem;min-width:0;max-width:36rem}\n"
    ".small{gap:.5rem}.small figure{flex:1 1 0;max-width:23rem}\n"
    "img{width:100%;height:auto;display:block;border-radius:4px;background:#000}\n"
    "figcaption{font-size:.9rem;color:var(--quiet);margin-top:.3rem}\n"
    ".row.wide figure{flex-basis:36rem;max-width:none}\n"
    "dl{display:flex;flex-wrap:wrap;gap:.5rem 2rem;margin:1rem 0}dl div{display:flex;"
    "flex-direction:column-reverse}\n"
    "dt{color:var(--quiet);font-size:.9rem}dd{margin:0;font-size:1.6rem;font-weight:600;line-height:1.2}\n"
    "table{border-collapse:collapse;margin:1rem 0}\n"
    "th,td{padding:.3rem .55rem;text-align:right;border-bottom:1px solid var(--line);"
    "white-space:nowrap;font-variant-numeric:tabular-nums}\n"
    "tr:first-child>*{white-space:normal;vertical-align:bottom}\n"
    "th:first-child,td:first-child{text-align:left}tr:first-child>*{"
    "border-bottom:2px solid var(--quiet);font-weight:600}\n"
    "pre{white-space:pre-wrap;background:var(--shade);padding:.8rem;font-size:.8rem;line-height:1.35}\n"
    "summary{cursor:pointer}\n"
    ".plot{display:block;width:100%;max-width:50rem;height:auto;margin:1rem 0;overflow:visible;"
    "background:#fff;border-radius:4px;box-sizing:border-box;padding:.4rem}\n"
    ".slider{flex:1 1 13rem;max-width:22rem}.slider input{display:block;width:100%;margin:.4rem 0}"
    ".slider figure[hidden]{display:none}\n"
    "@media (max-width:50rem){.many tr{display:flex;flex-wrap:wrap;gap:0 1rem;padding:.5rem 0;"
    "border-bottom:1px solid var(--line)}.many tr:first-child{display:none}.many th,.many td{display:block;"
    "border:0;padding:0}.many th{flex-basis:100%}.many td{font-weight:600}.many td::before{"
    "content:attr(data-head) ' ';font-weight:400;color:var(--quiet)}th,td{white-space:normal}}\n"
    "@media screen and (max-width:30rem){.plot text{font-size:19px}.plot .title text{font-size:15px}.plot "
    ".odd{display:none}}\n"
    "@media print{:root{color-scheme:light}table{font-size:.65rem}th,td{padding:.2rem .3rem}nav,.slider "
    "input{display:none}h2,h3,figure,svg,tr{break-inside:avoid;"
    "break-after:auto}h2,h3{break-after:avoid}.row.wide figure{flex-basis:60%}pre{font-size:.6rem}"
    "details::details-content{content-visibility:visible;height:auto}}\n"
    "</style>\n<title>";

static FILE *open_part(hs_page *page) {
    const int file = page->error.code == HS_OK ? sys_temporary() : -1;
    FILE *part = file >= 0 ? fdopen(file, "w+b") : NULL;
    if (!part && page->error.code == HS_OK)
        (void)hs_fail(&page->error, HS_ERR_OUTPUT, "page: temporary file: %s", strerror(errno));
    return part;
}

/* Writes unless something failed before. */
static void put_bytes(hs_page *page, const void *data, size_t bytes) {
    if (page->error.code == HS_OK && fwrite(data, 1, bytes, page->to) != bytes)
        (void)hs_fail(&page->error, HS_ERR_OUTPUT, "page: temporary file: %s", strerror(errno));
}

static void put(hs_page *page, const char *markup) {
    put_bytes(page, markup, strlen(markup));
}

void hs_page_escape(FILE *out, const char *text) {
    for (const char *c = text; *c; c++) {
        const char *const named = *c == '&'   ? "&amp;"
                                  : *c == '<' ? "&lt;"
                                  : *c == '>' ? "&gt;"
                                  : *c == '"' ? "&quot;"
                                              : NULL;
        (void)(named ? fputs(named, out) : fputc(*c, out));
    }
}

static void put_text(hs_page *page, const char *text) {
    if (page->error.code == HS_OK) hs_page_escape(page->to, text);
}

void hs_page_open(hs_page *page, const char *path, const char *title) {
    *page = (hs_page){0};
    if (!hs_output_open(&page->output, path, &page->error)) return;
    page->to = page->before = open_part(page);
    page->contents = open_part(page);
    page->after = open_part(page);
    put(page, head);
    put_text(page, title);
    put(page, "</title>\n</head>\n<body>\n<h1>");
    put_text(page, title);
    put(page, "</h1>\n");
}

void hs_page_contents(hs_page *page) {
    page->to = page->after;
}

/* `open` with the number of the heading after it, the text, `end`. */
static void put_numbered(hs_page *page, const char *open, const char *text, const char *end) {
    char number[32];
    (void)snprintf(number, sizeof number, "%u\">", page->headings);
    put(page, open);
    put(page, number);
    put_text(page, text);
    put(page, end);
}

void hs_page_heading(hs_page *page, int level, const char *text) {
    if (level != 2) {
        put(page, "<h3>");
        put_text(page, text);
        put(page, "</h3>\n");
        return;
    }
    FILE *const to = page->to;
    page->headings++;
    put_numbered(page, "<h2 id=\"part", text, "</h2>\n");
    page->to = page->contents;
    put_numbered(page, "<li><a href=\"#part", text, "</a></li>\n");
    page->to = to;
}

void hs_page_text(hs_page *page, const char *text) {
    put(page, "<p>");
    put_text(page, text);
    put(page, "</p>\n");
}

void hs_page_numbers(hs_page *page, const char *const *names, const char *const *values, unsigned count) {
    put(page, "<dl>\n");
    for (unsigned i = 0; i < count; i++) {
        put(page, "<div><dt>");
        put_text(page, names[i]);
        put(page, "</dt><dd>");
        put_text(page, values[i]);
        put(page, "</dd></div>\n");
    }
    put(page, "</dl>\n");
}

void hs_page_row_begin(hs_page *page, const char *kind) {
    put(page, "<div class=\"row ");
    put(page, kind);
    put(page, "\">\n");
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
    uint64_t size;
    FILE *file = hs_input_open(path, path, &size, &page->error);
    if (!file) return;
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

const char *hs_page_truth_caption(bool cut) {
    return cut ? "Ground truth. Grey: touches the occluder, cut" : "Ground truth";
}

const char *hs_page_slices_caption(bool clipped) {
    return clipped
               ? "The result beside three slices: the yellow line is the clipping surface, what lies before "
                 "it is dimmed; scales in mm"
               : "The result beside three slices: nothing is removed; scales in mm";
}

enum { MANY = 5 }; /* columns from which a table is too wide for a phone */

void hs_page_table_begin(hs_page *page) {
    page->heads[0] = NULL;
}

static void put_cells(hs_page *page, const char *const *cells, unsigned count) {
    put(page, "<tr><th>");
    put_text(page, cells[0]);
    put(page, "</th>");
    for (unsigned i = 1; i < count; i++) {
        put(page, "<td data-head=\"");
        put_text(page, page->heads[i] ? page->heads[i] : "");
        put(page, "\">");
        put_text(page, cells[i]);
        put(page, "</td>");
    }
    put(page, "</tr>\n");
}

void hs_page_table_row(hs_page *page, const char *const *cells, unsigned count) {
    if (!page->heads[0]) {
        put(page, count >= MANY ? "<table class=\"many\">\n" : "<table>\n");
        for (unsigned i = 0; i < count && i < HS_PAGE_COLUMNS; i++)
            if (!(page->heads[i] = strdup(cells[i])))
                (void)hs_fail(&page->error, HS_ERR_MEMORY, "page: no memory for a table");
    }
    put_cells(page, cells, count < HS_PAGE_COLUMNS ? count : HS_PAGE_COLUMNS);
}

void hs_page_table_end(hs_page *page) {
    for (unsigned i = 0; i < HS_PAGE_COLUMNS; i++) {
        free(page->heads[i]);
        page->heads[i] = NULL;
    }
    put(page, "</table>\n");
}

FILE *hs_page_stream(hs_page *page) {
    return page->error.code == HS_OK ? page->to : NULL;
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

void hs_page_fold_begin(hs_page *page, const char *summary) {
    put(page, "<details><summary>");
    put_text(page, summary);
    put(page, "</summary>\n");
}

void hs_page_fold_end(hs_page *page) {
    put(page, "</details>\n");
}

void hs_page_folded(hs_page *page, const char *summary, const char *text) {
    hs_page_fold_begin(page, summary);
    put(page, "<pre>");
    put_text(page, text);
    put(page, "</pre>");
    hs_page_fold_end(page);
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

/* Closes a part; what was written there goes to the page, if it is wanted. */
static void end_part(hs_page *page, FILE *part, bool wanted) {
    char block[4096];
    size_t bytes;
    bool ok = part && fflush(part) == 0 && fseek(part, 0, SEEK_SET) == 0;
    while (ok && wanted && page->error.code == HS_OK && (bytes = fread(block, 1, sizeof block, part)) > 0)
        (void)hs_output_write(&page->output, block, bytes, &page->error);
    ok = ok && !ferror(part);
    if (!ok && page->error.code == HS_OK)
        (void)hs_fail(&page->error, HS_ERR_OUTPUT, "page: temporary file: %s", strerror(errno));
    if (part) (void)fclose(part);
}

/* The list of contents stands between the two parts. */
bool hs_page_close(hs_page *page, hs_error *err) {
    const bool listed = page->to == page->after && page->headings > 0;
    if (page->has_slider) put(page, slider_script);
    put(page, "<p>SmartVis is for research. It is not a medical device.</p>\n</body>\n</html>\n");
    page->to = page->before;
    if (listed) put(page, "<nav aria-label=\"Contents\"><ul>\n");
    page->to = page->contents;
    put(page, "</ul></nav>\n");
    end_part(page, page->before, true);
    end_part(page, page->contents, listed);
    end_part(page, page->after, true);
    if (page->error.code == HS_OK) return hs_output_commit(&page->output, err);
    hs_output_discard(&page->output);
    return hs_fail(err, page->error.code, "%s", page->error.text);
}
