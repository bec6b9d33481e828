/* SPDX-License-Identifier: MIT */
#include "support/ref_lit.h"

#include <math.h>

#define SURFACE 0.69314718055994531
#define DEGREE  0.017453292519943295

typedef struct {
    const hs_volume *volume;
    const ref_lit_volume *lit;
    const hs_camera *camera;
    const hs_dvr_settings *s;
    const ref_depthmap *map;
    double u, v; /* the pixel in the box, 0 .. 1 */
    double steps, sample, edge,
        unit; /* samples of the box; mm: from sample to sample, the cube's edge, light */
} ray;

/* Smoothed index of a place in the box. */
static void index_at(const ray *r, const double box[3], double out[3]) {
    const double f = r->lit->factor;
    ref_position(r->volume, r->camera, box, out);
    for (int k = 0; k < 3; k++) out[k] = (out[k] - 0.5 * (f - 1.0)) / f + REF_LIT_BORDER;
}

static double intensity_at(const ray *r, double n) {
    const double box[3] = {r->u, r->v, n / r->steps};
    double at[3];
    index_at(r, box, at);
    return ref_linear(r->lit->smooth, r->lit->n, at, NULL);
}

/* The mean of ref_lit_limited(y) while y runs from a to b: by its antiderivative. */
static double whole(double y) {
    return y <= 0.0 ? 0.0 : y >= 1.0 ? y - 0.5 : 0.5 * y * y;
}
static double mean_opacity(double a, double b) {
    return fabs(b - a) < 1e-6 ? ref_lit_limited(0.5 * (a + b)) : (whole(b) - whole(a)) / (b - a);
}

/* Where ghosting of a depth is over, in samples; far before the box where nothing is clipped. */
static double over_at(const ray *r, double depth) {
    if (!(depth > 0.0 && depth < INFINITY)) return -1e30;
    const double behind = ((double)r->s->ghost_width - (double)r->s->ghost_offset) / r->lit->factor;
    return (depth + 0.5) / r->map->slices * r->steps + behind;
}

/* A place by its index and by its place in the picture and along the ray. */
typedef struct {
    double at[3], u, v, n;
} spot;

static spot moved(const ray *r, spot from, const double direction[3], double mm) {
    spot to = from;
    for (int k = 0; k < 3; k++) {
        const double *row = r->camera->rotation + (size_t)k * 3;
        for (int a = 0; a < 3; a++)
            to.at[k] += row[a] * direction[a] * mm / (r->lit->factor * r->volume->spacing[k]);
    }
    to.u += direction[0] * mm / r->camera->extent;
    to.v += direction[1] * mm / r->camera->extent;
    to.n += direction[2] * mm / r->sample;
    return to;
}

static double mean_opacity_at(const ray *r, const spot *p) {
    const double b = r->lit->block;
    double at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = (p->at[k] - 0.5 * (b - 1.0)) / b;
        if (at[k] < -0.5 || at[k] > r->lit->cells[k] - 0.5) return 0.0;
    }
    return ref_linear(r->lit->opacity, r->lit->cells, at, NULL) / 255.0;
}

/* Mean opacity at a place; 0 in what the map's nearest pixel removes. */
static double opacity_at(const ray *r, spot p) {
    if (r->map->depth) {
        const double x = fmin(fmax(p.u * r->map->width, 0.0), r->map->width - 1.0);
        const double y = fmin(fmax(p.v * r->map->height, 0.0), r->map->height - 1.0);
        const float depth = r->map->depth[(uint32_t)y * r->map->width + (uint32_t)x];
        if (p.n < over_at(r, (double)depth)) return 0.0;
    }
    return mean_opacity_at(r, &p);
}

static void normalise(double v[3]) {
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) v[k] /= length;
}

/* The cubic B-spline's weight of voxel i at p, or its slope. */
static double spline(double p, double i, bool slope) {
    const double d = p - i, a = fabs(d), sign = d > 0.0 ? 1.0 : -1.0;
    if (a >= 2.0) return 0.0;
    if (slope) return sign * (a <= 1.0 ? a * (1.5 * a - 2.0) : -0.5 * (2.0 - a) * (2.0 - a));
    return a <= 1.0 ? 2.0 / 3.0 - a * a + 0.5 * a * a * a : (2.0 - a) * (2.0 - a) * (2.0 - a) / 6.0;
}

