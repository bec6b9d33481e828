/* SPDX-License-Identifier: MIT */
#include "commands/run.h"

#include "core/text.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"
#include "render/camera.h"
#include "volume/fan_fit.h"

#define COLUMN 24 /* characters of a setting's column */

static const char *carrier_name(uint32_t carrier) {
    return carrier == SV_CARRIER_HOST     ? "host memory"
           : carrier == SV_CARRIER_BUFFER ? "OpenCL buffer"
                                          : "OpenCL image";
}

/* How the beams ran, and what nobody knows about it. */
static void print_beams(const hs_volume *v, FILE *out) {
    char words[160], question[160];
    hs_course_words(v, words, sizeof words);
    hs_course_question(v, question, sizeof question);
    (void)fprintf(out, "Beams    %s\n", words);
    if (question[0]) (void)fprintf(out, "         %s\n", question);
}

static void print_facts(const hs_run *run, FILE *out) {
    const hs_volume *v = hs_source_shape(&run->source);
    const hs_loop_options *o = hs_loop_get_options(run->loop); /* as the plugin takes them */
    const hs_slab_layout *l = hs_loop_layout(run->loop);
    char plugin[200];
    hs_run_plugin_name(run, plugin, sizeof plugin);
    char size[HS_SIZE_BYTES], doubt[HS_DOUBT_BYTES];
    hs_volume_size_words(v, size);
    hs_print(out, "Source   %s: %s, %.1f %% not scanned", v->name, size, 100 * run->unscanned);
    if (v->beams) (void)fprintf(out, "; %s", hs_beams_side_name(v->beams));
    if (run->source.count > 1) (void)fprintf(out, "; %u volumes in turn", run->source.count);
    if (run->source.left_out > 0)
        (void)fprintf(out, "; %u left out: their ImageStatus is INVALID", run->source.left_out);
    if (hs_volume_doubt(v, doubt)) hs_print(out, "\n         %s", doubt);
    hs_print(out, "\nPlugin   %s (%s)\n", plugin, run->plugin_path);
    hs_print(out, "Device   %s; the plugin uses %s\n", run->cl.device_name,
             o->own_queue ? "a queue of its own" : "the host's queue");
    if (v->pose.stated) {
        char words[200], mark[64];
        hs_camera camera;
        hs_pose_words(&v->pose, words, sizeof words);
        hs_loop_camera(run->loop, o->frames / 2, &camera);
        hs_camera_mark(&camera, v, mark, sizeof mark);
        hs_print(out, "Patient  %s; in the pictures: %s\n", words, mark);
    }
    if (hs_pose_doubt(&v->pose, doubt)) hs_print(out, "         %s\n", doubt);
    (void)fprintf(out, "Camera   from %s%s, yaw %g, pitch %g, orbit %g degrees; picture %u x %u\n",
                  o->from == HS_FROM_PROBE && hs_probe_is_known(v) ? "the probe at " : "",
                  o->from == HS_FROM_PROBE ? hs_probe_name(v->probe) : hs_from_name(o->from), o->yaw,
                  o->pitch, o->orbit, o->dvr.width, o->dvr.height);
    print_beams(v, out);
    (void)fprintf(out, "Slabs    %u x %u x %u voxels in %u slabs of %u slices, %s\n", l->width, l->height,
                  l->slices, hs_slab_count(l), l->slab_slices, carrier_name(o->carrier));
    if (run->has_plugin) (void)fprintf(out, "Scanned  told by %s\n", hs_fan_name(o->fan));
    if (run->cl.quick)
        (void)fprintf(out,
                      "Kernels  compiled without optimisation, which takes longer than so few frames: times "
                      "are some five times as long\n         ('host_sim prepare' optimises)\n");
    (void)fprintf(out, "Frames   %u a setting, after one that is not counted\n\n", o->frames);
}

