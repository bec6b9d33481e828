/* SPDX-License-Identifier: MIT */
#include "bench/bench_method.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const bench_method bench_methods[BENCH_METHODS] = {
    {"cost", {6.0, 15.0}, 171}, /* its bins of 512^3 voxels are gigabytes */
    {"wall", {1.5, 3.5}, 512},
};

double bench_limit_ms(const bench_method *method, uint32_t n) {
    return n == 128 ? method->limit_ms[0] : n == 171 ? method->limit_ms[1] : 0.0;
}

static double limit_of(const char *name, uint32_t n) {
    for (int i = 0; i < BENCH_METHODS; i++)
        if (strcmp(name, bench_methods[i].name) == 0) return bench_limit_ms(&bench_methods[i], n);
    return 0.0;
}

const bench_plugin_result *bench_find(const bench_report *report, const bench_plugin_result *like,
                                      const char *method) {
    for (uint32_t i = 0; i < report->plugin_count; i++) {
        const bench_plugin_result *r = &report->plugin[i];
        if (strcmp(r->method, method) == 0 && r->variant.n == like->variant.n &&
            r->variant.slab_slices == like->variant.slab_slices && r->variant.route == like->variant.route)
            return r;
    }
    return NULL;
}

static double per_profile(const bench_plugin_result *result, const bench_plugin_result *of) {
    if (!of || !of->has_stages || !(of->stages.profile_ms > 0.0)) return NAN;
    return result->times[BENCH_FRAME].median / of->stages.profile_ms;
}

bench_profile_ratio bench_per_profile(const bench_report *report, const bench_plugin_result *result) {
    return (bench_profile_ratio){.mean = per_profile(result, bench_find(report, result, "mean")),
                                 .own = per_profile(result, result)};
}

static void print_line(const bench_report *report, const bench_plugin_result *r) {
    const bench_times *t = &r->times[BENCH_FRAME];
    const bench_profile_ratio ratio = bench_per_profile(report, r);
    const double limit = limit_of(r->method, r->variant.n);
    const double n = r->variant.n;
    printf("%4u %-34s %4u | %7.3f %7.3f %7.3f %8.2f | %8.3f %9.3f %11.3f | %7.1f %5.1f | ", r->variant.n,
           bench_route_label(r->variant.route), r->variant.slab_slices, t->median, t->min, t->p95,
           t->median * 1e6 / (n * n * n), r->stages.profile_ms, r->stages.threshold_ms,
           r->stages.reconstruct_ms, ratio.mean, ratio.own);
    if (limit > 0.0) printf("%4.1f ms", limit);
    printf("%s\n", r->stats.outcome == SV_OK ? "" : "  (no surface)");
}

void bench_print_method(const bench_report *report, const char *method) {
    bool any = false;
    for (uint32_t i = 0; i < report->plugin_count; i++) {
        if (strcmp(report->plugin[i].method, method) != 0) continue;
        if (!any) {
            printf("\nFrame with method %s, milliseconds (medians unless named); as multiples of the profile "
                   "stage of the mean filter and of its own\n",
                   method);
            printf("%4s %-34s %4s | %7s %7s %7s %8s | %8s %9s %11s | %7s %5s | %s\n", "n", "slabs", "of",
                   "frame", "min", "p95", "ns/voxel", "profile", "threshold", "reconstruct", "/mean's",
                   "/own", "limit");
        }
        any = true;
        print_line(report, &report->plugin[i]);
    }
    (void)fflush(stdout);
}
