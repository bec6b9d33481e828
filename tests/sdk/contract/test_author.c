/* SPDX-License-Identifier: MIT */
/*
 * The header's demands on a plugin, kept by author.h: every misuse is refused with the header's code and a
 * reason that names field and value, by the example on the CPU and by the one with kernels.
 */
#include "programs/shared_programs.h"
#include "support/rig.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 9, HEIGHT = 7, SLICES = 10, SLAB = 4, SLABS = 3, RAYS = WIDTH * HEIGHT };

/* ---- fixtures */

typedef struct {
    rig r;
    const sv_plugin *p;
    stage *t;
    float depth[RAYS];
} subject;

static subject *open_subject(const char *library) {
    subject *s = calloc(1, sizeof *s);
    char path[1024];
    const char *build = getenv("SV_BUILD_DIR");
    assert_non_null(s);
    (void)snprintf(path, sizeof path, "%s/examples/%s.so", build ? build : ".", library);
    rig_open(&s->r, path);
    const rig_format f = {.width = WIDTH,
                          .height = HEIGHT,
                          .slices = SLICES,
                          .slab_slices = SLAB,
                          .tiles_x = 3,
                          .own_queue = true};
    uint8_t *volume = rig_volume(RIG_LAYERS, WIDTH, HEIGHT, SLICES, 9);
    s->t = rig_stage(&s->r, &f, volume);
    free(volume);
    s->p = s->r.plugin;
    return s;
}

static int close_subject(void **state) {
    subject *s = *state;
    rig_stage_free(s->t);
    rig_close(&s->r);
    free(s);
    return 0;
}

static int open_cpu(void **state) {
    *state = open_subject("first_edge");
    return 0;
}

static int open_kernels(void **state) {
    *state = open_subject("kernel_edge");
    return 0;
}

/* `status` is `expected`; last_error and the log hold `text`. */
static void refused(const subject *s, sv_status status, sv_status expected, const char *text) {
    if (status != expected || !strstr(s->p->last_error(s->p), text) || !strstr(s->r.last_log, text))
        fail_msg("status %d, expected %d; last_error '%s', log '%s', expected '%s'", status, expected,
                 s->p->last_error(s->p), s->r.last_log, text);
}

static sv_status begin(const subject *s) {
    const sv_frame frame = {.size = sizeof frame};
    return s->p->begin(s->p, &frame);
}

static sv_status slab(const subject *s, uint32_t n) {
    const sv_slab one = stage_slab(s->t, n);
    return s->p->slab(s->p, &one);
}

static sv_status end(subject *s) {
    const sv_result result = {.size = sizeof result, .depth = s->depth};
    return s->p->end(s->p, &result);
}

static void all_slabs(const subject *s) {
    assert_int_equal(begin(s), SV_OK);
    for (uint32_t n = 0; n < SLABS; n++) assert_int_equal(slab(s, n), SV_OK);
}

static void a_frame_works(subject *s) {
    all_slabs(s);
    assert_true(end(s) >= SV_OK);
}

static void activate(const subject *s) {
    assert_int_equal(s->p->activate(s->p, &s->t->format), SV_OK);
    assert_string_equal(s->p->last_error(s->p), "");
}

/* ---- states */

