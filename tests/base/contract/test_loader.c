/* SPDX-License-Identifier: MIT */
/* The plugin loader: what it accepts, and what it says about everything else. */
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"
#include "support/unit.h"

#include <unistd.h>

/* "<build>/tests/plugins/<name>" */
static const char *plugin_path(const char *name) {
    static char path[1024];
    const char *build = getenv("SV_BUILD_DIR");
    if (!build) fail_msg("SV_BUILD_DIR is not set: run this with ctest");
    (void)snprintf(path, sizeof path, "%s/tests/plugins/%s", build, name);
    return path;
}

/* Opens what must fail, and checks code and words of the message. */
static void expect_failure(const char *path, const char *id, const char *const *words) {
    hs_plugin plugin;
    hs_error err = {0};
    assert_false(hs_plugin_open(&plugin, path, id, SV_LOG_ERROR, &err));
    assert_int_equal(err.code, HS_ERR_PLUGIN);
    assert_null(plugin.library);
    assert_null(plugin.instance);
    for (; *words; words++)
        if (!strstr(err.text, *words)) fail_msg("'%s' does not say '%s'", err.text, *words);
}

static void loads_a_good_plugin_again_and_again(void **state) {
    for (int i = 0; i < 20; i++) {
        hs_plugin plugin;
        must(hs_plugin_open(&plugin, plugin_path("plane.so"), NULL, SV_LOG_ERROR, &err));
        assert_string_equal(plugin.instance->descriptor->id, "org.smartvis.test.plane");
        assert_int_equal(plugin.abi_major, SV_ABI_MAJOR);
        assert_ptr_equal(plugin.host.host_data, &plugin);
        hs_plugin_close(&plugin);
    }
}

static void a_given_id_is_found_or_answered_with_those_there_are(void **state) {
    hs_plugin plugin;
    must(hs_plugin_open(&plugin, plugin_path("plane.so"), "org.smartvis.test.plane", SV_LOG_ERROR, &err));
    hs_plugin_close(&plugin);
    expect_failure(plugin_path("plane.so"), "org.smartvis.test.plan",
                   (const char *const[]){"plane.so", "org.smartvis.test.plan'",
                                         "there are: org.smartvis.test.plane)", NULL});
}

static void files_that_are_no_plugin_are_named(void **state) {
    expect_failure("/no/such/folder/x.so", NULL,
                   (const char *const[]){"/no/such/folder/x.so", "No such file", NULL});
    expect_failure("/tmp", NULL,
                   (const char *const[]){"/tmp: cannot read the plugin file: not a file", NULL});
    expect_failure("", NULL, (const char *const[]){"No such file", NULL});
    expect_failure(plugin_path("no_symbol.so"), NULL,
                   (const char *const[]){"no_symbol.so", SV_ENTRY_SYMBOL, NULL});
}

static void a_text_file_is_not_loadable(void **state) {
    char path[] = "/tmp/test_loader_XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, "not a library\n", 14), 14);
    close(file);
    expect_failure(path, NULL, (const char *const[]){path, "not a library of plugins", NULL});
    unlink(path);
}

static void entries_that_break_the_abi_are_refused(void **state) {
    expect_failure(plugin_path("other_major.so"), NULL,
                   (const char *const[]){"other_major.so", "ABI major 2", "this host speaks 1", NULL});
    expect_failure(plugin_path("older_major.so"), NULL,
                   (const char *const[]){"older_major.so", "ABI major 0", "this host speaks 1", NULL});
    expect_failure(plugin_path("short_entry.so"), NULL,
                   (const char *const[]){"short_entry.so", "entry.size is 16", NULL});
    expect_failure(plugin_path("create_fails.so"), NULL,
                   (const char *const[]){"create_fails.so", "create", "SV_ERR_NO_MEMORY (-40)", NULL});
    expect_failure(plugin_path("no_slab.so"), NULL,
                   (const char *const[]){"no_slab.so", "instance.slab is NULL", NULL});
}

/* ------------------------------------------------------------------------------------- parameters -- */

static int open_plane(void **state) {
    static hs_plugin plugin;
    hs_error err = {0};
    *state = &plugin;
    return hs_plugin_open(&plugin, plugin_path("plane.so"), NULL, SV_LOG_ERROR, &err) ? 0 : -1;
}

static int close_plane(void **state) {
    hs_plugin_close(*state);
    return 0;
}

static void parameters_are_found_by_key(void **state) {
    const hs_plugin *plugin = *state;
    sv_param_info info;
    assert_true(hs_plugin_find_param(plugin, "depth", &info));
    assert_string_equal(info.unit, "slices");
    assert_true(info.flags & SV_PARAM_PRIMARY);
    assert_false(hs_plugin_find_param(plugin, "depthx", &info));
    assert_false(hs_plugin_find_param(plugin, "", &info));
}

