/* SPDX-License-Identifier: MIT */
/*
 * One frame by every method in every layout of the work, and from every carrier, on the first device there
 * is. Prints a line each, with a sum over the bits of all results: two runtimes compute the same if the lines
 * are the same. It needs nothing of the host, so it runs on simulators of devices, too. Usage: every_method
 * PLUGIN.so [small [METHOD [LAYOUT]]]. What stands behind OpenCL is printed to stderr. Exit code 1 if a frame
 * fails, if a method's layouts differ, or if two methods do not.
 */
#include "smartvis/confidence.h"
#include "smartvis/lookup.h"
#include "stage/stage.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* With "small" a corner of it, for simulators that take a thousand times as long. */
enum { WIDTH = 40, HEIGHT = 28, SLICES = 48, SLAB = 11, RAYS = WIDTH * HEIGHT };
enum { SMALL_WIDTH = 11, SMALL_HEIGHT = 7 };

static uint8_t voxels[SLICES * RAYS];
static sv_scanned scanned[RAYS];
static float adjusted[RAYS], confidences[RAYS];
static uint32_t width = WIDTH, height = HEIGHT;
static const char *only, *only_layout; /* of methods and layouts; NULL: all */
static int small, failures;

/* Skin, fluid and fetus with bright bone behind it, speckled; at the left there is no fluid. */
static void make_volume(void) {
    uint32_t random = 1;
    uint8_t *next = voxels;
    for (uint32_t z = 0; z < SLICES; z++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++) {
                const uint32_t near = 9 + x / 10, far = near + (x < width / 8 ? 0 : 14 + (x / 6 + y / 5) % 4);
                const uint32_t grey = z < near ? 110 : z < far ? 8 : z < far + 6 ? 130 : 225;
                random = random * 1664525u + 1013904223u;
                *next++ = (uint8_t)(grey + (random >> 24) % 24);
            }
    for (uint32_t i = 0; i < width * height; i++)
        scanned[i] = (sv_scanned){(uint16_t)(i % 3), (uint16_t)(SLICES - i % width / 8)};
}

static void failed(void *data, const char *what, cl_int code) {
    (void)fprintf(stderr, "every_method: %s: OpenCL error %d\n", what, (int)code);
    exit(1);
}

static void must(cl_int code, const char *call) {
    if (code != CL_SUCCESS) failed(NULL, call, code);
}

static void open_device(stage_device *d) {
    cl_platform_id platform;
    char text[256];
    cl_int code;
    must(clGetPlatformIDs(1, &platform, NULL), "clGetPlatformIDs");
    must(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &d->device, NULL), "clGetDeviceIDs");
    must(clGetPlatformInfo(platform, CL_PLATFORM_VERSION, sizeof text, text, NULL), "clGetPlatformInfo");
    (void)fprintf(stderr, "every_method: %s, ", text);
    must(clGetDeviceInfo(d->device, CL_DEVICE_NAME, sizeof text, text, NULL), "clGetDeviceInfo");
    (void)fprintf(stderr, "%s\n", text);
    d->context = clCreateContext(NULL, 1, &d->device, NULL, NULL, &code);
    must(code, "clCreateContext");
    d->queue = clCreateCommandQueue(d->context, d->device, 0, &code);
    must(code, "clCreateCommandQueue");
}

static void close_device(const stage_device *d) {
    must(clReleaseCommandQueue(d->queue), "clReleaseCommandQueue");
    must(clReleaseContext(d->context), "clReleaseContext");
}

/* A frame, the same with q = 0.7, and the confidence map if there is one. */
static sv_status run_frame(const sv_plugin *p, const stage *st, const sv_result *result) {
    sv_param_info q;
    sv_stats again = {.size = sizeof again};
    const sv_result second = {.size = sizeof second, .depth = adjusted, .stats = &again};
    const sv_ext_confidence *confidence = p->get_extension(p, SV_EXT_CONFIDENCE);
    memset(confidences, 0, sizeof confidences);
    sv_status status = stage_run(st, p, NULL, 0, result);
    if (status >= SV_OK && confidence && confidence->offered(p))
        status = confidence->write(p, confidences, NULL, 0);
    if (status >= SV_OK && sv_lookup_key(p, "q", &q))
        status = p->adjust(p, &(sv_param_value){.id = q.id, .value = 0.7}, 1, &second);
    must(clFinish(st->device.queue), "clFinish");
    return status;
}

/* Adds all bits to a sum that depends on their order (FNV-1a). */
static uint64_t sum_of(const void *data, size_t bytes, uint64_t sum) {
    for (size_t i = 0; i < bytes; i++) sum = (sum ^ ((const uint8_t *)data)[i]) * UINT64_C(1099511628211);
    return sum;
}

static uint64_t sum_of_results(const sv_result *result) {
    const size_t rays = (size_t)width * height;
    uint64_t sum = UINT64_C(14695981039346656037);
    sum = sum_of(result->depth, rays * sizeof(float), sum);
    sum = sum_of(adjusted, rays * sizeof(float), sum);
    sum = sum_of(confidences, rays * sizeof(float), sum);
    return sum_of(result->status, rays, sum);
}

