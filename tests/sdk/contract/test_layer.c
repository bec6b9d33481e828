/* SPDX-License-Identifier: MIT */
/*
 * The checking layer beside its rules: SMARTVIS_CHECK and its file do what docs/check.md says, and that page
 * has the layer's rules. That it has nothing to say to plugins that are right: test_layer_careless.
 */
#include "record/rec_item.h"
#include "rules/rules.h"
#include "support/layer_fixture.h"
#include "support/unit.h"

#include <dlfcn.h>
#include <inttypes.h>
#include <pthread.h>
#include <unistd.h>

#define CPU "wrong/right/results"
#define CL  "wrong/right/opencl"

/* ---- settings */
static void stop_makes_errors(void **state) {
    (void)setenv("SMARTVIS_CHECK", "stop", 1);
    layer_subject *s = layer_open(CPU);
    layer_create(s);
    layer_start(s, 1);
    assert_int_equal(layer_slab(s, 2), SV_ERR_SLAB_ORDER);
    assert_string_equal(s->p->last_error(s->p), "host-slabs: slab: first_slice is 16, expected 8");
    assert_null(strstr(s->log, "4 slab:")); /* the plugin was not asked */
    assert_int_equal(layer_frame(s), SV_OK);
    assert_string_equal(s->p->last_error(s->p), "");
    s->p->deactivate(s->p);
    layer_close(s);
    s = layer_open("wrong/depth_nan");
    layer_create(s);
    assert_int_equal(layer_activate(s), SV_OK);
    assert_int_equal(layer_frame(s), SV_ERR_INTERNAL);
    assert_non_null(strstr(s->p->last_error(s->p), "depth-values: end: frame 7: the depth of ray"));
    for (int i = 0; i < RAYS; i++) assert_true(s->depth[i] == s->depth[i]); /* NaN does not get through */
    s->p->deactivate(s->p);
    layer_close(s);
    s = layer_open("wrong/default_out_of_range");
    layer_create(s);
    assert_int_equal(s->created, SV_ERR_INTERNAL);
    layer_close(s);
    (void)unsetenv("SMARTVIS_CHECK");
}

/* The layer makes a map NaN before the plugin writes it. */
static void a_failed_call_leaves_no_nan(void **state) {
    for (int queue = 0; queue < 2; queue++) {
        layer_subject *s = layer_open(queue ? "wrong/end_minus_78" : "wrong/end_minus_77");
        if (queue) layer_take_queue(s);
        layer_create(s);
        layer_start(s, SLABS);
        for (int i = 0; i < RAYS; i++) s->depth[i] = 5.0f;
        assert_int_equal(layer_end(s), queue ? -78 : -77);
        if (queue)
            (void)clEnqueueReadBuffer(s->cl.queue, s->map, CL_TRUE, 0, sizeof s->depth, s->depth, 0, NULL,
                                      NULL);
        for (int i = 0; i < RAYS; i++) assert_true(s->depth[i] == 0.0f);
        s->p->deactivate(s->p);
        layer_close(s);
    }
}

static void off_is_the_plugin_itself(void **state) {
    Dl_info where;
    (void)setenv("SMARTVIS_CHECK", "off", 1);
    layer_subject *s = layer_open(CPU);
    layer_create(s);
    assert_int_not_equal(dladdr(*(void *const *)&s->p->slab, &where), 0);
    assert_non_null(strstr(where.dli_fname, CPU));
    (void)layer_activate(s);
    (void)layer_slab(s, 0);
    assert_null(strstr(s->log, "check:"));
    s->p->deactivate(s->p);
    layer_close(s);
    (void)unsetenv("SMARTVIS_CHECK");
}

static void repeated_breaches_are_told_less_and_less(void **state) {
    unsigned lines = 0;
    layer_subject *s = layer_open(CPU);
    layer_create(s);
    (void)layer_activate(s);
    for (int n = 0; n < 1000; n++) (void)layer_slab(s, 0);
    for (const char *at = s->log; (at = strstr(at, "check: host-states: slab")); at++) lines++;
    assert_int_equal(lines, 6); /* 1, 2, 3, 10, 100, 1000 */
    s->p->deactivate(s->p);
    layer_close(s);
}

__attribute__((format(printf, 1, 2))) static void shell(const char *format, ...) {
    char command[4096];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(command, sizeof command, format, args);
    va_end(args);
    assert_int_equal(system(command), 0); /* NOLINT(cert-env33-c) */
}

