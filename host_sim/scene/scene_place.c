/* SPDX-License-Identifier: MIT */
/*
 * Gaps are measured along beams, on the solids themselves and not on voxels: a beam's end at the skin is
 * looked for by steps of half the distance to it, and bisected. A move along the beam changes all the gaps
 * alike, so one search for the shortest is enough. Beams stand 1 mm apart, or a hundredth of what both cover
 * if that is more, and a quarter of it around the shortest.
 */
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

#include <stdlib.h>

#define COARSE_MM 1.0f
#define BEAMS     100.0f /* along an axis at most */
#define FINER     0.25f
#define NEAR_MM   0.05f /* the least step along a beam */

/* Fetuses, and what they touch. */
typedef struct {
    hs_solid_list list;
    uint32_t bodies;
    float low[3], high[3];
    uint16_t item[HS_SCENE_MAX_SOLIDS], on_beam[HS_SCENE_MAX_SOLIDS];
    uint32_t first[HS_PART_COUNT + 1], first_on_beam[HS_PART_COUNT + 1];
} fetuses;

/* What a gap is measured from: an occluder's far side, or the wall's end at the sac. */
typedef struct {
    const hs_scene_spec *spec;
    hs_solid solid; /* the occluder, or the sac */
    bool is_sac;
    fetuses *to;
} gap;

static bool is_skin(const hs_solid *s) {
    return s->part == HS_PART_SKIN || s->part == HS_PART_PATCH;
}

/* The skin of fetus `number`, or of all (-1). */
static bool collect(const hs_scene_spec *spec, int number, fetuses *out) {
    uint32_t bodies = 0;
    out->list.count = 0;
    for (uint32_t i = 0; i < spec->structure_count; i++) {
        if (spec->structure[i].kind != HS_STRUCTURE_FETUS || (number >= 0 && number != (int)i)) continue;
        hs_fetus_solids(&out->list, &spec->structure[i].of.fetus, bodies++);
    }
    out->bodies = bodies;
    for (int a = 0; a < 3; a++) {
        out->low[a] = INFINITY;
        out->high[a] = -INFINITY;
        for (size_t i = 0; i < out->list.count; i++) {
            if (!is_skin(&out->list.items[i])) continue;
            out->low[a] = fminf(out->low[a], out->list.items[i].low[a]);
            out->high[a] = fmaxf(out->high[a], out->list.items[i].high[a]);
        }
    }
    return hs_shape_all(&out->list, out->item, out->first);
}

/* The solids whose bounds the beam at x, y touches. */
static hs_shape on_beam(fetuses *f, float x, float y) {
    uint32_t kept = 0;
    for (uint32_t part = 0; part < HS_PART_COUNT; part++) {
        f->first_on_beam[part] = kept;
        for (uint32_t i = f->first[part]; i < f->first[part + 1]; i++) {
            const hs_solid *s = &f->list.items[f->item[i]];
            if (s->part <= HS_PART_PATCH && x >= s->low[0] && x <= s->high[0] && y >= s->low[1] &&
                y <= s->high[1])
                f->on_beam[kept++] = f->item[i];
        }
    }
    f->first_on_beam[HS_PART_COUNT] = kept;
    return (hs_shape){f->list.items, f->on_beam, f->first_on_beam};
}

/* Where the beam at x, y meets the skin; NAN if it does not. */
static float skin_depth(fetuses *f, float x, float y) {
    const hs_shape shape = on_beam(f, x, y);
    if (shape.first[HS_PART_SKIN] == shape.first[HS_PART_SKIN + 1]) return NAN;
    float outside = f->low[2], p[3] = {x, y, outside};
    while (p[2] < f->high[2]) {
        float d = hs_shape_body(&shape, f->bodies, p);
        if (d <= 0.0f) break;
        outside = p[2];
        p[2] += fmaxf(0.5f * d, NEAR_MM);
    }
    if (p[2] >= f->high[2]) return NAN;
    float inside = p[2];
    for (int i = 0; i < 8; i++) {
        p[2] = 0.5f * (inside + outside);
        if (hs_shape_body(&shape, f->bodies, p) <= 0.0f)
            inside = p[2];
        else
            outside = p[2];
    }
    return inside;
}

/* Where the beam at x, y leaves an ellipsoid: the larger root of |A (o + z e - c)| = 1, A its axes by
 * their radii. */
static float ellipsoid_end(const hs_solid *s, float x, float y) {
    const float o[3] = {x - s->centre[0], y - s->centre[1], -s->centre[2]};
    float dd = 0.0f, od = 0.0f, oo = 0.0f;
    for (int i = 0; i < 3; i++) {
        const float *row = s->axis + (size_t)i * 3;
        float along = row[2] / s->radii[i];
        float from = (row[0] * o[0] + row[1] * o[1] + row[2] * o[2]) / s->radii[i];
        dd += along * along;
        od += from * along;
        oo += from * from;
    }
    float root = od * od - dd * (oo - 1.0f);
    return root >= 0.0f ? (-od + sqrtf(root)) / dd : NAN;
}

