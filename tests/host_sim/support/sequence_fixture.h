/* SPDX-License-Identifier: MIT */
/* What the tests of sequences in the scan loop share. Volume n of a sequence has one level all over. */
#pragma once

#include "support/loop_fixture.h"

/* cmocka group fixtures: the loop's (*state is a fixture), and a folder for files (files_setup). */
int sequence_set_up(void **state);
int sequence_tear_down(void **state);

/* Volumes' worth of memory that a stream of three may take. The address sanitizer rounds sizes up by as much
 * as a quarter, and keeps an eighth of them beside. */
#ifdef __SANITIZE_ADDRESS__
enum { SEQUENCE_MAX_VOLUMES = 7 };
#else
enum { SEQUENCE_MAX_VOLUMES = 5 };
#endif

/* Bytes of this process that are in memory. */
size_t resident_bytes(void);

/* What expects takes `levels`, one a volume, and fails where a volume, or what its beams brought, has
 * another. */
void expect_volume(const hs_source *source, const uint8_t *levels, uint32_t index);

/* Volumes far from one another come as well as those that follow one another. */
void expect_any_order(const hs_source *source, const uint8_t *levels);

/* A round and some volumes more: `source`, which was opened when `before` bytes were in memory, never has
 * more than SEQUENCE_MAX_VOLUMES of them there. */
void expect_flat_memory(const hs_source *source, const uint8_t *levels, size_t before);

/* Volume `index` fails, whenever it is asked for, and says what of which file; volume 1 is there all the
 * same. */
void expect_failure(const hs_source *source, const uint8_t *levels, uint32_t index, const char *file,
                    const char *told);

/* Runs the loop a round and five frames more over the source, in the setting "smartvis" without a failure;
 * then every sixth volume's picture must show `levels` of it and nothing brighter. */
void expect_every_frame_shows_its_volume(const fixture *f, const hs_source *source, const uint8_t *levels);
