/* SPDX-License-Identifier: MIT */
#include "loop/sequence_file.h"

#include "volume/metaimage.h"

/* What only MetaImage files take must not be asked of others in vain. */
static bool check_kretz(const char *path, const hs_source_files *how, hs_error *err) {
    if (how->scanned.first)
        return hs_fail(err, HS_ERR_USAGE,
                       "%s: a Kretz file says itself what was scanned, maps of it were given", path);
    if (how->metaimage.has_probe)
        return hs_fail(err, HS_ERR_USAGE, "%s: a Kretz file says itself where the probe is, %s was given",
                       path, hs_probe_name(how->metaimage.probe));
    return !how->metaimage.has_window ||
           hs_fail(err, HS_ERR_USAGE, "%s: a window was given, but a Kretz file has 8 bits", path);
}

bool hs_sequence_file_open(hs_sequence_file *file, const char *path, const hs_source_files *how,
                           hs_error *err) {
    *file = (hs_sequence_file){0};
    if (hs_kretz_is_file(path)) {
        hs_kretz_options options = how->kretz;
        options.padding = how->metaimage.padding;
        file->kretz = check_kretz(path, how, err) ? hs_kretz_open(path, &options, err) : NULL;
        return file->kretz != NULL;
    }
    hs_metaimage_options options = how->metaimage;
    if (how->scanned.first) options.padding = HS_PADDING_ALL; /* no need to guess: the maps tell */
    file->scanned = how->scanned;
    file->metaimage = hs_metaimage_open(path, &options, err);
    return file->metaimage != NULL;
}

uint32_t hs_sequence_file_count(const hs_sequence_file *file) {
    return file->kretz ? hs_kretz_count(file->kretz) : hs_metaimage_volumes(file->metaimage);
}

bool hs_sequence_file_shape(const hs_sequence_file *file, hs_volume *shape, hs_error *err) {
    if (file->kretz) return hs_kretz_shape(file->kretz, shape, err);
    hs_metaimage_shape(file->metaimage, shape);
    return true;
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