static void print_headings(const hs_run *run, bool colour, FILE *out) {
    static const char *const names[HS_SETTING_COUNT] = {"DVR", "+ scan conversion", "+ plugin"};
    (void)fprintf(out, "%s%-26s", colour ? "\033[1m" : "", "Time of a stage [ms]");
    for (uint32_t i = 0; i < run->result_count; i++)
        (void)fprintf(out, "%*s", COLUMN, names[run->results[i].setting]);
    (void)fprintf(out, "%s\n%-26s", colour ? "\033[0m" : "", "");
    for (uint32_t i = 0; i < run->result_count; i++)
        (void)fprintf(out, "%*s%10s", COLUMN - 10, "median", "p95");
    (void)fprintf(out, "\n");
}

static bool any_has_stage(const hs_run *run, hs_stage stage) {
    for (uint32_t i = 0; i < run->result_count; i++)
        if (hs_run_has_stage(run, run->results[i].setting, stage)) return true;
    return false;
}

static void print_times(const hs_run *run, FILE *out) {
    for (int s = 0; s < HS_STAGE_COUNT; s++) {
        if (!any_has_stage(run, (hs_stage)s)) continue;
        (void)fprintf(out, "%-26s", hs_stage_label((hs_stage)s));
        for (uint32_t i = 0; i < run->result_count; i++) {
            const hs_loop_result *r = &run->results[i];
            if (hs_run_has_stage(run, r->setting, (hs_stage)s))
                (void)fprintf(out, "%*.2f%10.2f", COLUMN - 10, r->stage[s].median, r->stage[s].p95);
            else
                (void)fprintf(out, "%*s%10s", COLUMN - 10, "-", "-");
        }
        (void)fprintf(out, "\n");
    }
    (void)fprintf(out, "%-26s", "volumes a second");
    for (uint32_t i = 0; i < run->result_count; i++)
        (void)fprintf(out, "%*.1f%10s", COLUMN - 10, run->results[i].volumes_per_second, "");
    (void)fprintf(out, "\n%-26s", "plugin's share of a frame");
    for (uint32_t i = 0; i < run->result_count; i++) {
        if (run->results[i].setting == HS_SETTING_SMARTVIS)
            (void)fprintf(out, "%*.1f %%%8s", COLUMN - 12 + 2, 100 * run->results[i].plugin_share, "");
        else
            (void)fprintf(out, "%*s%10s", COLUMN - 10, "-", "");
    }
    (void)fprintf(out, "\n\n");
}

/* Which of the plugin's rules removed nothing, and the setting that does all the same, if there is one. */
static void print_reason(const hs_run *run, FILE *out) {
    char words[HS_REASON_BYTES];
    sv_confidence_report report;
    sv_param_info info;
    char doubt[HS_DOUBT_BYTES];
    if (hs_volume_doubt(hs_source_shape(&run->source), doubt)) {
        hs_print(out, "Why: %s\n", doubt);
        return;
    }
    if (!hs_plugin_reason(run->plugin.instance, &report, words)) return;
    hs_print(out, "Why: %s\n", words);
    for (uint32_t i = 0; report.try_id != 0 && i < hs_plugin_param_count(&run->plugin); i++) {
        const sv_plugin *p = run->plugin.instance;
        char value[64];
        info = (sv_param_info){.size = sizeof info};
        if (p->param_info(p, i, &info) == SV_OK && info.id == report.try_id &&
            p->param_text(p, info.id, (double)report.try_value, value, sizeof value) == SV_OK)
            hs_print(out, "Try: --set %s=%s\n", info.key, value);
    }
}

