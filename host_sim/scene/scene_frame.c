/* SPDX-License-Identifier: MIT */
/* A scene from its file to its volumes: the steps in their order, each only if the scene lists it. */
#include "core/system.h"
#include "core/threads.h"
#include "scene/scene.h"
#include "scene/scene_field.h"
#include "scene/scene_random.h"
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"
#include "volume/kretz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct hs_scene {
    char *json;
    hs_scene_spec spec;
};

enum { ALWAYS = 0 };

/* The steps in their order: what does it, and where the spec says whether the scene lists it. Those without
 * a function need more than field and spec. */
static const struct {
    const char *name;
    void (*run)(hs_field *field, const hs_scene_spec *spec);
    size_t on;
} steps[HS_SCENE_STEPS] = {
    [HS_SCENE_STEP_RASTER] = {"raster", NULL, ALWAYS},
    [HS_SCENE_STEP_ECHO] = {"echo", hs_scene_echo, ALWAYS},
    [HS_SCENE_STEP_ATTENUATION] = {"attenuation", hs_scene_attenuation,
                                   offsetof(hs_scene_spec, attenuation.on)},
    [HS_SCENE_STEP_EDGE_SHADOW] = {"edge shadow", hs_scene_edge_shadow, offsetof(hs_scene_spec, edge.on)},
    [HS_SCENE_STEP_REVERBERATION] = {"reverberation", hs_scene_reverberation,
                                     offsetof(hs_scene_spec, reverberation.on)},
    [HS_SCENE_STEP_HAZE] = {"haze", hs_scene_haze, offsetof(hs_scene_spec, haze.on)},
    [HS_SCENE_STEP_CORNER] = {"dark corner", hs_scene_dark_corner, offsetof(hs_scene_spec, corner.on)},
    [HS_SCENE_STEP_FAR_BAND] = {"far band", hs_scene_far_band, offsetof(hs_scene_spec, far_band.on)},
    [HS_SCENE_STEP_SPECKLE] = {"speckle", NULL, offsetof(hs_scene_spec, speckle.on)},
    [HS_SCENE_STEP_SIDE_LOBES] = {"side lobes", hs_scene_side_lobes, offsetof(hs_scene_spec, side_lobe.on)},
    [HS_SCENE_STEP_NOISE] = {"noise", hs_scene_noise, offsetof(hs_scene_spec, noise.on)},
    [HS_SCENE_STEP_COMPRESS] = {"compress", hs_scene_compress, ALWAYS},
    [HS_SCENE_STEP_FAN] = {"fan", hs_scene_fan, offsetof(hs_scene_spec, fan.on)},
    [HS_SCENE_STEP_CAMERA] = {"camera", NULL, offsetof(hs_scene_spec, camera_deg)},
    [HS_SCENE_STEP_TRUTH] = {"truth", NULL, ALWAYS},
};

const char *hs_scene_name(const hs_scene *scene) {
    return scene->spec.name;
}

const char *hs_scene_title(const hs_scene *scene) {
    return scene->spec.title;
}

const char *hs_scene_json(const hs_scene *scene) {
    return scene->json;
}

hs_scene *hs_scene_open(const char *name_or_path, hs_error *err) {
    char path[SYS_PATH + 256];
    char *text = hs_scene_text(name_or_path, path, sizeof path, err);
    hs_scene *scene = text ? calloc(1, sizeof *scene) : NULL;
    if (text && !scene) hs_fail(err, HS_ERR_MEMORY, "%s: no memory", path);
    if (scene && hs_scene_read_text(path, text, &scene->spec, err) && hs_scene_place(&scene->spec, err)) {
        scene->json = text;
        return scene;
    }
    free(text);
    free(scene);
    return NULL;
}

void hs_scene_close(hs_scene *scene) {
    if (scene) free(scene->json);
    free(scene);
}

/* What one frame is made from. */
typedef struct {
    hs_scene_spec spec; /* moved to the frame */
    hs_field field;
    hs_solid_list solids;
    const hs_volume *given; /* NULL but for a real scene */
    uint32_t *front;        /* hs_scene_real_front of it */
    bool lean;
    hs_speckle *speckle; /* NULL if the scene has none */
    hs_scene_data *data;
    hs_error *err;
} making;

static bool raster(making *m) {
    if (!hs_scene_raster(&m->field, &m->spec, &m->solids, NULL, m->err)) return false;
    if (m->given) hs_scene_real_place(&m->field, m->front);
    return true;
}

static bool truth(making *m) {
    if (m->given) hs_scene_real_combine(&m->field, m->given, m->front);
    if (!hs_scene_truth(&m->field, &m->spec, m->data, m->err)) return false;
    if (m->given) {
        memcpy(m->data->truth.voxels, m->given->voxels, hs_volume_count(m->given));
        m->data->truth_later = false;
    }
    if (!m->lean) hs_scene_fill_truth(m->data);
    return true;
}

