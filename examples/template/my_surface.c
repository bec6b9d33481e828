/* SPDX-License-Identifier: MIT */
/* A plugin to begin with. On every ray it takes the longest run of dark voxels for the fluid, and puts the
 * surface into it. Replace `surface` and the parameters; give the descriptor an id of your own. */
#include "smartvis/author.h"

enum { Q = 1, LEVEL }; /* the parameters' ids; they stay when others are added */

/* Fills `depth`, one value a ray, in slices from the front: the renderer begins its rays there. */
static sv_status surface(sva *a, float *depth) {
    const float q = (float)sva_value(a, Q);
    const float level = (float)(255.0 * sva_value(a, LEVEL));
    for (uint32_t i = 0; i < sva_rays(a); i++) {
        const uint32_t x = i % a->format.width, y = i / a->format.width;
        uint32_t run = 0, longest = 0, end = 0;
        int tissue = 0; /* what is dark before the first tissue is no fluid that the fetus lies in */
        for (uint32_t z = 0; z < a->format.slices; z++) {
            const uint8_t voxel = sva_voxel(a, x, y, z);
            if (!sva_scanned(a, x, y, z, voxel)) continue;
            const int dark = (float)voxel < level;
            if (dark && tissue) {
                run++;
                continue;
            }
            /* Only a run that ends at tissue lies before something. */
            if (run > longest) {
                longest = run;
                end = z;
            }
            run = 0;
            tissue = tissue || !dark;
        }
        depth[i] = longest > 0 ? (float)end - 0.5f - q * (float)longest : SVA_NO_DEPTH;
    }
    return SV_OK;
}

static const sva_param params[] = {SVA_PARAM(Q, SV_PARAM_FLOAT, SV_PARAM_PRIMARY, "q", "Surface position", "",
                                             "0: at the fetus; 1: at the tissue before it.", 0.0, 1.0, 0.25,
                                             0.01),
                                   SVA_PARAM(LEVEL, SV_PARAM_FLOAT, 0, "level", "Fluid level", "",
                                             "Darker voxels are fluid.", 0.0, 1.0, 0.2, 0.01)};

static const sv_descriptor descriptor =
    SVA_DESCRIPTOR("org.example." PLUGIN_NAME, PLUGIN_NAME, "Example", PLUGIN_VERSION,
                   "The longest dark run on every ray.", SV_FEATURE_SCANNED | SV_FEATURE_PADDING);

static const sva_method method = {
    .descriptor = &descriptor, .params = params, .param_count = 2, .finish = surface};
SVA_ENTRY(method);
