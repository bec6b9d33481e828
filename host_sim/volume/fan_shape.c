/* SPDX-License-Identifier: MIT */
#include "volume/fan_shape.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * The border of the scan is met along the three axes of the volume: the first and the last scanned voxel of
 * every column, unless it lies at the volume's own face, where the file ends and not the scan. Holes inside
 * are never met. Each point of the border should lie on one of the six surfaces of a fan: its two outer
 * lines, its two outer planes, the probe's face, the end of depth. Gauss-Newton brings the fan there, each
 * point drawn to the surface that is nearest, and counted less the farther it lies from it (Geman-McClure),
 * so that what is cut off obliquely does not bend the fan.
 */

enum { FEW = 300, LAST_TRIAL = 5 * FEW }; /* points of a first trial, and of the last */

static const double most_scale = 0.9;              /* of a logarithm, from where a trial begins */
static const double resting = 0.89;                /* a scale that went farther was held up on its way */
static const double first_radii[] = {30.0, 120.0}; /* mm, of lines and sweep at the face: trials begin here */
static const double enough = 0.75;                 /* of the border lies on a fan */
static const double near_by = 4.0;                 /* times as far as close */
static const double most_turn = 0.82;              /* cosine of 35 degrees, from the volume's axis */
static const double parallel_from = 1000.0;        /* mm: a longer radius tells nothing of a place */

/* ---- the border */
static bool is_scanned(const hs_volume *v, const uint32_t at[3]) {
    return v->voxels[((size_t)at[2] * v->ny + at[1]) * v->nx + at[0]] != 0;
}

static void keep(const hs_volume *v, const uint32_t at[3], int axis, double beside, border *b,
                 double (*points)[3]) {
    double *p = points[b->count++];
    for (int k = 0; k < 3; k++) p[k] = (at[k] + 0.5 + (k == axis ? beside : 0.0)) * v->spacing[k];
}

/* The ends of the scan in one column, unless they are the volume's. */
static void add_column(const hs_volume *v, uint32_t at[3], int axis, border *b, double (*points)[3]) {
    const uint32_t n[3] = {v->nx, v->ny, v->nz};
    uint32_t low = 0, high = n[axis];
    for (at[axis] = 0; low < high && !is_scanned(v, at); at[axis] = low) low++;
    if (low == high) return;
    at[axis] = low;
    if (low > 0) keep(v, at, axis, -0.5, b, points);
    for (at[axis] = high - 1; !is_scanned(v, at); at[axis] = high - 1) high--;
    if (high < n[axis]) keep(v, at, axis, 0.5, b, points);
}

void hs_border_find(const hs_volume *v, border *b, double (*points)[3]) {
    const uint32_t n[3] = {v->nx, v->ny, v->nz};
    b->points = (const double(*)[3])points;
    b->close = 1.0;
    for (int k = 0; k < 3; k++) {
        b->size[k] = n[k] * v->spacing[k];
        b->close = fmax(b->close, v->spacing[k]);
    }
    for (int axis = 0; axis < 3; axis++) {
        const int s = (axis + 1) % 3, t = (axis + 2) % 3;
        for (uint32_t i = 0; i < HS_BORDER_COLUMNS; i++)
            for (uint32_t j = 0; j < HS_BORDER_COLUMNS; j++) {
                uint32_t at[3] = {0, 0, 0};
                at[s] = (uint32_t)((i + 0.5) / HS_BORDER_COLUMNS * n[s]);
                at[t] = (uint32_t)((j + 0.5) / HS_BORDER_COLUMNS * n[t]);
                add_column(v, at, axis, b, points);
            }
    }
}

/* ---- a fan, and how far points lie from it */
/* The place along the fan's axes. */
static void local_place(const fan *f, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++) {
        out[k] = 0.0;
        for (int m = 0; m < 3; m++)
            out[k] += f->rotation[m * 3 + k] * (p[m] * f->factor[m] - f->x[PLACE + m]);
    }
}

