/* SPDX-License-Identifier: MIT */
/* The parts of the ABI's edge: the parameters and the extensions. What every plugin does there does
 * smartvis/author.h for this one, too. */
#pragma once

#include "device/diag.h"
#include "method/values.h"
#include "smartvis/author.h"

/* ---- parameters (params.c) */

enum { SV_PARAM_COUNT = 23 };
extern const sva_param sv_params[];

/* What sva_method.depends_values answers: for which methods a parameter matters, the methods' tables say. */
uint64_t sv_param_depends_values(const sva_param *param);

/* Values in the table's order, as the helper keeps them, by their ids. */
sv_values sv_values_of(const double *list);

/* ---- extensions that the plugin offers (extensions.c) */

/* Their ids, ended by NULL, for the descriptor. */
extern const char *const sv_extension_ids[];

/* The const table of an extension, or NULL for an unknown id. */
const void *sv_extension(const sva *author, const char *id);
