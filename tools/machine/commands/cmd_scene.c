/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "base/cli.h"
#include "base/options.h"
#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"
#include "scene/scene.h"
#include "scene/scene_draw.h"
#include "scene/scene_export.h"
#include "show/scene_sheet.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define SETS 32u

/* What is asked for. Strings are borrowed from argv. */
typedef struct {
    const char *out;
    hs_scene_options options;
    uint32_t frames;
    const char *sets[SETS]; /* PATH=VALUE */
    uint32_t set_count;
    uint32_t random;      /* scenes of a random set; 0: none */
    uint64_t random_seed; /* of the set */
    bool all, hard, ranges, json, export, vol, sheet, help;
} scene_line;

static bool take_set(void *target, const char *text, hs_error *err) {
    scene_line *const r = target;
    return hs_cli_append("--set", text, r->sets, &r->set_count, SETS, err);
}

static bool take_format(void *vol, const char *text, hs_error *err) {
    *(bool *)vol = strcmp(text, "vol") == 0;
    return *(bool *)vol || strcmp(text, "mha") == 0 ||
           hs_fail(err, HS_ERR_USAGE, "--format: '%s' is none of mha, vol", text);
}

#define AT(field) offsetof(scene_line, field)
static const hs_option options[] = {
    {"all", NULL, "the nine cases of the thesis\n", HS_OPTION_FLAG, AT(all), 0, 0, NULL},
    {"hard", NULL, "the hard cases, H01 and on\n", HS_OPTION_FLAG, AT(hard), 0, 0, NULL},
    {"random", "N", "the first N scenes of a random set, 1 .. 100000; --seed is the set's (default 1)\n",
     HS_OPTION_COUNT, AT(random), 1, HS_SCENE_MAX_DRAWN, NULL},
    {"ranges", NULL, "print what random scenes are drawn from, and no more\n", HS_OPTION_FLAG, AT(ranges), 0,
     0, NULL},
    {"set", "PATH=VALUE",
     "a field of the scene otherwise, repeatable: artefacts.haze=on, artefacts.fan=off,\n"
     "artefacts.haze.level_db=-12, structures[0].gap_mm=2\n",
     HS_OPTION_TAKEN, 0, 0, 0, take_set},
    {"size", "N", "voxels per axis, 32 .. 512 (default 256)\n", HS_OPTION_COUNT, AT(options.size), 32, 512,
     NULL},
    {"seed", "N", "another seed than the scene's own: speckle, noise and particles change\n", HS_OPTION_WHOLE,
     AT(options.seed), 1, 0, NULL},
    {"frames", "N", "N frames of the scene's motion, 1 .. 1000 (default 1)\n", HS_OPTION_COUNT, AT(frames), 1,
     1000, NULL},
    {"threads", "N", "threads, 1 .. 64 (default: one per processor); the bytes do not depend on it\n",
     HS_OPTION_COUNT, AT(options.threads), 1, 64, NULL},
    {"real", "FILE", "the volume that the scene 'real' puts its occluders before\n", HS_OPTION_TEXT,
     AT(options.real), 0, 0, NULL},
    {"json", NULL, "write <name>.json, the scene as a file; on its own it makes no volume\n", HS_OPTION_FLAG,
     AT(json), 0, 0, NULL},
    {"export", NULL, "write <name>.json, _full.mha, _truth.mha, _label.mha, _near.mha and _far.mha\n",
     HS_OPTION_FLAG, AT(export), 0, 0, NULL},
    {"format", "WHAT",
     "of --export: mha, or vol for Kretz files: <name>_full.vol and _truth.vol, with\n"
     "_label.mha for their Cartesian copies; several frames as a sequence, without\n"
     "(default mha)\n",
     HS_OPTION_TAKEN, AT(vol), 0, 0, take_format},
    {"sheet", NULL, "write <name>_sheet.png, a contact sheet (needs an OpenCL device)\n", HS_OPTION_FLAG,
     AT(sheet), 0, 0, NULL},
    {"out", "FOLDER", "where files go (default out/scenes)\n", HS_OPTION_TEXT, AT(out), 0, 0, NULL},
    {NULL, NULL, NULL, HS_OPTION_FLAG, 0, 0, 0, NULL},
};

