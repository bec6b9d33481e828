/* SPDX-License-Identifier: MIT */
#include "commands/cmd_scene.h"

#include "base/cli.h"
#include "base/paths.h"
#include "base/text.h"
#include "commands/look_line.h"
#include "commands/vol_line.h"
#include "report/scene_sheet.h"
#include "scene/scene.h"
#include "scene/scene_export.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const char help_text[] =
    "Usage: host_sim scenes [options] [NAME|FILE...]\n"
    "Generates synthetic scenes with their ground truth. Without a scene it lists the built-in ones.\n"
    "A scene is a built-in name (D01) or the path of a scene file (docs/scenes.md).\n"
    "\n"
    "  --all            all nine built-in cases\n"
    "  --size N         voxels per axis, 32 .. 512 (default 256)\n"
    "  --seed N         another seed than the scene's own: speckle, noise and particles change\n"
    "  --frames N       N frames of the scene's motion, 1 .. 1000 (default 1)\n"
    "  --threads N      threads, 1 .. 64 (default: one per processor); the bytes do not depend on it\n"
    "  --real FILE      the volume that the scene 'real' puts its occluders before\n"
    "  --export         write <name>_full.mha, _truth.mha, _label.mha, _near.mha and _far.mha\n"
    "  --format WHAT    of --export: mha, or vol for Kretz files: <name>_full.vol and _truth.vol, with\n"
    "                   _label.mha for their Cartesian copies; several frames as a sequence, without\n"
    "                   (default mha)\n";

static const char help_tail[] =
    "  --sheet          write <name>_sheet.png, a contact sheet (needs an OpenCL device)\n"
    "  --look NAME      how the sheet's renderings are drawn: thesis or lit (default lit)\n"
    "  --light AZ,EL    where the lamp of the lit look is, degrees: right, up (default -35,40)\n"
    "  --times          print what each step cost, in milliseconds; '-': the scene does not list it\n"
    "  --out FOLDER     where files go (default out/scenes)\n"
    "  --help           this text\n"
    "\n";

typedef struct {
    const char *out;
    hs_scene_options options;
    uint32_t frames;
    hs_vol_spec geometry;    /* of Kretz files */
    hs_dvr_settings drawing; /* of the sheet */
    bool all, export, vol, geometry_given, sheet, times, help;
} request;

enum {
    OPT_ALL = 1,
    OPT_SIZE,
    OPT_SEED,
    OPT_FRAMES,
    OPT_THREADS,
    OPT_REAL,
    OPT_EXPORT,
    OPT_FORMAT,
    OPT_VOL,
    OPT_SHEET,
    OPT_LOOK,
    OPT_LIGHT,
    OPT_TIMES,
    OPT_OUT,
    OPT_HELP
};

static const struct option options[] = {{"all", no_argument, NULL, OPT_ALL},
                                        {"size", required_argument, NULL, OPT_SIZE},
                                        {"seed", required_argument, NULL, OPT_SEED},
                                        {"frames", required_argument, NULL, OPT_FRAMES},
                                        {"threads", required_argument, NULL, OPT_THREADS},
                                        {"real", required_argument, NULL, OPT_REAL},
                                        {"export", no_argument, NULL, OPT_EXPORT},
                                        {"format", required_argument, NULL, OPT_FORMAT},
                                        {"vol", required_argument, NULL, OPT_VOL},
                                        {"sheet", no_argument, NULL, OPT_SHEET},
                                        {"look", required_argument, NULL, OPT_LOOK},
                                        {"light", required_argument, NULL, OPT_LIGHT},
                                        {"times", no_argument, NULL, OPT_TIMES},
                                        {"out", required_argument, NULL, OPT_OUT},
                                        {"help", no_argument, NULL, OPT_HELP},
                                        {0}};

