/* SPDX-License-Identifier: MIT */
#include "commands/scene_line.h"

#include "base/cli.h"
#include "commands/look_line.h"
#include "scene/scene_draw.h"
#include "scene/scene_export.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char vol_help[] =
    "  --vol KEY=VALUE,...  the geometry of Kretz files; what is not given fits the scene:\n"
    "                   pitch, start, axis (mm): samples, their start, and the sweep's axis, from the\n"
    "                   array's centre of curvature; theta, phi (degrees) from the first to the last line\n"
    "                   and plane; samples, lines, planes; skew 0 .. 0.9: uneven angles;\n"
    "                   descending 0 or 1; mirrored 0 or 1: to be read with --mirror\n";

/* What a spec is before any key: all is left open. */
static hs_vol_spec vol_line_defaults(void) {
    return (hs_vol_spec){.start = NAN, .axis = NAN};
}

static bool take(const char *key, const char *value, hs_vol_spec *s, hs_error *err) {
    const struct {
        const char *key;
        double low, high;
        double *number;
        uint32_t *count;
        bool *flag;
    } keys[] = {
        {"pitch", 0.01, 5.0, &s->pitch, NULL, NULL},     {"start", 0.0, 1000.0, &s->start, NULL, NULL},
        {"axis", -1000.0, 1000.0, &s->axis, NULL, NULL}, {"theta", 0.01, 179.0, &s->theta, NULL, NULL},
        {"phi", 0.01, 179.0, &s->phi, NULL, NULL},       {"skew", 0.0, 0.9, &s->skew, NULL, NULL},
        {"samples", 2, 2048, NULL, &s->samples, NULL},   {"lines", 2, 2048, NULL, &s->lines, NULL},
        {"planes", 2, 2048, NULL, &s->planes, NULL},     {"descending", 0, 1, NULL, NULL, &s->descending},
        {"mirrored", 0, 1, NULL, NULL, &s->mirrored},
    };
    char option[32], known[160] = "";
    (void)snprintf(option, sizeof option, "--vol %.20s", key);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        (void)strncat(known, i ? ", " : "", sizeof known - strlen(known) - 1);
        (void)strncat(known, keys[i].key, sizeof known - strlen(known) - 1);
        if (strcmp(key, keys[i].key) != 0) continue;
        if (keys[i].number)
            return hs_cli_number(option, value, keys[i].low, keys[i].high, keys[i].number, err);
        uint32_t count = 0;
        if (!hs_cli_u32(option, value, (uint32_t)keys[i].low, (uint32_t)keys[i].high, &count, err))
            return false;
        if (keys[i].count) *keys[i].count = count;
        if (keys[i].flag) *keys[i].flag = count == 1;
        return true;
    }
    return hs_fail(err, HS_ERR_USAGE, "--vol: '%.40s' is none of %s", key, known);
}

/* "KEY=VALUE,KEY=VALUE,...". HS_ERR_USAGE names the key and its value, or the keys there are. */
static bool vol_line_parse(const char *text, hs_vol_spec *spec, hs_error *err) {
    while (*text) {
        char pair[64];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof pair)
            return hs_fail(err, HS_ERR_USAGE, "--vol: '%.40s...', expected KEY=VALUE,KEY=VALUE", text);
        memcpy(pair, text, length);
        pair[length] = '\0';
        char *equals = strchr(pair, '=');
        if (!equals) return hs_fail(err, HS_ERR_USAGE, "--vol: '%s', expected KEY=VALUE", pair);
        *equals = '\0';
        if (!take(pair, equals + 1, spec, err)) return false;
        text += length + (text[length] == ',');
    }
    return true;
}

