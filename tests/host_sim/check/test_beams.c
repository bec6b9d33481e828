/* SPDX-License-Identifier: MIT */
/*
 * Probe geometry against an independent scalar conversion in float64: the Cartesian copy, voxel for voxel,
 * and the low-resolution slabs with every ray's scanned range, for unlike geometries and for cameras that
 * look into the fan from all sides.
 */
#include "render/scan_convert.h"
#include "support/host_fixture.h"
#include "support/ref_beams.h"
#include "volume/volume.h"

#include <math.h>

typedef struct {
    uint32_t samples, lines, planes;
    double pitch, start, axis; /* mm */
    double theta, phi;         /* rad: half of what they span */
    int uneven, descending, mirrored;
} geometry;

/* Like the ones that were seen: an abdominal probe with its axis behind the array, an endocavity probe with
 * its axis before it, and both with all that tables may do; one that starts in the centre of curvature. */
static const geometry geometries[] = {
    {180, 48, 36, 0.21, 8.5, -3.9, 0.61, 0.74, 0, 0, 0}, {120, 40, 30, 0.30, 11.0, 6.0, 0.9, 1.1, 0, 0, 1},
    {90, 33, 29, 0.45, 10.0, 4.0, 0.7, 0.5, 1, 1, 0},    {150, 25, 22, 0.25, 41.0, -20.0, 0.4, 0.6, 1, 0, 1},
    {60, 20, 15, 0.60, 0.0, -2.0, 1.3, 1.2, 0, 1, 0},
};
#define GEOMETRIES (sizeof geometries / sizeof geometries[0])

/* `count` angles from -half to half, or the other way; uneven ones lie closer in the middle. */
static double *angles(uint32_t count, double half, int uneven, int descending) {
    double *table = unit_memory(count * sizeof *table);
    for (uint32_t i = 0; i < count; i++) {
        const double t = 2.0 * i / (count - 1) - 1.0;
        table[i] = (descending ? -half : half) * (uneven ? t * (0.7 + 0.3 * t * t) : t);
    }
    return table;
}

static hs_beams *make_beams(const geometry *g) {
    double *theta = angles(g->lines, g->theta, g->uneven, 0);
    double *phi = angles(g->planes, g->phi, g->uneven, g->descending);
    const hs_beams shape = {.samples = g->samples,
                            .lines = g->lines,
                            .planes = g->planes,
                            .pitch = g->pitch,
                            .start = g->start,
                            .axis = g->axis,
                            .theta = theta,
                            .phi = phi,
                            .mirrored = g->mirrored};
    hs_error err = {0};
    hs_beams *beams = hs_beams_like(&shape, &err);
    assert_non_null(beams);
    return beams;
}

/* The Cartesian copy of a geometry whose echoes are noise, black ones among them, or what `field` says of
 * their place. */
static hs_volume make_volume(const geometry *g, double spacing, double (*field)(const double[3])) {
    test_random random = {77};
    hs_volume volume;
    hs_beams *b = make_beams(g);
    for (size_t n = 0; n < hs_beams_count(b); n++) {
        double place[3];
        ref_beams_place(b, (uint32_t)(n % b->samples), (uint32_t)(n / b->samples % b->lines),
                        (uint32_t)(n / b->samples / b->lines), place);
        b->voxels[n] =
            (uint8_t)(field ? lrint(field(place))
                            : (int)(unit_random(&random.state) % 4 ? unit_random(&random.state) % 256 : 0));
    }
    must(hs_beams_cartesian_init(&volume, b, spacing, &err));
    hs_beams_cartesian_fill(&volume);
    return volume;
}

static void centre_of(const hs_volume *v, uint32_t x, uint32_t y, uint32_t z, double place[3]) {
    const uint32_t at[3] = {x, y, z};
    for (int a = 0; a < 3; a++) place[a] = v->beams->corner[a] + (at[a] + 0.5) * v->spacing[a];
}

/* Within half a grey level, which is the rounding, for all voxels; and what was scanned is what the reference
 * says, for every voxel that is not within a billionth of a sample of the border. */
