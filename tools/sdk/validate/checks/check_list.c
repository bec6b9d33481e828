/* SPDX-License-Identifier: MIT */
/* All checks in their order. */
#include "validate/checks/check.h"

/* The rules that the validator tries, in their order. */
#define ROW_TRIED(name, id, needs) {&rules[RULE_##name], id, needs, check_##name},
#define ROW_BOTH(name, id, needs)  ROW_TRIED(name, id, needs)
#define ROW_SEEN(name, id, needs)
#define ROW(name, who, id, needs, what, mend) ROW_##who(name, id, needs)
const v_check v_checks[] = {RULES(ROW)};
const size_t v_check_count = sizeof v_checks / sizeof *v_checks;

const v_check *v_check_find(const char *id) {
    for (size_t i = 0; i < v_check_count; i++)
        if (strcmp(v_checks[i].id, id) == 0) return &v_checks[i];
    return NULL;
}
