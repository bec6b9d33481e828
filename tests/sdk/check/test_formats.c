/* SPDX-License-Identifier: MIT */
/*
 * However a volume is handed over, the answer is the same to the bit: sizes, slabs, tiles, padding, carriers
 * and the way the work is laid out. Every frame is compared with the scalar definition.
 * Requirement: R3.
 */
#include "support/compare.h"

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static rig_format layout(const rig *r, uint32_t strategy, uint32_t substeps, uint32_t width, uint32_t height,
                         uint32_t slices) {
    return (rig_format){
        .width = width,
        .height = height,
        .slices = slices,
        .padding = SV_NO_PADDING,
        .fixed = {{rig_param(r, "strategy"), 0, strategy}, {rig_param(r, "substeps"), 0, substeps}}};
}

static rig_settings settings_of(uint32_t substeps, uint32_t k) {
    rig_settings s = rig_default_settings();
    s.substeps = substeps;
    s.k = k;
    return s;
}

/* One activation, a frame of every kind of volume. */
static void compare_kinds(rig *r, const rig_format *f, const rig_settings *s, uint32_t seed,
                          const char *where) {
    for (uint32_t kind = 0; kind < RIG_KIND_COUNT; kind++) {
        uint8_t *volume = rig_volume(kind, f->width, f->height, f->slices, seed);
        stage *t = rig_stage(r, f, volume);
        if (kind == 0) assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
        compare_frame(r, t, volume, s, where);
    }
    r->plugin->deactivate(r->plugin);
}

/* Every kernel: work layout x samples per slice x padding x vector width, on every kind of volume. Each build
 * takes a second: by day any two of these with each other, at night all four. */
static void every_kernel(void **state) {
    static const uint32_t widths[] = {9, 33, 75}; /* vectors of 16, 32 and 64 rays, all with an odd end */
    static const int32_t paddings[] = {SV_NO_PADDING, 0, 77};
    for (uint32_t n = 0; n < 3 * 3 * 4 * 3; n++) {
        const uint32_t strategy = n / 3 % 3, samples = n / 9 % 4, width = n % 3, padding = n / 36;
        const bool pair = width == (strategy + samples) % 3 && padding == (strategy + 2 * samples) % 3;
        if (!pair && !getenv("SV_NIGHT")) continue;
        rig_format f = layout(*state, 1 + strategy, 1 + samples, widths[width], 37, 29);
        f.slab_slices = 8;
        f.padding = paddings[padding];
        const rig_settings s = settings_of(1 + samples, 7);
        compare_kinds(*state, &f, &s, n, "every kernel");
    }
    (void)compare_print("every kernel");
}

/* Rows shorter and longer than vectors, lone rows, columns and pixels, lone slices, a short last slab. */
static void sizes(void **state) {
    static const uint32_t list[][4] = {
        /* width, height, slices, slices a slab */
        {1, 1, 1, 1},     {1, 1, 2, 1},   {1, 1, 9, 4},     {1, 7, 5, 2},   {7, 1, 5, 5},
        {15, 3, 6, 6},    {16, 3, 6, 4},  {17, 3, 6, 4},    {31, 4, 5, 1},  {32, 4, 5, 5},
        {48, 33, 9, 9},   {63, 5, 7, 3},  {64, 5, 7, 7},    {65, 66, 1, 1}, {79, 2, 30, 1},
        {127, 129, 3, 2}, {128, 1, 3, 2}, {200, 201, 4, 3}, {3, 300, 5, 4}, {300, 3, 5, 4},
    };
    for (uint32_t n = 0; n < sizeof list / sizeof *list; n++)
        for (uint32_t strategy = 0; strategy <= 3; strategy++) {
            rig_format f = layout(*state, strategy, 1, list[n][0], list[n][1], list[n][2]);
            f.slab_slices = list[n][3];
            f.padding = n % 2 ? 0 : SV_NO_PADDING;
            const rig_settings s = settings_of(1, 23);
            uint8_t *volume = rig_volume(n % RIG_KIND_COUNT, f.width, f.height, f.slices, n);
            compare_run(*state, &f, volume, &s, "sizes");
        }
    (void)compare_print("sizes");
}

