/* SPDX-License-Identifier: MIT */
/*
 * Solids to voxels. The volume is cut into bricks of 8^3 voxels; a brick looks only at the solids whose
 * bounds it touches, so the cost is that of the surfaces, not of the volume.
 */
#include "core/threads.h"
#include "scene/scene_field.h"
#include "scene/scene_solid.h"

#include <stdlib.h>
#include <string.h>

enum { BRICK = HS_SCENE_BRICK };

typedef struct {
    hs_field *field;
    const hs_scene_spec *spec;
    const hs_solid *solids; /* grouped by part */
    uint32_t solid_count, bodies;
    hs_solid sac;
    bool turned;        /* the voxels are a camera's, turned around the cube's middle */
    float turn[9];      /* rows: its axes in the scene */
    float *layer_shift; /* mm per (x, y): the undulation of the layers */
    float reach;        /* mm: how far from a surface its distance is wanted */
    float inv_h;
    uint32_t bricks[3];
} raster;

/* Indices of the solids a brick (or a row of bricks) has to look at; first[part] .. first[part + 1] are
 * of one part. */
typedef struct {
    uint16_t item[HS_SCENE_MAX_SOLIDS];
    uint32_t first[HS_PART_COUNT + 1];
    bool sac_near;
    float sac_sign;
} brick_list;

/* Keeps of `from` (NULL: all solids) those that touch low .. high on the axes first_axis .. last_axis. */
static void collect(const raster *r, const brick_list *from, const float low[3], const float high[3],
                    int first_axis, int last_axis, brick_list *list) {
    uint32_t total = from ? from->first[HS_PART_COUNT] : r->solid_count, kept = 0, part = 0;
    list->first[0] = 0;
    for (uint32_t i = 0; i < total; i++) {
        uint16_t index = from ? from->item[i] : (uint16_t)i;
        const hs_solid *s = &r->solids[index];
        while (part < (uint32_t)s->part) list->first[++part] = kept;
        bool apart = false;
        for (int a = first_axis; a <= last_axis; a++)
            apart |= s->low[a] - r->reach > high[a] || s->high[a] + r->reach < low[a];
        if (!apart) list->item[kept++] = index;
    }
    while (part < HS_PART_COUNT) list->first[++part] = kept;
}

static float sac_distance(const raster *r, const float p[3]) {
    return hs_shape_sac_distance(&r->sac, &r->spec->sac, p);
}

static void look_at_sac(const raster *r, const float low[3], const float high[3], brick_list *list) {
    float centre[3], half = 0.0f;
    for (int a = 0; a < 3; a++) {
        centre[a] = 0.5f * (low[a] + high[a]);
        half += 0.25f * (high[a] - low[a]) * (high[a] - low[a]);
    }
    float d = sac_distance(r, centre);
    /* The distance to an ellipsoid is a first-order one: twice the way is kept as a margin. */
    list->sac_near = fabsf(d) < 2.0f * (sqrtf(half) + r->reach + r->spec->sac.roughness_mm);
    list->sac_sign = d < 0.0f ? -1.0f : 1.0f;
}

static bool has_part(const brick_list *list, hs_solid_part part) {
    return list->first[part] < list->first[part + 1];
}

static int8_t quantised(float mm, float inv_h) {
    float v = mm * inv_h * (float)HS_DISTANCE_ONE;
    return (int8_t)lrintf(fminf(fmaxf(v, (float)-HS_DISTANCE_FAR), (float)HS_DISTANCE_FAR));
}

static float undulation(const hs_scene_spec *spec, float u, float v) {
    return spec->layers.undulation_mm * 0.5f * (sinf(1.7f * u + 0.6f * v) + sinf(2.3f * v - 0.9f * u + 1.0f));
}

/* The layer of the wall at p; `column` is its pixel, for voxels along the beams. */
static hs_tissue layer_tissue(const raster *r, const float p[3], size_t column) {
    const hs_layers_spec *layers = &r->spec->layers;
    const float k = 6.2831853f / r->spec->extent_mm;
    float depth = r->turned ? undulation(r->spec, k * p[0], k * p[1]) : r->layer_shift[column];
    for (uint32_t i = 0; i < layers->count; i++) {
        depth += layers->thickness_mm[i];
        if (p[2] < depth) return layers->tissue[i];
    }
    return HS_TISSUE_WALL;
}

/* How much of an occluder's scatterers are there: none at the edge of a soft one, all of them soft_mm
 * inside. `depth` is that below its surface. */
