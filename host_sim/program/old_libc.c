/* SPDX-License-Identifier: MIT */
/* Only in host_sim_alone: what the archives linked into it ask of the C library that they were built with,
 * and glibc 2.34 does not have. Without these two the wheel would ask every machine for glibc 2.36. */
#include <math.h>
#include <stddef.h>
#include <string.h>
#include <sys/random.h>

void arc4random_buf(void *out, size_t bytes);

/* For cairo: lengths in pixels, whose squares do not overflow. */
double hypot(double x, double y) {
    return sqrt(x * x + y * y);
}

/* For expat: a number that salts its tables, which the font configuration does not need. */
void arc4random_buf(void *out, size_t bytes) {
    if (getrandom(out, bytes, 0) < 0) memset(out, 0, bytes);
}
