/* SPDX-License-Identifier: MIT */
/* smartvis.confidence/1: the map on the frame path is the map that read gives, by every way it can travel. */
#include "support/rig.h"
#include "support/scene_fixture.h"

enum { SIDE = 48, COUNT = SIDE * SIDE, BYTES = COUNT * 4, OFFSET = 64 };
static const double WALL = 7.0; /* the value of parameter method */

static const sv_ext_confidence *extension(const rig *r) {
    const sv_ext_confidence *ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    assert_non_null(ext);
    assert_true(SV_HAS(ext, write));
    return ext;
}

/* Active with this method, and one frame of a scene done. */
static void finish_frame(rig *r, double method, bool own_queue, rig_result *out) {
    static rig_format f;
    hs_scene_data data = make_scene("E01", SIDE, 2, 1, 0);
    f = (rig_format){.width = SIDE,
                     .height = SIDE,
                     .slices = SIDE,
                     .slab_slices = 16,
                     .own_queue = own_queue,
                     .fixed = {{rig_param(r, "method"), 0, method}}};
    stage *t = rig_stage(r, &f, data.full.voxels);
    *out = rig_result_make(SIDE, SIDE);
    assert_int_equal(extension(r)->offered(r->plugin), 0);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    assert_int_equal(extension(r)->offered(r->plugin), method == WALL);
    assert_int_equal(extension(r)->write(r->plugin, out->depth, NULL, 0), SV_ERR_STATE);
    assert_int_equal(rig_frame(r, t, NULL, 0, out), SV_OK);
}

/* It differs from place to place, or a comparison would say little. */
static void assert_varied(const float *map) {
    float low = map[0], high = map[0];
    for (int i = 0; i < COUNT; i++) {
        if (map[i] < low) low = map[i];
        if (map[i] > high) high = map[i];
    }
    assert_true(low >= 0.0f && high <= 1.0f && high - low > 0.5f);
}

static void write_gives_what_read_gives(void **state) {
    static float expected[COUNT], got[COUNT];
    rig *r = *state;
    const sv_ext_confidence *ext = extension(r);
    for (int own = 0; own < 2; own++) {
        rig_result out;
        finish_frame(r, WALL, own, &out);
        assert_int_equal(ext->read(r->plugin, expected, NULL), SV_OK);
        assert_varied(expected);
        memset(got, 0xff, sizeof got);
        assert_int_equal(ext->write(r->plugin, got, NULL, 0), SV_OK);
        if (!own) assert_int_equal(clFinish(r->queue), CL_SUCCESS);
        assert_memory_equal(got, expected, sizeof got);
        /* Another q moves the surface, not what is known of it. */
        const sv_param_value q = {rig_param(r, "q"), 0, 1.0};
        const sv_result result = {.size = sizeof result, .depth = out.depth};
        assert_int_equal(r->plugin->adjust(r->plugin, &q, 1, &result), SV_OK);
        memset(got, 0xff, sizeof got);
        assert_int_equal(ext->write(r->plugin, got, NULL, 0), SV_OK);
        if (!own) assert_int_equal(clFinish(r->queue), CL_SUCCESS);
        assert_memory_equal(got, expected, sizeof got);
        r->plugin->deactivate(r->plugin);
    }
}

static void a_buffer_is_written_where_it_was_asked(void **state) {
    static float expected[COUNT];
    static unsigned char got[BYTES + 2 * OFFSET];
    rig *r = *state;
    const sv_ext_confidence *ext = extension(r);
    rig_result out;
    finish_frame(r, WALL, false, &out);
    assert_int_equal(ext->read(r->plugin, expected, NULL), SV_OK);
    memset(got, 0xa5, sizeof got);
    cl_mem buffer =
        rig_keep(clCreateBuffer(r->context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof got, got, NULL));
    assert_int_equal(ext->write(r->plugin, NULL, buffer, OFFSET), SV_OK);
    assert_int_equal(clEnqueueReadBuffer(r->queue, buffer, CL_TRUE, 0, sizeof got, got, 0, NULL, NULL),
                     CL_SUCCESS);
    assert_memory_equal(got + OFFSET, expected, BYTES);
    for (int i = 0; i < OFFSET; i++)
        assert_true(got[i] == 0xa5 && got[OFFSET + BYTES + i] == 0xa5); /* and nothing beside it */
    /* What cannot be is refused, and the frame stays. */
    assert_int_equal(ext->write(r->plugin, NULL, buffer, 3 * OFFSET), SV_ERR_ARGUMENT);
    assert_int_equal(ext->write(r->plugin, NULL, buffer, 2), SV_ERR_ARGUMENT);
    assert_int_equal(ext->write(r->plugin, NULL, NULL, 0), SV_ERR_ARGUMENT);
    assert_int_equal(ext->write(r->plugin, expected, buffer, 0), SV_ERR_ARGUMENT);
    assert_int_equal(ext->write(r->plugin, NULL, rig_foreign_buffer(r, BYTES), 0), SV_ERR_ARGUMENT);
    assert_int_equal(ext->write(r->plugin, NULL, buffer, 0), SV_OK);
    assert_int_equal(clFinish(r->queue), CL_SUCCESS);
}

static void a_queue_of_its_own_reaches_no_buffer_of_the_host(void **state) {
    rig *r = *state;
    rig_result out;
    finish_frame(r, WALL, true, &out);
    assert_int_equal(extension(r)->write(r->plugin, NULL, rig_buffer(r, BYTES), 0), SV_ERR_ARGUMENT);
}

static void another_method_has_no_map(void **state) {
    rig *r = *state;
    rig_result out;
    finish_frame(r, 0.0, false, &out);
    assert_int_equal(extension(r)->write(r->plugin, out.depth, NULL, 0), SV_ERR_STATE);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(write_gives_what_read_gives),
             RIG_TEST(a_buffer_is_written_where_it_was_asked),
             RIG_TEST(a_queue_of_its_own_reaches_no_buffer_of_the_host), RIG_TEST(another_method_has_no_map))
