/* SPDX-License-Identifier: MIT */
#include "validate/spy/cl_spy.h"

#include "validate/spy/cl_spy_call.h"
#include "validate/spy/library_range.h"

#include <dlfcn.h>
#include <link.h>
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
    uint64_t live_bytes, memory, largest_buffer;
    uint32_t spoil_in; /* reads until the one that is spoiled; 0: none */
    bool spoiled;
    struct {
        cl_kernel kernel;
        size_t local[3];
    } launched[SPY_LAUNCHED]; /* those of live kernels; the first `warm` ones before the last reset */
    size_t launched_count, warm;
    uint32_t cold;
} spy;

void spy_watch(const void *address) {
    memset(&spy, 0, sizeof spy);
    spy.watched = library_range_of(address);
}

void spy_reset(void) {
    memset(spy.counts, 0, sizeof spy.counts);
    spy.blocking = spy.fail_in = spy.spoil_in = spy.cold = 0;
    spy.failed = NULL;
    spy.spoiled = false;
    spy.warm = spy.launched_count;
}

uint32_t spy_count(spy_kind kind) {
    return spy.counts[kind];
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
}

spy_verdict spy_enter(const char *name, spy_kind kind, const void *caller) {
    if (!library_range_holds(spy.watched, caller)) return (spy_verdict){false, false};
    if (spy.counts[kind]++ == 0) spy.first[kind] = name;
    if (kind == SPY_RELEASE || spy.fail_in == 0 || --spy.fail_in > 0) return (spy_verdict){true, false};
    spy.failed = name;
    return (spy_verdict){true, true};
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

SPY_CODE_CALL(clGetPlatformIDs, SPY_QUERY, (cl_uint n, cl_platform_id *out, cl_uint *count), (n, out, count))
SPY_CODE_CALL(clGetDeviceIDs, SPY_QUERY,
              (cl_platform_id platform, cl_device_type type, cl_uint n, cl_device_id *out, cl_uint *count),
              (platform, type, n, out, count))
cl_int clGetDeviceInfo(cl_device_id d, cl_device_info what, size_t n, void *out, size_t *size) {
    SPY_REAL(clGetDeviceInfo);
    SPY_ENTER(clGetDeviceInfo, SPY_QUERY);
    if (v.fails) return spy.code;
    const cl_int code = real(d, what, n, out, size);
    const uint64_t told = what == CL_DEVICE_GLOBAL_MEM_SIZE      ? spy.memory
                          : what == CL_DEVICE_MAX_MEM_ALLOC_SIZE ? spy.largest_buffer
                                                                 : 0;
    if (v.ours && code == CL_SUCCESS && told > 0) *(cl_ulong *)out = told;
    return code;
}
SPY_CODE_CALL(clGetCommandQueueInfo, SPY_QUERY,
              (cl_command_queue q, cl_command_queue_info what, size_t n, void *out, size_t *size),
              (q, what, n, out, size))
SPY_CODE_CALL(clGetMemObjectInfo, SPY_QUERY, (cl_mem m, cl_mem_info what, size_t n, void *out, size_t *size),
              (m, what, n, out, size))
SPY_CODE_CALL(clGetImageInfo, SPY_QUERY, (cl_mem m, cl_image_info what, size_t n, void *out, size_t *size),
              (m, what, n, out, size))
SPY_CODE_CALL(clGetProgramBuildInfo, SPY_QUERY,
              (cl_program p, cl_device_id d, cl_program_build_info what, size_t n, void *out, size_t *size),
              (p, d, what, n, out, size))
SPY_CODE_CALL(clGetEventProfilingInfo, SPY_QUERY,
              (cl_event e, cl_profiling_info what, size_t n, void *out, size_t *size),
              (e, what, n, out, size))
SPY_CODE_CALL(clSetKernelArg, SPY_QUERY, (cl_kernel k, cl_uint i, size_t n, const void *value),
              (k, i, n, value))
SPY_CODE_CALL(clBuildProgram, SPY_BUILD,
              (cl_program p, cl_uint n, const cl_device_id *devices, const char *options,
               void(CL_CALLBACK *notify)(cl_program, void *), void *data),
              (p, n, devices, options, notify, data))

cl_int clFinish(cl_command_queue queue) {
    SPY_REAL(clFinish);
    SPY_ENTER(clFinish, SPY_WAIT);
    const cl_int code = real(queue);
    if (v.ours) spy.pending = false;
    return v.fails ? spy.code : code;
}

SPY_CREATE_CALL(cl_context, clCreateContext,
                (const cl_context_properties *properties, cl_uint n, const cl_device_id *devices,
                 void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *data,
                 cl_int *errcode),
                (properties, n, devices, notify, data, errcode))
SPY_CREATE_CALL(cl_command_queue, clCreateCommandQueue,
                (cl_context c, cl_device_id d, cl_command_queue_properties properties, cl_int *errcode),
                (c, d, properties, errcode))
/* Bytes that a buffer takes on the device. */
static uint64_t bytes_of(cl_mem object) {
    static __typeof__(&clGetMemObjectInfo) info;
    if (!info) *(void **)(&info) = dlsym(RTLD_NEXT, "clGetMemObjectInfo");
    size_t bytes = 0;
    cl_mem_flags flags = 0;
    if (info(object, CL_MEM_SIZE, sizeof bytes, &bytes, NULL) != CL_SUCCESS) return 0;
    if (info(object, CL_MEM_FLAGS, sizeof flags, &flags, NULL) != CL_SUCCESS) return 0;
    return flags & CL_MEM_USE_HOST_PTR ? 0 : bytes;
}

cl_mem clCreateBuffer(cl_context c, cl_mem_flags flags, size_t n, void *host, cl_int *errcode) {
    SPY_REAL(clCreateBuffer);
    SPY_ENTER(clCreateBuffer, SPY_CREATE);
    if (v.fails) {
        if (errcode) *errcode = spy.code;
        return NULL;
    }
    cl_mem object = real(c, flags, n, host, errcode);
    if (v.ours && object) {
        spy.live++;
        spy.live_bytes += bytes_of(object);
    }
    return object;
}

cl_int clReleaseMemObject(cl_mem object) {
    SPY_REAL(clReleaseMemObject);
    SPY_ENTER(clReleaseMemObject, SPY_RELEASE);
    spy.live -= v.ours;
    if (v.ours) spy.live_bytes -= bytes_of(object);
    return real(object);
}

SPY_CREATE_CALL(cl_program, clCreateProgramWithSource,
                (cl_context c, cl_uint n, const char **text, const size_t *lengths, cl_int *errcode),
                (c, n, text, lengths, errcode))
SPY_CREATE_CALL(cl_kernel, clCreateKernel, (cl_program p, const char *name, cl_int *errcode),
                (p, name, errcode))

SPY_RELEASE_CALL(clReleaseContext, cl_context)
SPY_RELEASE_CALL(clReleaseCommandQueue, cl_command_queue)
SPY_RELEASE_CALL(clReleaseProgram, cl_program)
SPY_RELEASE_CALL(clReleaseEvent, cl_event)

/* A kernel that is gone has been launched with nothing: another may come to lie at its address. */
cl_int clReleaseKernel(cl_kernel kernel) {
    SPY_REAL(clReleaseKernel);
    SPY_ENTER(clReleaseKernel, SPY_RELEASE);
    spy.live -= v.ours;
    size_t kept = 0, warm = 0;
    for (size_t i = 0; i < spy.launched_count; i++) {
        if (spy.launched[i].kernel == kernel) continue;
        warm += i < spy.warm;
        spy.launched[kept++] = spy.launched[i];
    }
    spy.launched_count = kept;
    spy.warm = warm;
    return real(kernel);
}

static void note_launch(cl_kernel kernel, cl_uint dims, const size_t *local) {
    size_t size[3] = {0};
    if (local) memcpy(size, local, dims * sizeof *local);
    for (size_t i = 0; i < spy.launched_count; i++) {
        if (spy.launched[i].kernel != kernel || memcmp(spy.launched[i].local, size, sizeof size) != 0)
            continue;
        spy.cold += i >= spy.warm;
        return;
    }
    if (spy.launched_count == SPY_LAUNCHED)
        return; /* of more launches it is not known whether they are new */
    spy.launched[spy.launched_count].kernel = kernel;
    memcpy(spy.launched[spy.launched_count++].local, size, sizeof size);
    spy.cold++;
}

cl_int clEnqueueNDRangeKernel(cl_command_queue q, cl_kernel k, cl_uint dims, const size_t *offset,
                              const size_t *global, const size_t *local, cl_uint n, const cl_event *wait,
                              cl_event *event) {
    SPY_REAL(clEnqueueNDRangeKernel);
    SPY_ENTER(clEnqueueNDRangeKernel, SPY_ENQUEUE);
    if (v.fails) return spy.code;
    const cl_int code = real(q, k, dims, offset, global, local, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy.pending = true;
        spy.live += event != NULL;
        note_launch(k, dims, local);
    }
    return code;
}

/* After a read of `rows` rows: waits for it and changes every byte that it brought, if this is its turn. */
static void spoil(cl_command_queue q, void *to, size_t row_bytes, size_t rows, size_t pitch) {
    if (spy.spoil_in == 0 || --spy.spoil_in > 0) return;
    static __typeof__(&clFinish) finish;
    if (!finish) *(void **)(&finish) = dlsym(RTLD_NEXT, "clFinish");
    if (finish(q) != CL_SUCCESS) abort();
    for (size_t y = 0; y < rows; y++)
        for (size_t x = 0; x < row_bytes; x++) ((unsigned char *)to)[y * pitch + x] ^= 0x40;
    spy.spoiled = true;
}

SPY_ENQUEUE_CALL(clEnqueueFillBuffer, false,
                 (cl_command_queue q, cl_mem m, const void *pattern, size_t bytes, size_t offset, size_t size,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, m, pattern, bytes, offset, size, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueWriteBuffer, block,
                 (cl_command_queue q, cl_mem m, cl_bool block, size_t offset, size_t size, const void *from,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, m, block, offset, size, from, n, wait, event))
cl_int clEnqueueReadBuffer(cl_command_queue q, cl_mem m, cl_bool block, size_t offset, size_t size, void *to,
                           cl_uint n, const cl_event *wait, cl_event *event) {
    SPY_REAL(clEnqueueReadBuffer);
    SPY_ENTER(clEnqueueReadBuffer, SPY_ENQUEUE);
    if (v.ours && block) spy_blocks(__func__);
    if (v.fails) return spy.code;
    const cl_int code = real(q, m, block, offset, size, to, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy.pending = true;
        spy.live += event != NULL;
        spoil(q, to, size, 1, size);
    }
    return code;
}
cl_int clEnqueueReadBufferRect(cl_command_queue q, cl_mem m, cl_bool block, const size_t *from,
                               const size_t *to, const size_t *region, size_t row, size_t slice,
                               size_t host_row, size_t host_slice, void *host, cl_uint n,
                               const cl_event *wait, cl_event *event) {
    SPY_REAL(clEnqueueReadBufferRect);
    SPY_ENTER(clEnqueueReadBufferRect, SPY_ENQUEUE);
    if (v.ours && block) spy_blocks(__func__);
    if (v.fails) return spy.code;
    const cl_int code =
        real(q, m, block, from, to, region, row, slice, host_row, host_slice, host, n, wait, event);
    if (v.ours && code == CL_SUCCESS) {
        spy.pending = true;
        spy.live += event != NULL;
        spoil(q, host, region[0], region[1], host_row);
    }
    return code;
}
SPY_ENQUEUE_CALL(clEnqueueCopyBuffer, false,
                 (cl_command_queue q, cl_mem from, cl_mem to, size_t at, size_t offset, size_t size,
                  cl_uint n, const cl_event *wait, cl_event *event),
                 (q, from, to, at, offset, size, n, wait, event))
SPY_ENQUEUE_CALL(clEnqueueCopyImageToBuffer, false,
                 (cl_command_queue q, cl_mem image, cl_mem buffer, const size_t *from, const size_t *region,
                  size_t offset, cl_uint n, const cl_event *wait, cl_event *event),
                 (q, image, buffer, from, region, offset, n, wait, event))

const char *spy_unknown_import(void *handle) {
    struct link_map *map = NULL;
    if (dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0) return "(no link map)";
    const ElfW(Sym) *symbols = NULL;
    const char *names = NULL;
    const uint32_t *hash = NULL;
    for (const ElfW(Dyn) *d = map->l_ld; d->d_tag != DT_NULL; d++) {
        if (d->d_tag == DT_SYMTAB) symbols = (const ElfW(Sym) *)d->d_un.d_ptr;
        if (d->d_tag == DT_STRTAB) names = (const char *)d->d_un.d_ptr;
        if (d->d_tag == DT_GNU_HASH) hash = (const uint32_t *)d->d_un.d_ptr;
    }
    if (!symbols || !names || !hash) return "(no symbol table)";
    void *self = dlopen(NULL, RTLD_NOW);
    const char *unknown = NULL;
    for (uint32_t i = 1; i < hash[1] && !unknown; i++) { /* hash[1]: the first symbol that is not an import */
        const char *name = names + symbols[i].st_name;
        if (strncmp(name, "cl", 2) != 0 || name[2] < 'A' || name[2] > 'Z') continue;
        const void *known = self ? dlsym(self, name) : NULL;
        if (!known || !library_range_holds(library_range_of((const void *)(uintptr_t)&spy_watch), known))
            unknown = name;
    }
    if (self) (void)dlclose(self);
    return unknown;
}
