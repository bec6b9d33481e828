/* SPDX-License-Identifier: MIT */
#include "result/result_write.h"

#include "core/output_file.h"
#include "core/threads.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* From a voxel's index to the maps: (column, row, slice) = origin + index[0] * step[0] + ... */
typedef struct {
    double origin[3], step[3][3];
} voxel_to_map;

static void volume_size(const hs_volume *volume, double count[3]) {
    count[0] = volume->nx;
    count[1] = volume->ny;
    count[2] = volume->nz;
}

void hs_result_grid_of(const hs_maps *maps, const hs_volume *volume, hs_result_grid *grid) {
    const hs_camera *c = &maps->camera;
    const double extent[3] = {c->extent, c->extent, c->depth_extent};
    const double pixels[3] = {maps->width, maps->height, maps->slices};
    double count[3], middle[3], first[3];
    volume_size(volume, count);
    for (int k = 0; k < 3; k++) {
        grid->spacing[k] = extent[k] / pixels[k];
        middle[k] = 0.5 * (count[k] - 1.0);
    }
    grid->pose = (hs_pose){.stated = volume->pose.stated};
    /* The box stands around the volume's middle; its first pixel, in volume mm from there: */
    for (int k = 0; k < 3; k++) {
        first[k] = 0;
        for (int a = 0; a < 3; a++) first[k] += c->rotation[k * 3 + a] * 0.5 * (grid->spacing[a] - extent[a]);
        first[k] = middle[k] + first[k] / volume->spacing[k];
    }
    hs_pose_world(&volume->pose, volume->spacing, first, grid->pose.origin);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                grid->pose.direction[i * 3 + j] += volume->pose.direction[i * 3 + k] * c->rotation[k * 3 + j];
}

static void find_voxel_to_map(const hs_maps *maps, const hs_volume *volume, voxel_to_map *to_map) {
    const hs_camera *c = &maps->camera;
    const double extent[3] = {c->extent, c->extent, c->depth_extent};
    const double pixels[3] = {maps->width, maps->height, maps->slices};
    double count[3];
    volume_size(volume, count);
    for (int k = 0; k < 3; k++) {
        to_map->origin[k] = 0.5 * (pixels[k] - 1.0);
        for (int a = 0; a < 3; a++) {
            to_map->step[a][k] = c->rotation[a * 3 + k] * volume->spacing[a] * pixels[k] / extent[k];
            to_map->origin[k] -= to_map->step[a][k] * 0.5 * (count[a] - 1.0);
        }
    }
}

/* The depth in slices at which a ray through a place of the map begins; 0 if nothing is clipped there. */
static double depth_at(const hs_maps *maps, double column, double row) {
    const double depth = hs_map_at(maps->depth, maps->width, maps->height, column, row);
    return depth > 0.0 && isfinite(depth) ? depth : 0.0;
}

typedef struct {
    const hs_maps *maps;
    const hs_volume *volume;
    voxel_to_map to_map;
    uint8_t *mask;
} masking;

enum { STRIP = 64 }; /* voxels of a row */

/* The depths of a strip's rays, which are those of all slices if z does not move them. */
static void mask_strip(const masking *m, uint32_t x0, uint32_t y) {
    const voxel_to_map *t = &m->to_map;
    const hs_volume *v = m->volume;
    const uint32_t count = v->nx - x0 < STRIP ? v->nx - x0 : STRIP;
    const bool along_z = t->step[2][0] == 0.0 && t->step[2][1] == 0.0;
    double depth[STRIP], row[3];
    for (uint32_t z = 0; z < v->nz; z++) {
        uint8_t *out = m->mask + ((size_t)z * v->ny + y) * v->nx + x0;
        for (int k = 0; k < 3; k++) row[k] = t->origin[k] + y * t->step[1][k] + z * t->step[2][k];
        for (uint32_t i = 0; i < count && (z == 0 || !along_z); i++)
            depth[i] =
                depth_at(m->maps, row[0] + (x0 + i) * t->step[0][0], row[1] + (x0 + i) * t->step[0][1]);
        for (uint32_t i = 0; i < count; i++)
            out[i] = depth[i] == 0.0 || row[2] + (x0 + i) * t->step[0][2] >= depth[i];
    }
}

static void mask_row(void *context, uint32_t y) {
    const masking *m = context;
    for (uint32_t x = 0; x < m->volume->nx; x += STRIP) mask_strip(m, x, y);
}

