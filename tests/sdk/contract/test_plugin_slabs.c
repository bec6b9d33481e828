/* SPDX-License-Identifier: MIT */
/*
 * Slabs and results: what slab and end refuse. The order of slabs, guard bands around maps in memory and in
 * buffers, slabs that stay as they are in every carrier, and slabs that end where their bytes do, are
 * sv_validate's.
 * Requirement: R5.
 */
#include "support/fixture.h"

/* A slab that must be refused; afterwards the frame is over and the next one is good. */
static void refused_slab(fixture *f, uint32_t before, sv_slab slab, sv_status status, const char *text) {
    fixture_feed(f, before);
    fixture_refused(f, f->r.plugin->slab(f->r.plugin, &slab), status, text);
    assert_int_equal(f->r.last_severity, SV_LOG_HOST_MISBEHAVING);
    assert_int_equal(fixture_slab(f, before < FIXTURE_SLABS ? before : 0), SV_ERR_STATE);
    assert_int_equal(fixture_end(f), SV_ERR_STATE);
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
}

/* A slab that is refused for what `change` does to `slab`. */
#define REFUSED_SLAB(f, n, change, text)                                                                     \
    do {                                                                                                     \
        sv_slab slab = stage_slab((f)->textures, n);                                                         \
        change;                                                                                              \
        refused_slab(f, n, slab, SV_ERR_SLAB_SHAPE, text);                                                   \
    } while (0)

static void slab_shape(void **state) {
    fixture *f = *state;
    REFUSED_SLAB(f, 0, slab.slice_count = 0, "slice_count is 0, expected 1 to 6");
    REFUSED_SLAB(f, 2, slab.slice_count = 3, "slice_count is 3, expected 1 to 2");
    REFUSED_SLAB(f, 0, slab.memory = NULL, "memory is NULL and object is NULL, the carrier is 1");
    /* 6 slices, 4 to a row of 84 bytes: the last voxel is that of slice 5, in the second tile of the second
     * row. */
    REFUSED_SLAB(f, 0, slab.bytes = 84 * (18 + 17) + 42 - 1, "bytes is 2981, 6 slices need 2982");
    fixture_frame_is_good(f);
}

static void memory_that_was_not_registered(void **state) {
    fixture *f = *state;
    fixture_use(f, (rig_format){.in_place = true});
    uint8_t other[84 * 36] = {0};
    const char *const text = "memory does not lie within";
    const uint64_t left = (uint64_t)(f->textures->pages + f->textures->page_bytes - f->textures->memory[2]);
    REFUSED_SLAB(f, 0, slab.memory = other, text);
    REFUSED_SLAB(f, 0, slab.memory = f->textures->pages - 1, text);
    REFUSED_SLAB(f, 2, slab.bytes = left + 1, text);
    REFUSED_SLAB(f, 2, slab.bytes = UINT64_MAX, text);
    fixture_frame_is_good(f);
}

static cl_mem new_image(const fixture *f, cl_channel_order order, cl_channel_type type, size_t width,
                        size_t height) {
    const cl_image_format format = {order, type};
    const cl_image_desc desc = {
        .image_type = CL_MEM_OBJECT_IMAGE2D, .image_width = width, .image_height = height};
    return rig_keep(clCreateImage(f->r.context, CL_MEM_READ_WRITE, &format, &desc, NULL, NULL));
}

static void wrong_buffers(void **state) {
    fixture *f = *state;
    fixture_use(f, (rig_format){.carrier = SV_CARRIER_BUFFER});
    sv_slab given = stage_slab(f->textures, 0);
    given.object = NULL;
    given.memory = f->textures->memory[0]; /* the wrong carrier */
    refused_slab(f, 0, given, SV_ERR_SLAB_SHAPE, "memory is given and object is NULL, the carrier is 2");
    /* and the right one */
    REFUSED_SLAB(f, 0, slab.memory = f->textures->memory[0],
                 "memory is given and object is given, the carrier is 2");
    given = stage_slab(f->textures, 0);
    given.offset = 1; /* bytes + 1 reaches as far as the buffer does; 64 was the rig's */
    given.bytes += 64;
    refused_slab(f, 0, given, SV_ERR_SLAB_SHAPE, "are needed from 1 on");
    REFUSED_SLAB(f, 0, slab.offset = UINT64_MAX - 10, "from 18446744073709551605 on");
    given = stage_slab(f->textures, 0);
    given.object = new_image(f, CL_R, CL_UNORM_INT8, 84, 36);
    given.offset = 0;
    given.bytes = 84 * 36;
    refused_slab(f, 0, given, SV_ERR_SLAB_SHAPE, "object is no buffer");
    REFUSED_SLAB(f, 0, slab.object = rig_foreign_buffer(&f->r, slab.offset + slab.bytes),
                 "object is of another context");
    fixture_frame_is_good(f);
}

