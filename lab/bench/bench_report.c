/* SPDX-License-Identifier: MIT */
#include "bench/bench_results.h"

#include <stdio.h>
#include <string.h>

/* --------------------------------------------------------------------------------------------- methods -- */

/* What a frame may take, in milliseconds; 0: there is no limit. */
static double limit_of(const char *method, uint32_t n) {
    if (strcmp(method, BENCH_METHOD) != 0) return 0.0;
    return n == 128 ? 1.5 : n == 171 ? 3.5 : 0.0;
}

static void print_line(const bench_plugin_result *r) {
    const hs_timing *t = &r->times[BENCH_FRAME];
    const double limit = limit_of(r->method, r->variant.n);
    const double n = r->variant.n;
    printf("%4u %-34s %4u | %7.3f %7.3f %7.3f %8.3f %8.2f | %8.3f %9.3f %11.3f | ", r->variant.n,
           bench_route_label(r->variant.route), r->variant.slab_slices, t->median, t->min, t->p95,
           r->times[BENCH_DROPPED].median, t->median * 1e6 / (n * n * n), r->stages.profile_ms,
           r->stages.threshold_ms, r->stages.reconstruct_ms);
    if (limit > 0.0) printf("%4.1f ms", limit);
    printf("%s\n", r->stats.outcome == SV_OK ? "" : "  (no surface)");
}

void bench_print_method(const bench_report *report, const char *method) {
    bool any = false;
    for (uint32_t i = 0; i < report->plugin_count; i++) {
        if (strcmp(report->plugin[i].method, method) != 0) continue;
        if (!any) {
            printf("\nFrame with method %s, milliseconds (medians unless named); given up behind its last "
                   "slab\n",
                   method);
            printf("%4s %-34s %4s | %7s %7s %7s %8s %8s | %8s %9s %11s | %s\n", "n", "slabs", "of", "frame",
                   "min", "p95", "given up", "ns/voxel", "profile", "threshold", "reconstruct", "limit");
        }
        any = true;
        print_line(&report->plugin[i]);
    }
    (void)fflush(stdout);
}

void bench_print_worst(const bench_report *report) {
    printf("\nFrames with the plugin's defaults, milliseconds\n%4s %-34s %4s %7s | %7s %7s %7s %7s\n", "n",
           "slabs", "of", "frames", "min", "p50", "p99", "max");
    for (uint32_t i = 0; i < report->plugin_count; i++) {
        const bench_plugin_result *r = &report->plugin[i];
        const hs_timing *t = &r->times[BENCH_FRAME];
        printf("%4u %-34s %4u %7u | %7.2f %7.2f %7.2f %7.2f\n", r->variant.n,
               bench_route_label(r->variant.route), r->variant.slab_slices, r->frames, t->min, t->median,
               t->p99, t->max);
    }
    (void)fflush(stdout);
}

/* ---------------------------------------------------------------------------------------------- tables -- */

void bench_print_plugin_head(uint32_t n, uint32_t k) {
    printf("\nPlugin frame, %u^3 voxels, k = %u; milliseconds, medians unless named; ratios of medians, (of "
           "minima)\n",
           n, k);
    printf("%-34s %4s | %7s %7s | %7s %7s %7s | %13s | %6s %6s %7s %6s\n", "slabs", "of", "plain C", "min",
           "plugin", "min", "p95", "/plain C", "begin", "slabs", "end", "adjust");
    (void)fflush(stdout);
}

static double ratio(double a, double b) {
    return b > 0.0 ? a / b : 0.0;
}

void bench_print_plugin(const bench_plugin_result *r) {
    const hs_timing *t = r->times, *frame = &t[BENCH_FRAME], *plain = &t[BENCH_PLAIN];
    printf("%-34s %4u | %7.3f %7.3f | %7.3f %7.3f %7.3f | %5.2f (%5.2f) | %6.3f %6.3f %7.3f "
           "%6.3f\n",
           bench_route_label(r->variant.route), r->variant.slab_slices, plain->median, plain->min,
           frame->median, frame->min, frame->p95, ratio(frame->median, plain->median),
           ratio(frame->min, plain->min), t[BENCH_BEGIN].median, t[BENCH_SLABS].median, t[BENCH_END].median,
           t[BENCH_ADJUST].median);
    (void)fflush(stdout);
}

void bench_print_stages(const bench_plugin_result *results, uint32_t count) {
    printf("\nStages of the plugin's frame by its own events (" SV_EXT_TIMING "), medians in milliseconds\n");
    printf("%4s %-34s %4s | %8s %8s %9s %11s %7s | %s\n", "n", "slabs", "of", "transfer", "profile",
           "threshold", "reconstruct", "output", "initial points, empty, passes");
    for (uint32_t i = 0; i < count; i++) {
        const bench_plugin_result *r = &results[i];
        if (!r->has_stages || strcmp(r->method, "mean") != 0) continue;
        printf("%4u %-34s %4u | %8.3f %8.3f %9.3f %11.3f %7.3f | %.1f %%, %u, %u\n", r->variant.n,
               bench_route_label(r->variant.route), r->variant.slab_slices, r->stages.transfer_ms,
               r->stages.profile_ms, r->stages.threshold_ms, r->stages.reconstruct_ms, r->stages.output_ms,
               100.0 * ratio(r->stats.points, r->stats.rays), r->points.empty_points, r->points.passes);
    }
}
