/* SPDX-License-Identifier: MIT */
/* The sites that surfaces are judged on: sets of cases from scenes, folders and files. */
#ifndef SITE_SET_H
#define SITE_SET_H

#include "judge/surf_session.h"
#include "judge/wall_case.h"

enum { SITE_NAMES = 9, SITE_MAX_SETS = 8, SITE_MAX_CASES = 128 };

/* E01 .. D02. */
extern const char *const site_names[SITE_NAMES];

/* Cases that are read or made at once. Owned. */
typedef struct {
    char title[160];
    wall_case *cases;
    uint32_t count;
} site_set;

/* All sets of a command line. A zeroed list is empty. */
typedef struct {
    site_set set[SITE_MAX_SETS];
    uint32_t count;
} site_list;

/* Adds the nine cases of a folder as a set of its own (wall_case_read). */
bool site_add_folder(site_list *list, const char *folder, hs_error *err);

/* Adds one case, FULL,TRUTH,LABEL[,FIRST,END], to the set of files. */
bool site_add_files(site_list *list, const char *files, hs_error *err);

/* True for the set of site_add_files. */
bool site_is_files(const site_set *set);

/* Adds the nine scenes at 128^3 of "SEED,POSE" to the set of scenes. */
bool site_add_scenes(site_list *list, const char *seed_and_pose, hs_error *err);

/* Adds a scene by its name or path, as hs_scene_open takes it, at its own
 * seed, to the set of scenes. */
bool site_add_scene(site_list *list, const char *name, hs_error *err);

/* The same for the random scenes 0 .. COUNT - 1 of "SEED,COUNT". */
bool site_add_random(site_list *list, const char *seed_and_count, hs_error *err);

void site_free(site_list *list);

/* The case as a plugin gets it. Borrows from the case. */
surf_volume site_volume(const wall_case *c);

#endif