/* Speckle, or the sum of both levels without. */
static void envelope(making *m) {
    if (m->speckle)
        hs_speckle_finish(m->speckle);
    else
        hs_scene_add_powers(&m->field);
}

static bool run_step(making *m, int step) {
    if (step == HS_SCENE_STEP_RASTER) return raster(m);
    if (step == HS_SCENE_STEP_CAMERA) return hs_scene_camera(&m->field, &m->spec, &m->solids, m->err);
    if (step == HS_SCENE_STEP_TRUTH) return truth(m);
    if (step == HS_SCENE_STEP_SPECKLE)
        envelope(m);
    else
        steps[step].run(&m->field, &m->spec);
    return !atomic_load(&m->field.out_of_memory) ||
           hs_fail(m->err, HS_ERR_MEMORY, "scene %s: no memory for %s", m->spec.name, steps[step].name);
}

/* Whether the scene asks for a step. */
static bool wanted(const making *m, int step) {
    if (steps[step].on == ALWAYS) return true;
    return step == HS_SCENE_STEP_CAMERA
               ? hs_scene_camera_turned(&m->spec)
               : *(const bool *)(const void *)((const char *)&m->spec + steps[step].on);
}

/* The wanted steps of these, one after the other. Without speckle the levels are added in its place. */
static bool run_steps(making *m, int first, int end) {
    for (int step = first; step < end; step++)
        if ((step == HS_SCENE_STEP_SPECKLE || wanted(m, step)) && !run_step(m, step)) return false;
    return true;
}

