/* SPDX-License-Identifier: MIT */
#include "core/system.h"
#include "plugin/capabilities.h"
#include "replay/replay.h"

#include <unistd.h>

#define MIB          1048576.0
#define FREE_MIB     1024.0 /* that any recording may take: a volume of 512^3, and what a plugin makes of it */
#define MIB_FOR_EACH 512.0  /* MiB of the file */
#define MAX_MIB      65536.0
#define FREE_S       8.0 /* some hundreds of frames of which the voxels were not kept */
#define S_FOR_EACH   4.0 /* MiB of the file: more than twice what frames of 128^3 take that hold no voxels */

double rp_file_bytes(const rp_options *o) {
    const int file = sys_open(o->file, SYS_READ);
    const off_t bytes = file < 0 ? 0 : lseek(file, 0, SEEK_END);
    if (file >= 0) (void)close(file);
    return bytes > 0 ? (double)bytes : 0.0;
}

void rp_set_bounds(rp_options *o) {
    const double mib = rp_file_bytes(o) / MIB;
    const double most = FREE_MIB + MIB_FOR_EACH * mib;
    if (o->guard.memory_bytes == 0)
        o->guard.memory_bytes = (uint64_t)((most < MAX_MIB ? most : MAX_MIB) * MIB);
    if (o->seconds <= 0.0) o->seconds = FREE_S + S_FOR_EACH * mib;
}

/* What the plugin says that it takes for this format; 0: it does not say. */
static uint64_t ask_needs(const sv_plugin *in, const sv_format *format) {
    const uint64_t most = UINT64_MAX / 4;
    const sv_ext_needs *ext = hs_plugin_needs(in);
    const sv_needs_device device = {sizeof device, SV_NEEDS_CPU | SV_NEEDS_UNIFIED | SV_NEEDS_DOUBLES, 16, 0};
    sv_needs needs = {.size = sizeof needs};
    if (!ext || ext->of(in, format, NULL, 0, &device, &needs) != SV_OK) return 0;
    return (needs.device_bytes < most ? needs.device_bytes : most) +
           (needs.host_bytes < most ? needs.host_bytes : most);
}

bool rp_pays(const rp_options *o, const hs_plugin *plugin, const sv_format *f, uint64_t bytes,
             hs_error *err) {
    const uint64_t limit = o->guard.memory_bytes, rays = (uint64_t)f->width * f->height;
    /* An object has a copy of its slab. A picture's voxels are kept a second time. */
    uint64_t all = bytes * (f->carrier == SV_CARRIER_HOST ? 1 : 2) + rays * 16;
    if (o->out) all += rays * f->slices;
    if (all <= limit) all += ask_needs(plugin->instance, f);
    return all <= limit ||
           hs_fail(
               err, HS_ERR_INPUT,
               "activate: %u x %u x %u voxels in rows of %u bytes and tiles of %u rows take %llu MiB, and a "
               "recording of this size may take %llu: --guard-memory allows more",
               f->width, f->height, f->slices, f->row_pitch, f->tile_h, (unsigned long long)(all >> 20),
               (unsigned long long)(limit >> 20));
}
