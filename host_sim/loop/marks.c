/* SPDX-License-Identifier: MIT */
#include "loop/marks.h"

#include <math.h>
#include <string.h>

#define GAP_MM 2.0 /* of fluid, between two runs of tissue */

/* A mark as the box sees it. */
typedef struct {
    double at[3];  /* pixel x, y, slice */
    double radius; /* mm */
    uint32_t threshold;
    bool keep;
} seen_mark;

typedef struct {
    const hs_volume *volume;
    hs_box_map map;
    uint32_t n[3];
    double pixel, slice; /* mm */
    seen_mark mark;
} scene;

/* The mean of the scanned voxels around a place of the grid; 0: nothing was scanned there. */
static uint32_t level_at(const scene *s, uint32_t x, uint32_t y, uint32_t z) {
    const hs_volume *v = s->volume;
    const double place[3] = {(x + 0.5) / s->n[0], (y + 0.5) / s->n[1], (z + 0.5) / s->n[2]};
    const uint32_t size[3] = {v->nx, v->ny, v->nz};
    uint32_t at[3], first[3], last[3];
    if (!hs_box_map_voxel(&s->map, v, place, at)) return 0;
    for (int a = 0; a < 3; a++) {
        first[a] = at[a] > 0 ? at[a] - 1 : 0;
        last[a] = at[a] + 1 < size[a] ? at[a] + 1 : at[a];
    }
    uint32_t sum = 0, count = 0;
    for (uint32_t k = first[2]; k <= last[2]; k++)
        for (uint32_t j = first[1]; j <= last[1]; j++)
            for (uint32_t i = first[0]; i <= last[0]; i++) {
                const uint8_t level = v->voxels[((size_t)k * size[1] + j) * size[0] + i];
                sum += level;
                count += level != 0;
            }
    return count ? sum / count : 0;
}

static bool is_near(const scene *s, uint32_t x, uint32_t y) {
    const double right = x - s->mark.at[0], down = y - s->mark.at[1];
    return fabs(right) * s->pixel <= s->mark.radius && hypot(right, down) * s->pixel <= s->mark.radius;
}

/* In slices. */
static double reach_of(const scene *s) {
    return 2.0 * s->mark.radius / s->slice;
}

/* Otsu's: levels above it are tissue. */
static uint32_t split(const uint64_t histogram[256]) {
    double total = 0, sum = 0, below = 0, sum_below = 0, best = -1;
    uint32_t threshold = 0;
    for (uint32_t i = 1; i < 256; i++) {
        total += (double)histogram[i];
        sum += (double)histogram[i] * i;
    }
    for (uint32_t i = 1; i < 256; i++) {
        below += (double)histogram[i];
        sum_below += (double)histogram[i] * i;
        if (below <= 0 || below >= total) continue;
        const double apart = sum_below / below - (sum - sum_below) / (total - below);
        const double between = below * (total - below) * apart * apart;
        if (between <= best) continue;
        best = between;
        threshold = i;
    }
    return threshold;
}

/* Of what is at most `reach` slices before or behind the mark. */
static void find_threshold(scene *s, double reach) {
    uint64_t histogram[256] = {0};
    for (uint32_t y = 0; y < s->n[1]; y++)
        for (uint32_t x = 0; x < s->n[0]; x++)
            for (uint32_t z = 0; is_near(s, x, y) && z < s->n[2]; z++)
                if (fabs(z - s->mark.at[2]) <= reach) histogram[level_at(s, x, y, z)]++;
    s->mark.threshold = split(histogram);
}

/* The first run of tissue from slice `z` on that ends behind slice `from`: [first, end). False: none does. */
static bool find_run(const scene *s, uint32_t x, uint32_t y, uint32_t z, double from, uint32_t run[2]) {
    const uint32_t gap = (uint32_t)fmax(1.0, ceil(GAP_MM / s->slice));
    bool open = false;
    for (; z < s->n[2]; z++) {
        if (level_at(s, x, y, z) > s->mark.threshold) {
            if (!open) run[0] = z;
            open = true;
            run[1] = z + 1;
        } else if (open && z + 1 - run[1] >= gap) {
            if (run[1] > from) return true;
            open = false;
        }
    }
    return open && run[1] > from;
}

static float start_of(const uint32_t run[2]) {
    return run[0] > 0 ? (float)(run[0] - 1) : 0.0f;
}

/* The run that the mark keeps of this ray, if it was cut. */
static bool find_kept(const scene *s, uint32_t x, uint32_t y, double start, uint32_t run[2]) {
    const double reach = reach_of(s), z = s->mark.at[2];
    return find_run(s, x, y, 0, fmax(0.0, z - reach), run) && run[0] <= z + reach &&
           (double)start_of(run) < start;
}

/* `taken`: the end of what a mark before it took of this ray, or -INFINITY. */
static void apply_to(const scene *s, uint32_t x, uint32_t y, float *depth, double *taken) {
    const double reach = reach_of(s), start = fmax(0.0, *depth), z = s->mark.at[2];
    uint32_t run[2], next[2];
    if (s->mark.keep) {
        if (!find_kept(s, x, y, (double)*depth, run)) return;
        *depth = start_of(run);
        *taken = -INFINITY;
        return;
    }
    if (!find_run(s, x, y, 0, start, run)) return;
    const double seen = fmax(start, run[0]); /* a start inside a run shows what is left of it */
    if (fabs(seen - z) > reach || fabs(*taken - z) < fabs(seen - z)) return;
    if (!find_run(s, x, y, run[1], run[1], next)) return;
    *depth = start_of(next);
    *taken = run[1];
}