/* hypot without its care for overflow, which takes its time: squares of mm are small. */
static double length_of(double x, double y) {
    return sqrt(x * x + y * y);
}

/* What a point has met: its place along the fan's axes, and the nearest surface: 0, 1 lines, 2, 3 planes, 4,
 * 5 radii. */
typedef struct {
    double place[3], beyond; /* mm; inside: below 0 */
    int surface;
} meeting;
_Static_assert(sizeof(meeting) * LAST_TRIAL <= sizeof(double) * HS_BORDER_MOST, "they lie in the room");

/* Of a place along the fan's axes: how far it lies before the sweep's axis, how far from that, and how far
 * before and from the apex. */
typedef struct {
    double w, h, c, r;
} distances;

static distances distances_of(const fan *f, const double l[3]) {
    distances d = {.w = l[2] - f->x[SWEEP]};
    d.h = length_of(l[1], d.w) + 1e-9;
    d.c = d.h + f->x[SWEEP];
    d.r = length_of(l[0], d.c) + 1e-9;
    return d;
}

typedef struct {
    double cosine, sine;
} direction;

/* Of the lines and planes that end a fan, as surfaces are numbered. */
static void limits_of(const fan *f, direction limits[4]) {
    const double angles[4] = {f->x[LOW_LINE], f->x[HIGH_LINE], -f->x[PLANE], f->x[PLANE]};
    for (int k = 0; k < 4; k++) limits[k] = (direction){cos(angles[k]), sin(angles[k])};
}

/* How far the point lies from the nearer of two rays from 0: the arc to it is no shorter. */
static double from_rays(double x, double y, double radius, const direction limits[2]) {
    double least = radius;
    for (int k = 0; k < 2; k++) {
        const double beside = fabs(x * limits[k].cosine - y * limits[k].sine);
        if (beside < least && y * limits[k].cosine + x * limits[k].sine > 0.0) least = beside;
    }
    return least;
}

/* Two surfaces, of which the nearer one counts if it is nearer than what was met before; of two as near, the
 * first. */
static void meet(meeting *m, int first, double below, double above) {
    const double d[2] = {below, above};
    for (int k = 0; k < 2; k++) {
        const double now = fabs(d[k]), before = fabs(m->beyond);
        if (!(now < before || (now == before && first + k < m->surface))) continue;
        m->beyond = d[k];
        m->surface = first + k;
    }
}

/* How far the point lies beyond the nearest surface of the fan. An angle is found where the arc to its limits
 * may be the shortest way, for that takes most of the time. */
static meeting meet_fan(const fan *f, const direction limits[4], const double p[3]) {
    static const double rounding = 1e-9; /* mm, and of a length */
    meeting m = {.beyond = DBL_MAX, .surface = 6};
    local_place(f, p, m.place);
    const double *l = m.place;
    const distances d = distances_of(f, l);
    meet(&m, 4, f->x[FACE] - d.r, d.r - f->x[END]);
    const double least[2] = {from_rays(l[0], d.c, d.r, limits), from_rays(l[1], d.w, d.h, limits + 2)};
    for (int n = 0; n < 2; n++) {
        const bool planes = (least[1] < least[0]) != (n == 1); /* the ones that may be nearer come first */
        if (least[planes] > fabs(m.beyond) * (1.0 + rounding) + rounding) continue;
        if (planes) {
            const double plane = atan2(l[1], d.w);
            meet(&m, 2, (-f->x[PLANE] - plane) * d.h, (plane - f->x[PLANE]) * d.h);
        } else {
            const double line = atan2(l[0], d.c);
            meet(&m, 0, (f->x[LOW_LINE] - line) * d.r, (line - f->x[HIGH_LINE]) * d.r);
        }
    }
    return m;
}