static bool set_option(int option, request *r, hs_error *err) {
    switch (option) {
    case OPT_ALL:
        r->all = true;
        return true;
    case OPT_SIZE:
        return hs_cli_u32("--size", optarg, 32, 512, &r->options.size, err);
    case OPT_SEED:
        return hs_cli_integer("--seed", optarg, 1, UINT64_MAX, &r->options.seed, err);
    case OPT_FRAMES:
        return hs_cli_u32("--frames", optarg, 1, 1000, &r->frames, err);
    case OPT_THREADS:
        return hs_cli_u32("--threads", optarg, 1, 64, &r->options.threads, err);
    case OPT_REAL:
        r->options.real = optarg;
        return true;
    case OPT_EXPORT:
        r->export = true;
        return true;
    case OPT_FORMAT:
        r->vol = strcmp(optarg, "vol") == 0;
        return r->vol || strcmp(optarg, "mha") == 0 ||
               hs_fail(err, HS_ERR_USAGE, "--format: '%s' is none of mha, vol", optarg);
    case OPT_VOL:
        r->geometry_given = true;
        return hs_vol_line_parse(optarg, &r->geometry, err);
    case OPT_SHEET:
        r->sheet = true;
        return true;
    case OPT_LOOK:
        return hs_look_line_look(optarg, &r->drawing.look, err);
    case OPT_LIGHT:
        return hs_look_line_light(optarg, r->drawing.light, err);
    case OPT_TIMES:
        r->times = true;
        return true;
    case OPT_OUT:
        r->out = optarg;
        return true;
    default:
        r->help = true;
        return true;
    }
}

static bool parse(int argc, char **argv, request *r, hs_error *err) {
    *r = (request){
        .out = "out/scenes", .options = {.size = 256}, .frames = 1, .geometry = hs_vol_line_defaults()};
    hs_dvr_defaults(&r->drawing);
    r->drawing.look = HS_LOOK_LIT;
    optind = 1;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", options, NULL)) != -1;) {
        if (!hs_cli_known(option, argv, err) || !set_option(option, r, err)) return false;
    }
    if ((r->vol || r->geometry_given) && !r->export)
        return hs_fail(err, HS_ERR_USAGE, "%s: is for --export", r->vol ? "--format" : "--vol");
    if (r->geometry_given && !r->vol) return hs_fail(err, HS_ERR_USAGE, "--vol: is for --format vol");
    if (r->all && optind < argc)
        return hs_fail(err, HS_ERR_USAGE, "--all and the scene '%s' were both given", argv[optind]);
    return true;
}

static bool list_scenes(hs_error *err) {
    for (uint32_t i = 0; hs_scene_builtin(i); i++) {
        hs_scene *scene = hs_scene_open(hs_scene_builtin(i), err);
        if (!scene) return false;
        hs_print(stdout, "%-5s %s\n", hs_scene_name(scene), hs_scene_title(scene));
        hs_scene_close(scene);
    }
    return true;
}

static void print_times(const hs_scene_times *times) {
    for (int i = 0; i < HS_SCENE_STEPS; i++) {
        if (times->ms[i] > 0.0)
            hs_print(stdout, "    %-14s %8.1f ms\n", hs_scene_step_name(i), times->ms[i]);
        else
            hs_print(stdout, "    %-14s        -\n", hs_scene_step_name(i));
    }
}

static void print_facts(const char *name, const hs_scene_data *data, const hs_scene_points *points,
                        const hs_scene_times *times) {
    size_t labels[3] = {0}, pixels = (size_t)data->full.nx * data->full.ny;
    for (size_t i = 0; i < pixels; i++) labels[data->label[i]]++;
    double found = points->right + points->wrong, rays = (double)points->width * points->height;
    hs_print(stdout,
             "%-10s %u x %u x %u in %.0f ms; rays: fetus %.1f %%, sac only %.1f %%; "
             "initial points on %.1f %% of the rays, %.0f %% of them right\n",
             name, data->full.nx, data->full.ny, data->full.nz, times->total_ms,
             100.0 * (double)labels[2] / (double)pixels, 100.0 * (double)labels[1] / (double)pixels,
             rays > 0.0 ? 100.0 * found / rays : 0.0, found > 0.0 ? 100.0 * points->right / found : 0.0);
}

