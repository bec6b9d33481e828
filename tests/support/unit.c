/* SPDX-License-Identifier: MIT */
#include "support/unit.h"

typedef struct kept {
    const struct kept *before;
    void (*give_back)(void *what);
    void *what;
} kept;
static const kept *last, *first_of_test;

void unit_keep(void (*give_back)(void *what), void *what) {
    kept *k = malloc(sizeof *k);
    if (!k) abort();
    *k = (kept){last, give_back, what};
    last = k;
}

void *unit_memory(size_t bytes) {
    void *memory = calloc(1, bytes);
    if (!memory) abort();
    unit_keep(free, memory);
    return memory;
}

const char *unit_text(const char *format, ...) {
    char *text = NULL;
    va_list args;
    va_start(args, format);
    if (vasprintf(&text, format, args) < 0) abort();
    va_end(args);
    unit_keep(free, text);
    return text;
}

const void *unit_mark(void) {
    return last;
}

void unit_return(const void *mark) {
    while (last && last != mark) {
        const kept *k = last;
        last = k->before;
        k->give_back(k->what);
        free((void *)(uintptr_t)k);
    }
}

int unit_begin(void **state) {
    first_of_test = last;
    return 0;
}

int unit_end(void **state) {
    unit_return(first_of_test);
    return 0;
}

uint32_t unit_random(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

int unit_run(const char *group, CMFixtureFunction set_up, CMFixtureFunction tear_down, const char *names,
             const CMUnitTestFunction *functions) {
    struct CMUnitTest tests[64] = {{0}}; /* those without a name are none */
    char *text = strdup(names), *rest = NULL;
    for (size_t i = 0; functions[i]; i++) {
        if (!text || i == sizeof tests / sizeof *tests) abort();
        tests[i] = (struct CMUnitTest){.name = strtok_r(i ? NULL : text, ", ", &rest),
                                       .test_func = functions[i],
                                       .setup_func = unit_begin,
                                       .teardown_func = unit_end};
    }
    const int failed = cmocka_run_group_tests_name(group, tests, set_up, tear_down);
    free(text);
    return failed;
}