static void wrong_images(void **state) {
    fixture *f = *state;
    fixture_use(f, (rig_format){.carrier = SV_CARRIER_IMAGE});
    const struct {
        cl_mem object;
        const char *text;
    } table[] = {
        {new_image(f, CL_R, CL_UNORM_INT8, 83, 36), "the image is 83 x 36, expected at least 84 x 36"},
        {new_image(f, CL_R, CL_UNORM_INT8, 84, 35), "the image is 84 x 35"},
        {new_image(f, CL_RGBA, CL_UNORM_INT8, 84, 36), "expected CL_R with CL_UNORM_INT8"},
        {new_image(f, CL_R, CL_FLOAT, 84, 36), "expected CL_R with CL_UNORM_INT8"},
        {rig_buffer(&f->r, 84 * 36), "object is no 2D image"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        REFUSED_SLAB(f, 0, slab.object = table[i].object, table[i].text);
    REFUSED_SLAB(f, 0, slab.object = NULL, "memory is NULL and object is NULL, the carrier is 3");
    fixture_frame_is_good(f);
}

/* ---- results ---- */

static void refused_result(fixture *f, sv_result result, sv_status status, const char *text) {
    fixture_feed(f, FIXTURE_SLABS);
    fixture_refused(f, f->r.plugin->end(f->r.plugin, &result), status, text);
    fixture_refused(f, f->r.plugin->end(f->r.plugin, &result), SV_ERR_STATE, "no frame");
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
}

static void wrong_results(void **state) {
    fixture *f = *state;
    cl_mem buffer = rig_buffer(&f->r, FIXTURE_RAYS * 4 + 3), image = new_image(f, CL_R, CL_FLOAT, 21, 18);
    sv_result r = fixture_result(f);
    r.depth = NULL;
    refused_result(f, r, SV_ERR_ARGUMENT, "neither of depth and depth_object given");
    r = fixture_result(f);
    r.depth_object = buffer;
    refused_result(f, r, SV_ERR_ARGUMENT, "both of depth and depth_object given");
    static const uint32_t pitches[] = {1, 83, 80, 85, 86, UINT32_MAX};
    for (size_t i = 0; i < sizeof pitches / sizeof *pitches; i++) {
        char text[64];
        (void)snprintf(text, sizeof text, "depth_pitch is %u", pitches[i]);
        r = fixture_result(f);
        r.depth_pitch = pitches[i];
        refused_result(f, r, SV_ERR_ARGUMENT, text);
    }
    r = fixture_result(f);
    r.depth = NULL;
    r.depth_object = buffer;
    r.depth_offset = 2;
    refused_result(f, r, SV_ERR_ARGUMENT, "at depth_offset 2: expected a multiple of 4");
    r.depth_offset = 4; /* one pixel too far */
    refused_result(f, r, SV_ERR_ARGUMENT, "depth_object has 1515 bytes, and 1512 are needed from 4 on");
    r.depth_offset = UINT64_MAX - 3;
    refused_result(f, r, SV_ERR_ARGUMENT, "needed from 18446744073709551612 on");
    r.depth_offset = 0;
    r.depth_object = image;
    refused_result(f, r, SV_ERR_ARGUMENT, "depth_object is no buffer");
    r.depth_object = rig_foreign_buffer(&f->r, FIXTURE_RAYS * 4);
    refused_result(f, r, SV_ERR_ARGUMENT, "depth_object is of another context");
    sv_stats shorter = {.size = sizeof shorter - 4};
    r = fixture_result(f);
    r.stats = &shorter;
    refused_result(f, r, SV_ERR_SIZE, "stats.size is 16");
    fixture_frame_is_good(f);
    f->r.plugin->deactivate(f->r.plugin);
    fixture_use(f, (rig_format){.own_queue = true});
    r = fixture_result(f);
    r.depth = NULL;
    r.depth_object = (cl_mem)f; /* never looked at */
    refused_result(f, r, SV_ERR_ARGUMENT, "and the host's queue");
    fixture_frame_is_good(f);
}

UNIT_MAIN_OF(NULL, NULL, FIXTURE_TEST_ACTIVE(slab_shape), FIXTURE_TEST(memory_that_was_not_registered),
             FIXTURE_TEST(wrong_buffers), FIXTURE_TEST(wrong_images), FIXTURE_TEST_ACTIVE(wrong_results))