/* Slices that a pulse goes through at once. */
static uint32_t window_step(const hs_field *f) {
    return (f->threads + HS_SCENE_BRICK - 1) / HS_SCENE_BRICK * HS_SCENE_BRICK + HS_SCENE_BRICK;
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Slices that a window may hold at most: those that are not finished, those that are made now, and a brick
 * ahead, because normals look at the next slice. */
static uint32_t window_room(const hs_field *f, uint32_t reach, uint32_t all) {
    return least((reach > 0 ? reach : 1) + window_step(f) + HS_SCENE_BRICK, all);
}

/*
 * From solids to grey values. A field of a whole scene would take 11 bytes a voxel; so it is made from front
 * to back, window by window: tissues, then what the pulse meets on its way, then what the point spread makes
 * of it, some slices behind.
 */
static bool make_greys(making *m) {
    hs_field *f = &m->field;
    const uint32_t step = window_step(f), reach = hs_speckle_reach(&m->spec, f->h[2]);
    uint32_t drawn = 0, made = 0, done = 0;
    while (done < f->end) {
        const uint32_t next = least(made + step, f->end), ahead = least(next + HS_SCENE_BRICK, f->end);
        const uint32_t ready = next == f->end ? next : next > reach ? next - reach : 0;
        hs_field_move(f, least(done, made > 0 ? made - 1 : 0), ahead);
        hs_field_aim(f, drawn, ahead);
        if (!run_steps(m, HS_SCENE_STEP_RASTER, HS_SCENE_STEP_ECHO)) return false;
        hs_field_aim(f, made, next);
        if (!run_steps(m, HS_SCENE_STEP_ECHO, HS_SCENE_STEP_SPECKLE)) return false;
        if (m->speckle) hs_speckle_draw(m->speckle);
        hs_field_aim(f, done, ready);
        if (!run_steps(m, HS_SCENE_STEP_SPECKLE, HS_SCENE_STEP_FAN)) return false;
        drawn = ahead;
        made = next;
        done = ready;
    }
    return true;
}

/* Where the probe was. A scene's beams run along its z, as its shadows do, whatever fan it is seen in. */
static void tell_beams(const hs_scene_spec *spec, hs_volume *full) {
    hs_volume_scanned_from(full, HS_PROBE_LOW_Z);
    hs_scene_camera_turn(spec, full->probe_turn);
    full->course.kind = HS_BEAMS_PARALLEL;
}

static bool allocate(making *m, const uint32_t n[3], const float h[3]) {
    hs_scene_data *out = m->data;
    const char *name = m->spec.name;
    size_t pixels = (size_t)n[0] * n[1];
    if (!hs_volume_init(&out->full, n[0], n[1], n[2], m->err)) return false;
    if (!hs_volume_init(&out->truth, n[0], n[1], n[2], m->err)) return false;
    for (int a = 0; a < 3; a++)
        out->full.spacing[a] = out->truth.spacing[a] = m->given ? m->given->spacing[a] : (double)h[a];
    tell_beams(&m->spec, &out->full);
    if (m->given) out->full.pose = out->truth.pose = m->given->pose;
    snprintf(out->full.name, sizeof out->full.name, "%s", name);
    snprintf(out->truth.name, sizeof out->truth.name, "%s truth", name);
    out->label = calloc(pixels, 1);
    out->near_end = calloc(pixels, sizeof *out->near_end);
    out->far_end = calloc(pixels, sizeof *out->far_end);
    out->clip = calloc(pixels, sizeof *out->clip);
    if (out->label && out->near_end && out->far_end && out->clip) return true;
    return hs_fail(m->err, HS_ERR_MEMORY, "scene %s: no memory for %zu pixels", name, pixels);
}

static bool has_style(const hs_scene_spec *spec) {
    for (uint32_t i = 0; i < spec->structure_count; i++)
        if (hs_scene_style(&spec->structure[i])) return true;
    return false;
}

/* The field, with what its steps need beside it. */
static bool init_field(making *m, const uint32_t n[3], const float h[3]) {
    hs_field *f = &m->field;
    const hs_scene_spec *spec = &m->spec;
    f->greys = m->data->full.voxels;
    if (!hs_field_init(f, n, window_room(f, hs_speckle_reach(spec, h[2]), n[2]), h, m->err)) return false;
    if (spec->speckle.on && !(m->speckle = hs_speckle_begin(f, spec, window_step(f))))
        return hs_fail(m->err, HS_ERR_MEMORY, "scene %s: no memory for speckle", spec->name);
    if (has_style(spec) && !hs_field_add_style(f, m->err)) return false;
    if (!m->given) return true;
    m->front = hs_memory(hs_field_slice(f), sizeof *m->front, spec->name, m->err);
    if (m->front) hs_scene_real_front(m->given, f->threads, m->front);
    return m->front != NULL;
}

static bool make(making *m, const uint32_t n[3], const float h[3]) {
    if (!allocate(m, n, h) || !init_field(m, n, h)) return false;
    if (!hs_scene_solids(&m->spec, m->field.seed, &m->solids, m->err)) return false;
    if (!make_greys(m)) return false;
    hs_speckle_end(m->speckle);
    m->speckle = NULL;
    hs_field_free_planes(&m->field);
    if (!run_steps(m, HS_SCENE_STEP_FAN, HS_SCENE_STEPS)) return false;
    if (m->lean) return true;
    m->data->tissue = m->field.tissues; /* handed over */
    m->field.tissues = m->field.tissue = NULL;
    return true;
}

static bool check_options(const hs_scene *scene, const hs_scene_options *options, hs_error *err) {
    const char *name = scene->spec.name;
    if (scene->spec.real && !options->real)
        return hs_fail(err, HS_ERR_USAGE, "scene %s: needs a volume to put its occluders before", name);
    if (!scene->spec.real && options->real)
        return hs_fail(err, HS_ERR_USAGE, "scene %s: is synthetic, but the volume '%.200s' was given", name,
                       options->real);
    if (!scene->spec.real && (options->size < 32 || options->size > 512))
        return hs_fail(err, HS_ERR_USAGE, "scene %s: size is %u, expected 32 .. 512", name, options->size);
    return true;
}

/* The voxels: a cube of `size`, or those of the given volume, over which the scene's box is stretched. */
static void choose_grid(const making *m, uint32_t size, uint32_t n[3], float h[3]) {
    const uint32_t given[3] = {m->given ? m->given->nx : size, m->given ? m->given->ny : size,
                               m->given ? m->given->nz : size};
    for (int a = 0; a < 3; a++) {
        n[a] = given[a];
        h[a] = m->spec.extent_mm / (float)n[a];
    }
}

bool hs_scene_frame(const hs_scene *scene, const hs_scene_options *options, hs_scene_data *out,
                    hs_error *err) {
    memset(out, 0, sizeof *out);
    if (!check_options(scene, options, err)) return false;
    making *m = calloc(1, sizeof *m);
    if (!m) return hs_fail(err, HS_ERR_MEMORY, "scene %s: no memory", scene->spec.name);
    hs_volume given = {0};
    m->spec = scene->spec;
    m->given = options->real ? &given : NULL;
    m->lean = options->lean;
    m->data = out;
    m->err = err;
    hs_scene_move(&m->spec, options->frame);
    m->field.threads = hs_thread_count(options->threads);
    m->field.seed = options->seed ? options->seed : m->spec.seed;
    m->field.noise_seed = hs_random_key(m->field.seed, 1000u + (uint64_t)options->frame);
    bool ok = !options->real || (hs_volume_file_read(options->real, &given, err) &&
                                 hs_scene_real_lead(&given, m->spec.lead_mm / m->spec.extent_mm, err));
    if (ok) {
        uint32_t n[3];
        float h[3];
        choose_grid(m, options->size, n, h);
        ok = make(m, n, h);
    }
    if (!ok) hs_scene_free(out);
    hs_speckle_end(m->speckle);
    hs_field_free(&m->field);
    free(m->front);
    hs_solid_list_free(&m->solids);
    hs_volume_free(&given);
    free(m);
    return ok;
}

void hs_scene_free(hs_scene_data *data) {
    hs_volume_free(&data->full);
    hs_volume_free(&data->truth);
    free(data->label);
    free(data->near_end);
    free(data->far_end);
    free(data->clip);
    free(data->tissue);
    memset(data, 0, sizeof *data);
}
