/* SPDX-License-Identifier: MIT */
/*
 * Solids to voxels. The volume is cut into bricks of 8^3 voxels; a brick looks only at the solids whose
 * bounds it touches, so the cost is that of the surfaces, not of the volume.
 */
#include "scene/scene_raster.h"

#include "base/threads.h"
#include "scene/scene_random.h"

#include <stdlib.h>
#include <string.h>

enum { BRICK = 8 };

typedef struct {
    hs_field *field;
    const hs_scene_spec *spec;
    const hs_solid *solids; /* grouped by part */
    uint32_t solid_count;
    hs_solid sac;
    float *layer_shift; /* mm per (x, y): the undulation of the layers */
    float reach;        /* mm: how far from a surface its distance is wanted */
    float inv_h;
    uint32_t bricks[3];
} raster;

/* Indices of the solids a brick (or a row of bricks) has to look at;
 * first[part] .. first[part + 1] are of one part. */
typedef struct {
    uint16_t item[HS_SCENE_MAX_SOLIDS];
    uint32_t first[HS_PART_COUNT + 1];
    bool sac_near;
    float sac_sign;
} brick_list;

/* Bumps of the sac: three plane waves, a smooth function of place and seed. */
static float sac_distance(const raster *r, const float p[3]) {
    float d = hs_solid_distance(&r->sac, p);
    const hs_sac_spec *sac = &r->spec->sac;
    if (sac->roughness_mm <= 0.0f) return d;
    float k = 6.2831853f / sac->roughness_scale_mm;
    float s = sinf(k * (p[0] + 0.35f * p[1])) + sinf(k * (0.8f * p[1] - 0.4f * p[0]) + 1.3f) +
              sinf(k * (0.7f * p[2] + 0.5f * p[0] - 0.3f * p[1]) + 2.1f);
    return d + sac->roughness_mm * s * (1.0f / 3.0f);
}

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

static float blended(const raster *r, const brick_list *list, hs_solid_part part, const float p[3], float d) {
    for (uint32_t i = list->first[part]; i < list->first[part + 1]; i++) {
        const hs_solid *s = &r->solids[list->item[i]];
        d = hs_smooth_min(d, hs_solid_distance(s, p), s->blend);
    }
    return d;
}

static float body_distance(const raster *r, const brick_list *list, const float p[3]) {
    float d = blended(r, list, HS_PART_SKIN, p, 1e3f);
    for (uint32_t i = list->first[HS_PART_CARVE]; i < list->first[HS_PART_CARVE + 1]; i++) {
        const hs_solid *s = &r->solids[list->item[i]];
        d = -hs_smooth_min(-d, hs_solid_distance(s, p), s->blend);
    }
    return blended(r, list, HS_PART_PATCH, p, d);
}

/* The nearest solid of a part; its tissue is that of the voxel if the distance is negative. */
static float nearest(const raster *r, const brick_list *list, hs_solid_part part, const float p[3],
                     hs_tissue *tissue) {
    float d = 1e3f, least = 1e3f;
    for (uint32_t i = list->first[part]; i < list->first[part + 1]; i++) {
        const hs_solid *s = &r->solids[list->item[i]];
        float e = hs_solid_distance(s, p);
        if (e < least) {
            least = e;
            *tissue = s->tissue;
        }
        d = hs_smooth_min(d, e, s->blend);
    }
    return d;
}

static int8_t quantised(float mm, float inv_h) {
    float v = mm * inv_h * (float)HS_DISTANCE_ONE;
    return (int8_t)lrintf(fminf(fmaxf(v, (float)-HS_DISTANCE_FAR), (float)HS_DISTANCE_FAR));
}

static hs_tissue layer_tissue(const raster *r, float z, float shift) {
    const hs_layers_spec *layers = &r->spec->layers;
    float depth = shift;
    for (uint32_t i = 0; i < layers->count; i++) {
        depth += layers->thickness_mm[i];
        if (z < depth) return layers->tissue[i];
    }
    return HS_TISSUE_WALL;
}

static void voxel(const raster *r, const brick_list *list, const float p[3], size_t index, float shift) {
    hs_field *f = r->field;
    float body = has_part(list, HS_PART_SKIN) ? body_distance(r, list, p) : 1e3f;
    float bone = 1e3f;
    hs_tissue tissue = HS_TISSUE_FLUID, other = HS_TISSUE_PLACENTA;
    float occluder = nearest(r, list, HS_PART_OCCLUDER, p, &other);
    float wall = list->sac_near ? -sac_distance(r, p) : -list->sac_sign * 1e3f;
    if (body < r->reach) {
        hs_tissue organ = HS_TISSUE_SOFT, ignored;
        bone = nearest(r, list, HS_PART_BONE, p, &ignored);
        bone = fmaxf(bone, body);
        if (body < 0.0f) {
            tissue = HS_TISSUE_SOFT;
            if (nearest(r, list, HS_PART_ORGAN, p, &organ) < 0.0f) tissue = organ;
            if (bone < 0.0f) tissue = HS_TISSUE_BONE;
        }
    }
    if (tissue == HS_TISSUE_FLUID && occluder < 0.0f) tissue = other;
    if (tissue == HS_TISSUE_FLUID && wall < 0.0f) tissue = layer_tissue(r, p[2], shift);
    f->tissue[index] = (uint8_t)tissue;
    f->surface[index] = quantised(fminf(body, fminf(occluder, wall)), r->inv_h);
    f->bone[index] = quantised(bone, r->inv_h);
}

