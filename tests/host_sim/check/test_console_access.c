/* SPDX-License-Identifier: MIT */
/* Who may talk to the console: Host, Origin and token of a request; and which files it may name. */
#include "console/console.h"
#include "support/metaimage_files.h"

#include <sys/stat.h>
#include <unistd.h>

static void only_numbers_of_this_machine_are_its_host(void **unused) {
    static const char *const ours[] = {"127.0.0.1:8080", "localhost:8080", "127.0.0.2:8080", "[::1]:8080",
                                       "localhost:9000"}; /* a tunnel's */
    static const char *const others[] = {NULL,
                                         "",
                                         "127.0.0.1",
                                         "127.0.0.1:",
                                         "127.0.0.1:123456",
                                         "127.0.0.1:8080 ",
                                         "evil.example:8080",
                                         "localhost.evil.example:8080",
                                         "127.0.0.1.evil.example:8080",
                                         "127.0.0.1:8080.evil.example",
                                         "127.0.0:8080",
                                         "127.0.0.1.:8080",
                                         "127.0.0.999:8080",
                                         "127.0.0.1@evil.example:8080",
                                         "192.168.0.7:8080",
                                         "[::1:8080",
                                         "[::2]:8080",
                                         ":8080"};
    for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
        if (!hs_console_host_is_ours(ours[i], true)) fail_msg("'%s' is refused", ours[i]);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (hs_console_host_is_ours(others[i], true)) fail_msg("'%s' is taken", others[i]);
}

static void elsewhere_any_number_is(void **unused) {
    assert_true(hs_console_host_is_ours("192.168.0.7:9", false));
    assert_true(hs_console_host_is_ours("[fe80::1]:9", false));
    assert_true(hs_console_host_is_ours("localhost:9", false));
    assert_false(hs_console_host_is_ours("scanner.example:9", false)); /* a name may be made to lead here */
    assert_false(hs_console_host_is_ours("[fe80::x]:9", false));
    assert_false(hs_console_host_is_ours("1.2.3:9", false));
}

static void an_origin_is_a_page_of_this_host(void **unused) {
    static const char host[] = "127.0.0.1:8080";
    assert_true(hs_console_origin_is_ours("http://127.0.0.1:8080", host));
    assert_false(hs_console_origin_is_ours(NULL, host));
    assert_false(hs_console_origin_is_ours("http://127.0.0.1:8080", NULL));
    assert_false(hs_console_origin_is_ours("null", host));
    assert_false(hs_console_origin_is_ours("https://127.0.0.1:8080", host));
    assert_false(hs_console_origin_is_ours("http://127.0.0.1:8081", host));
    assert_false(hs_console_origin_is_ours("http://127.0.0.1:8080.evil.example", host));
    assert_false(hs_console_origin_is_ours("http://localhost:8080", host));
}

static void a_token_must_be_whole(void **unused) {
    char token[HS_CONSOLE_TOKEN], other[HS_CONSOLE_TOKEN], query[128];
    must(hs_console_make_token(token, &err));
    must(hs_console_make_token(other, &err));
    assert_int_equal(strlen(token), HS_CONSOLE_TOKEN - 1);
    assert_int_equal(strspn(token, "0123456789abcdef"), HS_CONSOLE_TOKEN - 1);
    assert_string_not_equal(token, other);
    (void)snprintf(query, sizeof query, "t=%s", token);
    assert_true(hs_console_token_fits(query, token));
    assert_false(hs_console_token_fits(query, other));
    (void)snprintf(query, sizeof query, "a=1&t=%s&b=2", token);
    assert_true(hs_console_token_fits(query, token));
    for (int digit = 0; digit < HS_CONSOLE_TOKEN - 1; digit++) { /* one wrong digit, wherever it stands */
        (void)snprintf(query, sizeof query, "t=%s", token);
        query[2 + digit] = token[digit] == '0' ? '1' : '0';
        assert_false(hs_console_token_fits(query, token));
    }
    (void)snprintf(query, sizeof query, "t=%s0", token);
    assert_false(hs_console_token_fits(query, token));
    (void)snprintf(query, sizeof query, "t=%.31s", token);
    assert_false(hs_console_token_fits(query, token));
    (void)snprintf(query, sizeof query, "xt=%s", token);
    assert_false(hs_console_token_fits(query, token));
    assert_false(hs_console_token_fits(NULL, token));
    assert_false(hs_console_token_fits("t=", ""));
}

/* --------------------------------------------------------------------------------------------- files -- */

static void link_to(const char *target, const char *name) {
    assert_int_equal(symlink(target, files_path(name)), 0);
}

/* given/ with volumes and links in it, and secret.mha beside it. */
static int make_tree(void **state) {
    static const char *const folders[] = {"given", "given/deep", "given-not", "given/loop"};
    static const char *const names[] = {"secret.mha",       "given-not/near.mha", "given/a.mha",
                                        "given/b.VOL",      "given/notes.txt",    "given/deep/c.mhd",
                                        "given/.hidden.mha"};
    assert_int_equal(files_setup(state), 0);
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        assert_int_equal(mkdir(files_path(folders[i]), 0700), 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) files_write(names[i], NULL, NULL, 0);
    link_to("a.mha", "given/inside.mha");
    link_to("../secret.mha", "given/outside.mha");
    link_to("../given-not/near.mha", "given/near.mha");
    link_to("..", "given/up");
    link_to(".", "given/loop/again");
    hs_console_files *files = calloc(1, sizeof *files);
    must(hs_console_files_add(files, files_path("given"), &err));
    *state = files;
    return 0;
}

static int remove_tree(void **state) {
    hs_console_files_free(*state);
    free(*state);
    return system(unit_text("rm -rf '%s'", files_path("")));
}

static bool note(void *context, uint32_t folder, const char *path) {
    char *list = context;
    assert_int_equal(folder, 0);
    strcat(strcat(list, path), " ");
    return true;
}

static void the_list_has_what_lies_inside(void **state) {
    char list[512] = "";
    hs_console_files_list(*state, note, list);
    assert_string_equal(list, "a.mha b.VOL deep/c.mhd inside.mha ");
}

static void nothing_outside_is_found(void **state) {
    static const char *const refused[] = {"../secret.mha",
                                          "outside.mha",
                                          "near.mha",
                                          "up/secret.mha",
                                          "../given-not/near.mha",
                                          "deep/../../secret.mha",
                                          "/etc/passwd",
                                          "notes.txt",
                                          "missing.mha",
                                          "deep",
                                          ".",
                                          ""};
    char path[1024];
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        hs_error err = {0};
        if (hs_console_files_find(*state, 0, refused[i], path, sizeof path, &err) || err.code != HS_ERR_INPUT)
            fail_msg("'%s' was found", refused[i]);
    }
    hs_error err = {0};
    assert_false(hs_console_files_find(*state, 1, "a.mha", path, sizeof path, &err));
    assert_true(hs_console_files_find(*state, 0, "deep/../inside.mha", path, sizeof path, &err));
    assert_string_equal(path, files_path("given/a.mha"));
}

static void what_is_no_folder_is_refused(void **state) {
    hs_console_files files = {0};
    must_not(hs_console_files_add(&files, "/no/such/folder", &err), HS_ERR_INPUT,
             "/no/such/folder: is no folder");
    hs_console_files_free(&files);
}

UNIT_MAIN(make_tree, remove_tree, only_numbers_of_this_machine_are_its_host, elsewhere_any_number_is,
          an_origin_is_a_page_of_this_host, a_token_must_be_whole, the_list_has_what_lies_inside,
          nothing_outside_is_found, what_is_no_folder_is_refused)
