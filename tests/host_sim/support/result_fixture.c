/* SPDX-License-Identifier: MIT */
#include "support/result_fixture.h"

#include <unistd.h>

const double source_directions[9] = {0.8, 0.6, 0, -0.48, 0.64, 0.6, -0.36, 0.48, -0.8};
const double source_spacing[3] = {0.9, 0.6, 0.75};
const double source_offset[3] = {12.5, -40, 1000};

/* Noise, so that no two neighbours are alike. */
int16_t source_voxel(size_t i) {
    if (i == 7) return SOURCE_LOWEST;
    return (int16_t)(SOURCE_LOWEST + 1 + (int)((i * 2654435761u >> 7) % 1900u));
}

void source_write(const char *path, uint32_t frames, const char *lines) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    (void)fprintf(file, "ObjectType = Image\nNDims = %d\nCompressedData = False\nDimSize = %d %d %d",
                  frames > 1 ? 4 : 3, SOURCE_X, SOURCE_Y, SOURCE_Z);
    if (frames > 1) (void)fprintf(file, " %u", frames);
    (void)fprintf(file, "\nOffset = %g %g %g\nTransformMatrix =", source_offset[0], source_offset[1],
                  source_offset[2]);
    for (int i = 0; i < 9; i++) (void)fprintf(file, " %.17g", source_directions[i]);
    (void)fprintf(file, "\nElementSpacing = %g %g %g\n%sElementType = MET_SHORT\nElementDataFile = LOCAL\n",
                  source_spacing[0], source_spacing[1], source_spacing[2], lines);
    for (size_t i = 0; i < (size_t)SOURCE_VOXELS * frames; i++) {
        const int16_t voxel = source_voxel(i);
        assert_int_equal(fwrite(&voxel, sizeof voxel, 1, file), 1);
    }
    assert_int_equal(fclose(file), 0);
}

int result_set_up(void **state) {
    static result_fixture f;
    hs_error err = {0};
    if (files_setup(state) != 0 || !hs_cl_open(&f.cl, &err)) return -1;
    f.plugin = open_plugin("plane");
    (void)snprintf(f.source, sizeof f.source, "%s", files_path("source.mha"));
    source_write(f.source, 1, "");
    *state = &f;
    return 0;
}

int result_tear_down(void **state) {
    static const char *const known[] = {
        "source.mha",  "sequence.mha", "second.mha",  "depthmap.mha",     "confidence.mha",  "status.mha",
        "clipped.mha", "mask.mha",     "surface.ply", "surface_0000.ply", "surface_0001.ply"};
    result_fixture *f = *state;
    unit_return(NULL);
    hs_cl_close(&f->cl);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) (void)unlink(files_path(known[i]));
    const int left = files_count();
    return files_teardown(state) || left;
}

hs_loop_options result_options(sv_param_value *values) {
    values[0] = (sv_param_value){.id = DEPTH, .value = 3};
    values[1] = (sv_param_value){.id = SHAPE, .value = 1};
    hs_loop_options o = options_with(values, 2);
    o.lowres = 24;
    return o;
}

hs_loop *result_loop(const result_fixture *f, const char *const *paths, uint32_t count,
                     const hs_metaimage_options *read, const hs_loop_options *options, hs_source **source) {
    const hs_source_files how = {.metaimage = read ? *read : (hs_metaimage_options){0}};
    *source = open_source(paths, count, &how);
    return make_loop_from(&f->cl, *source, f->plugin, options);
}

hs_result_report result_write(const result_fixture *f, const char *const *paths, uint32_t count,
                              const hs_metaimage_options *read, const hs_loop_options *options,
                              uint32_t what) {
    hs_source *source;
    hs_error err = {0};
    hs_result_report report;
    hs_loop *loop = result_loop(f, paths, count, read, options, &source);
    if (!hs_results_write(loop, source, what & ~(uint32_t)HS_RESULT_CONFIDENCE, what & HS_RESULT_CONFIDENCE,
                          files_path(""), &report, &err))
        fail_msg("%s", err.text);
    return report;
}
