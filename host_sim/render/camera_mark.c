/* SPDX-License-Identifier: MIT */
#include "render/camera_mark.h"

#include <stdio.h>

void hs_camera_mark(const hs_camera *camera, const hs_volume *volume, char *out, size_t bytes) {
    const double *r = camera->rotation;
    const char *ends[2];
    if (volume->beams) {
        (void)snprintf(out, bytes, "%s", hs_beams_side_name(volume->beams));
    } else if (volume->pose.stated) {
        const double right[3] = {r[0], r[3], r[6]}, up[3] = {-r[1], -r[4], -r[7]};
        hs_pose_ends(&volume->pose, right, up, ends);
        (void)snprintf(out, bytes, "patient's %s at the right, %s at the top", ends[0], ends[1]);
    } else if (bytes > 0) {
        out[0] = '\0';
    }
}

void hs_camera_title(const char *title, const hs_camera *camera, const hs_volume *volume, char *out,
                     size_t bytes) {
    char mark[64];
    hs_camera_mark(camera, volume, mark, sizeof mark);
    (void)snprintf(out, bytes, "%s%s%s", title, mark[0] ? ", " : "", mark);
}
