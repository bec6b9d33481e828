/* SPDX-License-Identifier: MIT */
#include "report/report_page_beside.h"

#include "picture/picture_colour.h"
#include "report/report_draw.h"
#include "report/report_page_parts.h"
#include "report/report_rows_beside.h"

#include <math.h>
#include <string.h>

#define LEGEND_STOPS 41u

static void put_table(hs_page *report, const hs_eval_study *study) {
    char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    const char *cells[HS_BESIDE_CELLS];
    for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++) cells[i] = cell[i];
    hs_page_table_begin(report);
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        hs_eval_beside_row(study, r, cell);
        hs_page_table_row(report, cells, HS_BESIDE_CELLS);
    }
    hs_page_table_end(report);
}

/* A bar in the colours of a map, with the words of its ends and its middle. */
typedef struct {
    const char *label;
    uint32_t (*colour)(double t);
    double low; /* what `colour` takes at the left end; 1 at the right */
    const char *left, *middle, *right;
} legend;

static void write_legend(FILE *out, const void *of) {
    const legend *l = of;
    (void)fprintf(out,
                  "<svg class=\"plot\" style=\"min-width:0;max-width:30rem\" viewBox=\"0 0 480 50\" "
                  "role=\"img\" aria-label=\"%s\" "
                  "font-family=\"sans-serif\" font-size=\"14\"><title>%s</title>\n",
                  l->label, l->label);
    for (uint32_t i = 0; i < LEGEND_STOPS; i++) {
        const double t = l->low + (1.0 - l->low) * i / (LEGEND_STOPS - 1);
        (void)fprintf(out, "<rect x=\"%.1f\" y=\"4\" width=\"%.1f\" height=\"18\" fill=\"#%06x\"/>\n",
                      480.0 * i / LEGEND_STOPS, 480.0 / LEGEND_STOPS + 0.5, l->colour(t));
    }
    (void)fprintf(out,
                  "<text x=\"0\" y=\"40\">%s</text><text x=\"240\" y=\"40\" text-anchor=\"middle\">%s</text>"
                  "<text x=\"480\" y=\"40\" text-anchor=\"end\">%s</text>\n</svg>\n",
                  l->left, l->middle, l->right);
}

static void put_legends(hs_page *report, bool with_confidence) {
    char left[64], right[64];
    (void)snprintf(left, sizeof left, "-%.0f steps: fetus cut", (double)HS_EVAL_ERROR_LIMIT);
    (void)snprintf(right, sizeof right, "+%.0f steps: occluder left", (double)HS_EVAL_ERROR_LIMIT);
    const legend errors = {.label = "Colours of the error pictures",
                           .colour = hs_colour_diverging,
                           .low = -1.0,
                           .left = left,
                           .middle = "0",
                           .right = right};
    const legend confidence = {.label = "Colours of the confidence pictures",
                               .colour = hs_colour_viridis,
                               .left = "confidence 0: none",
                               .middle = "0.5",
                               .right = "1: sure"};
    hs_eval_figure_put(report, write_legend, &errors);
    hs_page_text(report, "Dark grey is outside the sac and not evaluated.");
    if (!with_confidence) return;
    hs_eval_figure_put(report, write_legend, &confidence);
    hs_page_text(
        report,
        "The last picture of a case is not cut off at the surface but ghosted: opacity rises over a window "
        "before it, of ten low-resolution slices where the method is sure and up to thirty where it is "
        "not.");
}

/* "mean at q = 0.4: e_abs 8.36, cut 34.7%, left 2.1%" */
static void caption_of(const hs_eval_study *study, uint32_t index, hs_beside_way way, char *out,
                       size_t bytes) {
    const hs_eval_beside *b = &study->beside;
    const hs_measures *m = &b->of[index][way];
    char name[128];
    if (way == HS_BESIDE_KNOB && b->knob.exists)
        (void)snprintf(name, sizeof name, "%.60s at %.20s = %.4g", b->first_name, b->knob.info.key,
                       b->knob.value[b->best]);
    else
        (void)snprintf(name, sizeof name, "%.60s", way == HS_BESIDE_OTHER ? b->other_name : b->first_name);
    (void)snprintf(out, bytes, "%s: e_abs %.2f, cut %.1f%%, left %.1f%%", name, (double)m->of[HS_MEASURE_ABS],
                   100 * (double)m->of[HS_MEASURE_FETUS_CUT], 100 * (double)m->of[HS_MEASURE_OCCLUDER_LEFT]);
}

static void put_case(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const hs_eval_beside *b = &study->beside;
    char first[256], other[256], error[2][128];
    caption_of(study, index, HS_BESIDE_KNOB, first, sizeof first);
    caption_of(study, index, HS_BESIDE_OTHER, other, sizeof other);
    (void)snprintf(error[0], sizeof error[0], "Error of %.60s", b->first_name);
    (void)snprintf(error[1], sizeof error[1], "Error of %.60s", b->other_name);
    hs_page_heading(report, 3, study->space[index].name);
    hs_page_row_begin(report);
    hs_eval_page_show(report, study, index, "full.png", "rendering of the full volume", "Full volume");
    hs_eval_page_show(report, study, index, "truth.png", "rendering of the ground truth", "Ground truth");
    hs_eval_page_show(report, study, index, "beside_knob.png", first, first);
    hs_eval_page_show(report, study, index, "beside_other.png", other, other);
    hs_page_row_end(report);
    hs_page_row_begin(report);
    hs_eval_page_show(report, study, index, "beside_knob_error.png", error[0], error[0]);
    hs_eval_page_show(report, study, index, "beside_other_error.png", error[1], error[1]);
    if (b->has_confidence[index]) {
        (void)snprintf(other, sizeof other, "Confidence of %.60s", b->other_name);
        hs_eval_page_show(report, study, index, "beside_confidence.png", other, other);
        (void)snprintf(other, sizeof other, "%.60s, ghosted; wider where it is not sure", b->other_name);
        hs_eval_page_show(report, study, index, "beside_ghost.png", other, other);
    }
    hs_page_row_end(report);
}

void hs_eval_page_beside(hs_page *report, const hs_eval_study *study) {
    const hs_eval_beside *b = &study->beside;
    char text[900];
    bool confidence = false;
    if (!b->exists) return;
    (void)snprintf(text, sizeof text, "%.60s beside %.60s", b->other_name, b->first_name);
    hs_page_heading(report, 2, text);
    (void)snprintf(
        text, sizeof text,
        "Each method at one setting for all cases: %.60s at its defaults, %.60s with its knob where the "
        "mean e_abs over these cases is lowest. \"tuned\" is %.60s at the best setting of the whole "
        "parameter space, found on these very volumes.",
        b->other_name, b->first_name, b->first_name);
    hs_page_text(report, text);
    (void)snprintf(
        text, sizeof text,
        "e_abs in DVR steps; cut: share of the fetus that is cut by more than two steps; left: share of the "
        "occluded rays whose occluder is still there. ratio: e_abs of %.60s to that of %.60s at its best "
        "knob. true surface: what is left with the scene's own clipping surface as the depthmap.",
        b->other_name, b->first_name);
    hs_page_text(report, text);
    put_table(report, study);
    for (uint32_t i = 0; i < study->count; i++) confidence = confidence || b->has_confidence[i];
    put_legends(report, confidence);
    for (uint32_t i = 0; i < study->count; i++) put_case(report, study, i);
}
