/* SPDX-License-Identifier: MIT */
/* Instead of replay_draw.c and replay_show.c where the machine's pictures are not built. */
#include "replay/replay.h"

bool rp_draw(const rp_options *o, const rp_report *report, hs_error *err) {
    return hs_fail(err, HS_ERR_USAGE, "--out %s: frame %u is drawn on Linux: this build has no pictures",
                   o->out, report->drawn.number);
}

bool rp_show(const char *file, const char *folder, hs_error *err) {
    return hs_fail(err, HS_ERR_USAGE, "--show %s: %s is shown on Linux: this build has no pictures", folder,
                   file);
}
