/* SPDX-License-Identifier: MIT */
/*
 * Every parameter of the plugin's own list against the definition, by every method that it matters to: at its
 * ends, its default and between. A parameter has a row here, which tells the definition its value or says why
 * there is nothing to tell; one without a row fails, and so does a row whose values never move the surface.
 * Requirement: R2.
 */
#include "support/rig.h"

#include "method_list.h"
#include "ref/ref_chain.h"
#include "ref/ref_wall.h"
#include "smartvis/lookup.h"

#include <math.h>

enum { WIDTH = 40, HEIGHT = 34, SLICES = 44, RAYS = WIDTH * HEIGHT, MAX_VALUES = 8, MAX_SET = 8 };
static const float VOXEL_MM = 2.5f;

/* A frame's settings as the definitions know them. */
typedef struct {
    uint32_t method;
    sv_ref_bone bone;
    double evidence, min_gap, q;
    uint32_t substeps, passes; /* of the pre-filter, if there is one */
    bool prefilter, float32;
    sv_ref_settings settings;
    sv_wall_settings wall;
} defined;

/* ---- a row for every parameter */
#define TELLS(name, ...)                                                                                     \
    static void tell_##name(defined *d, double v) {                                                          \
        __VA_ARGS__;                                                                                         \
    }
TELLS(q, d->q = v)
TELLS(unsure, d->wall.clip_doubtful = v != 0.0)
TELLS(fluid_threshold, d->bone.fluid_threshold = v)
TELLS(bone_mode, d->bone.bone_mode = (int)v)
TELLS(bone_offset, d->bone.bone_offset = v)
TELLS(bone_threshold, d->bone.bone_threshold = v)
TELLS(bone_fraction, d->bone.bone_fraction = v)
TELLS(method, d->method = (uint32_t)v)
TELLS(kernel, d->settings.kernel = (uint32_t)v)
TELLS(fill_weight, d->settings.fill_weight = v)
TELLS(passes, d->settings.passes = (uint32_t)v)
TELLS(evidence, d->evidence = v)
TELLS(min_gap, d->min_gap = v)
TELLS(drop_empty, d->bone.drop_empty = v != 0.0)
TELLS(prefilter, d->prefilter = v != 0.0)
TELLS(prefilter_passes, d->passes = (uint32_t)v)
TELLS(prefilter_kernel, d->settings.prefilter_kernel = (uint32_t)v)
TELLS(lambda, d->settings.lambda = v)
TELLS(merge_grid, d->settings.merge_grid = (uint32_t)v)
/* A grid with no fewer nodes than the map has pixels is none. */
TELLS(spline_grid, d->settings.spline_grid = (v + 1.0) * (v + 1.0) < RAYS ? (uint32_t)v : 0)
TELLS(precision, d->float32 = v != 0.0)
TELLS(substeps, d->substeps = (uint32_t)v)

typedef struct {
    const char *key;
    void (*tell)(defined *d, double value);
    const char *why_not; /* nothing is told: the map is the same whatever the value */
    bool moved;          /* a value had another definition, or another bound, than the default */
} row;
static row rows[] = {
    {"q", tell_q, NULL, false},
    {"unsure", tell_unsure, NULL, false},
    {"fluid_threshold", tell_fluid_threshold, NULL, false},
    {"bone_mode", tell_bone_mode, NULL, false},
    {"bone_offset", tell_bone_offset, NULL, false},
    {"bone_threshold", tell_bone_threshold, NULL, false},
    {"bone_fraction", tell_bone_fraction, NULL, false},
    {"method", tell_method, NULL, false},
    {"kernel", tell_kernel, NULL, false},
    {"fill_weight", tell_fill_weight, NULL, false},
    {"passes", tell_passes, NULL, false},
    {"evidence", tell_evidence, NULL, false},
    {"min_gap", tell_min_gap, NULL, false},
    {"drop_empty", tell_drop_empty, NULL, false},
    {"prefilter", tell_prefilter, NULL, false},
    {"prefilter_passes", tell_prefilter_passes, NULL, false},
    {"prefilter_kernel", tell_prefilter_kernel, NULL, false},
    {"lambda", tell_lambda, NULL, false},
    {"merge_grid", tell_merge_grid, NULL, false},
    {"spline_grid", tell_spline_grid, NULL, false},
    {"precision", tell_precision, NULL, false},
    {"substeps", tell_substeps, NULL, false},
    {"strategy", NULL, "layouts of the same work", false},
};
enum { ROWS = sizeof rows / sizeof *rows };

static row *row_of(const char *key) {
    for (size_t i = 0; i < ROWS; i++)
        if (strcmp(rows[i].key, key) == 0) return &rows[i];
    fail_msg("the parameter '%s' has no row: how does the definition know its value, or why need it not?",
             key);
    return NULL;
}

