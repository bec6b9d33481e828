/* SPDX-License-Identifier: MIT */
/* A MetaImage file of any bytes, read as a volume and as a map. The input's first byte picks padding, window
 * and map. */
#include "fuzz/fuzz_target.h"
#include "fuzz/memory_file.h"
#include "volume/metaimage.h"

/* A volume that was read is as its header says: every voxel is there, and spacing is a length. */
static void check_volume(const hs_volume *v) {
    FUZZ_HOLDS(v->nx > 0 && v->ny > 0 && v->nz > 0 && v->voxels);
    unsigned sum = 0;
    for (size_t i = 0; i < hs_volume_count(v); i++) sum += v->voxels[i];
    for (int a = 0; a < 3; a++) FUZZ_HOLDS(v->spacing[a] > 0 && v->spacing[a] < 1e300);
    FUZZ_HOLDS(sum <= 255u * hs_volume_count(v));
}

/* Volumes out of order, one into the memory of the other, failed ones between them. */
static void read_at_random(hs_metaimage *file, uint32_t volumes) {
    hs_volume volume = {0};
    for (uint32_t turn = 0; turn < 6 && volumes > 0; turn++) {
        hs_error err = {0};
        if (hs_metaimage_read_at(file, turn * 7u % volumes, &volume, &err))
            check_volume(&volume);
        else
            FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    }
    hs_volume_free(&volume);
}

/* The same file as a sequence: no more volumes than it promised, each as its header says. */
static void read_sequence(const char *path, const hs_metaimage_options *options) {
    hs_error err = {0};
    hs_metaimage *file = hs_metaimage_open(path, options, &err);
    if (!file) FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    const uint32_t volumes = file ? hs_metaimage_volumes(file) : 0;
    for (uint32_t i = 0; i < volumes && i < 64; i++) {
        hs_volume volume = {0};
        const hs_frame_fields *fields = hs_metaimage_fields(file, i);
        if (!hs_metaimage_read_at(file, i, &volume, &err)) {
            FUZZ_HOLDS(err.code != HS_OK && err.text[0] && !volume.voxels);
            break;
        }
        check_volume(&volume);
        FUZZ_HOLDS(!fields || (fields->transform_count <= HS_FRAME_TRANSFORMS && !fields->invalid));
        hs_volume_free(&volume);
    }
    if (file) read_at_random(file, volumes);
    hs_metaimage_close(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size < 1) return 0;
    const unsigned choice = data[0];
    memory_file file;
    memory_file_open(&file, data + 1, size - 1);
    hs_error err = {0};
    if (choice & 0x80) {
        double map[7 * 5];
        if (!hs_metaimage_read_map(file.path, 7, 5, map, &err)) FUZZ_HOLDS(err.code != HS_OK && err.text[0]);
    } else {
        const hs_metaimage_options options = {.padding = (hs_padding)(choice % 3),
                                              .has_window = (choice & 0x40) != 0,
                                              .window_low = -100,
                                              .window_high = (choice & 0x20) ? 500 : -99};
        hs_volume volume;
        read_sequence(file.path, &options);
        if (hs_metaimage_read(file.path, &options, &volume, &err)) {
            check_volume(&volume);
            hs_volume_free(&volume);
        } else {
            FUZZ_HOLDS(err.code != HS_OK && err.text[0] && !volume.voxels);
        }
    }
    memory_file_close(&file);
    return 0;
}