static void values_of_every_type_are_read(void **state) {
    const hs_plugin *plugin = *state;
    static const struct {
        const char *text;
        uint32_t id;
        double value;
    } good[] = {{"depth=-2.5", 1, -2.5}, {"depth=1e4", 1, 1e4}, {"shape=flat", 2, 0}, {"shape=tilted", 2, 1},
                {"fail=end", 3, 4},      {"every=63", 4, 63},   {"every=1", 4, 1},    {"note=true", 5, 1},
                {"note=false", 5, 0},    {"note=1", 5, 1}};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        sv_param_value value;
        hs_error err = {0};
        if (!hs_plugin_parse_param(plugin, good[i].text, &value, &err))
            fail_msg("%s: %s", good[i].text, err.text);
        assert_int_equal(value.id, good[i].id);
        assert_int_equal(value.reserved, 0);
        assert_true(value.value == good[i].value);
    }
}

/* In one place, for command lines and for hosts that know a value's name only. */
static void enum_values_are_found_by_their_name(void **state) {
    const hs_plugin *plugin = *state;
    static const char *const calls[] = {"none", "activate", "begin", "slab", "end"};
    sv_param_info info;
    char name[HS_ENUM_NAME];
    double value;
    assert_true(hs_plugin_find_param(plugin, "fail", &info));
    assert_int_equal(hs_plugin_enum_count(&info), 5);
    for (uint32_t i = 0; i < 5; i++) {
        assert_true(hs_plugin_enum_at(plugin, &info, i, &value, name, sizeof name));
        assert_true(value == i);
        assert_string_equal(name, calls[i]);
        value = -1;
        assert_true(hs_plugin_find_enum(plugin, &info, calls[i], &value) && value == i);
    }
    assert_false(hs_plugin_enum_at(plugin, &info, 5, &value, name, sizeof name));
    assert_false(hs_plugin_find_enum(plugin, &info, "begi", &value));
    assert_false(hs_plugin_find_enum(plugin, &info, "", &value));
    assert_true(hs_plugin_find_param(plugin, "every", &info)); /* no enum: has no names */
    assert_int_equal(hs_plugin_enum_count(&info), 0);
    assert_false(hs_plugin_find_enum(plugin, &info, "1", &value));
}

/* Values that an enum leaves out between others have no name, and are not offered. */
static void an_enum_may_leave_values_out(void **state) {
    char path[1024], name[HS_ENUM_NAME];
    const char *build = getenv("SV_BUILD_DIR");
    hs_plugin plugin;
    sv_param_info info;
    sv_param_value retired;
    double value;
    (void)snprintf(path, sizeof path, "%s/smartvis.so", build ? build : ".");
    must(hs_plugin_open(&plugin, path, NULL, SV_LOG_ERROR, &err));
    assert_true(hs_plugin_find_param(&plugin, "method", &info));
    assert_false(hs_plugin_enum_at(&plugin, &info, 4, &value, name, sizeof name));
    assert_true(hs_plugin_enum_at(&plugin, &info, 7, &value, name, sizeof name) && value == 7.0);
    assert_string_equal(name, "wall");
    assert_true(hs_plugin_find_enum(&plugin, &info, "wall", &value) && value == 7.0);
    must_not(hs_plugin_parse_param(&plugin, "method=plate", &retired, &err), HS_ERR_USAGE,
             "'plate' is not one of mean, minimum, spline, wall");
    hs_plugin_close(&plugin);
}

