/* SPDX-License-Identifier: MIT */
/* The fields of a MetaImage header that make its last axis time. Internal to the MetaImage reader. */
#ifndef HS_METAIMAGE_SEQUENCE_H
#define HS_METAIMAGE_SEQUENCE_H

#include "volume/frame_fields.h"
#include "volume/metaimage_text.h"

#define HS_MET_MAX_FRAMES 100000u /* volumes in a file */

/*
 * Checks Kinds against the number of dimensions (3 or 4). A sequence of pictures, whose third axis is time,
 * is refused by name: as a volume it would be misread. Such a file has fields of its frames, or calls its
 * third axis a list or time. PLUS calls it so in the volumes that it reconstructs, too: those have no fields
 * of frames, and `placed`, a third spacing other than 1 or a third offset other than 0, which pictures never
 * have.
 */
bool hs_met_kinds(const hs_met_text *text, uint64_t dims, bool placed);

/* The fields of all `count` volumes of four dimensions: *fields is the caller's to free, and NULL if the file
 * has none of them. Fields that are not used are skipped unseen. */
bool hs_met_frames(const hs_met_text *text, uint64_t dims, uint32_t count, hs_frame_fields **fields);

#endif
