/* SPDX-License-Identifier: MIT */
/* A progress line with an estimate of the time left: on a terminal only, never in a file or a pipe. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const char *label;  /* what is under way; must stay valid until hs_progress_end */
    uint64_t total;     /* steps */
    double start, last; /* seconds: begin, and the line's last update */
    bool shown;         /* stderr is a terminal */
} hs_progress;

/* Starts a line on stderr. */
void hs_progress_begin(hs_progress *progress, const char *label, uint64_t total);

/* `done` steps of total are through. Updates the line ten times a second at most. */
void hs_progress_step(hs_progress *progress, uint64_t done);

/* From now on `heard` is called with the label at every step of every progress. NULL: nobody is. */
void hs_progress_tell(void (*heard)(const char *label));

/* Removes the line. */
void hs_progress_end(hs_progress *progress);

/* True if the stream is a terminal that shows colours: a tty, TERM not "dumb", NO_COLOR not set. */
bool hs_use_colour(int file_descriptor);

/* Seconds of a clock that only runs forward. */
double hs_now(void);
