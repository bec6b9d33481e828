/* SPDX-License-Identifier: MIT */
/* Cases from files with maps of what was scanned: a scene of ours, written as `scenes --export` does. */
#include "eval/eval_case.h"
#include "scene/scene_export.h"
#include "support/metaimage_files.h"
#include "support/scene_fixture.h"
#include "volume/metaimage_write.h"

enum { N = 32, RAYS = N * N, TEXT = 300 };

typedef struct {
    hs_scene_data scene;
    uint16_t first[RAYS], end[RAYS];
} fixture;

static void write_map(const char *file, hs_met_type type, const void *data, uint32_t n) {
    const hs_metaimage_format format = {
        .type = type, .dims = 3, .size = {n, n, 1}, .spacing = {1, 1, 1}, .compress = true};
    must(hs_metaimage_write(files_path(file), &format, data, &err));
}

static void write_maps(const fixture *f) {
    write_map("first.mha", HS_MET_USHORT, f->first, N);
    write_map("end.mha", HS_MET_USHORT, f->end, N);
}

/* Maps that are unlike in every column and row, and a ray without a label of which nothing was scanned. */
static int make_files(void **state) {
    fixture *f = unit_memory(sizeof *f);
    assert_int_equal(files_setup(state), 0);
    f->scene = make_scene("D01", N, 2, 7, 0);
    /* Black fluid: zeros that the maps must tell from what was not scanned. */
    for (size_t i = 0; i < (size_t)RAYS * N; i++)
        if (f->scene.full.voxels[i] < 20) f->scene.full.voxels[i] = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        f->first[i] = (uint16_t)(i % 3);
        f->end[i] = (uint16_t)(N - i / N % 4);
    }
    assert_int_equal(f->scene.label[0], HS_LABEL_NEITHER);
    f->first[0] = f->end[0] = 5;
    must(hs_scene_export(&f->scene, files_path("D01"), &err));
    write_maps(f);
    *state = f;
    return 0;
}

static int remove_files(void **state) {
    unit_return(NULL);
    return files_teardown(state);
}

/* Opens a case of the scene's files, with two maps or without. */
static bool open_case(const char *first, const char *end, hs_eval_source *out, hs_error *err) {
    char name[6 * TEXT];
    const char *const d = files_path(".");
    int length = snprintf(name, sizeof name, "%s/D01_full.mha,%s/D01_truth.mha,%s/D01_label.mha", d, d, d);
    if (first) length += snprintf(name + length, TEXT, ",%s/%s", d, first);
    if (end) (void)snprintf(name + length, TEXT, ",%s/%s", d, end);
    const hs_eval_request request = {.name = name};
    return hs_eval_source_open(out, &request, err);
}

static void must_fail(const char *first, const char *end, hs_code code, const char *says) {
    hs_eval_source source;
    hs_error err = {0};
    assert_false(open_case(first, end, &source, &err));
    unit_told(err, code, says);
}

static void maps_tell_what_was_scanned(void **state) {
    const fixture *f = *state;
    hs_eval_source s;
    uint32_t black = 0;
    must(open_case("first.mha", "end.mha", &s, &err));
    const hs_volume *const of[] = {hs_source_volume(&s.source, 0), hs_source_truth(&s.source, 0)};
    const uint8_t *const was[] = {f->scene.full.voxels, f->scene.truth.voxels};
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < RAYS; i++)
            for (uint32_t z = 0; z < N; z++) {
                const uint8_t old = was[k][z * RAYS + i], now = of[k]->voxels[z * RAYS + i];
                const bool scanned = f->first[i] <= z && z < f->end[i];
                assert_int_equal(now, !scanned ? 0 : old == 0 ? 1 : old);
                black += scanned && old == 0;
            }
    assert_true(black > 100);
    assert_memory_equal(s.label, f->scene.label, RAYS);
    hs_eval_source_close(&s);
}

/* Without maps a zero that reaches the border passes for unscanned, inner black fluid does not. */
static void without_maps_zeros_are_guessed_at(void **state) {
    hs_eval_source with, without;
    must(open_case("first.mha", "end.mha", &with, &err));
    must(open_case(NULL, NULL, &without, &err));
    assert_memory_not_equal(hs_source_volume(&with.source, 0)->voxels,
                            hs_source_volume(&without.source, 0)->voxels, (size_t)RAYS * N);
    hs_eval_source_close(&with);
    hs_eval_source_close(&without);
}

static void wrong_maps_are_named(void **state) {
    static const uint16_t small[4] = {0};
    static float fraction[RAYS];
    fraction[2 * N + 1] = 1.5f;
    write_map("small.mha", HS_MET_USHORT, small, 2);
    write_map("fraction.mha", HS_MET_FLOAT, fraction, N);
    must_fail("first.mha", NULL, HS_ERR_INPUT, "first.mha: "); /* it counts as a reference */
    must_fail("nowhere.mha", "end.mha", HS_ERR_INPUT, "nowhere.mha");
    must_fail("small.mha", "end.mha", HS_ERR_INPUT, "small.mha");
    must_fail("fraction.mha", "end.mha", HS_ERR_INPUT, "fraction.mha: pixel (1, 2) is 1.5, expected a slice");
    must_fail("D01_far.mha", "end.mha", HS_ERR_INPUT, "D01_far.mha: pixel (0, 0) is -1, expected a slice");
    must_fail("end.mha", "first.mha", HS_ERR_INPUT, "end.mha: pixel (1, 0) is 32, behind 1 in ");
}

static void a_labelled_ray_was_scanned(void **state) {
    fixture *f = *state;
    uint32_t i = 0;
    while (f->scene.label[i] != HS_LABEL_FETUS) i++;
    const uint16_t end = f->end[i];
    f->end[i] = f->first[i];
    write_maps(f);
    const char *const says = unit_text(
        "D01_label.mha: label 2 at pixel (%u, %u), where nothing was scanned: %u", i % N, i / N, f->first[i]);
    must_fail("first.mha", "end.mha", HS_ERR_INPUT, says);
    f->end[i] = end;
    write_maps(f);
}

UNIT_MAIN(make_files, remove_files, maps_tell_what_was_scanned, without_maps_zeros_are_guessed_at,
          wrong_maps_are_named, a_labelled_ray_was_scanned)
