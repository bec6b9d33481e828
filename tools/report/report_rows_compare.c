/* SPDX-License-Identifier: MIT */
#include "report/report_rows_compare.h"

#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"

#include <errno.h>
#include <limits.h>
#include <string.h>

bool hs_eval_compare_table(const hs_eval_comparison *x, hs_error *err) {
    char path[PATH_MAX];
    hs_output_file output = {0};
    if (!hs_path_join(x->options->out, "compare.csv", path, sizeof path, err) ||
        !hs_output_open(&output, path, err))
        return false;
    (void)fprintf(output.file,
                  "rank,method,case,seed,e_abs,e_abs_best_knob,fetus_cut,occluder_left,e_abs_unclipped\n");
    for (uint32_t r = 0; r < x->count; r++) {
        const hs_eval_method *m = &x->method[x->rank[r]];
        for (uint32_t i = 0; i < x->options->case_count; i++)
            for (uint32_t s = 0; s < x->seeds; s++)
                (void)fprintf(output.file, "%u,%u,%s,%u,%.6g,%.6g,%.6g,%.6g,%.6g\n", r + 1, x->rank[r] + 1,
                              x->name[i], s, (double)m->of[HS_METHOD_ABS][i][s],
                              (double)m->of[HS_METHOD_BEST][i][s], (double)m->of[HS_METHOD_CUT][i][s],
                              (double)m->of[HS_METHOD_LEFT][i][s], (double)x->unclipped[i][s]);
    }
    if (!ferror(output.file)) return hs_output_commit(&output, err);
    hs_output_discard(&output);
    return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
}

void hs_eval_compare_print(const hs_eval_comparison *x, FILE *out) {
    hs_print(out, "%4s %8s %10s %14s %18s  method\n", "rank", "e_abs", "best knob", "fetus cut [%]",
             "occluder left [%]");
    for (uint32_t r = 0; r < x->count; r++) {
        const uint32_t m = x->rank[r];
        hs_print(out, "%4u %8.2f %10.2f %14.2f %18.2f  %s\n", r + 1, hs_eval_method_mean(x, m, HS_METHOD_ABS),
                 hs_eval_method_mean(x, m, HS_METHOD_BEST), 100 * hs_eval_method_mean(x, m, HS_METHOD_CUT),
                 100 * hs_eval_method_mean(x, m, HS_METHOD_LEFT), x->method[m].label);
    }
}
