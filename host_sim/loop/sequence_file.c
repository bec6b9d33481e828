/* SPDX-License-Identifier: MIT */
#include "loop/sequence_file.h"

#include "volume/scanned_maps.h"

uint32_t hs_sequence_file_count(const hs_sequence_file *file) {
    return file->kretz ? hs_kretz_count(file->kretz) : hs_metaimage_volumes(file->metaimage);
}

bool hs_sequence_file_read(hs_sequence_file *file, uint32_t index, hs_volume *volume, hs_error *err) {
    if (file->kretz) return hs_kretz_read(file->kretz, index, volume, err);
    const bool fresh = volume->voxels == NULL;
    if (!hs_metaimage_read_at(file->metaimage, index, volume, err)) return false;
    const hs_source_scanned *maps = &file->scanned;
    const bool ok = !maps->first || hs_scanned_maps_apply(volume, maps->first, maps->end, err);
    if (!ok && fresh) hs_volume_free(volume);
    return ok;
}

void hs_sequence_file_close(hs_sequence_file *file) {
    hs_kretz_close(file->kretz);
    hs_metaimage_close(file->metaimage);
    *file = (hs_sequence_file){0};
}
