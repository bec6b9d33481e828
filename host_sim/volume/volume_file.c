/* SPDX-License-Identifier: MIT */
#include "volume/kretz.h"
#include "volume/volume.h"

#include <string.h>

static bool read_kretz(const char *path, hs_volume *out, hs_error *err) {
    memset(out, 0, sizeof *out);
    hs_kretz *kretz = hs_kretz_open(path, NULL, err);
    if (!kretz) return false;
    const uint32_t volumes = hs_kretz_count(kretz);
    const bool ok =
        (volumes == 1 ||
         hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, expected one volume", path, volumes)) &&
        hs_kretz_read(kretz, 0, out, err);
    hs_kretz_close(kretz);
    if (!ok) return false;
    hs_beams_free(out->beams);
    out->beams = NULL;
    return true;
}

bool hs_volume_file_read(const char *path, hs_volume *out, hs_error *err) {
    return hs_kretz_is_file(path) ? read_kretz(path, out, err) : hs_metaimage_read(path, NULL, out, err);
}
