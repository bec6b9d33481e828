/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion against the exact mean of the source over every voxel's box, for a still and for turned
 * cameras: speckle in a fan, as a probe sees it.
 *
 * The bounds follow from the weights. A trilinear sample of the halved volume has the weights of a box of two
 * voxels convolved with a tent: [3, 3, 1, 1] / 8 along an axis where it lies a quarter between two of them,
 * as it does straight on. The box itself has [1, 1, 1] / 3. The difference of the two in three axes has a
 * root sum of squares of 0.134, so noise of a standard deviation of s is off by 0.134 s. Turned, the sample
 * lies anywhere between; next to a halved voxel it is the mean of eight voxels where the box has 27, and at
 * the edge of what was scanned it is the mean of eight nearest voxels: sqrt(1 / 8 - 1 / 27) s = 0.297 s at
 * most. s is 26 levels here: 0.297 * 26 = 7.7 RMS and 6.2 in the mean of a normal distribution.
 */
#include "render/scan_convert.h"
#include "support/host_fixture.h"

#include <math.h>

enum { SIZE = 72, SPREAD = 90 }; /* grey levels, even: a standard deviation of 26 */

/* Absolute differences from the exact means, grey levels, over the voxels that are scanned in both. */
typedef struct {
    double mean, rms;
    size_t voxels;   /* compared */
    size_t disputed; /* scanned in one and not in the other; neither mean counts them */
} box_error;

enum { PLACES = 12 }; /* along an edge: a quarter of a source voxel where three make an edge */

/* The value at a voxel index of the source; negative: not scanned there. */
static double value_at(const hs_volume *v, const double at[3]) {
    const double n[3] = {v->nx, v->ny, v->nz};
    double index[3];
    for (int k = 0; k < 3; k++) {
        if (at[k] < -0.5 || at[k] >= n[k] - 0.5) return -1.0;
        index[k] = floor(at[k] + 0.5);
    }
    const uint8_t voxel = v->voxels[((size_t)index[2] * v->ny + (size_t)index[1]) * v->nx + (size_t)index[0]];
    return voxel ? voxel : -1.0;
}

/* The exact mean over a voxel's box, of the source voxels in which 12^3 places of it lie; negative: less than
 * half of it was scanned. */
static double exact_mean(const hs_volume *v, const hs_box_map *map, const hs_slab_layout *l,
                         const uint32_t voxel[3]) {
    const double size[3] = {l->width, l->height, l->slices};
    const double *const axis[3] = {map->du, map->dv, map->dw};
    double sum = 0.0;
    int scanned = 0;
    for (int i = 0; i < PLACES * PLACES * PLACES; i++) {
        const int step[3] = {i % PLACES, i / PLACES % PLACES, i / PLACES / PLACES};
        double at[3];
        for (int k = 0; k < 3; k++) {
            at[k] = map->origin[k];
            for (int a = 0; a < 3; a++) at[k] += axis[a][k] * (voxel[a] + (step[a] + 0.5) / PLACES) / size[a];
        }
        const double value = value_at(v, at);
        if (value < 0.0) continue;
        sum += value;
        scanned++;
    }
    return 2 * scanned < PLACES * PLACES * PLACES ? -1.0 : sum / scanned;
}

/* Every `every`th voxel of a converted volume of width * height * slices bytes against the exact mean. */
static box_error measure(const hs_volume *source, const hs_camera *camera, const hs_slab_layout *l,
                         const uint8_t *voxels, uint32_t every) {
    box_error out = {0};
    hs_box_map map;
    hs_camera_box_map(camera, source, &map);
    for (uint32_t i = 0; i < l->width * l->height * l->slices; i += every) {
        const uint32_t voxel[3] = {i % l->width, i / l->width % l->height, i / l->width / l->height};
        const double exact = exact_mean(source, &map, l, voxel), off = fabs(voxels[i] - exact);
        if ((exact < 0.0) != (voxels[i] == 0)) out.disputed++;
        if (exact < 0.0 || voxels[i] == 0) continue;
        out.mean += off;
        out.rms += off * off;
        out.voxels++;
    }
    out.mean /= (double)out.voxels;
    out.rms = sqrt(out.rms / (double)out.voxels);
    return out;
}