/* All ways of handing slabs over, in textures with ever more padding, which holds 255: bone, if it bled. */
static void carriers_and_tiles(void **state) {
    static const struct {
        uint32_t carrier;
        bool own_queue, in_place;
    } ways[] = {{SV_CARRIER_HOST, false, false},   {SV_CARRIER_HOST, false, true},
                {SV_CARRIER_HOST, true, false},    {SV_CARRIER_HOST, true, true},
                {SV_CARRIER_BUFFER, false, false}, {SV_CARRIER_IMAGE, false, false}};
    static const struct {
        uint32_t tiles_x, extra_w, extra_h, extra_pitch;
    } tiles[] = {{1, 0, 0, 0}, {1, 5, 3, 7}, {2, 0, 2, 0}, {3, 1, 0, 61}, {7, 13, 1, 0}, {40, 0, 0, 1}};
    uint8_t *volume = rig_volume(RIG_LAYERS, 37, 19, 23, 3);
    for (uint32_t w = 0; w < sizeof ways / sizeof *ways; w++)
        for (uint32_t n = 0; n < sizeof tiles / sizeof *tiles; n++) {
            rig_format f = layout(*state, 1 + (w + n) % 3, 1 + n % 2, 37, 19, 23);
            f.slab_slices = 9;
            f.carrier = ways[w].carrier;
            f.own_queue = ways[w].own_queue;
            f.in_place = ways[w].in_place;
            f.tiles_x = tiles[n].tiles_x;
            f.extra_w = tiles[n].extra_w;
            f.extra_h = tiles[n].extra_h;
            f.extra_pitch = tiles[n].extra_pitch;
            const rig_settings s = settings_of(1 + n % 2, 9);
            compare_run(*state, &f, volume, &s, "carriers and tiles");
        }
    (void)compare_print("carriers and tiles");
}

/* A random split into at most `longest` slices a slab, ending with 0. */
static void random_split(uint32_t *lengths, uint32_t slices, uint32_t longest, uint32_t *seed) {
    while (slices > 0) {
        uint32_t length = 1 + next_random(seed) % longest;
        if (length > slices) length = slices;
        *lengths++ = length;
        slices -= length;
    }
    *lengths = 0;
}

static void any_split(void **state) {
    enum { SLICES = 60 };
    uint32_t seed = 99;
    for (uint32_t n = 0; n < 36; n++) {
        uint32_t lengths[SLICES + 1];
        random_split(lengths, SLICES, 1 + n, &seed);
        const uint32_t substeps = 1 + n % 4;
        rig_format f = layout(*state, 1 + n / 4 % 3, substeps, 70, 6, SLICES);
        f.lengths = lengths;
        f.tiles_x = 1 + n % 5;
        f.padding = n % 3 == 0 ? 0 : SV_NO_PADDING;
        const rig_settings s = settings_of(substeps, 5);
        uint8_t *volume = rig_volume(n % RIG_KIND_COUNT, f.width, f.height, SLICES, n);
        compare_run(*state, &f, volume, &s, "any split");
    }
    (void)compare_print("any split");
}

/* 8-bit positions hold 254 samples: longer slabs are walked in chunks. */
static void long_slabs(void **state) {
    for (uint32_t n = 0; n < 12; n++) {
        const uint32_t substeps = 1 + n % 4;
        rig_format f = layout(*state, 1 + n / 4, substeps, n % 2 ? 21 : 70, 4, 700);
        f.slab_slices = n % 3 == 0 ? 700 : 255 + n;
        f.tiles_x = 26;
        f.padding = n % 3 == 1 ? 0 : SV_NO_PADDING;
        const rig_settings s = settings_of(substeps, 5);
        uint8_t *volume = rig_volume(n % RIG_KIND_COUNT, f.width, f.height, f.slices, n);
        compare_run(*state, &f, volume, &s, "long slabs");
    }
    (void)compare_print("long slabs");
}

/* 700 slices under a window of 63 x 48: the sums need 64 bits; under 3 x 3 the same instance uses 32
 * again. */
