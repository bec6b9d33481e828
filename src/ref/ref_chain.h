/* SPDX-License-Identifier: MIT */
/*
 * The definition of every method, and of the pre-filter before it. Tests and benchmark hold the kernels to
 * it, and the plugin's self-test asks the device for an answer computed here.
 */
#pragma once

#include "ref/ref_method.h"

/* What the plugin takes for them by default, at every pixel and without merging. */
extern const sv_ref_settings sv_ref_default_settings;

/* The definition of method SV_METHOD_* (method_list.h), or NULL if there is none. */
const sv_ref_method *sv_ref_method_of(uint32_t method);

/* The name of method SV_METHOD_*: the value of parameter `method`. NULL if there is none. */
const char *sv_ref_method_name(uint32_t method);

/* Largest difference in slices that the whole chain's surface may have from sv_ref_chain. */
double sv_ref_bound(const sv_ref_method *method, const sv_ref_task *task, const sv_ref_device *device);

/* The whole chain: pre-filter and method. */
bool sv_ref_chain(const sv_ref_method *method, const sv_ref_task *task, double *surface);
