/* SPDX-License-Identifier: MIT */
/*
 * The results as a plot: time to the right on a logarithmic axis, error upwards on another, a marker a row.
 * Left the largest error against the float64 definition, right the distance from the scenes' ground truth.
 */
#include "bench/methods.h"

#include "base/output_file.h"
#include "ref/ref_chain.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 1440, HEIGHT = 700, TOP = 84, BOTTOM = 600, PANEL = 500, MARK = 6 };
static const double smallest = 1e-7; /* slices: what an error of 0 is drawn at */
static const char *const colours[] = {"#0072b2", "#009e73", "#d55e00", "#cc79a7", "#e69f00", "#56504a"};
static const char *const dashes[BENCH_SIZES] = {"none", "7 4", "2 4"};

static const char *colour_of(uint32_t method) {
    return colours[method % (sizeof colours / sizeof *colours)];
}

/* A diagram of the two in the file, and its axes. */
typedef struct {
    FILE *file;
    double left;           /* pixels */
    double x0, x1, y0, y1; /* log10 of ms and slices */
    bool named;            /* the marks of the fronts have their names beside them */
} panel;

/* What one marker stands for. */
typedef struct {
    double ms, error;
    const methods_row *row;
    int size; /* index into bench_sizes */
} mark;

static double place_x(const panel *p, double ms) {
    return p->left + PANEL * (log10(ms) - p->x0) / (p->x1 - p->x0);
}
static double place_y(const panel *p, double error) {
    return BOTTOM - (BOTTOM - TOP) * (log10(error) - p->y0) / (p->y1 - p->y0);
}

/* Quarters of a decade around the marks. */
static void find_limits(panel *p, const mark *marks, uint32_t count) {
    p->x0 = p->y0 = INFINITY;
    p->x1 = p->y1 = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        const double x = 4.0 * log10(marks[i].ms), y = 4.0 * log10(marks[i].error);
        p->x0 = fmin(p->x0, floor(x - (p->named ? 1.3 : 0.3)) / 4.0); /* names stand left of their marks */
        p->x1 = fmax(p->x1, ceil(x + 0.3) / 4.0);
        p->y0 = fmin(p->y0, floor(y - 0.3) / 4.0);
        p->y1 = fmax(p->y1, ceil(y + 0.3) / 4.0);
    }
}

/* One line of the grid, and what it stands for. */
static void draw_line(const panel *p, bool vertical, double value, bool strong, bool text) {
    const double at = vertical ? place_x(p, value) : place_y(p, value);
    const char *stroke = strong ? "#b8b8b8" : "#ececec";
    if (vertical)
        (void)fprintf(p->file, "<path d='M%.1f %d V%d' stroke='%s'/>\n", at, TOP, BOTTOM, stroke);
    else
        (void)fprintf(p->file, "<path d='M%.1f %.1f h%d' stroke='%s'/>\n", p->left, at, PANEL, stroke);
    if (text && vertical)
        (void)fprintf(p->file, "<text x='%.1f' y='%d' text-anchor='middle'>%g</text>\n", at, BOTTOM + 18,
                      value);
    if (text && !vertical)
        (void)fprintf(p->file, "<text x='%.1f' y='%.1f' text-anchor='end'>%g</text>\n", p->left - 8, at + 4,
                      value);
}

static void draw_grid(const panel *p, bool vertical) {
    const double low = vertical ? p->x0 : p->y0, high = vertical ? p->x1 : p->y1;
    const bool few = high - low <= 2.5; /* decades: 2 and 5 are named, too */
    for (int decade = (int)floor(low); decade <= (int)floor(high); decade++)
        for (int digit = 1; digit <= 9; digit++) {
            const double value = digit * pow(10.0, decade), at = log10(value);
            if (at < low - 1e-9 || at > high + 1e-9) continue;
            draw_line(p, vertical, value, digit == 1, digit == 1 || (few && (digit == 2 || digit == 5)));
        }
}

static void draw_axes(const panel *p, const char *title, const char *y_label) {
    draw_grid(p, true);
    draw_grid(p, false);
    (void)fprintf(p->file,
                  "<rect x='%.1f' y='%d' width='%d' height='%d' fill='none' stroke='#303030'/>\n"
                  "<text x='%.1f' y='%d' font-size='15' font-weight='bold'>%s</text>\n"
                  "<text x='%.1f' y='%d' text-anchor='middle'>time of the reconstruction, median, ms</text>\n"
                  "<text transform='translate(%.1f %d) rotate(-90)' text-anchor='middle'>%s</text>\n",
                  p->left, TOP, PANEL, BOTTOM - TOP, p->left, TOP - 12, title, p->left + PANEL / 2.0,
                  BOTTOM + 40, p->left - 62, (TOP + BOTTOM) / 2, y_label);
}

