/* SPDX-License-Identifier: MIT */
/* Values of `host_sim run`'s options: a number, one of a few words, or several things. */
#ifndef HS_RUN_VALUE_H
#define HS_RUN_VALUE_H

#include "loop/loop.h"
#include "loop/source.h"

/* All of them: HS_ERR_USAGE names the option, the text and what is expected. */

/* A number in low .. high. */
bool hs_value_float(const char *option, const char *text, double low, double high, float *out, hs_error *err);

/* --window "LOW,HIGH" */
bool hs_value_window(const char *text, hs_metaimage_options *read, hs_error *err);

/* --scanned "FIRST,END"; the first path is copied to `first`, and `out` points there and into `text`. */
bool hs_value_scanned(const char *text, char *first, size_t bytes, hs_source_scanned *out, hs_error *err);

/* --probe and --view */
bool hs_value_probe(const char *text, hs_metaimage_options *read, hs_error *err);
bool hs_value_view(const char *text, hs_loop_options *loop, hs_error *err);

#endif
