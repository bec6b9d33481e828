/* SPDX-License-Identifier: MIT */
/* The end of a frame: bone threshold, initial points, reconstruction, S(q) and the results. Enqueues; the
 * caller has validated everything. */
#ifndef SV_PIPELINE_END_H
#define SV_PIPELINE_END_H

#include "frame/pipeline.h"
#include "smartvis/points.h"

sv_status sv_pipeline_end(sv_pipeline *pipeline, float q);    /* up to the surfaces */
sv_status sv_pipeline_adjust(sv_pipeline *pipeline, float q); /* what another q asks for before the output */
sv_status sv_pipeline_output(sv_pipeline *pipeline, float q, const sv_result *result); /* S(q) and the rest */

/* Enqueues a read of what the points stage found out; valid when the queue has run. */
sv_status sv_pipeline_read_points(sv_pipeline *pipeline, sv_points_report *out);

/* The last frame's confidence, for a method that gives one: to `map` (width * height) or, if that is NULL, to
 * `object` from byte `offset` on. Waits only if `wait` is set. */
sv_status sv_pipeline_confidence(sv_pipeline *pipeline, float *map, cl_mem object, uint64_t offset,
                                 bool wait);

#endif
