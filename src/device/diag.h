/* SPDX-License-Identifier: MIT */
/* Failures: the reason of the last one, kept for last_error and told to the host's log (sva_error, sva_blame,
 * sva_say, sva_cl_check). */
#pragma once

#include <CL/cl.h>

#include "smartvis/author_objects.h"

/* Who is told: the plugin's instance. Below the ABI's edge no more of it is used. */
typedef sva sv_diag;
