/* SPDX-License-Identifier: MIT */
#include "validate/spy/cl_spy.h"

#include "core/progress.h"
#include "validate/spy/library.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { SPY_LAUNCHED = 1024 };

static struct {
    library_range watched;
    uint32_t counts[SPY_KINDS], blocking;
    const char *first[SPY_KINDS], *first_blocking; /* the first call that was counted */
    int32_t live;
    bool pending;
    uint32_t fail_in; /* calls until the one that fails; 0: none */
    cl_int code;
    const char *failed;
    bool lost; /* all calls behind the first failing one fail, too */
    uint64_t live_bytes, memory, largest_buffer;
    uint32_t spoil_in; /* reads until the one that is spoiled; 0: none */
    bool spoiled;
    struct {
        cl_kernel kernel;
        size_t local[3];
        bool used;            /* since the last reset */
    } launched[SPY_LAUNCHED]; /* those of live kernels; the first `warm` ones before the last reset */
    size_t launched_count, warm;
    uint32_t cold;
} spy;
static _Atomic(spy_work *) work;

void spy_watch(const void *address) {
    memset(&spy, 0, sizeof spy);
    spy.watched = library_range_of(address);
    library_redirect(address);
}

void spy_reset(void) {
    memset(spy.counts, 0, sizeof spy.counts);
    spy.blocking = spy.fail_in = spy.spoil_in = spy.cold = 0;
    spy.failed = NULL;
    spy.spoiled = false;
    spy.warm = spy.launched_count;
    for (size_t i = 0; i < spy.launched_count; i++) spy.launched[i].used = false;
}

uint32_t spy_count(spy_kind kind) {
    return spy.counts[kind];
}
uint32_t spy_calls(void) {
    uint32_t calls = 0;
    for (int kind = 0; kind < SPY_KINDS; kind++) calls += spy.counts[kind];
    return calls;
}
const char *spy_first(spy_kind kind) {
    return spy.counts[kind] > 0 ? spy.first[kind] : "";
}
uint32_t spy_blocking(void) {
    return spy.blocking;
}
const char *spy_first_blocking(void) {
    return spy.blocking > 0 ? spy.first_blocking : "";
}
int32_t spy_live(void) {
    return spy.live;
}
bool spy_pending(void) {
    return spy.pending;
}
const char *spy_failed(void) {
    return spy.failed;
}

uint64_t spy_live_bytes(void) {
    return spy.live_bytes;
}
void spy_device_memory(uint64_t memory, uint64_t largest_buffer) {
    spy.memory = memory;
    spy.largest_buffer = largest_buffer;
}
uint32_t spy_cold(void) {
    return spy.cold;
}
uint32_t spy_idle(void) {
    uint32_t idle = 0;
    for (size_t i = 0; i < spy.launched_count; i++) idle += !spy.launched[i].used;
    return idle;
}
bool spy_spoiled(void) {
    return spy.spoiled;
}
void spy_spoil(uint32_t nth) {
    spy.spoil_in = nth;
    spy.spoiled = false;
}

void spy_fail(uint32_t nth, cl_int code) {
    spy.fail_in = nth;
    spy.code = code;
    spy.failed = NULL;
    spy.lost = false;
}

void spy_lose(uint32_t nth, cl_int code) {
    spy_fail(nth, code);
    spy.lost = true;
}

/* ---- calls under way */
static uint64_t now_ns(void) {
    return (uint64_t)(hs_now() * 1e9);
}

static void begins_work(spy_work *out) {
    if (out) atomic_fetch_add(&out->busy, 1);
}

/* The time comes first: who sees nothing under way sees since when. */
static void ends_work(spy_work *out) {
    if (!out) return;
    atomic_store(&out->idle_ns, now_ns());
    atomic_fetch_sub(&out->busy, 1);
}

spy_verdict spy_enter(const char *name, spy_kind kind, const void *caller) {
    spy_verdict v = {.told = atomic_load(&work)};
    begins_work(v.told);
    v.ours = library_range_holds(spy.watched, caller);
    if (!v.ours) return v;
    if (spy.counts[kind]++ == 0) spy.first[kind] = name;
    if (kind == SPY_RELEASE || spy.fail_in == 0 || spy.fail_in-- > 1) return v;
    if (spy.lost) spy.fail_in = 1;
    if (!spy.failed) spy.failed = name;
    v.fails = true;
    return v;
}

void spy_leave(const spy_verdict *v) {
    ends_work(v->told);
}

cl_int spy_code(void) {
    return spy.code;
}
void spy_alive(int32_t objects) {
    spy.live += objects;
}
void spy_blocks(const char *name) {
    if (spy.blocking++ == 0) spy.first_blocking = name;
}
void spy_enqueued(const cl_event *event) {
    spy.pending = true;
    spy.live += event != NULL;
}
void spy_finished(void) {
    spy.pending = false;
}

