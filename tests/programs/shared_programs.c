/* SPDX-License-Identifier: MIT */
#include "programs/shared_programs.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PROGRAMS = 256 };

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
    built built[MAX_PROGRAMS];
    alias aliases[MAX_PROGRAMS];
    size_t built_count, next_alias;
} shared;

/* Guards `shared`: instances of a plugin may be activated at once. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

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
    const bool any = getenv("SV_SHARE_PROGRAMS") != NULL;
    if (!shared.context && !any) return NULL;
    (void)clGetProgramInfo(program, CL_PROGRAM_CONTEXT, sizeof(cl_context), &context, NULL);
    if (any) shared_programs_begin(context);
    if (context != shared.context) return NULL;
    /* One that was made of a binary has none. */
    if (clGetProgramInfo(program, CL_PROGRAM_SOURCE, 0, NULL, &bytes) != CL_SUCCESS || bytes < 2) return NULL;
    char *source = calloc(bytes + 1, 1);
    if (source && clGetProgramInfo(program, CL_PROGRAM_SOURCE, bytes, source, NULL) == CL_SUCCESS)
        return source;
    free(source);
    return NULL;
}

static alias *alias_of(cl_program program) {
    for (size_t i = 0; i < MAX_PROGRAMS; i++)
        if (shared.aliases[i].program == program) return &shared.aliases[i];
    return NULL;
}

static void keep(cl_program program, char *source, const char *options) {
    char *copy = strdup(options);
    if (!copy || shared.built_count == MAX_PROGRAMS || clRetainProgram(program) != CL_SUCCESS) {
        free(copy);
        free(source);
        return;
    }
    shared.built[shared.built_count++] = (built){program, source, copy};
}

static bool take_built(cl_program program, const char *source, const char *options) {
    for (size_t i = 0; i < shared.built_count; i++)
        if (strcmp(shared.built[i].options, options) == 0 && strcmp(shared.built[i].source, source) == 0) {
            shared.aliases[shared.next_alias++ % MAX_PROGRAMS] = (alias){program, shared.built[i].program};
            return true;
        }
    return false;
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
    (void)pthread_mutex_lock(&lock);
    char *source = source_of(program);
    cl_int code = CL_SUCCESS;
    if (source && take_built(program, source, with)) {
        free(source);
    } else {
        code = real(program, n, devices, options, notify, data);
        if (source && code == CL_SUCCESS) keep(program, source, with);
        if (source && code != CL_SUCCESS) free(source);
    }
    (void)pthread_mutex_unlock(&lock);
    return code;
}

cl_kernel clCreateKernel(cl_program program, const char *name, cl_int *errcode) {
    REAL(clCreateKernel);
    (void)pthread_mutex_lock(&lock);
    const alias *a = alias_of(program);
    if (a) program = a->stands_for;
    (void)pthread_mutex_unlock(&lock);
    return real(program, name, errcode);
}

/* After the last release a later program may lie at the same address. */
cl_int clReleaseProgram(cl_program program) {
    REAL(clReleaseProgram);
    (void)pthread_mutex_lock(&lock);
    alias *a = alias_of(program);
    cl_uint references = 0;
    if (a) (void)clGetProgramInfo(program, CL_PROGRAM_REFERENCE_COUNT, sizeof references, &references, NULL);
    if (a && references <= 1) *a = (alias){NULL, NULL};
    (void)pthread_mutex_unlock(&lock);
    return real(program);
}
