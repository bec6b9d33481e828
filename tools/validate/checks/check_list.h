/* SPDX-License-Identifier: MIT */
/* All checks in their order. */
#ifndef CHECK_LIST_H
#define CHECK_LIST_H

#include "validate/checks/check.h"

#include <stddef.h>

extern const v_check v_checks[];
extern const size_t v_check_count;

/* The check with this id, or NULL. */
const v_check *v_check_find(const char *id);

#endif
