/* SPDX-License-Identifier: MIT */
/* What the hard cases hold: gaps as long as asked, contact without fluid, a bladder before the uterus,
 * no fetus, nothing before the fetus, two of them, a cord round the neck. Each with its truth. */
#include "scene/scene.h"
#include "support/scene_fixture.h"

#define FLUID_GREY 40 /* T_L = 40.5 / 255 */

/* A wall 28 mm thick, a fetus, and what is put in: %s. Nothing but the echoes. */
#define SCENE                                                                                                \
    "{ \"name\": \"t\", \"title\": \"t\", \"seed\": 1, \"extent_mm\": 120,\n"                                \
    "  \"sac\": { \"centre_mm\": [60, 60, 66], \"radii_mm\": [56, 62, 38], \"roughness_mm\": 1.5 },\n"       \
    "  \"structures\": [ %s ], \"artefacts\": [] }\n"
#define FETUS "{ \"type\": \"fetus\", \"position_mm\": [60, 64, 74], \"scale\": 0.55%s }"

static hs_scene_data make(const char *structures, uint32_t size) {
    return make_text_scene(unit_text(SCENE, structures), size);
}

static uint8_t tissue(const hs_scene_data *d, size_t pixel, long z) {
    return scene_voxel(d->tissue, &d->full, pixel, z);
}

/* The shortest run of fluid between `before` and the fetus on any ray, in mm; *touching counts the rays
 * on which one follows the other. */
static double shortest(const hs_scene_data *d, hs_tissue before, size_t *touching) {
    double narrowest = 1e3;
    *touching = 0;
    for (size_t p = 0; p < (size_t)d->full.nx * d->full.ny; p++) {
        if (d->label[p] != HS_LABEL_FETUS) continue;
        const long near_z = lrintf(d->near_end[p]), far_z = lrintf(d->far_end[p]);
        if (near_z == 0 || tissue(d, p, near_z - 1) != before) continue;
        const bool touches = hs_tissue_is_fetus(tissue(d, p, near_z));
        *touching += touches;
        narrowest = fmin(narrowest, touches ? 0.0 : (double)(far_z - near_z + 1) * d->full.spacing[2]);
    }
    return narrowest;
}

/* The gap of a fold before the trunk, and of the wall: within a voxel, 0.5 mm, and what a ray between
 * two voxels may add. */
static void gaps_are_as_long_as_asked(void **state) {
    static const double gaps[4] = {2.0, 5.0, 12.0, 30.0};
    for (int i = 0; i < 4; i++) {
        char structures[512];
        size_t touching;
        (void)snprintf(structures, sizeof structures,
                       "{ \"type\": \"occluder\", \"tissue\": \"placenta\", \"centre_mm\": [63, 60, 10],\n"
                       "\"radii_mm\": [20, 18, 16], \"rotation_deg\": [12, -9, 0], \"gap_mm\": %g }, " FETUS,
                       gaps[i], ", \"gap_mm\": 36");
        hs_scene_data d = make(structures, 240);
        const double found = shortest(&d, HS_TISSUE_PLACENTA, &touching);
        const double wall = shortest(&d, HS_TISSUE_WALL, &touching);
        printf("asked for %g mm: %g mm from the fold, %g mm from the wall\n", gaps[i], found, wall);
        assert_near(found, gaps[i], 0.75);
        assert_true(wall > 35.0); /* the fold may hide where the wall is nearest */
        if (i % 3) continue;
        (void)snprintf(structures, sizeof structures, FETUS, "%s");
        char alone[512], gap[64];
        (void)snprintf(gap, sizeof gap, ", \"gap_mm\": %g", gaps[i]);
        (void)snprintf(alone, sizeof alone, structures, gap);
        d = make(alone, 240);
        assert_near(shortest(&d, HS_TISSUE_WALL, &touching), gaps[i], 0.75);
    }
}

/* Pressed in by 3 mm: rays without any fluid before the skin, over more than a square centimetre of the
 * placenta, near = far = the skin. No interface shines between the two: tissue of nearly the same
 * impedance meets. */