static bool write_sheet(const request *r, const hs_scene *scene, const char *name, const hs_scene_data *data,
                        const hs_scene_points *points, const hs_cl *cl, hs_error *err) {
    char path[1024], file[128], title[640];
    hs_picture picture;
    snprintf(file, sizeof file, "%s_sheet.png", name);
    snprintf(title, sizeof title, "%s: %s", name, hs_scene_title(scene));
    if (!hs_path_join(r->out, file, path, sizeof path, err)) return false;
    if (!hs_scene_sheet(cl, &r->drawing, data, points, title, &picture, err)) return false;
    bool ok = hs_picture_save(&picture, path, err);
    hs_picture_free(&picture);
    return ok;
}

/* What --export asks for. A sequence of Kretz files has the scene's name, whatever the frame. */
static bool export_frame(const request *r, const hs_scene *scene, const char *prefix,
                         const hs_scene_data *data, hs_vol_export *files, hs_error *err) {
    char path[1024];
    if (!r->vol) return hs_scene_export(data, prefix, err);
    return hs_path_join(r->out, hs_scene_name(scene), path, sizeof path, err) &&
           hs_vol_export_frame(files, &r->geometry, path, r->frames, data, err);
}

static bool make_frame(const request *r, const hs_scene *scene, uint32_t frame, const hs_cl *cl,
                       hs_vol_export *files, hs_error *err) {
    hs_scene_options one = r->options;
    hs_scene_data data;
    hs_scene_times times;
    hs_scene_points points = {0};
    char name[96], prefix[1024];
    one.frame = frame;
    if (r->frames > 1)
        snprintf(name, sizeof name, "%s_f%03u", hs_scene_name(scene), frame);
    else
        snprintf(name, sizeof name, "%s", hs_scene_name(scene));
    if (!hs_path_join(r->out, name, prefix, sizeof prefix, err)) return false;
    if (!hs_scene_frame(scene, &one, &data, &times, err)) return false;
    bool ok = hs_scene_points_find(&data, &points, err);
    if (ok) print_facts(name, &data, &points, &times);
    if (ok && r->times) print_times(&times);
    if (ok && r->export) ok = export_frame(r, scene, prefix, &data, files, err);
    if (ok && r->sheet) ok = write_sheet(r, scene, name, &data, &points, cl, err);
    hs_scene_points_free(&points);
    hs_scene_free(&data);
    return ok;
}

static bool make_scene(const request *r, const char *name, const hs_cl *cl, hs_error *err) {
    hs_scene *scene = hs_scene_open(name, err);
    if (!scene) return false;
    bool ok = true;
    hs_vol_export files = {0};
    for (uint32_t frame = 0; ok && frame < r->frames; frame++)
        ok = make_frame(r, scene, frame, cl, &files, err);
    hs_vol_export_discard(&files);
    hs_scene_close(scene);
    return ok;
}

static bool make_scenes(const request *r, char **names, int count, hs_error *err) {
    hs_cl cl = {0};
    if ((r->export || r->sheet) && !hs_path_make_folder(r->out, err)) return false;
    bool ok = !r->sheet || hs_cl_open(&cl, err);
    for (int i = 0; ok && i < count; i++) ok = make_scene(r, names[i], &cl, err);
    for (uint32_t i = 0; ok && r->all && hs_scene_builtin(i); i++)
        if (strcmp(hs_scene_builtin(i), "real") != 0) ok = make_scene(r, hs_scene_builtin(i), &cl, err);
    hs_cl_close(&cl);
    if (ok && (r->export || r->sheet)) hs_print(stdout, "Files are in %s\n", r->out);
    return ok;
}

int hs_cmd_scene(int argc, char **argv) {
    request r;
    hs_error err = {0};
    if (!parse(argc, argv, &r, &err)) return hs_cli_fail("scenes", &err);
    if (r.help) {
        printf("%s%s%s%s", help_text, hs_vol_line_help, help_tail, hs_exit_codes_help);
        return HS_OK;
    }
    bool ok =
        r.all || optind < argc ? make_scenes(&r, argv + optind, argc - optind, &err) : list_scenes(&err);
    return ok ? HS_OK : hs_cli_fail("scenes", &err);
}
