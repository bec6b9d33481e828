/* SPDX-License-Identifier: MIT */
#include "report/report_line.h"

#include "base/cli.h"
#include "commands/look_line.h"

#include "guarded/guard_line.h"
#include "scene/scene_names.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const char help_text[] =
    "Usage: host_sim report [options]\n"
    "Measures a plugin over the nine cases and its whole parameter space (thesis, chapter 5), and writes\n"
    "CSV files, pictures and one page, index.html. A run that was ended goes on where it stopped.\n"
    "\n"
    "  --out DIR        folder for everything [out/report]\n"
    "  --case NAME      a built-in scene, a scene file, or files FULL,TRUTH,LABEL[,FIRST,END];\n"
    "                   the last two are every ray's first scanned slice and the first one behind the scan;\n"
    "                   repeatable [E01 .. E04, M01 .. M03, D01, D02]\n"
    "  --hard           the hard cases, H01 and on (docs/scenes.md); with --case those, too\n"
    "  --real FILE      the scene 'real' as a case: synthetic occluders before the volume in FILE\n"
    "  --size N         voxels per axis of the scenes, 32 .. 512 [384]\n"
    "  --lowres N       pixels per axis of the depthmap [a third of the size: 128]\n"
    "  --seed N         seed of the scenes; 0 is their own [0]\n"
    "  --plugin PATH    library to measure, a path or a name [smartvis]\n"
    "  --set KEY=VALUE  a plugin parameter; repeatable; see 'host_sim list'; a plugin that has the mean\n"
    "                   filter is studied with method=mean, as in the thesis, unless this names another\n"
    "  --beside 'KEY=VALUE ...'  another setting of the plugin that is set beside the studied one, or none\n"
    "                   [method=wall, if the plugin has it and --set names no method]\n"
    "  --coarse         every fifth position on every axis of the parameter space\n"
    "  --quick          small scenes (96), --coarse, few frames: to see what the page looks like\n"
    "  --frames N       frames of a measurement of speed; 0 measures none [20]\n"
    "  --check N        measures N settings the direct way, too; exit code 1 if they differ by 0.001 steps\n"
    "  --shard I/N      computes only every N-th setting, from the I-th (1 .. N) on; writes no page\n"
    "  --merge          computes nothing: puts the CSV files of all shards in --out together\n"
    "  --look NAME      how pictures are drawn: thesis or lit [lit]; measures always use thesis\n"
    "  --light AZ,EL    where the lamp of the lit look is, degrees from the viewer: right, up [-35,40]\n"
    "Comparison, instead of the parameter space:\n"
    "  --compare 'PATH [KEY=VALUE]...'  a plugin with its settings; repeatable; '-' is the default plugin\n"
    "  --seeds N        seeds of every scene, for the spread of the differences [3]\n"
    "%s"
    "  --help           this text\n"
    "\n";

enum {
    OPT_OUT = 256,
    OPT_CASE,
    OPT_HARD,
    OPT_REAL,
    OPT_SIZE,
    OPT_LOWRES,
    OPT_SEED,
    OPT_PLUGIN,
    OPT_SET,
    OPT_BESIDE,
    OPT_COARSE,
    OPT_QUICK,
    OPT_FRAMES,
    OPT_CHECK,
    OPT_SHARD,
    OPT_MERGE,
    OPT_LOOK,
    OPT_LIGHT,
    OPT_COMPARE,
    OPT_SEEDS,
    OPT_HELP
};

static const struct option options[] = {{"out", required_argument, NULL, OPT_OUT},
                                        {"case", required_argument, NULL, OPT_CASE},
                                        {"hard", no_argument, NULL, OPT_HARD},
                                        {"real", required_argument, NULL, OPT_REAL},
                                        {"size", required_argument, NULL, OPT_SIZE},
                                        {"lowres", required_argument, NULL, OPT_LOWRES},
                                        {"seed", required_argument, NULL, OPT_SEED},
                                        {"plugin", required_argument, NULL, OPT_PLUGIN},
                                        {"set", required_argument, NULL, OPT_SET},
                                        {"beside", required_argument, NULL, OPT_BESIDE},
                                        {"coarse", no_argument, NULL, OPT_COARSE},
                                        {"quick", no_argument, NULL, OPT_QUICK},
                                        {"frames", required_argument, NULL, OPT_FRAMES},
                                        {"check", required_argument, NULL, OPT_CHECK},
                                        {"shard", required_argument, NULL, OPT_SHARD},
                                        {"merge", no_argument, NULL, OPT_MERGE},
                                        {"look", required_argument, NULL, OPT_LOOK},
                                        {"light", required_argument, NULL, OPT_LIGHT},
                                        {"compare", required_argument, NULL, OPT_COMPARE},
                                        {"seeds", required_argument, NULL, OPT_SEEDS},
                                        HS_GUARD_OPTIONS,
                                        {"help", no_argument, NULL, OPT_HELP},
                                        {0}};