void spy_tells_memory(cl_device_info what, void *out) {
    const uint64_t told = what == CL_DEVICE_GLOBAL_MEM_SIZE      ? spy.memory
                          : what == CL_DEVICE_MAX_MEM_ALLOC_SIZE ? spy.largest_buffer
                                                                 : 0;
    if (told > 0) *(cl_ulong *)out = told;
}

/* Bytes that a buffer takes on the device. */
static uint64_t bytes_of(cl_mem object) {
    static __typeof__(&clGetMemObjectInfo) info;
    if (!info) *(void **)(&info) = library_next("clGetMemObjectInfo");
    size_t bytes = 0;
    cl_mem_flags flags = 0;
    if (info(object, CL_MEM_SIZE, sizeof bytes, &bytes, NULL) != CL_SUCCESS) return 0;
    if (info(object, CL_MEM_FLAGS, sizeof flags, &flags, NULL) != CL_SUCCESS) return 0;
    return flags & CL_MEM_USE_HOST_PTR ? 0 : bytes;
}

void spy_holds(cl_mem buffer, int32_t sign) {
    spy.live += sign;
    spy.live_bytes += (uint64_t)sign * bytes_of(buffer);
}

void spy_forgets(cl_kernel kernel) {
    size_t kept = 0, warm = 0;
    for (size_t i = 0; i < spy.launched_count; i++) {
        if (spy.launched[i].kernel == kernel) continue;
        warm += i < spy.warm;
        spy.launched[kept++] = spy.launched[i];
    }
    spy.launched_count = kept;
    spy.warm = warm;
}

void spy_launches(cl_kernel kernel, cl_uint dims, const size_t *local) {
    size_t size[3] = {0};
    if (local) memcpy(size, local, dims * sizeof *local);
    for (size_t i = 0; i < spy.launched_count; i++) {
        if (spy.launched[i].kernel != kernel || memcmp(spy.launched[i].local, size, sizeof size) != 0)
            continue;
        spy.cold += i >= spy.warm;
        spy.launched[i].used = true;
        return;
    }
    if (spy.launched_count == SPY_LAUNCHED)
        return; /* of more launches it is not known whether they are new */
    spy.launched[spy.launched_count].kernel = kernel;
    spy.launched[spy.launched_count].used = true;
    memcpy(spy.launched[spy.launched_count++].local, size, sizeof size);
    spy.cold++;
}

void spy_has_read(cl_command_queue q, void *to, size_t row_bytes, size_t rows, size_t pitch) {
    if (spy.spoil_in == 0 || --spy.spoil_in > 0) return;
    static __typeof__(&clFinish) finish;
    if (!finish) *(void **)(&finish) = library_next("clFinish");
    if (finish(q) != CL_SUCCESS) abort();
    for (size_t y = 0; y < rows; y++)
        for (size_t x = 0; x < row_bytes; x++) ((unsigned char *)to)[y * pitch + x] ^= 0x40;
    spy.spoiled = true;
}

/* ---- the kernel that runs */
/* The names of launches that have not begun; one that is older loses its own. */
enum { SPY_FOLLOWED = 64, NAME_BYTES = sizeof(((spy_work *)NULL)->name) };
static char followed[SPY_FOLLOWED][NAME_BYTES];
static atomic_uint followed_count;

void spy_tell_work(const void *address, spy_work *out) {
    if (address) library_redirect(address);
    atomic_store(&work, out);
}

bool spy_wants_work(void) {
    return atomic_load(&work) != NULL;
}

/* The runtime calls it when it likes: whether the kernel still runs is asked after it was told. */
static void CL_CALLBACK begins(cl_event event, cl_int state, void *name) {
    static __typeof__(&clGetEventInfo) info;
    spy_work *out = atomic_load(&work);
    if (!info) *(void **)(&info) = library_next("clGetEventInfo");
    if (!out) return;
    memcpy(out->name, name, sizeof out->name);
    atomic_store(&out->since_ns, now_ns());
    if (info(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, NULL) != CL_SUCCESS ||
        state <= CL_COMPLETE)
        atomic_store(&out->since_ns, 0);
    ends_work(out);
}

static void CL_CALLBACK ends(cl_event event, cl_int state, void *nothing) {
    spy_work *out = atomic_load(&work);
    (void)event, (void)state, (void)nothing;
    if (out) atomic_store(&out->since_ns, 0);
}

void spy_follows(cl_kernel kernel, cl_event event) {
    static __typeof__(&clSetEventCallback) call;
    static __typeof__(&clGetKernelInfo) info;
    char *name = followed[atomic_fetch_add(&followed_count, 1) % SPY_FOLLOWED];
    if (!call) *(void **)(&call) = library_next("clSetEventCallback");
    if (!info) *(void **)(&info) = library_next("clGetKernelInfo");
    if (info(kernel, CL_KERNEL_FUNCTION_NAME, sizeof followed[0], name, NULL) != CL_SUCCESS) name[0] = '\0';
    spy_work *out = atomic_load(&work);
    begins_work(out); /* before it can be over */
    if (call(event, CL_RUNNING, begins, name) == CL_SUCCESS)
        (void)call(event, CL_COMPLETE, ends, NULL);
    else
        ends_work(out);
}