static uint8_t share_of(const raster *r, const hs_solid *s, float depth) {
    const float soft = r->spec->structure[s->style - 1].of.occluder.soft_mm;
    return soft > 0.0f ? (uint8_t)lrintf(255.0f * fminf(fmaxf(depth / soft, 0.0f), 1.0f)) : 255;
}

static hs_tissue body_tissue(const hs_shape *shape, const float p[3], float bone) {
    const hs_solid *organ = NULL;
    if (bone < 0.0f) return HS_TISSUE_BONE;
    return hs_shape_nearest(shape, HS_PART_ORGAN, p, &organ) < 0.0f && organ ? organ->tissue : HS_TISSUE_SOFT;
}

static void voxel(const raster *r, const brick_list *list, const float p[3], size_t index, size_t column) {
    hs_field *f = r->field;
    const hs_shape shape = {r->solids, list->item, list->first};
    const hs_solid *other = NULL, *ignored = NULL;
    float body = has_part(list, HS_PART_SKIN) ? hs_shape_body(&shape, r->bodies, p) : HS_SHAPE_FAR;
    float bone = HS_SHAPE_FAR;
    hs_tissue tissue = HS_TISSUE_FLUID;
    float occluder = hs_shape_nearest(&shape, HS_PART_OCCLUDER, p, &other);
    float urine = hs_shape_nearest(&shape, HS_PART_BLADDER, p, &ignored);
    float wall = list->sac_near ? -sac_distance(r, p) : -list->sac_sign * HS_SHAPE_FAR;
    uint8_t style = 0;
    if (body < r->reach) {
        bone = fmaxf(hs_shape_nearest(&shape, HS_PART_BONE, p, &ignored), body);
        if (body < 0.0f) tissue = body_tissue(&shape, p, bone);
    }
    if (tissue == HS_TISSUE_FLUID && urine < 0.0f) tissue = HS_TISSUE_URINE;
    if (tissue == HS_TISSUE_FLUID && occluder < 0.0f && other) {
        tissue = other->tissue;
        style = other->style;
    }
    if (tissue == HS_TISSUE_FLUID && wall < 0.0f) tissue = layer_tissue(r, p, column);
    f->tissue[index] = (uint8_t)tissue;
    if (!f->surface) return;
    f->surface[index] = quantised(fminf(body, fmaxf(fminf(occluder, wall), -urine)), r->inv_h);
    f->bone[index] = quantised(bone, r->inv_h);
    if (!f->style) return;
    f->style[index] = style;
    f->share[index] = style ? share_of(r, other, -fminf(occluder, wall)) : 255;
}

/* A brick no surface comes near: fluid, or the layers of the wall. */
static bool empty_brick(const brick_list *list) {
    return list->first[HS_PART_COUNT] == 0 && !list->sac_near;
}

/* A point of the voxels' cube in the scene. */
static void to_scene(const raster *r, float p[3]) {
    if (!r->turned) return;
    const float middle = 0.5f * r->spec->extent_mm;
    const float q[3] = {p[0] - middle, p[1] - middle, p[2] - middle};
    for (int a = 0; a < 3; a++)
        p[a] = middle + q[0] * r->turn[a] + q[1] * r->turn[3 + a] + q[2] * r->turn[6 + a];
}

/* What a box of the voxels' cube touches in the scene. */
static void box_in_scene(const raster *r, float low[3], float high[3]) {
    float middle[3], half[3];
    if (!r->turned) return;
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5f * (low[a] + high[a]);
        half[a] = 0.5f * (high[a] - low[a]);
    }
    to_scene(r, middle);
    for (int a = 0; a < 3; a++) {
        float reach =
            fabsf(r->turn[a]) * half[0] + fabsf(r->turn[3 + a]) * half[1] + fabsf(r->turn[6 + a]) * half[2];
        low[a] = middle[a] - reach;
        high[a] = middle[a] + reach;
    }
}

