/* SPDX-License-Identifier: MIT */
/*
 * What author_cl.h says of a method that leaves a line of its table out, or names a kernel that its source
 * does not have; that a kernel may have large arrays of its own; and that texts have a decimal point where
 * the host's locale has a comma.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "smartvis/author_cl.h"
#include "support/rig.h"

#include <locale.h>

enum { WIDTH = 64, HEIGHT = 64, SLICES = 6, FIND = 0, PLACE, KERNELS };

static const char source[] =
    "kernel void find(SVA_SLAB, global uint *rays) { }\n"
    "kernel void deep(SVA_SLAB, global uint *rays) {\n"
    "    const size_t at = get_global_id(1) * WIDTH + get_global_id(0);\n"
    "    uint kept[4000];\n"
    "    for (uint i = 0; i < 4000; i++) kept[i] = rays[(at + i) % (WIDTH * HEIGHT)];\n"
    "    for (uint i = 1; i < 4000; i++) kept[kept[i - 1] % 4000] += i;\n"
    "    rays[at] = kept[at % 4000];\n"
    "}\n"
    "kernel void place(global uint *rays, global float *depth) {\n"
    "    depth[get_global_id(1) * WIDTH + get_global_id(0)] = 2.0f;\n"
    "}\n";
static const char *wanted; /* what the method calls its first kernel */
static uint32_t place_args;

static sv_status activate(sva *a) {
    const char *const kernels[KERNELS] = {wanted, "place"};
    return sva_cl_open(a, source, kernels, KERNELS);
}

static sv_status find(sva *a, const sv_slab *slab) {
    const sva_cl_arg args[] = {SVA_ARG(((sva_cl *)a->own)->rays)};
    return sva_cl_slab(a, slab, FIND, args, 1);
}

static sv_status place(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    const sva_cl *cl = a->own;
    const sva_cl_arg args[] = {SVA_ARG(cl->rays), SVA_ARG(cl->depth)};
    return sva_cl_launch(a, PLACE, args, place_args);
}

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR("test.kernels", "Kernels", "Test", "1", "Finds nothing.", 0);
static const sva_method whole = {.descriptor = &descriptor,
                                 .own_bytes = sizeof(sva_cl),
                                 .ray_bytes = 4,
                                 .activate = activate,
                                 .deactivate = sva_cl_close,
                                 .begin = sva_cl_begin,
                                 .slab = find,
                                 .finish = place,
                                 .output = sva_cl_output};

static void no_stage(void *data, const char *what, cl_int code) {
    fail_msg("%s: OpenCL error %d", what, (int)code);
}

/* The first error of an activation and a frame with this method, or "". */
static const char *run(const sva_method *method) {
    static const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "test", "1", NULL, NULL};
    static const uint8_t volume[WIDTH * HEIGHT * SLICES];
    static char reason[512];
    static stage st;
    const stage_way way = {.width = WIDTH,
                           .height = HEIGHT,
                           .slices = SLICES,
                           .longest = SLICES,
                           .tiles_x = 1,
                           .carrier = SV_CARRIER_HOST,
                           .own_queue = true,
                           .padding = SV_NO_PADDING};
    const sv_plugin *p = NULL;
    if (sva_create(method, &host, "test.kernels", &p) != SV_OK) return "create";
    stage_make(&st, &way, NULL, no_stage, NULL);
    stage_fill(&st, volume, NULL);
    stage_poison(&st, STAGE_POISON);
    const sv_result result = stage_result(&st);
    sv_status status = p->activate(p, &st.format);
    const int active = status == SV_OK;
    if (active) status = stage_run(&st, p, NULL, 0, &result);
    (void)snprintf(reason, sizeof reason, "%s", status < 0 ? p->last_error(p) : "");
    if (active) p->deactivate(p);
    p->destroy(p);
    stage_free(&st);
    return reason;
}