/* Returns the sum over the results. */
static uint64_t try_one(const sv_plugin *p, const stage_device *d, uint32_t carrier,
                        const sv_param_value values[2], const char *label) {
    static const char *const carriers[] = {"", "host", "buffer", "image"};
    static stage st;
    const stage_way way = {.width = width,
                           .height = height,
                           .slices = SLICES,
                           .longest = SLAB,
                           .tiles_x = SLAB,
                           .extra_w = WIDTH - width,
                           .extra_h = HEIGHT - height,
                           .carrier = carrier,
                           .ranges = true,
                           .spacing_mm = {1, 1, 1},
                           .padding = SV_NO_PADDING,
                           .fixed_count = 2,
                           .fixed = {values[0], values[1]}};
    stage_make(&st, &way, d, failed, NULL);
    stage_fill(&st, voxels, scanned);
    stage_poison(&st, 0);
    const sv_result result = stage_result(&st);
    sv_status status = p->activate(p, &st.format);
    const bool active = status >= SV_OK;
    if (active) status = run_frame(p, &st, &result);
    if (status < SV_OK) (void)fprintf(stderr, "every_method: %s: %s\n", label, p->last_error(p));
    if (active) p->deactivate(p);
    failures += status < SV_OK;
    const uint64_t sum = sum_of_results(&result);
    (void)printf("%-20s %-6s outcome %d, results %016llx\n", label, carriers[carrier],
                 (int)(status < SV_OK ? status : result.stats->outcome), (unsigned long long)sum);
    (void)fflush(stdout);
    stage_free(&st);
    return sum;
}

/* All layouts and carriers of a method give the same results, and no two methods do: else the frame shows
 * nothing of what was chosen. */
static void judge(double method, uint64_t sum, const char *label) {
    static struct {
        double method;
        uint64_t sum;
    } seen[64];
    static size_t count;
    size_t i = 0;
    while (i < count && (seen[i].method == method) == (seen[i].sum == sum)) i++;
    if (i < count) {
        failures++;
        (void)fprintf(stderr, "every_method: %s: %s\n", label,
                      seen[i].method == method ? "other results than the same method had before"
                                               : "the results of another method");
    }
    if (count < sizeof seen / sizeof *seen) {
        seen[count].method = method;
        seen[count++].sum = sum;
    }
}

static void try_all(const sv_plugin *p, const stage_device *d) {
    const bool images = stage_has_images(d);

    sv_param_info method, strategy;
    if (!sv_lookup_key(p, "method", &method) || !sv_lookup_key(p, "strategy", &strategy)) {
        (void)fprintf(stderr, "every_method: %s has no methods and layouts\n", p->descriptor->id);
        exit(1);
    }
    /* The first layout picks one of the others. */
    for (double m = method.min_value; m <= method.max_value; m += method.step)
        for (double s = strategy.min_value + strategy.step; s <= strategy.max_value; s += strategy.step) {
            const sv_param_value values[2] = {{.id = method.id, .value = m}, {.id = strategy.id, .value = s}};
            char name[32], layout[32], label[80];
            if (p->param_text(p, strategy.id, s, layout, sizeof layout) < 0) exit(1);
            if (p->param_text(p, method.id, m, name, sizeof name) < 0)
                continue; /* no method has this value */
            if ((only && strcmp(only, name) != 0) || (only_layout && strcmp(only_layout, layout) != 0))
                continue;
            (void)snprintf(label, sizeof label, "%s %s", name, layout);
            /* A small run tries two layouts a method, in turn one of the others and rays, for which a method
             * may have kernels of its own. */
            const int turn = (int)((m - method.min_value) / method.step) % 2 + 1;
            const bool chosen = s == strategy.min_value + turn * strategy.step || s == strategy.max_value;
            if (small && m > method.min_value && !chosen) continue;
            judge(m, try_one(p, d, SV_CARRIER_BUFFER, values, label), label);
            if (m > method.min_value) continue; /* how the slabs come is the same for all methods */
            judge(m, try_one(p, d, SV_CARRIER_HOST, values, label), label);
            if (images) judge(m, try_one(p, d, SV_CARRIER_IMAGE, values, label), label);
        }
}

static void print_log(const sv_host *host, int32_t severity, const char *text) {
    if (severity >= SV_LOG_WARNING) (void)fprintf(stderr, "plugin: %s\n", text);
}

int main(int argc, char **argv) {
    only = argc > 3 ? argv[3] : NULL;
    only_layout = argc > 4 ? argv[4] : NULL;
    small = argc >= 3 && argc <= 5 && strcmp(argv[2], "small") == 0;
    void *library = argc == 2 || small ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    const sv_entry *entry = library ? dlsym(library, SV_ENTRY_SYMBOL) : NULL;
    if (!entry || entry->abi_major != SV_ABI_MAJOR) {
        (void)fprintf(stderr, "usage: every_method FOLDER/PLUGIN.so [small [METHOD [LAYOUT]]]\n");
        return 2;
    }
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "every_method", "1", print_log, NULL};
    const sv_plugin *p = NULL;
    stage_device d;
    if (small) {
        width = SMALL_WIDTH;
        height = SMALL_HEIGHT;
    }
    make_volume();
    open_device(&d);
    if (entry->create(&host, entry->descriptor(0)->id, &p) != SV_OK) return 1;
    try_all(p, &d);
    p->destroy(p);
    close_device(&d);
    return failures > 0;
}
