/* SPDX-License-Identifier: MIT */
/* host_sim: the simulated ultrasound machine. Dispatches to a subcommand. */
#include "commands/commands.h"
#include "console/console.h"
#include "core/cli.h"
#include "core/system.h"
#include "core/text.h"
#include "guard/child.h"
#include "guarded/guard_block.h"
#include "guarded/guard_options.h"
#include "picture/picture_draw.h"
#include "report/report.h"
#include "report/verify.h"
#include "smartvis_plugin.h"
#include "sv_version.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *what;
} command;

static const command commands[] = {
    {"run", hs_cmd_run, "the scan loop on a volume or a scene: times, statistics, pictures"},
    {"console", hs_cmd_console, "the scan loop live, on a web page of this machine"},
    {"demo", hs_cmd_demo, "the scan loop on a few scenes, with one page of pictures and numbers"},
    {"report", hs_cmd_report, "quality and speed over all cases and the whole parameter space, with a page"},
    {"measure", hs_cmd_measure, "quality of depthmaps that were made elsewhere, on one case, as JSON"},
    {"scenes", hs_cmd_scene, "synthetic scenes with ground truth: list, generate, export, look at"},
    {"list", hs_cmd_list, "a plugin library's plugins and parameters"},
    {"prepare", hs_cmd_prepare, "compiles the kernels ahead, anew if asked, into the runtime's cache"},
    {"verify", hs_cmd_verify,
     "this installation on this machine: files, device, a known frame, times; a page"},
    {"info", hs_cmd_info, "facts about MetaImage and Kretz volumes"},
};

static void print_help(FILE *out) {
    (void)fprintf(
        out,
        "Usage: host_sim COMMAND [options]\n"
        "Simulates the ultrasound machine around a SmartVis plugin. For research, not a medical device.\n\n");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        (void)fprintf(out, "  %-8s %s\n", commands[i].name, commands[i].what);
    (void)fprintf(
        out,
        "\n'host_sim COMMAND --help' tells all options of a command, 'host_sim --version' the versions.\n"
        "\n"
        "Environment:\n"
        "  SMARTVIS_DEVICE       cpu or gpu: narrows the choice of the OpenCL device\n"
        "  SMARTVIS_KERNEL_CACHE folder of compiled kernels, where the OpenCL runtime keeps none\n"
        "                        [smartvis/kernels in $XDG_CACHE_HOME or ~/.cache]; empty: none are kept\n"
        "  SMARTVIS_QUICK_KERNELS 1: kernels are compiled without optimisation, if they never were with it\n"
        "                        [run: 1 for a few frames]; empty: with it\n"
        "  SMARTVIS_PLUGIN_PATH  folders, parted by '%s', in which a plugin is looked for by its name; "
        "behind\n"
        "                        them ../lib/smartvis beside the folder of host_sim",
        sys_list_separator);
    for (size_t i = 0; sys_plugin_folders[i]; i++) (void)fprintf(out, ", %s", sys_plugin_folders[i]);
    (void)fprintf(
        out,
        "\n"
        "  SMARTVIS_SCENES       folder of the built-in scenes [share/smartvis/scenes beside host_sim "
        "or\n"
        "                        beside its folder]\n\n%s",
        hs_exit_codes_help);
}

static void print_version(void) {
    (void)printf("host_sim %s, SmartVis plugin ABI %u.%u\n", SV_VERSION, (unsigned)SV_ABI_MAJOR,
                 (unsigned)SV_ABI_MINOR);
}

static int run(int argc, char **argv) {
    if (argc < 2) {
        print_help(stderr);
        return HS_ERR_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return HS_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        print_version();
        return HS_OK;
    }
    if (strcmp(argv[1], HS_GUARD_COMMAND) == 0) return hs_guard_serve();
    hs_guard_set_program(NULL);
    hs_picture_software("SmartVis " SV_VERSION);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        if (strcmp(argv[1], commands[i].name) == 0) {
            const int code = commands[i].run(argc - 1, argv + 1);
            hs_picture_finish();
            return code;
        }
    hs_print(stderr, "host_sim: '%s' is no command\nTry 'host_sim --help'.\n", argv[1]);
    return HS_ERR_USAGE;
}

/* PoCL and LLVM leave by exit(1), abort or a fault where they cannot compile, a plugin without a guard as it
 * likes. */
static const char last_words[] =
    "\nhost_sim: a library ended it: the plugin, if it has no guard, or the OpenCL runtime's "
    "compiler.\n'host_sim prepare "
    "--fresh' empties the kernel caches and compiles anew; "
    "docs/troubleshooting.md says what else there is.\n";

int main(int argc, char **argv) {
    argv = sys_arguments(&argc, argv);
    if (!hs_child_take(&argc, argv)) sys_last_words(last_words, HS_ERR_DEVICE);
    const int code = hs_cli_finish("host_sim", run(argc, argv));
    sys_last_words(NULL, 0);
    return code;
}
