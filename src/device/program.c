/* SPDX-License-Identifier: MIT */
#include "device/program.h"

#include "device/timing.h"
#include "kernels_frame.h"
#include "kernels_profile.h"
#include "smartvis/author_programs.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The build log goes to the host's log whole, line by line; the error keeps its first error. */
static sv_status report_build(sv_diag *diag, const sv_device *device, cl_program program, cl_int code) {
    size_t bytes = 0;
    (void)clGetProgramBuildInfo(program, device->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    char *log = calloc(bytes + 1, 1);
    if (log) (void)clGetProgramBuildInfo(program, device->device, CL_PROGRAM_BUILD_LOG, bytes, log, NULL);
    const char *first = NULL;
    for (char *end = log; end && *end;) {
        const char *line = end;
        end += strcspn(end, "\n");
        if (*end) *end++ = '\0';
        if (*line) sva_log(diag, SV_LOG_ERROR, line);
        if (!first && strstr(line, "error")) first = line;
    }
    const sv_status status =
        sva_error(diag, SV_ERR_BUILD, "the kernels do not build: %s (%d): %.300s", sva_cl_name(code), code,
                  first ? first
                  : log ? log
                        : "");
    free(log);
    return status;
}

static sv_status divides_exactly(sv_diag *diag, const sv_device *device, bool *exactly) {
    cl_device_fp_config config = 0;
    const cl_int code =
        clGetDeviceInfo(device->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof config, &config, NULL);
    *exactly = (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    return sva_cl_check(diag, code, "clGetDeviceInfo(CL_DEVICE_SINGLE_FP_CONFIG)");
}

#define SV_KERNEL_CREATE(name)                                                                               \
    p->name = clCreateKernel(program, #name, &code);                                                         \
    if (code != CL_SUCCESS) return sva_cl_check(diag, code, "clCreateKernel(" #name ")");

static sv_status create_profile_kernels(sv_diag *diag, cl_program program, sv_program *p) {
    cl_int code = CL_SUCCESS;
    SV_PROFILE_KERNELS(SV_KERNEL_CREATE)
    return SV_OK;
}

static sv_status create_frame_kernels(sv_diag *diag, cl_program program, sv_program *p) {
    cl_int code = CL_SUCCESS;
    SV_FRAME_KERNELS(SV_KERNEL_CREATE)
    return SV_OK;
}
#undef SV_KERNEL_CREATE

static cl_program find_build(const sv_builds *builds, const unsigned char *source, const char *options) {
    for (uint32_t i = 0; builds && i < builds->count; i++)
        if (builds->of[i].source == source && strcmp(builds->of[i].options, options) == 0)
            return builds->of[i].program;
    return NULL;
}

/* Keeps a program for later. False if there is no room: such a program is compiled again. */
static bool keep_build(sv_builds *builds, const unsigned char *source, const char *options,
                       cl_program program) {
    if (!builds || builds->count == SV_MAX_BUILDS) return false;
    sv_build *b = &builds->of[builds->count++];
    b->source = source;
    b->program = program;
    (void)snprintf(b->options, sizeof b->options, "%s", options);
    return true;
}

void sv_builds_release(sv_builds *builds) {
    for (uint32_t i = 0; i < builds->count; i++) (void)clReleaseProgram(builds->of[i].program);
    *builds = (sv_builds){0};
}

/* Why programs are not kept is told once an activation. */
static void note_build(sv_diag *diag, sv_builds *builds, double seconds, const sva_built *built) {
    if (!builds) return;
    builds->built++;
    builds->kept += built->kept != 0;
    builds->quick += built->quick != 0;
    builds->seconds += seconds;
    if (built->why[0] && !builds->told) sva_say(diag, SV_LOG_WARNING, "activate: %s", built->why);
    builds->told |= built->why[0] != '\0';
}

/* Compiles one source with the options every program has, then `own`; or takes what was compiled so before.
 * Only if `*kept` is false the caller has to release it: kernels keep their program. */
static sv_status compile(sv_diag *diag, const sv_device *device, const unsigned char *source, size_t length,
                         const char *own, cl_program *out, bool *kept) {
    bool exactly = false;
    const sv_status status = divides_exactly(diag, device, &exactly);
    if (status != SV_OK) return status;
    char options[SV_MAX_OPTIONS];
    const int wanted = snprintf(options, sizeof options, "-cl-std=CL1.2 -w%s %s",
                                exactly ? " -cl-fp32-correctly-rounded-divide-sqrt" : "", own);
    assert(wanted > 0 && (size_t)wanted < sizeof options);
    (void)wanted;
    *out = find_build(device->builds, source, options);
    *kept = *out != NULL;
    if (*kept) return SV_OK;
    const char *text = (const char *)source;
    sva_built built;
    const double begun = sv_seconds();
    sva_program_build(device->context, device->device, 1, &text, &length, options, &built);
    *out = built.program;
    note_build(diag, device->builds, sv_seconds() - begun, &built);
    if (built.code != CL_SUCCESS)
        return *out ? report_build(diag, device, *out, built.code)
                    : sva_cl_check(diag, built.code, built.call);
    *kept = keep_build(device->builds, source, options, *out);
    return SV_OK;
}

typedef sv_status create_kernels(sv_diag *diag, cl_program program, sv_program *out);

static sv_status build_part(sv_diag *diag, const sv_device *device, const unsigned char *source,
                            size_t length, const char *options, create_kernels *create, sv_program *out) {
    cl_program program = NULL;
    bool kept = false;
    sv_status status = compile(diag, device, source, length, options, &program, &kept);
    if (status == SV_OK) status = create(diag, program, out);
    if (program && !kept) (void)clReleaseProgram(program);
    return status;
}

sv_status sv_program_build(sv_diag *diag, const sv_device *device, const sv_structure *structure,
                           sv_program *out) {
    *out = (sv_program){0};
    char options[128];
    (void)snprintf(options, sizeof options,
                   "-DSV_SUBSTEPS=%u -DSV_STRIP=%u -DSV_PADDED=%d -DSV_RANGED=%d -DSV_FETCH_AHEAD=%d",
                   structure->substeps, structure->strip, structure->padded, structure->ranged,
                   structure->fetch_ahead);
    sv_status status = build_part(diag, device, sv_kernels_profile, sv_kernels_profile_size, options,
                                  create_profile_kernels, out);
    (void)snprintf(options, sizeof options, "-DSV_SUBSTEPS=%u -DSV_WIDE_SUMS=%d", structure->substeps,
                   structure->wide_sums);
    if (status == SV_OK)
        status = build_part(diag, device, sv_kernels_frame, sv_kernels_frame_size, options,
                            create_frame_kernels, out);
    if (status != SV_OK) sv_program_release(out);
    return status;
}

void sv_program_release(sv_program *program) {
#define SV_KERNEL_RELEASE(name)                                                                              \
    if (program->name) (void)clReleaseKernel(program->name);
    SV_KERNELS(SV_KERNEL_RELEASE)
#undef SV_KERNEL_RELEASE
    *program = (sv_program){0};
}

sv_status sv_kernel_set_build(sv_diag *diag, const sv_device *device, const unsigned char *source,
                              size_t source_size, const char *const *names, const char *options,
                              sv_kernel_set *out) {
    *out = (sv_kernel_set){0};
    cl_program program = NULL;
    bool kept = false;
    sv_status status = compile(diag, device, source, source_size, options, &program, &kept);
    for (uint32_t i = 0; status == SV_OK && names[i]; i++) {
        cl_int code = CL_SUCCESS;
        out->kernel[i] = clCreateKernel(program, names[i], &code);
        status = sva_cl_check(diag, code, names[i]);
    }
    if (program && !kept) (void)clReleaseProgram(program);
    if (status != SV_OK) sv_kernel_set_release(out);
    return status;
}

void sv_kernel_set_release(sv_kernel_set *set) {
    for (uint32_t i = 0; i < SV_MAX_METHOD_KERNELS; i++)
        if (set->kernel[i]) (void)clReleaseKernel(set->kernel[i]);
    *set = (sv_kernel_set){0};
}
