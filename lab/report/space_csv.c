/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "base/output_file.h"
#include "base/paths.h"

#include <limits.h>

static void write_head(const hs_eval_space *space, FILE *file) {
    (void)fprintf(file, "t_b,delta_mi,k,%s,outcome",
                  space->plan->knob.exists ? space->plan->knob.info.key : "position");
    for (int m = 0; m < HS_MEASURE_COUNT; m++) (void)fprintf(file, ",%s", hs_measure_key((hs_measure)m));
    (void)fprintf(file, "\n");
}

/* The rows of one item. */
static void write_item(const hs_eval_space *space, uint32_t item, FILE *file) {
    const hs_eval_plan *plan = space->plan;
    const uint32_t t = item / plan->kernel.count, k = item % plan->kernel.count;
    for (uint32_t q = 0; q < plan->knob.count; q++) {
        if (plan->threshold.exists)
            (void)fprintf(file, "%.6g,%.4f,", plan->threshold.value[t],
                          space->volume_max - plan->threshold.value[t]);
        else
            (void)fprintf(file, ",,");
        if (plan->kernel.exists) (void)fprintf(file, "%.6g", plan->kernel.value[k]);
        (void)fprintf(file, ",");
        if (plan->knob.exists) (void)fprintf(file, "%.9g", plan->knob.value[q]);
        (void)fprintf(file, ",%d", space->outcome[item]);
        const hs_measures *m = &space->at[(size_t)item * plan->knob.count + q];
        for (int i = 0; i < HS_MEASURE_COUNT; i++) (void)fprintf(file, ",%.6g", (double)m->of[i]);
        (void)fprintf(file, "\n");
    }
}

bool hs_eval_csv_write(const hs_eval_space *space, const char *folder, hs_error *err) {
    char name[96], path[PATH_MAX];
    hs_output_file output = {0};
    (void)snprintf(name, sizeof name, "space_%s.csv", space->name);
    if (!hs_path_join(folder, name, path, PATH_MAX, err) || !hs_output_open(&output, path, err)) return false;
    write_head(space, output.file);
    for (uint32_t item = 0; item < space->items; item++) write_item(space, item, output.file);
    return hs_output_commit(&output, err); /* fails if any write before did */
}
