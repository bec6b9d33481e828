/* SPDX-License-Identifier: MIT */
/*
 * Results make the round trip: a volume is clipped from five cameras, written, and read back by a reader of
 * the test's own. All that is compared is what stands in the files: where a voxel lies by their spacing,
 * offset and directions, on which side of the depthmap it is, and what it holds.
 * Requirement: R14.
 */
#include "support/result_files.h"
#include "support/result_fixture.h"

#include <math.h>

static void expect_the_sources_place(const result_file *file) {
    for (int a = 0; a < 3; a++) {
        assert_true(file->spacing[a] == source_spacing[a] && file->origin[a] == source_offset[a]);
        for (int k = 0; k < 3; k++) assert_true(file->direction[k * 3 + a] == source_directions[a * 3 + k]);
    }
    assert_int_equal(file->size[0], SOURCE_X);
    assert_int_equal(file->size[1], SOURCE_Y);
    assert_int_equal(file->size[2], SOURCE_Z);
}

/* How far before (< 0) or behind the depthmap a voxel's middle lies, mm; NAN where the map clips nothing. */
static double distance_to_cut(const result_file *volume, const result_file *map, size_t voxel) {
    const double index[3] = {(double)(voxel % SOURCE_X), (double)(voxel / SOURCE_X % SOURCE_Y),
                             (double)(voxel / SOURCE_X / SOURCE_Y)};
    double world[3], place[3];
    result_world(volume, index, world);
    result_index(map, world, place);
    const double depth = result_map_at(map, place[0], place[1]);
    return depth > 0 ? place[2] * map->spacing[2] - depth : NAN;
}

/* Half of a voxel along the map's depth, mm. */
static double half_voxel(const result_file *volume, const result_file *map) {
    double length = 0;
    for (int a = 0; a < 3; a++) {
        double along = 0;
        for (int k = 0; k < 3; k++) along += volume->direction[k * 3 + a] * map->direction[k * 3 + 2];
        length += fabs(along) * volume->spacing[a];
    }
    return 0.5 * length;
}

/* Every voxel is the source's and kept behind the map, and the fill value before it; within half a voxel it
 * may be either. */
static void expect_the_cut(const result_file *source, const result_file *clipped, const result_file *mask,
                           const result_file *map) {
    const double half = half_voxel(source, map);
    size_t kept = 0, cut = 0, wrong = 0;
    for (size_t i = 0; i < source->voxels; i++) {
        const double distance = distance_to_cut(source, map, i);
        const bool is_kept = mask->data[i] == 1;
        int16_t was, is;
        memcpy(&was, source->data + i * 2, 2);
        memcpy(&is, clipped->data + i * 2, 2);
        assert_true(mask->data[i] <= 1);
        assert_int_equal(is, is_kept ? was : SOURCE_LOWEST);
        kept += is_kept;
        cut += !is_kept;
        wrong += isnan(distance) || distance > half ? !is_kept : distance < -half && is_kept;
    }
    assert_int_equal(wrong, 0);
    assert_true(kept > source->voxels / 10 && cut > source->voxels / 10);
}

/* Every vertex is on a pixel's middle and as deep as the map says. Float32 at 1000 mm has 6e-5 mm. */
static void expect_vertices_on(const result_file *map, const result_mesh *mesh) {
    for (uint32_t i = 0; i < mesh->vertices; i++) {
        const float *v = mesh->vertex[i];
        const double world[3] = {(double)v[0], (double)v[1], (double)v[2]};
        double place[3];
        result_index(map, world, place);
        const double x = nearbyint(place[0]), y = nearbyint(place[1]);
        assert_true(fabs(place[0] - x) < 1e-3 && fabs(place[1] - y) < 1e-3);
        assert_true(fabs(place[2] * map->spacing[2] - result_map_at(map, x, y)) < 1e-3);
    }
}

static void expect_the_surface(const result_file *map, const char *path) {
    result_mesh mesh;
    result_mesh_open(&mesh, path);
    assert_true(mesh.vertices > 50 && mesh.faces > 50);
    expect_vertices_on(map, &mesh);
    for (uint32_t i = 0; i < mesh.faces; i++) {
        const float *v[3];
        double towards = 0;
        for (int c = 0; c < 3; c++) {
            assert_true(mesh.face[i][c] >= 0 && (uint32_t)mesh.face[i][c] < mesh.vertices);
            v[c] = mesh.vertex[mesh.face[i][c]];
        }
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            const double normal = (double)(v[1][a] - v[0][a]) * (double)(v[2][b] - v[0][b]) -
                                  (double)(v[1][b] - v[0][b]) * (double)(v[2][a] - v[0][a]);
            towards += normal * map->direction[k * 3 + 2];
        }
        assert_true(towards < -1e-3); /* a triangle, and its front faces the camera */
    }
}

