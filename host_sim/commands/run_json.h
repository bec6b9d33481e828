/* SPDX-License-Identifier: MIT */
/* A run's results as JSON. */
#ifndef HS_RUN_JSON_H
#define HS_RUN_JSON_H

#include "commands/run.h"

/* Writes facts, times, shares and statistics to `path`, which appears whole. HS_ERR_OUTPUT, HS_ERR_MEMORY. */
bool hs_run_write_json(const hs_run *run, const char *path, hs_error *err);

#endif
