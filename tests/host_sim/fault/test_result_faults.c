/* SPDX-License-Identifier: MIT */
/* Results that cannot be written are refused with a reason and leave nothing behind; a plugin that fails cuts
 * nothing away. */
#include "support/result_files.h"
#include "support/result_fixture.h"

#include <unistd.h>

static void expect_refused(hs_loop *loop, const hs_source *source, uint32_t what, hs_code code,
                           const char *told) {
    hs_result_report report;
    hs_error err = {0};
    assert_false(hs_results_write(loop, source, what, 0, files_path("."), &report, &err));
    unit_told(err, code, told);
    assert_int_not_equal(access(files_path("mask.mha"), F_OK), 0);
}

/* A volume like the fixture's, of bytes. */
static void write_bytes(const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    (void)fprintf(file, "NDims = 3\nDimSize = %d %d %d\nTransformMatrix =", SOURCE_X, SOURCE_Y, SOURCE_Z);
    for (int i = 0; i < 9; i++) (void)fprintf(file, " %.17g", source_directions[i]);
    (void)fprintf(file, "\nElementSpacing = %g %g %g\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
                  source_spacing[0], source_spacing[1], source_spacing[2]);
    for (int i = 0; i < SOURCE_VOXELS; i++) (void)fputc(i % 250 + 1, file);
    assert_int_equal(fclose(file), 0);
}

static void files_of_two_types_make_no_sequence(void **state) {
    const result_fixture *f = *state;
    const char *const second = files_path("second.mha");
    write_bytes(second);
    const char *const paths[] = {f->source, second};
    sv_param_value values[2];
    const hs_loop_options options = result_options(values);
    hs_source *source;
    hs_loop *loop = result_loop(f, paths, 2, NULL, &options, &source);
    expect_refused(loop, source, HS_RESULT_CLIPPED | HS_RESULT_MASK, HS_ERR_INPUT,
                   "second.mha: ElementType is MET_UCHAR, but ");
}

/* Between reading and writing somebody else writes the file. */
static void a_file_that_changed_is_noticed(void **state) {
    const result_fixture *f = *state;
    const char *const path = files_path("second.mha");
    source_write(path, 2, "");
    const char *const paths[] = {path};
    sv_param_value values[2];
    const hs_loop_options options = result_options(values);
    hs_source *source;
    hs_loop *loop = result_loop(f, paths, 1, NULL, &options, &source);
    source_write(path, 1, "");
    expect_refused(loop, source, HS_RESULT_CLIPPED | HS_RESULT_MASK, HS_ERR_INPUT, "the file changed");
    (void)unlink(path);
    expect_refused(loop, source, HS_RESULT_CLIPPED | HS_RESULT_MASK, HS_ERR_INPUT, "No such file");
}

static void a_failed_plugin_cuts_nothing_away(void **state) {
    const result_fixture *f = *state;
    const char *const paths[] = {f->source};
    const sv_param_value values[] = {{.id = DEPTH, .value = 9}, {.id = FAIL, .value = FAIL_END}};
    const hs_loop_options options = options_with(values, 2);
    const hs_result_report report =
        result_write(f, paths, 1, NULL, &options, HS_RESULT_CLIPPED | HS_RESULT_MASK | HS_RESULT_SURFACE);
    assert_int_equal(report.clipped, 0);
    assert_int_equal(report.surface.triangles, 0);
    result_file mask;
    result_open(&mask, files_path("mask.mha"));
    for (size_t i = 0; i < mask.voxels; i++) assert_int_equal(mask.data[i], 1);
    (void)unlink(files_path("mask.mha"));
}

static void words_name_results(void **state) {
    uint32_t what;
    must(hs_result_parse("--write", "all", &what, &err));
    assert_int_equal(what, HS_RESULT_ALL);
    must(hs_result_parse("--write", "surface,depthmap", &what, &err));
    assert_int_equal(what, HS_RESULT_SURFACE | HS_RESULT_DEPTHMAP);
    static const char *const bad[] = {"", "depth", "mask,", ",mask", "mask,all", "mask mask"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        must_not(hs_result_parse("--write", bad[i], &what, &err), HS_ERR_USAGE, "");
    }
}

UNIT_MAIN(result_set_up, result_tear_down, files_of_two_types_make_no_sequence,
          a_file_that_changed_is_noticed, a_failed_plugin_cuts_nothing_away, words_name_results)
