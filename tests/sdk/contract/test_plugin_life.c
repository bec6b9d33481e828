/* SPDX-License-Identifier: MIT */
/*
 * Lives of instances beside what sv_validate tries (frames repeated, broken off and interleaved, many
 * activations, destroyed while active): formats one after the other; forked; kernels that do not build. That
 * there may be no device: test_devices.
 * Requirement: R5.
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

UNIT_MAIN_OF(NULL, NULL, FIXTURE_TEST(another_format_after_another), FIXTURE_TEST(a_fork_is_told),
             FIXTURE_TEST(kernels_that_do_not_build), FIXTURE_TEST(kernels_that_compute_wrongly))