static void brick_voxels(const raster *r, const brick_list *list, const uint32_t start[3],
                         const uint32_t stop[3]) {
    hs_field *f = r->field;
    const bool empty = empty_brick(list), fluid = list->sac_sign < 0.0f;
    for (uint32_t z = start[2]; z < stop[2]; z++)
        for (uint32_t y = start[1]; y < stop[1]; y++) {
            size_t row = hs_field_index(f, start[0], y, z), width = stop[0] - start[0];
            if (empty && f->surface) {
                memset(f->surface + row, fluid ? HS_DISTANCE_FAR : -HS_DISTANCE_FAR, width);
                memset(f->bone + row, HS_DISTANCE_FAR, width);
                if (f->style) memset(f->style + row, 0, width);
            }
            for (uint32_t x = start[0]; x < stop[0]; x++) {
                size_t index = row + x - start[0];
                float p[3] = {((float)x + 0.5f) * f->h[0], ((float)y + 0.5f) * f->h[1],
                              ((float)(f->first + z) + 0.5f) * f->h[2]};
                to_scene(r, p);
                const size_t column = (size_t)y * f->n[0] + x;
                if (!empty)
                    voxel(r, list, p, index, column);
                else
                    f->tissue[index] = (uint8_t)(fluid ? HS_TISSUE_FLUID : layer_tissue(r, p, column));
            }
        }
}

static void brick(const raster *r, const uint32_t start[3], const brick_list *row_list, brick_list *list) {
    const hs_field *f = r->field;
    uint32_t stop[3];
    float low[3], high[3];
    for (int a = 0; a < 3; a++) {
        const uint32_t end = a == 2 ? f->high : f->n[a], before = a == 2 ? f->first : 0;
        stop[a] = start[a] + BRICK < end ? start[a] + BRICK : end;
        low[a] = (float)(before + start[a]) * f->h[a];
        high[a] = (float)(before + stop[a]) * f->h[a];
    }
    box_in_scene(r, low, high);
    collect(r, row_list, low, high, 0, r->turned ? 2 : 0, list);
    look_at_sac(r, low, high, list);
    brick_voxels(r, list, start, stop);
}

/* The solids of a row of bricks are looked for once; in a turned one all of them are. */
static void brick_row(void *context, uint32_t block) {
    const raster *r = context;
    const hs_field *f = r->field;
    brick_list row_list, list;
    uint32_t start[3] = {0, block % r->bricks[1] * BRICK, f->low + block / r->bricks[1] * BRICK};
    const float low[3] = {0.0f, (float)start[1] * f->h[1], (float)(f->first + start[2]) * f->h[2]};
    const float high[3] = {0.0f, low[1] + BRICK * f->h[1], low[2] + BRICK * f->h[2]};
    if (!r->turned) collect(r, NULL, low, high, 1, 2, &row_list);
    for (uint32_t bx = 0; bx < r->bricks[0]; bx++) {
        start[0] = bx * BRICK;
        brick(r, start, r->turned ? NULL : &row_list, &list);
    }
}

static bool make_layer_shift(raster *r, hs_error *err) {
    const hs_field *f = r->field;
    const float k = 6.2831853f / r->spec->extent_mm;
    r->layer_shift = hs_memory(hs_field_slice(f), sizeof *r->layer_shift, "scene", err);
    if (!r->layer_shift) return false;
    for (uint32_t y = 0; y < f->n[1]; y++)
        for (uint32_t x = 0; x < f->n[0]; x++)
            r->layer_shift[(size_t)y * f->n[0] + x] =
                undulation(r->spec, k * ((float)x + 0.5f) * f->h[0], k * ((float)y + 0.5f) * f->h[1]);
    return true;
}

bool hs_scene_raster(hs_field *f, const hs_scene_spec *spec, hs_solid_list *solids, const float *turn,
                     hs_error *err) {
    raster r = {.field = f, .spec = spec, .turned = turn != NULL};
    if (solids->count > HS_SCENE_MAX_SOLIDS)
        return hs_fail(err, HS_ERR_INPUT, "scene %s: %zu solids, at most %u", spec->name, solids->count,
                       HS_SCENE_MAX_SOLIDS);
    if (turn) memcpy(r.turn, turn, sizeof r.turn);
    hs_solid_list_sort(solids);
    r.solids = solids->items;
    r.solid_count = (uint32_t)solids->count;
    r.bodies = hs_solid_list_bodies(solids);
    r.inv_h = 1.0f / fminf(f->h[0], fminf(f->h[1], f->h[2]));
    r.reach = 2.5f * fmaxf(f->h[0], fmaxf(f->h[1], f->h[2]));
    for (int a = 0; a < 2; a++) r.bricks[a] = (f->n[a] + BRICK - 1) / BRICK;
    r.bricks[2] = (f->high - f->low + BRICK - 1) / BRICK;
    r.sac = hs_shape_sac(&spec->sac);
    if (!make_layer_shift(&r, err)) return false;
    hs_parallel(f->threads, r.bricks[1] * r.bricks[2], brick_row, &r);
    free(r.layer_shift);
    return true;
}
