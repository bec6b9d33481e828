/* SPDX-License-Identifier: MIT */
/* cmocka behind the headers that it wants, and those of C that nearly every test uses. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* cmocka's own names neither side. */
#undef assert_int_equal
#define assert_int_equal(found, expected)                                                                    \
    do {                                                                                                     \
        const long long found_ = (long long)(found), expected_ = (long long)(expected);                      \
        if (found_ != expected_)                                                                             \
            fail_msg("%s is %lld, expected %s = %lld", #found, found_, #expected, expected_);                \
    } while (0)

/* What a test takes and need not give back: it is gone when the test has ended, whatever came of it. */

/* Zeros. Without memory the program ends. */
void *unit_memory(size_t bytes);

/* A text, as printf makes it. */
const char *unit_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* `give_back` is called with `what` then; the last is given back first. */
void unit_keep(void (*give_back)(void *what), void *what);

/* Where loops take much: unit_return gives back what has been taken since unit_mark. */
const void *unit_mark(void);
void unit_return(const void *mark);

/* Set-up and tear-down of UNIT_MAIN's tests that have none of their own, whose tear-down calls unit_end: what
 * was taken since the set-up is given back, and what the group's took stays. Both return 0. */
int unit_begin(void **state);
int unit_end(void **state);

/* Deterministic numbers: xorshift, 32 bits. The state must not be 0. */
uint32_t unit_random(uint32_t *state);

/* Fails unless the error has this code, and words of its text are these. */
#define unit_told(err, expected, words)                                                                      \
    do {                                                                                                     \
        assert_int_equal((err).code, expected);                                                              \
        if (!strstr((err).text, words)) fail_msg("'%s' does not say '%s'", (err).text, words);               \
    } while (0)

/* Fails, with its reason, unless the call succeeds; what it tells goes to `&err`, an hs_error of its own. */
#define must(call)                                                                                           \
    do {                                                                                                     \
        hs_error err = {0};                                                                                  \
        if (!(call)) fail_msg("%s: %s", #call, err.text);                                                    \
    } while (0)

/* Fails unless the call does, with this code and words in what it tells. */
#define must_not(call, expected, words)                                                                      \
    do {                                                                                                     \
        hs_error err = {0};                                                                                  \
        if (call) fail_msg("%s does not fail", #call);                                                       \
        unit_told(err, expected, words);                                                                     \
    } while (0)

/* Runs these tests, by their names, between the group's set-up and tear-down (NULL: none); how many failed.
 */
#define UNIT_RUN(group, set_up, tear_down, ...)                                                              \
    unit_run(group, set_up, tear_down, #__VA_ARGS__, (const CMUnitTestFunction[]){__VA_ARGS__, NULL})
int unit_run(const char *group, CMFixtureFunction set_up, CMFixtureFunction tear_down, const char *names,
             const CMUnitTestFunction *functions);

/* The program: these tests. Its file's name is that of the group. */
#define UNIT_MAIN(set_up, tear_down, ...)                                                                    \
    int main(void) {                                                                                         \
        return UNIT_RUN(__FILE__, set_up, tear_down, __VA_ARGS__);                                           \
    }

/* The same of cmocka's own structs, where tests have set-ups of their own. */
#define UNIT_MAIN_OF(set_up, tear_down, ...)                                                                 \
    int main(void) {                                                                                         \
        struct CMUnitTest tests[] = {__VA_ARGS__};                                                           \
        for (size_t i = 0; i < sizeof tests / sizeof *tests; i++)                                            \
            if (!tests[i].setup_func) {                                                                      \
                tests[i].setup_func = unit_begin;                                                            \
                tests[i].teardown_func = unit_end;                                                           \
            }                                                                                                \
        return cmocka_run_group_tests_name(__FILE__, tests, set_up, tear_down);                              \
    }
