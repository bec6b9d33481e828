/* SPDX-License-Identifier: MIT */
/* host_sim measure: the quality of depthmaps that were made elsewhere. */
#include "report/report.h"

#include "core/cli.h"
#include "core/options.h"
#include "loop/source_options.h"
#include "volume/metaimage.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    hs_eval_request of;
    int first; /* index of the first map's argument */
    bool help;
} request;

#define AT(field) offsetof(request, of.field)
static const hs_option options[] = {
    HS_TEXT("case", "NAME", AT(name),
            "a built-in scene, a scene file, or files FULL,TRUTH,LABEL[,FIRST,END]\n"
            "(see 'host_sim report --help') [D01]"),
    HS_TEXT("real", "FILE", AT(real), "the volume of the scene 'real'"),
    HS_IN(COUNT, "size", "N", AT(size), 32, 512, "voxels per axis of a scene, 32 .. 512 [384]"),
    HS_SOURCE_ROWS(AT(read)),
    HS_IN(COUNT, "lowres", "N", AT(lowres), 8, 1024, "pixels per axis of the maps [as in run: 128 of 384]"),
    HS_IN(WHOLE, "seed", "N", AT(seed), 0, 0, "seed of the scene; 0 is its own [0]"),
    HS_OPTIONS_END,
};

static const char usage[] =
    "Usage: host_sim measure [options] MAP...\n"
    "Measures depthmaps that were made elsewhere, as 'report' measures a plugin's, and prints JSON.\n"
    "MAP is a MetaImage file of as many values as the map has pixels: depths in slices of the\n"
    "low-resolution volume (the mm of run --write depthmap by its third ElementSpacing), 0 or less\n"
    "clips nothing. '-' is the map that clips nothing at all.\n\n";

/* What is for scenes would do nothing with files, and a volume nothing with a synthetic scene. */
static bool check_case(const hs_eval_request *of, hs_error *err) {
    const char *option = of->size ? "--size" : of->seed ? "--seed" : of->real ? "--real" : NULL;
    if (option && strchr(of->name, ','))
        return hs_fail(err, HS_ERR_USAGE, "%s: is for scenes, --case %s names files", option, of->name);
    if (of->real && strcmp(of->name, "real") != 0)
        return hs_fail(err, HS_ERR_USAGE, "--real %s: is for --case real, not %s", of->real, of->name);
    return true;
}

static bool parse(int argc, char **argv, request *r, hs_error *err) {
    *r = (request){.of = {.name = "D01"}};
    if (!hs_options_read(argc, argv, options, r, &r->first, &r->help, err)) return false;
    if (r->help) return true;
    if (r->first == argc) return hs_fail(err, HS_ERR_USAGE, "no depthmap was given");
    if (!check_case(&r->of, err)) return false;
    if (r->of.size == 0) r->of.size = 384;
    return true;
}

/* The map of a file, as the table takes it. False if it cannot be read, or if the host would not render with
 * it: a value is not finite, or lies beyond twice the volume. */
static bool read_map(const char *path, const hs_eval_table *table, float *map, hs_error *err) {
    const size_t pixels = (size_t)table->width * table->height;
    double *values = calloc(pixels, sizeof *values);
    if (!values) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu pixels", path, pixels);
    bool ok = hs_metaimage_read_map(path, table->width, table->height, values, err);
    const double slices = (double)((float)table->steps / table->steps_per_slice);
    for (size_t i = 0; ok && i < pixels; i++) {
        map[i] = (float)values[i];
        if (fabs(values[i]) > 2.0 * slices)
            ok = hs_fail(err, HS_ERR_INPUT,
                         "%s: the depth of pixel (%zu, %zu) is %g, expected twice %g slices at most", path,
                         i % table->width, i / table->width, values[i], slices);
    }
    free(values);
    return ok;
}

/* JSON has no NaN: a measure over no ray is null. */
static json_t *describe(const char *name, const hs_measures *measures) {
    json_t *object = json_object();
    json_t *text = json_string(name);
    if (json_object_set_new(object, "map", text ? text : json_string("?")) != 0) return object;
    for (int m = 0; m < HS_MEASURE_COUNT; m++) {
        const double value = (double)measures->of[m];
        (void)json_object_set_new(object, hs_measure_key((hs_measure)m),
                                  isnan(value) ? json_null() : json_real(value));
    }
    return object;
}

static bool measure_all(const hs_eval_case *c, char **paths, int count, json_t *out, hs_error *err) {
    for (int i = 0; i < count; i++) {
        hs_measures measures;
        const bool unclipped = strcmp(paths[i], "-") == 0;
        if (!unclipped && !read_map(paths[i], &c->table, c->map, err)) return false;
        hs_eval_measure_map(&c->table, unclipped ? NULL : c->map, &measures);
        json_t *described = describe(paths[i], &measures);
        if (!unclipped)
            (void)json_object_set_new(described, "map_crc32",
                                      json_integer(hs_eval_map_crc(&c->table, c->map)));
        if (json_array_append_new(out, described) != 0)
            return hs_fail(err, HS_ERR_MEMORY, "no memory for the results");
    }
    return true;
}

static bool measure(const request *r, char **paths, int count, hs_error *err) {
    const hs_eval_values none = {0};
    hs_cl cl = {0};
    hs_eval_case c = {0};
    json_t *out = json_array();
    bool ok = out || hs_fail(err, HS_ERR_MEMORY, "no memory for the results");
    ok = ok && hs_cl_open(&cl, err) && hs_eval_case_open(&c, &cl, NULL, &none, &r->of, err) &&
         measure_all(&c, paths, count, out, err);
    if (ok && (json_dumpf(out, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) != 0 || printf("\n") < 0))
        ok = hs_fail(err, HS_ERR_OUTPUT, "the results cannot be written");
    hs_eval_case_close(&c);
    hs_cl_close(&cl);
    json_decref(out);
    return ok;
}

int hs_cmd_measure(int argc, char **argv) {
    request r;
    hs_error err = {0};
    if (!parse(argc, argv, &r, &err)) return hs_cli_fail("measure", &err);
    if (r.help) return hs_options_help(usage, options, "");
    return measure(&r, argv + r.first, argc - r.first, &err) ? HS_OK : hs_cli_fail("measure", &err);
}
