/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "core/paths.h"
#include "core/system.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#define WHOLE 0.01 /* shares up to which nothing is cut, or left, to the eye */
#define A_BIT 0.05

static const char source_of_real[] =
    "A scan of a fetus of 12 to 13 weeks in its sac: ultrasound.nrrd of github.com/seaniod/vizbi_webgl_demo "
    "(commit c6c2d7d, MIT licence).";

/* A picture of the case, if it was made (a real volume has no ground truth). */
typedef void put_figure(hs_page *page, const char *path, const char *alt, const char *caption);
static void show(hs_page *page, const char *out, const hs_demo_case *c, put_figure *put, const char *file,
                 const char *alt, const char *caption) {
    char folder[SYS_PATH], path[SYS_PATH], whole[256];
    (void)snprintf(whole, sizeof whole, "%s: %s", c->name, alt);
    if (hs_path_join(out, c->folder, folder, sizeof folder, &page->error) &&
        hs_path_join(folder, file, path, sizeof path, &page->error) && access(path, F_OK) == 0)
        put(page, path, whole, caption);
}

/* Full volume, result, ground truth, in the order of all pages. */
static void show_renderings(hs_page *page, const char *out, const hs_demo_case *c) {
    show(page, out, c, hs_page_photo, "full.png", "rendering of the full volume", "Full volume");
    show(page, out, c, hs_page_photo, "result.png",
         c->clipped ? "rendering that starts at the clipping surface" : "rendering, not clipped",
         c->clipped ? "Result" : "Result: not clipped");
    if (c->has_truth)
        show(page, out, c, hs_page_photo, "truth.png", "rendering of the ground truth",
             hs_page_truth_caption(c->truth_cut));
    hs_page_row_end(page);
}

static double known(double share) {
    return isnan(share) ? 0.0 : share;
}

static void percent(double share, char out[16]) {
    (void)snprintf(out, 16, isnan(share) ? "-" : "%.1f %%", 100 * share);
}

/* The sentence under the case's name. */
static void put_verdict(hs_page *page, const hs_demo_case *c) {
    char text[600], cut[16], left[16];
    percent(c->cut, cut);
    percent(c->left, left);
    const char *shown = c->file[0] ? "the volume" : "the fetus";
    const char *state = known(c->cut) <= WHOLE ? "whole" : known(c->cut) <= A_BIT ? "cut a little" : "cut";
    const char *before = known(c->left) <= WHOLE   ? "and nothing hides it any more"
                         : known(c->left) <= A_BIT ? "and little is left before it"
                                                   : "and a part of what hides it is left";
    if (!c->clipped)
        (void)snprintf(text, sizeof text, "Verdict: %s", c->note);
    else if (!c->has_truth)
        (void)snprintf(text, sizeof text, "Verdict: clipped; there is no ground truth to tell how well. %s",
                       c->note);
    else
        (void)snprintf(text, sizeof text, "Verdict: %s is %s, %s. Cut %s, left %s, %.1f ms. %s", shown, state,
                       before, cut, left, c->plugin_ms, c->note);
    hs_page_text(page, text);
}

/* A share that the synthetic cases have: its mean, and the largest with its case. NAN: none has it. */
typedef struct {
    double mean, worst;
    const char *of;
} summary;

static summary summarise(const hs_demo_case *cases, uint32_t count, bool cut) {
    summary s = {.mean = (double)NAN, .worst = -1.0};
    double sum = 0.0;
    uint32_t known_cases = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double share = cut ? cases[i].cut : cases[i].left;
        if (!cases[i].scene || cases[i].file[0] || isnan(share)) continue;
        sum += share;
        known_cases++;
        if (share > s.worst) s = (summary){.worst = share, .of = cases[i].name};
    }
    if (known_cases > 0) s.mean = sum / known_cases;
    return s;
}

/* What a reader came for: what it does, and how well in the mean and in the worst case. */
static void put_answer(hs_page *page, const hs_demo_case *cases, uint32_t count) {
    const summary of[2] = {summarise(cases, count, true), summarise(cases, count, false)};
    static const char *const words[2] = {"of the fetus cut", "of what hides it left"};
    char names[2][200], values[2][16], worst[16];
    hs_page_text(page,
                 "SmartVis finds a surface in the fluid before the fetus and starts the picture there, so "
                 "that what hides the fetus is gone. For research, not a medical device.");
    if (isnan(of[0].mean)) {
        hs_page_text(page, "No case has a ground truth to tell how well.");
        return;
    }
    for (int i = 0; i < 2; i++) {
        percent(of[i].mean, values[i]);
        percent(of[i].worst, worst);
        (void)snprintf(names[i], sizeof names[i], "%s in the mean of the synthetic cases (worst: %s, %s)",
                       words[i], worst, of[i].of);
    }
    hs_page_numbers(page, (const char *const[2]){names[0], names[1]},
                    (const char *const[2]){values[0], values[1]}, 2);
}

