/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "core/cli.h"
#include "core/options.h"
#include "core/output_file.h"
#include "core/paths.h"
#include "core/text.h"
#include "scene/scene.h"
#include "scene/scene_export.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

/* What is asked for. Strings are borrowed from argv. */
typedef struct {
    const char *out;
    hs_scene_options options;
    uint32_t frames;
    bool all, hard, export, vol, help;
} scene_line;

static bool take_format(void *vol, const char *text, hs_error *err) {
    *(bool *)vol = strcmp(text, "vol") == 0;
    return *(bool *)vol || strcmp(text, "mha") == 0 ||
           hs_fail(err, HS_ERR_USAGE, "--format: '%s' is none of mha, vol", text);
}

#define AT(field) offsetof(scene_line, field)
static const hs_option options[] = {
    HS_FLAG("all", AT(all), "the nine cases of the thesis"),
    HS_FLAG("hard", AT(hard), "the hard cases, H01 and on"),
    HS_IN(COUNT, "size", "N", AT(options.size), 32, 512, "voxels per axis, 32 .. 512 (default 256)"),
    HS_IN(WHOLE, "seed", "N", AT(options.seed), 1, 0,
          "another seed than the scene's own: speckle, noise and particles change"),
    HS_IN(COUNT, "frames", "N", AT(frames), 1, 1000, "N frames of the scene's motion, 1 .. 1000 (default 1)"),
    HS_IN(COUNT, "threads", "N", AT(options.threads), 1, 64,
          "threads, 1 .. 64 (default: one per processor); the bytes do not depend on it"),
    HS_TEXT("real", "FILE", AT(options.real), "the volume that the scene 'real' puts its occluders before"),
    HS_FLAG("export", AT(export),
            "write <name>_full.mha, _truth.mha, _label.mha, _near.mha and _far.mha, and <name>.json,\n"
            "the scene as a file"),
    HS_TAKEN("format", "WHAT", AT(vol), take_format,
             "of --export: mha, or vol for Kretz files: <name>_full.vol and _truth.vol, with\n"
             "_label.mha for their Cartesian copies; several frames as a sequence, without\n"
             "(default mha)"),
    HS_TEXT("out", "FOLDER", AT(out), "where files go (default out/scenes)"),
    HS_OPTIONS_END,
};

static bool parse(int argc, char **argv, scene_line *r, hs_error *err) {
    *r = (scene_line){.out = "out/scenes", .options = {.size = 256}, .frames = 1};
    int next = argc;
    if (!hs_options_read(argc, argv, options, r, &next, &r->help, err)) return false;
    if (r->help) return true;
    if (r->vol && !r->export) return hs_fail(err, HS_ERR_USAGE, "--format: is for --export");
    if (r->all && r->hard) return hs_fail(err, HS_ERR_USAGE, "only one of --all and --hard");
    return next == argc || !(r->all || r->hard) ||
           hs_fail(err, HS_ERR_USAGE, "%s and the scene '%s' were both given", r->all ? "--all" : "--hard",
                   argv[next]);
}

static const char usage[] =
    "Usage: host_sim scenes [options] [NAME|FILE...]\n"
    "Generates synthetic scenes with their ground truth. Without a scene it lists the built-in ones.\n"
    "A scene is a built-in name (D01), the path of a scene file (docs/scenes.md), or R<seed>_<number>:\n"
    "a random scene, number 0 and on of the set with that seed.\n\n";

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

static void print_facts(const char *name, const hs_scene_data *data) {
    size_t labels[3] = {0}, pixels = (size_t)data->full.nx * data->full.ny;
    for (size_t i = 0; i < pixels; i++) labels[data->label[i]]++;
    hs_print(stdout, "%-10s %u x %u x %u; rays: fetus %.1f %%, sac only %.1f %%\n", name, data->full.nx,
             data->full.ny, data->full.nz, 100.0 * (double)labels[2] / (double)pixels,
             100.0 * (double)labels[1] / (double)pixels);
}

/* What --export asks for. A sequence of Kretz files has the scene's name, whatever the frame. */
static bool export_frame(const scene_line *r, const hs_scene *scene, const char *prefix,
                         const hs_scene_data *data, hs_vol_export *files, hs_error *err) {
    char path[1024];
    if (!r->vol) return hs_scene_export(data, prefix, err);
    return hs_path_join(r->out, hs_scene_name(scene), path, sizeof path, err) &&
           hs_vol_export_frame(files, path, r->frames, data, err);
}

static bool make_frame(const scene_line *r, const hs_scene *scene, uint32_t frame, hs_vol_export *files,
                       hs_error *err) {
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

static bool make_scene(const scene_line *r, const char *name, hs_error *err) {
    hs_scene *scene = hs_scene_open(name, err);
    if (!scene) return false;
    bool ok = true;
    hs_vol_export files = {0};
    for (uint32_t frame = 0; ok && frame < r->frames; frame++) ok = make_frame(r, scene, frame, &files, err);
    if (ok && r->export) ok = write_json(r, scene, err);
    hs_vol_export_discard(&files);
    hs_scene_close(scene);
    return ok;
}

static bool make_group(const scene_line *r, hs_scene_group group, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && hs_scene_of_group(group, i); i++)
        ok = make_scene(r, hs_scene_of_group(group, i), err);
    return ok;
}

static bool make_scenes(const scene_line *r, char **names, int count, hs_error *err) {
    bool ok = !r->export || hs_path_make_folder(r->out, err);
    for (int i = 0; ok && i < count; i++) ok = make_scene(r, names[i], err);
    if (ok && r->all) ok = make_group(r, HS_SCENES_THESIS, err);
    if (ok && r->hard) ok = make_group(r, HS_SCENES_HARD, err);
    if (ok && r->export) hs_print(stdout, "Files are in %s\n", r->out);
    return ok;
}

int hs_cmd_scene(int argc, char **argv) {
    scene_line r;
    hs_error err = {0};
    if (!parse(argc, argv, &r, &err)) return hs_cli_fail("scenes", &err);
    if (r.help) return hs_options_help(usage, options, "");
    const bool make = r.all || r.hard || optind < argc;
    bool ok = make ? make_scenes(&r, argv + optind, argc - optind, &err) : list_scenes(&err);
    return ok ? HS_OK : hs_cli_fail("scenes", &err);
}
