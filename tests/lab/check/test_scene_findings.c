/* SPDX-License-Identifier: MIT */
/*
 * The findings of the thesis on its nine examinations, found again on the nine scenes: the two peaks of the
 * histogram (Figure 3.3), the share of initial points (3.2), and who is easy and who is hard at one setting
 * (Tables 5.2 and 5.3, Figure 5.8). The algorithm is the scalar definition; the clipping and the error are
 * written here from spec 7.
 */
#include "render/dvr_settings.h"
#include "support/scene_fixture.h"

#include "ref/ref_mean.h"
#include "ref/ref_points.h"

enum { SIZE = 192, LOW = SIZE / 3, PIXELS = LOW * LOW };

static const double fluid_threshold = 40.5 / 255.0;

/* Low-resolution volume: the mean of 3^3 voxels, 0 where less than half of them were scanned. */
static void reduce(const hs_volume *full, uint8_t *low) {
    for (uint32_t i = 0; i < LOW * PIXELS; i++) {
        uint32_t x = i % LOW * 3, y = i / LOW % LOW * 3, z = i / PIXELS * 3, sum = 0, count = 0;
        for (uint32_t k = 0; k < 27; k++) {
            uint8_t v = full->voxels[((size_t)(z + k / 9) * SIZE + y + k / 3 % 3) * SIZE + x + k % 3];
            sum += v;
            count += v != 0;
        }
        low[i] = (uint8_t)(2 * count >= 27 ? (sum + count / 2) / count : 0);
    }
}

/* Depth in slices at which a ray ends that starts at `start`. */
static double termination(const hs_volume *v, size_t pixel, double start) {
    hs_dvr_settings dvr;
    hs_dvr_defaults(&dvr);
    float opacity = 0.0f;
    uint32_t z = start > 0.0 ? (uint32_t)ceil(start) : 0;
    for (; z < v->nz; z++) {
        const uint8_t level = v->voxels[(size_t)z * SIZE * SIZE + pixel];
        opacity += (1.0f - opacity) * hs_dvr_opacity(&dvr, level);
        if (opacity >= dvr.termination) break;
    }
    return fmin(z, v->nz);
}

typedef struct {
    double share; /* of rays that give a point */
    double right; /* of the points that lie in the admissible interval, give or take a low-resolution slice */
    double error; /* mean absolute, slices of the full volume */
    uint32_t maximum; /* grey */
} finding;

static double low_to_full(double depth) {
    return (depth + 0.5) * 3.0 - 0.5;
}

/* The surface between the pixel centres of the low-resolution map. */
static double surface_at(const double *surface, uint32_t x, uint32_t y) {
    double u = fmin(fmax((x + 0.5) / 3.0 - 0.5, 0.0), LOW - 1.001),
           v = fmin(fmax((y + 0.5) / 3.0 - 0.5, 0.0), LOW - 1.001);
    uint32_t i = (uint32_t)u, j = (uint32_t)v;
    const double *s = surface + j * LOW + i;
    u -= i, v -= j;
    return low_to_full((s[0] * (1 - u) + s[1] * u) * (1 - v) + (s[LOW] * (1 - u) + s[LOW + 1] * u) * v);
}

static float error_map[SIZE * SIZE]; /* of the last mean_error; 0 without a label */

static double mean_error(const hs_scene_data *d, const double *surface) {
    double sum = 0.0;
    size_t count = 0;
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            size_t pixel = (size_t)y * SIZE + x;
            error_map[pixel] = 0.0f;
            if (d->label[pixel] == HS_LABEL_NEITHER) continue;
            double error =
                termination(&d->truth, pixel, 0.0) - termination(&d->full, pixel, surface_at(surface, x, y));
            error_map[pixel] = (float)error;
            sum += fabs(error);
            count++;
        }
    return sum / (double)count;
}

/* What section 5.3 says of a case: where occluders are left (positive error) and where
 * the fetus is cut (negative). */