/* ---- the frame by definition */
/* The wall's surface, and whether there is one. */
static bool by_wall(const sv_ref_volume *volume, const defined *d, double *surface) {
    static float depth[RAYS], confidence[RAYS];
    const double mm[3] = {(double)VOXEL_MM, (double)VOXEL_MM, (double)VOXEL_MM};
    sv_wall_settings settings = d->wall;
    sv_wall_outcome outcome;
    settings.q = d->q;
    assert_true(sv_wall_surface_padded(volume, mm, NULL, &settings, depth, confidence, &outcome, NULL));
    for (size_t i = 0; i < RAYS; i++) surface[i] = (double)depth[i];
    return outcome == SV_WALL_SURFACE || (outcome == SV_WALL_DOUBTFUL && settings.clip_doubtful);
}

/* The surface through the initial points at S(q), which are float32 for the minimum filter's sake. */
static bool by_points(const sv_ref_volume *volume, const defined *d, double *surface) {
    static sv_ref_ray rays[RAYS];
    static uint8_t status[RAYS];
    static double near_end[RAYS], far_end[RAYS], depth[RAYS];
    sv_ref_settings settings = d->settings;
    sv_ref_profile(volume, d->bone.fluid_threshold, d->substeps, rays);
    const uint32_t level = sv_ref_bone_level(rays, RAYS, &d->bone);
    const uint32_t points = sv_ref_points(rays, RAYS, &d->bone, level, status, near_end, far_end);
    const sv_ref_evidence found = sv_ref_gather_evidence(rays, RAYS, level, d->min_gap, d->substeps);
    memset(surface, 0, RAYS * sizeof *surface);
    if (!sv_ref_surface_wanted(points, found, d->evidence)) return false;
    for (size_t i = 0; i < RAYS; i++) {
        const float n = (float)near_end[i], f = (float)far_end[i];
        depth[i] = (double)(f + (float)d->q * (n - f));
    }
    settings.prefilter_passes = d->prefilter ? d->passes : 0;
    if (d->float32) /* at most 64 points */
        settings.merge_grid = settings.merge_grid > 0 && settings.merge_grid < 8 ? settings.merge_grid : 8;
    const sv_ref_task task = {.map = {status, depth, WIDTH, HEIGHT}, .q = d->q, .settings = &settings};
    assert_true(sv_ref_chain(sv_ref_method_of(d->method), &task, surface));
    return true;
}

static bool by_definition(const uint8_t *voxels, const defined *d, double *surface) {
    const sv_ref_volume volume = {voxels, WIDTH, HEIGHT, SLICES, SV_NO_PADDING, NULL};
    return sv_ref_method_of(d->method)->takes_volume ? by_wall(&volume, d, surface)
                                                     : by_points(&volume, d, surface);
}

static double bound_of(const defined *d) {
    const sv_ref_task task = {.map = {.width = WIDTH, .height = HEIGHT}, .q = d->q, .settings = &d->settings};
    const sv_ref_device device = {.slices = SLICES, .substeps = d->substeps, .doubles = !d->float32};
    return sv_ref_bound(sv_ref_method_of(d->method), &task, &device);
}

/* ---- the same frame by the plugin */
/* Values that are not the defaults. */
typedef struct {
    uint32_t count;
    struct {
        sv_param_info info;
        double value;
    } of[MAX_SET];
} set;

static void put(set *s, const sv_param_info *info, double value) {
    assert_true(s->count < MAX_SET);
    s->of[s->count].info = *info;
    s->of[s->count++].value = value;
}

static defined defaults_of(const rig *r) {
    defined d = {.settings = sv_ref_default_settings, .wall = sv_wall_settings_default()};
    sv_param_info info;
    for (uint32_t i = 0; sv_lookup_index(r->plugin, i, &info); i++) {
        const row *known = row_of(info.key);
        if (known->tell) known->tell(&d, info.default_value);
    }
    return d;
}

static void run(rig *r, const uint8_t *voxels, const set *s, rig_result *out, sv_status *status) {
    rig_format format = {.width = WIDTH,
                         .height = HEIGHT,
                         .slices = SLICES,
                         .slab_slices = 9,
                         .padding = SV_NO_PADDING,
                         .voxel_mm = VOXEL_MM};
    sv_param_value values[MAX_SET];
    uint32_t fixed = 0, count = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const sv_param_value value = {s->of[i].info.id, 0, s->of[i].value};
        if (s->of[i].info.flags & SV_PARAM_REACTIVATE)
            format.fixed[fixed++] = value;
        else
            values[count++] = value;
    }
    *status = rig_run(r, &format, voxels, values, count, out);
    if (*status < SV_OK) fail_msg("status %d: %s", (int)*status, r->last_log);
}

static void in_words(const set *s, char *out, size_t bytes) {
    size_t used = 0;
    for (uint32_t i = 0; i < s->count && used < bytes; i++)
        used += (size_t)snprintf(out + used, bytes - used, "%s%s = %g", i ? ", " : "", s->of[i].info.key,
                                 s->of[i].value);
}

