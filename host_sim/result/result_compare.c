/* SPDX-License-Identifier: MIT */
#include "result/result_write.h"

#include "core/output_file.h"
#include "core/paths.h"
#include "core/system.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A row for each ray whose depths are too far apart. */
static bool write_differences(const char *path, const double *kept, const double *found, uint32_t width,
                              uint32_t height, hs_result_difference *d, hs_error *err) {
    hs_output_file output;
    if (!hs_output_open(&output, path, err)) return false;
    (void)fprintf(output.file, "x,y,reference_mm,depth_mm,difference_mm\n");
    for (uint32_t i = 0; i < width * height; i++) {
        const double off = found[i] - kept[i];
        if (fabs(off) <= d->tolerance) continue;
        (void)fprintf(output.file, "%u,%u,%.9g,%.9g,%.9g\n", i % width, i / width, kept[i], found[i], off);
        if (fabs(off) > d->largest) {
            d->largest = fabs(off);
            d->x = i % width;
            d->y = i / width;
        }
        d->different++;
    }
    return hs_output_commit(&output, err);
}

bool hs_result_compare(const char *folder, const char *reference, uint32_t width, uint32_t height,
                       double tolerance, hs_result_difference *out, hs_error *err) {
    char map[SYS_PATH], rows[SYS_PATH];
    const uint32_t rays = width * height;
    *out = (hs_result_difference){.rays = rays, .tolerance = tolerance};
    double *kept = hs_memory((size_t)rays * 2, sizeof *kept, reference, err);
    if (!kept) return false;
    const bool ok = hs_path_join(folder, "depthmap.mha", map, sizeof map, err) &&
                    hs_path_join(folder, "differences.csv", rows, sizeof rows, err) &&
                    hs_metaimage_read_map(reference, width, height, kept, err) &&
                    hs_metaimage_read_map(map, width, height, kept + rays, err) &&
                    write_differences(rows, kept, kept + rays, width, height, out, err);
    free(kept);
    return ok;
}
