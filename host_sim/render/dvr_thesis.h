/* SPDX-License-Identifier: MIT */
/* The thesis' look, and the ends of rays in either: arguments of its kernel (dvr.h defines both). */
#ifndef HS_DVR_THESIS_H
#define HS_DVR_THESIS_H

#include "render/dvr_view.h"

#define HS_DVR_THESIS_KERNEL "render_volume"

/* All arguments of render_volume behind what it samples (SAMPLED in cl/dvr.cl). `depths` as for
 * hs_dvr_render; `rgba` and `termination` may be NULL. */
void hs_dvr_thesis_arguments(hs_launch *launch, const hs_dvr_settings *settings, const hs_ray_view *view,
                             const hs_start_depths *depths, cl_mem rgba, cl_mem termination);

#endif