static void wrong_values_are_refused_with_what_is_allowed(void **state) {
    const hs_plugin *plugin = *state;
    static const struct {
        const char *text, *says;
    } bad[] = {{"depth", "expected key=value"},
               {"=3", "expected key=value"},
               {"depht=3", "there are: depth, shape, fail, every, note"},
               {"depth=", "depth: '' is not a number"},
               {"depth=3x", "'3x' is not a number"},
               {"depth=nan", "'nan' is not a number"},
               {"depth=inf", "'inf' is not a number"},
               {"depth=10001", "10001 is outside -10000 .. 10000"},
               {"every=0", "0 is outside 1 .. 63"},
               {"every=4", "4 is not 1 plus a multiple of 2"},
               {"every=2.5", "2.5 is not 1 plus a multiple of 2"},
               {"shape=round", "'round' is not one of flat, tilted"},
               {"note=maybe", "'maybe' is not a number"},
               {"note=2", "2 is outside 0 .. 1"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sv_param_value value;
        must_not(hs_plugin_parse_param(plugin, bad[i].text, &value, &err), HS_ERR_USAGE, bad[i].says);
    }
}

static void a_failed_call_is_told_with_path_call_status_and_reason(void **state) {
    const hs_plugin *plugin = *state;
    const sv_plugin *p = plugin->instance;
    sv_result result = {.size = sizeof result};
    hs_error err = {0};
    assert_true(hs_plugin_check(plugin, SV_OK, "end", &err));
    assert_true(hs_plugin_check(plugin, SV_NO_SURFACE, "end", &err));
    assert_int_equal(err.code, HS_OK);
    assert_false(hs_plugin_check(plugin, p->adjust(p, NULL, 0, &result), "adjust", &err));
    unit_told(err, HS_ERR_PLUGIN, "plane.so: adjust: SV_ERR_STATE (-20): adjust: the instance is inactive");
}

/* A recording may name any carrier: 0 and 33 are none, even where a shift by 33 is one by 1. */
static void carriers_that_are_none_are_not_taken(void **state) {
    const sv_descriptor all = {.carriers = UINT32_MAX, .voxel_types = UINT32_MAX, .queues = UINT32_MAX};
    static const uint32_t none[] = {0, 4, 31, 32, 33, 34, 16385, UINT32_MAX};
    for (uint32_t carrier = SV_CARRIER_HOST; carrier <= SV_CARRIER_IMAGE; carrier++)
        assert_true(hs_plugin_takes(&all, (hs_handover){carrier, false}));
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_false(hs_plugin_takes(&all, (hs_handover){none[i], false}));
}

static void every_status_has_its_name(void **state) {
    assert_string_equal(hs_status_name(SV_OK), "SV_OK");
    assert_string_equal(hs_status_name(SV_PARTIAL), "SV_PARTIAL");
    assert_string_equal(hs_status_name(SV_ERR_SLAB_ORDER), "SV_ERR_SLAB_ORDER");
    assert_string_equal(hs_status_name(SV_ERR_NO_MEMORY), "SV_ERR_NO_MEMORY");
    assert_string_equal(hs_status_name(-999), "unknown status");
}

/* A table of a later revision's beginning, or one that a plugin left half empty. */
static sv_ext_confidence given;

static const void *give_confidence(const sv_plugin *plugin, const char *id) {
    return strcmp(id, SV_EXT_CONFIDENCE) == 0 ? &given : NULL;
}

static uint32_t never_offered(const sv_plugin *plugin) {
    return 0;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is the extension's */
static sv_status never_read(const sv_plugin *plugin, float *map, sv_confidence_report *report) {
    return SV_ERR_STATE;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the same */
static sv_status never_written(const sv_plugin *plugin, float *map, struct _cl_mem *object, uint64_t offset) {
    return SV_ERR_STATE;
}

static void an_extension_without_all_of_its_calls_is_none(void **state) {
    const sv_plugin plugin = {.get_extension = give_confidence};
    const sv_ext_confidence whole = {
        .size = sizeof whole, .read = never_read, .offered = never_offered, .write = never_written};
    given = whole;
    assert_ptr_equal(hs_plugin_confidence(&plugin), &given);
    given.size = offsetof(sv_ext_confidence, write);
    assert_null(hs_plugin_confidence(&plugin));
    given = whole;
    given.write = NULL;
    assert_null(hs_plugin_confidence(&plugin));
    given = whole;
    given.offered = NULL;
    assert_null(hs_plugin_confidence(&plugin));
    given = whole;
    given.read = NULL;
    assert_null(hs_plugin_confidence(&plugin));
}

UNIT_MAIN_OF(
    NULL, NULL, cmocka_unit_test(an_extension_without_all_of_its_calls_is_none),
    cmocka_unit_test(loads_a_good_plugin_again_and_again),
    cmocka_unit_test(a_given_id_is_found_or_answered_with_those_there_are),
    cmocka_unit_test(files_that_are_no_plugin_are_named), cmocka_unit_test(a_text_file_is_not_loadable),
    cmocka_unit_test(entries_that_break_the_abi_are_refused),
    cmocka_unit_test_setup_teardown(parameters_are_found_by_key, open_plane, close_plane),
    cmocka_unit_test_setup_teardown(values_of_every_type_are_read, open_plane, close_plane),
    cmocka_unit_test_setup_teardown(enum_values_are_found_by_their_name, open_plane, close_plane),
    cmocka_unit_test_setup_teardown(wrong_values_are_refused_with_what_is_allowed, open_plane, close_plane),
    cmocka_unit_test_setup_teardown(a_failed_call_is_told_with_path_call_status_and_reason, open_plane,
                                    close_plane),
    cmocka_unit_test(an_enum_may_leave_values_out), cmocka_unit_test(carriers_that_are_none_are_not_taken),
    cmocka_unit_test(every_status_has_its_name))
