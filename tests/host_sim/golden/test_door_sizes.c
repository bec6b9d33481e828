/* SPDX-License-Identifier: MIT */
/*
 * Programs and libsmartvis_host of two versions: every struct of the door is taken from a newer program,
 * whose fields behind ours stay as they are, and refused if it ends before what 1.0 had. What an older
 * program's struct lacks counts as 0, and is not written.
 */
#include "door/door_size.h"
#include "door/smartvis_host.h"
#include "support/door_calls.h"
#include "support/unit.h"

enum { SIDE = 32, BEHIND = 32, FILL = 0xa5 };

static uint8_t voxels[SIDE * SIDE * SIDE];

/* A newer program's struct. */
#define LONGER(type)                                                                                         \
    struct {                                                                                                 \
        type own;                                                                                            \
        uint8_t behind[BEHIND];                                                                              \
    }
#define LENGTHEN(s)                                                                                          \
    do {                                                                                                     \
        (s)->own.size = sizeof *(s);                                                                         \
        memset((s)->behind, FILL, BEHIND);                                                                   \
    } while (0)
#define IS_AS_LONG(s)                                                                                        \
    do {                                                                                                     \
        assert_int_equal((s)->own.size, sizeof *(s));                                                        \
        for (int i = 0; i < BEHIND; i++) assert_int_equal((s)->behind[i], FILL);                             \
    } while (0)

static int set_up(void **state) {
    (void)state;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int z = i / (SIDE * SIDE);
        voxels[i] = z < 6 ? 120 : z < 18 ? 8 : 200;
    }
    return svh_open(NULL, &host, &told) == SVH_OK ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    svh_close(host);
    return 0;
}

static svh_voxels given_voxels(void) {
    return (svh_voxels){.size = sizeof(svh_voxels),
                        .n = {SIDE, SIDE, SIDE},
                        .spacing = {2, 2, 2},
                        .scanned = SVH_ALL_SCANNED,
                        .bytes = voxels};
}

static svh_volume *taken(const svh_voxels *given) {
    svh_volume *volume;
    door_must(svh_volume_take(host, given, &volume, &told));
    unit_keep(free_volume, volume);
    return volume;
}

/* ---- what an older and a newer version make of each other */
typedef struct {
    uint32_t size, first;
} older;
typedef struct {
    uint32_t size, first;
    double second;
} newer;

static void fields_that_one_side_lacks(void **state) {
    (void)state;
    hs_error err = {0};
    struct {
        older own;
        uint8_t behind[16];
    } program = {.own = {sizeof program.own, 7}};
    memset(program.behind, FILL, sizeof program.behind);
    newer ours;
    memset(&ours, FILL, sizeof ours);
    assert_true(door_take(&ours, sizeof ours, &program, sizeof(older), "older", &err));
    assert_true(ours.size == sizeof ours && ours.first == 7 && ours.second == 0.0);
    ours = (newer){sizeof ours, 8, 2.5};
    door_give(&program, &ours, sizeof ours);
    assert_true(program.own.size == sizeof(older) && program.own.first == 8);
    for (size_t i = 0; i < sizeof program.behind; i++) assert_int_equal(program.behind[i], FILL);
    newer ahead = {sizeof ahead, 9, 3.5};
    older library;
    assert_true(door_take(&library, sizeof library, &ahead, sizeof(older), "older", &err));
    assert_true(library.size == sizeof library && library.first == 9);
    library.first = 10;
    door_give(&ahead, &library, sizeof library);
    assert_true(ahead.size == sizeof ahead && ahead.first == 10 && ahead.second == 3.5);
    program.own.size--;
    assert_false(door_take(&ours, sizeof ours, &program, sizeof(older), "older", &err));
    assert_string_equal(err.text, "older: size is 7, expected at least 8");
}

/* ---- each struct */
static void a_newer_program_opens_and_takes(void **state) {
    (void)state;
    LONGER(svh_options) options = {.own = {.guard = SVH_GUARD_OFF}};
    LONGER(svh_voxels) given = {.own = given_voxels()};
    LONGER(svh_about) about;
    svh_host *another;
    LENGTHEN(&options);
    door_must(svh_open(&options.own, &another, &told));
    svh_close(another);
    options.own.size = DOOR_1_0_svh_options - 1;
    door_must_not(svh_open(&options.own, &another, &told), SVH_USAGE, "svh_options: size is");
    LENGTHEN(&given);
    svh_volume *volume = taken(&given.own), *none;
    given.own.size = DOOR_1_0_svh_voxels - 1;
    door_must_not(svh_volume_take(host, &given.own, &none, &told), SVH_USAGE, "svh_voxels: size is");
    LENGTHEN(&about);
    door_must(svh_volume_about(volume, &about.own, &told));
    IS_AS_LONG(&about);
    assert_true(about.own.n[2] == SIDE && about.own.spacing[0] == 2.0 && about.own.beams[0]);
    about.own.size = DOOR_1_0_svh_about - 1;
    door_must_not(svh_volume_about(volume, &about.own, &told), SVH_USAGE, "svh_about: size is");
    LONGER(svh_file) file = {0};
    LENGTHEN(&file);
    door_must_not(svh_volume_read(host, "/none.mha", &file.own, &none, &told), SVH_INPUT, "/none.mha");
    file.own.size = DOOR_1_0_svh_file - 1;
    door_must_not(svh_volume_read(host, "/none.mha", &file.own, &none, &told), SVH_USAGE, "svh_file: size");
}