/* A brick no surface comes near: fluid, or the layers of the wall. */
static bool empty_brick(const brick_list *list) {
    return list->first[HS_PART_COUNT] == 0 && !list->sac_near;
}

static void brick(const raster *r, const uint32_t start[3], const brick_list *row_list, brick_list *list) {
    hs_field *f = r->field;
    uint32_t stop[3];
    float low[3], high[3];
    for (int a = 0; a < 3; a++) {
        stop[a] = start[a] + BRICK < f->n[a] ? start[a] + BRICK : f->n[a];
        low[a] = (float)start[a] * f->h[a];
        high[a] = (float)stop[a] * f->h[a];
    }
    collect(r, row_list, low, high, 0, 0, list);
    look_at_sac(r, low, high, list);
    bool empty = empty_brick(list), fluid = list->sac_sign < 0.0f;
    for (uint32_t z = start[2]; z < stop[2]; z++)
        for (uint32_t y = start[1]; y < stop[1]; y++) {
            size_t row = hs_field_index(f, start[0], y, z), width = stop[0] - start[0];
            const float *shift = r->layer_shift + (size_t)y * f->n[0];
            float p[3] = {0.0f, ((float)y + 0.5f) * f->h[1], ((float)z + 0.5f) * f->h[2]};
            if (empty) {
                memset(f->surface + row, fluid ? HS_DISTANCE_FAR : -HS_DISTANCE_FAR, width);
                memset(f->bone + row, HS_DISTANCE_FAR, width);
            }
            for (uint32_t x = start[0]; x < stop[0]; x++) {
                size_t index = row + x - start[0];
                p[0] = ((float)x + 0.5f) * f->h[0];
                if (!empty)
                    voxel(r, list, p, index, shift[x]);
                else
                    f->tissue[index] = (uint8_t)(fluid ? HS_TISSUE_FLUID : layer_tissue(r, p[2], shift[x]));
            }
        }
}

static void brick_row(void *context, uint32_t block) {
    const raster *r = context;
    const hs_field *f = r->field;
    brick_list row_list, list;
    uint32_t start[3] = {0, block % r->bricks[1] * BRICK, block / r->bricks[1] * BRICK};
    const float low[3] = {0.0f, (float)start[1] * f->h[1], (float)start[2] * f->h[2]};
    const float high[3] = {0.0f, low[1] + BRICK * f->h[1], low[2] + BRICK * f->h[2]};
    collect(r, NULL, low, high, 1, 2, &row_list);
    for (uint32_t bx = 0; bx < r->bricks[0]; bx++) {
        start[0] = bx * BRICK;
        brick(r, start, &row_list, &list);
    }
}

static int by_part(const void *a, const void *b) {
    const hs_solid *s = a, *t = b;
    if (s->part != t->part) return s->part < t->part ? -1 : 1;
    return s->order < t->order ? -1 : 1;
}

bool hs_scene_raster(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err) {
    if (solids->count > HS_SCENE_MAX_SOLIDS)
        return hs_fail(err, HS_ERR_INPUT, "scene %s: %zu solids, at most %u", spec->name, solids->count,
                       HS_SCENE_MAX_SOLIDS);
    for (size_t i = 0; i < solids->count; i++) solids->items[i].order = (uint32_t)i;
    if (solids->count) qsort(solids->items, solids->count, sizeof *solids->items, by_part);
    raster r = {
        .field = field, .spec = spec, .solids = solids->items, .solid_count = (uint32_t)solids->count};
    float h = fminf(field->h[0], fminf(field->h[1], field->h[2]));
    r.inv_h = 1.0f / h;
    r.reach = 2.5f * fmaxf(field->h[0], fmaxf(field->h[1], field->h[2]));
    for (int a = 0; a < 3; a++) r.bricks[a] = (field->n[a] + BRICK - 1) / BRICK;
    r.sac.shape = HS_SOLID_ELLIPSOID;
    memcpy(r.sac.centre, spec->sac.centre, sizeof r.sac.centre);
    memcpy(r.sac.radii, spec->sac.radii, sizeof r.sac.radii);
    hs_rotation(spec->sac.rotation, r.sac.axis);
    r.layer_shift = malloc(hs_field_slice(field) * sizeof *r.layer_shift);
    if (!r.layer_shift)
        return hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %zu pixels", hs_field_slice(field));
    float k = 6.2831853f / spec->extent_mm;
    for (uint32_t y = 0; y < field->n[1]; y++)
        for (uint32_t x = 0; x < field->n[0]; x++) {
            float u = k * ((float)x + 0.5f) * field->h[0], v = k * ((float)y + 0.5f) * field->h[1];
            r.layer_shift[(size_t)y * field->n[0] + x] =
                spec->layers.undulation_mm * 0.5f *
                (sinf(1.7f * u + 0.6f * v) + sinf(2.3f * v - 0.9f * u + 1.0f));
        }
    hs_parallel(field->threads, r.bricks[1] * r.bricks[2], brick_row, &r);
    free(r.layer_shift);
    return true;
}
