/* SPDX-License-Identifier: MIT */
/* sv_sites: how good surfaces are on volumes that nobody tuned on, and what they do where nothing hides
 * (docs/surface.md). */
#include "base/cli.h"
#include "judge/site_flicker.h"
#include "judge/site_harm.h"
#include "judge/site_page.h"
#include "judge/site_reverse.h"
#include "judge/site_table.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: sv_sites COMMAND [options]\n"
    "Judges methods of a plugin on sites: scenes, and volumes of other programs with their truth.\n"
    "  table    every method on every site: error, cut, left, worst case, AUC and calibration of the "
    "confidence\n"
    "  reverse  the constants of wall chosen on one site alone, judged on the others\n"
    "  harm     bare cases, cases without a fetus, with a bladder; volumes that nothing hides, from 36 "
    "sides\n"
    "  flicker  what the renderings of four moving scenes, or of the frames given by --case, flicker beyond "
    "the\n"
    "           truth's\n"
    "  page     every case in pictures, with bare ones and views of the volumes, on one page\n"
    "Options, repeatable but the last four:\n"
    "  --scenes SEED,POSE  the nine scenes at 128^3 [201,0]\n"
    "  --scene NAME        one scene by name or file, at 128^3\n"
    "  --random SEED,COUNT the first random scenes of a set, at 128^3; all scenes together are one site\n"
    "  --site FOLDER       nine cases NAME_full.mha, NAME_truth.mha, NAME_label.mha, with scan_first.mha "
    "and\n"
    "                      scan_end.mha; every folder is a site\n"
    "  --case FILES        FULL,TRUTH,LABEL[,FIRST,END] as host_sim report takes them; all of them are one "
    "site\n"
    "  --volume FILE       harm, page: a volume that nothing hides, MetaImage\n"
    "  --method SETTINGS   'KEY=VALUE ...', or 'best KEY=VALUE ...' at its best single q\n"
    "                      [best method=mean; method=cost; method=wall];\n"
    "                      page: the last of them\n"
    "  --rounds N          reverse: rounds of the search at most, 1 .. 100 [4]\n"
    "  --plugin PATH       library to judge [the build's smartvis.so]\n"
    "  --out FOLDER        page: where it goes [out/sites]\n"
    "  --help              this text\n"
    "\n";

enum { MAX_VOLUMES = 16 };

typedef struct {
    const struct command *command;
    site_list sites;
    site_methods methods;
    const char *volumes[MAX_VOLUMES];
    uint32_t volume_count;
    uint32_t rounds;
    const char *out;
    bool help;
} request;

enum {
    OPT_SCENES = 256,
    OPT_SCENE,
    OPT_RANDOM,
    OPT_SITE,
    OPT_CASE,
    OPT_VOLUME,
    OPT_METHOD,
    OPT_ROUNDS,
    OPT_PLUGIN,
    OPT_OUT,
    OPT_HELP
};

static const struct option options[] = {
    {"scenes", required_argument, NULL, OPT_SCENES}, {"scene", required_argument, NULL, OPT_SCENE},
    {"random", required_argument, NULL, OPT_RANDOM}, {"site", required_argument, NULL, OPT_SITE},
    {"case", required_argument, NULL, OPT_CASE},     {"volume", required_argument, NULL, OPT_VOLUME},
    {"method", required_argument, NULL, OPT_METHOD}, {"rounds", required_argument, NULL, OPT_ROUNDS},
    {"plugin", required_argument, NULL, OPT_PLUGIN}, {"out", required_argument, NULL, OPT_OUT},
    {"help", no_argument, NULL, OPT_HELP},           {0}};

static bool add_method(const char *text, site_methods *m, hs_error *err) {
    static const char best[] = "best ";
    if (m->count == SITE_MAX_METHODS)
        return hs_fail(err, HS_ERR_USAGE, "--method: given more than %d times", SITE_MAX_METHODS);
    const bool best_q = strncmp(text, best, sizeof best - 1) == 0;
    m->method[m->count++] = (site_method){best_q ? text + sizeof best - 1 : text, best_q};
    return true;
}

static bool take(int option, request *r, hs_error *err) {
    switch (option) {
    case OPT_SCENES:
        return site_add_scenes(&r->sites, optarg, err);
    case OPT_SCENE:
        return site_add_scene(&r->sites, optarg, err);
    case OPT_RANDOM:
        return site_add_random(&r->sites, optarg, err);
    case OPT_SITE:
        return site_add_folder(&r->sites, optarg, err);
    case OPT_CASE:
        return site_add_files(&r->sites, optarg, err);
    case OPT_VOLUME:
        return hs_cli_append("--volume", optarg, r->volumes, &r->volume_count, MAX_VOLUMES, err);
    case OPT_METHOD:
        return add_method(optarg, &r->methods, err);
    case OPT_ROUNDS:
        return hs_cli_u32("--rounds", optarg, 1, 100, &r->rounds, err);
    case OPT_PLUGIN:
        r->methods.plugin = optarg;
        return true;
    case OPT_OUT:
        r->out = optarg;
        return true;
    default:
        r->help = true;
        return true;
    }
}

static bool table(const request *r, hs_error *err) {
    return site_table(&r->sites, &r->methods, err);
}

static bool reverse(const request *r, hs_error *err) {
    return site_reverse(&r->sites, r->rounds, err);
}

static bool harm(const request *r, hs_error *err) {
    return site_harm(&r->sites, r->volumes, r->volume_count, &r->methods, err);
}

static bool flicker(const request *r, hs_error *err) {
    return site_flicker(&r->sites, &r->methods, err);
}

static bool page(const request *r, hs_error *err) {
    const site_page page = {.sites = &r->sites,
                            .volumes = r->volumes,
                            .volume_count = r->volume_count,
                            .plugin = r->methods.plugin,
                            .settings = r->methods.method[r->methods.count - 1].settings,
                            .out = r->out};
    return site_page_write(&page, err);
}

static const struct command {
    const char *name;
    bool (*run)(const request *r, hs_error *err);
} commands[] = {{"table", table}, {"reverse", reverse}, {"harm", harm}, {"flicker", flicker}, {"page", page}};

static bool find_command(const char *name, request *r, hs_error *err) {
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(name, commands[i].name) == 0) r->command = &commands[i];
    return r->command ||
           hs_fail(err, HS_ERR_USAGE, "'%s' is no command: table, reverse, harm, flicker or page", name);
}

static bool parse(int argc, char **argv, request *r, hs_error *err) {
    *r = (request){.methods = {.plugin = SURF_PLUGIN}, .rounds = 4, .out = "out/sites"};
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", options, NULL)) != -1;)
        if (!hs_cli_known(option, argv, err) || !take(option, r, err)) return false;
    if (r->help) return true;
    if (optind + 1 != argc)
        return hs_fail(err, HS_ERR_USAGE, "expected one command, %d given", argc - optind);
    if (!find_command(argv[optind], r, err)) return false;
    if (r->methods.count == 0) r->methods = site_methods_default(r->methods.plugin);
    const bool all_given = r->sites.count > 0 || r->command->run == flicker;
    return all_given || site_add_scenes(&r->sites, "201,0", err);
}

int main(int argc, char **argv) {
    request r;
    hs_error err = {0};
    bool ok = parse(argc, argv, &r, &err);
    if (ok && r.help)
        printf("%s%s", help, hs_exit_codes_help);
    else if (ok)
        ok = r.command->run(&r, &err);
    site_free(&r.sites);
    if (!ok) fprintf(stderr, "sv_sites: %s\n", err.text);
    return ok ? HS_OK : (int)err.code;
}