/* Half as wide a fan at the front as at the back and 0 around it, or all of it scanned. */
static hs_volume make_volume(bool fan) {
    test_random random = {5};
    hs_volume v;
    must(hs_volume_init(&v, SIZE, SIZE, SIZE, &err));
    for (uint32_t i = 0; i < SIZE * SIZE * SIZE; i++) {
        const double x = i % SIZE - 0.5 * (SIZE - 1), z = i / (SIZE * SIZE);
        const bool scanned = !fan || fabs(x) < 0.25 * SIZE + 0.25 * z;
        const uint32_t noise = unit_random(&random.state) % (SPREAD + 1);
        v.voxels[i] = (uint8_t)(scanned ? 70 + noise : 0);
    }
    return v;
}

static box_error error_of(const hs_cl *cl, const hs_volume *v, double yaw, double pitch, double span) {
    hs_camera camera;
    hs_camera_look(&camera, v, yaw, pitch);
    const uint32_t across = (uint32_t)lround(camera.extent / span),
                   deep = (uint32_t)lround(camera.depth_extent / span);
    const hs_slab_layout l = {across, across, deep, deep, 1, across, across, across};
    const size_t count = (size_t)across * across * deep;
    return measure(v, &camera, &l, test_convert(cl, v, &camera, &l, 0, count).voxels, 7);
}

/* Of the voxels at the fan's edge, whose box is cut, some are scanned in one and not in the other: a layer
 * one voxel thick at most, and half a voxel in the mean. */
static void means_are_near_the_exact_ones(void **state) {
    static const struct {
        double yaw, pitch, span, limit; /* limit: of the RMS, of the noise's standard deviation */
        bool fan;
    } views[] = {{0, 0, 3, 0.134, false},  {0, 0, 3, 0.297, true},  {30, 20, 3, 0.297, true},
                 {45, 35, 3, 0.297, true}, {90, 0, 3, 0.297, true}, {-20, 80, 3.1, 0.297, true},
                 {15, 5, 4, 0.297, true}};
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        hs_volume v = make_volume(views[i].fan);
        const box_error e = error_of(*state, &v, views[i].yaw, views[i].pitch, views[i].span);
        print_message("%3g, %3g degrees, %g voxels%s: mean %.2f, RMS %.2f levels; %zu voxels, %zu disputed\n",
                      views[i].yaw, views[i].pitch, views[i].span, views[i].fan ? ", a fan" : "", e.mean,
                      e.rms, e.voxels, e.disputed);
        assert_true(e.voxels > 500);
        assert_true(e.rms <= views[i].limit * 26.3 + 0.1); /* the noise's own spread, and rounding */
        assert_true(e.mean <= 6.2);
        assert_true((double)e.disputed <= 0.05 * (double)e.voxels);
        hs_volume_free(&v);
    }
}

/* The measure can tell: a volume that is five levels too bright is five levels off. */
static void a_wrong_volume_is_told(void **state) {
    hs_volume v;
    hs_camera camera;
    uint8_t voxels[64];
    must(hs_volume_init(&v, 12, 12, 12, &err));
    memset(v.voxels, 100, 12 * 12 * 12);
    memset(voxels, 105, sizeof voxels);
    voxels[7] = 0;
    hs_camera_look(&camera, &v, 0, 0);
    const hs_slab_layout l = {4, 4, 4, 4, 1, 4, 4, 4};
    const box_error e = measure(&v, &camera, &l, voxels, 1);
    assert_int_equal(e.voxels, 63);
    assert_int_equal(e.disputed, 1);
    assert_true(fabs(e.mean - 5) < 1e-9 && fabs(e.rms - 5) < 1e-9);
    hs_volume_free(&v);
}

UNIT_MAIN(test_open_device, test_close_device, means_are_near_the_exact_ones, a_wrong_volume_is_told)