static double middle_of(const hs_volume *v, size_t axis) {
    const uint32_t size[3] = {v->nx, v->ny, v->nz};
    return 0.5 * (size[axis] - 1.0) * v->spacing[axis];
}

void hs_marks_seen(const hs_volume *volume, const hs_camera *camera, const double place[3], double seen[3]) {
    double from_middle[3];
    for (size_t a = 0; a < 3; a++) from_middle[a] = place[a] - middle_of(volume, a);
    for (size_t a = 0; a < 3; a++)
        seen[a] = camera->rotation[a] * from_middle[0] + camera->rotation[3 + a] * from_middle[1] +
                  camera->rotation[6 + a] * from_middle[2];
}

void hs_marks_place(const hs_volume *volume, const hs_camera *camera, const double seen[3], double place[3]) {
    for (size_t a = 0; a < 3; a++) {
        const double *row = &camera->rotation[3 * a];
        place[a] = row[0] * seen[0] + row[1] * seen[1] + row[2] * seen[2] + middle_of(volume, a);
    }
}

static scene scene_of(const hs_volume *volume, const hs_camera *camera, const uint32_t n[3]) {
    scene s = {.volume = volume, .pixel = camera->extent / n[0], .slice = camera->depth_extent / n[2]};
    memcpy(s.n, n, sizeof s.n);
    hs_camera_box_map(camera, volume, &s.map);
    return s;
}

/* Where the mark lies in the box, whose middle is the volume's. */
static void locate(scene *s, const hs_mark *mark, const hs_camera *camera) {
    double seen[3];
    hs_marks_seen(s->volume, camera, mark->place, seen);
    s->mark = (seen_mark){.at = {(seen[0] + 0.5 * camera->extent) / s->pixel - 0.5,
                                 (seen[1] + 0.5 * camera->extent) / s->pixel - 0.5,
                                 (seen[2] + 0.5 * camera->depth_extent) / s->slice - 0.5},
                          .radius = mark->radius,
                          .keep = mark->keep};
}

/* Whether a mark at slice z lies on tissue that it would keep. Fluid alone has a threshold below `least`. */
static bool keeps_at(scene *s, uint32_t x, uint32_t y, double z, double start, double least) {
    uint32_t run[2];
    s->mark.at[2] = z;
    find_threshold(s, reach_of(s));
    return s->mark.threshold >= least && find_kept(s, x, y, start, run) && run[0] <= z && z < run[1];
}

bool hs_marks_find_cut(hs_mark *mark, const hs_volume *volume, const hs_camera *camera, const uint32_t n[3],
                       const float *depth) {
    scene s = scene_of(volume, camera, n);
    double seen[3];
    locate(&s, mark, camera);
    const double *at = s.mark.at;
    if (!(at[0] > -0.5 && at[1] > -0.5 && at[0] < n[0] - 0.5 && at[1] < n[1] - 0.5)) return false;
    const uint32_t x = (uint32_t)(at[0] + 0.5), y = (uint32_t)(at[1] + 0.5);
    const double start = fmin((double)depth[(size_t)y * n[0] + x], n[2] - 1.0);
    find_threshold(&s, n[2]);
    const double least = 0.25 * s.mark.threshold; /* of that of the whole ray */
    double z = start > 0.0 ? floor(start) : -1.0;
    while (z >= 0.0 && !keeps_at(&s, x, y, z, start, least)) z -= 1.0;
    if (z < 0.0) return false;
    hs_marks_seen(volume, camera, mark->place, seen);
    seen[2] = (z + 0.5) * s.slice - 0.5 * camera->depth_extent;
    hs_marks_place(volume, camera, seen, mark->place);
    return true;
}

bool hs_marks_apply(const hs_mark *marks, uint32_t count, const hs_volume *volume, const hs_camera *camera,
                    const uint32_t n[3], float *depth, hs_error *err) {
    scene s = scene_of(volume, camera, n);
    seen_mark all[HS_MARKS_MAX];
    if (count > HS_MARKS_MAX)
        return hs_fail(err, HS_ERR_USAGE, "%u marks, expected at most %d", count, HS_MARKS_MAX);
    for (uint32_t i = 0; i < count; i++) {
        const hs_mark *m = &marks[i];
        if (!isfinite(m->place[0] + m->place[1] + m->place[2]) || !(m->radius > 0.0 && isfinite(m->radius)))
            return hs_fail(err, HS_ERR_USAGE, "mark %g,%g,%g,%g: expected x, y, z in mm and a radius above 0",
                           m->place[0], m->place[1], m->place[2], m->radius);
        locate(&s, m, camera);
        find_threshold(&s, reach_of(&s));
        all[i] = s.mark;
    }
    for (uint32_t y = 0; y < n[1]; y++)
        for (uint32_t x = 0; x < n[0]; x++) {
            double taken = -INFINITY;
            for (uint32_t i = 0; i < count; i++) {
                s.mark = all[i];
                if (is_near(&s, x, y)) apply_to(&s, x, y, &depth[(size_t)y * n[0] + x], &taken);
            }
        }
    return true;
}