static void a_newer_program_clips(void **state) {
    (void)state;
    const svh_voxels given = given_voxels();
    svh_volume *volume = taken(&given);
    svh_clipper *clipper = clipper_of(NULL);
    LONGER(svh_view) view = {0};
    LONGER(svh_frame) frame = {0};
    LONGER(svh_result) result;
    LONGER(svh_mesh) mesh;
    svh_view plain = {.size = sizeof plain};
    uint64_t bytes = 0;
    LENGTHEN(&view);
    door_must(svh_plan(volume, &view.own, &told));
    IS_AS_LONG(&view);
    door_must(svh_plan(volume, &plain, &told));
    assert_memory_equal(&plain.from, &view.own.from, sizeof plain - offsetof(svh_view, from));
    door_must(svh_needs(clipper, volume, &view.own, &bytes, &told));
    LENGTHEN(&frame);
    LENGTHEN(&result);
    door_must(svh_set(clipper, "unsure=clip", &told));
    door_must(svh_clip(clipper, volume, &view.own, &frame.own, &result.own, &told));
    IS_AS_LONG(&result);
    assert_true(result.own.n[0] == plain.n[0] && result.own.depth && result.own.why);
    door_must(svh_adjust(clipper, NULL, NULL, 0, &result.own, &told));
    IS_AS_LONG(&result);
    LENGTHEN(&mesh);
    door_must(svh_surface(volume, &view.own, result.own.depth, &mesh.own, &told));
    IS_AS_LONG(&mesh);
    svh_mesh_free(&mesh.own);
    mesh.own.size = DOOR_1_0_svh_mesh - 1;
    door_must_not(svh_surface(volume, &view.own, result.own.depth, &mesh.own, &told), SVH_USAGE, "svh_mesh:");
    frame.own.size = DOOR_1_0_svh_frame - 1;
    door_must_not(svh_clip(clipper, volume, NULL, &frame.own, &result.own, &told), SVH_USAGE, "svh_frame:");
    result.own.size = DOOR_1_0_svh_result - 1;
    door_must_not(svh_clip(clipper, volume, NULL, NULL, &result.own, &told), SVH_USAGE, "svh_result:");
    door_must_not(svh_adjust(clipper, NULL, NULL, 0, &result.own, &told), SVH_USAGE, "svh_result:");
    view.own.size = DOOR_1_0_svh_view - 1;
    door_must_not(svh_plan(volume, &view.own, &told), SVH_USAGE, "svh_view: size is");
    door_must_not(svh_needs(clipper, volume, &view.own, &bytes, &told), SVH_USAGE, "svh_view: size is");
}

static void a_newer_program_asks(void **state) {
    (void)state;
    svh_clipper *clipper = clipper_of(NULL);
    LONGER(svh_plugin) about;
    LONGER(svh_param) param;
    LONGER(svh_error) why;
    LENGTHEN(&about);
    door_must(svh_clipper_about(clipper, &about.own, &told));
    IS_AS_LONG(&about);
    assert_string_equal(about.own.id, "org.smartvis.clip");
    about.own.size = DOOR_1_0_svh_plugin - 1;
    door_must_not(svh_clipper_about(clipper, &about.own, &told), SVH_USAGE, "svh_plugin: size is");
    LENGTHEN(&param);
    door_must(svh_param_at(clipper, 0, &param.own, &told));
    IS_AS_LONG(&param);
    assert_string_equal(param.own.key, "q");
    param.own.size = DOOR_1_0_svh_param - 1;
    door_must_not(svh_param_at(clipper, 0, &param.own, &told), SVH_USAGE, "svh_param: size is");
    LENGTHEN(&why);
    assert_int_equal(svh_set(clipper, "qq=1", &why.own), SVH_USAGE);
    IS_AS_LONG(&why);
    assert_true(why.own.code == SVH_USAGE && strstr(why.own.text, "no parameter 'qq'"));
    why.own.size = DOOR_1_0_svh_error - 1; /* there is nowhere to say it */
    why.own.text[0] = '\0';
    assert_int_equal(svh_set(clipper, "qq=1", &why.own), SVH_USAGE);
    assert_string_equal(why.own.text, "");
}

UNIT_MAIN(set_up, tear_down, fields_that_one_side_lacks, a_newer_program_opens_and_takes,
          a_newer_program_clips, a_newer_program_asks)
