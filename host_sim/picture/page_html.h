/* SPDX-License-Identifier: MIT */
/* One self-contained HTML page: pictures inlined, no network, readable on a
 * phone; no script but the slider's. */
#ifndef HS_PAGE_HTML_H
#define HS_PAGE_HTML_H

#include "base/output_file.h"

/* A page under way. The first error is kept in it, so that only hs_report_close need be checked. */
typedef struct {
    hs_output_file output;
    hs_error error;
    bool has_slider; /* the script is needed */
} hs_report;

/* Starts a page at `path`; it appears when closed. All texts are escaped. */
void hs_report_open(hs_report *report, const char *path, const char *title);

/* A heading of level 2 or 3. */
void hs_report_heading(hs_report *report, int level, const char *text);

/* A paragraph. */
void hs_report_text(hs_report *report, const char *text);

/* A row of pictures, which wraps on a narrow screen: begin, pictures, end. */
void hs_report_row_begin(hs_report *report);
void hs_report_row_end(hs_report *report);

/* A PNG file, inlined, with the text that stands for it when it is not seen, and a caption below. */
void hs_report_picture(hs_report *report, const char *path, const char *alt, const char *caption);

/* The same as JPEG, for renderings: a sixth of the bytes, with a loss that speckle hides. */
void hs_report_photo(hs_report *report, const char *path, const char *alt, const char *caption);

/* A table: the first row given is its head, the first cell of a row its heading. */
void hs_report_table_begin(hs_report *report);
void hs_report_table_row(hs_report *report, const char *const *cells, unsigned count);
void hs_report_table_end(hs_report *report);

/* Finished markup (a figure in SVG); the caller answers for it. */
void hs_report_markup(hs_report *report, const char *markup);

/* A slider over pictures: begin, one hs_report_picture per position, end. `label` says what it turns;
 * `shown` is the position it starts at (0: the first). A short script in the page moves it; without one all
 * pictures are seen, and in print the one it stands at. */
void hs_report_slider_begin(hs_report *report, const char *label, unsigned count, unsigned shown);
void hs_report_slider_end(hs_report *report);

/* Text as printed in a terminal, folded away under `summary`. */
void hs_report_folded(hs_report *report, const char *summary, const char *text);

/* Ends the page. HS_ERR_OUTPUT or HS_ERR_INPUT (a picture that cannot be read): then there is no page. */
bool hs_report_close(hs_report *report, hs_error *err);

#endif