enum { LEFT = 1, CUT = -1 };
typedef struct {
    const char *name, *where;
    int sign;
    double x0, y0, x1, y1; /* parts of the picture */
} statement;

static const statement statements[] = {
    {"E01", "right arm", LEFT, 0.31, 0.46, 0.44, 0.62},
    {"E01", "forehead", CUT, 0.42, 0.18, 0.64, 0.42},
    {"E02", "face", LEFT, 0.40, 0.22, 0.58, 0.45},
    {"E02", "right leg", CUT, 0.36, 0.61, 0.56, 0.82},
    {"E03", "neck and shoulder", LEFT, 0.52, 0.34, 0.64, 0.46},
    {"E03", "right arm", CUT, 0.27, 0.45, 0.37, 0.58},
    {"E03", "legs", CUT, 0.33, 0.55, 0.62, 0.83},
    {"E04", "left arm", CUT, 0.52, 0.28, 0.70, 0.47},
    {"E04", "legs", CUT, 0.38, 0.57, 0.68, 0.82},
    {"M01", "forehead", LEFT, 0.47, 0.14, 0.59, 0.24},
    {"M01", "knee", LEFT, 0.56, 0.65, 0.70, 0.80},
    {"M01", "right leg", CUT, 0.38, 0.76, 0.52, 0.90},
    {"M02", "face", LEFT, 0.42, 0.22, 0.66, 0.43},
    {"M02", "right elbow", CUT, 0.24, 0.49, 0.37, 0.62},
    {"M03", "back of the head", CUT, 0.38, 0.05, 0.70, 0.40},
    {"D02", "neck", LEFT, 0.40, 0.28, 0.60, 0.43},
    {"D02", "back", LEFT, 0.38, 0.50, 0.52, 0.70},
};

/* A statement holds if at least a twentieth of its region is wrong by three slices or more in its
 * direction. */
static void check_statements(const char *name) {
    for (size_t i = 0; i < sizeof statements / sizeof statements[0]; i++) {
        const statement *s = &statements[i];
        if (strcmp(s->name, name) != 0) continue;
        uint32_t wrong = 0, all = 0;
        for (uint32_t y = (uint32_t)(s->y0 * SIZE); y < (uint32_t)(s->y1 * SIZE); y++)
            for (uint32_t x = (uint32_t)(s->x0 * SIZE); x < (uint32_t)(s->x1 * SIZE); x++, all++)
                wrong += (float)s->sign * error_map[(size_t)y * SIZE + x] >= 3.0f;
        printf("  %s: %s %.1f %%\n", s->where, s->sign == LEFT ? "occluders left" : "cut",
               100.0 * wrong / all);
        assert_true(20 * wrong >= all);
    }
}

/* The whole algorithm with offset threshold `delta`, k = 55 of 512 pixels, q = 0.4. */
static finding find(const hs_scene_data *d, const sv_ref_ray *rays, double delta) {
    static uint8_t status[PIXELS];
    static double near_end[PIXELS], far_end[PIXELS], depth[PIXELS], surface[PIXELS];
    const sv_ref_bone bone = {
        .fluid_threshold = fluid_threshold, .bone_mode = SV_REF_OFFSET, .bone_offset = delta};
    uint32_t level = sv_ref_bone_level(rays, PIXELS, &bone);
    uint32_t points = sv_ref_points(rays, PIXELS, &bone, level, status, near_end, far_end), right = 0;
    finding found = {.share = (double)points / PIXELS};
    for (uint32_t i = 0; i < PIXELS; i++) {
        depth[i] = far_end[i] + 0.4 * (near_end[i] - far_end[i]);
        if (rays[i].maximum > found.maximum) found.maximum = rays[i].maximum;
        size_t pixel = ((size_t)(i / LOW) * 3 + 1) * SIZE + i % LOW * 3 + 1;
        double z = low_to_full(depth[i]);
        right +=
            status[i] && d->label[pixel] && z > d->near_end[pixel] - 3.0f && z < d->far_end[pixel] + 3.0f;
    }
    found.right = points ? (double)right / points : 0.0;
    sv_ref_fill fill;
    assert_true(sv_ref_mean(status, depth, LOW, LOW, 7, 0.5, surface, &fill));
    assert_int_equal(fill.unfilled, 0);
    found.error = mean_error(d, surface);
    return found;
}