/* A circle, a square or a triangle by size; hollow for an approximation that a setting asked for. */
static void draw_shape(FILE *file, double x, double y, int size, const char *colour, bool hollow,
                       const char *tip) {
    char fill[64];
    (void)snprintf(fill, sizeof fill, "fill='%s' stroke='%s' stroke-width='2'", hollow ? "#ffffff" : colour,
                   colour);
    if (size == 0) (void)fprintf(file, "<circle cx='%.1f' cy='%.1f' r='%d' %s>", x, y, MARK - 1, fill);
    if (size == 1)
        (void)fprintf(file, "<path d='M%.1f %.1f h%d v%d h-%dz' %s>", x - MARK + 1, y - MARK + 1,
                      2 * MARK - 2, 2 * MARK - 2, 2 * MARK - 2, fill);
    if (size == 2)
        (void)fprintf(file, "<path d='M%.1f %.1f l%d %d h-%dz' %s>", x, y - MARK, MARK, 2 * MARK - 1,
                      2 * MARK, fill);
    (void)fprintf(file, "<title>%s</title></%s>\n", tip, size == 0 ? "circle" : "path");
}

/* A name below its mark and to the left; a line lower for every mark of the front that
 * stands as high and further left. */
static void draw_name(const panel *p, const double *x, const double *y, const bool *best, uint32_t count,
                      uint32_t own, const char *name) {
    int below = 14;
    for (uint32_t i = 0; i < count; i++)
        if (best[i] && x[i] < x[own] && fabs(place_y(p, y[i]) - place_y(p, y[own])) < 12.0) below += 13;
    (void)fprintf(p->file, "<text x='%.1f' y='%.1f' font-size='11' text-anchor='end'>%s</text>\n",
                  place_x(p, x[own]) - 8, place_y(p, y[own]) + below, name);
}

/* The marks that no other of the size beats in both, joined as a staircase. Below and to the left of it there
 * is nothing, so names stand there. */
static void draw_front(const panel *p, const mark *marks, uint32_t count, int size) {
    double x[METHODS_ROWS], y[METHODS_ROWS];
    bool best[METHODS_ROWS];
    const methods_row *own_row[METHODS_ROWS];
    uint32_t own = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (marks[i].size != size) continue;
        own_row[own] = marks[i].row;
        x[own] = marks[i].ms;
        y[own++] = marks[i].error;
    }
    if (own == 0) return;
    methods_pareto(x, y, own, best);
    (void)fprintf(p->file, "<path fill='none' stroke='#303030' stroke-width='1.5' stroke-dasharray='%s' d='",
                  dashes[size]);
    double last = -1.0;
    for (uint32_t drawn = 0;; drawn++) { /* from left to right */
        uint32_t next = own;
        for (uint32_t i = 0; i < own; i++)
            if (best[i] && x[i] > last && (next == own || x[i] < x[next])) next = i;
        if (next == own) break;
        const double at_x = place_x(p, x[next]), at_y = place_y(p, y[next]);
        if (drawn == 0) (void)fprintf(p->file, "M%.1f %d V%.1f", at_x, TOP, at_y);
        if (drawn > 0) (void)fprintf(p->file, " H%.1f V%.1f", at_x, at_y);
        last = x[next];
    }
    (void)fprintf(p->file, " H%.1f'/>\n", p->left + PANEL);
    for (uint32_t i = 0; p->named && i < own; i++)
        if (best[i]) draw_name(p, x, y, best, own, i, own_row[i]->variant->label);
}

static void draw_panel(panel *p, const mark *marks, uint32_t count, const char *title, const char *y_label) {
    if (count == 0) return;
    find_limits(p, marks, count);
    draw_axes(p, title, y_label);
    for (int size = 0; size < BENCH_SIZES; size++) draw_front(p, marks, count, size);
    for (uint32_t i = 0; i < count; i++) {
        const methods_row *r = marks[i].row;
        char tip[160];
        (void)snprintf(tip, sizeof tip, "%s, %u x %u: %.3g ms, %.3g slices", r->variant->label, r->n, r->n,
                       marks[i].ms, marks[i].error);
        draw_shape(p->file, place_x(p, marks[i].ms), place_y(p, marks[i].error), marks[i].size,
                   colour_of(r->variant->method), methods_variant_approximates(r->variant), tip);
    }
}

