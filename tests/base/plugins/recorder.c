/* SPDX-License-Identifier: MIT */
/* A plugin on the CPU that clips nothing and keeps what its host told it (record.h). CMakeLists.txt
 * compiles variants with other RECORDER_FEATURES and RECORDER_VOXELS. */
#include "record.h"
#include "smartvis/author.h"

#ifndef RECORDER_FEATURES
#define RECORDER_FEATURES (SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_PROBE)
#endif

static record seen = {.size = sizeof seen}; /* one instance is all that a test makes */

static sv_status finish(sva *a, float *depth) {
    seen.frames++;
    seen.format = a->format;
    seen.frame = a->frame;
    for (size_t i = 0; i < sva_rays(a); i++) {
        depth[i] = 0.0f;
        if (a->scanned && i < RECORD_RAYS) seen.scanned[i] = a->scanned[i];
    }
    return SV_OK;
}

static const void *extension(const sva *a, const char *id) {
    return strcmp(id, RECORD_ID) == 0 ? &seen : NULL;
}

#ifdef RECORDER_OTHER_VOXELS
static const char *const none[] = {NULL};
static const sv_descriptor descriptor = {.size = sizeof descriptor,
                                         .carriers = SV_BIT(SV_CARRIER_HOST),
                                         .id = "org.smartvis.test.recorder",
                                         .name = "Recorder",
                                         .vendor = "SmartVis tests",
                                         .version = "1.0.0",
                                         .summary = "Reads 16-bit voxels only.",
                                         .voxel_types = SV_BIT(SV_VOXEL_U16),
                                         .queues = SV_QUEUE_OWN,
                                         .extensions = none};
#else
static const sv_descriptor descriptor =
    SVA_DESCRIPTOR("org.smartvis.test.recorder", "Recorder", "SmartVis tests", "1.0.0",
                   "Keeps what its host told it.", RECORDER_FEATURES);
#endif

static const sva_method method = {.descriptor = &descriptor, .finish = finish, .extension = extension};
SVA_ENTRY(method);
