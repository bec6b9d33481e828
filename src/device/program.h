/* SPDX-License-Identifier: MIT */
/* Builds the embedded kernels for one structure (-D options) and holds the kernel objects. One
 * set per instance. */
#pragma once

#include "device/device.h"

/* The programs that one activation has compiled, so that its self-tests and its pipeline make their kernels
 * of the same ones: even a driver that keeps compiled kernels reads a source anew for every program. */
enum { SV_MAX_BUILDS = 8, SV_MAX_OPTIONS = 256 };
typedef struct {
    const unsigned char *source;
    cl_program program;
    char options[SV_MAX_OPTIONS];
} sv_build;
struct sv_builds {
    sv_build of[SV_MAX_BUILDS];
    uint32_t count;
    uint32_t built; /* programs, */
    uint32_t kept;  /* of which so many came from files, */
    uint32_t quick; /* and so many were compiled without optimisation, */
    double seconds; /* in so long by the wall clock */
    bool told;      /* why not more are kept */
};

/* Releases the programs; their kernels stay. A zeroed struct may be passed. */
void sv_builds_release(sv_builds *builds);

/* Every kernel by its name in cl/ that methods on points need: the ray profiles, a program of their own, and
 * what a frame does with them. */
#define SV_PROFILE_KERNELS(X) X(profile_strip) X(profile_rays)
#define SV_FRAME_KERNELS(X)                                                                                  \
    X(scanned_planes)                                                                                        \
    X(frame_end)                                                                                             \
    X(band_survey)                                                                                           \
    X(band_level)                                                                                            \
    X(band_points)                                                                                           \
    X(band_mean)                                                                                             \
    X(band_record)                                                                                           \
    X(rays_clear)                                                                                            \
    X(rays_survey)                                                                                           \
    X(rays_points)                                                                                           \
    X(rays_columns)                                                                                          \
    X(rays_means)                                                                                            \
    X(blend)
#define SV_KERNELS(X) SV_PROFILE_KERNELS(X) SV_FRAME_KERNELS(X)

typedef struct {
#define SV_KERNEL_FIELD(name) cl_kernel name;
    SV_KERNELS(SV_KERNEL_FIELD)
#undef SV_KERNEL_FIELD
} sv_program;

/* The kernels of a program of its own, by their place in its list of names. */
#define SV_MAX_METHOD_KERNELS 36
typedef struct {
    cl_kernel kernel[SV_MAX_METHOD_KERNELS];
} sv_kernel_set;

/* Builds `source` and makes the kernels of the NULL-terminated list. */
sv_status sv_kernel_set_build(sv_diag *diag, const sv_device *device, const unsigned char *source,
                              size_t source_size, const char *const *names, const char *options,
                              sv_kernel_set *out);

/* Safe on a zeroed struct. */
void sv_kernel_set_release(sv_kernel_set *set);

/* What changes the code; the same names stand in cl/. */
typedef struct {
    uint32_t substeps; /* SV_SUBSTEPS */
    uint32_t strip;    /* SV_STRIP: 16, 32, 64 */
    bool padded;       /* SV_PADDED */
    bool ranged;       /* SV_RANGED */
    bool wide_sums;    /* SV_WIDE_SUMS */
    bool fetch_ahead;  /* SV_FETCH_AHEAD */
} sv_structure;

/* Builds the program. SV_ERR_BUILD: the build log is in the host's log. */
sv_status sv_program_build(sv_diag *diag, const sv_device *device, const sv_structure *structure,
                           sv_program *out);

/* Safe on a zeroed struct. */
void sv_program_release(sv_program *program);
