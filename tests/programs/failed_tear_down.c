/* SPDX-License-Identifier: MIT */
/* A group whose tests pass and whose tear-down fails: CTest must count it as a failure. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void passes(void **state) {}

static int fails(void **state) {
    return -1;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(passes)};
    return cmocka_run_group_tests(tests, NULL, fails);
}
