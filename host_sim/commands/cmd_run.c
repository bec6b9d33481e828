/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "commands/run.h"
#include "commands/run_line.h"
#include "core/cli.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/paths.h"
#include "core/system.h"
#include "core/text.h"
#include "volume/fan_fit.h"

#include <errno.h>
#include <jansson.h>
#include <string.h>
#include <unistd.h>

/* Adds a member. A value that could not be made (no memory, a number that is not finite) fails the whole file
 * rather than being left out. */
static void put(json_t *object, const char *key, json_t *value, bool *ok) {
    if (json_object_set_new(object, key, value) != 0) *ok = false;
}

static json_t *stage_times(const hs_run *run, const hs_loop_result *r, bool *ok) {
    static const char *const keys[HS_STAGE_COUNT] = {"upload", "scan_conversion", "plugin", "dvr", "loop"};
    json_t *stages = json_object();
    for (int s = 0; s < HS_STAGE_COUNT; s++)
        if (hs_run_has_stage(run, r->setting, (hs_stage)s))
            put(stages, keys[s],
                json_pack("{s:f, s:f}", "median_ms", r->stage[s].median, "p95_ms", r->stage[s].p95), ok);
    return stages;
}

static json_t *plugin_part(const hs_loop_result *r, bool *ok) {
    const sv_stats *s = &r->stats;
    json_t *part =
        json_pack("{s:f, s:i, s:i, s:i, s:i, s:s, s:i}", "share", r->plugin_share, "clipped_frames",
                  (int)r->clipped_frames, "partial_frames", (int)r->partial_frames, "note_frames",
                  (int)r->note_frames, "failed_frames", (int)r->failed_frames, "outcome",
                  hs_status_name(r->outcome), "outcome_code", (int)r->outcome);
    put(part, "stats",
        json_pack("{s:I, s:I, s:I}", "rays", (json_int_t)s->rays, "points", (json_int_t)s->points, "unfilled",
                  (json_int_t)s->unfilled),
        ok);
    put(part, "doubtful_frames", json_integer(r->doubtful_frames), ok);
    const sv_points_report *p = &r->points;
    if (p->size > 0)
        put(part, "points",
            json_pack("{s:I, s:I, s:I, s:f, s:f}", "empty_points", (json_int_t)p->empty_points, "sure_points",
                      (json_int_t)p->sure_points, "passes", (json_int_t)p->passes, "volume_max",
                      (double)p->volume_max, "bone_threshold", (double)p->bone_threshold),
            ok);
    const sv_stage_times *t = &r->plugin_stages;
    if (r->has_plugin_stages)
        put(part, "stages_ms",
            json_pack("{s:f, s:f, s:f, s:f, s:f}", "transfer", t->transfer_ms, "profile", t->profile_ms,
                      "threshold", t->threshold_ms, "reconstruct", t->reconstruct_ms, "output", t->output_ms),
            ok);
    return part;
}

static json_t *vector(const double v[3]) {
    return json_pack("[f, f, f]", v[0], v[1], v[2]);
}

/* Lists the files of --write. */
static json_t *written_part(const hs_result_report *w, bool *ok) {
    json_t *part = json_object(), *what = json_array();
    for (uint32_t i = 0; i < HS_RESULT_COUNT; i++)
        if (w->what >> i & 1u && json_array_append_new(what, json_string(hs_result_name(i))) != 0)
            *ok = false;
    put(part, "what", what, ok);
    put(part, "volumes", json_integer(w->volumes), ok);
    put(part, "clipped_volumes", json_integer(w->clipped), ok);
    if (w->what & HS_RESULT_CLIPPED) put(part, "fill", json_real(w->fill), ok);
    return part;
}