static void cartesian_copy_is_the_reference(void **state) {
    for (size_t g = 0; g < GEOMETRIES; g++) {
        hs_volume v = make_volume(&geometries[g], 0.83, NULL);
        size_t scanned = 0;
        for (size_t n = 0; n < hs_volume_count(&v); n++) {
            double place[3];
            centre_of(&v, (uint32_t)(n % v.nx), (uint32_t)(n / v.nx % v.ny), (uint32_t)(n / v.nx / v.ny),
                      place);
            const ref_echo echo = ref_beams_at(v.beams, place);
            if (echo.margin < 1e-9) continue;
            if (echo.echo < 0.0 ? v.voxels[n] != 0
                                : v.voxels[n] == 0 || fabs(v.voxels[n] - fmax(echo.echo, 1.0)) > 0.5 + 1e-9)
                fail_msg("geometry %zu, voxel %zu: %d, expected %.6f", g, n, v.voxels[n], echo.echo);
            scanned += echo.echo >= 0.0;
        }
        assert_true(scanned > hs_volume_count(&v) / 10);
        hs_volume_free(&v);
    }
}

/* Linear but for the steps between samples: it tells left from right and near from far. */
static double slope(const double p[3]) {
    return 100.0 + 0.7 * p[0] - 0.5 * p[1] + 0.6 * p[2];
}

/* Unlike geometries that saw the same tissue show it in the same places: what is in a voxel is what is there,
 * by the forward formulae, to what a line's steps and the rounding of echoes lose. */
static void tissue_is_where_it_was(void **state) {
    for (size_t g = 0; g < GEOMETRIES; g++) {
        hs_volume v = make_volume(&geometries[g], 0.9, slope);
        const hs_beams *b = v.beams;
        const double end = b->start + b->samples * b->pitch;
        const double step =
            fmax(2.4 * geometries[g].theta / (b->lines - 1), 2.4 * geometries[g].phi / (b->planes - 1));
        /* A chord of an arc of radius r lies step^2 / 8 r below it; two of them, and rounding twice. */
        const double allowed = 2.0 * (1.1 * (end + fabs(b->axis)) * step * step / 8.0) + 1.0;
        assert_true(allowed < 4.0);
        for (size_t n = 0; n < hs_volume_count(&v); n++) {
            double place[3];
            centre_of(&v, (uint32_t)(n % v.nx), (uint32_t)(n / v.nx % v.ny), (uint32_t)(n / v.nx / v.ny),
                      place);
            if (v.voxels[n] != 0 && fabs(v.voxels[n] - slope(place)) > allowed)
                fail_msg("geometry %zu at (%.2f, %.2f, %.2f): %d, expected %.2f", g, place[0], place[1],
                         place[2], v.voxels[n], slope(place));
        }
        hs_volume_free(&v);
    }
}

/* Points behind the sweep's axis and behind the array have tangents of points in the fan. */
static void ghosts_are_not_scanned(void **state) {
    hs_beams *b = make_beams(&geometries[0]);
    double index[3], place[3];
    for (uint32_t i = 0; i < b->samples; i += 7) {
        ref_beams_place(b, i, b->lines / 2, b->planes / 3, place);
        assert_true(hs_beams_locate(b, place, index));
        assert_true(fabs(index[0] - i) < 1e-9);
        const double behind_axis[3] = {place[0], -place[1], 2.0 * b->axis - place[2]};
        assert_false(hs_beams_locate(b, behind_axis, index));
        const double behind_array[3] = {-place[0], -place[1], -place[2]};
        assert_false(hs_beams_locate(b, behind_array, index));
    }
    hs_beams_free(b);
}

