/* SPDX-License-Identifier: MIT */
/* Slices beside a rendering, and what is said of a frame: over layers whose every pixel can be computed by
 * hand. */
#include "picture/picture_draw.h"
#include "show/loop_pictures.h"
#include "show/picture_slices.h"
#include "support/loop_fixture.h"

#include <math.h>

enum { CELL = 96, LEFT = 16 + CELL + 60, TOP = 16 + 38, NEXT = 60 + CELL + 16 };

/* The grey level, or the colour, at a share of a slice's sides: slice 0 across, 1 along, 2 at a depth. */
static uint32_t at(const hs_picture *p, int slice, double right, double down) {
    const uint32_t x = (uint32_t)(LEFT + slice * NEXT) + (uint32_t)(right * CELL),
                   y = TOP + (uint32_t)(down * CELL);
    return p->pixels[(size_t)y * p->width + x];
}

static uint32_t grey(double level) {
    return (uint32_t)level * 0x010101u;
}

/* A plane at depth 5 of 16 slices, which is 5.5 / 16 of 48 mm; the layers' depths are in voxels of 1 mm. */
static void the_line_is_where_the_plane_is(void **state) {
    const fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 5};
    const hs_loop_options o = options_with(&value, 1);
    hs_loop *loop = make_loop(f, &o);
    hs_view view = view_of(loop, 0);
    hs_picture p;
    const double plane = 5.5 / 16, occluder = (OCCLUDER + 4.0) / N, fetus = (FETUS + 9.0) / N;
    assert_true(fabs(hs_view_clip_depth(&view) - plane * N) < 1e-6);
    must(hs_picture_slices(&p, &view, CELL, &(hs_caption){0}, &err));
    for (int slice = 0; slice < 2; slice++) { /* depth runs down in the first and right in the second */
        const bool down = slice == 0;
        assert_int_equal(at(&p, slice, down ? 0.2 : occluder, down ? occluder : 0.2), grey(0.4 * 153));
        assert_int_equal(at(&p, slice, down ? 0.2 : fetus, down ? fetus : 0.2), grey(255));
        assert_int_equal(at(&p, slice, down ? 0.2 : plane - 0.5 / CELL, down ? plane - 0.5 / CELL : 0.2),
                         0xffd23f);
        assert_int_equal(at(&p, slice, down ? 0.2 : plane + 3.0 / CELL, down ? plane + 3.0 / CELL : 0.2),
                         grey(10));
    }
    hs_picture_free(&p);
}

/* Nothing is clipped: nothing is dimmed, and the sentence is one for people. */
static void nothing_clipped_is_said_in_words(void **state) {
    const fixture *f = *state;
    const sv_param_value values[2] = {{.id = DEPTH, .value = 5}, {.id = NOTE, .value = 1}};
    const hs_loop_options o = options_with(values, 2);
    hs_loop *loop = make_loop(f, &o);
    hs_view view = view_of(loop, 0);
    hs_picture p;
    char note[160];
    assert_false(view.maps.frame.clipped);
    assert_true(hs_view_clip_depth(&view) < 0);
    assert_string_equal(hs_frame_note(&view.maps.frame, "", note, sizeof note),
                        "No fluid found before the fetus: nothing removed.");
    must(hs_picture_slices(&p, &view, CELL, &(hs_caption){0}, &err));
    assert_int_equal(at(&p, 0, 0.2, (OCCLUDER + 4.0) / N), grey(153));
    hs_picture_free(&p);
}

static int tear_down_fonts(void **state) {
    hs_picture_finish(); /* or they count as leaks */
    return tear_down(state);
}

UNIT_MAIN(set_up, tear_down_fonts, the_line_is_where_the_plane_is, nothing_clipped_is_said_in_words)
