/* SPDX-License-Identifier: MIT */
/* sv_judge: how good surfaces are on volumes with a ground truth, and what they do where nothing hides
 * (docs/surface.md). */
#include "judge/judge.h"

#include "core/cli.h"
#include "core/options.h"
#include "core/system.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool judge_cases(judge_request *r, hs_error *err) {
    return site_table(&r->sites, &r->methods, err);
}

static bool judge_harm(judge_request *r, hs_error *err) {
    return site_harm(&r->sites, r->volumes, r->volume_count, &r->methods, err);
}

static bool judge_scans(judge_request *r, hs_error *err) {
    return site_scans(&r->sites, r->volumes, r->volume_count, &r->methods, err);
}

static bool judge_marks(judge_request *r, hs_error *err) {
    return site_marks(&r->sites, r->volumes, r->volume_count, &r->methods, err);
}

static bool judge_flicker(judge_request *r, hs_error *err) {
    return site_flicker(&r->sites, &r->methods, err);
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
    {"scans", judge_scans, false,
     "verdict, error, cut, left of every set and of volumes from all sides, with beams told, the pose alone, "
     "nothing"},
    {"marks", judge_marks, false,
     "error, cut, left after 0, 1, 3 and 6 marks of a user who knows the truth; volumes from nine views"},
    {"flicker", judge_flicker, false,
     "what the renderings of four moving scenes, or of the frames given by --case, flicker beyond the "
     "truth's"},
    {"wall", judge_wall, false,
     "the definition of wall with any of its constants changed (--set); what it knows of a case"},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

/* -------------------------------------------------------------------------------------------- options -- */

static bool take_scenes(void *r, const char *text, hs_error *err) {
    return site_add_scenes(&((judge_request *)r)->sites, text, err);
}

static bool take_scene(void *r, const char *text, hs_error *err) {
    return site_add_scene(&((judge_request *)r)->sites, text, err);
}

static bool take_random(void *r, const char *text, hs_error *err) {
    return site_add_random(&((judge_request *)r)->sites, 'R', text, err);
}

static bool take_greys(void *r, const char *text, hs_error *err) {
    return site_add_random(&((judge_request *)r)->sites, 'G', text, err);
}

static bool take_site(void *r, const char *text, hs_error *err) {
    return site_add_folder(&((judge_request *)r)->sites, text, err);
}

static bool take_case(void *r, const char *text, hs_error *err) {
    return site_add_files(&((judge_request *)r)->sites, text, err);
}

static bool take_volume(void *all, const char *text, hs_error *err) {
    judge_request *const r = all;
    return hs_cli_append("--volume", text, r->volumes, &r->volume_count, JUDGE_MAX_VOLUMES, err);
}

static bool take_method(void *all, const char *text, hs_error *err) {
    judge_request *const r = all;
    static const char best[] = "best ";
    site_methods *const m = &r->methods;
    if (m->count == SITE_MAX_METHODS)
        return hs_fail(err, HS_ERR_USAGE, "--method: given more than %d times", SITE_MAX_METHODS);
    const bool best_q = strncmp(text, best, sizeof best - 1) == 0;
    m->method[m->count++] = (site_method){best_q ? text + sizeof best - 1 : text, best_q};
    return true;
}

static bool take_constant(void *r, const char *text, hs_error *err) {
    return wall_change_set(&((judge_request *)r)->wall, text, err);
}

static bool take_tilt(void *all, const char *text, hs_error *err) {
    judge_request *const r = all;
    int length = 0;
    double *const tilt = r->wall.tilt;
    const bool read = sscanf(text, "%lf,%lf%n", &tilt[0], &tilt[1], &length) == 2 && text[length] == '\0';
    return (read && fabs(tilt[0]) <= 45.0 && fabs(tilt[1]) <= 45.0) ||
           hs_fail(err, HS_ERR_USAGE, "--tilt: '%s' is no X,Y of -45 to 45 degrees", text);
}

#define AT(field) offsetof(judge_request, field)
static const hs_option options[] = {
    HS_TAKEN("scenes", "SEED,POSE", 0, take_scenes, "the nine scenes at 128^3 [201,0]"),
    HS_TAKEN("scene", "NAME", 0, take_scene,
             "one scene by name or file, at 128^3: H01, or R7_3, number 3 of the random set 7"),
    HS_TAKEN("random", "SEED,COUNT", 0, take_random,
             "the first random scenes of a set, at 128^3; all scenes together are one site"),
    HS_TAKEN("greys", "SEED,COUNT", 0, take_greys,
             "the same scenes in random greys, an echo of its own for every tissue but fluid"),
    HS_TAKEN(
        "site", "FOLDER", 0, take_site,
        "every NAME_full.mha there, with NAME_truth, NAME_label, NAME_first and NAME_end.mha, or scan_first\n"
        "and scan_end.mha for all"),
    HS_TAKEN("case", "FILES", 0, take_case,
             "FULL,TRUTH,LABEL[,FIRST,END] as host_sim report takes them; all are one site"),
    HS_TAKEN("volume", "FILE", 0, take_volume,
             "harm, scans: a volume that nothing hides, MetaImage; scans, marks: one with FILE_label.mha "
             "beside it;\nwall: its verdict"),
    HS_TAKEN("method", "SETTINGS", 0, take_method,
             "'KEY=VALUE ...', or 'best KEY=VALUE ...' at its best single q\n"
             "[best method=mean; method=wall]"),
    HS_TAKEN("set", "KEY=VALUE", 0, take_constant,
             "wall: another value of a constant, a field of sv_wall_settings; or gain, gamma, black:\n"
             "change the grey levels first, the judgement is on the unchanged ones; near_slices,\n"
             "near_gain, near_black: so many first scanned slices only; beams=1: tell the beams"),
    HS_TAKEN("tilt", "X,Y", 0, take_tilt,
             "wall: turn the camera by so many degrees about x and then y first"),
    HS_TEXT("plugin", "PATH", AT(methods.plugin), "library to judge [the build's smartvis.so]"),
    HS_OPTIONS_END,
};

static void print_help(void) {
    printf("Usage: sv_judge COMMAND [options]\n"
           "Judges surfaces on sites: scenes, and volumes of other programs with their truth. Errors are in "
           "slices of\n"
           "128; cut: %% of the fetus' rays cut by more than 2 slices; left: %% of the labelled rays with an "
           "occluder.\n");
    for (size_t i = 0; i < COMMANDS; i++) printf("  %-9s %s\n", commands[i].name, commands[i].help);
    printf("Options; scenes, scene, random, greys, site, case, volume, method and set are repeatable:\n");
    hs_options_print(options);
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
    int next = argc;
    if (!hs_options_read(argc, argv, options, r, &next, &r->help, err)) return false;
    if (r->help) return true;
    if (next + 1 != argc) return hs_fail(err, HS_ERR_USAGE, "expected one command, %d given", argc - next);
    if (!find_command(argv[next], r, err)) return false;
    if (r->methods.count == 0 && (r->command->run == judge_scans || r->command->run == judge_marks))
        r->methods.method[r->methods.count++] = (site_method){.settings = "method=wall"};
    if (r->methods.count == 0) r->methods = site_methods_default(r->methods.plugin);
    return r->sites.count > 0 || !r->command->needs_cases || site_add_scenes(&r->sites, "201,0", err);
}

int main(int argc, char **argv) {
    judge_request r = {.methods = {.plugin = SURF_PLUGIN}, .wall = wall_change_none()};
    hs_error err = {0};
    argv = sys_arguments(&argc, argv);
    bool ok = parse(argc, argv, &r, &err);
    if (ok && r.help)
        print_help();
    else if (ok)
        ok = r.command->run(&r, &err);
    site_free(&r.sites);
    if (!ok) fprintf(stderr, "sv_judge: %s\n", err.text);
    return hs_cli_finish("sv_judge", ok ? HS_OK : (int)err.code);
}
