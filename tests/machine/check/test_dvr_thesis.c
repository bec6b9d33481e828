/* SPDX-License-Identifier: MIT */
/*
 * The thesis' look is bit for bit what it was before there was another: sums over pictures, projections and
 * ends of rays of the renderer's cases, which were taken from the renderer as it stood then. Only views with
 * a step of one slice count: the others need pow, which a driver may round as it likes. A GPU may round
 * divisions, too, so the sums are those of a CPU device.
 */
#include "support/dvr_fixture.h"

/* FNV-1a, 64 bits. */
static uint64_t add(uint64_t sum, const void *data, size_t bytes) {
    const uint8_t *at = data;
    for (size_t i = 0; i < bytes; i++) sum = (sum ^ at[i]) * UINT64_C(0x100000001b3);
    return sum;
}

/* The view at every scene, without a confidence or with one. */
static uint64_t sum_of(const hs_cl *cl, size_t view, bool with_confidence) {
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (size_t scene = 0; scene < SCENES; scene++) {
        test_random random = {(uint32_t)(300 + scene * 53 + view)};
        hs_camera camera;
        hs_dvr_settings s;
        float map[MAP_W * MAP_H], confidence[MAP_W * MAP_H];
        hs_volume volume = dvr_lay_out(&random, scene, view, 2.0f, &camera, &s, map);
        for (uint32_t i = 0; i < MAP_W * MAP_H; i++) confidence[i] = (float)test_uniform(&random, 0.0, 1.0);
        dvr_picture p = dvr_render(cl, &volume, &camera, &s, dvr_views[view].map == MAP_NONE ? NULL : map,
                                   with_confidence ? confidence : NULL);
        const size_t pixels = (size_t)s.width * s.height;
        sum = add(sum, p.rgba, pixels * 4);
        sum = add(sum, p.gray, pixels);
        sum = add(sum, p.termination, pixels * sizeof *p.termination);
    }
    return sum;
}

static void bits_are_as_before(void **state) {
    static const struct {
        size_t view;
        bool with_confidence;
        uint64_t sum;
    } cases[] = {
        {0, false, UINT64_C(0x2f67408f2960fca5)}, {1, false, UINT64_C(0xea5c47c3adaa7e78)},
        {4, false, UINT64_C(0xbff33cf2d82af759)}, {4, true, UINT64_C(0xa1ea413dd0de8a1e)},
        {5, true, UINT64_C(0xd5b52e2c1c445353)},  {6, true, UINT64_C(0xad3496bcee5bcce7)},
        {7, false, UINT64_C(0x601835b6e77ff29d)}, {8, false, UINT64_C(0x8c697db1a0637bc5)},
        {9, false, UINT64_C(0x631f67f17e0b0b04)},
    };
    const hs_cl *cl = *state;
    if (!cl->is_cpu) skip();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const uint64_t sum = sum_of(cl, cases[i].view, cases[i].with_confidence);
        if (sum != cases[i].sum)
            fail_msg("view %zu%s: the sum is %016llx, expected %016llx", cases[i].view,
                     cases[i].with_confidence ? " with a confidence" : "", (unsigned long long)sum,
                     (unsigned long long)cases[i].sum);
    }
}

HOST_MAIN(cmocka_unit_test(bits_are_as_before))