static json_t *describe(const hs_run *run, bool *ok) {
    const hs_volume *v = hs_source_shape(&run->source);
    const hs_slab_layout *l = hs_loop_layout(run->loop);
    const hs_loop_options *o = hs_loop_get_options(run->loop);
    static const char *const carriers[] = {
        [SV_CARRIER_HOST] = "host", [SV_CARRIER_BUFFER] = "buffer", [SV_CARRIER_IMAGE] = "image"};
    const double size[3] = {v->nx * v->spacing[0], v->ny * v->spacing[1], v->nz * v->spacing[2]};
    hs_camera camera; /* its box is the same for all frames */
    hs_loop_camera(run->loop, 0, &camera);
    const double box[3] = {camera.extent, camera.extent, camera.depth_extent};
    const double lowres[3] = {box[0] / l->width, box[1] / l->height, box[2] / l->slices};
    char words[160], plugin[200], letters[4], doubt[HS_DOUBT_BYTES];
    hs_run_plugin_name(run, plugin, sizeof plugin);
    hs_pose_letters(&v->pose, letters);
    json_t *root = json_object();
    put(root, "source", hs_json_text(v->name), ok);
    put(root, "source_size", json_pack("[i, i, i]", (int)v->nx, (int)v->ny, (int)v->nz), ok);
    put(root, "source_spacing_mm", v->spacing_unsaid ? json_null() : vector(v->spacing), ok);
    put(root, "source_size_mm", v->spacing_unsaid ? json_null() : vector(size), ok);
    put(root, "doubt", hs_volume_doubt(v, doubt) ? json_string(doubt) : json_null(), ok);
    put(root, "source_origin_mm", vector(v->pose.origin), ok);
    put(root, "source_orientation", v->pose.stated ? json_string(letters) : json_null(), ok);
    put(root, "probe", hs_probe_is_known(v) ? json_string(hs_probe_name(v->probe)) : json_null(), ok);
    hs_course_words(v, words, sizeof words);
    put(root, "beams", json_string(words), ok);
    put(root, "unscanned_share", json_real(run->unscanned), ok);
    if (v->beams) put(root, "mirrored", json_boolean(v->beams->mirrored), ok);
    put(root, "plugin", hs_json_text(plugin), ok);
    put(root, "device", hs_json_text(run->cl.device_name), ok);
    put(root, "lowres_size", json_pack("[i, i, i]", (int)l->width, (int)l->height, (int)l->slices), ok);
    put(root, "lowres_spacing_mm", vector(lowres), ok);
    put(root, "box_mm", vector(box), ok);
    put(root, "slab_slices", json_integer(l->slab_slices), ok);
    put(root, "slab_mm", json_real(l->slab_slices * lowres[2]), ok);
    put(root, "carrier", json_string(carriers[o->carrier]), ok);
    put(root, "own_queue", json_boolean(o->own_queue), ok);
    put(root, "scanned", hs_json_text(hs_fan_name(o->fan)), ok);
    put(root, "camera",
        json_pack("{s:s, s:f, s:f, s:f, s:f}", "from", hs_from_name(o->from), "yaw", o->yaw, "pitch",
                  o->pitch, "roll", o->roll, "orbit", o->orbit),
        ok);
    const hs_crop *c = &run->source.crop;
    if (c->used)
        put(root, "render_box_mm",
            json_pack("[f, f, f, f, f, f]", c->low[0], c->low[1], c->low[2], c->high[0], c->high[1],
                      c->high[2]),
            ok);
    put(root, "picture", json_pack("[i, i]", (int)o->dvr.width, (int)o->dvr.height), ok);
    return root;
}