static void print_plugin(const hs_run *run, const hs_loop_result *r, FILE *out) {
    const sv_stage_times *t = &r->plugin_stages;
    if (r->has_plugin_stages)
        (void)fprintf(out,
                      "Plugin by its own clock [ms]: "
                      "transfer %.3f, ray profiles %.3f, threshold %.3f, surface %.3f, output %.3f\n",
                      t->transfer_ms, t->profile_ms, t->threshold_ms, t->reconstruct_ms, t->output_ms);
    (void)fprintf(out, "Frames: %u clipped", r->clipped_frames);
    if (r->partial_frames > 0) (void)fprintf(out, ", %u of them in part", r->partial_frames);
    if (r->doubtful_frames > 0) (void)fprintf(out, ", %u of them although doubtful", r->doubtful_frames);
    (void)fprintf(out, "; rendered unclipped: %u by the plugin's note, %u by its failure\n", r->note_frames,
                  r->failed_frames);
    const sv_stats *s = &r->stats;
    /* A plugin that could not be made has no status of its own to tell: its reason says more. */
    const hs_error *failure = hs_run_plugin_error(run);
    hs_print(out, "Last frame: %s",
             r->outcome < 0 && failure->code != HS_OK ? failure->text : hs_status_name(r->outcome));
    const sv_points_report *p = &r->points;
    if (s->points > 0)
        (void)fprintf(out, "; %u rays gave a point (%.1f %% of %u)", s->points, 100.0 * s->points / s->rays,
                      s->rays);
    if (s->rays > 0) (void)fprintf(out, ", %u pixels without a surface", s->unfilled);
    if (p->size > 0)
        (void)fprintf(out,
                      "; %u points with an empty interval, %u surely in fluid; "
                      "T_B %.3f, volume maximum %.3f; %u passes",
                      p->empty_points, p->sure_points, (double)p->bone_threshold, (double)p->volume_max,
                      p->passes);
    (void)fprintf(out, "\n");
    char words[120];
    if (r->outcome == SV_NO_SURFACE) print_reason(run, out);
    if (hs_doubt_words(r->doubt, words, sizeof words))
        (void)fprintf(out, "%s%s%s\n", hs_use_colour(fileno(out)) ? "\033[33m" : "", words,
                      hs_use_colour(fileno(out)) ? "\033[0m" : "");
}

static void print_written(const hs_result_report *w, FILE *out) {
    (void)fprintf(out, "Results:");
    for (uint32_t i = 0, count = 0; i < HS_RESULT_COUNT; i++)
        if (w->what >> i & 1u) {
            const bool surface = 1u << i == HS_RESULT_SURFACE;
            (void)fprintf(out, "%s %s%s.%s", count++ ? "," : "", hs_result_name(i),
                          surface && w->volumes > 1 ? "_0000" : "", surface ? "ply" : "mha");
        }
    if (w->volumes > 1) (void)fprintf(out, "; sequences of %u volumes", w->volumes);
    if (w->clipped < w->volumes) (void)fprintf(out, "; nothing is cut away in %u", w->volumes - w->clipped);
    if (w->what & HS_RESULT_CLIPPED) (void)fprintf(out, "; what is cut away became %g", w->fill);
    if (w->what & HS_RESULT_SURFACE) (void)fprintf(out, "; %u triangles", w->surface.triangles);
    (void)fprintf(out, "\n");
}

static void print_difference(const hs_run *run, FILE *out) {
    const hs_result_difference *d = &run->difference;
    hs_print(out, "Reference %s: %u of %u rays differ by more than %g mm", run->request.reference,
             d->different, d->rays, d->tolerance);
    if (d->different > 0)
        (void)fprintf(out, ", the most by %g mm at (%u, %u): differences.csv", d->largest, d->x, d->y);
    (void)fprintf(out, "\n");
}

void hs_run_print(const hs_run *run, FILE *out) {
    const bool colour = hs_use_colour(fileno(out));
    bool other_settings = false;
    print_facts(run, out);
    print_headings(run, colour, out);
    print_times(run, out);
    for (uint32_t i = 0; i < run->result_count; i++) {
        if (run->results[i].setting == HS_SETTING_SMARTVIS)
            print_plugin(run, &run->results[i], out);
        else
            other_settings = true;
    }
    if (run->has_written) print_written(&run->written, out);
    if (run->difference.rays > 0) print_difference(run, out);
    if (other_settings)
        (void)fprintf(
            out,
            "\"DVR\" and \"+ scan conversion\" render the full volume, unclipped; only \"+ plugin\" starts "
            "its rays at the depthmap.\n");
}
