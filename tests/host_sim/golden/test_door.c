/* SPDX-License-Identifier: MIT */
/*
 * libsmartvis_host gives the bits of `host_sim run --write all` for the same file, from the file and from
 * memory: maps, mask, clipped voxels, surface. It adjusts, marks and activates anew where it must, a plugin
 * that crashes costs a call, and every mistake is named.
 */
#include "door/smartvis_host.h"
#include "support/door_calls.h"
#include "support/files.h"
#include "support/result_files.h"
#include "support/unit.h"

#include <math.h>

static const char *build, *scan;

static int set_up(void **state) {
    build = getenv("SV_BUILD_DIR");
    if (files_setup(state) != 0 || !build || svh_open(NULL, &host, &told) != SVH_OK) return -1;
    scan = files_path("M02_full.mha");
    return system(unit_text("'%s/host_sim' scenes M02 --size 48 --export --out '%s' > /dev/null", build,
                            files_path("")));
}

static int tear_down(void **state) {
    svh_close(host);
    return files_teardown(state);
}

static svh_volume *read_scan(void) {
    svh_volume *volume;
    door_must(svh_volume_read(host, scan, NULL, &volume, &told));
    unit_keep(free_volume, volume);
    return volume;
}

/* The scan's own levels, with what its file says of them. */
static svh_volume *take_scan(void) {
    svh_about about = {.size = sizeof about};
    svh_volume *file = read_scan(), *volume;
    door_must(svh_volume_about(file, &about, &told));
    svh_voxels given = {.size = sizeof given, .scanned = SVH_ZEROS, .bytes = about.levels};
    memcpy(given.n, about.n, sizeof given.n);
    memcpy(given.spacing, about.spacing, sizeof given.spacing);
    door_must(svh_volume_take(host, &given, &volume, &told));
    unit_keep(free_volume, volume);
    return volume;
}

static svh_result clip(svh_clipper *clipper, svh_volume *volume, const svh_view *view,
                       const svh_frame *frame) {
    svh_result result = {.size = sizeof result};
    door_must(svh_clip(clipper, volume, view, frame, &result, &told));
    return result;
}

static size_t rays_of(const svh_result *result) {
    return (size_t)result->n[0] * result->n[1];
}

/* The depthmap, in memory that the next frame leaves alone. */
static float *keep_depth(const svh_result *result) {
    const size_t bytes = rays_of(result) * sizeof(float);
    return memcpy(unit_memory(bytes), result->depth, bytes);
}

static void expect_files(svh_volume *volume, const svh_view *view, const svh_result *result) {
    const size_t rays = rays_of(result);
    result_file depth, confidence, status, mask, clipped;
    svh_about about = {.size = sizeof about};
    door_must(svh_volume_about(volume, &about, &told));
    uint8_t *bytes = unit_memory((size_t)about.n[0] * about.n[1] * about.n[2]);
    result_open(&depth, files_path("depthmap.mha"));
    assert_int_equal(depth.voxels, rays);
    for (size_t i = 0; i < rays; i++) {
        const float mm = (float)((double)result->depth[i] * result->spacing[2]);
        if (memcmp(depth.data + 4 * i, &mm, 4) != 0) fail_msg("depth of ray %zu is %g mm", i, (double)mm);
    }
    result_open(&confidence, files_path("confidence.mha"));
    assert_memory_equal(confidence.data, result->confidence, 4 * rays);
    result_open(&status, files_path("status.mha"));
    assert_memory_equal(status.data, result->status, rays);
    result_open(&mask, files_path("mask.mha"));
    door_must(svh_mask(volume, view, result->depth, bytes, &told));
    assert_memory_equal(mask.data, bytes, mask.voxels);
    result_open(&clipped, files_path("clipped.mha"));
    door_must(svh_clipped(volume, view, result->depth, bytes, &told));
    assert_memory_equal(clipped.data, bytes, clipped.voxels);
}