void hs_result_mask(const hs_maps *maps, const hs_volume *volume,
                    uint8_t *mask) { /* NOLINT(readability-non-const-parameter) */
    masking m = {.maps = maps, .volume = volume, .mask = mask};
    find_voxel_to_map(maps, volume, &m.to_map);
    hs_parallel(hs_thread_count(0), volume->ny, mask_row, &m);
}

enum { NONE = -1 };

typedef struct {
    const hs_maps *maps;
    hs_result_grid grid;
    bool *usable;    /* a pixel whose surface lies in the volume, and in its box */
    int32_t *number; /* of its vertex, or NONE */
    hs_surface_size size;
} surface;

/* The index of a place of the map is what the map's place of an index is, turned round: the steps are at
 * right angles, so their transpose over their squared lengths does it. */
static bool lies_inside(const voxel_to_map *t, const hs_volume *v, const hs_crop *box,
                        const double place[3]) {
    const double count[3] = {v->nx, v->ny, v->nz};
    double rest[3], scale[3];
    for (int k = 0; k < 3; k++) {
        rest[k] = place[k] - t->origin[k];
        scale[k] = 0;
        for (int a = 0; a < 3; a++)
            scale[k] += t->step[a][k] * t->step[a][k] / (v->spacing[a] * v->spacing[a]);
    }
    for (int a = 0; a < 3; a++) {
        double index = 0;
        for (int k = 0; k < 3; k++)
            index += t->step[a][k] * rest[k] / (scale[k] * v->spacing[a] * v->spacing[a]);
        const double low = box->used ? fmax(box->low[a] / v->spacing[a], 0.0) : 0.0;
        const double high = box->used ? fmin(box->high[a] / v->spacing[a], count[a] - 1.0) : count[a] - 1.0;
        if (!(index >= low - 0.5 && index <= high + 0.5)) return false;
    }
    return true;
}

static void find_usable(surface *s, const hs_volume *volume, const hs_crop *box) {
    voxel_to_map to_map;
    find_voxel_to_map(s->maps, volume, &to_map);
    for (uint32_t y = 0; y < s->maps->height; y++)
        for (uint32_t x = 0; x < s->maps->width; x++) {
            const size_t i = (size_t)y * s->maps->width + x;
            const double place[3] = {x, y, (double)s->maps->depth[i]};
            s->usable[i] = s->maps->depth[i] > 0.0f && isfinite(s->maps->depth[i]) &&
                           lies_inside(&to_map, volume, box, place);
        }
}

/* True if the cell whose first pixel is `i` is a part of the surface. */
static bool is_cell(const surface *s, size_t i) {
    const size_t w = s->maps->width, corner[4] = {i, i + 1, i + w, i + w + 1};
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 4; k++) {
        if (!s->usable[corner[k]]) return false;
        low = fmin(low, (double)s->maps->depth[corner[k]]);
        high = fmax(high, (double)s->maps->depth[corner[k]]);
    }
    const double across = fmin(s->grid.spacing[0], s->grid.spacing[1]);
    return (high - low) * s->grid.spacing[2] <= HS_SURFACE_STEEPEST * across;
}

/* Counts the triangles and numbers the vertices that they need. */
static void number_vertices(surface *s) {
    const uint32_t w = s->maps->width, h = s->maps->height;
    for (size_t i = 0; i < (size_t)w * h; i++) s->number[i] = NONE;
    for (uint32_t y = 0; y + 1 < h; y++)
        for (uint32_t x = 0; x + 1 < w; x++) {
            const size_t i = (size_t)y * w + x;
            if (!is_cell(s, i)) continue;
            s->number[i] = s->number[i + 1] = s->number[i + w] = s->number[i + w + 1] = 0;
            s->size.triangles += 2;
        }
    for (size_t i = 0; i < (size_t)w * h; i++)
        if (s->number[i] != NONE) s->number[i] = (int32_t)s->size.vertices++;
}

/* Vertices in mm of the patient. */
static void place_vertices(const surface *s, float (*vertices)[3]) {
    for (uint32_t y = 0; y < s->maps->height; y++)
        for (uint32_t x = 0; x < s->maps->width; x++) {
            const size_t i = (size_t)y * s->maps->width + x;
            if (s->number[i] == NONE) continue;
            const double index[3] = {x, y, (double)s->maps->depth[i]};
            double world[3];
            hs_pose_world(&s->grid.pose, s->grid.spacing, index, world);
            for (int k = 0; k < 3; k++) vertices[s->number[i]][k] = (float)world[k];
        }
}

/* The picture's x runs right, y down and depth away: upper left, lower left, upper right turns against the
 * clock for who looks at it; along left-handed axes the other way round. */
