/* SPDX-License-Identifier: MIT */
/* What a check is, and all checks. */
#ifndef V_CHECK_H
#define V_CHECK_H

#include "rules/rules.h"
#include "validate/drive/drive.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    const rule *rule;
    const char *id;    /* the rule's */
    const char *needs; /* skipped unless this check passed; NULL: none */
    void (*run)(v_run *run);
} v_check;

extern const v_check v_checks[];
extern const size_t v_check_count;

/* The check with this id, or NULL. */
const v_check *v_check_find(const char *id);

/* void check_<name>(v_run *run) of every rule that the validator tries. */
#define CHECK_TRIED(name) void check_##name(v_run *run);
#define CHECK_BOTH(name)  CHECK_TRIED(name)
#define CHECK_SEEN(name)
#define CHECK(name, who, id, needs, what, mend) CHECK_##who(name)
RULES(CHECK)
#undef CHECK

#endif