static void a_file_beside_it_has_the_settings(void **state) {
    char folder[] = "/tmp/layer_XXXXXX", recording[64];
    assert_non_null(mkdtemp(folder));
    shell("cp %s/smartvis_check.so %s && cp %s/" CPU ".so %s/inner.so && printf "
          "'# a comment\\nSMARTVIS_CHECK=stop\\nSMARTVIS_CHECK_PLUGIN=inner.so\\nSMARTVIS_RECORD=own.svr\\n' "
          "> %s/smartvis_check.conf",
          layer_build(), folder, layer_build(), folder, folder);
    (void)unsetenv("SMARTVIS_CHECK_PLUGIN");
    layer_subject *s = layer_load(folder);
    layer_create(s);
    assert_int_equal(s->created, SV_OK);
    assert_int_equal(layer_slab(s, 0), SV_ERR_STATE);
    layer_close(s);
    (void)snprintf(recording, sizeof recording, "%s/own.svr", folder);
    assert_int_equal(access(recording, R_OK), 0);
    shell("echo SMARTVIS_CHEK=stop >> %s/smartvis_check.conf", folder);
    s = layer_load(folder);
    layer_create(s);
    assert_int_equal(s->created, SV_ERR_INTERNAL);
    assert_non_null(strstr(s->log, "smartvis_check.conf: 'SMARTVIS_CHEK=stop' is no setting"));
    layer_close(s);
    shell("rm -r %s", folder);
}

/* lib/smartvis/check/smartvis_check.so and lib/smartvis/smartvis.so. */
static void an_installation_needs_no_setting(void **state) {
    char folder[] = "/tmp/layer_XXXXXX", check[64];
    assert_non_null(mkdtemp(folder));
    (void)snprintf(check, sizeof check, "%s/check", folder);
    shell("mkdir %s && cp %s/smartvis_check.so %s && cp %s/" CPU ".so %s/smartvis.so", check, layer_build(),
          check, layer_build(), folder);
    (void)unsetenv("SMARTVIS_CHECK_PLUGIN");
    layer_subject *s = layer_load(check);
    layer_create(s);
    assert_int_equal(s->created, SV_OK);
    layer_close(s);
    shell("rm -r %s", folder);
}

static void what_cannot_be_used_is_told(void **state) {
    static const struct {
        const char *plugin, *check, *text;
    } wrong[] = {{"no_such", "on", "no_such.so: cannot open"},
                 {"smartvis_check", "on", "is the layer itself"},
                 {"wrong/no_symbol", "on", "no symbol smartvis_plugin_entry"},
                 {CPU, "maybe", "SMARTVIS_CHECK is 'maybe', expected off, on or stop"}};
    for (size_t n = 0; n < sizeof wrong / sizeof *wrong; n++) {
        (void)setenv("SMARTVIS_CHECK", wrong[n].check, 1);
        layer_subject *s = layer_open(wrong[n].plugin);
        layer_create(s);
        assert_int_equal(s->created, SV_ERR_INTERNAL);
        assert_null(s->p);
        if (!strstr(s->log, wrong[n].text)) fail_msg("expected '%s' in %s", wrong[n].text, s->log);
        layer_close(s);
    }
    (void)unsetenv("SMARTVIS_CHECK");
}

/* ---- ends */
static void *open_gate(void *gate) {
    (void)usleep(50000);
    (void)clSetUserEventStatus(gate, CL_COMPLETE);
    return NULL;
}

/* A host that forgets deactivate while the queue has not run: what the layer enqueued finds its memory. */
static void destroy_waits_for_what_is_under_way(void **state) {
    pthread_t thread;
    layer_subject *s = layer_open(CL);
    layer_take_queue(s);
    layer_create(s);
    cl_event gate = clCreateUserEvent(s->cl.context, NULL);
    assert_int_equal(layer_activate(s), SV_OK);
    assert_int_equal(clEnqueueBarrierWithWaitList(s->cl.queue, 1, &gate, NULL), CL_SUCCESS);
    assert_int_equal(layer_begin(s), SV_OK);
    for (uint32_t n = 0; n < SLABS; n++) assert_int_equal(layer_slab(s, n), SV_OK);
    const sv_result result = layer_result_of(s);
    assert_int_equal(s->p->end(s->p, &result), SV_OK);
    assert_int_equal(pthread_create(&thread, NULL, open_gate, gate), 0);
    s->p->destroy(s->p);
    s->p = NULL;
    cl_int status = CL_QUEUED;
    (void)clGetEventInfo(gate, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, NULL);
    assert_int_equal(status, CL_COMPLETE);
    assert_int_equal(pthread_join(thread, NULL), 0);
    (void)clReleaseEvent(gate);
    layer_close(s);
}

