/* SPDX-License-Identifier: MIT */
/* Each artefact against numbers computed by hand. */
#include "scene/scene_field.h"
#include "support/scene_fixture.h"

enum { N = 64 };

/* A slab of `tissue` in slices first .. last - 1 across all columns, with the distances an interface
 * needs. */
static void put_slab(hs_field *f, hs_tissue tissue, uint32_t first, uint32_t last) {
    for (uint32_t z = 0; z < N; z++) {
        float outside = fmaxf((float)first - ((float)z + 0.5f), (float)z + 0.5f - (float)last);
        float d = fminf(fmaxf(outside * HS_DISTANCE_ONE, -HS_DISTANCE_FAR), HS_DISTANCE_FAR);
        for (size_t i = 0; i < (size_t)N * N; i++) {
            size_t index = hs_field_slice(f) * z + i;
            if (z >= first && z < last) f->tissue[index] = (uint8_t)tissue;
            if (tissue == HS_TISSUE_BONE)
                f->bone[index] = (int8_t)d;
            else
                f->surface[index] = (int8_t)d;
        }
    }
}

/* dB of scattered echo at slice z, after attenuation, against a level of 0 everywhere before. */
static double column_level(const hs_field *f, uint32_t z) {
    return level_db(f->diffuse[hs_field_index(f, N / 2, N / 2, z)]);
}

/* The pulse starts anew. */
static void start_again(hs_field *f) {
    memset(f->beam, 0, hs_field_slice(f) * sizeof *f->beam);
}

static void attenuate(hs_field *f, float tgc, float frequency) {
    hs_scene_spec spec = empty_spec();
    spec.frequency_mhz = frequency;
    spec.attenuation = (hs_attenuation_spec){true, tgc};
    for (size_t i = 0; i < (size_t)N * N * N; i++) f->diffuse[i] = 0;
    start_again(f);
    hs_scene_attenuation(f, &spec);
}

/* Soft tissue, 0.5 dB / (cm MHz) at 4 MHz without compensation: 4 dB per cm there and back. */
static void decays_exponentially(void **state) {
    hs_field *f = one_tissue_field(N, 1.0f, HS_TISSUE_SOFT);
    attenuate(f, 0.0f, 4.0f);
    for (uint32_t z = 0; z < N; z += 7)
        assert_near(column_level(f, z), -4.0 * ((double)z + 0.5) / 10.0, 0.02);
    attenuate(f, 0.5f, 4.0f); /* what the compensation assumes stays level */
    for (uint32_t z = 0; z < N; z += 7) assert_near(column_level(f, z), 0.0, 0.02);
}

/* 3 mm of bone (6 dB / (cm MHz)) in soft tissue at 3.5 MHz, compensated for soft tissue (0.5): behind it
 * 2 * 3.5 * (6 - 0.5) * 0.3 = 11.55 dB are missing, and two crossings of R = (3.75 - 1.63) / (3.75 + 1.63) =
 * 0.3941: 2 * 20 log10(1 - 0.1553) = -2.93 dB. */
static void bone_throws_a_shadow(void **state) {
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_SOFT);
    put_slab(f, HS_TISSUE_BONE, 20, 26);
    attenuate(f, 0.5f, 3.5f);
    assert_near(column_level(f, 10), 0.0, 0.02);
    assert_near(column_level(f, 40), -11.55 - 2.93, 0.1);
    assert_near(column_level(f, 60), -11.55 - 2.93, 0.1);
}

/* 10 mm of fluid (0.005) between soft tissue (0.5), compensated for 0.3 at 3.5 MHz. To the fluid: 7 (0.3 -
 * 0.5) 1.0 = -1.4 dB; through it: 7 (0.3 - 0.005) 1.0 = +2.065 dB; two crossings of R = 0.0415: -0.03
 * dB; 10.25 mm behind it: -1.435 dB. */
static void fluid_brightens(void **state) {
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_SOFT);
    put_slab(f, HS_TISSUE_FLUID, 20, 40);
    attenuate(f, 0.3f, 3.5f);
    assert_near(column_level(f, 19), -1.4 + 0.035, 0.02);
    assert_near(column_level(f, 40), -1.4 + 2.065 - 0.03 - 0.035, 0.03);
    assert_near(column_level(f, 60), -1.4 + 2.065 - 0.03 - 1.435, 0.03);
}

/* An interface's level: specular_db + 20 log10 R at normal incidence. Fluid to soft
 * tissue: R = 0.0415, -27.63 dB. */
