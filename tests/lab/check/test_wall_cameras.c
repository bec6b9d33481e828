/* SPDX-License-Identifier: MIT */
/*
 * Method wall, where one volume is seen by one camera after another: the beams are asked once, but no map
 * depends on the cameras before.
 */
#include "support/rig.h"
#include "support/scene_fixture.h"

#include "smartvis/confidence.h"

enum { SIDE = 84 };
typedef struct {
    uint8_t *volume;
    sv_beams beams;
} view;

/* In front of it, or moved to its right by so many voxels. */
static view from_before(const uint8_t *volume, uint32_t right, const sv_beams *beams) {
    view v = {unit_memory((size_t)SIDE * SIDE * SIDE), *beams};
    for (size_t i = 0; i < (size_t)SIDE * SIDE * SIDE; i++)
        v.volume[i] = i % SIDE + right < SIDE ? volume[i + right] : 0;
    return v;
}

/* From the left of another camera. */
static view from_its_left(const view *from, double mm) {
    view v = {unit_memory((size_t)SIDE * SIDE * SIDE), from->beams};
    const size_t plane = (size_t)SIDE * SIDE;
    for (size_t z = 0; z < SIDE; z++)
        for (size_t y = 0; y < SIDE; y++)
            for (size_t x = 0; x < SIDE; x++)
                v.volume[(SIDE - 1 - x) * plane + y * SIDE + z] = from->volume[z * plane + y * SIDE + x];
    for (size_t i = 0; i < 3; i++) {
        v.beams.rotation[i] = from->beams.rotation[6 + i];
        v.beams.rotation[6 + i] = -from->beams.rotation[i];
    }
    v.beams.side[0] = from->beams.side[2];
    v.beams.side[2] = -from->beams.side[0];
    v.beams.apex_mm[0] = from->beams.apex_mm[2];
    v.beams.apex_mm[2] = (float)((SIDE - 1) * mm - (double)from->beams.apex_mm[0]);
    return v;
}

typedef struct {
    float depth[SIDE * SIDE], confidence[SIDE * SIDE];
} maps;

/* A frame of one camera; `same`: of the volume of the frame before. */
static maps *look(rig *r, stage *t, const view *v, bool same) {
    const sv_ext_confidence *const ext = r->plugin->get_extension(r->plugin, SV_EXT_CONFIDENCE);
    const sv_param_value unsure = {rig_param(r, "unsure"), 0, 1};
    rig_result out = rig_result_make(SIDE, SIDE);
    maps *const m = unit_memory(sizeof *m);
    stage_fill(t, v->volume, NULL);
    rig_tell(t, &v->beams);
    t->frame_flags = same ? SV_FRAME_SAME_VOLUME : 0;
    assert_int_equal(rig_frame(r, t, &unsure, 1, &out), SV_OK);
    assert_int_equal(ext->read(r->plugin, m->confidence, NULL), SV_OK);
    memcpy(m->depth, out.depth, sizeof m->depth);
    return m;
}

static void restart(rig *r, stage *t) {
    r->plugin->deactivate(r->plugin);
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
}

/* Where limbs float is found in the blocks of the frame's own camera: after others of the same volume its map
 * is that of a camera that came first. One without a fan may have been moved though its beams are the same.
 */
static void test_a_map_is_that_of_its_camera(void **state) {
    static const char *const layouts[] = {"single", "rays"};
    static const uint32_t order[] = {0, 0, 1, 0, 2, 3, 2, 1, 1};
    enum { VIEWS = 4, FRAMES = sizeof order / sizeof *order };
    const double mm = 1.05;
    rig *const r = *state;
    const hs_scene_data data = make_scene("E01", SIDE, 2, 1, 0);
    const sv_beams untold = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .side = {0, 0, -1}};
    sv_beams beams = untold;
    beams.kind = SV_BEAMS_FAN;
    beams.sweep_mm = -20;
    memcpy(beams.apex_mm, (const float[]){40, 40, -70}, sizeof beams.apex_mm);
    view views[VIEWS] = {from_before(data.full.voxels, 0, &beams)};
    views[1] = from_its_left(&views[0], mm);
    views[2] = from_before(data.full.voxels, 0, &untold);
    views[3] = from_before(data.full.voxels, 16, &untold);
    for (size_t n = 0; n < 2; n++) {
        const rig_format f = {.width = SIDE,
                              .height = SIDE,
                              .slices = SIDE,
                              .slab_slices = SIDE,
                              .carrier = SV_CARRIER_HOST,
                              .fixed = {{rig_param(r, "method"), 0, rig_enum(r, "method", "wall")},
                                        {rig_param(r, "strategy"), 0, rig_enum(r, "strategy", layouts[n])}}};
        stage *t = rig_stage(r, &f, data.full.voxels);
        for (int a = 0; a < 3; a++) t->format.spacing_mm[a] = (float)mm;
        const maps *alone[VIEWS];
        for (size_t v = 0; v < VIEWS; v++) {
            restart(r, t);
            alone[v] = look(r, t, &views[v], false);
        }
        restart(r, t);
        for (uint32_t i = 0; i < FRAMES; i++) {
            const maps *m = look(r, t, &views[order[i]], i > 0);
            if (memcmp(m, alone[order[i]], sizeof *m) != 0)
                fail_msg("%s: frame %u, camera %u has the map of another one", layouts[n], i, order[i]);
        }
        r->plugin->deactivate(r->plugin);
    }
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(test_a_map_is_that_of_its_camera))
