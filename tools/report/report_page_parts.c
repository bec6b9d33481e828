/* SPDX-License-Identifier: MIT */
#include "report/report_page_parts.h"

#include "base/paths.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void hs_eval_page_show(hs_page *report, const hs_eval_study *study, uint32_t index, const char *name,
                       const char *alt, const char *caption) {
    const bool drawn = strstr(name, "error") || strstr(name, "confidence") || strstr(name, "depthmap");
    char folder[PATH_MAX], path[PATH_MAX], full_alt[256];
    (void)snprintf(full_alt, sizeof full_alt, "%s: %s", study->space[index].name, alt);
    if (hs_path_join(study->options->out, study->space[index].name, folder, sizeof folder, &report->error) &&
        hs_path_join(folder, name, path, sizeof path, &report->error))
        (drawn ? hs_page_picture : hs_page_photo)(report, path, full_alt, caption);
}

void hs_eval_figure_put(hs_page *report, hs_eval_figure_fn write, const void *plot) {
    char *markup = NULL;
    size_t bytes = 0;
    FILE *stream = open_memstream(&markup, &bytes);
    if (stream) write(stream, plot);
    if (stream && fclose(stream) == 0)
        hs_page_markup(report, markup);
    else
        (void)hs_fail(&report->error, HS_ERR_MEMORY, "page: no memory for a figure");
    free(markup);
}
