/* SPDX-License-Identifier: MIT */
/*
 * Which device is taken where the host gives none, by the plugin (device.c) and by all who ask
 * smartvis/device.h to open one, with an OpenCL of this test's own: it has the devices that a case asks for.
 */
#include <CL/cl.h>

#include "support/unit.h"

/* A device is a platform of its own. */
typedef struct {
    const char *platform;
    cl_device_type type;
    int broken; /* its context cannot be made */
    const char *driver;
} fake;
static const fake *fakes;
static cl_uint fake_count;

static cl_int told_platforms(cl_uint n, cl_platform_id *out, cl_uint *count) {
    *count = fake_count;
    for (cl_uint i = 0; i < fake_count && i < n; i++) out[i] = (cl_platform_id)(uintptr_t)&fakes[i];
    return fake_count ? CL_SUCCESS : -1001;
}
static cl_int told_devices(cl_platform_id p, cl_device_type type, cl_uint n, cl_device_id *out,
                           cl_uint *count) {
    const fake *f = (const fake *)p;
    if (n < 1 || !(f->type & type)) return CL_DEVICE_NOT_FOUND;
    *out = (cl_device_id)p;
    *count = 1;
    return CL_SUCCESS;
}
/* NOLINTNEXTLINE(readability-non-const-parameter) */
static cl_int told_device(cl_device_id d, cl_device_info what, size_t bytes, void *out, size_t *size) {
    const fake *f = (const fake *)d;
    memset(out, 0, bytes);
    if (what == CL_DEVICE_PLATFORM) memcpy(out, &d, sizeof d);
    if (what == CL_DEVICE_TYPE) memcpy(out, &f->type, sizeof f->type);
    if (what == CL_DEVICE_NAME) (void)snprintf(out, bytes, "the device of %s", f->platform);
    if (what == CL_DRIVER_VERSION) (void)snprintf(out, bytes, "%s", f->driver ? f->driver : "");
    return CL_SUCCESS;
}
/* NOLINTNEXTLINE(readability-non-const-parameter) */
static cl_int told_platform(cl_platform_id p, cl_platform_info what, size_t bytes, void *out, size_t *size) {
    (void)snprintf(out, bytes, "%s", ((const fake *)p)->platform);
    return CL_SUCCESS;
}
static cl_context make_context(const cl_context_properties *p, cl_uint n, const cl_device_id *d,
                               void (*told)(const char *, const void *, size_t, void *), void *data,
                               cl_int *code) {
    const fake *f = (const fake *)*d;
    *code = f->broken ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
    return f->broken ? NULL : (cl_context)*d;
}
static cl_command_queue make_queue(cl_context c, cl_device_id d, cl_command_queue_properties p,
                                   cl_int *code) {
    *code = CL_SUCCESS;
    return (cl_command_queue)c;
}

#define clGetPlatformIDs         told_platforms
#define clGetDeviceIDs           told_devices
#define clGetDeviceInfo          told_device
#define clGetPlatformInfo        told_platform
#define clCreateContext          make_context
#define clCreateCommandQueue     make_queue
#define clReleaseContext(c)      ((void)(c), CL_SUCCESS)
#define clReleaseCommandQueue(q) ((void)(q), CL_SUCCESS)
#include "../../../src/device/device.c" /* NOLINT(bugprone-suspicious-include) */

static char logged[1024];
static void keep(const sv_host *host, int32_t severity, const char *text) {
    (void)snprintf(logged + strlen(logged), sizeof logged - strlen(logged), "%s\n", text);
}

/* `taken`: index of the device that the plugin takes, -1: none. `said`: in the log, or NULL: nothing was
 * said. */
static void takes(const fake *all, cl_uint count, const char *wish, int taken, const char *said) {
    static const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "test", "1", keep, NULL};
    sva a = {.host = &host};
    sv_device device;
    fakes = all;
    fake_count = count;
    logged[0] = '\0';
    assert_int_equal(wish ? setenv("SMARTVIS_DEVICE", wish, 1) : unsetenv("SMARTVIS_DEVICE"), 0);
    const sv_status status = sv_device_open(&a, NULL, NULL, NULL, &device);
    assert_int_equal(status == SV_OK, taken >= 0);
    if (taken >= 0) {
        assert_ptr_equal(device.device, &all[taken]);
        /* A work item of rusticl's has one ray, whatever the device. */
        assert_int_equal(device.rays_only, strcmp(all[taken].platform, "rusticl") == 0);
        assert_false(device.rays_only && device.is_cpu);
    }
    if (said ? !strstr(logged, said) : logged[0] != '\0') fail_msg("'%s' in '%s'", said ? said : "", logged);
}