static void interfaces_follow_impedance(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.specular_db = 10.0f;
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    put_slab(f, HS_TISSUE_SOFT, 20, 40);
    hs_scene_echo(f, &spec);
    size_t column = hs_field_index(f, N / 2, N / 2, 0), slice = hs_field_slice(f);
    assert_near(level_db(f->coherent[column + 20 * slice]), 10.0 - 27.63, 0.05);
    assert_int_equal(f->coherent[column + 19 * slice], HS_LEVEL_SILENT); /* the fluid's side */
    assert_int_equal(f->coherent[column + 30 * slice], HS_LEVEL_SILENT); /* inside */
    assert_near(level_db(f->diffuse[column + 30 * slice]), spec.tissue[HS_TISSUE_SOFT].echo_db, 0.01);
}

/* A sphere of bone in soft tissue: the beam through its centre meets it square and loses nothing by
 * refraction; beside it nothing happens. 12 of 14 voxels off its axis the beam comes in at asin(12 / 14) = 59
 * degrees, beyond the critical angle asin(1550 / 2500) = 38: max_loss_db. It goes out at 59 degrees too: sin
 * t = 0.531, T = 0.661 against 0.845 at normal incidence: 2.13 dB. The normals come from 8-bit distances, so
 * half a dB is left to them. */
static void edges_throw_shadows(void **state) {
    const float radius = 14.0f;
    hs_scene_spec spec = empty_spec();
    spec.edge = (hs_edge_spec){true, 9.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_SOFT);
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                float dx = (float)x - 32.0f, dy = (float)y - 32.0f, dz = (float)z - 24.0f;
                float d = (sqrtf(dx * dx + dy * dy + dz * dz) - radius) * HS_DISTANCE_ONE;
                size_t index = hs_field_index(f, x, y, z);
                f->bone[index] = (int8_t)lrintf(fminf(fmaxf(d, -HS_DISTANCE_FAR), HS_DISTANCE_FAR));
                if (d < 0.0f) f->tissue[index] = HS_TISSUE_BONE;
                f->diffuse[index] = 0;
            }
    hs_scene_edge_shadow(f, &spec);
    assert_near(level_db(f->diffuse[hs_field_index(f, 32, 32, 60)]), 0.0, 0.1);
    assert_near(level_db(f->diffuse[hs_field_index(f, 32 + 17, 32, 60)]), 0.0, 0.0);
    assert_near(level_db(f->diffuse[hs_field_index(f, 32 + 12, 32, 60)]), -9.0 - 2.13, 0.5);
    assert_near(level_db(f->diffuse[hs_field_index(f, 32 + 12, 32, 4)]), 0.0, 0.0); /* before it */
}

/* Wall with a boundary at slice 8, ending at 20 before fluid: the wall's end (slice 19) comes back every 11
 * slices, 6 dB weaker each time. */
