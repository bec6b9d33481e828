/* SPDX-License-Identifier: MIT */
/* Speckle: the statistics of fully developed speckle, and the size of its grains. */
#include "scene/scene_field.h"
#include "support/scene_fixture.h"

enum { N = 96 };

static hs_field *uniform_speckle(float axial, float lateral, float focus, float rayleigh) {
    hs_scene_spec spec = empty_spec();
    spec.speckle = (hs_speckle_spec){true, axial, lateral, focus, rayleigh};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_SOFT);
    for (size_t i = 0; i < (size_t)N * N * N; i++) f->diffuse[i] = hs_level(-30.0f);
    make_speckle(f, &spec);
    assert_false(atomic_load(&f->out_of_memory));
    return f;
}

/* Amplitude over a cube that the border's missing neighbours do not reach. */
static void moments(const hs_field *f, double *mean, double *deviation, double *power) {
    double sum = 0.0, square = 0.0;
    size_t count = 0;
    for (uint32_t z = 12; z < N - 12; z++)
        for (uint32_t y = 12; y < N - 12; y++)
            for (uint32_t x = 12; x < N - 12; x++, count++) {
                double a = (double)hs_level_amplitude(f->envelope[hs_field_index(f, x, y, z)]);
                sum += a;
                square += a * a;
            }
    *mean = sum / (double)count;
    *power = square / (double)count;
    *deviation = sqrt(*power - *mean * *mean);
}

/* Rayleigh amplitude: mean / deviation = sqrt(pi / (4 - pi)) = 1.913 before log compression. The cube holds
 * about 72^3 / (volume of a grain, 40 voxels) = 9000 grains: 0.1 is some 5 standard errors. */
static void has_the_snr_of_rayleigh(void **state) {
    hs_field *f = uniform_speckle(0.5f, 0.9f, 24.0f, 1000.0f);
    double mean, deviation, power;
    moments(f, &mean, &deviation, &power);
    printf("SNR %.3f, mean power %.2f dB\n", mean / deviation, 10.0 * log10(power));
    assert_near(mean / deviation, 1.913, 0.1);
}

/* The kernels have unit energy: speckle keeps the tissue's mean power (-30 dB) whatever the point spread. */
static void keeps_the_mean_power(void **state) {
    const float lateral[3] = {0.0f, 0.6f, 1.2f};
    for (int i = 0; i < 3; i++) {
        hs_field *f = uniform_speckle(0.4f, lateral[i], 24.0f, 1000.0f);
        double mean, deviation, power;
        moments(f, &mean, &deviation, &power);
        assert_near(10.0 * log10(power), -30.0, 0.3);
    }
}

/* Correlation of the intensity (squared amplitude) of slice z at a lag along x or z. */
static double correlation(const hs_field *f, uint32_t z, uint32_t lag_x, uint32_t lag_z) {
    double a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
    double count = 0.0;
    for (uint32_t w = z - 4; w <= z + 4; w++)
        for (uint32_t y = 10; y < N - 10; y++)
            for (uint32_t x = 10; x < N - 20; x++) {
                double p = (double)hs_level_amplitude(f->envelope[hs_field_index(f, x, y, w)]);
                double q =
                    (double)hs_level_amplitude(f->envelope[hs_field_index(f, x + lag_x, y, w + lag_z)]);
                p *= p;
                q *= q;
                a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
                count += 1.0;
            }
    a /= count, b /= count;
    return (ab / count - a * b) / sqrt((aa / count - a * a) * (bb / count - b * b));
}

/* Intensity of Gaussian-filtered complex noise is correlated as exp(-d^2 / (2 sigma^2)). Across the beam
 * sigma grows off the focus as sqrt(1 + ((z - z_f) / z_R)^2): focus at 8 mm, z_R 12 mm, so at 40 mm it
 * is 2.85 times wider. */
static void grains_widen_off_the_focus(void **state) {
    hs_field *f = uniform_speckle(0.5f, 0.6f, 8.0f, 12.0f);
    const uint32_t slices[2] = {16, 80}; /* 8.25 mm and 40.25 mm */
    for (int i = 0; i < 2; i++) {
        double off = (((double)slices[i] + 0.5) * 0.5 - 8.0) / 12.0, sigma = 0.6 * sqrt(1.0 + off * off);
        uint32_t lag = i == 0 ? 1 : 3;
        double expected = exp(-0.5 * pow((double)lag * 0.5 / sigma, 2.0));
        double found = correlation(f, slices[i], lag, 0);
        printf("z %u: sigma %.2f mm, correlation %.3f, expected %.3f\n", slices[i], sigma, found, expected);
        assert_near(found, expected, 0.06);
    }
    assert_near(correlation(f, 40, 0, 1), exp(-0.5 * pow(0.5 / 0.5, 2.0)), 0.06);
}

/* An interface across the beam keeps its level behind the point spread: -10 dB in silence, at its own
 * depth. */
static void interfaces_keep_their_level(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.speckle = (hs_speckle_spec){true, 0.4f, 0.8f, 24.0f, 30.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    for (size_t i = 0; i < (size_t)N * N; i++) f->coherent[hs_field_slice(f) * 40 + i] = hs_level(-10.0f);
    make_speckle(f, &spec);
    assert_false(atomic_load(&f->out_of_memory));
    size_t middle = hs_field_index(f, N / 2, N / 2, 40);
    assert_near(level_db(f->envelope[middle]), -10.0, 0.1);
    /* One voxel (0.5 mm) off: 20 log10 exp(-0.5 (0.5 / 0.4)^2) = -6.79 dB. */
    assert_near(level_db(f->envelope[middle + hs_field_slice(f)]), -16.79, 0.1);
}

UNIT_MAIN(NULL, NULL, has_the_snr_of_rayleigh, keeps_the_mean_power, grains_widen_off_the_focus,
          interfaces_keep_their_level)