/* The same, and who opens what smartvis/device.h finds comes to that device, or to the same words. */
static void all_take(const fake *all, cl_uint count, const char *wish, int taken, const char *said) {
    sv_devices devices;
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    takes(all, count, wish, taken, said);
    assert_int_equal(sv_devices_open(&devices, 0, &device, &context, &queue), taken >= 0);
    assert_ptr_equal(device, taken < 0 ? NULL : &all[taken]);
    assert_ptr_equal(context, device);
    assert_ptr_equal(queue, device);
    if (taken < 0 && !strstr(devices.why, said)) fail_msg("'%s' in '%s'", said, devices.why);
}

static void the_first_that_works(void **state) {
    static const fake two[] = {{"Maker", CL_DEVICE_TYPE_CPU, 0, NULL},
                               {"Other", CL_DEVICE_TYPE_GPU, 0, NULL}};
    static const fake broken[] = {{"Maker", CL_DEVICE_TYPE_GPU, 1, NULL},
                                  {"Other", CL_DEVICE_TYPE_CPU, 0, NULL}};
    static const fake none[] = {{"Maker", CL_DEVICE_TYPE_GPU, 1, NULL},
                                {"Other", CL_DEVICE_TYPE_CPU, 1, NULL}};
    static const fake others[] = {{"Maker", CL_DEVICE_TYPE_ACCELERATOR, 0, NULL},
                                  {"Other", CL_DEVICE_TYPE_ACCELERATOR, 0, NULL},
                                  {"Third", CL_DEVICE_TYPE_CPU, 0, NULL}};
    static const fake aborts[] = {{"rusticl", CL_DEVICE_TYPE_GPU, 0, "25.0.7-2"},
                                  {"Other", CL_DEVICE_TYPE_CPU, 0, NULL}};
    static const fake rusticl[] = {{"rusticl", CL_DEVICE_TYPE_CPU, 0, "26.2.6-1"},
                                   {"rusticl", CL_DEVICE_TYPE_GPU, 0, "26.1.6"},
                                   {"rusticl", CL_DEVICE_TYPE_GPU, 0, "27.0.0-devel"},
                                   {"rusticl", CL_DEVICE_TYPE_GPU, 0, NULL}};
    takes(aborts, 2, NULL, 1,
          "the OpenCL platform 'rusticl' of Mesa 25.0.7-2 ends its host while it compiles");
    takes(aborts, 1, NULL, -1, "take a device of another one");
    takes(&rusticl[0], 1, NULL, 0, NULL); /* by its version */
    takes(&rusticl[1], 1, NULL, -1, "expected 26.2 or later");
    takes(&rusticl[2], 1, NULL, 0, NULL);
    takes(&rusticl[3], 1, NULL, -1, "expected 26.2 or later");
    all_take(two, 2, NULL, 1, NULL); /* a GPU comes first */
    all_take(two, 2, "", 1, NULL);
    all_take(others, 3, NULL, 2, NULL); /* and a CPU before what is neither */
    all_take(others, 2, NULL, 0, NULL);
    all_take(others, 2, "cpu", -1, "no OpenCL device for SMARTVIS_DEVICE=cpu: CL_DEVICE_NOT_FOUND (-1)");
    all_take(two, 2, "gpu", 1, NULL);
    all_take(two, 2, "cpu", 0, NULL);
    all_take(two, 2, "abacus", -1, "SMARTVIS_DEVICE is 'abacus', expected 'cpu' or 'gpu'");
    all_take(two, 1, "gpu", -1, "no OpenCL device for SMARTVIS_DEVICE=gpu: CL_DEVICE_NOT_FOUND (-1)");
    assert_int_equal(setenv("OCL_ICD_VENDORS", "/none", 1), 0);
    all_take(
        two, 0, NULL, -1,
        "no OpenCL platform: CL_PLATFORM_NOT_FOUND_KHR (-1001). OCL_ICD_VENDORS, where drivers are looked "
        "for, is '/none'. Install a driver");
    all_take(broken, 2, NULL, 1, "the device 'the device of Maker' does not work; trying the next one");
    all_take(broken, 2, "gpu", -1, "clCreateContext: CL_OUT_OF_RESOURCES (-5)");
    all_take(none, 2, NULL, -1, "clCreateContext: CL_OUT_OF_RESOURCES (-5)");
}

UNIT_MAIN(NULL, NULL, the_first_that_works)
