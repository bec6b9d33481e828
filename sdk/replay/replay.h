/* SPDX-License-Identifier: MIT */
/* Plays a recording (sdk/record/) into a plugin, and tells where the two part. */
#pragma once

#include "guarded/guarded.h"
#include "opencl/host_cl.h"
#include "record/rec.h"
#include "record/rec_item.h"

enum { RP_MAX_SETS = 32, RP_MAX_TOLD = 12 };
#define RP_LAST UINT32_MAX

typedef struct {
    const char *file, *plugin, *id;
    const char *sets[RP_MAX_SETS]; /* KEY=VALUE instead of what was recorded */
    uint32_t set_count;
    uint32_t carrier; /* SV_CARRIER_*; 0: as it was recorded */
    bool own_queue, verbose, list;
    double seconds;         /* that it may play, without the first activate */
    const char *out;        /* folder for the files of `frame`, or NULL */
    const char *show;       /* folder for a page of all frames, or NULL */
    uint32_t frame;         /* from 0; RP_LAST */
    hs_guard_options guard; /* memory_bytes bounds what an activation takes, with a guard or without */
} rp_options;

/* replay_bounds: sets what nobody has chosen (0) of the memory and the seconds that a recording may cost. It
 * pays for them with its bytes: a file from elsewhere asks for any format and any number of frames. */
void rp_set_bounds(rp_options *o);

/* Bytes of the recording; 0: it cannot be read. */
double rp_file_bytes(const rp_options *o);

/* True if an activation whose slabs have so many bytes stays within the bounds, with what the plugin says
 * that it needs; else HS_ERR_INPUT. */
bool rp_pays(const rp_options *o, const hs_plugin *plugin, const sv_format *format, uint64_t bytes,
             hs_error *err);

/* ------------------------------------------------------------------------------- replay_hand: the host -- */
/* What a plugin is handed: slabs as they were recorded, in memory or objects, and room for results. */

typedef struct {
    const hs_plugin *plugin;
    hs_handover way;
    hs_cl cl;         /* queue NULL: not needed so far */
    sv_format format; /* as the plugin was given it; width 0: inactive */
    uint8_t *memory;  /* of all slabs of a frame */
    size_t bytes, used;
    bool guards;     /* the memory is the guard's */
    cl_mem *objects; /* of the frame: ranges and slabs, at most one for each slice */
    uint32_t object_count;
    sv_scanned *ranges;
    float *depth; /* rows `row` bytes apart */
    size_t row;
    uint8_t *status;
    cl_mem depth_object; /* of the activation */
    bool in_object;      /* the result under way goes there */
    sv_stats stats;
} rp_hand;

/* Chooses the way and makes the format and its memory. The recorded one is `item`'s. The plugin is inactive.
 * HS_ERR_INPUT if it takes more than o->guard.memory_bytes. */
bool rp_hand_format(rp_hand *h, const rp_options *o, const rec_item *item, hs_error *err);
bool rp_hand_frame(rp_hand *h, const rec_item *item, sv_frame *frame, hs_error *err);
bool rp_hand_slab(rp_hand *h, const rec_item *item, sv_slab *slab, hs_error *err);
bool rp_hand_result(rp_hand *h, const rec_item *item, sv_result *result, hs_error *err);
/* Behind end or adjust: the queue has run, and the depths are in h->depth. */
bool rp_hand_collect(rp_hand *h, hs_error *err);
/* What lasts from activate to deactivate, and all of it. The plugin is inactive. */
void rp_hand_release(rp_hand *h);
void rp_hand_close(rp_hand *h);

/* -------------------------------------------------------------------------------------- replay_play -- */

/* One frame, for its files. */
typedef struct {
    uint32_t number;
    sv_format format;
    uint8_t *voxels; /* NULL: none was kept */
    sv_scanned *ranges;
    float *depth; /* what the plugin made of it here */
    uint8_t *status;
    sv_status outcome;
} rp_frame;
void rp_frame_free(rp_frame *frame);

typedef struct {
    char id[256], version[64]; /* of the recorded plugin */
    uint32_t frames, calls,
        left_out;                /* left out: calls that broke a rule, of which only the status was kept */
    uint32_t maps, lines;        /* that were compared */
    uint32_t differences;        /* what was not the same */
    char told[RP_MAX_TOLD][400]; /* the first of it */
    uint64_t voxel_bytes;        /* of all slabs, unpacked */
    double recorded_ms, ms;      /* of all begins, slabs and ends */
    bool maps_kept;
    bool fresh; /* the first frame continues none that is not there */
    rp_frame drawn;
} rp_report;

/* Plays all of it. HS_ERR_INPUT if the recording is cut off or damaged (what came before was played),
 * HS_ERR_PLUGIN if the plugin cannot be made or its process ended, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool rp_play(const rp_options *o, rp_report *report, hs_error *err);

/* -------------------------------------------------------------------------------------- replay_list -- */

/* Prints every call of a recording and plays none. */
bool rp_list(const char *file, hs_error *err);

/* ------------------------------------------------------------------------------------- replay_show -- */

/* Writes index.html into the folder: calls that failed, lines of the log, and what frames came to, with the
 * recorded depthmaps. Plays none. A recording that is cut off, or takes longer than o->seconds, is shown as
 * far as it goes: HS_ERR_INPUT. */
bool rp_show(const rp_options *o, hs_error *err);

/* ----------------------------------------------------------------------------------- replay_export -- */

/* Writes the frame into the folder as host_sim run takes it, volume.mha and map.mha, and prints how. */
bool rp_export(const rp_options *o, const rp_report *report, hs_error *err);
