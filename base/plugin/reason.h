/* SPDX-License-Identifier: MIT */
/* Why a plugin found no surface, or a doubtful one, in words for who holds the probe. */
#pragma once

#include "smartvis/confidence.h"

#include <stdbool.h>

enum { HS_REASON_BYTES = 320 };

/* False: the report tells no reason, or one of a later version. */
bool hs_reason_words(const sv_confidence_report *report, char words[HS_REASON_BYTES]);