/* The box touches what was scanned on all six sides, and the copy holds all of it. */
static void box_holds_the_fan(void **state) {
    for (size_t g = 0; g < GEOMETRIES; g++) {
        double low[3], high[3], seen_low[3] = {1e9, 1e9, 1e9}, seen_high[3] = {-1e9, -1e9, -1e9};
        hs_volume v = make_volume(&geometries[g], 0.7, NULL);
        const hs_beams *b = v.beams;
        hs_beams_box(b, low, high);
        for (size_t n = 0; n < hs_beams_count(b); n++) {
            double p[3];
            ref_beams_place(b, (uint32_t)(n % b->samples), (uint32_t)(n / b->samples % b->lines),
                            (uint32_t)(n / b->samples / b->lines), p);
            for (int a = 0; a < 3; a++) {
                seen_low[a] = fmin(seen_low[a], p[a]);
                seen_high[a] = fmax(seen_high[a], p[a]);
            }
        }
        const double size[3] = {v.nx * v.spacing[0], v.ny * v.spacing[1], v.nz * v.spacing[2]};
        for (int a = 0; a < 3; a++) {
            assert_true(seen_low[a] >= low[a] - 1e-9 && seen_high[a] <= high[a] + 1e-9);
            assert_true(seen_low[a] - low[a] < 0.5 &&
                        high[a] - seen_high[a] < 0.5); /* samples in the middle of it */
            assert_true(b->corner[a] <= low[a] + 1e-6 && b->corner[a] + size[a] >= high[a] - 1e-6);
            assert_true(size[a] - (high[a] - low[a]) < v.spacing[a]);
        }
        hs_volume_free(&v);
    }
}

static void spacing_is_bounded(void **state) {
    hs_volume v;
    hs_beams *b = make_beams(&geometries[0]);
    must(hs_beams_cartesian_init(&v, b, 0.0, &err));
    assert_true(v.spacing[0] >= b->pitch && v.nx <= HS_CARTESIAN_AXIS && v.ny <= HS_CARTESIAN_AXIS);
    hs_volume_free(&v);
    b = make_beams(&geometries[0]);
    must_not(hs_beams_cartesian_init(&v, b, 0.001, &err), HS_ERR_USAGE, "");
    assert_null(v.voxels);
    hs_beams_free(b);
}

typedef struct {
    size_t geometry;
    double yaw, pitch;
    uint32_t lowres[3];
} view;

static const view views[] = {
    {0, 0, 0, {23, 23, 21}},    {0, 90, 0, {22, 22, 30}},    {1, 0, 0, {21, 21, 25}},
    {1, 35, -20, {24, 24, 29}}, {2, -110, 40, {20, 20, 26}}, {2, 0, 90, {21, 21, 21}},
    {3, 20, 0, {22, 22, 19}},   {4, 0, 0, {25, 25, 18}},     {4, 180, 0, {19, 19, 19}},
    {3, 0, 0, {48, 48, 40}},
};

static test_slabs convert(const hs_cl *cl, const hs_volume *v, const hs_camera *camera,
                          const hs_slab_layout *l) {
    return test_convert(cl, v, camera, l, 0, hs_slab_bytes(l, l->slab_slices));
}

/* As scan_convert.h says for a Cartesian source of this spacing. */
static void samples_of(const hs_volume *v, const hs_camera *camera, const hs_slab_layout *l, int grid[3]) {
    const double edge[3] = {camera->extent / l->width, camera->extent / l->height,
                            camera->depth_extent / l->slices};
    for (int a = 0; a < 3; a++) {
        const double span = edge[a] / v->spacing[a];
        grid[a] = (int)fmin(fmax(round(span / 1.5), span >= 1.5 * (1.0 - 1e-6) ? 2.0 : 1.0), 8.0);
    }
}

/*
 * Voxels: half a level for the rounding, and float32 positions: a place is good to 2e-5 mm, so an index to
 * 1e-4, of 255 levels. Ranges: first and last voxel that is scanned, the very same, for all rays none of
 * whose voxels has a sample within a thousandth of the border; those are few.
 */
