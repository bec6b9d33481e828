/* SPDX-License-Identifier: MIT */
/* One self-contained HTML page: pictures inlined, no network, readable on a phone; no script but the
 * slider's. */
#pragma once

#include "core/output_file.h"

enum { HS_PAGE_COLUMNS = 40 };

/* A page under way. The first error is kept in it, so that only hs_page_close need be checked. Must not move
 * while open. */
typedef struct {
    hs_output_file output;
    hs_error error;
    bool has_slider;                 /* the script is needed */
    char *heads[HS_PAGE_COLUMNS];    /* of the table under way; NULL behind the last */
    unsigned headings;               /* of level 2 so far */
    FILE *before, *contents, *after; /* what stands before the list of contents, it, and after it */
    FILE *to;                        /* what is written now */
} hs_page;

/* Starts a page at `path`; it appears when closed. All texts are escaped. */
void hs_page_open(hs_page *page, const char *path, const char *title);

/* A heading of level 2 or 3. */
void hs_page_heading(hs_page *page, int level, const char *text);

/* Here stands the list of the headings of level 2 that follow, at most once. */
void hs_page_contents(hs_page *page);

/* Figures to be seen at once: each value with its name. */
void hs_page_numbers(hs_page *page, const char *const *names, const char *const *values, unsigned count);

/* A paragraph of plain text. */
void hs_page_text(hs_page *page, const char *text);

/* A row of pictures: begin, pictures, end. `kind`: "" wraps on a narrow screen, "small" stays one, "wide" is
 * of pictures with labels in them, and scrolls rather than shrinks. */
void hs_page_row_begin(hs_page *page, const char *kind);
void hs_page_row_end(hs_page *page);

/* A PNG file, inlined, with the text that stands for it when it is not seen, and a caption below. */
void hs_page_picture(hs_page *page, const char *path, const char *alt, const char *caption);

/* The caption of a rendering of the ground truth; `cut`: it shows one (hs_truth_shows_cut). */
const char *hs_page_truth_caption(bool cut);

/* The caption of slices.png: what the yellow line is, or that there is none. */
const char *hs_page_slices_caption(bool clipped);

/* hs_page_picture as JPEG, for renderings: a sixth of the bytes, with a loss that speckle hides. */
void hs_page_photo(hs_page *page, const char *path, const char *alt, const char *caption);

/* A table: the first row given is its head, the first cell of a row its heading. On a phone the rows of one
 * with many columns are lists of heads and values. */
void hs_page_table_begin(hs_page *page);
void hs_page_table_row(hs_page *page, const char *const *cells, unsigned count);
void hs_page_table_end(hs_page *page);

/* Takes finished markup (a figure in SVG), for which the caller answers; NULL if something failed before. */
FILE *hs_page_stream(hs_page *page);

/* Text with the characters that markup needs replaced. */
void hs_page_escape(FILE *out, const char *text);

/* A slider over pictures: begin, one hs_page_picture per position, end. `label` says what it turns;
 * `shown` is the position it starts at (0: the first). A short script in the page moves it; without one all
 * pictures are seen, and in print the one it stands at. */
void hs_page_slider_begin(hs_page *page, const char *label, unsigned count, unsigned shown);
void hs_page_slider_end(hs_page *page);

/* What stands between is folded away under `summary`. */
void hs_page_fold_begin(hs_page *page, const char *summary);
void hs_page_fold_end(hs_page *page);

/* Text as printed in a terminal, folded away under `summary`. */
void hs_page_folded(hs_page *page, const char *summary, const char *text);

/* Ends the page. HS_ERR_OUTPUT or HS_ERR_INPUT (a picture that cannot be read): then there is no page. */
bool hs_page_close(hs_page *page, hs_error *err);
