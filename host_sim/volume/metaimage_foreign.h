/* SPDX-License-Identifier: MIT */
/* Files of other formats, told by what is in them and not by their names. Internal
 * to the MetaImage reader. */
#ifndef HS_METAIMAGE_FOREIGN_H
#define HS_METAIMAGE_FOREIGN_H

#include "base/error.h"

#include <stddef.h>

/* True, with HS_ERR_INPUT, if the first bytes of `path` are those of NRRD, NIfTI (also compressed), Analyze
 * or DICOM: the message names the format and says how to convert the file. `head` holds the first `bytes`. */
bool hs_met_is_foreign(const char *path, const char *head, size_t bytes, hs_error *err);

#endif