/* ---- recordings */
/* Calls of a kind that returned SV_OK, in a recording that is whole. Every call has its time. */
static uint32_t recorded(const char *path, rc_kind kind) {
    static rec_item item;
    char error[300];
    uint32_t calls = 0;
    uint64_t last = 1;
    int more;
    rec_reader *r = rec_reader_open(path, error, sizeof error);
    if (!r) fail_msg("%s", error);
    while ((more = rec_reader_next(r, &item, error, sizeof error)) == 1) {
        calls += item.type == REC_RETURN && item.kind == kind && item.returned == SV_OK;
        if (item.type != REC_CALL) continue;
        if (item.ns < last) fail_msg("%u starts at %" PRIu64 ", behind %" PRIu64, item.kind, item.ns, last);
        last = item.ns;
    }
    rec_reader_close(r);
    if (more < 0) fail_msg("%s", error);
    return calls;
}

/* Makes a file, and the next layer records there. */
static void record_to_file(char *name) {
    const int file = mkstemp(name);
    assert_true(file >= 0);
    (void)close(file);
    (void)setenv("SMARTVIS_RECORD", name, 1);
}

static void what_passes_is_recorded(void **state) {
    static const char *const modes[] = {"on", "off"};
    char path[] = "/tmp/layer_XXXXXX";
    record_to_file(path);
    for (int n = 0; n < 4; n++) {
        (void)setenv("SMARTVIS_CHECK", modes[n % 2], 1);
        layer_subject *s = layer_open(n < 2 ? CPU : CL);
        if (n >= 2) layer_take_queue(s);
        layer_create(s);
        layer_use(s);
        assert_int_equal(strstr(s->log, "check:") == NULL, n % 2);
        layer_close(s);
        assert_int_equal(recorded(path, RC_END), 3);
    }
    (void)unlink(path);
    (void)setenv("SMARTVIS_RECORD", "/no/such/folder/file", 1);
    layer_subject *s = layer_open(CPU);
    layer_create(s);
    layer_use(s);
    assert_non_null(strstr(s->log, "/no/such/folder/file"));
    layer_close(s);
    (void)unsetenv("SMARTVIS_RECORD");
    (void)unsetenv("SMARTVIS_CHECK");
}

/* What the layer refuses of activate's return, it gives back: the plugin is inactive, as the host has it. */
static void an_activation_that_is_stopped_is_undone(void **state) {
    char path[] = "/tmp/layer_XXXXXX";
    record_to_file(path);
    (void)setenv("SMARTVIS_CHECK", "stop", 1);
    layer_subject *s = layer_open("wrong/activate_partial");
    layer_create(s);
    for (int n = 0; n < 2; n++) {
        assert_int_equal(layer_activate(s), SV_ERR_INTERNAL);
        assert_non_null(strstr(s->p->last_error(s->p), "frame-outcome: activate: returns SV_PARTIAL"));
    }
    assert_int_equal(layer_begin(s), SV_ERR_STATE);
    layer_close(s);
    assert_int_equal(recorded(path, RC_DEACTIVATE), 2);
    (void)unlink(path);
    (void)unsetenv("SMARTVIS_RECORD");
    (void)unsetenv("SMARTVIS_CHECK");
}

/* ---- the page */
static void the_page_has_the_rules(void **state) {
    static char page[1 << 16];
    char path[1024], row[512];
    (void)snprintf(path, sizeof path, "%s/docs/check.md", getenv("SV_SOURCE_DIR"));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    (void)fclose(file);
    for (int n = 0; n < RULE_COUNT; n++) {
        /* What a plugin's rule says stands on the validator's page. */
        if (rule_is_hosts((rule_name)n))
            (void)snprintf(row, sizeof row, "\n| `%s` | %s |", rules[n].id, rules[n].what);
        else
            (void)snprintf(row, sizeof row, "`%s`", rules[n].id);
        if (rules[n].seen != (strstr(page, row) != NULL))
            fail_msg("docs/check.md: %s: %s", rules[n].seen ? "not there" : "there", row);
    }
}

UNIT_MAIN(NULL, NULL, stop_makes_errors, off_is_the_plugin_itself, repeated_breaches_are_told_less_and_less,
          a_failed_call_leaves_no_nan, a_file_beside_it_has_the_settings, an_installation_needs_no_setting,
          what_cannot_be_used_is_told, destroy_waits_for_what_is_under_way, what_passes_is_recorded,
          an_activation_that_is_stopped_is_undone, the_page_has_the_rules)