static void wrong_states(void **state) {
    subject *s = *state;
    const sv_result result = {.size = sizeof result, .depth = s->depth};
    refused(s, begin(s), SV_ERR_STATE, "begin: ");
    refused(s, slab(s, 0), SV_ERR_STATE, "slab: ");
    refused(s, end(s), SV_ERR_STATE, "end: ");
    refused(s, s->p->adjust(s->p, NULL, 0, &result), SV_ERR_STATE, "adjust: ");
    s->p->deactivate(s->p);
    refused(s, SV_ERR_STATE, SV_ERR_STATE, "deactivate: ");
    assert_int_equal(s->r.last_severity, SV_LOG_HOST_MISBEHAVING);
    activate(s);
    refused(s, s->p->activate(s->p, &s->t->format), SV_ERR_STATE, "activate: ");
    refused(s, slab(s, 0), SV_ERR_STATE, "slab: ");
    refused(s, s->p->adjust(s->p, NULL, 0, &result), SV_ERR_STATE, "adjust: ");
    assert_int_equal(begin(s), SV_OK);
    refused(s, s->p->adjust(s->p, NULL, 0, &result), SV_ERR_STATE, "adjust: ");
    refused(s, s->p->activate(s->p, &s->t->format), SV_ERR_STATE, "activate: ");
    assert_int_equal(slab(s, 0), SV_OK); /* the refused calls have changed nothing */
    refused(s, slab(s, 0), SV_ERR_SLAB_ORDER, "first_slice is 0, expected 4");
    refused(s, slab(s, 1), SV_ERR_STATE, "slab: "); /* an error ends the frame */
    assert_int_equal(begin(s), SV_OK);
    assert_int_equal(slab(s, 0), SV_OK);
    refused(s, end(s), SV_ERR_SLAB_MISSING, "4 of 10 slices came");
    refused(s, end(s), SV_ERR_STATE, "end: ");
    a_frame_works(s);
    refused(s, end(s), SV_ERR_STATE, "end: ");
    refused(s, slab(s, 0), SV_ERR_STATE, "slab: ");
    assert_true(s->p->adjust(s->p, NULL, 0, &result) >= SV_OK);
    assert_int_equal(begin(s), SV_OK); /* and a frame under way may be dropped */
    assert_int_equal(slab(s, 0), SV_OK);
    a_frame_works(s);
    s->p->deactivate(s->p);
    activate(s);
    a_frame_works(s);
    s->p->deactivate(s->p);
}

/* ---- structs */

static void short_structs(void **state) {
    subject *s = *state;
    sv_format format = s->t->format;
    sv_host host = s->r.host;
    const sv_plugin *out = s->p;
    const char *id = s->p->descriptor->id;
    host.size--;
    assert_int_equal(s->r.entry->create(&host, id, &out), SV_ERR_SIZE);
    assert_null(out);
    assert_int_equal(s->r.entry->create(&s->r.host, "nobody", &out), SV_ERR_UNKNOWN_ID);
    assert_int_equal(s->r.entry->create(NULL, id, &out), SV_ERR_ARGUMENT);
    format.size--;
    refused(s, s->p->activate(s->p, &format), SV_ERR_SIZE, "format.size is ");
    refused(s, s->p->activate(s->p, NULL), SV_ERR_ARGUMENT, "format is NULL");
    activate(s);
    const sv_frame frame = {.size = SV_FRAME_SIZE_1_0 - 1};
    refused(s, s->p->begin(s->p, &frame), SV_ERR_SIZE, "frame.size is ");
    refused(s, s->p->begin(s->p, NULL), SV_ERR_ARGUMENT, "frame is NULL");
    assert_int_equal(begin(s), SV_OK);
    sv_slab one = stage_slab(s->t, 0);
    one.size--;
    refused(s, s->p->slab(s->p, &one), SV_ERR_SIZE, "slab.size is ");
    assert_int_equal(begin(s), SV_OK);
    refused(s, s->p->slab(s->p, NULL), SV_ERR_ARGUMENT, "slab is NULL");
    sv_stats stats = {.size = sizeof stats - 1};
    sv_result result = {.size = sizeof result, .depth = s->depth, .stats = &stats};
    all_slabs(s);
    refused(s, s->p->end(s->p, &result), SV_ERR_SIZE, "stats.size is ");
    result.size--;
    all_slabs(s);
    refused(s, s->p->end(s->p, &result), SV_ERR_SIZE, "result.size is ");
    all_slabs(s);
    refused(s, s->p->end(s->p, NULL), SV_ERR_ARGUMENT, "result is NULL");
    sv_param_info info = {.size = sizeof info - 1};
    assert_int_equal(s->p->param_info(s->p, 0, &info), SV_ERR_SIZE);
    info.size = sizeof info;
    assert_int_equal(s->p->param_info(s->p, 99, &info), SV_ERR_ARGUMENT);
    assert_int_equal(s->p->param_info(s->p, 0, NULL), SV_ERR_ARGUMENT);
    a_frame_works(s);
    s->p->deactivate(s->p);
}

#define BAD_FORMAT(field, value, expected, text)                                                             \
    do {                                                                                                     \
        sv_format bad = s->t->format;                                                                        \
        bad.field = (value);                                                                                 \
        refused(s, s->p->activate(s->p, &bad), expected, text);                                              \
    } while (0)

