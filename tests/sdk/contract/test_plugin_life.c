/* SPDX-License-Identifier: MIT */
/*
 * Lives of instances beside what sv_validate tries (frames repeated, broken off and interleaved, many
 * activations, destroyed while active): formats one after the other; without a device; forked; kernels that
 * do not build.
 */
#include "programs/shared_programs.h"
#include "support/fixture.h"

#include <sys/wait.h>
#include <unistd.h>

/* Formats one after the other in one instance: nothing of the larger one is left in the smaller one's
 * maps. */
static void another_format_after_another(void **state) {
    fixture *f = *state;
    static const rig_format ways[] = {{.tiles_x = 1},
                                      {.carrier = SV_CARRIER_IMAGE},
                                      {.own_queue = true},
                                      {.carrier = SV_CARRIER_BUFFER, .extra_h = 2},
                                      {.in_place = true}};
    for (size_t n = 0; n < sizeof ways / sizeof *ways; n++) {
        uint8_t *volume = rig_volume(RIG_LAYERS, 90, 50, 12, 3);
        const rig_format large = {.width = 90, .height = 50, .slices = 12, .padding = 0};
        rig_result out = rig_result_make(90, 50);
        assert_true(rig_run(&f->r, &large, volume, NULL, 0, &out) >= 0);
        fixture_use(f, ways[n]);
        fixture_frame_is_good(f);
        f->r.plugin->deactivate(f->r.plugin);
    }
}

/* ---- no device, no kernels ---- */

static const char *self; /* this program's path */

/* Own-queue activation in a child in which no OpenCL driver is installed. Exit code 0: refused as it
 * should be. */
static int child_without_device(void) {
    rig r;
    rig_open_library(&r, NULL);
    const sv_plugin *p = r.plugin; /* create makes no OpenCL call: it works */
    sv_param_info info = {.size = sizeof info};
    if (p->param_count(p) == 0 || p->param_info(p, 0, &info) != SV_OK) return 3;
    const rig_format how = {
        .width = 8, .height = 8, .slices = 4, .padding = SV_NO_PADDING, .own_queue = true};
    uint8_t volume[8 * 8 * 4] = {0};
    stage *t = rig_stage(&r, &how, volume);
    int code = 0;
    for (int n = 0; n < 2 && code == 0; n++) {
        if (p->activate(p, &t->format) != SV_ERR_NO_DEVICE) code = 4;
        const char *reason = p->last_error(p);
        if (!strstr(reason, "no OpenCL device") || !strstr(reason, "Install a driver")) code = 5;
        if (!strstr(reason, "OCL_ICD_VENDORS, where drivers are looked for, is '/tmp/sv_no_driver_"))
            code = 8;
        if (strcmp(reason, r.last_log) != 0) code = 6;
        if (r.last_severity != SV_LOG_ERROR) code = 7;
    }
    if (code) (void)fprintf(stderr, "%s\n", p->last_error(p));
    rig_close_library(&r);
    return code;
}

