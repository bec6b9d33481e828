/* SPDX-License-Identifier: MIT */
#include "report/report_pictures_compare.h"

#include "base/paths.h"
#include "report/report_draw.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>

bool hs_eval_compare_folder(const hs_eval_comparison *x, uint32_t index, char *out, size_t bytes,
                            hs_error *err) {
    char name[sizeof x->name[0]];
    (void)snprintf(name, sizeof name, "%s", x->name[index]); /* of a file: any characters */
    for (char *p = name; *p; p++)
        if (!isalnum((unsigned char)*p) && *p != '-') *p = '_';
    return hs_path_join(x->options->out, name, out, bytes, err);
}

void hs_eval_compare_file(uint32_t method, char *out, size_t bytes) {
    (void)snprintf(out, bytes, "method_%u.png", method + 1);
}

/* The first method's view has the full volume and the ground truth, too. */
static bool draw_method(const hs_eval_comparison *x, uint32_t method, const hs_eval_case *c,
                        const char *folder, hs_error *err) {
    const hs_eval_drawing drawing = {.options = x->options,
                                     .cl = &x->cl,
                                     .plugin = &x->method[method].plugin,
                                     .c = c,
                                     .values = &x->method[method].values,
                                     .pixels = HS_EVAL_PICTURE};
    char file[32];
    hs_view view;
    hs_eval_compare_file(method, file, sizeof file);
    if (!hs_eval_draw_result(&drawing, folder, file, &view, err)) return false;
    const bool ok = method > 0 || (hs_eval_save_rgba(view.full, HS_EVAL_PICTURE, folder, "full.png", err) &&
                                   hs_eval_save_rgba(view.truth, HS_EVAL_PICTURE, folder, "truth.png", err));
    hs_view_free(&view);
    return ok;
}

bool hs_eval_compare_pictures(const hs_eval_comparison *x, uint32_t index, hs_eval_case *c, hs_error *err) {
    char folder[PATH_MAX];
    hs_eval_case_release(c);
    bool ok =
        hs_eval_compare_folder(x, index, folder, sizeof folder, err) && hs_path_make_folder(folder, err);
    for (uint32_t m = 0; ok && m < x->count; m++) ok = draw_method(x, m, c, folder, err);
    return ok;
}
