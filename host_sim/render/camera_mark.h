/* SPDX-License-Identifier: MIT */
/* The mark of orientation in a picture's caption. */
#ifndef HS_CAMERA_MARK_H
#define HS_CAMERA_MARK_H

#include "render/camera.h"

/* What is known about left and right in a picture that `camera` takes of `volume`: "patient's left at the
 * right, head at the top", by the closest directions, if the file says how the patient lies; of a probe's
 * volume hs_beams_side_name; else "". At most 64 bytes. */
void hs_camera_mark(const hs_camera *camera, const hs_volume *volume, char *out, size_t bytes);

/* The same behind a title and a comma; the title alone if there is no mark. */
void hs_camera_title(const char *title, const hs_camera *camera, const hs_volume *volume, char *out,
                     size_t bytes);

#endif