static void five_cameras_make_the_round_trip(void **state) {
    static const struct {
        hs_from from;
        double yaw, pitch;
        bool has_probe;
        hs_probe probe;
    } cameras[] = {{HS_FROM_PROBE, 0, 0, false, HS_PROBE_LOW_Z},
                   {HS_FROM_PROBE, 33, -21, false, HS_PROBE_LOW_Z},
                   {HS_FROM_PROBE, 90, 0, true, HS_PROBE_HIGH_Z},
                   {HS_FROM_PROBE, -10, 5, true, HS_PROBE_HIGH_Y},
                   {HS_FROM_ANTERIOR, 0, 0, false, HS_PROBE_LOW_Z}};
    const result_fixture *f = *state;
    const char *const paths[] = {f->source};
    result_file source, clipped, mask, map, status;
    result_open(&source, f->source);
    for (size_t c = 0; c < sizeof cameras / sizeof *cameras; c++) {
        sv_param_value values[2];
        hs_loop_options options = result_options(values);
        options.from = cameras[c].from;
        options.yaw = cameras[c].yaw;
        options.pitch = cameras[c].pitch;
        const hs_metaimage_options read = {
            .padding = HS_PADDING_NONE, .has_probe = cameras[c].has_probe, .probe = cameras[c].probe};
        const hs_result_report report = result_write(f, paths, 1, &read, &options, HS_RESULT_ALL);
        assert_int_equal(report.what, HS_RESULT_ALL & ~HS_RESULT_CONFIDENCE); /* a plane has none */
        assert_int_equal(report.clipped, 1);
        assert_true(report.fill == SOURCE_LOWEST);
        result_open(&clipped, files_path("clipped.mha"));
        result_open(&mask, files_path("mask.mha"));
        result_open(&map, files_path("depthmap.mha"));
        result_open(&status, files_path("status.mha"));
        assert_string_equal(clipped.type, "MET_SHORT");
        expect_the_sources_place(&clipped);
        expect_the_sources_place(&mask);
        assert_int_equal(map.size[0], 24);
        assert_memory_equal(status.origin, map.origin, sizeof map.origin);
        assert_memory_equal(status.direction, map.direction, sizeof map.direction);
        expect_the_cut(&source, &clipped, &mask, &map);
        expect_the_surface(&map, files_path("surface.ply"));
    }
}

