/* SPDX-License-Identifier: MIT */
/* How an OpenCL function is interposed: what cl_spy.c and cl_spy_more.c have in common. */
#ifndef SV_CL_SPY_CALL_H
#define SV_CL_SPY_CALL_H

#include "validate/spy/cl_spy_kind.h"

#include <CL/cl.h>
#include <dlfcn.h>
#include <stdbool.h>

/* What becomes of a call. */
typedef struct {
    bool ours, fails;
} spy_verdict;

/* Counts a call; `caller` is where it returns to. */
spy_verdict spy_enter(const char *name, spy_kind kind, const void *caller);

/* What a failing call returns. */
cl_int spy_code(void);

/* The library has so many objects more, or fewer. */
void spy_alive(int32_t objects);

/* It made a blocking call. */
void spy_blocks(const char *name);

/* It enqueued something; `event` is where it asked for an event, or NULL. */
void spy_enqueued(const cl_event *event);

/* The real function, looked up once. A runtime of an older OpenCL may not have it. */
#define SPY_REAL(name)                                                                                       \
    static __typeof__(&name) real;                                                                           \
    if (!real) *(void **)(&real) = dlsym(RTLD_NEXT, #name)
#define SPY_ENTER(name, kind) const spy_verdict v = spy_enter(#name, kind, __builtin_return_address(0))

/* Calls that return a code. */
#define SPY_CODE_CALL(name, kind, parameters, arguments)                                                     \
    cl_int name parameters {                                                                                 \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails) return spy_code();                                                                      \
        return real ? real arguments : CL_INVALID_OPERATION;                                                 \
    }
/* Calls that return an object. */
#define SPY_OBJECT_CALL(type, name, kind, parameters, arguments)                                             \
    type name parameters {                                                                                   \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, kind);                                                                               \
        if (v.fails || !real) {                                                                              \
            if (errcode) *errcode = v.fails ? spy_code() : CL_INVALID_OPERATION;                             \
            return NULL;                                                                                     \
        }                                                                                                    \
        type object = real arguments;                                                                        \
        if (v.ours && object) spy_alive(1);                                                                  \
        return object;                                                                                       \
    }
#define SPY_CREATE_CALL(type, name, parameters, arguments)                                                   \
    SPY_OBJECT_CALL(type, name, SPY_CREATE, parameters, arguments)
#define SPY_RELEASE_CALL(name, type)                                                                         \
    cl_int name(type object) {                                                                               \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_RELEASE);                                                                        \
        if (v.ours) spy_alive(-1);                                                                           \
        return real(object);                                                                                 \
    }
#define SPY_RETAIN_CALL(name, type)                                                                          \
    cl_int name(type object) {                                                                               \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_RETAIN);                                                                         \
        if (v.fails) return spy_code();                                                                      \
        if (v.ours) spy_alive(1);                                                                            \
        return real(object);                                                                                 \
    }
/* Commands: their last parameter is the event. */
#define SPY_ENQUEUE_CALL(name, blocks, parameters, arguments)                                                \
    cl_int name parameters {                                                                                 \
        SPY_REAL(name);                                                                                      \
        SPY_ENTER(name, SPY_ENQUEUE);                                                                        \
        if (v.ours && (blocks)) spy_blocks(#name);                                                           \
        if (v.fails) return spy_code();                                                                      \
        const cl_int code = real arguments;                                                                  \
        if (v.ours && code == CL_SUCCESS) spy_enqueued(event);                                               \
        return code;                                                                                         \
    }

#endif
