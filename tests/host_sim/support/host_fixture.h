/* SPDX-License-Identifier: MIT */
/* What the tests of scan conversion and renderer share: a device, random volumes, buffers with guards. */
#pragma once

#include "render/camera.h"
#include "render/host_kernels.h"
#include "render/scan_convert.h"
#include "support/unit.h"

/* xorshift: the same volumes on every machine. */
typedef struct {
    uint32_t state;
} test_random;

/* Uniform in low .. high. */
double test_uniform(test_random *random, double low, double high);

/* Patterns. TEST_DOTS: single voxels on the seams between the renderer's bricks. What TEST_FAN and
 * TEST_CORNER do not hold was not scanned. */
enum {
    TEST_NOISE,
    TEST_SPARSE,
    TEST_SMOOTH,
    TEST_FULL,
    TEST_EMPTY,
    TEST_CHECKER,
    TEST_DOTS,
    TEST_FAN,
    TEST_CORNER
};

/* What the volume points at is given back when the test ends, and not by hs_volume_free. */
void keep_volume(const hs_volume *volume);

/* A volume of a pattern, kept; spacing in mm. */
hs_volume test_volume(test_random *random, int pattern, const uint32_t size[3], const double spacing[3]);

/* A device buffer with these contents, NULL for none. The caller releases it. */
cl_mem test_buffer(const hs_cl *cl, size_t bytes, const void *contents);

/* Waits for the queue and reads the buffer. */
void test_read(const hs_cl *cl, cl_mem buffer, size_t bytes, void *out);

/* All slabs of a volume, `stride` bytes apart from `offset` on, among bytes of TEST_GUARD; and what was
 * scanned of every ray if the offset is 0, else NULL. Both are kept. */
enum { TEST_GUARD = 0xA5 };
typedef struct {
    uint8_t *voxels;
    cl_ushort2 *ranges;
} test_slabs;
test_slabs test_convert(const hs_cl *cl, const hs_volume *volume, const hs_camera *camera,
                        const hs_slab_layout *layout, size_t offset, size_t stride);

/* cmocka group fixtures: *state is an open hs_cl, here with the kernels as this device runs them. */
int test_open_device(void **state);

/* test_open_device with the kernels as a GPU runs them: one ray or voxel a work item. */
int test_open_single(void **state);

int test_close_device(void **state);

/* The program: these tests, with the kernels as this device runs them and as a GPU does. */
#define HOST_MAIN(...)                                                                                       \
    int main(void) {                                                                                         \
        return UNIT_RUN("packets", test_open_device, test_close_device, __VA_ARGS__) +                       \
               UNIT_RUN("single items", test_open_single, test_close_device, __VA_ARGS__);                   \
    }
