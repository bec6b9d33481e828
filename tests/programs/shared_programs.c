/* SPDX-License-Identifier: MIT */
#include "programs/shared_programs.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 256 };

/* A program that was built. */
typedef struct {
    cl_program program;
    char *source, *options;
} built;

/* A program that stands for one that was built before. */
typedef struct {
    cl_program program, stands_for;
} alias;

static struct {
    cl_context context;
    built built[MOST];
    alias aliases[MOST];
    size_t built_count, next_alias;
} shared;

static const char *more_options;

void shared_programs_options(const char *options) {
    more_options = options;
}

#define REAL(name)                                                                                           \
    static __typeof__(&name) real;                                                                           \
    if (!real) *(void **)(&real) = dlsym(RTLD_NEXT, #name)

void shared_programs_begin(cl_context context) {
    if (!shared.context) shared.context = context;
}

void shared_programs_end(cl_context context) {
    if (shared.context != context) return;
    for (size_t i = 0; i < shared.built_count; i++) {
        (void)clReleaseProgram(shared.built[i].program);
        free(shared.built[i].source);
        free(shared.built[i].options);
    }
    memset(&shared, 0, sizeof shared);
}

/* The program's source, or NULL if its programs are not shared. */
static char *source_of(cl_program program) {
    cl_context context = NULL;
    size_t bytes = 0;
    if (!shared.context) return NULL;
    (void)clGetProgramInfo(program, CL_PROGRAM_CONTEXT, sizeof(cl_context), &context, NULL);
    if (context != shared.context) return NULL;
    if (clGetProgramInfo(program, CL_PROGRAM_SOURCE, 0, NULL, &bytes) != CL_SUCCESS) return NULL;
    char *source = calloc(bytes + 1, 1);
    if (source && clGetProgramInfo(program, CL_PROGRAM_SOURCE, bytes, source, NULL) == CL_SUCCESS)
        return source;
    free(source);
    return NULL;
}

static alias *alias_of(cl_program program) {
    for (size_t i = 0; i < MOST; i++)
        if (shared.aliases[i].program == program) return &shared.aliases[i];
    return NULL;
}

static void keep(cl_program program, char *source, const char *options) {
    char *copy = strdup(options);
    if (!copy || shared.built_count == MOST || clRetainProgram(program) != CL_SUCCESS) {
        free(copy);
        free(source);
        return;
    }
    shared.built[shared.built_count++] = (built){program, source, copy};
}

cl_int clBuildProgram(cl_program program, cl_uint n, const cl_device_id *devices, const char *options,
                      void(CL_CALLBACK *notify)(cl_program, void *), void *data) {
    REAL(clBuildProgram);
    const char *with = options ? options : "";
    if (more_options) {
        char both[1024];
        const int length = snprintf(both, sizeof both, "%s %s", with, more_options);
        if (length < 0 || (size_t)length >= sizeof both) abort();
        return real(program, n, devices, both, notify, data);
    }
    char *source = source_of(program);
    for (size_t i = 0; source && i < shared.built_count; i++)
        if (strcmp(shared.built[i].options, with) == 0 && strcmp(shared.built[i].source, source) == 0) {
            free(source);
            shared.aliases[shared.next_alias++ % MOST] = (alias){program, shared.built[i].program};
            return CL_SUCCESS;
        }
    const cl_int code = real(program, n, devices, options, notify, data);
    if (source && code == CL_SUCCESS) keep(program, source, with);
    if (source && code != CL_SUCCESS) free(source);
    return code;
}

cl_kernel clCreateKernel(cl_program program, const char *name, cl_int *errcode) {
    REAL(clCreateKernel);
    const alias *a = alias_of(program);
    return real(a ? a->stands_for : program, name, errcode);
}

/* After the last release a later program may lie at the same address. */
cl_int clReleaseProgram(cl_program program) {
    REAL(clReleaseProgram);
    alias *a = alias_of(program);
    cl_uint references = 0;
    if (a) (void)clGetProgramInfo(program, CL_PROGRAM_REFERENCE_COUNT, sizeof references, &references, NULL);
    if (a && references <= 1) *a = (alias){NULL, NULL};
    return real(program);
}
