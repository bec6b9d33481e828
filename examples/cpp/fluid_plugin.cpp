/* SPDX-License-Identifier: MIT */
/* A plugin in C++17 against the installed headers: the first dark voxel behind the first bright one. */
#include "smartvis/author.h"

#include <cstdint>

namespace {

sv_status surface(sva *a, float *depth) {
    for (std::uint32_t i = 0; i < sva_rays(a); i++) {
        bool tissue = false;
        depth[i] = SVA_NO_DEPTH;
        for (std::uint32_t z = 0; z < a->format.slices; z++) {
            const auto voxel = sva_voxel(a, i % a->format.width, i / a->format.width, z);
            if (!sva_scanned(a, i % a->format.width, i / a->format.width, z, voxel)) continue;
            if (tissue && voxel < 50) {
                depth[i] = static_cast<float>(z);
                break;
            }
            tissue = tissue || voxel >= 50;
        }
    }
    return SV_OK;
}

const sv_descriptor descriptor = SVA_DESCRIPTOR("org.example.fluid", "Fluid", "Example", "1.0.0",
                                                "The first fluid on every ray.", SV_FEATURE_SCANNED);

const sva_method method = {&descriptor, nullptr, 0,       0,       0,       nullptr, nullptr, nullptr,
                           nullptr,     surface, nullptr, nullptr, nullptr, nullptr, nullptr};

} // namespace

SVA_ENTRY(method);