static void expect_surface(svh_volume *volume, const svh_view *view, const svh_result *result) {
    svh_mesh mesh = {.size = sizeof mesh};
    result_mesh file;
    result_mesh_open(&file, files_path("surface.ply"));
    door_must(svh_surface(volume, view, result->depth, &mesh, &told));
    assert_int_equal(mesh.vertex_count, file.vertices);
    assert_int_equal(mesh.triangle_count, file.faces);
    assert_true(file.faces > 100);
    assert_memory_equal(mesh.vertices, file.vertex, sizeof *file.vertex * file.vertices);
    assert_memory_equal(mesh.triangles, file.face, sizeof *file.face * file.faces);
    svh_mesh_free(&mesh);
}

static void gives_the_bits_of_run(void **state) {
    (void)state;
    assert_int_equal(system(unit_text("'%s/host_sim' run --volume '%s' --set q=0.4 --yaw 20 --pitch -10 "
                                      "--picture 32 --few-pictures --frames 1 --setting smartvis "
                                      "--write all --out '%s' > /dev/null",
                                      build, scan, files_path(""))),
                     0);
    svh_volume *const volumes[] = {read_scan(), take_scan()};
    svh_clipper *clipper = clipper_of(NULL);
    door_must(svh_set(clipper, "q=0.4", &told));
    for (int i = 0; i < 2; i++) {
        svh_view view = {.size = sizeof view, .yaw = 20.0, .pitch = -10.0};
        door_must(svh_plan(volumes[i], &view, &told));
        const svh_result result = clip(clipper, volumes[i], &view, NULL);
        assert_true(result.clips && result.confidence && result.why[0] == '\0');
        expect_files(volumes[i], &view, &result);
        expect_surface(volumes[i], &view, &result);
    }
}

static void adjusts_and_activates_anew(void **state) {
    (void)state;
    svh_clipper *clipper = clipper_of(NULL);
    svh_volume *volume = read_scan();
    svh_result result = {.size = sizeof result};
    svh_param q = {.size = sizeof q};
    const double near = 0.9;
    door_must(svh_param_at(clipper, 0, &q, &told));
    assert_string_equal(q.key, "q");
    door_must_not(svh_adjust(clipper, &q.id, &near, 1, &result, &told), SVH_USAGE, "no volume to adjust");
    const svh_result first = clip(clipper, volume, NULL, NULL);
    const float *plain = keep_depth(&first);
    door_must(svh_adjust(clipper, &q.id, &near, 1, &result, &told));
    const float *turned = keep_depth(&result);
    door_must(svh_set(clipper, "q=0.9", &told));
    result = clip(clipper, volume, NULL, NULL);
    assert_memory_equal(result.depth, turned, 4 * rays_of(&result));
    assert_memory_not_equal(plain, turned, 4 * rays_of(&result));
    /* Only activation reads the method. */
    door_must(svh_set(clipper, "method=mean", &told));
    result = clip(clipper, volume, NULL, NULL);
    assert_true(result.clips && !result.confidence && result.knows_points && !result.knows_fluid);
    const float *mean = keep_depth(&result);
    door_must(svh_set(clipper, "method=minimum", &told));
    result = clip(clipper, volume, NULL, NULL);
    assert_memory_not_equal(mean, result.depth, 4 * rays_of(&result));
    svh_reset(clipper);
    result = clip(clipper, volume, NULL, NULL);
    assert_memory_equal(result.depth, plain, 4 * rays_of(&result));
}

