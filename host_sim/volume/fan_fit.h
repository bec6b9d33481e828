/* SPDX-License-Identifier: MIT */
/* How the beams ran that scanned a volume, found in the outline of what was scanned. */
#pragma once

#include "volume/fan_kept.h"
#include "volume/volume.h"

/*
 * Says how the beams ran (volume->course), and where the probe was if nobody said it:
 *
 * - of a volume with beams of its own, exactly;
 * - else by the toroidal fan whose sides, face and end lie closest to the border between scanned voxels and
 *   zeros. Where nothing but the volume's own faces ends the scan, there is none. The face of the volume that
 *   the fan narrows to is the probe's, if it was not stated and no other fits;
 * - without a fan, the one whose lines meet where the file says, if it does;
 * - else, or where the size is doubted, parallel from the probe's face, if that was stated.
 *
 * Black fluid that was written as 0 is scanned all the same: see hs_volume_fill_fan. Deterministic; some
 * 100 ms, unless the same outline is among `fits`, which may be NULL. True: it was fitted anew. Does not read
 * what is inside the scan.
 */
bool hs_volume_find_beams(hs_volume *volume, hs_fits *fits);

/* Voxels of 0 inside a fan whose outline is whole become 1, a black echo, if nobody said what was
 * scanned. */
void hs_volume_fill_fan(hs_volume *volume);

/* Looks whether the volume's corners are dark noise (course.noisy), as where a file has no one value outside
 * the scan, or hold one level (course.blank) though all was said to be scanned. */
void hs_course_find_noise(hs_volume *volume);

/* All lines meet in the apex that the file says, and begin at the probe's face, which is stated. */
void hs_course_take_said(hs_volume *volume);

/* Says of a volume what was found of another one of the same scan. */
void hs_volume_share_beams(hs_volume *volume, const hs_volume *found);

/* One line about it for a person: "a fan, fitted to within 0.1 mm: lines from 77 mm, sweep from 50 mm". */
void hs_course_words(const hs_volume *volume, char *out, size_t bytes);

/* What to ask of a person who may know more: "The scan narrows towards -y: is the probe there? --probe -y";
 * "" if nothing. At most 160 bytes. */
void hs_course_question(const hs_volume *volume, char *out, size_t bytes);
