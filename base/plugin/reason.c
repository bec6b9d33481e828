/* SPDX-License-Identifier: MIT */
#include "plugin/reason.h"

#include <stdio.h>

bool hs_reason_words(const sv_confidence_report *r, char words[HS_REASON_BYTES]) {
    const double found = 100.0 * (double)r->found, wanted = 100.0 * (double)r->wanted;
    switch (r->reason) {
    case SV_REASON_EMPTY:
        (void)snprintf(words, HS_REASON_BYTES,
                       "Too little was scanned, or all of it has one grey level. Scan more of it.");
        return true;
    case SV_REASON_NO_FETUS:
        (void)snprintf(
            words, HS_REASON_BYTES,
            "No fetus is seen: %.0f %% of the scan show tissue brighter than the wall behind it, and "
            "%.0f %% are needed.",
            found, wanted);
        return true;
    case SV_REASON_OPEN:
        (void)snprintf(words, HS_REASON_BYTES, "Nothing hides the fetus: the scan begins in the fluid.");
        return true;
    case SV_REASON_NO_FLUID:
        (void)snprintf(
            words, HS_REASON_BYTES,
            "No fluid lies between wall and fetus: %.0f %% of what is as dark as fluid; from %.0f %% on "
            "it is sure.",
            found, wanted);
        return true;
    case SV_REASON_DOUBTFUL:
        (void)snprintf(
            words, HS_REASON_BYTES,
            "It is doubtful whether fluid lies between wall and fetus: %.0f %% of what is as dark as "
            "fluid; from %.0f %% on it is sure.",
            found, wanted);
        return true;
    default:
        return false; /* of a later version */
    }
}
