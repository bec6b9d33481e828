/* SPDX-License-Identifier: MIT */
/* cmocka behind the headers that it wants, and those of C that nearly every test uses. */
#ifndef UNIT_H
#define UNIT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The program: these tests, between the group's set-up and tear-down (NULL: none). Its file's name is that of
 * the group. */
#define UNIT_MAIN(set_up, tear_down, ...)                                                                    \
    int main(void) {                                                                                         \
        const struct CMUnitTest tests[] = {__VA_ARGS__};                                                     \
        return cmocka_run_group_tests_name(__FILE__, tests, set_up, tear_down);                              \
    }

#endif