/* One way to name scenes, and the seed to whom it belongs. */
static bool check_choice(scene_line *r, const char *named, hs_error *err) {
    const char *const all = r->all ? "--all" : r->hard ? "--hard" : r->random ? "--random" : NULL;
    if (all && named) return hs_fail(err, HS_ERR_USAGE, "%s and the scene '%s' were both given", all, named);
    if (r->all + r->hard + (r->random > 0) > 1)
        return hs_fail(err, HS_ERR_USAGE, "only one of --all, --hard and --random");
    if (r->random) {
        r->random_seed = r->options.seed ? r->options.seed : 1;
        r->options.seed = 0;
    }
    return true;
}

static bool parse(int argc, char **argv, scene_line *r, hs_error *err) {
    *r = (scene_line){.out = "out/scenes", .options = {.size = 256}, .frames = 1};
    int next = argc;
    if (!hs_options_read(argc, argv, options, r, &next, &r->help, err)) return false;
    if (r->help) return true;
    if (r->vol && !r->export) return hs_fail(err, HS_ERR_USAGE, "--format: is for --export");
    return check_choice(r, next < argc ? argv[next] : NULL, err);
}

static void print_help(void) {
    (void)printf(
        "Usage: host_sim scenes [options] [NAME|FILE...]\n"
        "Generates synthetic scenes with their ground truth. Without a scene it lists the built-in ones.\n"
        "A scene is a built-in name (D01), the path of a scene file (docs/scenes.md), or R<seed>_<number>:\n"
        "a random scene, number 0 and on of the set with that seed.\n"
        "\n");
    hs_options_print(options);
    (void)printf("\n%s", hs_exit_codes_help);
}

static bool list_scenes(hs_error *err) {
    for (int group = 0; group < HS_SCENES_GROUPS; group++)
        for (uint32_t i = 0; hs_scene_of_group((hs_scene_group)group, i); i++) {
            hs_scene *scene = hs_scene_open(hs_scene_of_group((hs_scene_group)group, i), err);
            if (!scene) return false;
            hs_print(stdout, "%-5s %s\n", hs_scene_name(scene), hs_scene_title(scene));
            hs_scene_close(scene);
        }
    return true;
}

/* Prints what random scenes are drawn from. */
static void print_ranges(void) {
    for (int i = 0; i < HS_RANGE_COUNT; i++) {
        const hs_scene_range *r = &hs_scene_ranges[i];
        if (r->low == r->high)
            hs_print(stdout, "| `%s` | %g %s | | %s |\n", r->key, r->low / 100.0, r->unit, r->what);
        else
            hs_print(stdout, "| `%s` | %g .. %g%s%s | %g | %s |\n", r->key, r->low / 100.0, r->high / 100.0,
                     r->unit[0] ? " " : "", r->unit, r->step / 100.0, r->what);
    }
}

static void print_facts(const char *name, const hs_scene_data *data) {
    size_t labels[3] = {0}, pixels = (size_t)data->full.nx * data->full.ny;
    for (size_t i = 0; i < pixels; i++) labels[data->label[i]]++;
    hs_print(stdout, "%-10s %u x %u x %u; rays: fetus %.1f %%, sac only %.1f %%\n", name, data->full.nx,
             data->full.ny, data->full.nz, 100.0 * (double)labels[2] / (double)pixels,
             100.0 * (double)labels[1] / (double)pixels);
}

static bool write_sheet(const scene_line *r, const hs_scene *scene, const char *name,
                        const hs_scene_data *data, const hs_cl *cl, hs_error *err) {
    char path[1024], file[128], title[640];
    hs_picture picture;
    snprintf(file, sizeof file, "%s_sheet.png", name);
    snprintf(title, sizeof title, "%s: %s", name, hs_scene_title(scene));
    if (!hs_path_join(r->out, file, path, sizeof path, err)) return false;
    if (!hs_scene_sheet(cl, data, title, &picture, err)) return false;
    bool ok = hs_picture_save(&picture, path, err);
    hs_picture_free(&picture);
    return ok;
}