static void marks_change_the_map(void **state) {
    (void)state;
    svh_clipper *clipper = clipper_of(NULL);
    svh_volume *volume = read_scan();
    svh_view view = {.size = sizeof view};
    door_must(svh_plan(volume, &view, &told));
    const svh_result first = clip(clipper, volume, &view, NULL);
    const size_t middle = (size_t)(first.n[1] / 2) * first.n[0] + first.n[0] / 2;
    float *plain = keep_depth(&first);
    /* In the patient's wall before the fluid: it is brought back. */
    const double side = view.box[0] / 2.0;
    const svh_mark mark = {.place = {side, side, 2.0}, .radius = 6.0, .keep = 1};
    const svh_frame frame = {.size = sizeof frame, .marks = &mark, .mark_count = 1};
    const svh_result marked = clip(clipper, volume, &view, &frame);
    assert_true(marked.depth[middle] < plain[middle] && marked.depth[0] >= plain[0]);
    door_must(svh_mark_depth(volume, &view, &mark, 1, plain, &told));
    assert_memory_equal(marked.depth, plain, 4 * rays_of(&marked));
    const svh_mark wrong = {.radius = -1.0};
    door_must_not(svh_mark_depth(volume, &view, &wrong, 1, plain, &told), SVH_USAGE, "radius");
}

static void one_box_holds_every_view(void **state) {
    (void)state;
    svh_volume *volume = read_scan();
    svh_view views[3] = {{.around = 1}, {.around = 1, .yaw = 50.0, .pitch = 20.0}, {.around = 0}};
    for (int i = 0; i < 3; i++) {
        views[i].size = sizeof views[i];
        door_must(svh_plan(volume, &views[i], &told));
    }
    assert_memory_equal(views[0].box, views[1].box, sizeof views[0].box);
    assert_memory_equal(views[0].n, views[1].n, sizeof views[0].n);
    assert_true(views[0].box[0] > views[2].box[0] && views[0].box[1] > views[2].box[1]);
}

static void a_plugin_that_crashes_costs_a_call(void **state) {
    (void)state;
    svh_clipper *good = clipper_of(unit_text("%s/examples/first_edge.so", build));
    svh_clipper *bad = clipper_of(unit_text("%s/wrong/crash_in_slab.so", build));
    svh_volume *volume = read_scan();
    svh_plugin about = {.size = sizeof about};
    svh_result result = {.size = sizeof result};
    door_must(svh_clipper_about(good, &about, &told));
    assert_string_equal(about.id, "org.smartvis.example.first_edge");
    assert_true(about.guarded);
    const char *const end = getenv("SV_SANITIZE") ? "left by exit(1) in slab" : "crashed: SIGSEGV in slab";
    door_must_not(svh_clip(bad, volume, NULL, NULL, &result, &told), SVH_PLUGIN, end);
    assert_true(clip(good, volume, NULL, NULL).clips);
    door_must(svh_clipper_about(clipper_of(NULL), &about, &told));
    assert_true(!about.guarded);
}

/* As languages that collect their garbage free them, or a thread that is still at work. */
static void a_host_outlives_its_opener(void **state) {
    (void)state;
    svh_host *const own = host, *brief;
    door_must(svh_open(NULL, &brief, &told));
    host = brief;
    svh_clipper *const clipper = clipper_of(NULL);
    svh_volume *const volume = read_scan();
    host = own;
    svh_close(brief);
    assert_true(clip(clipper, volume, NULL, NULL).clips);
}

