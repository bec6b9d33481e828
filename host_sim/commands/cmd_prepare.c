/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "commands/run_line.h"
#include "core/cli.h"
#include "core/text.h"
#include "smartvis/author_kept.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { MOST_ARGUMENTS = 200 };

static const char usage[] =
    "Usage: host_sim prepare [--fresh] [options of run, but for what is looked at]\n"
    "Runs one small frame, so that the kernels of host and plugin are compiled when a real one comes.\n\n"
    "  --fresh        empties the kernel caches first, PoCL's and SmartVis': a damaged one of PoCL's\n"
    "                 ends whoever reads it. No other program may be using it\n"
    "  --set K=V, --plugin FILE, --guard, ...: as 'host_sim run --help' says. Each method has kernels of\n"
    "                 its own (--set method=mean)\n\n";

/* Removes a file, a link or a whole folder, into which no link is followed. */
static bool erase(const char *path) {
    char inside[SVA_CACHE_PATH * 2];
    if (remove(path) == 0) return true;
    DIR *folder = opendir(path);
    bool ok = folder != NULL;
    for (const struct dirent *entry; ok && (entry = readdir(folder)) != NULL;) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        const int length = snprintf(inside, sizeof inside, "%s/%s", path, entry->d_name);
        ok = length > 0 && (size_t)length < sizeof inside && erase(inside);
    }
    if (folder) (void)closedir(folder);
    return ok && remove(path) == 0;
}

/* PoCL's own entries: folders of two letters from A to P, and files on their way; and what we say of them. */
static bool is_pocls(const char *name) {
    static const char letters[] = "ABCDEFGHIJKLMNOP";
    return (strlen(name) == 2 && strspn(name, letters) == 2) || strncmp(name, "tempfile", 8) == 0 ||
           strcmp(name, "smartvis") == 0;
}

/* Whatever else lies in the folder stays. One that is not there is empty. */
static bool empty_cache(const char *path, hs_error *err) {
    char inside[SVA_CACHE_PATH * 2];
    DIR *folder = opendir(path);
    if (!folder)
        return errno == ENOENT ||
               hs_fail(err, HS_ERR_DEVICE, "--fresh: %s: cannot be read: %s", path, strerror(errno));
    bool ok = true;
    for (const struct dirent *entry; ok && (entry = readdir(folder)) != NULL;) {
        if (!is_pocls(entry->d_name)) continue;
        (void)snprintf(inside, sizeof inside, "%s/%s", path, entry->d_name);
        ok = erase(inside) ||
             hs_fail(err, HS_ERR_DEVICE, "--fresh: %s: cannot be removed: %s", inside, strerror(errno));
    }
    (void)closedir(folder);
    return ok;
}

/* A run of one small frame, which nobody sees. */
static bool compile(int argc, char **argv, hs_code *code, hs_error *err) {
    hs_run_line line;
    hs_run run;
    if (!hs_run_line_parse(argc, argv, &line, err)) return false;
    memset(line.request.settings, 0, sizeof line.request.settings);
    line.request.settings[HS_SETTING_SMARTVIS] = true;
    if (!hs_run_open(&run, &line.request, err)) return false;
    const bool ok = hs_run_measure(&run, err);
    const hs_error *failure = hs_run_plugin_error(&run);
    *code = failure->code;
    if (failure->code != HS_OK) hs_print(stderr, "host_sim prepare: %s\n", failure->text);
    if (ok) hs_print(stdout, "Compiled for %s\n", run.cl.device_name);
    hs_error ended = {0};
    if (!hs_run_close(&run, &ended) && *code == HS_OK) *code = ended.code;
    return ok;
}

int hs_cmd_prepare(int argc, char **argv) {
    static char *frame[] = {"run", "--scene", "E01", "--size", "64", "--frames", "1"};
    char *arguments[MOST_ARGUMENTS + sizeof frame / sizeof *frame + 1], cache[SVA_CACHE_PATH];
    int count = (int)(sizeof frame / sizeof *frame);
    hs_code code = HS_OK;
    hs_error err = {0};
    bool fresh = false;
    memcpy(arguments, frame, sizeof frame);
    for (int i = 1; i < argc && i < MOST_ARGUMENTS; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            hs_print(stdout, "%s%s", usage, hs_exit_codes_help);
            return HS_OK;
        }
        if (strcmp(argv[i], "--fresh") == 0)
            fresh = true;
        else
            arguments[count++] = argv[i];
    }
    arguments[count] = NULL;
    const bool named = sva_cache_folder(cache, sizeof cache);
    if (fresh) sva_kept_empty();
    const bool ok = (!fresh || !named || empty_cache(cache, &err)) && compile(count, arguments, &code, &err);
    return ok ? (int)code : hs_cli_fail("prepare", &err);
}