static void contact_leaves_no_fluid(void **state) {
    char structures[512];
    size_t touching;
    (void)snprintf(
        structures, sizeof structures,
        "{ \"type\": \"occluder\", \"tissue\": \"placenta\", \"centre_mm\": [60, 40, 10], \"radii_mm\":\n"
        "[24, 22, 28], \"gap_mm\": -3 }, " FETUS,
        ", \"gap_mm\": 11");
    hs_scene_data d = make(structures, 120);
    assert_near(shortest(&d, HS_TISSUE_PLACENTA, &touching), 0.0, 0.0);
    printf("placenta and fetus touch on %zu mm^2\n", touching);
    assert_true(touching > 20);
    double skin = 0.0, before = 0.0, count = 0.0;
    for (size_t p = 0; p < (size_t)120 * 120; p++) {
        check_scene_pixel(&d, p);
        if (d.label[p] != HS_LABEL_FETUS) continue;
        const long z = lrintf(d.near_end[p]);
        if (z == 0 || tissue(&d, p, z - 1) != HS_TISSUE_PLACENTA || tissue(&d, p, z) != HS_TISSUE_SOFT)
            continue;
        assert_near(d.near_end[p], d.far_end[p], 0.0);
        assert_near(d.clip[p], d.far_end[p], 0.0);
        skin += scene_voxel(d.full.voxels, &d.full, p, z);
        before += scene_voxel(d.full.voxels, &d.full, p, z - 1);
        count += 1.0;
    }
    assert_true(fabs(skin - before) / count < 12.0); /* grey levels: -30 against -31 dB, and few edges */
    (void)snprintf(structures, sizeof structures, FETUS, ", \"gap_mm\": -2");
    d = make(structures, 120);
    assert_near(shortest(&d, HS_TISSUE_WALL, &touching), 0.0, 0.0);
    printf("wall and fetus touch on %zu mm^2\n", touching);
    assert_true(touching > 5);
}

/* A gap to what is not there is an error that names it. */
static void a_gap_needs_both_its_ends(void **state) {
    static const struct {
        const char *structures, *error;
    } bad[3] = {
        {"{ \"type\": \"occluder\", \"tissue\": \"placenta\", \"centre_mm\": [60, 40, 10], \"radii_mm\": [9, "
         "9, 9], \"gap_mm\": 3 }",
         "structures[0]: gap_mm is 3, but the scene has no fetus"},
        {"{ \"type\": \"fetus\", \"position_mm\": [60, 64, 74], \"scale\": 0.8 }, { \"type\": \"occluder\", "
         "\"tissue\": \"placenta\", \"centre_mm\": [6, 6, 10], \"radii_mm\": [4, 4, 4], \"gap_mm\": 3 }",
         "structures[1].gap_mm: no beam meets both this occluder and a fetus"},
        {"{ \"type\": \"nuchal_cord\", \"radius_mm\": 2, \"fetus\": 1 }, { \"type\": \"fetus\", "
         "\"position_mm\": [60, 64, 74] }",
         "structures[0]: fetus is 1, but the scene has 1"},
    };
    for (int i = 0; i < 3; i++) {
        hs_error err = {0};
        assert_null(scene_of_text(unit_text(SCENE, bad[i].structures), &err));
        unit_told(err, HS_ERR_INPUT, bad[i].error);
    }
}

/* On a beam through the bladder: wall, 12 mm of urine, which is dark, its own wall, the uterus', the
 * sac. No interval holds urine, and a ray that meets no other fluid has no label. */
static void a_bladder_is_no_sac(void **state) {
    const char *const structures =
        unit_text("{ \"type\": \"bladder\", \"centre_mm\": [96, 96, 17], \"radii_mm\": [22, 22, 6], "
                  "\"wall_mm\": 3 }, " FETUS,
                  ", \"gap_mm\": 10");
    hs_scene_data d = make(structures, 120);
    const size_t through = (size_t)96 * 120 + 96;
    long z = 0, order[5] = {0};
    while (tissue(&d, through, z) != HS_TISSUE_URINE) z++, order[0]++;
    for (; tissue(&d, through, z) == HS_TISSUE_URINE; z++, order[1]++)
        if (order[1] > 0 && order[1] < 11)
            assert_true(scene_voxel(d.full.voxels, &d.full, through, z) <= FLUID_GREY);
    while (tissue(&d, through, z) == HS_TISSUE_MUSCLE) z++, order[2]++;
    while (tissue(&d, through, z) == HS_TISSUE_WALL) z++, order[3]++;
    while (tissue(&d, through, z) == HS_TISSUE_FLUID) z++, order[4]++;
    printf("wall %ld mm, urine %ld, muscle %ld, wall %ld, fluid %ld\n", order[0], order[1], order[2],
           order[3], order[4]);
    assert_in_range(order[0], 10, 12);
    assert_in_range(order[1], 11, 13);
    assert_in_range(order[2], 2, 4);
    assert_true(order[3] > 0 && order[4] > 5);
    size_t bladder_only = 0;
    for (size_t p = 0; p < (size_t)120 * 120; p++) {
        check_scene_pixel(&d, p);
        bool urine = false;
        for (long s = 0; s < 120; s++) urine = urine || tissue(&d, p, s) == HS_TISSUE_URINE;
        bladder_only += urine && d.label[p] == HS_LABEL_NEITHER;
        if (d.label[p] == HS_LABEL_NEITHER) continue;
        for (long s = lrintf(d.near_end[p]); s <= lrintf(d.far_end[p]); s++)
            assert_int_not_equal(tissue(&d, p, s), HS_TISSUE_URINE);
    }
    assert_true(bladder_only > 20); /* it reaches beyond the sac, as bladders do */
}