static void a_line_left_out_is_named(void **state) {
    wanted = "find";
    place_args = 2;
    assert_string_equal(run(&whole), "");
    sva_method m = whole;
    m.own_bytes = sizeof(sva_cl) - 1;
    assert_non_null(strstr(run(&m), "sva_method.own_bytes is "));
    m.own_bytes = 0;
    assert_non_null(strstr(run(&m), "sva_method.own_bytes is 0, expected at least sizeof(sva_cl)"));
    m = whole;
    m.ray_bytes = 0;
    assert_string_equal(run(&m), "a kernel takes sva_cl.rays, and sva_method.ray_bytes is 0");
    m = whole;
    m.begin = NULL;
    assert_string_equal(run(&m), "sva_cl_open: sva_method.begin is NULL, expected sva_cl_begin");
    m = whole;
    m.output = NULL;
    assert_string_equal(run(&m), "sva_cl_open: sva_method.output is NULL, expected sva_cl_output");
    m = whole;
    m.deactivate = NULL;
    assert_string_equal(run(&m), "sva_cl_open: sva_method.deactivate is NULL, expected sva_cl_close");
    static const sva_param params[1];
    m = whole;
    m.params = params;
    assert_string_equal(run(&m), "create"); /* without param_count */
    m.params = NULL;
    m.param_count = 1;
    assert_string_equal(run(&m), "create");
}

static void kernels_are_named(void **state) {
    wanted = "fnid";
    const char *said = run(&whole);
    assert_non_null(strstr(said, "kernel fnid: CL_INVALID_KERNEL_NAME (-46); the source has "));
    assert_non_null(strstr(said, "find") && strstr(said, "place") ? said : NULL);
    wanted = "find";
    place_args = 1;
    said = run(&whole);
    assert_non_null(strstr(said, "clEnqueueNDRangeKernel of kernel place: CL_INVALID_KERNEL_ARGS (-52)"));
}

/* 16 KB a ray, 64 MB for all of them: more than a thread's stack. */
static void a_kernel_has_large_arrays(void **state) {
    wanted = "deep";
    place_args = 2;
    assert_string_equal(run(&whole), "");
}

/* Takes a locale with a comma, which is made where the system has the sources of its own. */
static int take_comma(char *folder) {
    char command[200];
    if (!mkdtemp(folder)) return 0;
    (void)snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/comma > %s/said 2>&1", folder,
                   folder);
    if (system(command) == -1 || setenv("LOCPATH", folder, 1) != 0) return 0; /* NOLINT(cert-env33-c) */
    return setlocale(LC_ALL, "comma") && strcmp(localeconv()->decimal_point, ",") == 0;
}

/* The device that smartvis/device.h finds, or its words. */
static void a_device_that_is_not_there_is_told(void **state) {
    wanted = "find";
    place_args = 2;
    assert_int_equal(setenv("SMARTVIS_DEVICE", "abacus", 1), 0);
    assert_string_equal(run(&whole), "activate: SMARTVIS_DEVICE is 'abacus', expected 'cpu' or 'gpu'");
    assert_int_equal(setenv("SMARTVIS_DEVICE", "", 1), 0);
    assert_string_equal(run(&whole), "");
    assert_int_equal(unsetenv("SMARTVIS_DEVICE"), 0);
}

static void a_comma_stays_outside(void **state) {
    rig *r = *state;
    char folder[] = "/tmp/sv_locale_XXXXXX", text[32], command[64];
    const int taken = take_comma(folder);
    const uint32_t q = rig_param(r, "q");
    const sv_param_value far = {q, 0, 7.25};
    const rig_format f = {
        .width = 24, .height = 16, .slices = 16, .slab_slices = 8, .padding = SV_NO_PADDING};
    uint8_t *volume = rig_volume(RIG_LAYERS, 24, 16, 16, 9);
    stage *t = rig_stage(r, &f, volume);
    const sv_plugin *p = r->plugin;
    assert_int_equal(p->activate(p, &t->format), SV_OK);
    const char *const seconds =
        strstr(r->last_log, "activate: "); /* "activate: 1.26 s; of it 0.31 s for ..." */
    assert_non_null(seconds);
    assert_int_equal(seconds[strcspn(seconds, ".,")], '.');
    assert_int_equal(p->param_text(p, q, 0.25, text, sizeof text), SV_OK);
    assert_string_equal(text, "0.25");
    const sv_frame frame = {.size = sizeof frame, .values = &far, .value_count = 1};
    assert_int_equal(p->begin(p, &frame), SV_ERR_PARAM_RANGE);
    assert_string_equal(p->last_error(p), "begin: q is 7.25, expected 0 to 1.5");
    p->deactivate(p);
    (void)setlocale(LC_ALL, "C");
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(system(command), 0); /* NOLINT(cert-env33-c) */
    if (!taken) skip();
}

UNIT_MAIN_OF(NULL, NULL, cmocka_unit_test(a_line_left_out_is_named), cmocka_unit_test(kernels_are_named),
             cmocka_unit_test(a_kernel_has_large_arrays),
             cmocka_unit_test(a_device_that_is_not_there_is_told), RIG_TEST(a_comma_stays_outside))
