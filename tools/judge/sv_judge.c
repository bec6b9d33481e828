/* SPDX-License-Identifier: MIT */
/* sv_judge: how good surfaces are on volumes with a ground truth, and what they do where nothing hides
 * (docs/surface.md). */
#include "judge/judge.h"

#include "base/cli.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool judge_cases(judge_request *r, hs_error *err) {
    return site_table(&r->sites, &r->methods, err);
}

static bool choose_constants(judge_request *r, hs_error *err) {
    return site_reverse(&r->sites, r->rounds, err);
}

static bool judge_harm(judge_request *r, hs_error *err) {
    return site_harm(&r->sites, r->volumes, r->volume_count, &r->methods, err);
}

static bool judge_flicker(judge_request *r, hs_error *err) {
    return site_flicker(&r->sites, &r->methods, err);
}

static bool write_page(judge_request *r, hs_error *err) {
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
    bool (*run)(judge_request *r, hs_error *err);
    bool needs_cases; /* without any it gets the scenes 201,0 */
    const char *help;
} commands[] = {
    {"table", judge_cases, true,
     "every method on every site: error, cut, left, worst case, AUC and calibration of the confidence"},
    {"harm", judge_harm, true,
     "bare cases, cases without a fetus, with a bladder; volumes that nothing hides, from 36 sides"},
    {"flicker", judge_flicker, false,
     "what the renderings of four moving scenes, or of the frames given by --case, flicker beyond the "
     "truth's"},
    {"page", write_page, true,
     "every case in pictures, with bare ones and views of the volumes, on one page"},
    {"wall", judge_wall, false,
     "the definition of wall with any of its constants changed (--set); what it knows of a case"},
    {"reverse", choose_constants, true,
     "the constants of wall chosen on one site alone, judged on the others"},
    {"cost", judge_cost, false,
     "mean and cost on the nine scenes in eleven seeds and poses, and in motion; or cost on the volumes "
     "given"},
    {"ablation", judge_ablation, false,
     "what each part of the cost volume is worth, by its scalar definition"},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

/* -------------------------------------------------------------------------------------------- options -- */

static bool take_scenes(judge_request *r, const char *text, hs_error *err) {
    return site_add_scenes(&r->sites, text, err);
}

static bool take_scene(judge_request *r, const char *text, hs_error *err) {
    return site_add_scene(&r->sites, text, err);
}

static bool take_random(judge_request *r, const char *text, hs_error *err) {
    return site_add_random(&r->sites, text, err);
}

static bool take_site(judge_request *r, const char *text, hs_error *err) {
    return site_add_folder(&r->sites, text, err);
}

static bool take_case(judge_request *r, const char *text, hs_error *err) {
    return site_add_files(&r->sites, text, err);
}

static bool take_volume(judge_request *r, const char *text, hs_error *err) {
    return hs_cli_append("--volume", text, r->volumes, &r->volume_count, JUDGE_MAX_VOLUMES, err);
}

static bool take_method(judge_request *r, const char *text, hs_error *err) {
    static const char best[] = "best ";
    site_methods *const m = &r->methods;
    if (m->count == SITE_MAX_METHODS)
        return hs_fail(err, HS_ERR_USAGE, "--method: given more than %d times", SITE_MAX_METHODS);
    const bool best_q = strncmp(text, best, sizeof best - 1) == 0;
    m->method[m->count++] = (site_method){best_q ? text + sizeof best - 1 : text, best_q};
    return true;
}

static bool take_constant(judge_request *r, const char *text, hs_error *err) {
    return wall_change_set(&r->wall, text, err);
}

static bool take_tilt(judge_request *r, const char *text, hs_error *err) {
    int length = 0;
    double *const tilt = r->wall.tilt;
    const bool read = sscanf(text, "%lf,%lf%n", &tilt[0], &tilt[1], &length) == 2 && text[length] == '\0';
    return (read && fabs(tilt[0]) <= 45.0 && fabs(tilt[1]) <= 45.0) ||
           hs_fail(err, HS_ERR_USAGE, "--tilt: '%s' is no X,Y of -45 to 45 degrees", text);
}

static bool take_still(judge_request *r, const char *text, hs_error *err) {
    r->still = text;
    return site_seed_and_pose("--still", text, &r->still_seed, &r->still_pose, err);
}

static bool take_rounds(judge_request *r, const char *text, hs_error *err) {
    return hs_cli_u32("--rounds", text, 1, 100, &r->rounds, err);
}

static bool take_plugin(judge_request *r, const char *text, hs_error *err) {
    (void)err;
    r->methods.plugin = text;
    return true;
}

static bool take_out(judge_request *r, const char *text, hs_error *err) {
    (void)err;
    r->out = text;
    return true;
}

static bool take_help(judge_request *r, const char *text, hs_error *err) {
    (void)text;
    (void)err;
    r->help = true;
    return true;
}

static const struct {
    const char *name, *value;
    bool (*take)(judge_request *r, const char *text, hs_error *err);
    const char *help;
} options[] = {
    {"scenes", "SEED,POSE", take_scenes, "the nine scenes at 128^3 [201,0]"},
    {"scene", "NAME", take_scene,
     "one scene by name or file, at 128^3: H01, or R7_3, number 3 of the random set 7"},
    {"random", "SEED,COUNT", take_random,
     "the first random scenes of a set, at 128^3; all scenes together are one site"},
    {"site", "FOLDER", take_site,
     "nine cases NAME_full.mha, NAME_truth.mha, NAME_label.mha, with scan_first.mha and scan_end.mha"},
    {"case", "FILES", take_case,
     "FULL,TRUTH,LABEL[,FIRST,END] as host_sim report takes them; all are one site"},
    {"volume", "FILE", take_volume, "harm, page, wall, cost: a volume that nothing hides, MetaImage"},
    {"method", "SETTINGS", take_method,
     "'KEY=VALUE ...', or 'best KEY=VALUE ...' at its best single q [best method=mean; method=cost; "
     "method=wall]; "
     "page: the last of them"},
    {"set", "KEY=VALUE", take_constant,
     "wall: another value of a constant, a field of sv_wall_settings; or gain, gamma, black: change the grey "
     "levels first, the judgement is on the unchanged ones"},
    {"tilt", "X,Y", take_tilt, "wall: turn the camera by so many degrees about x and then y first"},
    {"still", "SEED,POSE", take_still,
     "wall: the nine scenes standing still, other speckle and particles in each of 8 frames: how much the "
     "ends of "
     "rays move"},
    {"rounds", "N", take_rounds, "reverse: rounds of the search at most, 1 .. 100 [4]"},
    {"plugin", "PATH", take_plugin, "library to judge [the build's smartvis.so]"},
    {"out", "FOLDER", take_out, "page: where it goes [out/sites]"},
    {"help", NULL, take_help, "this text"},
};
enum { OPTIONS = sizeof options / sizeof *options, FIRST_OPTION = 256 };

static void print_help(void) {
    printf("Usage: sv_judge COMMAND [options]\n"
           "Judges surfaces on sites: scenes, and volumes of other programs with their truth. Errors are in "
           "slices of\n"
           "128; cut: %% of the fetus' rays cut by more than 2 slices; left: %% of the labelled rays with an "
           "occluder.\n");
    for (size_t i = 0; i < COMMANDS; i++) printf("  %-9s %s\n", commands[i].name, commands[i].help);
    printf("Options; scenes, scene, random, site, case, volume, method and set are repeatable:\n");
    for (size_t i = 0; i < OPTIONS; i++)
        printf("  --%s %s\n      %s\n", options[i].name, options[i].value ? options[i].value : "",
               options[i].help);
    printf("\n%s", hs_exit_codes_help);
}

static bool find_command(const char *name, judge_request *r, hs_error *err) {
    char names[160] = "";
    for (size_t i = 0; i < COMMANDS; i++) {
        if (strcmp(name, commands[i].name) == 0) r->command = &commands[i];
        const size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", commands[i].name);
    }
    return r->command || hs_fail(err, HS_ERR_USAGE, "'%s' is no command: %s", name, names);
}

static bool parse(int argc, char **argv, judge_request *r, hs_error *err) {
    struct option known[OPTIONS + 1] = {{0}};
    for (int i = 0; i < OPTIONS; i++)
        known[i] = (struct option){options[i].name, options[i].value ? required_argument : no_argument, NULL,
                                   FIRST_OPTION + i};
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", known, NULL)) != -1;)
        if (!hs_cli_known(option, argv, err) || !options[option - FIRST_OPTION].take(r, optarg, err))
            return false;
    if (r->help) return true;
    if (optind + 1 != argc)
        return hs_fail(err, HS_ERR_USAGE, "expected one command, %d given", argc - optind);
    if (!find_command(argv[optind], r, err)) return false;
    if (r->methods.count == 0) r->methods = site_methods_default(r->methods.plugin);
    return r->sites.count > 0 || !r->command->needs_cases || site_add_scenes(&r->sites, "201,0", err);
}

int main(int argc, char **argv) {
    judge_request r = {
        .methods = {.plugin = SURF_PLUGIN}, .wall = wall_change_none(), .rounds = 4, .out = "out/sites"};
    hs_error err = {0};
    bool ok = parse(argc, argv, &r, &err);
    if (ok && r.help)
        print_help();
    else if (ok)
        ok = r.command->run(&r, &err);
    site_free(&r.sites);
    if (!ok) fprintf(stderr, "sv_judge: %s\n", err.text);
    return ok ? HS_OK : (int)err.code;
}