/* The direction in which the values at `place` fall fastest, never away from the viewer. */
static void slope_at(const ray *r, const uint8_t *values, const uint32_t n[3], const double place[3],
                     double normal[3]) {
    const ref_lit_volume *lit = r->lit;
    double g[3] = {0}, at[3], first[3];
    double finest = r->volume->spacing[0];
    for (int k = 0; k < 3; k++) {
        at[k] = fmin(fmax(place[k], 1.0), n[k] - 2.0);
        first[k] = fmin(floor(at[k]), n[k] - 3.0) - 1.0;
        finest = fmin(finest, r->volume->spacing[k]);
    }
    for (int i = 0; i < 64; i++) {
        const double voxel[3] = {first[0] + i % 4, first[1] + i / 4 % 4, first[2] + i / 16};
        const double value =
            values[ref_lit_index(n, (uint32_t)voxel[0], (uint32_t)voxel[1], (uint32_t)voxel[2])];
        for (int k = 0; k < 3; k++) {
            double weight = value;
            for (int j = 0; j < 3; j++) weight *= spline(at[j], voxel[j], j == k);
            g[k] += weight;
        }
    }
    for (int a = 0; a < 3; a++) {
        normal[a] = 0.0;
        for (int k = 0; k < 3; k++)
            normal[a] -= r->camera->rotation[k * 3 + a] * g[k] / (lit->factor * r->volume->spacing[k]);
    }
    normal[2] = -fabs(normal[2]) - 0.5 / (lit->factor * finest);
    normalise(normal);
}

/* The tissue's own, or that of the scan's face; returns how much it is the latter. */
static double normal_at(const ray *r, const spot *p, double normal[3]) {
    const ref_lit_volume *lit = r->lit;
    const double side = lit->side;
    double at[3], wide[3];
    for (int k = 0; k < 3; k++)
        at[k] = (p->at[k] - REF_LIT_BORDER - 0.5 * (side - 1.0)) / side + REF_LIT_BORDER;
    const double face =
        ref_lit_limited((0.8 - ref_linear(lit->scanned, lit->shares, at, NULL) / 255.0) / 0.15);
    slope_at(r, lit->smooth, lit->n, p->at, normal);
    slope_at(r, lit->scanned, lit->shares, at, wide);
    for (int k = 0; k < 3; k++) normal[k] += face * (wide[k] - normal[k]);
    normalise(normal);
    return face;
}

static void map_normal(const ray *r, double normal[3]) {
    const double du = 2.0 / r->map->width, dv = 2.0 / r->map->height;
    const double right = ref_map_value(r->map, r->map->depth, r->u + du, r->v);
    const double left = ref_map_value(r->map, r->map->depth, r->u - du, r->v);
    const double below = ref_map_value(r->map, r->map->depth, r->u, r->v + dv);
    const double above = ref_map_value(r->map, r->map->depth, r->u, r->v - dv);
    const double slice = r->camera->depth_extent / r->map->slices;
    normal[0] = normal[1] = 0.0;
    normal[2] = -1.0;
    const double all[4] = {left, right, above, below};
    for (int i = 0; i < 4; i++)
        if (!(all[i] > 0.0 && all[i] < INFINITY)) return;
    normal[0] = (right - left) * slice / (2.0 * du * r->camera->extent);
    normal[1] = (below - above) * slice / (2.0 * dv * r->camera->extent);
    normalise(normal);
}