/* Runs `call` of this program anew with an environment variable set, and returns its exit code. */
static int run_child(const char *call, const char *variable, const char *value) {
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (setenv(variable, value, 1) == 0) (void)execl(self, self, call, (char *)NULL);
        _exit(99);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void no_device(void **state) {
    char folder[] = "/tmp/sv_no_driver_XXXXXX";
    assert_non_null(mkdtemp(folder));
    const int code = run_child("child_without_device", "OCL_ICD_VENDORS", folder);
    assert_int_equal(rmdir(folder), 0);
    assert_int_equal(code, 0);
}

/* A fork's child has none of the driver's threads: every call says so, and none hangs. */
static int forked(fixture *f) {
    const sv_plugin *p = f->r.plugin;
    const sv_ext_confidence *confidence = p->get_extension(p, SV_EXT_CONFIDENCE);
    const sv_result result = fixture_result(f);
    float map[FIXTURE_RAYS];
    (void)alarm(30);
    if (confidence->write(p, map, NULL, 0) != SV_ERR_STATE) return 1;
    if (p->adjust(p, NULL, 0, &result) != SV_ERR_STATE || !strstr(p->last_error(p), "forked")) return 2;
    if (fixture_begin(f) != SV_ERR_STATE || !strstr(p->last_error(p), "spawn")) return 3;
    p->deactivate(p);
    p->destroy(p);
    return 0;
}

static void a_fork_is_told(void **state) {
    fixture *f = *state;
    for (int own = 0; own < 2; own++) {
        fixture_use(f, (rig_format){.own_queue = own});
        fixture_frame_is_good(f);
        const pid_t child = fork();
        if (child == 0) _exit(forked(f));
        int status = 0;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_int_equal(status, 0);
        fixture_frame_is_good(f);
        f->r.plugin->deactivate(f->r.plugin);
    }
}

static void no_such_device(void **state) {
    fixture *f = *state;
    fixture_change(f, (rig_format){.own_queue = true});
    assert_int_equal(setenv("SMARTVIS_DEVICE", "abacus", 1), 0);
    fixture_refused(f, fixture_activate(f), SV_ERR_NO_DEVICE,
                    "SMARTVIS_DEVICE is 'abacus', expected 'cpu' or 'gpu'");
    assert_int_equal(unsetenv("SMARTVIS_DEVICE"), 0);
    fixture_works(f);
}

/* activate while the kernels are compiled with one more option. */
static sv_status activate_with(fixture *f, const char *option) {
    shared_programs_options(option);
    const sv_status status = fixture_activate(f);
    shared_programs_options(NULL);
    return status;
}

/* Kernels that do not build: the log reaches the host, the instance stays inactive, and can be activated
 * later. */
static void kernels_that_do_not_build(void **state) {
    fixture *f = *state;
    fixture_refused(f, activate_with(f, "-D__kernel=banana"), SV_ERR_BUILD,
                    "the kernels do not build: CL_BUILD_PROGRAM_FAILURE (-11)");
    assert_int_equal(f->r.last_severity, SV_LOG_ERROR);
    /* The build log names file and line; on a GPU it may be NVIDIA's, which calls every file <kernel>. */
    const bool named = strstr(f->r.all_logs, "cl/profile/profile_rays.cl:") != NULL;
    if (!named && (rig_is_cpu(&f->r) || !strstr(f->r.all_logs, "<kernel>:")))
        fail_msg("the build log is '%s'", f->r.all_logs);
    assert_non_null(strstr(f->r.all_logs, "banana"));
    assert_int_equal(fixture_begin(f), SV_ERR_STATE);
    fixture_works(f);
}

/* A compiler that gets it wrong (here: kernels built for another structure): the
 * self-test must not let it pass. */
static void kernels_that_compute_wrongly(void **state) {
    static const char *const wrong[] = {"-DSV_PADDED=1", "-DSV_SUBSTEPS=2"};
    fixture *f = *state;
    for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        fixture_refused(f, activate_with(f, wrong[n]), SV_ERR_SELF_TEST, "self-test: ");
        assert_int_equal(fixture_begin(f), SV_ERR_STATE);
        fixture_works(f);
        f->r.plugin->deactivate(f->r.plugin);
    }
}

int main(int argc, char **argv) {
    self = argv[0];
    if (argc > 1 && strcmp(argv[1], "child_without_device") == 0) return child_without_device();
    const struct CMUnitTest tests[] = {
        FIXTURE_TEST(another_format_after_another),
        cmocka_unit_test(no_device),
        FIXTURE_TEST(no_such_device),
        FIXTURE_TEST(a_fork_is_told),
        FIXTURE_TEST(kernels_that_do_not_build),
        FIXTURE_TEST(kernels_that_compute_wrongly),
    };
    return cmocka_run_group_tests_name("life of instances", tests, NULL, NULL);
}