static bool append_group(const char *option, hs_scene_group group, hs_eval_options *o, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && hs_scene_of_group(group, i); i++)
        ok = hs_cli_append(option, hs_scene_of_group(group, i), o->cases, &o->case_count, HS_EVAL_MAX_CASES,
                           err);
    return ok;
}

/* "2/4": the second of four. */
static bool parse_shard(const char *text, hs_eval_shard *shard, hs_error *err) {
    unsigned index = 0, count = 0;
    int length = 0;
    if (sscanf(text, "%5u/%5u%n", &index, &count, &length) != 2 || text[length] != '\0' || index < 1 ||
        index > count)
        return hs_fail(err, HS_ERR_USAGE, "--shard: '%s' is not I/N with 1 <= I <= N", text);
    *shard = (hs_eval_shard){index - 1, count};
    return true;
}

static bool take(int option, hs_eval_options *o, bool *help, hs_error *err) {
    switch (option) {
    case OPT_OUT:
        o->out = optarg;
        return true;
    case OPT_CASE:
        return hs_cli_append("--case", optarg, o->cases, &o->case_count, HS_EVAL_MAX_CASES, err);
    case OPT_HARD:
        return append_group("--hard", HS_SCENES_HARD, o, err);
    case OPT_REAL:
        o->real = optarg;
        return hs_cli_append("--real", "real", o->cases, &o->case_count, HS_EVAL_MAX_CASES, err);
    case OPT_SIZE:
        return hs_cli_u32("--size", optarg, 32, 512, &o->size, err);
    case OPT_LOWRES:
        return hs_cli_u32("--lowres", optarg, 1, 512, &o->lowres, err);
    case OPT_SEED:
        return hs_cli_integer("--seed", optarg, 0, UINT64_MAX, &o->seed, err);
    case OPT_PLUGIN:
        o->plugin = optarg;
        return true;
    case OPT_SET:
        return hs_cli_append("--set", optarg, o->sets, &o->set_count, HS_EVAL_MAX_CASES, err);
    case OPT_BESIDE:
        o->beside = optarg;
        return true;
    case OPT_COARSE:
        o->coarse = true;
        return true;
    case OPT_QUICK:
        o->coarse = true;
        o->size = 96;
        o->frames = 3;
        return true;
    case OPT_FRAMES:
        return hs_cli_u32("--frames", optarg, 0, 10000, &o->frames, err);
    case OPT_CHECK:
        return hs_cli_u32("--check", optarg, 0, 1000000, &o->check, err);
    case OPT_SHARD:
        return parse_shard(optarg, &o->shard, err);
    case OPT_MERGE:
        o->merge = true;
        return true;
    case OPT_LOOK:
        return hs_look_line_look(optarg, &o->look, err);
    case OPT_LIGHT:
        return hs_look_line_light(optarg, o->light, err);
    case OPT_COMPARE:
        return hs_cli_append("--compare", optarg, o->compare, &o->compare_count, HS_EVAL_MAX_CASES, err);
    case OPT_SEEDS:
        return hs_cli_u32("--seeds", optarg, 1, 100, &o->seeds, err);
    default:
        *help = true;
        return true;
    }
}

bool hs_report_line_parse(int argc, char **argv, hs_eval_options *o, bool *help, hs_error *err) {
    *o = (hs_eval_options){.out = "out/report", .size = 384, .shard = {0, 1}, .frames = 20, .seeds = 3};
    hs_guard_defaults(&o->guard);
    hs_dvr_settings drawing;
    hs_dvr_defaults(&drawing);
    o->look = HS_LOOK_LIT;
    memcpy(o->light, drawing.light, sizeof o->light);
    *help = false;
    optind = 1;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", options, NULL)) != -1;) {
        if (!hs_cli_known(option, argv, err)) return false;
        if (hs_guard_line_is(option) ? !hs_guard_line_take(option, optarg, &o->guard, err)
                                     : !take(option, o, help, err))
            return false;
        if (*help) return true;
    }
    if (o->case_count == 0 && !append_group("the cases", HS_SCENES_THESIS, o, err)) return false;
    if (o->merge && o->shard.count > 1)
        return hs_fail(err, HS_ERR_USAGE, "--merge and --shard: the shards are computed first, then merged");
    return hs_cli_no_more(argc, argv, optind, err);
}

void hs_report_line_help(void) {
    (void)printf(help_text, hs_guard_line_help);
    (void)printf("%s", hs_exit_codes_help);
}
