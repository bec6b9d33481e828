/* SPDX-License-Identifier: MIT */
/*
 * Between a library under test and OpenCL: counts its calls, and makes one of them fail. A program that
 * links spy/cl_spy.c defines clCreateBuffer and so on itself; exported, these come before those of the OpenCL
 * loader when a plugin is loaded with dlopen. On Windows they are written into the library's import table.
 * Only calls that return into the watched library count, so those of the program, of the loader and of the
 * driver do not. One thread only.
 */
#ifndef SV_CL_SPY_H
#define SV_CL_SPY_H

#include <CL/cl.h>
#include <stdbool.h>
#include <stdint.h>

/* The kinds of OpenCL calls that are told apart. */
typedef enum {
    SPY_QUERY,   /* clGet...Info, clSetKernelArg, clFlush: nothing is made, nothing waits */
    SPY_ENQUEUE, /* clEnqueue... */
    SPY_CREATE,  /* clCreate... */
    SPY_RETAIN,  /* clRetain... */
    SPY_RELEASE, /* clRelease... */
    SPY_BUILD,   /* clBuildProgram, clCompileProgram, clLinkProgram */
    SPY_WAIT,    /* clFinish, clWaitForEvents */
    SPY_KINDS
} spy_kind;

/* Watches the library that holds `address`, and forgets all counts. */
void spy_watch(const void *address);

/* Counts start again at 0, and no call fails. Live objects are kept. */
void spy_reset(void);

uint32_t spy_count(spy_kind kind);
uint32_t spy_calls(void);             /* of all kinds */
const char *spy_first(spy_kind kind); /* name of the first of these calls, "" if there was none */
uint32_t spy_blocking(void);          /* reads, writes and maps that were told to block */
const char *spy_first_blocking(void);
int32_t spy_live(void); /* objects and events the library has made or retained and not yet released */
bool spy_pending(void); /* it has enqueued something since its last clFinish */

/* The nth call from now on (1, 2, ...; clRelease... is not counted) fails with `code`; 0: none. A clFinish
 * that fails does finish: commands in flight with nobody waiting are no error OpenCL can report. */
void spy_fail(uint32_t nth, cl_int code);
/* The same, and all calls after it until the next spy_fail: the device is lost. */
void spy_lose(uint32_t nth, cl_int code);
const char *spy_failed(void); /* the first call that was made to fail, or NULL */

/* Launches of a kernel with a local size that it had not been launched with before the last spy_reset: PoCL
 * compiles those at launch. */
uint32_t spy_cold(void);

/* Such launches before it that have not been made again since: compiled, and nobody needed it. Kernels that
 * are gone do not count. */
uint32_t spy_idle(void);

/* The nth read from now on (1, 2, ...) brings other bytes than the device has; 0: none. spy_spoiled: it came
 * to that. */
void spy_spoil(uint32_t nth);
bool spy_spoiled(void);

/* Bytes of the buffers that the library has made and not yet released, those around the host's memory left
 * out. */
uint64_t spy_live_bytes(void);

/* What OpenCL does. Times are hs_now's. */
typedef struct {
    char name[64];             /* of the kernel that runs; where some run at once, of one of them */
    _Atomic uint64_t since_ns; /* when that began; 0: none runs */
    _Atomic uint32_t busy;     /* calls that have not come back, and launches not begun: they may compile */
    _Atomic uint64_t idle_ns;  /* when the last of these was over */
} spy_work;

/* From now on what OpenCL does for the library at `address` is told here, on any thread. A kernel runs when
 * its runtime has compiled it. NULL: nowhere. */
void spy_tell_work(const void *address, spy_work *out);

/* What the library hears of the device's memory and of the largest buffer; 0: the truth. */
void spy_device_memory(uint64_t memory, uint64_t largest_buffer);

/* ---------------------------------------------- for the functions of cl_spy_calls.c, which stand in for
 * OpenCL's -- */

/* What becomes of a call. */
typedef struct {
    bool ours, fails;
    spy_work *told;
} spy_verdict;

/* Counts a call; `caller` is where it returns to. Then it is over. */
spy_verdict spy_enter(const char *name, spy_kind kind, const void *caller);
void spy_leave(const spy_verdict *v);

/* What a failing call returns. */
cl_int spy_code(void);

/* The library has so many objects more, or fewer. */
void spy_alive(int32_t objects);

/* It made a blocking call. */
void spy_blocks(const char *name);

/* It enqueued something; `event` is where it asked for an event, or NULL. */
void spy_enqueued(const cl_event *event);

/* It has made a buffer (1), or released one (-1). */
void spy_holds(cl_mem buffer, int32_t sign);

/* It has launched a kernel; and a kernel that is gone has been launched with nothing: another may come to lie
 * at its address. */
void spy_launches(cl_kernel kernel, cl_uint dims, const size_t *local);
void spy_forgets(cl_kernel kernel);

/* The launch whose event this is: told, should that be wanted. NULL: no event was asked for. */
bool spy_wants_work(void);
void spy_follows(cl_kernel kernel, cl_event event);

/* After its read of `rows` rows: waits for it and changes every byte that it brought, if this is its turn. */
void spy_has_read(cl_command_queue q, void *to, size_t row_bytes, size_t rows, size_t pitch);

/* Told when the plugin's queue has finished. */
void spy_finished(void);

/* What it hears of the device's memory, if that is not to be the truth. */
void spy_tells_memory(cl_device_info what, void *out);

#endif