/* Where the beam at x, y first leaves the wall for the sac. It comes from before all of the sac. */
static float sac_end(const gap *g, float x, float y) {
    const hs_sac_spec *sac = &g->spec->sac;
    const float last = g->spec->extent_mm;
    float square = 0.0f;
    for (size_t i = 0; i < 3; i++) {
        const float along = g->solid.axis[3 * i + 2] * g->solid.radii[i];
        square += along * along;
    }
    float outside = g->solid.centre[2] - sqrtf(square) - 2.0f * sac->roughness_mm - 1.0f;
    float p[3] = {x, y, outside};
    while (p[2] < last) {
        float d = hs_shape_sac_distance(&g->solid, sac, p);
        if (d < 0.0f) break;
        outside = p[2];
        p[2] += fmaxf(0.25f * d, 0.25f);
    }
    if (p[2] >= last) return NAN;
    float inside = p[2];
    for (int i = 0; i < 8; i++) {
        p[2] = 0.5f * (inside + outside);
        if (hs_shape_sac_distance(&g->solid, sac, p) < 0.0f)
            inside = p[2];
        else
            outside = p[2];
    }
    return inside;
}

/* What lies between at x, y; NAN if the beam does not meet both. */
static float length_at(const gap *g, float x, float y) {
    float from = g->is_sac ? sac_end(g, x, y) : ellipsoid_end(&g->solid, x, y);
    return isnan(from) ? NAN : skin_depth(g->to, x, y) - from;
}

static void shortest_in(const gap *g, const float low[2], const float high[2], float step, float best[3]) {
    const int nx = (int)floorf((high[0] - low[0]) / step), ny = (int)floorf((high[1] - low[1]) / step);
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++) {
            const float x = low[0] + step * (float)i, y = low[1] + step * (float)j;
            const float length = length_at(g, x, y);
            if (isnan(length) || length >= best[2]) continue;
            best[0] = x;
            best[1] = y;
            best[2] = length;
        }
}

/* The shortest; INFINITY if no beam through the volume meets both. */
static float shortest(const gap *g) {
    float best[3] = {0, 0, INFINITY}, low[2], high[2];
    for (int a = 0; a < 2; a++) {
        low[a] = fmaxf(g->to->low[a], 0.0f);
        high[a] = fminf(g->to->high[a], g->spec->extent_mm);
        if (g->is_sac) continue;
        low[a] = fmaxf(low[a], g->solid.low[a]);
        high[a] = fminf(high[a], g->solid.high[a]);
    }
    const float step = fmaxf(COARSE_MM, fmaxf(high[0] - low[0], high[1] - low[1]) / BEAMS);
    shortest_in(g, low, high, step, best);
    if (isinf(best[2])) return INFINITY;
    const float around[2][2] = {{best[0] - step, best[1] - step}, {best[0] + step, best[1] + step}};
    shortest_in(g, around[0], around[1], FINER * step, best);
    return best[2];
}

static bool missing(const hs_scene_spec *spec, uint32_t index, const char *what, hs_error *err) {
    return hs_fail(err, HS_ERR_INPUT, "scene %s: structures[%u].gap_mm: no beam meets both %s", spec->name,
                   index, what);
}

static bool place_fetus(hs_scene_spec *spec, uint32_t index, fetuses *f, hs_error *err) {
    hs_fetus_spec *fetus = &spec->structure[index].of.fetus;
    if (isnan(fetus->gap_mm)) return true;
    if (!collect(spec, (int)index, f))
        return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for its gaps", spec->name);
    const gap g = {.spec = spec, .solid = hs_shape_sac(&spec->sac), .is_sac = true, .to = f};
    const float length = shortest(&g);
    if (isinf(length)) return missing(spec, index, "the wall and this fetus", err);
    fetus->position[2] += fetus->gap_mm - length;
    return true;
}

static bool place_occluder(hs_scene_spec *spec, uint32_t index, fetuses *f, hs_error *err) {
    hs_occluder_spec *o = &spec->structure[index].of.occluder;
    hs_solid_list one = {0};
    const hs_solid_frame frame = hs_frame_at(o->centre, o->rotation);
    const float zero[3] = {0, 0, 0};
    if (isnan(o->gap_mm)) return true;
    const hs_solid *solid =
        hs_solid_ellipsoid(&one, &frame, HS_PART_OCCLUDER, o->tissue, 0.0f, zero, o->radii);
    gap g = {.spec = spec, .to = f};
    if (solid) g.solid = *solid;
    hs_solid_list_free(&one);
    if (!solid || !collect(spec, -1, f))
        return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for its gaps", spec->name);
    const float length = shortest(&g);
    if (isinf(length)) return missing(spec, index, "this occluder and a fetus", err);
    o->centre[2] += length - o->gap_mm;
    return true;
}

bool hs_scene_place(hs_scene_spec *spec, hs_error *err) {
    fetuses *f = calloc(1, sizeof *f);
    bool ok = f != NULL || hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory for its gaps", spec->name);
    for (uint32_t i = 0; ok && i < spec->structure_count; i++)
        if (spec->structure[i].kind == HS_STRUCTURE_FETUS) ok = place_fetus(spec, i, f, err);
    for (uint32_t i = 0; ok && i < spec->structure_count; i++)
        if (spec->structure[i].kind == HS_STRUCTURE_OCCLUDER) ok = place_occluder(spec, i, f, err);
    if (f) hs_solid_list_free(&f->list);
    free(f);
    return ok;
}