static void check_view(const hs_cl *cl, const view *w) {
    hs_camera camera;
    int grid[3];
    hs_volume v = make_volume(&geometries[w->geometry], 1.0, NULL);
    const hs_slab_layout layout = {w->lowres[0], w->lowres[1], w->lowres[2], 7, 1,
                                   w->lowres[0], w->lowres[1], w->lowres[0]};
    hs_camera_look(&camera, &v, w->yaw, w->pitch);
    samples_of(&v, &camera, &layout, grid);
    const test_slabs out = convert(cl, &v, &camera, &layout);
    const size_t rays = (size_t)layout.width * layout.height;
    size_t undecided = 0, crossed = 0;
    for (size_t ray = 0; ray < rays; ray++) {
        uint32_t first = layout.slices, end = 0;
        bool decided = true;
        for (uint32_t z = 0; z < layout.slices; z++) {
            const int got = out.voxels[z * rays + ray];
            const ref_beams_voxel e =
                ref_beams_convert(&v, &camera, &layout, grid, (uint32_t)(ray % layout.width),
                                  (uint32_t)(ray / layout.width), z);
            if (e.value != 0 && first == layout.slices) first = z;
            if (e.value != 0) end = z + 1;
            if (!e.decided)
                decided = false;
            else if ((got == 0) != (e.value == 0))
                fail_msg("view %td, ray %zu, slice %u: %d, expected %.4f", w - views, ray, z, got, e.mean);
            if (e.close == 0 && got > 0 && fabs(got - e.mean) > 0.5 + 255.0 * 1e-4)
                fail_msg("view %td, ray %zu, slice %u: %d, expected %.4f", w - views, ray, z, got, e.mean);
        }
        if (first == layout.slices) first = end = 0;
        crossed += end > first;
        undecided += !decided;
        const cl_ushort2 r = out.ranges[ray];
        const bool none = r.s[0] >= r.s[1];
        if (decided && (none ? end > first : r.s[0] != first || r.s[1] != end))
            fail_msg("view %td, ray %zu: scanned %u .. %u, expected %u .. %u", w - views, ray, r.s[0], r.s[1],
                     first, end);
    }
    assert_true(crossed > rays / 10);
    if (undecided * 50 > rays)
        fail_msg("view %td: %zu of %zu rays graze the border", w - views, undecided, rays);
    hs_volume_free(&v);
}

static void slabs_and_ranges_are_the_reference(void **state) {
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) check_view(*state, &views[i]);
}

/* A sequence brings another volume, and then one of other angles, without a new device volume. */
static void volumes_follow_each_other(void **state) {
    hs_error err = {0};
    hs_camera camera;
    const hs_slab_layout layout = {20, 20, 20, 20, 1, 20, 20, 20};
    geometry other = geometries[2];
    other.uneven = 0;
    hs_volume v[2] = {make_volume(&geometries[2], 0.8, NULL), make_volume(&other, 0.8, slope)};
    hs_camera_look(&camera, &v[0], 10, 20);
    const test_slabs alone[2] = {convert(*state, &v[0], &camera, &layout),
                                 convert(*state, &v[1], &camera, &layout)};
    hs_device_volume *source = hs_device_volume_create(*state, &v[0], &err);
    hs_scan_converter *converter = hs_scan_converter_create(*state, &layout, &err);
    assert_true(source && converter);
    uint8_t out[8000];
    cl_mem buffer = test_buffer(*state, sizeof out, NULL);
    for (int turn = 0; turn < 5; turn++) {
        if (!hs_device_volume_replace(source, &v[turn % 2], &err) ||
            !hs_scan_convert_slab(converter, source, &camera, 0, buffer, 0, NULL, &err))
            fail_msg("%s", err.text);
        test_read(*state, buffer, sizeof out, out);
        assert_memory_equal(out, alone[turn % 2].voxels, sizeof out);
    }
    hs_volume plain = v[0];
    plain.beams = NULL;
    assert_false(hs_device_volume_replace(source, &plain, &err));
    assert_int_equal(err.code, HS_ERR_INPUT);
    clReleaseMemObject(buffer);
    hs_scan_converter_destroy(converter);
    hs_device_volume_destroy(source);
    for (int i = 0; i < 2; i++) hs_volume_free(&v[i]);
}

int main(void) {
    return UNIT_RUN("shapes", NULL, NULL, cartesian_copy_is_the_reference, tissue_is_where_it_was,
                    ghosts_are_not_scanned, box_holds_the_fan, spacing_is_bounded) +
           UNIT_RUN("packets", test_open_device, test_close_device, slabs_and_ranges_are_the_reference,
                    volumes_follow_each_other) +
           UNIT_RUN("single voxels", test_open_single, test_close_device, slabs_and_ranges_are_the_reference,
                    volumes_follow_each_other);
}
