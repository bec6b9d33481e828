/* SPDX-License-Identifier: MIT */
/* A Kretz file of any bytes, read to its last volume. The input's first byte picks mirror and padding. */
#include "fuzz/fuzz_target.h"
#include "fuzz/memory_file.h"
#include "volume/kretz.h"

#include <math.h>

#define SPACING 60.0 /* mm: a box of twelve metres, the largest a header can ask for, stays small */

static double end_of(const hs_beams *b) {
    return b->start + (b->samples - 1.0) * b->pitch;
}

/* What was read is as a header may say, and every sample and voxel is there. */
static void check_volume(const hs_volume *v) {
    size_t sum = 0;
    FUZZ_HOLDS(v->nx > 0 && v->ny > 0 && v->nz > 0 && v->voxels);
    for (size_t i = 0; i < hs_volume_count(v); i++) sum += v->voxels[i];
    for (int a = 0; a < 3; a++) FUZZ_HOLDS(v->spacing[a] >= 0.01 && v->spacing[a] <= SPACING);
    const hs_beams *b = v->beams;
    if (b) {
        for (size_t i = 0; i < hs_beams_count(b); i++) sum += b->voxels[i];
        FUZZ_HOLDS(b->samples > 1 && b->lines > 1 && b->planes > 1 && b->pitch > 0 && b->start >= 0);
        FUZZ_HOLDS(fabs(b->theta[0] + b->theta[b->lines - 1]) < 1e-12 && fabs(b->theta[0]) < 1.5708);
        FUZZ_HOLDS(b->start * cos(b->theta[0]) > b->axis && end_of(b) < 12000.0);
        double low[3], high[3];
        hs_beams_box(b, low, high);
        for (int a = 0; a < 3; a++) FUZZ_HOLDS(low[a] < high[a] && isfinite(b->corner[a]));
    }
    FUZZ_HOLDS(sum <= 255 * (hs_volume_count(v) + (b ? hs_beams_count(b) : 0)));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size < 1) return 0;
    const hs_kretz_options options = {
        .mirrored = (data[0] & 1) != 0, .padding = (hs_padding)(data[0] / 2 % 3), .spacing = SPACING};
    memory_file file;
    memory_file_open(&file, data + 1, size - 1);
    hs_error err = {0};
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(file.path, &options, &err);
    const uint32_t count = kretz ? hs_kretz_count(kretz) : 0;
    FUZZ_HOLDS(kretz ? count > 0 : err.code != HS_OK && err.text[0]);
    bool ok = kretz != NULL;
    for (uint32_t i = 0; ok && i < count; i += i < 2 ? 1 : count / 2) {
        ok = hs_kretz_read(kretz, i, &volume, &err);
        if (ok) check_volume(&volume);
    }
    FUZZ_HOLDS(ok || (err.code != HS_OK && err.text[0]));
    hs_volume_free(&volume);
    hs_kretz_close(kretz);
    memory_file_close(&file);
    return 0;
}
