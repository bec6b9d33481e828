/* SPDX-License-Identifier: MIT */
#include "judge/site_set.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const site_names[SITE_NAMES] = {"E01", "E02", "E03", "E04", "M01", "M02", "M03", "D01", "D02"};

static site_set *new_set(site_list *list, const char *title, hs_error *err) {
    if (list->count == SITE_MAX_SETS) {
        (void)hs_fail(err, HS_ERR_USAGE, "more than %d sites", SITE_MAX_SETS);
        return NULL;
    }
    site_set *s = &list->set[list->count];
    *s = (site_set){.cases = calloc(SITE_MAX_CASES, sizeof *s->cases)};
    (void)snprintf(s->title, sizeof s->title, "%s", title);
    if (s->cases) {
        list->count++;
        return s;
    }
    (void)hs_fail(err, HS_ERR_MEMORY, "no memory for %d cases", SITE_MAX_CASES);
    return NULL;
}

/* The set whose title begins like that; made if there is none. */
static site_set *set_of(site_list *list, const char *title, hs_error *err) {
    for (uint32_t i = 0; i < list->count; i++)
        if (strncmp(list->set[i].title, title, strlen(title)) == 0) return &list->set[i];
    return new_set(list, title, err);
}

static wall_case *new_case(site_set *s, hs_error *err) {
    if (s->count < SITE_MAX_CASES) return &s->cases[s->count];
    (void)hs_fail(err, HS_ERR_USAGE, "%s: more than %d cases", s->title, SITE_MAX_CASES);
    return NULL;
}

/* Says in the title what was added. */
static void name_part(site_set *s, const char *text) {
    const size_t used = strlen(s->title);
    (void)snprintf(s->title + used, sizeof s->title - used, " %s", text);
}

bool site_add_folder(site_list *list, const char *folder, hs_error *err) {
    site_set *s = new_set(list, folder, err);
    for (int i = 0; s && i < SITE_NAMES; i++) {
        if (!wall_case_read(folder, site_names[i], &s->cases[i], err)) return false;
        s->count++;
    }
    return s != NULL;
}

bool site_add_files(site_list *list, const char *files, hs_error *err) {
    site_set *s = set_of(list, "files", err);
    wall_case *c = s ? new_case(s, err) : NULL;
    if (!c || !wall_case_files(files, c, err)) return false;
    s->count++;
    return true;
}

bool site_add_scenes(site_list *list, const char *text, hs_error *err) {
    unsigned long seed = 0, pose = 0;
    int length = 0;
    if (sscanf(text, "%9lu,%9lu%n", &seed, &pose, &length) != 2 || text[length] != '\0')
        return hs_fail(err, HS_ERR_USAGE, "--scenes: '%s' is no SEED,POSE", text);
    site_set *s = set_of(list, "scenes", err);
    if (!s) return false;
    name_part(s, text);
    for (int i = 0; i < SITE_NAMES; i++) {
        wall_case *c = new_case(s, err);
        if (!c || !wall_case_make(site_names[i], seed, (uint32_t)pose, 0, c, err)) return false;
        s->count++;
    }
    return true;
}

static bool add_named(site_set *s, const char *name, hs_error *err) {
    wall_case *c = new_case(s, err);
    if (!c || !wall_case_make(name, 0, 0, 0, c, err)) return false;
    s->count++;
    return true;
}

bool site_add_scene(site_list *list, const char *name, hs_error *err) {
    site_set *s = set_of(list, "scenes", err);
    if (!s || !add_named(s, name, err)) return false;
    name_part(s, name);
    return true;
}

bool site_add_random(site_list *list, const char *text, hs_error *err) {
    unsigned long seed = 0, count = 0;
    int length = 0;
    if (sscanf(text, "%9lu,%9lu%n", &seed, &count, &length) != 2 || text[length] != '\0' || count < 1 ||
        count > SITE_MAX_CASES)
        return hs_fail(err, HS_ERR_USAGE, "--random: '%s' is no SEED,COUNT with a count of 1 .. %d", text,
                       SITE_MAX_CASES);
    site_set *s = set_of(list, "scenes", err);
    if (!s) return false;
    char name[48];
    for (unsigned long n = 0; n < count; n++) {
        (void)snprintf(name, sizeof name, "R%lu_%lu", seed, n);
        if (!add_named(s, name, err)) return false;
    }
    (void)snprintf(name, sizeof name, "R%lu_0..%lu", seed, count - 1);
    name_part(s, name);
    return true;
}

bool site_is_files(const site_set *set) {
    return strcmp(set->title, "files") == 0;
}

void site_free(site_list *list) {
    for (uint32_t i = 0; i < list->count; i++) {
        for (uint32_t n = 0; n < list->set[i].count; n++) wall_case_free(&list->set[i].cases[n]);
        free(list->set[i].cases);
    }
    *list = (site_list){0};
}

surf_volume site_volume(const wall_case *c) {
    return (surf_volume){.voxels = c->full,
                         .width = c->nx,
                         .height = c->ny,
                         .slices = c->nz,
                         .spacing_mm = {c->spacing_mm[0], c->spacing_mm[1], c->spacing_mm[2]},
                         .first = c->first,
                         .end = c->end};
}
