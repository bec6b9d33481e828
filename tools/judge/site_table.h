/* SPDX-License-Identifier: MIT */
/* Methods of a plugin on every site, one setting for all cases. */
#ifndef SITE_TABLE_H
#define SITE_TABLE_H

#include "judge/site_score.h"
#include "judge/site_set.h"

enum { SITE_MAX_METHODS = 8 };

/* A method: settings as "key=value", parted by spaces. */
typedef struct {
    const char *settings;
    bool best_q; /* at the single q that gives the least mean error over the set */
} site_method;

typedef struct {
    const char *plugin;
    site_method method[SITE_MAX_METHODS];
    uint32_t count;
} site_methods;

/* The mean filter at its best q, `cost` and `wall`. */
site_methods site_methods_default(const char *plugin);

/* Judges an open session on a set; `q` gets the best one, or -1 if the method is taken as it is set. `each`
 * (count numbers, may be NULL) gets every case's score. */
bool site_judge(surf_session *s, const site_set *set, bool best_q, site_score *out, double *q,
                wall_score *each, hs_error *err);

/* Prints the table, every case's errors, and how well the confidences are calibrated. */
bool site_table(const site_list *list, const site_methods *methods, hs_error *err);

#endif
