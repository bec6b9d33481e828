/* SPDX-License-Identifier: MIT */
#include "support/host_fixture.h"

#include <math.h>
#include <pthread.h>

double test_uniform(test_random *random, double low, double high) {
    return low + (high - low) * ((double)unit_random(&random->state) / 4294967295.0);
}

static uint8_t test_voxel(test_random *random, int pattern, const uint32_t n[3], uint32_t x, uint32_t y,
                          uint32_t z) {
    const uint32_t noise = unit_random(&random->state);
    const double off = hypot(x - 0.5 * n[0], y - 0.5 * n[1]);
    switch (pattern) {
    case TEST_NOISE:
        return (uint8_t)(noise >> 24);
    case TEST_SPARSE:
        return ((x / 9) * 7 + (y / 9) * 3 + z / 9) % 5 == 0 ? (uint8_t)(noise >> 24) : 0;
    case TEST_SMOOTH:
        return (uint8_t)(20 + (x * 5 + y * 3 + z * 4) % 200);
    case TEST_FULL:
        return 255;
    case TEST_DOTS:
        return x % 8 == 0 && y % 8 == 0 && z % 8 == 0 && noise % 3 == 0 ? 255 : 0;
    case TEST_CHECKER:
        return (x + y + z) % 2 ? 255 : 0;
    case TEST_FAN:
        return off < 5.0 + 0.5 * z && hypot(off, z) < n[2] ? (uint8_t)(1 + noise % 255) : 0;
    case TEST_CORNER:
        return x + 12 > n[0] && y + 12 > n[1] && z + 12 > n[2] ? (uint8_t)(1 + noise % 255) : 0;
    default:
        return 0;
    }
}

static void free_volume(void *volume) {
    hs_volume_free(volume);
}

void keep_volume(const hs_volume *volume) {
    hs_volume *copy = unit_memory(sizeof *copy);
    *copy = *volume;
    unit_keep(free_volume, copy);
}

hs_volume test_volume(test_random *random, int pattern, const uint32_t size[3], const double spacing[3]) {
    hs_volume volume;
    must(hs_volume_init(&volume, size[0], size[1], size[2], &err));
    keep_volume(&volume);
    memcpy(volume.spacing, spacing, sizeof volume.spacing);
    uint8_t *voxel = volume.voxels;
    for (uint32_t z = 0; z < size[2]; z++) {
        for (uint32_t y = 0; y < size[1]; y++) {
            for (uint32_t x = 0; x < size[0]; x++) *voxel++ = test_voxel(random, pattern, size, x, y, z);
        }
    }
    return volume;
}

cl_mem test_buffer(const hs_cl *cl, size_t bytes, const void *contents) {
    cl_int code = CL_SUCCESS;
    cl_mem buffer = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
    assert_int_equal(code, CL_SUCCESS);
    if (contents) {
        code = clEnqueueWriteBuffer(cl->queue, buffer, CL_TRUE, 0, bytes, contents, 0, NULL, NULL);
        assert_int_equal(code, CL_SUCCESS);
    }
    return buffer;
}

void test_read(const hs_cl *cl, cl_mem buffer, size_t bytes, void *out) {
    assert_int_equal(clEnqueueReadBuffer(cl->queue, buffer, CL_TRUE, 0, bytes, out, 0, NULL, NULL),
                     CL_SUCCESS);
}

test_slabs test_convert(const hs_cl *cl, const hs_volume *volume, const hs_camera *camera,
                        const hs_slab_layout *layout, size_t offset, size_t stride) {
    hs_error err = {0};
    const uint32_t slabs = hs_slab_count(layout);
    const size_t bytes = offset + stride * slabs, rays = (size_t)layout->width * layout->height;
    test_slabs out = {.voxels = unit_memory(bytes)};
    hs_scanned_rays finder = {0};
    memset(out.voxels, TEST_GUARD, bytes);
    cl_mem buffer = test_buffer(cl, bytes, out.voxels);
    hs_device_volume *source = hs_device_volume_create(cl, volume, &err);
    hs_scan_converter *converter = source ? hs_scan_converter_create(cl, layout, &err) : NULL;
    bool ok = converter && hs_scanned_rays_create(&finder, cl, layout, &err);
    for (uint32_t i = 0; ok && i < slabs; i++)
        ok = hs_scan_convert_slab(converter, source, camera, i, buffer, offset + i * stride, NULL, &err);
    if (ok && offset == 0) {
        out.ranges = unit_memory(rays * sizeof *out.ranges);
        ok = hs_scanned_rays_find(&finder, layout, source, camera, buffer, stride, &err);
    }
    if (!ok) fail_msg("%s", err.text);
    test_read(cl, buffer, bytes, out.voxels);
    if (out.ranges) test_read(cl, finder.ranges, rays * sizeof *out.ranges, out.ranges);
    hs_scanned_rays_destroy(&finder);
    hs_scan_converter_destroy(converter);
    hs_device_volume_destroy(source);
    clReleaseMemObject(buffer);
    return out;
}

/* The runtime's threads have as little stack as where users may give 512 KiB. */
static bool take_small_stacks(void) {
    pthread_attr_t small;
    const bool taken = pthread_attr_init(&small) == 0 && pthread_attr_setstacksize(&small, 512 << 10) == 0 &&
                       pthread_setattr_default_np(&small) == 0;
    return pthread_attr_destroy(&small) == 0 && taken;
}

static int test_open_lanes(void **state, uint32_t lanes) {
    static hs_cl cl;
    hs_error err = {HS_OK, ""};
    if (!take_small_stacks()) return -1;
    if (!hs_cl_open_lanes(&cl, lanes, &err)) {
        print_error("%s\n", err.text);
        return -1;
    }
    *state = &cl;
    return 0;
}

int test_open_device(void **state) {
    return test_open_lanes(state, 0);
}

int test_open_single(void **state) {
    return test_open_lanes(state, 1);
}

int test_close_device(void **state) {
    unit_return(NULL);
    hs_cl_close(*state);
    return 0;
}
