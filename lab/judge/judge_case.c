/* SPDX-License-Identifier: MIT */
/* A volume with its ground truth, to judge the definition of the wall's surface on: from files or from a
 * scene. */
#include "judge/judge.h"

#include "core/system.h"
#include "render/camera.h"
#include "volume/fan_fit.h"
#include "volume/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void wall_case_free(wall_case *c) {
    free(c->full);
    free(c->first);
    free(c->end);
    free(c->label);
    free(c->truth);
    free(c->clean);
    free(c->near);
    free(c->far);
    *c = (wall_case){0};
}

sv_wall_volume wall_case_volume(const wall_case *c) {
    return (sv_wall_volume){.voxels = c->full,
                            .width = c->nx,
                            .height = c->ny,
                            .slices = c->nz,
                            .first = c->first,
                            .end = c->end,
                            .spacing_mm = {c->spacing_mm[0], c->spacing_mm[1], c->spacing_mm[2]}};
}

/* What is known of probe and beams, along the volume's axes. */
static sv_frame told_of(const hs_volume *v) {
    static const double straight[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    hs_camera camera;
    hs_told told;
    hs_camera_turn(&camera, v, straight);
    hs_camera_tell(&camera, v, (const uint32_t[3]){v->nx, v->ny, v->nz}, &told);
    sv_frame frame = {.beams = told.beams, .beam_sweep_mm = told.sweep_mm};
    memcpy(frame.probe_rotation, told.rotation, sizeof frame.probe_rotation);
    memcpy(frame.probe_side, told.side, sizeof frame.probe_side);
    for (int a = 0; told.beams == SV_BEAMS_FAN && a < 3; a++)
        frame.beam_apex_mm[a] = (float)(v->course.apex[a] - 0.5 * v->spacing[a]);
    return frame;
}

/* Takes the voxels of a volume; it is empty afterwards. */
static void take(wall_case *c, hs_volume *v, const char *name) {
    if (v->course.kind == HS_BEAMS_UNKNOWN) (void)hs_volume_find_beams(v, NULL);
    c->told = told_of(v);
    (void)snprintf(c->name, sizeof c->name, "%.63s", name);
    c->nx = v->nx;
    c->ny = v->ny;
    c->nz = v->nz;
    memcpy(c->spacing_mm, v->spacing, sizeof c->spacing_mm);
    c->full = v->voxels;
    v->voxels = NULL;
    hs_volume_free(v);
}

static bool make_ranges(wall_case *c, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    c->first = calloc(plane, sizeof *c->first);
    c->end = calloc(plane, sizeof *c->end);
    if (!c->first || !c->end)
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", c->name, plane);
    for (size_t i = 0; i < plane; i++)
        for (uint32_t z = 0; z < c->nz; z++) {
            if (c->full[z * plane + i] == 0) continue;
            if (c->end[i] == 0) c->first[i] = (uint16_t)z;
            c->end[i] = (uint16_t)(z + 1);
        }
    return true;
}

/* The case's name without what the loader's file names add to it. */
static void shorten(char *name) {
    char *const tail = strstr(name, "_full");
    if (tail && tail != name) *tail = '\0';
}

/* Termination depths in a ground truth. */
static bool find_truth(wall_case *c, const hs_volume *truth, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    c->truth = malloc(plane * sizeof *c->truth);
    if (!c->truth) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", c->name, plane);
    for (size_t i = 0; i < plane; i++) c->truth[i] = hs_eval_ray_end(truth->voxels, plane, c->nz, i, 0);
    return true;
}

/* A copy, or NULL with an error. */
static void *copy_of(const void *from, size_t bytes, const char *name, hs_error *err) {
    void *const to = malloc(bytes);
    if (to)
        memcpy(to, from, bytes);
    else
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", name, bytes);
    return to;
}

/* Black fluid as the file has it: with maps, a 0 needs no other value to tell that it was scanned. */
static bool take_black(const char *files, wall_case *c, hs_error *err) {
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    char path[SYS_PATH];
    hs_volume v;
    (void)snprintf(path, sizeof path, "%.*s", (int)strcspn(files, ","), files);
    if (!hs_metaimage_read(path, &as_it_is, &v, err)) return false;
    const size_t plane = (size_t)c->nx * c->ny;
    for (size_t i = 0; i < plane; i++)
        for (size_t z = c->first[i]; z < c->end[i]; z++) c->full[z * plane + i] = v.voxels[z * plane + i];
    hs_volume_free(&v);
    return true;
}

static bool has_maps(const char *files) {
    int commas = 0;
    for (const char *at = files; (at = strchr(at, ',')); at++) commas++;
    return commas == 4;
}

bool wall_case_take(const hs_eval_source *source, wall_case *out, hs_error *err) {
    const hs_volume *const full = hs_source_volume(&source->source, 0);
    const hs_volume *const truth = hs_source_truth(&source->source, 0);
    const size_t plane = (size_t)full->nx * full->ny;
    hs_volume copy = *full;
    *out = (wall_case){0};
    copy.beams = NULL;
    copy.voxels = copy_of(full->voxels, plane * full->nz, full->name, err);
    if (!copy.voxels) return false;
    take(out, &copy, full->name);
    shorten(out->name);
    out->label = copy_of(source->label, plane, out->name, err);
    out->clean = copy_of(truth->voxels, plane * out->nz, out->name, err);
    if (out->label && out->clean && find_truth(out, truth, err) && make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

bool wall_case_files(const char *files, wall_case *out, hs_error *err) {
    hs_eval_source source;
    const hs_eval_request request = {.name = files};
    *out = (wall_case){0};
    if (!strchr(files, ','))
        return hs_fail(err, HS_ERR_USAGE, "'%s': expected FULL,TRUTH,LABEL[,FIRST,END]", files);
    if (!hs_eval_source_open(&source, &request, err)) return false;
    const bool taken = wall_case_take(&source, out, err);
    hs_eval_source_close(&source);
    if (!taken || !has_maps(files) || take_black(files, out, err)) return taken;
    wall_case_free(out);
    return false;
}

static bool read_interval(const char *folder, const char *name, wall_case *c, hs_error *err) {
    char near[2048], far[2048];
    (void)snprintf(near, sizeof near, "%s/%s_near.mha", folder, name);
    (void)snprintf(far, sizeof far, "%s/%s_far.mha", folder, name);
    if (access(near, F_OK) != 0 || access(far, F_OK) != 0) return true;
    c->near = hs_metaimage_load_map(near, c->nx, c->ny, err);
    c->far = c->near ? hs_metaimage_load_map(far, c->nx, c->ny, err) : NULL;
    return c->far != NULL;
}

bool wall_case_read(const char *folder, const char *name, wall_case *out, hs_error *err) {
    char files[5 * 1024], own[1024];
    (void)snprintf(own, sizeof own, "%s/%s_first.mha", folder, name);
    const char *const scan = access(own, F_OK) == 0 ? name : "scan";
    const int length = snprintf(
        files, sizeof files, "%s/%s_full.mha,%s/%s_truth.mha,%s/%s_label.mha,%s/%s_first.mha,%s/%s_end.mha",
        folder, name, folder, name, folder, name, folder, scan, folder, scan);
    if (length < 0 || (size_t)length >= sizeof files)
        return hs_fail(err, HS_ERR_USAGE, "%.200s...: the path is too long", folder);
    if (!wall_case_files(files, out, err)) return false;
    if (read_interval(folder, name, out, err)) return true;
    wall_case_free(out);
    return false;
}

bool wall_case_scene(hs_scene_data *data, const char *name, wall_case *out, hs_error *err) {
    *out = (wall_case){.label = data->label, .near = data->near_end, .far = data->far_end};
    data->label = NULL;
    data->near_end = data->far_end = NULL;
    take(out, &data->full, name);
    const bool ok = find_truth(out, &data->truth, err) && make_ranges(out, err);
    out->clean = data->truth.voxels;
    data->truth.voxels = NULL;
    if (!ok) wall_case_free(out);
    return ok;
}

bool wall_case_open(const char *path, wall_case *out, hs_error *err) {
    hs_volume v;
    *out = (wall_case){0};
    if (!hs_metaimage_read(path, NULL, &v, err)) return false;
    char name[64];
    (void)snprintf(name, sizeof name, "%.63s", v.name);
    take(out, &v, name);
    if (make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

/* Trilinear at (x, y, z) voxels, over scanned voxels only; 0 if they weigh less than half. */
static uint8_t sample(const wall_case *c, const double at[3]) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    double sum = 0.0, weight = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        double w = 1.0;
        size_t index = 0, stride = 1;
        for (int axis = 0; axis < 3; axis++) {
            const double low = floor(at[axis]), rest = at[axis] - low, i = low + (corner >> axis & 1);
            w *= corner >> axis & 1 ? rest : 1.0 - rest;
            if (i < 0.0 || i >= n[axis]) w = 0.0;
            if (w > 0.0) index += (size_t)i * stride;
            stride *= n[axis];
        }
        if (w <= 0.0 || c->full[index] == 0) continue;
        sum += w * c->full[index];
        weight += w;
    }
    return weight >= 0.5 ? (uint8_t)fmin(fmax(sum / weight + 0.5, 1.0), 255.0) : 0;
}

bool wall_case_turn(const wall_case *from, int axis, double degrees, uint32_t side, wall_case *out,
                    hs_error *err) {
    const double co = cos(degrees * acos(-1.0) / 180.0), si = sin(degrees * acos(-1.0) / 180.0);
    const uint32_t n[3] = {from->nx, from->ny, from->nz};
    double diagonal = 0.0;
    for (int i = 0; i < 3; i++) diagonal += n[i] * from->spacing_mm[i] * n[i] * from->spacing_mm[i];
    const double mm = sqrt(diagonal) / side;
    *out = (wall_case){.nx = side, .ny = side, .nz = side, .spacing_mm = {mm, mm, mm}};
    (void)snprintf(out->name, sizeof out->name, "%.50s %c %.0f", from->name, "xyz"[axis], degrees);
    out->full = calloc((size_t)side * side, side);
    if (!out->full) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %u^3 voxels", from->name, side);
    uint8_t *voxel = out->full;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                double p[3] = {mm * (x + 0.5 - 0.5 * side), mm * (y + 0.5 - 0.5 * side),
                               mm * (z + 0.5 - 0.5 * side)};
                if (axis ==
                    2) { /* from the side: turning about the viewing direction alone would be one view */
                    const double swap = p[2];
                    p[2] = -p[1];
                    p[1] = swap;
                }
                double *a = &p[axis == 0 ? 1 : 0], *b = &p[axis == 2 ? 1 : 2];
                const double u = co * *a - si * *b, v = si * *a + co * *b;
                *a = u;
                *b = v;
                for (int i = 0; i < 3; i++) p[i] = p[i] / from->spacing_mm[i] + 0.5 * n[i] - 0.5;
                *voxel++ = sample(from, p);
            }
    if (make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

/* Rounds to the nearest grey level. */
static uint8_t to_grey(double level) {
    return (uint8_t)fmin(fmax(level + 0.5, 0.0), 255.0);
}

void wall_case_change(wall_case *c, double gain, double gamma, double black) {
    const size_t plane = (size_t)c->nx * c->ny;
    for (size_t i = 0; i < plane; i++)
        for (size_t z = c->first[i]; z < c->end[i]; z++) {
            const double level = 255.0 * pow(c->full[z * plane + i] / 255.0, gamma) * gain + black;
            c->full[z * plane + i] = to_grey(level);
        }
}

void wall_case_change_near(wall_case *c, uint32_t slices, double gain, double black) {
    const size_t plane = (size_t)c->nx * c->ny;
    for (size_t i = 0; i < plane; i++)
        for (size_t z = c->first[i]; z < c->end[i] && z < c->first[i] + slices; z++) {
            const double level = c->full[z * plane + i] * gain + black;
            c->full[z * plane + i] = to_grey(level);
        }
}

/* -------------------------------------------------------------------------------------- turned cameras -- */

enum { NEAR_RAYS = 2, NEAR_SLICES = 3 };

/* From voxels of the turned case to those of the case: at = row . (x, y, z, 1); in mm it is a turn about the
 * middle. */
typedef struct {
    double row[3][4], turn[3][3];
} mapping;

static mapping mapping_of(const wall_case *c, const double degrees[2]) {
    const double a = degrees[0] * acos(-1.0) / 180.0, b = degrees[1] * acos(-1.0) / 180.0;
    const double turn[3][3] = {{cos(b), sin(b) * sin(a), sin(b) * cos(a)},
                               {0.0, cos(a), -sin(a)},
                               {-sin(b), cos(b) * sin(a), cos(b) * cos(a)}};
    const double middle[3] = {0.5 * (c->nx - 1.0), 0.5 * (c->ny - 1.0), 0.5 * (c->nz - 1.0)};
    mapping m;
    memcpy(m.turn, turn, sizeof turn);
    for (int i = 0; i < 3; i++) {
        m.row[i][3] = middle[i];
        for (int k = 0; k < 3; k++) {
            m.row[i][k] = turn[i][k] * c->spacing_mm[k] / c->spacing_mm[i];
            m.row[i][3] -= m.row[i][k] * middle[k];
        }
    }
    return m;
}

static void place_of(const mapping *m, double x, double y, double z, double at[3]) {
    for (int i = 0; i < 3; i++) at[i] = m->row[i][0] * x + m->row[i][1] * y + m->row[i][2] * z + m->row[i][3];
}

/* The voxels around a place and their weights. False: not all of them were scanned. */
static bool around(const wall_case *c, const double at[3], size_t index[8], double weight[8]) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    uint32_t low[3];
    double rest[3];
    for (int i = 0; i < 3; i++) {
        if (at[i] < 0.0 || at[i] >= n[i] - 1.0) return false;
        low[i] = (uint32_t)at[i];
        rest[i] = at[i] - low[i];
    }
    for (uint32_t k = 0; k < 8; k++) {
        const size_t ray = (size_t)(low[1] + (k >> 1 & 1)) * c->nx + low[0] + (k & 1);
        const uint32_t z = low[2] + (k >> 2);
        if (z < c->first[ray] || z >= c->end[ray]) return false;
        index[k] = (size_t)z * c->nx * c->ny + ray;
        weight[k] = (k & 1 ? rest[0] : 1.0 - rest[0]) * (k & 2 ? rest[1] : 1.0 - rest[1]) *
                    (k & 4 ? rest[2] : 1.0 - rest[2]);
    }
    return true;
}

static uint8_t mix(const uint8_t *voxels, const size_t index[8], const double weight[8]) {
    double sum = 0.5;
    for (int k = 0; k < 8; k++) sum += weight[k] * voxels[index[k]];
    return (uint8_t)sum;
}

/* The voxels of a ray, in both volumes, and which were scanned. */
static void turn_ray(const wall_case *c, const mapping *m, uint32_t x, uint32_t y, wall_case *to) {
    const size_t plane = (size_t)c->nx * c->ny, ray = (size_t)y * c->nx + x;
    for (uint32_t z = 0; z < c->nz; z++) {
        double at[3], weight[8];
        size_t index[8];
        place_of(m, x, y, z, at);
        if (!around(c, at, index, weight)) continue;
        to->full[z * plane + ray] = mix(c->full, index, weight);
        to->clean[z * plane + ray] = mix(c->clean, index, weight);
        if (to->end[ray] == 0) to->first[ray] = (uint16_t)z;
        to->end[ray] = (uint16_t)(z + 1);
    }
}

/* What the ray of the case is that ends in this place. */
static uint8_t label_at(const wall_case *c, const double at[3]) {
    const int64_t x = (int64_t)floor(at[0] + 0.5), y = (int64_t)floor(at[1] + 0.5);
    if (x < 0 || y < 0 || x >= c->nx || y >= c->ny) return 0;
    double nearest = c->nz;
    for (int64_t v = y - NEAR_RAYS; v <= y + NEAR_RAYS; v++)
        for (int64_t u = x - NEAR_RAYS; u <= x + NEAR_RAYS; u++)
            if (u >= 0 && v >= 0 && u < c->nx && v < c->ny)
                nearest = fmin(nearest, fabs(at[2] - (double)c->truth[v * c->nx + u]));
    return nearest < NEAR_SLICES ? c->label[y * c->nx + x] : 0;
}

/* What the turned case tells of probe and beams, along its own axes. */
static void turn_told(const wall_case *c, const mapping *m, sv_frame *told) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    memset(told->probe_rotation, 0, sizeof told->probe_rotation);
    memset(told->probe_side, 0, sizeof told->probe_side);
    for (int i = 0; i < 3; i++) {
        double apex = 0.0;
        for (int k = 0; k < 3; k++) {
            const double middle = 0.5 * (n[k] - 1.0) * c->spacing_mm[k];
            for (int a = 0; a < 3; a++)
                told->probe_rotation[3 * i + a] += (float)(m->turn[k][i] * c->told.probe_rotation[3 * k + a]);
            told->probe_side[i] += (float)(m->turn[k][i] * c->told.probe_side[k]);
            apex += m->turn[k][i] * (c->told.beam_apex_mm[k] - middle);
        }
        if (told->beams == SV_BEAMS_FAN)
            told->beam_apex_mm[i] = (float)(apex + 0.5 * (n[i] - 1.0) * c->spacing_mm[i]);
    }
}

bool wall_case_room(const wall_case *from, uint32_t lead, wall_case *out, hs_error *err) {
    const size_t plane = (size_t)from->nx * from->ny, count = plane * (from->nz + lead);
    *out = *from;
    out->nz += lead;
    out->near = out->far = NULL; /* they hold for the rays of `from` */
    out->full = calloc(count, 1);
    out->clean = calloc(count, 1);
    out->first = calloc(plane, sizeof *out->first);
    out->end = calloc(plane, sizeof *out->end);
    out->label = calloc(plane, 1);
    out->truth = calloc(plane, sizeof *out->truth);
    if (out->full && out->clean && out->first && out->end && out->label && out->truth) return true;
    wall_case_free(out);
    return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a variant of %zu voxels", from->name, count);
}

bool wall_case_tilt(wall_case *c, const double degrees[2], hs_error *err) {
    const mapping m = mapping_of(c, degrees);
    const size_t plane = (size_t)c->nx * c->ny;
    wall_case to;
    if (!wall_case_room(c, 0, &to, err)) return false;
    (void)snprintf(to.name, sizeof to.name, "%.40s %.0f,%.0f", c->name, degrees[0], degrees[1]);
    turn_told(c, &m, &to.told);
    for (uint32_t y = 0; y < c->ny; y++)
        for (uint32_t x = 0; x < c->nx; x++) {
            const size_t ray = (size_t)y * c->nx + x;
            double at[3];
            turn_ray(c, &m, x, y, &to);
            to.truth[ray] = hs_eval_ray_end(to.clean, plane, c->nz, ray, 0);
            place_of(&m, x, y, (double)to.truth[ray], at);
            if (to.end[ray] && to.truth[ray] < (float)c->nz) to.label[ray] = label_at(c, at);
        }
    wall_case_free(c);
    *c = to;
    return true;
}
