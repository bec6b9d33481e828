/* SPDX-License-Identifier: MIT */
#include "judge/wall_flicker.h"

#include "judge/wall_judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Mean move of the rays' ends, which are those of the truth, or of a result. */
static double move(const wall_case *before, const wall_case *now, const float *end_before,
                   const float *end_now) {
    const size_t rays = (size_t)now->nx * now->ny;
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < rays; i++) {
        if (before->label[i] == 0 || now->label[i] == 0) continue;
        sum += fabs((double)(end_now[i] - end_before[i]));
        count += 1.0;
    }
    return count > 0.0 ? 128.0 / now->nz * sum / count : 0.0;
}

static bool check(const wall_case *frames, uint32_t count, hs_error *err) {
    if (count < 2) return hs_fail(err, HS_ERR_USAGE, "flicker: a sequence of %u frame", count);
    for (uint32_t n = 1; n < count; n++)
        if (frames[n].nx != frames[0].nx || frames[n].ny != frames[0].ny)
            return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u rays, the first frame has %u x %u", frames[n].name,
                           frames[n].nx, frames[n].ny, frames[0].nx, frames[0].ny);
    return true;
}

bool wall_flicker_of(const wall_case *frames, uint32_t count, wall_surface *surface, void *user,
                     wall_flicker *out, hs_error *err) {
    *out = (wall_flicker){0};
    if (!check(frames, count, err)) return false;
    const size_t rays = (size_t)frames[0].nx * frames[0].ny;
    float *const memory = malloc(3 * rays * sizeof *memory);
    float *const depth = memory, *const before = memory + rays, *const now = memory + 2 * rays;
    if (!memory) return hs_fail(err, HS_ERR_MEMORY, "flicker: no memory for %zu rays", rays);
    bool ok = true;
    for (uint32_t n = 0; n < count; n++) {
        const wall_case *c = &frames[n];
        if (!(ok = surface(user, c, depth, err))) break;
        for (size_t i = 0; i < rays; i++) now[i] = wall_ray_end(c, c->full, i, depth[i]);
        if (n > 0) {
            out->result += move(c - 1, c, before, now) / (count - 1);
            out->truth += move(c - 1, c, c[-1].truth, c->truth) / (count - 1);
        }
        memcpy(before, now, rays * sizeof *now);
    }
    free(memory);
    return ok;
}