static void bad_formats(void **state) {
    subject *s = *state;
    BAD_FORMAT(width, 0, SV_ERR_FORMAT, "width is 0");
    BAD_FORMAT(width, 8193, SV_ERR_FORMAT, "width is 8193");
    BAD_FORMAT(height, 0, SV_ERR_FORMAT, "height is 0");
    BAD_FORMAT(slices, 0, SV_ERR_FORMAT, "slices is 0");
    BAD_FORMAT(max_slab_slices, SLICES + 1, SV_ERR_FORMAT, "max_slab_slices is 11");
    BAD_FORMAT(tiles_x, 0, SV_ERR_FORMAT, "tiles_x is 0");
    BAD_FORMAT(tile_w, WIDTH - 1, SV_ERR_FORMAT, "tile_w is 8");
    BAD_FORMAT(tile_h, 16385, SV_ERR_FORMAT, "tile_h is 16385");
    BAD_FORMAT(row_pitch, 3 * WIDTH - 1, SV_ERR_FORMAT, "row_pitch is 26");
    BAD_FORMAT(voxel_type, SV_VOXEL_U16, SV_ERR_FORMAT, "voxel_type is 2");
    BAD_FORMAT(voxel_type, 7, SV_ERR_FORMAT, "voxel_type is 7");
    BAD_FORMAT(carrier, SV_CARRIER_IMAGE, SV_ERR_FORMAT, "carrier is 3");
    BAD_FORMAT(carrier, 4, SV_ERR_ARGUMENT, "carrier is 4");
    BAD_FORMAT(padding_value, 256, SV_ERR_FORMAT, "padding_value is 256");
    BAD_FORMAT(padding_value, -2, SV_ERR_FORMAT, "padding_value is -2");
    BAD_FORMAT(spacing_mm[1], 1.0f, SV_ERR_FORMAT, "spacing_mm is 0, 1, 0");
    BAD_FORMAT(spacing_mm[2], NAN, SV_ERR_FORMAT, "spacing_mm is ");
    BAD_FORMAT(flags, 2, SV_ERR_ARGUMENT, "flags is 0x2");
    BAD_FORMAT(host_memory_bytes, 9, SV_ERR_ARGUMENT, "host_memory_bytes is 9");
    BAD_FORMAT(queue, s->r.queue, SV_ERR_ARGUMENT, "1 of context, device and queue");
    activate(s);
    a_frame_works(s);
    s->p->deactivate(s->p);
}