/* What `beyond` changes by for each unknown, at a point p. */
static void slope_of(const fan *f, const double p[3], const meeting *met, double slope[UNKNOWNS]) {
    const int surface = met->surface;
    const double *l = met->place, sign = surface % 2 ? 1.0 : -1.0;
    const distances d = distances_of(f, l);
    const double w = d.w, h = d.h, c = d.c, r = d.r;
    double g[3] = {0, l[1] / h, w / h}, by_sweep = 1.0 - w / h; /* of c, along the fan's axes */
    if (surface < 2 || surface > 3) {
        const double of_x = surface < 2 ? c / r : l[0] / r, of_c = surface < 2 ? -l[0] / r : c / r;
        g[0] = of_x;
        g[1] *= of_c;
        g[2] *= of_c;
        by_sweep *= of_c;
    } else {
        g[1] = w / h;
        g[2] = -l[1] / h;
        by_sweep = l[1] / h;
    }
    memset(slope, 0, UNKNOWNS * sizeof *slope);
    for (int k = 0; k < 3; k++) {
        for (int m = 0; m < 3; m++) slope[PLACE + k] -= sign * f->rotation[k * 3 + m] * g[m];
        const int a = (k + 1) % 3, e = (k + 2) % 3;
        slope[TURN + k] = -sign * (l[a] * g[e] - l[e] * g[a]);
    }
    slope[SWEEP] = sign * by_sweep;
    for (int k = 0; f->scaled && k < SCALES; k++) slope[SCALE + k] = -slope[PLACE + k] * p[k] * f->factor[k];
    slope[surface < 2   ? LOW_LINE + surface
          : surface < 4 ? PLANE
          : surface < 5 ? FACE
                        : END] = surface < 2   ? -sign * r
                                 : surface < 4 ? -h
                                               : -sign;
}

/* What each point meets, and the cost: infinite if it is known to be more than `most`. */
static double meet_all(const fan *f, const border *b, uint32_t every, double scale, double most,
                       meeting *met) {
    direction limits[4];
    limits_of(f, limits);
    const uint32_t n = (b->count - 1) / every + 1;
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        met[i] = meet_fan(f, limits, b->points[(size_t)i * every]);
        const double e = met[i].beyond;
        sum += e * e / (e * e + scale * scale);
        if (sum > most * n) return DBL_MAX;
    }
    return sum / n;
}

/* Solves a symmetric positive system, of which the upper half is given, in place: b becomes the solution. */
static void solve(double a[UNKNOWNS][UNKNOWNS], double b[UNKNOWNS]) {
    for (int k = 0; k < UNKNOWNS; k++)
        for (int i = k + 1; i < UNKNOWNS; i++) {
            const double factor = a[k][i] / a[k][k];
            for (int j = i; j < UNKNOWNS; j++) a[i][j] -= factor * a[k][j];
            b[i] -= factor * b[k];
        }
    for (int k = UNKNOWNS - 1; k >= 0; k--) {
        for (int j = k + 1; j < UNKNOWNS; j++) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
}

/* Turns the fan about its own axes by a rotation vector (Rodrigues). */
static void turn_by(double rotation[9], const double v[3]) {
    const double angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (angle < 1e-12) return;
    const double x = v[0] / angle, y = v[1] / angle, z = v[2] / angle, s = sin(angle), c = 1.0 - cos(angle);
    const double turn[9] = {1 - c * (y * y + z * z), c * x * y - s * z,       c * x * z + s * y,
                            c * x * y + s * z,       1 - c * (x * x + z * z), c * y * z - s * x,
                            c * x * z - s * y,       c * y * z + s * x,       1 - c * (x * x + y * y)};
    double out[9] = {0};
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) out[i] += rotation[i / 3 * 3 + k] * turn[k * 3 + i % 3];
    memcpy(rotation, out, sizeof out);
}