static void share_of_labels(const hs_scene_data *d, size_t labels[3]) {
    labels[0] = labels[1] = labels[2] = 0;
    for (size_t p = 0; p < (size_t)d->full.nx * d->full.ny; p++) labels[d->label[p]]++;
}

/* Nothing of a fetus: the sac's rays have label 1 and their longest fluid. */
static void a_scan_without_a_fetus(void **state) {
    size_t labels[3];
    hs_scene_data d = make_scene("H10", 72, 2, 0, 0);
    share_of_labels(&d, labels);
    assert_int_equal(labels[HS_LABEL_FETUS], 0);
    assert_true(labels[HS_LABEL_SAC] > 72 * 72 / 2);
    for (size_t p = 0; p < (size_t)72 * 72; p++) {
        check_scene_pixel(&d, p);
        if (d.label[p] == HS_LABEL_SAC) assert_true(d.far_end[p] > d.near_end[p] || d.near_end[p] > 0.0f);
    }
}

/* Every ray begins in fluid, with its first scanned voxel, and its interval ends at the skin or at the
 * scan's end. */
static void nothing_before_the_fetus(void **state) {
    size_t labels[3];
    hs_scene_data d = make_scene("H11", 72, 2, 0, 0);
    share_of_labels(&d, labels);
    assert_true(labels[HS_LABEL_FETUS] > 72 * 72 / 8);
    for (size_t p = 0; p < (size_t)72 * 72; p++) {
        check_scene_pixel(&d, p);
        if (d.label[p] != HS_LABEL_FETUS) continue;
        long first = 0;
        while (scene_voxel(d.full.voxels, &d.full, p, first) == 0) first++;
        /* A limb may hide a part of the body, but nothing else is there. */
        assert_int_equal(lrintf(d.near_end[p]), first);
    }
}

/* Voxels of the fetus that hang together with the first, and all of them. */
static size_t connected(const hs_scene_data *d, size_t *all) {
    const size_t n = d->full.nx, slice = n * n, count = hs_volume_count(&d->full);
    size_t *stack = unit_memory(count * sizeof *stack), used = 0, reached = 0, first = 0;
    uint8_t *seen = unit_memory(count);
    *all = 0;
    for (size_t i = 0; i < count; i++) *all += hs_tissue_is_fetus(d->tissue[i]);
    while (!hs_tissue_is_fetus(d->tissue[first])) first++;
    seen[first] = 1;
    for (stack[used++] = first; used > 0; reached++) {
        const size_t i = stack[--used];
        const size_t to[6] = {i % n ? i - 1 : i,          i % n + 1 < n ? i + 1 : i,
                              i / n % n ? i - n : i,      i / n % n + 1 < n ? i + n : i,
                              i >= slice ? i - slice : i, i + slice < count ? i + slice : i};
        for (int k = 0; k < 6; k++)
            if (!seen[to[k]] && hs_tissue_is_fetus(d->tissue[to[k]])) seen[to[k]] = 1, stack[used++] = to[k];
    }
    return reached;
}

static void twins_are_two(void **state) {
    size_t all;
    hs_scene_data d = make_scene("H15", 96, 2, 0, 0);
    const size_t one = connected(&d, &all);
    printf("twins: %zu of %zu voxels hang together\n", one, all);
    assert_true(one > all / 3 && one < 2 * all / 3);
    size_t side[2] = {0, 0};
    for (size_t p = 0; p < (size_t)96 * 96; p++) {
        check_scene_pixel(&d, p);
        if (d.label[p] == HS_LABEL_FETUS) side[p % 96 > 48]++;
    }
    assert_true(side[0] > 300 && side[1] > 300);
}

