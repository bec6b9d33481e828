/* SPDX-License-Identifier: MIT */
#include "bench/methods.h"

#include "base/output_file.h"
#include "loop/view.h"
#include "ref/ref_chain.h"
#include "ref/ref_points.h"
#include "spline/spline_shared.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- points -- */

enum { ALIGN = 4096, NO_SCAN_PADDING = -1 };

static bool allocate(methods_map *map, uint32_t n, hs_error *err) {
    const size_t rays = (size_t)n * n;
    *map = (methods_map){.n = n, .bytes = (rays * METHODS_SLICES + ALIGN - 1) / ALIGN * ALIGN};
    map->voxels = aligned_alloc(ALIGN, map->bytes);
    map->status = calloc(rays, 1);
    map->near_end = calloc(rays, sizeof *map->near_end);
    map->far_end = calloc(rays, sizeof *map->far_end);
    if (map->voxels && map->status && map->near_end && map->far_end) return true;
    methods_map_free(map);
    return hs_fail(err, HS_ERR_MEMORY, "initial points: no memory for %u x %u rays", n, n);
}

void methods_map_free(methods_map *map) {
    free(map->voxels);
    free(map->status);
    free(map->near_end);
    free(map->far_end);
    *map = (methods_map){0};
}

/* Status and ends of the volume's rays, by the definition of the ray profile with the plugin's defaults. */
static bool find_points(methods_map *map, hs_error *err) {
    const size_t rays = (size_t)map->n * map->n;
    const sv_ref_volume volume = {map->voxels, map->n, map->n, METHODS_SLICES, NO_SCAN_PADDING, NULL};
    const sv_ref_bone bone = {.fluid_threshold = (BENCH_FLUID_LEVEL + 0.5) / 255.0,
                              .bone_mode = SV_REF_OFFSET,
                              .bone_offset = 0.24};
    sv_ref_ray *ray = malloc(rays * sizeof *ray);
    double *ends = malloc(2 * rays * sizeof *ends);
    if (ray && ends) {
        sv_ref_profile(&volume, bone.fluid_threshold, 1, ray);
        map->points = sv_ref_points(ray, rays, &bone, sv_ref_bone_level(ray, rays, &bone), map->status, ends,
                                    ends + rays);
        for (size_t i = 0; i < rays; i++) { /* one sample a slice: ends are whole */
            map->near_end[i] = (uint16_t)ends[i];
            map->far_end[i] = (uint16_t)ends[rays + i];
        }
    }
    const bool ok = ray && ends;
    free(ray);
    free(ends);
    if (!ok) methods_map_free(map);
    return ok || hs_fail(err, HS_ERR_MEMORY, "initial points: no memory for %zu rays", rays);
}

bool methods_map_bones(methods_map *map, uint32_t n, hs_error *err) {
    if (!allocate(map, n, err)) return false;
    uint8_t *slice[METHODS_SLICES];
    for (size_t z = 0; z < METHODS_SLICES; z++) slice[z] = map->voxels + z * n * n;
    if (bench_volume_fill(n, METHODS_SLICES, slice, n, err)) return find_points(map, err);
    methods_map_free(map);
    return false;
}

/* Ray i: tissue, fluid between two wavy layers, and bone behind. */
static void put_point(methods_map *map, size_t i) {
    const size_t rays = (size_t)map->n * map->n;
    const size_t x = i % map->n, y = i / map->n;
    const double u = (double)x / map->n, v = (double)y / map->n;
    const size_t near_end = (size_t)(14.0 + 5.0 * sin(9.0 * u) + 4.0 * cos(7.0 * v));
    const size_t far_end = (size_t)(40.0 + 9.0 * sin(8.0 * u + 1.0) * cos(6.0 * v));
    for (size_t z = near_end; z < far_end; z++) map->voxels[z * rays + i] = 0;
    for (size_t z = far_end; z < METHODS_SLICES; z++) map->voxels[z * rays + i] = 255;
}

bool methods_map_scattered(methods_map *map, uint32_t n, uint32_t count, hs_error *err) {
    if (!allocate(map, n, err)) return false;
    const size_t rays = (size_t)n * n;
    memset(map->voxels, 100, map->bytes);
    uint32_t random = 2654435761u;
    for (uint32_t found = 0; found < count;) {
        random ^= random << 13; /* xorshift */
        random ^= random >> 17;
        random ^= random << 5;
        const size_t i = random % rays;
        if (map->status[i]) continue;
        map->status[i] = 1; /* taken; find_points will set it for good */
        put_point(map, i);
        found++;
    }
    return find_points(map, err);
}

bool methods_map_write(const methods_map *map, const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (!hs_output_open(&output, path, err)) return false;
    for (size_t i = 0; i < (size_t)map->n * map->n; i++)
        if (map->status[i])
            (void)fprintf(output.file, "%zu %zu %u %u\n", i % map->n, i / map->n, map->near_end[i],
                          map->far_end[i]);
    return hs_output_commit(&output, err);
}

/* ----------------------------------------------------------------------------------------- definitions -- */

