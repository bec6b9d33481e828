/* SPDX-License-Identifier: MIT */
/* A recording as text, call by call. */
#include "core/text.h"
#include "plugin/loader.h"
#include "replay/replay.h"

#include <inttypes.h>
#include <stdio.h>

static void print_item(const rec_item *it, uint64_t first_ns) {
    if (it->type == REC_PLUGIN)
        hs_print(stdout, "plugin %s %s, %u parameters\n", it->id, it->version, it->param_count);
    if (it->type == REC_LOG) hs_print(stdout, "  log, severity %d: %s\n", (int)it->severity, it->text);
    if (it->type == REC_RETURN)
        hs_print(stdout, "  %s%s%s, %.3f ms\n", hs_status_name(it->returned), it->reason[0] ? ": " : "",
                 it->reason, (double)it->ns * 1e-6);
    if (it->type != REC_CALL) return;
    hs_print(stdout, "%s", rc_names[it->kind]);
    if (!it->sound)
        hs_print(stdout, ", which broke a rule");
    else if (it->kind == RC_ACTIVATE)
        hs_print(stdout, " %u x %u x %u, slabs of %u, carrier %u on %s queue, flags 0x%x", it->format.width,
                 it->format.height, it->format.slices, it->format.max_slab_slices, it->format.carrier,
                 it->host_queue ? "the host's" : "the plugin's own", it->format.flags);
    else if (it->kind == RC_BEGIN)
        hs_print(stdout, " %" PRIu64 ", time %" PRIu64 " ns, flags 0x%x%s, probe towards (%g, %g, %g)",
                 it->frame.index, it->frame.time_ns, it->frame.flags, it->ranges ? ", with ranges" : "",
                 (double)it->frame.probe_side[0], (double)it->frame.probe_side[1],
                 (double)it->frame.probe_side[2]);
    else if (it->kind == RC_SLAB)
        hs_print(stdout, " %u .. %u%s", it->slab.first_slice, it->slab.first_slice + it->slab.slice_count,
                 it->voxels ? "" : ", without voxels");
    for (uint32_t i = 0; i < it->value_count && it->sound &&
                         (it->kind == RC_ACTIVATE || it->kind == RC_BEGIN || it->kind == RC_ADJUST);
         i++)
        hs_print(stdout, "%s %u=%g", i ? "," : ";", it->values[i].id, it->values[i].value);
    hs_print(stdout, "; at %.3f ms\n", (double)(it->ns - first_ns) * 1e-6);
}

bool rp_list(const char *file, hs_error *err) {
    static rec_item item;
    char wrong[1500];
    int there = -1;
    uint64_t first_ns = 0;
    rec_reader *reader = rec_reader_open(file, wrong, sizeof wrong);
    while (reader && (there = rec_reader_next(reader, &item, wrong, sizeof wrong)) == 1) {
        if (first_ns == 0 && item.type == REC_CALL) first_ns = item.ns;
        print_item(&item, first_ns);
    }
    rec_reader_close(reader);
    return there == 0 || hs_fail(err, HS_ERR_INPUT, "%s", wrong);
}