static void lamp_of(const hs_dvr_settings *s, double lamp[3], double between[3]) {
    const double azimuth = (double)s->light[0] * DEGREE, elevation = (double)s->light[1] * DEGREE;
    lamp[0] = sin(azimuth) * cos(elevation);
    lamp[1] = -sin(elevation);
    lamp[2] = -cos(azimuth) * cos(elevation);
    for (int k = 0; k < 3; k++) between[k] = lamp[k] - (k == 2 ? 1.0 : 0.0);
    normalise(between);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static spot spot_at(const ray *r, double n) {
    const double box[3] = {r->u, r->v, n / r->steps};
    spot p = {.u = r->u, .v = r->v, .n = n};
    index_at(r, box, p.at);
    return p;
}

/* Shading with cut weight c at sample n; 0 .. 1 a channel. */
static void shade(const ray *r, double n, double c, double rgb[3]) {
    const spot p = spot_at(r, n);
    const double t = ref_lit_limited(n / r->steps), fade[3] = {0.30, 0.55, 0.62};
    double normal[3], lamp[3], between[3], tone[3];
    const double face = normal_at(r, &p, normal), pale = fmax(c, face);
    lamp_of(r->s, lamp, between);
    for (int k = 0; k < 3; k++) tone[k] = (double)r->s->skin[k] * (1.0 - fade[k] * t);
    if (c > 0.0) {
        double flat[3];
        map_normal(r, flat);
        for (int k = 0; k < 3; k++) normal[k] += c * (flat[k] - normal[k]);
        normalise(normal);
    }
    const spot in = moved(r, p, normal, -3.0 * face * r->sample);
    const double echo = ref_linear(r->lit->smooth, r->lit->n, in.at, NULL) / 255.0;
    const double grey = 0.3 * tone[0] + 0.59 * tone[1] + 0.11 * tone[2];
    for (int k = 0; k < 3; k++) {
        tone[k] += 0.7 * pale * (grey * (k == 2 ? 1.04 : 1.0) - tone[k]);
        tone[k] *= 1.0 + pale * (0.55 + 0.6 * echo - 1.0);
    }
    const double reach[3] = {4, 7, 11}, weight[3] = {0.4, 0.25, 0.15};
    double ambient = 1.0, blocked = 0.0;
    for (int i = 0; i < 3; i++) ambient -= weight[i] * opacity_at(r, moved(r, p, normal, reach[i] * r->unit));
    const spot start = moved(r, p, normal, 4.0 * r->unit);
    for (int i = 1; i <= 6; i++) blocked += opacity_at(r, moved(r, start, lamp, 3.0 * i * r->unit));
    const double shadow = 1.0 / (1.0 + blocked * blocked);
    const double light = ambient * (0.24 - 0.24 * normal[2]) + 0.58 * shadow * fmax(dot(normal, lamp), 0.0);
    const double shine = 0.14 * shadow * pow(fmax(dot(normal, between), 0.0), 24.0) * (1.0 - pale);
    for (int k = 0; k < 3; k++) rgb[k] = tone[k] * light + shine;
}

/* Where the intensity first reaches half of its maximum around a surface. */
static double edge_of(const ray *r, double surface, double over) {
    double value[6], where[6], maximum = intensity_at(r, surface + 5.0);
    for (int i = 0; i < 6; i++) {
        where[i] = fmax(fmax(surface + i - 2.0, over), 0.0);
        value[i] = intensity_at(r, where[i]);
        maximum = fmax(maximum, value[i]);
    }
    const double level = fmin(0.5 * maximum, (double)r->s->threshold_high * 255.0);
    if (value[0] >= level) return where[0];
    for (int i = 0; i < 5; i++)
        if (value[i + 1] >= level)
            return where[i] + (level - value[i]) / (value[i + 1] - value[i]) * (where[i + 1] - where[i]);
    return where[0];
}

/* What a ray met. */
typedef struct {
    double depth, surface, thickest, at, cut, veil, veil_thickest, veil_at;
    bool found;
} met;

static void take_step(const ray *r, met *m, double a, double over, double y0, double y1, double thickness) {
    const double part = ref_lit_limited(over - a), y = y0 + part * (y1 - y0);
    const double depth = thickness * (1.0 - part) * mean_opacity(y, y1);
    if (!m->found && m->depth + depth >= SURFACE) {
        double low = 0.0, high = 1.0;
        for (int i = 0; i < 6; i++) {
            const double middle = 0.5 * (low + high);
            if (thickness * (1.0 - part) * middle * mean_opacity(y, y + middle * (y1 - y)) >=
                SURFACE - m->depth)
                high = middle;
            else
                low = middle;
        }
        m->surface = a + part + (1.0 - part) * 0.5 * (low + high);
        m->found = true;
    }
    if (depth > m->thickest) {
        m->thickest = depth;
        m->at = a + part + 0.5 * (1.0 - part);
    }
    m->depth += depth;
    if (over >= a && over < a + 1.0) m->cut = ref_lit_limited(y);
    if (!r->map->depth || !((double)r->s->ghost_width > 0.0)) return;
    const double growth =
        r->map->confidence ? 1.0 - ref_map_value(r->map, r->map->confidence, r->u, r->v) : 0.0;
    const double width =
        (double)r->s->ghost_width * (1.0 + (double)r->s->ghost_doubt * growth) / r->lit->factor;
    const double factor = ref_lit_limited((a + 0.5 * part - (over - width)) / width);
    const double veil = thickness * part * factor * mean_opacity(y0, y);
    if (veil > m->veil_thickest) {
        m->veil_thickest = veil;
        m->veil_at = a + 0.5;
    }
    m->veil += veil;
}

static met walk(const ray *r, double over) {
    const double thickness = 1.5 * r->sample * 256.0 / r->edge;
    met m = {0};
    double before = ref_lit_ramp(r->s, intensity_at(r, 0.0));
    for (double n = 1.0; n < ceil(r->steps) + 1.0 && !m.found; n += 1.0) {
        const double now = ref_lit_ramp(r->s, intensity_at(r, n));
        take_step(r, &m, n - 1.0, over, before, now, thickness);
        before = now;
    }
    return m;
}

static double cut_weight(const ray *r, const met *m, double over, double edge) {
    if (!r->map->depth || over <= 0.0) return 0.0;
    const spot p = spot_at(r, over);
    const double around = (mean_opacity_at(r, &p) - 0.25) / 0.25;
    return ref_lit_limited(1.0 - (edge - over) / 6.0) * ref_lit_limited(fmax(m->cut, around));
}

void ref_lit_pixel(const hs_volume *volume, const ref_lit_volume *lit, const hs_camera *camera,
                   const hs_dvr_settings *s, const ref_depthmap *map, uint32_t x, uint32_t y, double rgb[3]) {
    ray r = {volume, lit, camera, s, map, (x + 0.5) / s->width, (y + 0.5) / s->height, 0, 0, 0, 0};
    const double finest = fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
    const double slices = fmax(1.0, round(camera->depth_extent / finest));
    r.steps = slices / (lit->factor * (double)s->step);
    r.sample = camera->depth_extent / r.steps;
    r.edge = cbrt(volume->nx * volume->spacing[0] * volume->ny * volume->spacing[1] * volume->nz *
                  volume->spacing[2]);
    r.unit = r.edge / 64.0;
    const double over = map->depth ? over_at(&r, ref_map_value(map, map->depth, r.u, r.v)) : -1e30;
    const met m = walk(&r, over);
    rgb[0] = rgb[1] = rgb[2] = 0.0;
    if (m.depth > 0.0) {
        const double edge = edge_of(&r, m.found ? m.surface : m.at, over);
        double lit_rgb[3];
        shade(&r, edge, cut_weight(&r, &m, over, edge), lit_rgb);
        for (int k = 0; k < 3; k++) rgb[k] = ref_lit_limited(m.depth / SURFACE) * lit_rgb[k];
    }
    if (m.veil > 0.0) {
        const double share = 0.35 * (1.0 - exp(-m.veil)), cool[3] = {0.62, 0.78, 1.0};
        const spot p = spot_at(&r, m.veil_at);
        double normal[3], lamp[3], between[3];
        (void)normal_at(&r, &p, normal);
        lamp_of(s, lamp, between);
        const double light = 0.35 + 0.35 * fmax(dot(normal, lamp), 0.0);
        for (int k = 0; k < 3; k++) rgb[k] += share * (cool[k] * light - rgb[k]);
    }
    for (int k = 0; k < 3; k++) rgb[k] = fmin(255.0 * (double)s->exposure * rgb[k], 255.0);
}