/* Zeros are the highest bin. The second peak lies where tissue is, above T_L; what is between the two is
 * fluid, and lies lower than the second peak somewhere. */
static void check_histogram(const char *name, const hs_volume *v) {
    uint32_t bins[256] = {0};
    for (size_t i = 0; i < hs_volume_count(v); i++) bins[v->voxels[i]]++;
    uint32_t peak = 0, valley = UINT32_MAX, peak_at = 0, valley_at = 0;
    for (uint32_t g = 45; g < 250; g++) {
        uint32_t smooth = 0;
        for (uint32_t k = g - 4; k <= g + 4; k++) smooth += bins[k];
        if (smooth > peak) peak = smooth, peak_at = g;
    }
    for (uint32_t g = 5; g < peak_at; g++) {
        uint32_t smooth = 0;
        for (uint32_t k = g - 4; k <= g + 4; k++) smooth += bins[k];
        if (smooth < valley) valley = smooth, valley_at = g;
    }
    printf("%s: peaks at 0 (%.1f %%) and %u, valley at %u (%.2f of the peak)\n", name,
           100.0 * bins[0] / (double)hs_volume_count(v), peak_at, valley_at, (double)valley / peak);
    for (uint32_t g = 1; g < 256; g++) assert_true(bins[0] > bins[g]);
    assert_true(peak_at > 60 && peak_at < 180);
    assert_true(valley_at > 5 && valley_at < peak_at - 20 && valley < 0.9 * peak);
}

static void findings_of_the_thesis(void **state) {
    double error[9], sum = 0.0, sum_high = 0.0;
    uint8_t *low = unit_memory((size_t)LOW * PIXELS);
    sv_ref_ray *rays = unit_memory(PIXELS * sizeof *rays);
    for (int c = 0; c < 9; c++) {
        hs_scene_data d = make_scene(scene_cases[c], SIZE, 2, 0, 0);
        check_histogram(scene_cases[c], &d.full);
        reduce(&d.full, low);
        const sv_ref_volume volume = {low, LOW, LOW, LOW, 0, NULL};
        sv_ref_profile(&volume, fluid_threshold, 1, rays);
        finding high = find(&d, rays, 0.06), found = find(&d, rays, 0.24);
        printf("%s: maximum %u, points %.1f %% (%.0f %% right), error %.2f; T_B high: points %.2f %%, error "
               "%.2f\n",
               scene_cases[c], found.maximum, 100.0 * found.share, 100.0 * found.right, found.error,
               100.0 * high.share, high.error);
        assert_true(found.share >= 0.01 && found.share <= 0.10);
        /* In M03 the points of the head are drawn into it: that is what the case is for. */
        if (c == 8)
            assert_true(found.right < 0.5);
        else
            assert_true(found.right > 0.8);
        check_statements(scene_cases[c]);
        error[c] = found.error;
        sum += found.error;
        sum_high += high.error;
    }
    printf("mean error %.2f, with a high bone threshold %.2f\n", sum / 9.0, sum_high / 9.0);
    for (int c = 1; c < 9; c++) assert_true(error[0] < error[c]); /* D01 is the easiest */
    for (int c = 0; c < 8; c++) assert_true(error[8] > error[c]); /* M03 the hardest */
    assert_true(sum_high > 1.2 * sum);
}

UNIT_MAIN(NULL, NULL, findings_of_the_thesis)