static void put_details(hs_page *page, const char *out, const hs_demo_case *c) {
    hs_page_fold_begin(page, "How it was found");
    hs_page_row_begin(page, "wide");
    show(page, out, c, hs_page_picture, "depthmap.png", "the clipping depthmap in false colour",
         "Clipping depthmap: where the rays start, in mm; hatched clips nothing");
    show(page, out, c, hs_page_picture, "confidence.png", "the plugin's confidence in its depthmap",
         "Confidence: how sure the plugin is of the depthmap");
    hs_page_row_end(page);
    hs_page_row_begin(page, "wide");
    show(page, out, c, hs_page_photo, "slices.png", "the result beside three slices",
         hs_page_slices_caption(c->clipped));
    hs_page_row_end(page);
    hs_page_fold_end(page);
    hs_page_folded(page, "Times and statistics", c->printed ? c->printed : "");
}

/* The first case's renderings stand on top of the page. */
static void put_case(hs_page *page, const char *out, const hs_demo_case *c, bool first) {
    hs_page_heading(page, 2, c->name);
    put_verdict(page, c);
    hs_page_text(page, c->what);
    if (!first) {
        hs_page_row_begin(page, "small");
        show_renderings(page, out, c);
    }
    put_details(page, out, c);
}

/* The heads, or the row of a case, without the columns that no case has anything for. */
static void put_speeds(hs_page *page, const char *const *names, const hs_demo_case *c,
                       const hs_demo_case *cases, uint32_t count) {
    const char *cells[HS_DEMO_CELLS] = {c ? c->name : names[0]};
    uint32_t n = 1;
    for (uint32_t k = 1; k < HS_DEMO_CELLS; k++) {
        bool any = false;
        for (uint32_t i = 0; i < count; i++) any = any || cases[i].row[k][0];
        if (any) cells[n++] = c ? c->row[k] : names[k];
    }
    hs_page_table_row(page, cells, n);
}

static void put_speed(hs_page *page, const hs_demo_case *cases, uint32_t count) {
    static const char *const names[HS_DEMO_CELLS] = {
        "Case",        "DVR [1/s]",      "+ scan conversion [1/s]", "+ plugin [1/s]",
        "plugin [ms]", "plugin's share", "initial points",          "outcome"};
    hs_page_heading(page, 2, "Speed");
    hs_page_text(
        page,
        "Volumes a second from the median of the whole loop, in the three settings of the thesis' Figure "
        "5.21: direct volume rendering (DVR) alone and with scan conversion draw the full volume, "
        "unclipped; with the plugin the rays start at its depthmap. The plugin's share is that of a "
        "whole frame.");
    hs_page_table_begin(page);
    put_speeds(page, names, NULL, cases, count);
    for (uint32_t i = 0; i < count; i++) put_speeds(page, NULL, &cases[i], cases, count);
    hs_page_table_end(page);
}

void hs_demo_page(hs_page *page, const char *out, const hs_demo_case *cases, uint32_t count) {
    if (count > 0) {
        hs_page_row_begin(page, "small");
        show_renderings(page, out, &cases[0]);
        hs_page_text(page, cases[0].real ? source_of_real : cases[0].name);
        if (cases[0].note[0]) hs_page_text(page, cases[0].note);
    }
    put_answer(page, cases, count);
    hs_page_contents(page);
    for (uint32_t i = 0; i < count; i++) put_case(page, out, &cases[i], i == 0);
    put_speed(page, cases, count);
    hs_page_heading(page, 2, "What the words mean");
    hs_page_text(
        page, "Cut is the share of the fetus that is cut by more than two steps of a ray, left the share of "
              "the rays on which more than two steps of the occluder, which hides it, are left; a step is "
              "one slice of the volume. Grey is tissue that the surface cuts, or where the scan ends.");
    hs_page_text(page,
                 "The synthetic cases follow figures of the thesis from which SmartVis comes, Application of "
                 "Smart Visibility on Medical 3D Ultrasound Datasets.");
}
