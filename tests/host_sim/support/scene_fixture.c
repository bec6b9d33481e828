/* SPDX-License-Identifier: MIT */
#include "support/scene_fixture.h"

#include <math.h>
#include <unistd.h>

const char *const scene_cases[SCENE_CASES] = {"D01", "D02", "E01", "E02", "E03", "E04", "M01", "M02", "M03"};

static void free_field(void *field) {
    hs_field_free(field);
}

static void free_scene(void *data) {
    hs_scene_free(data);
}

hs_scene_spec empty_spec(void) {
    hs_scene_spec spec;
    must(hs_scene_read_text("empty.json", EMPTY_SCENE, &spec, &err));
    return spec;
}

hs_field *one_tissue_field(uint32_t n, float h, hs_tissue tissue) {
    const uint32_t size[3] = {n, n, n};
    const float spacing[3] = {h, h, h};
    hs_field *field = unit_memory(sizeof *field);
    unit_keep(free_field, field);
    must(hs_field_init(field, size, n, spacing, &err));
    field->threads = 2;
    field->seed = 7;
    field->noise_seed = hs_random_key(7, 1000);
    size_t count = (size_t)n * n * n;
    memset(field->tissue, (int)tissue, count);
    memset(field->surface, tissue == HS_TISSUE_FLUID ? HS_DISTANCE_FAR : -HS_DISTANCE_FAR, count);
    memset(field->bone, HS_DISTANCE_FAR, count);
    for (size_t i = 0; i < count; i++) field->diffuse[i] = field->coherent[i] = HS_LEVEL_SILENT;
    return field;
}

void make_speckle(hs_field *field, const hs_scene_spec *spec) {
    hs_speckle *speckle = hs_speckle_begin(field, spec, field->end);
    assert_non_null(speckle);
    hs_speckle_draw(speckle);
    hs_speckle_finish(speckle);
    hs_speckle_end(speckle);
}

double level_db(int16_t level) {
    return (double)level / HS_LEVEL_ONE;
}

hs_scene_data scene_frame(hs_scene *scene, const hs_scene_options *options) {
    hs_scene_data *out = unit_memory(sizeof *out);
    unit_keep(free_scene, out);
    must(hs_scene_frame(scene, options, out, &err));
    hs_scene_close(scene);
    return *out;
}

hs_scene_data make_scene(const char *name, uint32_t size, uint32_t threads, uint64_t seed, uint32_t frame) {
    hs_error err = {0};
    hs_scene *scene = hs_scene_open(name, &err);
    if (!scene) fail_msg("%s", err.text);
    return scene_frame(scene,
                       &(hs_scene_options){.size = size, .threads = threads, .seed = seed, .frame = frame});
}

uint8_t scene_voxel(const uint8_t *voxels, const hs_volume *v, size_t pixel, long z) {
    return voxels[(size_t)z * v->nx * v->ny + pixel];
}

void check_scene_pixel(const hs_scene_data *d, size_t pixel) {
    const hs_volume *v = &d->full;
    long fetus = -1;
    for (long z = (long)v->nz - 1; z >= 0; z--)
        if (scene_voxel(v->voxels, v, pixel, z) != 0 &&
            hs_tissue_is_fetus(scene_voxel(d->tissue, v, pixel, z)))
            fetus = z;
    assert_int_equal(d->label[pixel] == HS_LABEL_FETUS, fetus >= 0);
    if (d->label[pixel] == HS_LABEL_NEITHER) {
        assert_true(isnan(d->near_end[pixel]) && isnan(d->far_end[pixel]));
        for (long z = 0; z < (long)v->nz; z++)
            assert_false(scene_voxel(v->voxels, v, pixel, z) != 0 &&
                         scene_voxel(d->tissue, v, pixel, z) == HS_TISSUE_FLUID);
        return;
    }
    long near_z = lrintf(d->near_end[pixel]), far_z = lrintf(d->far_end[pixel]);
    assert_true(near_z >= 0 && near_z <= far_z && far_z < (long)v->nz);
    bool touched = fetus >= 0 && near_z == fetus;
    for (long z = near_z; z <= far_z && !touched; z++)
        if (scene_voxel(d->tissue, v, pixel, z) != HS_TISSUE_FLUID)
            fail_msg("pixel %zu slice %ld is no fluid", pixel, z);
    if (fetus >= 0 && !touched) assert_int_equal(far_z + 1, fetus);
    if (near_z > 0 && scene_voxel(v->voxels, v, pixel, near_z - 1) != 0)
        assert_int_not_equal(scene_voxel(d->tissue, v, pixel, near_z - 1), HS_TISSUE_FLUID);
    assert_true(d->clip[pixel] >= d->near_end[pixel] && d->clip[pixel] <= d->far_end[pixel]);
}

hs_scene *scene_of_text(const char *text, hs_error *err) {
    const char *const path = unit_text("/tmp/scene_of_text_%ld.json", (long)getpid());
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
    hs_scene *scene = hs_scene_open(path, err);
    (void)unlink(path);
    return scene;
}

hs_scene_data make_text_scene(const char *text, uint32_t size) {
    hs_error err = {0};
    hs_scene *scene = scene_of_text(text, &err);
    if (!scene) fail_msg("%s", err.text);
    return scene_frame(scene, &(hs_scene_options){.size = size, .threads = 2});
}