static void place_triangles(const surface *s, int32_t (*out)[3]) {
    const uint32_t w = s->maps->width;
    const bool mirrored = hs_pose_is_mirrored(&s->grid.pose);
    for (uint32_t y = 0; y + 1 < s->maps->height; y++)
        for (uint32_t x = 0; x + 1 < w; x++) {
            const size_t i = (size_t)y * w + x;
            const int32_t *n = s->number + i;
            if (!is_cell(s, i)) continue;
            const int32_t *a = mirrored ? n + 1 : n + w, *b = mirrored ? n + w : n + 1;
            const int32_t cell[2][3] = {{n[0], *a, *b}, {*b, *a, n[w + 1]}};
            memcpy(out, cell, sizeof cell);
            out += 2;
        }
}

/* As many as were counted, at least room for one. */
static bool make_mesh(const surface *s, hs_mesh *mesh, hs_error *err) {
    mesh->size = s->size;
    mesh->vertices = hs_memory(s->size.vertices + 1u, sizeof *mesh->vertices, "surface", err);
    mesh->triangles = hs_memory(s->size.triangles + 1u, sizeof *mesh->triangles, "surface", err);
    if (!mesh->vertices || !mesh->triangles) return false;
    place_vertices(s, mesh->vertices);
    place_triangles(s, mesh->triangles);
    return true;
}

bool hs_result_surface(const hs_maps *maps, const hs_volume *volume, const hs_crop *box, hs_mesh *mesh,
                       hs_error *err) {
    const size_t rays = (size_t)maps->width * maps->height;
    surface s = {.maps = maps};
    *mesh = (hs_mesh){0};
    s.usable = hs_memory(rays, sizeof *s.usable, "surface", err);
    s.number = hs_memory(rays, sizeof *s.number, "surface", err);
    bool ok = s.usable && s.number;
    if (ok) {
        hs_result_grid_of(maps, volume, &s.grid);
        find_usable(&s, volume, box);
        number_vertices(&s);
        ok = make_mesh(&s, mesh, err);
    }
    free(s.usable);
    free(s.number);
    if (!ok) hs_mesh_free(mesh);
    return ok;
}

void hs_mesh_free(hs_mesh *mesh) {
    free(mesh->vertices);
    free(mesh->triangles);
    *mesh = (hs_mesh){0};
}

static bool write_head(const hs_mesh *mesh, const hs_volume *volume, hs_output_file *out, hs_error *err) {
    const bool mm = !volume->spacing_unsaid; /* lengths are; else nobody knows them */
    const int written = fprintf(
        out->file,
        "ply\nformat %s 1.0\ncomment SmartVis clipping surface, %s, %s\ncomment SPACE=LPS%s\n"
        "element vertex %" PRIu32
        "\nproperty float x\nproperty float y\nproperty float z\nelement face %" PRIu32
        "\nproperty list uchar int vertex_indices\nend_header\n",
        __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? "binary_big_endian" : "binary_little_endian",
        mm ? "mm" : "voxels: the file does not say its spacing",
        volume->pose.stated ? "x to the left, y to the back, z to the head (LPS)" : "along the source's axes",
        mm ? " UNIT=mm" : "", mesh->size.vertices, mesh->size.triangles);
    return written > 0 ||
           hs_fail(err, HS_ERR_OUTPUT, "%s: the header cannot be written: %s", out->path, strerror(errno));
}

static bool write_triangles(const hs_mesh *mesh, hs_output_file *out, hs_error *err) {
    static const uint8_t corners = 3;
    for (uint32_t i = 0; i < mesh->size.triangles; i++)
        if (!hs_output_write(out, &corners, 1, err) ||
            !hs_output_write(out, mesh->triangles[i], sizeof mesh->triangles[i], err))
            return false;
    return true;
}

bool hs_result_write_surface(const char *path, const hs_maps *maps, const hs_volume *volume,
                             const hs_crop *box, hs_surface_size *size, hs_error *err) {
    hs_output_file out;
    hs_mesh mesh;
    bool ok = hs_result_surface(maps, volume, box, &mesh, err);
    *size = mesh.size;
    ok = ok && hs_output_open(&out, path, err);
    if (ok) {
        ok = write_head(&mesh, volume, &out, err) &&
             hs_output_write(&out, mesh.vertices, mesh.size.vertices * sizeof *mesh.vertices, err) &&
             write_triangles(&mesh, &out, err);
        ok = hs_output_commit(&out, err) && ok;
    }
    hs_mesh_free(&mesh);
    return ok;
}