static const char help_text[] =
    "Usage: host_sim scenes [options] [NAME|FILE...]\n"
    "Generates synthetic scenes with their ground truth. Without a scene it lists the built-in ones.\n"
    "A scene is a built-in name (D01), the path of a scene file (docs/scenes.md), or R<seed>_<number>:\n"
    "a random scene, number 0 and on of the set with that seed.\n"
    "\n"
    "  --list           the built-in scenes, one line each\n"
    "  --all            the nine cases of the thesis\n"
    "  --hard           the hard cases, H01 and on\n"
    "  --random N       the first N scenes of a random set, 1 .. 100000; --seed is the set's (default 1)\n"
    "  --ranges         print what random scenes are drawn from, and no more\n"
    "  --set PATH=VALUE a field of the scene otherwise, repeatable: artefacts.haze=on, artefacts.fan=off,\n"
    "                   artefacts.haze.level_db=-12, structures[0].gap_mm=2\n"
    "  --size N         voxels per axis, 32 .. 512 (default 256)\n"
    "  --seed N         another seed than the scene's own: speckle, noise and particles change\n"
    "  --frames N       N frames of the scene's motion, 1 .. 1000 (default 1)\n"
    "  --threads N      threads, 1 .. 64 (default: one per processor); the bytes do not depend on it\n"
    "  --real FILE      the volume that the scene 'real' puts its occluders before\n"
    "  --json           write <name>.json, the scene as a file; on its own it makes no volume\n"
    "  --export         write <name>.json, _full.mha, _truth.mha, _label.mha, _near.mha and _far.mha\n"
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

enum {
    OPT_ALL = 1,
    OPT_HARD,
    OPT_LIST,
    OPT_RANDOM,
    OPT_RANGES,
    OPT_SET,
    OPT_JSON,
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
                                        {"hard", no_argument, NULL, OPT_HARD},
                                        {"list", no_argument, NULL, OPT_LIST},
                                        {"random", required_argument, NULL, OPT_RANDOM},
                                        {"ranges", no_argument, NULL, OPT_RANGES},
                                        {"set", required_argument, NULL, OPT_SET},
                                        {"json", no_argument, NULL, OPT_JSON},
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

static bool set_option(int option, hs_scene_line *r, hs_error *err) {
    switch (option) {
    case OPT_ALL:
        r->all = true;
        return true;
    case OPT_HARD:
        r->hard = true;
        return true;
    case OPT_LIST:
        r->list = true;
        return true;
    case OPT_RANDOM:
        return hs_cli_u32("--random", optarg, 1, HS_SCENE_MAX_DRAWN, &r->random, err);
    case OPT_RANGES:
        r->ranges = true;
        return true;
    case OPT_SET:
        if (r->set_count == HS_SCENE_LINE_SETS)
            return hs_fail(err, HS_ERR_USAGE, "--set: given more than %u times", HS_SCENE_LINE_SETS);
        r->sets[r->set_count++] = optarg;
        return true;
    case OPT_JSON:
        r->json = true;
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
        return vol_line_parse(optarg, &r->geometry, err);
    case OPT_SHEET:
        r->sheet = true;
        return true;
    case OPT_LOOK:
        return hs_look_line_look(&r->drawing.look, optarg, err);
    case OPT_LIGHT:
        return hs_look_line_light(r->drawing.light, optarg, err);
    case OPT_TIMES:
        r->times = true;
        return true;
    case OPT_OUT:
        r->out = optarg;
        return true;
    case OPT_HELP:
        r->help = true;
        return true;
    default:
        return hs_cli_forgotten(option, err);
    }
}

/* One way to name scenes, and the seed to whom it belongs. */
static bool check_choice(hs_scene_line *r, const char *named, hs_error *err) {
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

bool hs_scene_line_parse(int argc, char **argv, hs_scene_line *r, hs_error *err) {
    *r = (hs_scene_line){
        .out = "out/scenes", .options = {.size = 256}, .frames = 1, .geometry = vol_line_defaults()};
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
    return check_choice(r, argc > optind ? argv[optind] : NULL, err);
}

void hs_scene_line_help(void) {
    (void)printf("%s%s%s%s", help_text, vol_help, help_tail, hs_exit_codes_help);
}