static void sums_of_64_bits(void **state) {
    assert_true(sv_fixed_format(64, 48, 700, 63, 2).wide);
    assert_false(sv_fixed_format(64, 48, 700, 3, 2).wide);
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        rig_format f = layout(*state, strategy, 1, 64, 48, 700);
        f.slab_slices = 100;
        rig_settings s = settings_of(1, 63);
        compare_kinds(*state, &f, &s, strategy, "sums of 64 bits");
        uint8_t *volume = rig_volume(RIG_LAYERS, f.width, f.height, f.slices, 1);
        stage *t = rig_stage(*state, &f, volume);
        rig *r = *state;
        assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
        static const uint32_t sizes_of_k[] = {63, 3, 61, 5};
        for (uint32_t i = 0; i < 4; i++) {
            s = settings_of(1, sizes_of_k[i]);
            s.omega = 0.25 * i; /* 0: windows without weight must not divide */
            compare_frame(r, t, volume, &s, "64 and 32 bits in turn");
        }
        r->plugin->deactivate(r->plugin);
    }
    (void)compare_print("sums of 64 bits");
}

/* ---- hard cases of spec 8 */

/* The longest volume, 8192 slices: positions of 16 bits with four samples a slice, depths near 10^4 with
 * detail. */
static void longest_volume(void **state) {
    enum { SLICES = 8192, RAYS = 15 };
    int32_t ends[2 * RAYS];
    for (int32_t i = 0; i < RAYS; i++) {
        ends[i] = 8100 + i;
        ends[RAYS + i] = SLICES - 1 - i % 4;
    }
    uint8_t *volume = rig_map_volume(ends, ends + RAYS, 5, 3, SLICES);
    for (uint32_t n = 0; n < 6; n++) {
        const uint32_t substeps = n < 3 ? 1 : 4;
        rig_format f = layout(*state, 1 + n % 3, substeps, 5, 3, SLICES);
        f.slab_slices = substeps == 1 ? SLICES : 1000;
        f.tiles_x = 91;
        const rig_settings s = settings_of(substeps, 23);
        compare_run(*state, &f, volume, &s, "longest volume");
    }
    (void)compare_print("longest volume");
}

/* Running float32 sums and summed-area tables are off by 1 to 3 slices here: 512 x 512, k = 3, deep
 * values. */
static void float_sums_would_drift(void **state) {
    enum { SIDE = 512, SLICES = 256, RAYS = SIDE * SIDE };
    int32_t *ends = unit_memory(2 * RAYS * sizeof *ends);
    uint32_t seed = 4;
    for (uint32_t i = 0; i < RAYS; i++) {
        seed = seed * 1664525u + 1013904223u;
        ends[i] = (int32_t)(seed >> 25);                                      /* near end 0 .. 127 */
        ends[RAYS + i] = seed % 3 ? (int32_t)(128 + (seed >> 16) % 128) : -1; /* far end 128 .. 255 */
    }
    rig_format f = layout(*state, 0, 1, SIDE, SIDE, SLICES);
    f.slab_slices = 64;
    const rig_settings s = settings_of(1, 3);
    uint8_t *volume = rig_map_volume(ends, ends + RAYS, SIDE, SIDE, SLICES);
    compare_run(*state, &f, volume, &s, "float sums would drift");
    (void)compare_print("float sums would drift");
}

/* Roundings of many passes add up: the widest map, k = 3, points at its left edge only. */
static void many_passes(void **state) {
    enum { WIDTH = 512, HEIGHT = 8, SLICES = 512, RAYS = WIDTH * HEIGHT };
    int32_t *ends = unit_memory(2 * RAYS * sizeof *ends);
    uint32_t seed = 5;
    for (uint32_t i = 0; i < RAYS; i++) {
        seed = seed * 1664525u + 1013904223u;
        ends[RAYS + i] = i % WIDTH < 3 ? (int32_t)(1 + (seed >> 8) % (SLICES - 1)) : -1;
    }
    const rig_format f = layout(*state, 0, 1, WIDTH, HEIGHT, SLICES);
    const rig_settings s = settings_of(1, 3);
    uint8_t *volume = rig_map_volume(ends, ends + RAYS, WIDTH, HEIGHT, SLICES);
    compare_run(*state, &f, volume, &s, "many passes");
    assert_int_equal(compare_print("many passes").max_passes, WIDTH - 3);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(every_kernel), RIG_TEST(sizes), RIG_TEST(carriers_and_tiles),
             RIG_TEST(any_split), RIG_TEST(long_slabs), RIG_TEST(sums_of_64_bits), RIG_TEST(longest_volume),
             RIG_TEST(float_sums_would_drift), RIG_TEST(many_passes))
