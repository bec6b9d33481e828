/* SPDX-License-Identifier: MIT */
#include "core/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double hs_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool hs_use_colour(int file_descriptor) {
    const char *term = getenv("TERM");
    const char *no_colour = getenv("NO_COLOR");
    return isatty(file_descriptor) && term && strcmp(term, "dumb") != 0 && !(no_colour && no_colour[0]);
}

static void (*listener)(const char *label);

void hs_progress_tell(void (*heard)(const char *label)) {
    listener = heard;
}

void hs_progress_begin(hs_progress *progress, const char *label, uint64_t total) {
    *progress =
        (hs_progress){.label = label, .total = total, .start = hs_now(), .shown = isatty(STDERR_FILENO)};
}

void hs_progress_step(hs_progress *progress, uint64_t done) {
    double now = hs_now();
    if (listener) listener(progress->label);
    if (!progress->shown || done == 0 || now - progress->last < 0.1) return;
    progress->last = now;
    double left = (now - progress->start) / (double)done * (double)(progress->total - done);
    /* \r and "erase to the end of the line" keep one line, whatever its length was before. */
    (void)fprintf(stderr, "\r%s: %llu of %llu, %.0f s left\033[K", progress->label, (unsigned long long)done,
                  (unsigned long long)progress->total, left);
    (void)fflush(stderr);
}

void hs_progress_end(hs_progress *progress) {
    if (progress->shown && progress->last > 0) (void)fprintf(stderr, "\r\033[K");
    progress->shown = false;
}
