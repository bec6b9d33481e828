/* SPDX-License-Identifier: MIT */
/* The demo: its cases, what came of each, and the page that shows them. */
#ifndef HS_DEMO_H
#define HS_DEMO_H

#include "page/page_html.h"

#include <limits.h>
#include <stdint.h>

#define HS_DEMO_CASES 16
#define HS_DEMO_CELLS 8  /* of a row of the table of speeds */
#define HS_DEMO_CELL  64 /* bytes of a cell */

/* One source of the demo. */
typedef struct {
    const char *scene;         /* a scene's name, or NULL: ... */
    char file[PATH_MAX];       /* ... a volume's path */
    char folder[NAME_MAX + 1]; /* of its pictures, inside the demo's */
    char name[96];             /* for a person: "Cord before the face" */
    bool real;                 /* the real fetus in fluid, which the page names the source of */

    /* What came of it. */
    char what[300]; /* a sentence on the source */
    char note[400]; /* why it is not clipped, or not all of it; empty: it is */
    bool clipped, has_truth, has_knob;
    bool truth_cut;   /* its picture of the truth shows a cut (hs_truth_shows_cut) */
    double cut, left; /* shares, 0 .. 1; NAN: not known */
    double plugin_ms;
    char row[HS_DEMO_CELLS][HS_DEMO_CELL]; /* in the table of speeds, without the first cell */
    char *printed;                         /* the table of `host_sim run`; owned, may be NULL */
} hs_demo_case;

/* Fills the open page. `out` is the folder that holds those of the cases. Errors are kept in the page. */
void hs_demo_page(hs_page *page, const char *out, const hs_demo_case *cases, uint32_t count);

#endif