static void mistakes_are_named(void **state) {
    (void)state;
    svh_volume *volume = read_scan(), *none;
    svh_clipper *clipper = clipper_of(NULL), *no_clipper;
    svh_result result = {.size = sizeof result};
    svh_view view = {.size = sizeof view};
    const uint8_t byte = 0;
    svh_voxels given = {.size = sizeof given, .n = {1, 0, 1}, .unsaid = 1, .bytes = &byte};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_INPUT, "0 voxels along y");
    assert_null(none);
    given = (svh_voxels){.size = sizeof given, .n = {1, 1, 1}, .spacing = {1, 1, NAN}, .bytes = &byte};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_INPUT, "spacing along z is nan");
    given = (svh_voxels){.size = sizeof given, .n = {1, 1, 1}, .unsaid = 1, .origin = {0, INFINITY, 0}};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_INPUT, "origin[1] is inf");
    given = (svh_voxels){
        .size = sizeof given, .n = {1, 1, 1}, .unsaid = 1, .direction = {1, 1, 0, 0, 1, 0, 0, 0, 1}};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_INPUT, "direction is (1 1 0)");
    given = (svh_voxels){.size = sizeof given, .n = {1, 1, 1}, .unsaid = 1, .apex_said = 1, .apex = {NAN}};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_INPUT, "apex[0] is nan");
    const double two[] = {1.0, 2.0};
    given = (svh_voxels){.size = sizeof given, .n = {2, 1, 1}, .unsaid = 1, .values = two, .window = {5, 1}};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_USAGE, "window 5 .. 1");
    given = (svh_voxels){.size = sizeof given, .n = {1, 1, 1}, .unsaid = 1};
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_USAGE, "neither bytes nor values");
    given.size--;
    door_must_not(svh_volume_take(host, &given, &none, &told), SVH_USAGE, "svh_voxels: size is");
    door_must_not(svh_volume_read(host, "/none.mha", NULL, &none, &told), SVH_INPUT, "/none.mha");
    door_must_not(svh_set(clipper, "qq=1", &told), SVH_USAGE, "no parameter 'qq'");
    door_must_not(svh_clip(clipper, volume, &view, NULL, &result, &told), SVH_USAGE, "call svh_plan first");
    view.yaw = NAN;
    door_must_not(svh_plan(volume, &view, &told), SVH_USAGE, "yaw, pitch and roll are nan, 0 and 0");
    view = (svh_view){.size = sizeof view, .turned = 1};
    door_must_not(svh_plan(volume, &view, &told), SVH_USAGE, "rotation is (0 0 0)");
    view = (svh_view){.size = sizeof view, .from = SVH_FROM_LEFT};
    door_must_not(svh_plan(volume, &view, &told), SVH_INPUT, "no view left");
    const svh_frame frame = {.size = sizeof frame, .flags = 8};
    door_must_not(svh_clip(clipper, volume, NULL, &frame, &result, &told), SVH_USAGE, "flags are 0x8");
    door_must_not(svh_clipper_open(host, "/none.so", NULL, &no_clipper, &told), SVH_PLUGIN, "/none.so");
    /* What the plugin refuses comes with its call, status and words, and the next frame is as any. */
    door_must(svh_set_number(clipper, 1, 77.0, &told));
    door_must_not(svh_clip(clipper, volume, NULL, NULL, &result, &told), SVH_PLUGIN, "77");
    assert_true(told.status < 0 && told.call[0] && strstr(told.text, told.reason) && told.reason[0]);
    svh_reset(clipper);
    assert_true(clip(clipper, volume, NULL, NULL).clips);
}

static void what_is_not_given_is_named(void **state) {
    (void)state;
    svh_volume *volume = read_scan();
    svh_clipper *clipper = clipper_of(NULL);
    svh_result result = {.size = sizeof result};
    svh_view view = {.size = sizeof view};
    float depth = 0;
    door_must_not(svh_plan(volume, NULL, &told), SVH_USAGE, "svh_plan: view is NULL");
    door_must_not(svh_clip(NULL, volume, NULL, NULL, &result, &told), SVH_USAGE, "svh_clip: clipper is NULL");
    door_must_not(svh_mask(volume, &view, &depth, NULL, &told), SVH_USAGE, "svh_mask: mask is NULL");
    door_must(svh_plan(volume, &view, &told));
    door_must_not(svh_mark_depth(volume, &view, NULL, 2, &depth, &told), SVH_USAGE,
                  "marks is NULL, expected 2");
    assert_true(clip(clipper, volume, &view, NULL).clips);
    door_must_not(svh_adjust(clipper, NULL, NULL, 1, &result, &told), SVH_USAGE, "svh_adjust: ids is NULL");
    assert_int_equal(svh_set(clipper, NULL, NULL), SVH_USAGE);
    svh_reset(NULL);
    svh_mesh_free(NULL);
}

UNIT_MAIN(set_up, tear_down, gives_the_bits_of_run, adjusts_and_activates_anew, marks_change_the_map,
          one_box_holds_every_view, a_plugin_that_crashes_costs_a_call, a_host_outlives_its_opener,
          mistakes_are_named, what_is_not_given_is_named)