double methods_reference_cost(const methods_map *map, const methods_variant *v) {
    const double n = map->n, pixels = n * n;
    const double points =
        fmin(map->points, v->merge_grid ? v->merge_grid * v->merge_grid : SV_SPLINE_MAX_POINTS);
    const uint32_t reach = v->k / 2;
    if (v->method == SV_METHOD_SPLINE) /* elimination; a logarithm a pixel and point */
        return points * points * points + 10.0 * pixels * points;
    /* filters: k^2 a pixel and pass; gaps of 0.385 sides, k / 2 of which a pass closes */
    return pixels * v->k * v->k * ceil(0.385 * n / reach);
}

double *methods_reference_make(const methods_map *map, const methods_variant *v, float q, hs_error *err) {
    const size_t count = (size_t)map->n * map->n;
    double *depth = malloc(count * sizeof *depth), *surface = malloc(count * sizeof *surface);
    sv_ref_settings settings = sv_ref_default_settings; /* the plugin's */
    settings.kernel = v->k;
    settings.merge_grid = v->merge_grid;
    const sv_ref_task task = {
        .map = {.status = map->status, .depth = depth, .width = map->n, .height = map->n},
        .settings = &settings};
    /* In float32, as the minimum filter gets them: it must be exact. */
    for (size_t i = 0; depth && i < count; i++)
        depth[i] = (double)((float)map->far_end[i] + q * ((float)map->near_end[i] - (float)map->far_end[i]));
    const bool ok = depth && surface && sv_ref_chain(sv_ref_method_of(v->method), &task, surface, NULL);
    free(depth);
    if (ok) return surface;
    free(surface);
    (void)hs_fail(err, HS_ERR_MEMORY, "definition of %s: no memory for %zu pixels", v->label, count);
    return NULL;
}

bool methods_reference_same(const methods_variant *a, const methods_variant *b) {
    return a->method == b->method && a->k == b->k && a->merge_grid == b->merge_grid;
}

methods_error methods_error_of(const float *depth, const double *reference, size_t count) {
    methods_error error = {.known = true};
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double off = isfinite(depth[i]) ? fabs((double)depth[i] - reference[i]) : (double)INFINITY;
        error.largest = fmax(error.largest, off);
        sum += off;
    }
    error.mean = sum / (double)count;
    return error;
}

/* ---------------------------------------------------------------------------------------------- scenes -- */

const char *const methods_scene_names[METHODS_SCENES] = {"D01", "E01", "M02"};

static bool view_scene(const hs_cl *cl, const hs_source *source, const hs_plugin *plugin,
                       const methods_values *values, hs_view *view, hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = METHODS_SCENE_SIZE;
    options.dvr.width = options.dvr.height = METHODS_SCENE_SIZE;
    options.values = values ? values->all : NULL;
    options.value_count = values ? values->count : 0;
    hs_loop *loop = hs_loop_create(cl, source, plugin, &options, err);
    if (!loop) return false;
    bool ok = hs_loop_view(loop, 0, view, err);
    const hs_error *failed = hs_loop_plugin_error(loop);
    if (ok && plugin && failed->code != HS_OK) {
        hs_view_free(view);
        ok = hs_fail(err, failed->code, "%s", failed->text);
    }
    hs_loop_destroy(loop);
    return ok;
}

/* Picture pixels lie on the label map's: the camera at 0, 0 sees exactly the volume. */
static double difference(const methods_scene *scene, const float *termination) {
    const uint8_t *label = scene->source.scenes[0].label;
    double sum = 0.0;
    size_t rays = 0;
    for (size_t i = 0; i < (size_t)METHODS_SCENE_SIZE * METHODS_SCENE_SIZE; i++) {
        if (label[i] == HS_LABEL_NEITHER) continue;
        sum += fabs((double)termination[i] - (double)scene->truth[i]);
        rays++;
    }
    return rays ? sum / (double)rays : 0.0;
}

bool methods_scene_open(methods_scene *scene, const hs_cl *cl, const char *name, hs_error *err) {
    const hs_source_scene what = {.name = name, .size = METHODS_SCENE_SIZE, .volumes = 1};
    *scene = (methods_scene){0};
    hs_view clear = {0}, full = {0};
    if (!hs_source_open_scene(&scene->source, &what, err)) return false;
    const hs_source truth = {.volumes = scene->source.truths, .count = 1};
    bool ok = view_scene(cl, &truth, NULL, NULL, &clear, err) &&
              view_scene(cl, &scene->source, NULL, NULL, &full, err);
    if (ok) {
        scene->truth = clear.termination;
        clear.termination = NULL;
        scene->unclipped = difference(scene, full.full_termination);
    }
    hs_view_free(&clear);
    hs_view_free(&full);
    if (!ok) methods_scene_close(scene);
    return ok;
}

void methods_scene_close(methods_scene *scene) {
    hs_source_close(&scene->source);
    free(scene->truth);
    *scene = (methods_scene){0};
}

bool methods_scene_difference(const methods_scene *scene, const hs_cl *cl, const hs_plugin *plugin,
                              const methods_variant *variant, double *slices, bool *clipped, hs_error *err) {
    methods_values values;
    hs_view view = {0};
    if (!methods_values_make(plugin, variant, &values, err) ||
        !view_scene(cl, &scene->source, plugin, &values, &view, err))
        return false;
    *slices = difference(scene, view.termination);
    *clipped = view.frame.clipped;
    hs_view_free(&view);
    return true;
}
