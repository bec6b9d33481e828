/* SPDX-License-Identifier: MIT */
/* A library with a variable of its own for each thread, for leak_probe: loaded later, as PoCL is, it gets
 * them from malloc. */
long *of_this_thread(void);

static _Thread_local long numbers[2];

long *of_this_thread(void) {
    return numbers;
}
