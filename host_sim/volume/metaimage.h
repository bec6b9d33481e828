/* SPDX-License-Identifier: MIT */
/* Reads volumes from MetaImage files (.mhd with a data file, .mha). docs/metaimage.md states the mapping. */
#pragma once

#include "volume/levels.h"
#include "volume/volume.h"

typedef enum {
    HS_MET_CHAR = 0,
    HS_MET_UCHAR,
    HS_MET_SHORT,
    HS_MET_USHORT,
    HS_MET_INT,
    HS_MET_UINT,
    HS_MET_LONG_LONG,
    HS_MET_ULONG_LONG,
    HS_MET_FLOAT,
    HS_MET_DOUBLE,
    HS_MET_TYPES
} hs_met_type;

/* The type as headers name it, "MET_CHAR"; static. */
const char *hs_met_type_name(hs_met_type type);
/* Bytes of a voxel. */
uint32_t hs_met_type_bytes(hs_met_type type);

#define HS_FRAME_TRANSFORMS 8u /* of one volume */

/* Where something was while the volume was scanned. */
typedef struct {
    char name[48];     /* "ImageToReference": letters, digits and _ */
    double matrix[16]; /* row-major, mm; the last row is 0 0 0 1. The identity if only a status was given */
    char status[24];   /* "OK", or why it does not hold, in capitals */
} hs_frame_transform;

/* What a header says of one volume; a zeroed struct says nothing. */
typedef struct {
    bool invalid;  /* the image is none */
    bool has_time; /* `time` is given */
    double time;   /* s, by the scanner's clock */
    uint32_t transform_count;
    hs_frame_transform transforms[HS_FRAME_TRANSFORMS];
} hs_frame_fields;

/* What a 0 in the 8-bit volume means. */
typedef enum {
    HS_PADDING_AUTO = 0, /* zeros connected to the border are not scanned, inner ones become 1; a constant
                            that lies outside a fan counts as 0 (levels.h) */
    HS_PADDING_NONE,     /* everything was scanned: every zero becomes 1 */
    HS_PADDING_ALL       /* every zero is not scanned */
} hs_padding;

typedef struct {
    hs_padding padding;
    bool has_window;                /* false: MET_UCHAR as it is, other types from their own range */
    double window_low, window_high; /* source values that become 0 and 255; low < high, finite */
    bool has_probe;                 /* `probe` instead of what the file says or slice 0 */
    hs_probe probe;
    bool has_spacing; /* `spacing`, mm, instead of what the file says or does not say */
    double spacing[3];
    const char *scanned[2]; /* MetaImage files of a map each: first scanned slice, first one behind the scan
                               (hs_scanned_maps_load). Range and padding are theirs then. NULL: none */
    const char *folder;     /* header and data lie in it or below, wherever links lead; NULL: anywhere */
} hs_metaimage_options;

/*
 * A file that is being read, of one volume or of a sequence of them. One thread at a time.
 *
 * Open: `path` must outlive it. A type that must be mapped to 8 bit is read through for its range first, all
 * volumes together, so that brightness means the same in all of them. NULL on failure; errors as in
 * hs_metaimage_read.
 */
typedef struct hs_metaimage hs_metaimage;
hs_metaimage *hs_metaimage_open(const char *path, const hs_metaimage_options *opt, hs_error *err);
void hs_metaimage_close(hs_metaimage *file); /* NULL is allowed */

/* How many volumes it has: 1 .. 100000. Those that the file itself calls invalid (ImageStatus) are left
 * out. */
uint32_t hs_metaimage_volumes(const hs_metaimage *file);
uint32_t hs_metaimage_left_out(const hs_metaimage *file);

/* Size, spacing, pose, probe and name of its volumes; no voxels. */
void hs_metaimage_shape(const hs_metaimage *m, hs_volume *shape);

/* True if values are mapped to 8 bit, and then what becomes 0 and 255: a window that spares a later opening
 * of the same file the search for its range. */
bool hs_metaimage_range(const hs_metaimage *file, double *low, double *high);

/* How, and what lies outside the scan. The file's. */
const hs_levels *hs_metaimage_levels(const hs_metaimage *file);

/*
 * Reads volume `index` (0 .. hs_metaimage_volumes - 1), in any order. A zeroed `volume` is made, and the
 * caller frees it with hs_volume_free; one that an earlier call made from the same file is filled again,
 * without new memory but for the padding. Plain data is read where it stands. Compressed data is inflated
 * forward from where the last call ended, and anew from the first byte if that lies behind: going round a
 * file in order inflates it once a round. From then on `err` receives the errors of the file, those of
 * hs_metaimage_read; a volume that was to be made is zeroed then.
 */
bool hs_metaimage_read_at(hs_metaimage *file, uint32_t index, hs_volume *volume, hs_error *err);

/* What the file says about volume `index`; NULL: nothing about any of them. The file's. */
const hs_frame_fields *hs_metaimage_fields(const hs_metaimage *file, uint32_t index);

/*
 * Reads the volume of a file that holds one. `opt` may be NULL (padding auto, no window). On success the
 * caller frees `out` with hs_volume_free; on failure it is zeroed and nothing is left. Needs the 8-bit volume
 * and about 1 MB beside it, whatever the voxel type, and 128 KB a thread: the data is streamed, twice if its
 * range must be found first. Bytes that are taken as they are go from the file straight to the voxels.
 * Padding auto needs what hs_volume_mark_unscanned does.
 *
 * HS_ERR_INPUT: unreadable, malformed or truncated file, or a sequence of several volumes, named with line,
 * field and value; NaN or infinite voxels, named with their position. HS_ERR_USAGE: a window that is none.
 * HS_ERR_MEMORY. Values of fields this reader does not use never appear in a message: they may hold a
 * patient's data. Any thread.
 */
bool hs_metaimage_read(const char *path, const hs_metaimage_options *opt, hs_volume *out, hs_error *err);

/* Reads a map of nx x ny pixels (a file of nx x ny x 1) as it stands, row by row, into `values`, the
 * caller's. HS_ERR_INPUT as above, and if the size is another one; HS_ERR_MEMORY. Any thread. */
bool hs_metaimage_read_map(const char *path, uint32_t nx, uint32_t ny, double *values, hs_error *err);

/* The same map as float32 in new memory, which the caller frees. NULL on failure: HS_ERR_INPUT as above, and
 * for a value beyond float32. */
float *hs_metaimage_load_map(const char *path, uint32_t nx, uint32_t ny, hs_error *err);

/*
 * Voxel (x, y, z) was scanned if first(x, y) <= z < end(x, y): what was not becomes 0, and zeros that were
 * scanned become 1 (hs_volume). `first` and `end` are MetaImage files of nx x ny x 1 whole numbers, 0 .. nz;
 * first >= end means that nothing was scanned there.
 *
 * Both maps, one behind the other, which the caller frees; NULL on failure: HS_ERR_INPUT names the file, the
 * pixel and the value that does not fit; HS_ERR_MEMORY. And what they do to a volume of their size.
 */
double *hs_scanned_maps_load(const hs_volume *shape, const char *first, const char *end, hs_error *err);
void hs_scanned_maps_mark(hs_volume *volume, const double *maps);
