/* SPDX-License-Identifier: MIT */
#include "picture/plot_frame.h"

#include <math.h>

static void escape(FILE *out, const char *text) {
    for (const char *c = text; *c; c++) {
        if (*c == '&')
            (void)fputs("&amp;", out);
        else if (*c == '<')
            (void)fputs("&lt;", out);
        else if (*c == '>')
            (void)fputs("&gt;", out);
        else if (*c == '"')
            (void)fputs("&quot;", out);
        else
            (void)fputc(*c, out);
    }
}

void hs_plot_text(FILE *out, double x, double y, const char *anchor, const char *text) {
    (void)fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    escape(out, text);
    (void)fprintf(out, "</text>\n");
}

void hs_plot_begin(FILE *out, const char *title, const char *x_label, const char *y_label) {
    const double middle_x = (HS_PLOT_LEFT + HS_PLOT_RIGHT) / 2.0;
    const double middle_y = (HS_PLOT_TOP + HS_PLOT_BOTTOM) / 2.0;
    (void)fprintf(out,
                  "<div class=\"wide\"><svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"",
                  HS_PLOT_WIDTH, HS_PLOT_HEIGHT);
    escape(out, title);
    (void)fprintf(out, "\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"#1c2024\">\n<title>");
    escape(out, title);
    (void)fprintf(out, "</title>\n<g font-size=\"14\" font-weight=\"600\">");
    hs_plot_text(out, HS_PLOT_LEFT, HS_PLOT_TOP - 14, "start", title);
    (void)fprintf(out, "</g>\n");
    hs_plot_text(out, middle_x, HS_PLOT_HEIGHT - 12, "middle", x_label);
    (void)fprintf(out, "<g transform=\"translate(16 %.1f) rotate(-90)\">", middle_y);
    hs_plot_text(out, 0, 0, "middle", y_label);
    (void)fprintf(out, "</g>\n");
}

void hs_plot_end(FILE *out) {
    (void)fprintf(out, "</svg></div>\n");
}

double hs_plot_y(double value, double top) {
    return HS_PLOT_BOTTOM - (HS_PLOT_BOTTOM - HS_PLOT_TOP) * fmin(fmax(value / top, 0), 1);
}

/* 1, 2 or 5 times a power of ten: the least that makes six ticks at most. */
static double round_step(double largest) {
    const double least = largest / 6;
    const double power = pow(10, floor(log10(least)));
    for (int i = 0; i < 3; i++) {
        static const double factors[3] = {1, 2, 5};
        if (factors[i] * power >= least) return factors[i] * power;
    }
    return 10 * power;
}

double hs_plot_y_axis(FILE *out, double largest) {
    const double usable = isfinite(largest) && largest > 0 ? largest : 1;
    const double step = round_step(usable), top = ceil(usable / step - 1e-9) * step;
    for (int i = 0; i * step <= top * (1 + 1e-9); i++) {
        char text[32];
        const double y = hs_plot_y(i * step, top);
        (void)snprintf(text, sizeof text, "%.6g", i * step);
        (void)fprintf(out, "<path d=\"M%d %.1fH%d\" stroke=\"#d5d9de\"/>\n", HS_PLOT_LEFT, y, HS_PLOT_RIGHT);
        hs_plot_text(out, HS_PLOT_LEFT - 6, y + 4, "end", text);
    }
    return top;
}

void hs_plot_legend(FILE *out, uint32_t index, uint32_t colour, const char *name) {
    const double y = HS_PLOT_TOP + 18.0 * index;
    (void)fprintf(out, "<rect x=\"%d\" y=\"%.1f\" width=\"11\" height=\"11\" fill=\"#%06x\"/>\n",
                  HS_PLOT_RIGHT + 12, y, colour);
    hs_plot_text(out, HS_PLOT_RIGHT + 28, y + 10, "start", name);
}

uint32_t hs_plot_colour(uint32_t index) {
    static const uint32_t colours[8] = {0x0072b2, 0xe69f00, 0x009e73, 0xd55e00,
                                        0x56b4e9, 0xcc79a7, 0x7a7a00, 0x333333};
    return colours[index % 8];
}