/* Holds one frame to its definition, which is left in `surface`. Returns by how much it may be missed. */
static double hold(rig *r, const uint8_t *voxels, const set *s, double *surface) {
    char what[300] = "defaults";
    const void *mark = unit_mark();
    defined d = defaults_of(r);
    rig_result out = rig_result_make(WIDTH, HEIGHT);
    sv_status status;
    in_words(s, what, sizeof what);
    for (uint32_t i = 0; i < s->count; i++)
        if (row_of(s->of[i].info.key)->tell) row_of(s->of[i].info.key)->tell(&d, s->of[i].value);
    const bool clips = by_definition(voxels, &d, surface);
    const double bound = bound_of(&d);
    run(r, voxels, s, &out, &status);
    if ((status != SV_NO_SURFACE) != clips) fail_msg("%s: outcome %d", what, (int)status);
    for (size_t i = 0; i < RAYS; i++)
        if (!(fabs((double)out.depth[i] - surface[i]) <= bound))
            fail_msg("%s: the depth at (%zu, %zu) is %.7g, by definition %.7g +- %.1g", what, i % WIDTH,
                     i / WIDTH, (double)out.depth[i], surface[i], bound);
    unit_return(mark);
    return bound;
}

/* ---- all parameters */
static void add_value(double *list, uint32_t *count, double value) {
    for (uint32_t i = 0; i < *count; i++)
        if (list[i] == value) return;
    list[(*count)++] = value;
}

/* All values of what has few, else its ends and the first step, those for a slider, and one between. */
static uint32_t values_of(const rig *r, const sv_param_info *p, double *out) {
    char text[64];
    uint32_t count = 0;
    const bool few = p->type == SV_PARAM_ENUM || (p->max_value - p->min_value) / p->step < 4.0;
    for (double v = p->min_value; few && v <= p->max_value; v += p->step)
        if (r->plugin->param_text(r->plugin, p->id, v, text, sizeof text) == SV_OK) add_value(out, &count, v);
    if (few) return count;
    add_value(out, &count, p->min_value);
    add_value(out, &count, p->max_value);
    add_value(out, &count, p->min_value + p->step);
    if (p->display_max > p->display_min) add_value(out, &count, p->display_min);
    if (p->display_max > p->display_min) add_value(out, &count, p->display_max);
    add_value(out, &count, p->min_value + p->step * floor((p->max_value - p->min_value) / p->step / 7.0));
    return count;
}

static void hold_parameter(rig *r, const uint8_t *voxels, const sv_param_info *p, const set *base) {
    static double usual[RAYS], surface[RAYS];
    double values[MAX_VALUES];
    row *known = row_of(p->key);
    const uint32_t count = values_of(r, p, values);
    const double bound = hold(r, voxels, base, usual);
    for (uint32_t i = 0; i < count; i++) {
        set s = *base;
        put(&s, p, values[i]);
        known->moved |= hold(r, voxels, &s, surface) != bound || memcmp(surface, usual, sizeof surface) != 0;
    }
}

static void hold_all(rig *r, const uint8_t *voxels, const sv_param_info *method, double value) {
    sv_param_info p, on;
    sv_param_value others[RIG_MAX_ENABLE];
    for (uint32_t i = 0; sv_lookup_index(r->plugin, i, &p); i++) {
        set base = {0};
        const int count = p.id == method->id ? -1 : rig_enable(r, &p, value, others);
        put(&base, method, value);
        for (int n = 0; n < count; n++) {
            assert_true(sv_lookup_id(r->plugin, others[n].id, &on));
            put(&base, &on, others[n].value);
        }
        if (count >= 0) hold_parameter(r, voxels, &p, &base);
    }
}

/* Layers, with a column of rays in seven that show no fluid: bone that gives an empty interval. */
static uint8_t *patchy_layers(void) {
    uint8_t *voxels = rig_volume(RIG_LAYERS, WIDTH, HEIGHT, SLICES, 5);
    for (size_t i = 0; i < (size_t)RAYS * SLICES; i++)
        if (i % WIDTH % 7 == 0 && voxels[i] < 90) voxels[i] = 90;
    return voxels;
}

static void every_value_is_the_definitions(void **state) {
    rig *r = *state;
    sv_param_info method;
    double values[MAX_VALUES];
    assert_true(sv_lookup_key(r->plugin, "method", &method));
    const uint32_t count = values_of(r, &method, values);
    const uint8_t *const volumes[] = {patchy_layers(), rig_volume(RIG_SPARSE, WIDTH, HEIGHT, SLICES, 5),
                                      rig_volume(RIG_NOISE, WIDTH, HEIGHT, SLICES, 5)};
    for (size_t n = 0; n < sizeof volumes / sizeof *volumes; n++)
        for (uint32_t i = 0; i < count; i++) hold_all(r, volumes[n], &method, values[i]);
    for (size_t i = 0; i < ROWS; i++)
        if (strcmp(rows[i].key, "method") != 0 && rows[i].moved != (rows[i].tell != NULL))
            fail_msg("%s: %s", rows[i].key,
                     rows[i].tell ? "no value moved the surface" : "a value moved the surface");
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(every_value_is_the_definitions))