static void bad_slabs(void **state) {
    subject *s = *state;
    activate(s);
    struct {
        uint32_t first, count;
        uint64_t bytes;
        sv_status expected;
        const char *text;
    } bad[] = {{1, 4, 999, SV_ERR_SLAB_ORDER, "first_slice is 1"},
               {0, 0, 999, SV_ERR_SLAB_SHAPE, "slice_count is 0"},
               {0, 5, 999, SV_ERR_SLAB_SHAPE, "slice_count is 5"},
               /* 4 slices, 3 to a row of 27 bytes: the second row of tiles begins at texture row 7 */
               {0, 4, (7 + 6) * 27 + 9 - 1, SV_ERR_SLAB_SHAPE, "bytes is 359, 4 slices need 360"},
               {0, 3, 6 * 27 + 26, SV_ERR_SLAB_SHAPE, "bytes is 188, 3 slices need 189"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sv_slab one = stage_slab(s->t, 0);
        one.first_slice = bad[i].first;
        one.slice_count = bad[i].count;
        one.bytes = bad[i].bytes;
        assert_int_equal(begin(s), SV_OK);
        refused(s, s->p->slab(s->p, &one), bad[i].expected, bad[i].text);
        one.bytes++;
        assert_int_equal(begin(s), SV_OK);
        if (i >= 3) assert_int_equal(s->p->slab(s->p, &one), SV_OK);
    }
    sv_slab none = stage_slab(s->t, 0);
    none.memory = NULL;
    assert_int_equal(begin(s), SV_OK);
    refused(s, s->p->slab(s->p, &none), SV_ERR_SLAB_SHAPE, "memory is NULL");
    a_frame_works(s);
    s->p->deactivate(s->p);
}

static void bad_frames_and_results(void **state) {
    subject *s = *state;
    float wide[HEIGHT][WIDTH + 2];
    sv_scanned ranges[RAYS] = {{0, SLICES}};
    activate(s);
    sv_frame frame = {.size = sizeof frame, .flags = 4};
    refused(s, s->p->begin(s->p, &frame), SV_ERR_ARGUMENT, "flags is 0x4");
    frame = (sv_frame){.size = sizeof frame, .scanned = ranges};
    refused(s, s->p->begin(s->p, &frame), SV_ERR_ARGUMENT,
            "1 of scanned and scanned_object given, expected 0");
    sv_result result = {.size = sizeof result};
    all_slabs(s);
    refused(s, s->p->end(s->p, &result), SV_ERR_ARGUMENT, "neither of depth and depth_object");
    result.depth = &wide[0][0];
    result.depth_pitch = WIDTH * 4 - 4;
    all_slabs(s);
    refused(s, s->p->end(s->p, &result), SV_ERR_ARGUMENT, "depth_pitch is 32");
    result.depth_pitch = WIDTH * 4 + 2;
    all_slabs(s);
    refused(s, s->p->end(s->p, &result), SV_ERR_ARGUMENT, "depth_pitch is 38");
    for (int i = 0; i < HEIGHT * (WIDTH + 2); i++) (&wide[0][0])[i] = -77.0f;
    result.depth_pitch = sizeof wide[0];
    a_frame_works(s);
    all_slabs(s);
    assert_true(s->p->end(s->p, &result) >= SV_OK);
    for (int y = 0; y < HEIGHT; y++) {
        assert_memory_equal(wide[y], s->depth + y * WIDTH, WIDTH * sizeof(float));
        assert_true(wide[y][WIDTH] == -77.0f && wide[y][WIDTH + 1] == -77.0f);
    }
    s->p->deactivate(s->p);
    s->t->format.flags = SV_FORMAT_SCANNED;
    activate(s);
    refused(s, begin(s), SV_ERR_ARGUMENT, "0 of scanned and scanned_object given, expected 1");
    s->p->deactivate(s->p);
}

static void bad_values(void **state) {
    subject *s = *state;
    const uint32_t q = rig_param(&s->r, "q");
    const struct {
        sv_param_value value;
        sv_status expected;
        const char *text;
    } bad[] = {{{0, 0, 0.5}, SV_ERR_PARAM_ID, "no parameter has id 0"},
               {{4711, 0, 0.5}, SV_ERR_PARAM_ID, "no parameter has id 4711"},
               {{q, 0, 1.0000001}, SV_ERR_PARAM_RANGE, "q is 1"},
               {{q, 0, -0.25}, SV_ERR_PARAM_RANGE, "q is -0.25, expected 0 to 1"},
               {{q, 0, NAN}, SV_ERR_PARAM_RANGE, "q is nan"},
               {{q, 0, INFINITY}, SV_ERR_PARAM_RANGE, "q is inf"}};
    char text[32];
    sv_format format = s->t->format;
    format.values = &bad[0].value;
    format.value_count = 1;
    refused(s, s->p->activate(s->p, &format), SV_ERR_PARAM_ID, "no parameter has id 0");
    const sv_param_value fine = {q, 0, 0.5};
    format.values = &fine;
    refused(s, s->p->activate(s->p, &format), SV_ERR_PARAM_ID, "q is not a parameter of this call");
    activate(s);
    const sv_result result = {.size = sizeof result, .depth = s->depth};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const sv_frame frame = {.size = sizeof frame, .values = &bad[i].value, .value_count = 1};
        refused(s, s->p->begin(s->p, &frame), bad[i].expected, bad[i].text);
        refused(s, slab(s, 0), SV_ERR_STATE, "slab: ");
        a_frame_works(s);
        refused(s, s->p->adjust(s->p, &bad[i].value, 1, &result), bad[i].expected, bad[i].text);
        assert_true(s->p->adjust(s->p, NULL, 0, &result) >= SV_OK);
        assert_int_equal(s->p->param_text(s->p, bad[i].value.id, bad[i].value.value, text, sizeof text),
                         bad[i].expected);
        assert_string_equal(text, "");
    }
    const sv_frame frame = {.size = sizeof frame, .value_count = 3};
    refused(s, s->p->begin(s->p, &frame), SV_ERR_ARGUMENT, "values is NULL, value_count is 3");
    assert_int_equal(s->p->param_text(s->p, q, 0.25, text, sizeof text), SV_OK);
    assert_string_equal(text, "0.25");
    assert_int_equal(s->p->param_text(s->p, q, 0.25, text, 3), SV_OK);
    assert_string_equal(text, "0.");
    assert_int_equal(s->p->param_text(s->p, q, 0.25, text, 0), SV_ERR_ARGUMENT);
    assert_null(s->p->get_extension(s->p, "smartvis.timing/1"));
    assert_null(s->p->get_extension(s->p, NULL));
    s->p->deactivate(s->p);
}