/* Writes facts, times, shares and statistics to `path`, which appears whole. HS_ERR_OUTPUT, HS_ERR_MEMORY. */
static bool hs_run_write_json(const hs_run *run, const char *path, hs_error *err) {
    bool ok = true;
    json_t *root = describe(run, &ok);
    json_t *settings = json_object();
    for (uint32_t i = 0; i < run->result_count; i++) {
        const hs_loop_result *r = &run->results[i];
        json_t *one =
            json_pack("{s:i, s:f}", "frames", (int)r->frames, "volumes_per_second", r->volumes_per_second);
        put(one, "stages", stage_times(run, r, &ok), &ok);
        if (r->setting == HS_SETTING_SMARTVIS) put(one, "plugin", plugin_part(r, &ok), &ok);
        put(settings, hs_setting_key(r->setting), one, &ok);
    }
    put(root, "settings", settings, &ok);
    const hs_error *failure = hs_run_plugin_error(run);
    if (run->has_written) put(root, "written", written_part(&run->written, &ok), &ok);
    const hs_result_difference *d = &run->difference;
    if (d->rays > 0)
        put(root, "reference",
            json_pack("{s:I, s:I, s:f, s:f}", "rays", (json_int_t)d->rays, "different",
                      (json_int_t)d->different, "tolerance_mm", d->tolerance, "largest_mm", d->largest),
            &ok);
    put(root, "plugin_error", failure->code == HS_OK ? json_null() : hs_json_text(failure->text), &ok);
    char *dump = !ok ? NULL : json_dumps(root, JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(9));
    json_decref(root);
    if (!dump)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: a result is no finite number, or memory ran out", path);
    hs_output_file output;
    ok = hs_output_open(&output, path, err);
    if (ok) (void)fprintf(output.file, "%s\n", dump);
    free(dump);
    return ok && hs_output_commit(&output, err); /* fails if the writing did */
}

static bool can_be_read(const char *path) {
    const int file = sys_open(path, SYS_READ);
    return file >= 0 && close(file) == 0;
}

/* Before the work starts: all of it would be lost. */
static bool files_at_hand(const hs_run_line *line, hs_error *err) {
    const char *reference = line->request.reference;
    if (reference && !can_be_read(reference))
        return hs_fail(err, HS_ERR_INPUT, "--reference %s: cannot be read: %s", reference, strerror(errno));
    char plugin[SYS_PATH]; /* a name that was mistyped: thirty frames without it tell nothing */
    if (line->request.plugin_path) {
        hs_plugin_find(line->request.plugin_path, plugin, sizeof plugin);
        if (!can_be_read(plugin))
            return hs_fail(err, HS_ERR_PLUGIN, "%s: cannot read the plugin file: %s", plugin,
                           strerror(errno));
    }
    return hs_path_make_folder(line->out, err) && hs_output_try(line->json, err);
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

static bool run_loop(const hs_run_line *line, hs_code *code, hs_error *err) {
    hs_run run;
    bool reported = false;
    hs_run_request request = line->request;
    request.alone = true;
    if (!hs_run_open(&run, &request, err)) return false;
    report_plugin_error(&run, &reported);
    bool ok = hs_run_measure(&run, err) && hs_run_pictures(&run, line->out, err) &&
              hs_run_write(&run, line->out, err);
    report_plugin_error(&run, &reported);
    report_confidence_error(&run);
    if (ok) {
        hs_run_print(&run, stdout);
        ok = !line->json || hs_run_write_json(&run, line->json, err);
    }
    *code = hs_run_plugin_error(&run)->code;
    if (*code == HS_OK && run.difference.different > 0) *code = HS_ERR_FAILED;
    hs_error ended = {0};
    if (!hs_run_close(&run, &ended) && *code == HS_OK) {
        hs_print(stderr, "host_sim run: %s\n", ended.text);
        *code = ended.code;
    }
    return ok;
}

int hs_cmd_run(int argc, char **argv) {
    hs_run_line line;
    hs_error err = {0};
    hs_code code = HS_OK;
    if (!hs_run_line_parse(argc, argv, &line, &err)) return hs_cli_fail("run", &err);
    if (line.help) return hs_run_line_help();
    if (!files_at_hand(&line, &err) || !run_loop(&line, &code, &err)) return hs_cli_fail("run", &err);
    hs_print(stdout, "Pictures are in %s\n", line.out);
    return (int)code;
}