static void bands_stand_at_multiples(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.reverberation = (hs_reverberation_spec){true, 3, 0.0f, 6.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    for (uint32_t z = 0; z < 20; z++)
        memset(f->tissue + hs_field_slice(f) * z, z < 8 ? HS_TISSUE_FAT : HS_TISSUE_WALL, hs_field_slice(f));
    size_t column = hs_field_index(f, 5, 50, 0), slice = hs_field_slice(f);
    for (size_t i = 0; i < slice; i++) f->coherent[slice * 19 + i] = hs_level(-12.0f);
    hs_scene_reverberation(f, &spec);
    for (uint32_t z = 20; z < N; z++) {
        double expected = z == 30 ? -18.0 : z == 41 ? -24.0 : z == 52 ? -30.0 : -200.0;
        assert_near(level_db(f->coherent[column + z * slice]), expected, 0.02);
    }
    spec.reverberation = (hs_reverberation_spec){true, 2, 4.0f, 10.0f}; /* 4 mm: 8 slices */
    for (size_t i = slice * 20; i < slice * N; i++) f->coherent[i] = HS_LEVEL_SILENT;
    start_again(f);
    hs_scene_reverberation(f, &spec);
    assert_near(level_db(f->coherent[column + 27 * slice]), -22.0, 0.02);
    assert_near(level_db(f->coherent[column + 35 * slice]), -32.0, 0.02);
    assert_int_equal(f->coherent[column + 43 * slice], HS_LEVEL_SILENT);
}

/* A whole slice of interface at 0 dB: far from the border the blur changes nothing, so the haze
 * is level_db; the next slice has none. A single line of it is spread over width_mm: peak 1 / 9
 * of it (two boxes of 9 voxels). */
static void haze_has_its_level(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.side_lobe = (hs_side_lobe_spec){true, -26.5f, 8.0f}; /* boxes of 2 * 4 + 1 voxels */
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    size_t slice = hs_field_slice(f);
    for (size_t i = 0; i < slice * N; i++) f->envelope[i] = HS_LEVEL_SILENT;
    for (size_t i = 0; i < slice; i++) f->coherent[slice * 10 + i] = 0;
    for (uint32_t y = 0; y < N; y++) f->coherent[hs_field_index(f, 32, y, 20)] = 0;
    hs_scene_side_lobes(f, &spec);
    assert_false(atomic_load(&f->out_of_memory));
    assert_near(level_db(f->envelope[hs_field_index(f, 32, 32, 10)]), -26.5, 0.05);
    assert_int_equal(f->envelope[hs_field_index(f, 32, 32, 11)], HS_LEVEL_SILENT);
    assert_near(level_db(f->envelope[hs_field_index(f, 32, 32, 20)]), -26.5 + 20.0 * log10(1.0 / 9.0), 0.05);
    assert_near(level_db(f->envelope[hs_field_index(f, 36, 32, 20)]), -26.5 + 20.0 * log10(5.0 / 81.0), 0.05);
    assert_int_equal(f->envelope[hs_field_index(f, 42, 32, 20)], HS_LEVEL_SILENT);
}

/* Noise alone: its mean power is level_db (64^3 exponential samples: 0.2 % standard error). */
static void noise_has_its_power(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.noise = (hs_noise_spec){true, -40.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    for (size_t i = 0; i < (size_t)N * N * N; i++) f->envelope[i] = HS_LEVEL_SILENT;
    hs_scene_noise(f, &spec);
    double power = 0.0;
    for (size_t i = 0; i < (size_t)N * N * N; i++) {
        double a = (double)hs_level_amplitude(f->envelope[i]);
        power += a * a;
    }
    assert_near(10.0 * log10(power / (N * N * N)), -40.0, 0.05);
}

/* Straight ahead all depths to depth_mm; at the surface z = 0 half a width of r
 * tan(angle / 2); nothing outside. */
static void fan_has_its_borders(void **state) {
    hs_scene_spec spec = empty_spec();
    spec.fan = (hs_fan_spec){true, 60.0f, 60.0f, 20.0f, 20.0f, 25.0f};
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID); /* 32 mm */
    static uint8_t voxels[N * N * N];
    memset(voxels, 9, sizeof voxels);
    f->grey = voxels;
    hs_scene_fan(f, &spec);
    for (uint32_t z = 0; z < N; z++) /* x = y = 0.25 mm off the middle; depth z + 0.25 mm */
        assert_int_equal(voxels[hs_field_index(f, 32, 32, z)], z < 50 ? 9 : 0);
    /* 20.25 tan 30 = 11.69 mm: 23 voxels of 0.5 mm reach 11.25 mm, the next centre is at 11.75. */
    assert_int_equal(voxels[hs_field_index(f, 32 + 22, 32, 0)], 9);
    assert_int_equal(voxels[hs_field_index(f, 32 + 23, 32, 0)], 0);
    assert_int_equal(voxels[hs_field_index(f, 32, 32 - 23, 0)], 9);
    assert_int_equal(voxels[hs_field_index(f, 32, 32 - 24, 0)], 0);
}

/* grey = 255 (1 + (L + gain) / range): -24 dB with 60 dB of range is 153, all below the range is 1, above
 * it 255. */
static void compresses_as_stated(void **state) {
    hs_scene_spec spec = empty_spec();
    hs_field *f = one_tissue_field(N, 0.5f, HS_TISSUE_FLUID);
    for (size_t i = 0; i < (size_t)N * N * N; i++) f->envelope[i] = hs_level(-24.0f);
    f->envelope[1] = hs_level(-61.0f);
    f->envelope[2] = hs_level(3.0f);
    f->envelope[3] = HS_LEVEL_SILENT;
    static uint8_t voxels[N * N * N];
    f->grey = voxels;
    hs_scene_compress(f, &spec);
    assert_int_equal(voxels[0], 153);
    assert_int_equal(voxels[1], 1);
    assert_int_equal(voxels[2], 255);
    assert_int_equal(voxels[3], 1);
    /* A level of a power and back: within 0.02 dB over the whole range. */
    for (int db = -120; db < 50; db++) {
        float a = hs_level_amplitude(hs_level((float)db));
        assert_near(level_db(hs_level_of_power(a * a)), (double)db, 0.02);
    }
}

UNIT_MAIN(NULL, NULL, decays_exponentially, bone_throws_a_shadow, fluid_brightens,
          interfaces_follow_impedance, edges_throw_shadows, bands_stand_at_multiples, haze_has_its_level,
          noise_has_its_power, fan_has_its_borders, compresses_as_stated)