static void draw_legend(FILE *file) {
    double y = TOP + 8;
    const double x = WIDTH - 190;
    for (uint32_t m = 0; m < SV_METHOD_END; m++) {
        if (!methods_on_points(m)) continue;
        draw_shape(file, x, y, 0, colour_of(m), false, sv_ref_method_name(m));
        (void)fprintf(file, "<text x='%.1f' y='%.1f'>%s</text>\n", x + 16, y + 4, sv_ref_method_name(m));
        y += 22;
    }
    y += 12;
    for (int size = 0; size < BENCH_SIZES; size++, y += 22) {
        draw_shape(file, x, y, size, "#303030", false, "map size");
        (void)fprintf(
            file,
            "<text x='%.1f' y='%.1f'>%u x %u pixels</text>\n"
            "<path d='M%.1f %.1f h34' stroke='#303030' stroke-width='1.5' stroke-dasharray='%s'/>\n",
            x + 16, y + 4, bench_sizes[size], bench_sizes[size], x + 132, y, dashes[size]);
    }
    (void)fprintf(file, "<text x='%.1f' y='%.1f'>lines: Pareto fronts</text>\n", x - 6, y + 6);
    y += 34;
    draw_shape(file, x, y, 0, "#303030", true, "approximation");
    (void)fprintf(file,
                  "<text x='%.1f' y='%.1f'>float32, int16, coarse grid,</text>\n"
                  "<text x='%.1f' y='%.1f'>fewer pixels or steps</text>\n"
                  "<text x='%.1f' y='%.1f'>errors below 1e-07</text>\n"
                  "<text x='%.1f' y='%.1f'>are drawn there</text>\n",
                  x + 16, y + 4, x + 16, y + 20, x - 6, y + 52, x - 6, y + 68);
}

/* Text from outside, with what XML keeps for itself escaped. */
static void write_text(FILE *file, const char *text) {
    for (; *text; text++) {
        if (*text == '&' || *text == '<') (void)fprintf(file, "&#%d;", *text);
        if (*text != '&' && *text != '<') (void)fputc(*text, file);
    }
}

/* Marks of the left (truth false) or of the right diagram. Returns their number. */
static uint32_t collect(const methods_report *report, bool truth, mark *marks) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < report->row_count; i++) {
        const methods_row *r = &report->rows[i];
        const methods_truth_row *picture = methods_row_truth(report, r);
        if (truth ? !picture || r->n != METHODS_SCENE_SIZE : !r->error.known || !isfinite(r->error.largest))
            continue;
        int size = 0;
        while (size < BENCH_SIZES - 1 && bench_sizes[size] != r->n) size++;
        const double error = truth ? methods_truth_mean(picture) : r->error.largest;
        marks[count++] = (mark){methods_row_ms(r), fmax(error, smallest), r, size};
    }
    return count;
}

bool methods_write_svg(const methods_report *report, const char *path, hs_error *err) {
    hs_output_file output = {0};
    mark marks[METHODS_ROWS];
    if (!hs_output_open(&output, path, err)) return false;
    FILE *file = output.file;
    (void)fprintf(
        file,
        "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' viewBox='0 0 %d %d' "
        "font-family='sans-serif' font-size='13' fill='#202020'>\n"
        "<rect width='%d' height='%d' fill='#ffffff'/>\n"
        "<text x='90' y='34' font-size='19' font-weight='bold'>Surface reconstruction: speed against "
        "error</text>\n<text x='90' y='%d' fill='#606060'>",
        WIDTH, HEIGHT, WIDTH, HEIGHT, WIDTH, HEIGHT, HEIGHT - 24);
    write_text(file, report->machine.cpu);
    (void)fputs("; ", file);
    write_text(file, report->machine.plugin);
    (void)fprintf(file, "; load %.1f</text>\n", report->machine.load);
    panel left = {.file = file, .left = 90}, right = {.file = file, .left = 710, .named = true};
    draw_panel(&left, marks, collect(report, false, marks), "Against the method's float64 definition",
               "largest error, slices");
    draw_panel(&right, marks, collect(report, true, marks),
               "Against the scenes' ground truth (D01, E01, M02)", "mean distance of the rays' ends, slices");
    draw_legend(file);
    (void)fprintf(file, "</svg>\n");
    return hs_output_commit(&output, err);
}