/* What --export asks for. A sequence of Kretz files has the scene's name, whatever the frame. */
static bool export_frame(const scene_line *r, const hs_scene *scene, const char *prefix,
                         const hs_scene_data *data, hs_vol_export *files, hs_error *err) {
    char path[1024];
    if (!r->vol) return hs_scene_export(data, prefix, err);
    return hs_path_join(r->out, hs_scene_name(scene), path, sizeof path, err) &&
           hs_vol_export_frame(files, path, r->frames, data, err);
}

static bool make_frame(const scene_line *r, const hs_scene *scene, uint32_t frame, const hs_cl *cl,
                       hs_vol_export *files, hs_error *err) {
    hs_scene_options one = r->options;
    hs_scene_data data;
    char name[96], prefix[1024];
    one.frame = frame;
    if (r->frames > 1)
        snprintf(name, sizeof name, "%s_f%03u", hs_scene_name(scene), frame);
    else
        snprintf(name, sizeof name, "%s", hs_scene_name(scene));
    if (!hs_path_join(r->out, name, prefix, sizeof prefix, err)) return false;
    if (!hs_scene_frame(scene, &one, &data, err)) return false;
    bool ok = true;
    print_facts(name, &data);
    if (r->export) ok = export_frame(r, scene, prefix, &data, files, err);
    if (ok && r->sheet) ok = write_sheet(r, scene, name, &data, cl, err);
    hs_scene_free(&data);
    return ok;
}

static bool write_json(const scene_line *r, const hs_scene *scene, hs_error *err) {
    char path[1024], file[128];
    hs_output_file output;
    snprintf(file, sizeof file, "%s.json", hs_scene_name(scene));
    if (!hs_path_join(r->out, file, path, sizeof path, err) || !hs_output_open(&output, path, err))
        return false;
    (void)fputs(hs_scene_json(scene), output.file);
    return hs_output_commit(&output, err);
}

static bool make_scene(const scene_line *r, const char *name, const hs_cl *cl, hs_error *err) {
    hs_scene *scene = hs_scene_open_with(name, r->sets, r->set_count, err);
    if (!scene) return false;
    const bool volumes = !r->json || r->export || r->sheet;
    bool ok = true;
    hs_vol_export files = {0};
    for (uint32_t frame = 0; ok && volumes && frame < r->frames; frame++)
        ok = make_frame(r, scene, frame, cl, &files, err);
    if (ok && (r->json || r->export)) ok = write_json(r, scene, err);
    hs_vol_export_discard(&files);
    hs_scene_close(scene);
    return ok;
}

static bool make_group(const scene_line *r, hs_scene_group group, const hs_cl *cl, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && hs_scene_of_group(group, i); i++)
        ok = make_scene(r, hs_scene_of_group(group, i), cl, err);
    return ok;
}

static bool make_random(const scene_line *r, const hs_cl *cl, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < r->random; i++) {
        char name[64];
        snprintf(name, sizeof name, "R%" PRIu64 "_%" PRIu32, r->random_seed, i);
        ok = make_scene(r, name, cl, err);
    }
    return ok;
}

static bool make_scenes(const scene_line *r, char **names, int count, hs_error *err) {
    hs_cl cl = {0};
    const bool files = r->json || r->export || r->sheet;
    if (files && !hs_path_make_folder(r->out, err)) return false;
    bool ok = !r->sheet || hs_cl_open(&cl, err);
    for (int i = 0; ok && i < count; i++) ok = make_scene(r, names[i], &cl, err);
    if (ok && r->all) ok = make_group(r, HS_SCENES_THESIS, &cl, err);
    if (ok && r->hard) ok = make_group(r, HS_SCENES_HARD, &cl, err);
    if (ok && r->random) ok = make_random(r, &cl, err);
    hs_cl_close(&cl);
    if (ok && files) hs_print(stdout, "Files are in %s\n", r->out);
    return ok;
}

int hs_cmd_scene(int argc, char **argv) {
    scene_line r;
    hs_error err = {0};
    if (!parse(argc, argv, &r, &err)) return hs_cli_fail("scenes", &err);
    if (r.help) {
        print_help();
        return HS_OK;
    }
    if (r.ranges) {
        print_ranges();
        return HS_OK;
    }
    const bool make = r.all || r.hard || r.random || optind < argc;
    bool ok = make ? make_scenes(&r, argv + optind, argc - optind, &err) : list_scenes(&err);
    return ok ? HS_OK : hs_cli_fail("scenes", &err);
}
