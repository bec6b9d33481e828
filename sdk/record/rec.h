/* SPDX-License-Identifier: MIT */
/*
 * Writes what passes between a host and a plugin to a file that sv_replay plays again (docs/recording.md).
 * Needs libc, OpenCL for slabs and maps that lie in objects, and zlib. Nothing here depends on a host of our
 * own.
 */
#pragma once

#include "rules/call.h"

#include <stddef.h>

/* Names of calls, as recordings, layer and player tell them: "begin". */
extern const char *const rc_names[RC_CALLS];

typedef struct rec rec;

/*
 * Begins a recording of one instance in the file `path`, which is overwritten and may be read by its owner
 * only. A recording there that was not finished becomes `path`.before in place of an earlier one. A process
 * that the host forks adds nothing to it.
 *
 * `options`: NULL, or words between blanks or commas. With frames=N at least the last N frames are kept, and
 * fewer than 2 N while it runs; and the frame that brought the volume of the first of them. Else all. With
 * voxels=no neither voxels nor maps are kept, only shapes, values, statuses and statistics.
 *
 * Returns NULL, with a sentence in `error`, if the file cannot be written or a word is unknown.
 */
rec *rec_open(const char *path, const char *options, char *error, size_t error_bytes);

/*
 * Around every call, in the caller's thread. What the call is given is in the file before the plugin sees it,
 * so a call that never returns is there, too. Slabs and ranges in objects are read through the format's
 * queue, which waits; behind end and adjust, rec_after waits for that queue and keeps the results. Calls that
 * are not `sound` are kept by their kind and status alone. For create, rec_after needs the instance.
 */
void rec_before(rec *r, const rc_call *call);
void rec_after(rec *r, const rc_call *call);

/* A line of the plugin's log, from any thread. `severity` REC_NOTE: a remark of whoever records, which is
 * shown and not compared. */
#define REC_NOTE (-1)
void rec_log(rec *r, int32_t severity, const char *text);

/* Why it has stopped, "" if it has not: the disk is full, or a slab too large. Valid until close. */
const char *rec_why(const rec *r);

/* Ends the file as a whole one. NULL is fine. */
void rec_close(rec *r);