/* The anterior view's map looks from the front to the back, and its rows run down to the feet. */
static void the_maps_lie_as_the_camera_looks(void **state) {
    const result_fixture *f = *state;
    const char *const paths[] = {f->source};
    sv_param_value values[2];
    hs_loop_options options = result_options(values);
    options.from = HS_FROM_ANTERIOR;
    result_write(f, paths, 1, NULL, &options, HS_RESULT_DEPTHMAP);
    result_file map;
    result_open(&map, files_path("depthmap.mha"));
    static const double expected[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
    for (int i = 0; i < 9; i++) assert_true(fabs(map.direction[i] - expected[i]) < 1e-12);
    assert_non_null(strstr(map.text, "\nAnatomicalOrientation = RSA\n"));
}

/* A flat map at this depth lies that many slices deep everywhere; from the probe at slice 0, voxels are kept
 * from the slice on whose middle is that deep; and the middle of the view box is the middle of the volume. */
static void depth_is_in_millimetres(const result_fixture *f, double flat) {
    const char *const paths[] = {f->source};
    const sv_param_value values[] = {{.id = DEPTH, .value = flat}};
    const hs_loop_options options = options_with(values, 1);
    result_write(f, paths, 1, NULL, &options, HS_RESULT_DEPTHMAP | HS_RESULT_MASK);
    result_file map, mask;
    result_open(&map, files_path("depthmap.mha"));
    result_open(&mask, files_path("mask.mha"));
    for (uint32_t y = 0; y < map.size[1]; y++)
        for (uint32_t x = 0; x < map.size[0]; x++)
            assert_true(fabs(result_map_at(&map, x, y) - flat * map.spacing[2]) < 1e-5);
    assert_int_equal(mask.data[0], 0);
    for (size_t i = 0; i < mask.voxels; i++) {
        const double deep = ((double)(i / SOURCE_X / SOURCE_Y) + 0.5) * source_spacing[2];
        assert_int_equal(mask.data[i], deep >= (flat + 0.5) * map.spacing[2]);
    }
    const double slices = SOURCE_Z * source_spacing[2] / map.spacing[2];
    assert_true(fabs(slices - nearbyint(slices)) < 1e-9);
    const double box[3] = {0.5 * (map.size[0] - 1), 0.5 * (map.size[1] - 1), 0.5 * (slices - 1)};
    const double middle[3] = {0.5 * (SOURCE_X - 1), 0.5 * (SOURCE_Y - 1), 0.5 * (SOURCE_Z - 1)};
    double box_world[3], middle_world[3];
    result_world(&map, box, box_world);
    result_world(&mask, middle, middle_world);
    for (int k = 0; k < 3; k++) assert_true(fabs(box_world[k] - middle_world[k]) < 1e-9);
}

static void depths_are_millimetres(void **state) {
    depth_is_in_millimetres(*state, 9.0);
    depth_is_in_millimetres(*state, 0.375); /* less than half a slice */
}

/* The second volume of the first file, since its first one is invalid, then the second file's only one. */
static void expect_two_volumes(const result_file *clipped, const result_file *mask) {
    for (size_t i = 0; i < (size_t)2 * SOURCE_VOXELS; i++) {
        int16_t is;
        memcpy(&is, clipped->data + i * 2, 2);
        const int16_t was = source_voxel(i < SOURCE_VOXELS ? SOURCE_VOXELS + i : i - SOURCE_VOXELS);
        assert_int_equal(is, mask->data[i] ? was : SOURCE_LOWEST);
    }
}

static void sequences_give_sequences(void **state) {
    const result_fixture *f = *state;
    const char *const paths[] = {files_path("sequence.mha"), files_path("second.mha")};
    source_write(paths[0], 2,
                 "Seq_Frame0000_ImageStatus = INVALID\nSeq_Frame0001_Timestamp = 2.5\n"
                 "Seq_Frame0001_ProbeToTrackerTransform = 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n"
                 "Seq_Frame0001_ProbeToTrackerTransformStatus = INVALID\n");
    source_write(paths[1], 1, "");
    sv_param_value values[2];
    const hs_loop_options options = result_options(values);
    const hs_result_report report = result_write(f, paths, 2, NULL, &options, HS_RESULT_ALL);
    assert_true(report.volumes == 2 && report.clipped == 2 && report.fill == SOURCE_LOWEST);
    result_file clipped, mask, map;
    result_open(&clipped, files_path("clipped.mha"));
    result_open(&mask, files_path("mask.mha"));
    result_open(&map, files_path("depthmap.mha"));
    assert_true(clipped.dims == 4 && clipped.size[3] == 2 && mask.size[3] == 2 && map.size[3] == 2);
    expect_the_sources_place(&clipped);
    static const char *const lines[] = {
        "\nKinds = domain domain domain list\n", "\nSeq_Frame0000_Timestamp = 2.5\n",
        "\nSeq_Frame0000_ProbeToTrackerTransform = 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n",
        "\nSeq_Frame0000_ProbeToTrackerTransformStatus = INVALID\n", "\nSeq_Frame0001_ImageStatus = OK\n"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (!strstr(clipped.text, lines[i])) fail_msg("no line '%s'", lines[i]);
    expect_two_volumes(&clipped, &mask);
    result_mesh mesh;
    result_mesh_open(&mesh, files_path("surface_0001.ply"));
    assert_true(mesh.faces > 50);
}

/* A sequence that this project wrote is read back by it. */
static void sequences_read_back(void **state) {
    const char *const written[] = {files_path("clipped.mha")};
    const hs_source *source = open_source(written, 1, NULL);
    assert_int_equal(source->count, 2);
    const hs_frame_fields *fields = &hs_source_origin_of(source, 0)->fields;
    assert_true(fields->has_time && fields->time == 2.5 && fields->transform_count == 1);
    assert_true(hs_source_volume(source, 0)->pose.origin[2] == source_offset[2]);
}

UNIT_MAIN(result_set_up, result_tear_down, five_cameras_make_the_round_trip, the_maps_lie_as_the_camera_looks,
          depths_are_millimetres, sequences_give_sequences, sequences_read_back)