/* Objects that are no buffers, or end too early; only the host's queue has objects. */
static void bad_objects(void **state) {
    subject *s = *state;
    cl_int code = CL_SUCCESS;
    sv_format *f = &s->t->format;
    f->carrier = SV_CARRIER_BUFFER;
    refused(s, s->p->activate(s->p, f), SV_ERR_FORMAT, "carrier is 2");
    f->context = s->r.context;
    f->device = s->r.device;
    f->queue = s->r.queue;
    activate(s);
    cl_mem buffer = clCreateBuffer(s->r.context, CL_MEM_READ_WRITE, 1000, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
    sv_slab one = {.size = sizeof one, .slice_count = SLAB, .object = buffer, .offset = 640, .bytes = 361};
    assert_int_equal(begin(s), SV_OK);
    refused(s, s->p->slab(s->p, &one), SV_ERR_SLAB_SHAPE,
            "object has 1000 bytes, and 361 are needed from 640 on");
    one.object = rig_foreign_buffer(&s->r, 1000);
    assert_int_equal(begin(s), SV_OK);
    refused(s, s->p->slab(s->p, &one), SV_ERR_SLAB_SHAPE, "object is of another context");
    assert_int_equal(clReleaseMemObject(one.object), CL_SUCCESS);
    one.object = buffer;
    sv_result result = {.size = sizeof result, .depth_object = buffer, .depth_offset = 1000 - RAYS * 4 + 4};
    for (uint32_t n = 0; n < 2; n++) {
        one.bytes = 360;
        assert_int_equal(begin(s), SV_OK);
        for (one.first_slice = 0; one.first_slice < SLICES; one.first_slice += one.slice_count) {
            one.slice_count = SLICES - one.first_slice < SLAB ? SLICES - one.first_slice : SLAB;
            assert_int_equal(s->p->slab(s->p, &one), SV_OK);
        }
        if (n == 0)
            refused(s, s->p->end(s->p, &result), SV_ERR_ARGUMENT,
                    "depth_object has 1000 bytes, and 252 are needed from 752 on");
        else
            assert_int_equal(s->p->end(s->p, &result), SV_OK);
        result.depth_offset -= 4;
    }
    assert_int_equal(clFinish(s->r.queue), CL_SUCCESS);
    assert_int_equal(clReleaseMemObject(buffer), CL_SUCCESS);
    s->p->deactivate(s->p);
}

/* A build error names file and line of the kernel, in the reason and in the log, which gets a line at a time
 * (support/rig.c holds that). */
static void build_errors_name_lines(void **state) {
    subject *s = *state;
    shared_programs_options("-Dsorted=1"); /* no name for an array */
    const sv_status status = s->p->activate(s->p, &s->t->format);
    shared_programs_options(NULL);
    refused(s, status, SV_ERR_BUILD, rig_is_cpu(&s->r) ? "edge.cl:22:11" : "error");
    assert_true(s->r.log_lines > 2);
    activate(s);
    s->p->deactivate(s->p);
}

#define ON_BOTH(test)                                                                                        \
    cmocka_unit_test_setup_teardown(test, open_cpu, close_subject),                                          \
        cmocka_unit_test_setup_teardown(test, open_kernels, close_subject)

int main(void) {
    const struct CMUnitTest tests[] = {
        ON_BOTH(wrong_states),
        ON_BOTH(short_structs),
        ON_BOTH(bad_formats),
        ON_BOTH(bad_slabs),
        ON_BOTH(bad_frames_and_results),
        ON_BOTH(bad_values),
        cmocka_unit_test_setup_teardown(bad_objects, open_kernels, close_subject),
        cmocka_unit_test_setup_teardown(build_errors_name_lines, open_kernels, close_subject),
    };
    return cmocka_run_group_tests_name("author", tests, NULL, NULL);
}
