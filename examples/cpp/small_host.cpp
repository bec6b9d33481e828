/* SPDX-License-Identifier: MIT */
/* The host of examples/small_host in C++17. Destructors give back what it takes, also where a call fails.
 * Usage: small_host PLUGIN.so */
#include "smartvis/host.hpp"

#include <cstdint>
#include <cstdio>

namespace {

constexpr std::uint32_t side = 64, slices = 64, slab_slices = 16, rays = side * side;

/* A skin, a wavy gap of fluid and a fetus; a slab is its slices one after the other. */
std::vector<std::uint8_t> make_volume() {
    std::vector<std::uint8_t> volume(slices * rays);
    for (std::uint32_t i = 0; i < rays; i++) {
        const std::uint32_t x = i % side, near = 8 + x / 16, far = near + 20 + (x / 8 + i / side / 8) % 4;
        for (std::uint32_t z = 0; z < slices; z++)
            volume[z * rays + i] = z < near  ? std::uint8_t{100}
                                   : z < far ? std::uint8_t{10}
                                             : std::uint8_t{200};
    }
    return volume;
}

sv_format make_format(bool ranges) {
    auto format = smartvis::sized<sv_format>();
    format.width = format.height = side;
    format.slices = slices;
    format.max_slab_slices = slab_slices;
    format.voxel_type = SV_VOXEL_U8;
    format.carrier = SV_CARRIER_HOST;
    format.padding_value = SV_NO_PADDING;
    format.tiles_x = 1;
    format.tile_w = format.tile_h = format.row_pitch = side;
    for (float &mm : format.spacing_mm) mm = 1.0f;
    if (ranges) format.flags = SV_FORMAT_SCANNED;
    return format;
}

/* One volume, front to back, with every parameter at its default. Returns the outcome. */
sv_status run(const smartvis::instance &plugin, std::vector<float> &depths) {
    const auto volume = make_volume();
    const std::vector<sv_scanned> scanned(rays, {0, slices - 4});
    const bool ranges = (plugin->descriptor->features & SV_FEATURE_SCANNED) != 0;
    smartvis::activation active(plugin, make_format(ranges));
    auto frame = smartvis::sized<sv_frame>();
    frame.index = 1;
    frame.scanned = ranges ? scanned.data() : nullptr;
    active.begin(frame);
    for (std::uint32_t z = 0; z < slices; z += slab_slices) {
        auto slab = smartvis::sized<sv_slab>();
        slab.first_slice = z;
        slab.slice_count = slab_slices;
        slab.memory = &volume[z * rays];
        slab.bytes = slab_slices * rays;
        active.slab(slab);
    }
    auto result = smartvis::sized<sv_result>();
    result.depth = depths.data();
    return active.end(result);
}

void print_log(std::int32_t severity, const char *text) {
    if (severity >= SV_LOG_WARNING) std::fprintf(stderr, "plugin: %s\n", text);
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 2) return std::fputs("usage: small_host FOLDER/PLUGIN.so\n", stderr), 2;
    try {
        const smartvis::library library(argv[1]);
        const smartvis::instance plugin(library, "small_host", print_log);
        std::vector<float> depths(rays);
        sv_status status = SV_OK;
        try {
            status = run(plugin, depths);
        } catch (const smartvis::error &e) {
            std::printf("%s\n", e.what());
            status = e.status();
        }
        const bool clip = smartvis::clips(status); /* else unclipped, never with an old map */
        std::printf("%s: status %d, rendered %s\n", library.descriptor().id, static_cast<int>(status),
                    clip ? "with the map" : "unclipped");
        for (std::uint32_t i = 0; i < rays; i++)
            if (i % 8 == 4 && i / side % 8 == 4)
                std::printf("%5.1f%c", clip ? static_cast<double>(depths[i]) : 0.0,
                            i % side > side - 8 ? '\n' : ' ');
        return status < SV_OK ? 4 : 0;
    } catch (const std::exception &e) {
        return std::fprintf(stderr, "small_host: %s\n", e.what()), 4;
    }
}
