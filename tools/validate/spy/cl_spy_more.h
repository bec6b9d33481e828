/* SPDX-License-Identifier: MIT */
/* cl_spy_more.c defines OpenCL functions only; cl_spy.h counts them. */
#ifndef SV_CL_SPY_MORE_H
#define SV_CL_SPY_MORE_H

#include <CL/cl.h>

#endif