static void move_by(fan *f, const double step[UNKNOWNS]) {
    for (int k = 0; k < UNKNOWNS; k++)
        if (k < TURN || k > TURN + 2) f->x[k] += step[k];
    turn_by(f->rotation, step + TURN);
    for (int k = 0; f->scaled && k < SCALES; k++) {
        double *scale = &f->x[SCALE + k];
        *scale = fmin(fmax(*scale, -most_scale), most_scale); /* a flat scan lies on any fan */
        f->factor[k] = exp(*scale);
    }
}

/* Of the weighted least squares that a step solves. The lower half is not read: whole rows are quicker. */
typedef struct {
    double normal[UNKNOWNS][UNKNOWNS], right[UNKNOWNS];
} equations;

static equations equations_of(const fan *f, const border *b, uint32_t every, double scale,
                              const meeting *met) {
    equations q = {0};
    for (uint32_t i = 0, at = 0; at < b->count; i++, at += every) {
        double slope[UNKNOWNS];
        slope_of(f, b->points[at], &met[i], slope);
        const double e = met[i].beyond, root = scale * scale / (e * e + scale * scale), weight = root * root;
        for (int k = 0; k < UNKNOWNS; k++) {
            if (slope[k] == 0.0) continue; /* each surface has a few unknowns only */
            const double weighted = weight * slope[k];
            q.right[k] -= weighted * e;
            for (int m = 0; m < UNKNOWNS; m++) q.normal[k][m] += weighted * slope[m];
        }
    }
    return q;
}

/* Up to `rounds` of Levenberg's steps; `scale` mm: what lies farther away counts little. */
static void improve(fan *f, const border *b, uint32_t every, int rounds, double scale, meeting *met) {
    double damping = 1e-3;
    f->cost = meet_all(f, b, every, scale, DBL_MAX, met);
    for (int round = 0; round < rounds; round++) {
        const equations q = equations_of(f, b, every, scale, met);
        bool better = false;
        for (int trial = 0; trial < 5 && !better; trial++) {
            equations solved = q;
            for (int k = 0; k < UNKNOWNS; k++) solved.normal[k][k] += damping * solved.normal[k][k] + 1e-9;
            solve(solved.normal, solved.right);
            fan next = *f;
            move_by(&next, solved.right);
            next.cost = meet_all(&next, b, every, scale, f->cost, met);
            better = next.cost < f->cost; /* never with a NaN */
            damping = better ? fmax(damping * 0.3, 1e-6) : damping * 5.0;
            if (better) *f = next;
        }
        if (!better) return;
    }
}

