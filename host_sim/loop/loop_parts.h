/* SPDX-License-Identifier: MIT */
/* Parts of the scan loop, used by hs_loop*.c and hs_eval*.c only: the slabs in their carrier, and the
 * plugin's share of a frame. */
#ifndef HS_LOOP_PARTS_H
#define HS_LOOP_PARTS_H

#include "loop/loop.h"

/* ----------------------------------------------------------------------------------------------- slabs -- */

/* A whole low-resolution volume as slabs, each in memory of its own: the ABI wants a slab unchanged until the
 * frame's commands have run. */
typedef struct {
    hs_slab_layout layout;
    uint32_t carrier;    /* SV_CARRIER_* */
    uint32_t count;      /* slabs */
    size_t stride;       /* bytes from one slab to the next, a multiple of HS_SLAB_ALIGN */
    cl_mem buffer;       /* device, all slabs: what scan conversion writes */
    cl_mem *images;      /* SV_CARRIER_IMAGE: one 2D image a slab */
    uint8_t *memory;     /* SV_CARRIER_HOST: a copy of `buffer`, aligned to HS_SLAB_ALIGN */
    size_t memory_bytes; /* count * stride */
} hs_slabs;

#define HS_SLAB_ALIGN 4096u /* bytes: a page, so that a plugin may read host memory in place */

bool hs_slabs_create(hs_slabs *slabs, const hs_cl *cl, const hs_slab_layout *layout, uint32_t carrier,
                     hs_error *err);
void hs_slabs_destroy(hs_slabs *slabs);

/* Enqueues the conversion of every slab and its way into the carrier; does not wait. */
bool hs_slabs_convert(const hs_slabs *slabs, const hs_cl *cl, hs_scan_converter *converter,
                      const hs_device_volume *source, const hs_camera *camera, hs_error *err);

/* Slab `index` as the plugin gets it. */
void hs_slabs_describe(const hs_slabs *slabs, uint32_t index, sv_slab *out);

/* ------------------------------------------------------------------------------------------- the plugin --
 */

/* The plugin's side of the loop. It fails softly: `error` keeps the first failure, and the loop goes on. */
typedef struct {
    const hs_plugin *plugin; /* NULL: none */
    const hs_cl *cl;
    const hs_slabs *slabs;
    bool own_queue;
    bool active;
    bool want_status;                    /* asks for the status map as well */
    bool want_confidence;                /* asks for the confidence, if the plugin has it */
    const sv_ext_confidence *confidence; /* NULL: the active plugin gives no such map */
    const sv_param_value *values;
    uint32_t value_count;
    size_t pixels;     /* of the depthmap */
    cl_mem depth;      /* device, float32: what the renderer reads */
    float *host_depth; /* own queue: where the plugin writes */
    cl_mem sure;       /* device, float32: the confidence, for the renderer */
    float *host_sure;  /* own queue: where the plugin writes it */
    cl_kernel check;   /* counts confidences that are out of range, into `wrong` */
    cl_mem wrong;
    cl_int wrong_count;      /* of the last frame; valid when the queue has run */
    uint8_t *status;         /* SV_POINT_* */
    sv_stats stats;          /* written by the queue; valid when it has run */
    sv_points_report points; /* the same; size is 0 if the plugin does not have the extension */
    hs_error error;          /* the plugin's first failure */
    hs_error sure_error;     /* the first failure to give a usable confidence; not among the others */
} hs_clipper;

/* Makes the memory and activates the plugin. False only for failures of the host's own. */
bool hs_clipper_create(hs_clipper *clipper, const hs_cl *cl, const hs_slabs *slabs, const hs_plugin *plugin,
                       const hs_loop_options *options, hs_error *err);
void hs_clipper_destroy(hs_clipper *clipper);

/* One frame: begin, every slab, end; waits for the queue. On true, frame->clipped tells whether `depth` may
 * be used, and frame->sure whether `sure` may. The slabs must be complete on the device. */
bool hs_clipper_frame(hs_clipper *clipper, uint32_t index, hs_frame *frame, hs_error *err);

/* The last successful frame with another value for one parameter that is flagged SV_PARAM_ADJUST. */
bool hs_clipper_adjust(hs_clipper *clipper, sv_param_value value, hs_frame *frame, hs_error *err);

/* The confidence of a frame (host_sim/loop/loop_sure.c): its memory, once the plugin is active; between the
 * plugin's last call and the wait, which settles it too; and what came of it: a map that may be used. */
bool hs_clipper_sure_create(hs_clipper *clipper, hs_error *err);
void hs_clipper_sure_destroy(hs_clipper *clipper);
bool hs_clipper_sure_ask(hs_clipper *clipper, bool *asked, hs_error *err);
bool hs_clipper_sure_settle(hs_clipper *clipper, bool asked);

/* Switches the plugin's own timing on or off; false if it has none. */
bool hs_clipper_time_stages(hs_clipper *clipper, bool on);
/* Its times for the last frame; false if it has none. */
bool hs_clipper_stage_times(hs_clipper *clipper, sv_stage_times *times);

/* ------------------------------------------------------------------------------------------------- loop --
 */

struct hs_loop {
    const hs_cl *cl;
    const hs_source *source;
    hs_loop_options options;
    hs_camera box; /* one box for the whole run: the format is fixed at activation */
    hs_slabs slabs;
    hs_clipper clipper;
    hs_device_volume *volume;
    uint32_t resident; /* index into source->volumes of the volume on the device */
    hs_scan_converter *converter;
    hs_dvr *dvr;
    cl_mem rgba;        /* the picture */
    cl_mem termination; /* termination depths; written for views only */
    double *times;      /* HS_STAGE_COUNT rows of options.frames */
};

/* The camera of frame `index`, in the loop's box. */
void hs_loop_camera(const hs_loop *loop, uint32_t index, hs_camera *camera);

/* Enqueues a picture of `volume` into loop->rgba, and its termination depths if `with_termination`. `frame`
 * tells which of the plugin's maps may be used; NULL: none, the full volume. */
bool hs_loop_render(hs_loop *loop, const hs_device_volume *volume, const hs_camera *camera,
                    const hs_frame *frame, bool with_termination, hs_error *err);

#endif
