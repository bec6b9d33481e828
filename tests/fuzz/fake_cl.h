/* SPDX-License-Identifier: MIT */
/*
 * OpenCL without a device, for the plugin linked into a fuzz target: objects are heap blocks, copies happen
 * at once, kernels do nothing, and the self-test passes. So an input costs microseconds, and the address
 * sanitizer sees every byte that the plugin lets OpenCL touch, and every object that it forgets.
 */
#pragma once

#include <stdint.h>

/* The nth call from now on (1, 2, ...) that makes something or enqueues fails, once; 0: none. */
void fake_cl_fail(uint32_t nth);