/* The value that this share of them is below; changes their order (Hoare's selection). */
static double quantile(double *values, uint32_t count, double share) {
    const uint32_t wanted = (uint32_t)(share * (count - 1));
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        const double pivot = values[low + (high - low) / 2];
        uint32_t i = low, j = high;
        for (;; i++, j--) {
            while (values[i] < pivot) i++;
            while (pivot < values[j]) j--;
            if (i >= j) break;
            const double other = values[i];
            values[i] = values[j];
            values[j] = other;
        }
        if (wanted <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[wanted];
}

/* ---- trials */
/* A fan from this face, of these radii at its middle, whose limits hold most of the points. */
static void begin(fan *f, const border *b, uint32_t every, bool scaled, const double axes[9], double lines,
                  double planes) {
    double across[2][FEW * 2], depth[FEW * 2], l[3];
    uint32_t n = 0;
    *f = (fan){.scaled = scaled, .factor = {1.0, 1.0, 1.0}};
    memcpy(f->rotation, axes, sizeof f->rotation);
    for (int k = 0; k < 3; k++) f->x[PLACE + k] = 0.5 * b->size[k];
    for (uint32_t i = 0; i < b->count; i += every) {
        local_place(f, b->points[i], l);
        depth[n++] = l[2];
    }
    const double top = quantile(depth, n, 0.01), bottom = quantile(depth, n, 0.99);
    for (int k = 0; k < 3; k++) f->x[PLACE + k] += axes[k * 3 + 2] * (top - lines);
    f->x[SWEEP] = lines - planes;
    for (uint32_t i = 0, at = 0; i < b->count; i += every, at++) {
        local_place(f, b->points[i], l);
        const double w = l[2] - f->x[SWEEP];
        across[0][at] = atan2(l[0], length_of(l[1], w) + f->x[SWEEP]);
        across[1][at] = atan2(l[1], w);
    }
    f->x[LOW_LINE] = quantile(across[0], n, 0.08);
    f->x[HIGH_LINE] = quantile(across[0], n, 0.92);
    f->x[PLANE] = 0.5 * (quantile(across[1], n, 0.92) - quantile(across[1], n, 0.08));
    f->x[FACE] = lines;
    f->x[END] = lines + bottom - top;
}

/* How well it fits, over all points. */
static void measure(fan *f, const border *b, double *room) {
    uint32_t close = 0, near = 0;
    direction limits[4];
    limits_of(f, limits);
    memset(f->on, 0, sizeof f->on);
    for (uint32_t i = 0; i < b->count; i++) {
        const meeting met = meet_fan(f, limits, b->points[i]);
        room[i] = fabs(met.beyond);
        near += room[i] <= near_by * b->close;
        if (!(room[i] <= b->close)) continue;
        close++;
        f->on[met.surface]++;
    }
    f->share = (double)close / b->count;
    f->follows = near ? (double)close / near : 0.0;
    f->median = quantile(room, b->count, 0.5);
}

fan hs_fan_from(const double axes[9], const border *b, double *room, bool turned, bool scaled,
                double hopeless) {
    static const double turns[4][3] = {{0.49, 0, 0}, {-0.49, 0, 0}, {0, 0.49, 0}, {0, -0.49, 0}};
    const uint32_t every = 1 + (b->count - 1) / FEW;
    meeting *met = (void *)room;
    fan best = {.cost = 2.0};
    for (int n = 0; n < 4; n++) {
        double begun[9];
        fan f;
        memcpy(begun, axes, sizeof begun);
        if (turned) turn_by(begun, turns[n]);
        begin(&f, b, every, scaled, begun, turned ? 60.0 : first_radii[n / 2],
              turned ? 60.0 : first_radii[n % 2]);
        improve(&f, b, every, 8, 5.0, met);
        if (f.cost < hopeless) improve(&f, b, every, 6, 2.0, met);
        if (f.cost < best.cost) best = f;
    }
    if (best.cost > 1.0) return best;
    if (best.cost < hopeless) improve(&best, b, 1 + (b->count - 1) / LAST_TRIAL, 60, 1.0, met);
    measure(&best, b, room);
    return best;
}

bool hs_fan_scale_rests(const fan *f) {
    bool rest = true;
    for (int k = 0; k < SCALES; k++) rest = rest && !(fabs(f->x[SCALE + k]) > resting);
    return rest;
}

bool hs_fan_holds(const fan *f, const border *b, const double axes[9]) {
    double along = 0.0;
    for (int k = 0; k < 3; k++) along += f->rotation[k * 3 + 2] * axes[k * 3 + 2];
    const double widest = fmax(fabs(f->x[LOW_LINE]), fabs(f->x[HIGH_LINE]));
    const bool possible = f->x[FACE] > 0.0 && f->x[FACE] < parallel_from && widest < 1.4 &&
                          f->x[LOW_LINE] < f->x[HIGH_LINE] && f->x[PLANE] > 0.0 && f->x[PLANE] < 1.4 &&
                          f->x[FACE] * cos(widest) > f->x[SWEEP] && f->x[SWEEP] > -parallel_from;
    const uint32_t lines = f->on[0] + f->on[1], planes = f->on[2] + f->on[3], radii = f->on[4] + f->on[5];
    const bool seen = (lines > b->count / 50 && planes > b->count / 50) || radii > b->count / 10;
    return possible && seen && along > most_turn && f->share >= enough && f->median < 0.5 * b->close;
}