/* Two that touch do not melt together: of each, the other's solids change nothing but where both are. */
static void twins_keep_their_shape(void **state) {
    static const char left[] = "{ \"type\": \"fetus\", \"position_mm\": [50, 60, 66], \"scale\": 0.6 }";
    static const char right[] = "{ \"type\": \"fetus\", \"position_mm\": [70, 60, 66], \"scale\": 0.6 }";
    hs_scene_data d[3];
    const char *const both = unit_text("%s, %s", left, right);
    d[0] = make(left, 96);
    d[1] = make(right, 96);
    d[2] = make(both, 96);
    size_t shared = 0, wrong = 0;
    for (size_t i = 0; i < hs_volume_count(&d[0].full); i++) {
        const bool one = hs_tissue_is_fetus(d[0].tissue[i]), other = hs_tissue_is_fetus(d[1].tissue[i]);
        shared += one && other;
        wrong += (one || other) != hs_tissue_is_fetus(d[2].tissue[i]);
    }
    assert_true(shared > 10); /* they do touch */
    assert_int_equal(wrong, 0);
}

/* Around the neck's axis there is a cord in every direction, against the skin but for what it hangs over. */
static void a_cord_lies_round_the_neck(void **state) {
    enum { SIDE = 240, SECTORS = 12 };
    hs_scene_data d = make("{ \"type\": \"fetus\", \"position_mm\": [60, 64, 66] },"
                           " { \"type\": \"nuchal_cord\", \"loops\": 1, \"radius_mm\": 2.4 }",
                           SIDE);
    size_t cord[SECTORS] = {0}, touching[SECTORS] = {0};
    for (size_t z = 1; z + 1 < SIDE; z++)
        for (size_t y = 76; y < 120; y++) /* 38 to 60 mm; the neck's middle is at 49 */
            for (size_t x = 1; x + 1 < SIDE; x++) {
                const size_t i = (z * SIDE + y) * SIDE + x;
                const double u = 0.5 * (double)x - 60.0, w = 0.5 * (double)z - 70.5;
                if (d.tissue[i] != HS_TISSUE_CORD || u * u + w * w > 18.0 * 18.0) continue;
                const int sector = (int)((atan2(w, u) / 6.2831853 + 1.0) * SECTORS) % SECTORS;
                const size_t slice = (size_t)SIDE * SIDE;
                cord[sector]++;
                touching[sector] +=
                    hs_tissue_is_fetus(d.tissue[i - 1]) || hs_tissue_is_fetus(d.tissue[i + 1]) ||
                    hs_tissue_is_fetus(d.tissue[i - SIDE]) || hs_tissue_is_fetus(d.tissue[i + SIDE]) ||
                    hs_tissue_is_fetus(d.tissue[i - slice]) || hs_tissue_is_fetus(d.tissue[i + slice]);
            }
    int around = 0, against = 0;
    for (int s = 0; s < SECTORS; s++) {
        printf("%3d degrees: %zu voxels of cord, %zu against the skin\n", 360 * s / SECTORS, cord[s],
               touching[s]);
        around += cord[s] > 50;
        against += touching[s] > 5;
    }
    assert_int_equal(around, SECTORS);
    assert_true(against >= SECTORS - 2);
}

/* All of them: labels and intervals hold, with haze, contact and turned cameras. */
static void hard_truths_are_exact(void **state) {
    for (uint32_t c = 0; hs_scene_of_group(HS_SCENES_HARD, c); c++) {
        hs_scene_data d = make_scene(hs_scene_of_group(HS_SCENES_HARD, c), 64, 2, 0, c % 3);
        for (size_t p = 0; p < (size_t)64 * 64; p++) check_scene_pixel(&d, p);
    }
}

/* The picture that the truth leaves shows no haze before the skin: but for 3 mm the rays of the fetus
 * are dark there. */
static void no_haze_is_left_in_the_truth(void **state) {
    hs_scene_data d = make_scene("H01", 128, 2, 0, 0);
    size_t hazy = 0, all = 0, before = 0;
    for (size_t p = 0; p < (size_t)128 * 128; p++) {
        if (d.label[p] != HS_LABEL_FETUS) continue;
        const long skin = lrintf(d.far_end[p]) - 3;
        for (long z = lrintf(d.near_end[p]) + 3; z < skin; z++, all++) {
            hazy += scene_voxel(d.truth.voxels, &d.truth, p, z) > FLUID_GREY;
            before += scene_voxel(d.full.voxels, &d.full, p, z) > FLUID_GREY;
        }
    }
    printf("of %zu voxels of fluid %zu were hazy, %zu are left\n", all, before, hazy);
    assert_true(before > all / 10);
    assert_true(hazy < all / 100);
}

UNIT_MAIN(NULL, NULL, gaps_are_as_long_as_asked, contact_leaves_no_fluid, a_gap_needs_both_its_ends,
          a_bladder_is_no_sac, a_scan_without_a_fetus, nothing_before_the_fetus, twins_are_two,
          twins_keep_their_shape, a_cord_lies_round_the_neck, hard_truths_are_exact,
          no_haze_is_left_in_the_truth)
