/* SPDX-License-Identifier: MIT */
/* Reading a volume's bytes once, one of the yardsticks (plain_volume.h). */
#ifndef PLAIN_READ_H
#define PLAIN_READ_H

#include "bench/bench_team.h"

#include <stddef.h>
#include <stdint.h>

/* Reads `bytes` bytes (a multiple of 16, aligned to 8) once, as 64-bit words that are summed. Between
 * bench_team_ready and _rest. */
uint64_t plain_read(bench_team *team, const void *memory, size_t bytes);

#endif
