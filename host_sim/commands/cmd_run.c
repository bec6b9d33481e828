/* SPDX-License-Identifier: MIT */
#include "commands/cmd_run.h"

#include "base/cli.h"
#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"
#include "commands/run_json.h"
#include "commands/run_line.h"
#include "commands/run_print.h"

/* Before the work starts: all of it would be lost. */
static bool can_write(const hs_run_line *line, hs_error *err) {
    if (!hs_path_make_folder(line->out, err)) return false;
    hs_output_file probe;
    if (!line->json) return true;
    if (!hs_output_open(&probe, line->json, err)) return false;
    hs_output_discard(&probe);
    return true;
}

/* Said early, since nothing after it looks as the user expects. */
static void report_plugin_error(const hs_run *run, bool *reported) {
    const hs_error *failure = hs_run_plugin_error(run);
    if (failure->code == HS_OK || *reported) return;
    hs_print(stderr, "host_sim run: %s\nhost_sim run: rendering unclipped\n", failure->text);
    *reported = true;
}

/* Once, at the end: the pictures are what they would be without it. */
static void report_confidence_error(const hs_run *run) {
    const hs_error *failure = hs_run_confidence_error(run);
    if (failure->code != HS_OK)
        hs_print(stderr, "host_sim run: %s\nhost_sim run: ghosting without the confidence map\n",
                 failure->text);
}

static bool run_loop(const hs_run_line *line, hs_code *plugin_code, hs_error *err) {
    hs_run run;
    bool reported = false;
    if (!hs_run_open(&run, &line->request, err)) return false;
    report_plugin_error(&run, &reported);
    bool ok = hs_run_measure(&run, err) && hs_run_pictures(&run, line->out, err) &&
              hs_run_write(&run, line->out, err);
    report_plugin_error(&run, &reported);
    report_confidence_error(&run);
    if (ok) {
        hs_run_print(&run, stdout);
        ok = !line->json || hs_run_write_json(&run, line->json, err);
    }
    *plugin_code = hs_run_plugin_error(&run)->code;
    hs_error ended = {0};
    if (!hs_run_close(&run, &ended) && *plugin_code == HS_OK) {
        hs_print(stderr, "host_sim run: %s\n", ended.text);
        *plugin_code = ended.code;
    }
    return ok;
}

int hs_cmd_run(int argc, char **argv) {
    hs_run_line line;
    hs_error err = {0};
    hs_code plugin_code = HS_OK;
    if (!hs_run_line_parse(argc, argv, &line, &err)) return hs_cli_fail("run", &err);
    if (line.help) {
        hs_run_line_help();
        return HS_OK;
    }
    if (!can_write(&line, &err) || !run_loop(&line, &plugin_code, &err)) return hs_cli_fail("run", &err);
    hs_print(stdout, "Pictures are in %s\n", line.out);
    return (int)plugin_code;
}
