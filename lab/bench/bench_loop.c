/* SPDX-License-Identifier: MIT */
/* The whole loop as a scan runs it: a turned camera, a new volume every frame, a
 * method of the plugin's, lit. */
#include "base/progress.h"
#include "bench/bench.h"
#include "bench/bench_results.h"
#include "bench/plain.h"
#include "plugin/loader_param.h"

#include <stdio.h>

#define BENCH_LOOP_TARGET 30.0 /* volumes a second */

enum { LIT, UNLIT, FLOW, LOOPS, MAX_VALUES = 16, SAMPLES = HS_STAGE_COUNT + 5 };
enum { AT_UNLIT = HS_STAGE_COUNT, AT_FLOW, AT_PROCESSOR, AT_READ, AT_READ_PROCESSOR };

static const char *const methods[BENCH_LOOP_METHODS] = {"mean", "cost", "wall"};
static const double yaw = 30.0, pitch = 20.0; /* degrees */

/* Loops run in turns, so each has an instance of the plugin of its own. */
typedef struct {
    hs_plugin plugin[LOOPS];
    bool opened[LOOPS];
    hs_loop *loop[LOOPS];
    sv_param_value values[MAX_VALUES + 1];
    bench_samples samples[SAMPLES];
} bench;

static bool open_loops(bench *b, const bench_host_setup *setup, const hs_source *source, uint32_t values,
                       hs_error *err) {
    for (int i = 0; i < LOOPS; i++) {
        hs_loop_options o;
        hs_loop_defaults(&o);
        o.frames = setup->frames;
        o.yaw = yaw;
        o.pitch = pitch;
        o.live = true;
        o.in_flow = i == FLOW;
        o.values = b->values;
        o.value_count = values;
        hs_loop_for_pictures(&o, i == UNLIT ? HS_LOOK_THESIS : HS_LOOK_LIT);
        b->opened[i] = hs_plugin_open(&b->plugin[i], setup->plugin->path,
                                      setup->plugin->instance->descriptor->id, SV_LOG_WARNING, err);
        if (!b->opened[i] || !(b->loop[i] = hs_loop_create(setup->cl, source, &b->plugin[i], &o, err)))
            return false;
    }
    return true;
}

static void close_loops(bench *b) {
    for (int i = 0; i < LOOPS; i++) {
        hs_loop_destroy(b->loop[i]);
        if (b->opened[i]) hs_plugin_close(&b->plugin[i]);
    }
}

static void time_read(bench *b, bench_team *team, const hs_volume *v, bool counts) {
    bench_team_ready(team);
    const double begin = hs_now(), busy = bench_processor_ms();
    (void)plain_read(team, v->voxels, hs_volume_count(v) / 16 * 16);
    const double ms = (hs_now() - begin) * 1e3, processor = bench_processor_ms() - busy;
    bench_team_rest(team);
    if (!counts) return;
    bench_samples_add(&b->samples[AT_READ], ms);
    bench_samples_add(&b->samples[AT_READ_PROCESSOR], processor);
}

static bool take_turn(bench *b, uint32_t index, bool counts, bench_loop_row *out, hs_error *err) {
    hs_frame frame[LOOPS];
    double busy = 0.0;
    for (int i = 0; i < LOOPS; i++) {
        busy = bench_processor_ms();
        if (!hs_loop_frame(b->loop[i], HS_SETTING_SMARTVIS, index, &frame[i], err)) return false;
    }
    busy = bench_processor_ms() - busy;
    if (!counts) return true;
    for (int s = 0; s < HS_STAGE_COUNT; s++) bench_samples_add(&b->samples[s], frame[LIT].ms[s]);
    bench_samples_add(&b->samples[AT_UNLIT], frame[UNLIT].ms[HS_STAGE_LOOP]);
    bench_samples_add(&b->samples[AT_FLOW], frame[FLOW].ms[HS_STAGE_LOOP]);
    bench_samples_add(&b->samples[AT_PROCESSOR], busy);
    out->clipped += frame[LIT].clipped;
    out->frames++;
    return true;
}

static bool run_method(bench *b, const bench_host_setup *setup, bench_team *team, const hs_source *source,
                       bench_loop_row *out, hs_error *err) {
    bool ok = true;
    for (int i = 0; i < SAMPLES; i++) ok = ok && bench_samples_create(&b->samples[i], setup->frames, err);
    hs_progress progress;
    hs_progress_begin(&progress, out->method, setup->frames);
    for (uint32_t i = 0; ok && i <= setup->frames; i++) { /* the first is not counted */
        time_read(b, team, hs_source_volume(source, 0), i > 0);
        ok = take_turn(b, i % setup->frames, i > 0, out, err);
        hs_progress_step(&progress, i);
    }
    hs_progress_end(&progress);
    for (int i = 0; i < LOOPS; i++)
        if (ok && hs_loop_plugin_error(b->loop[i])->code != HS_OK)
            ok = hs_fail(err, hs_loop_plugin_error(b->loop[i])->code, "%s",
                         hs_loop_plugin_error(b->loop[i])->text);
    for (int s = 0; s < HS_STAGE_COUNT; s++) out->stage[s] = bench_samples_times(&b->samples[s]);
    out->unlit = bench_samples_times(&b->samples[AT_UNLIT]);
    out->flow = bench_samples_times(&b->samples[AT_FLOW]);
    out->processor = bench_samples_times(&b->samples[AT_PROCESSOR]);
    out->read = bench_samples_times(&b->samples[AT_READ]);
    out->read_processor = bench_samples_times(&b->samples[AT_READ_PROCESSOR]);
    for (int i = 0; i < SAMPLES; i++) bench_samples_destroy(&b->samples[i]);
    return ok;
}

/* The setup's values with this method; false: the plugin does not have it. */
static bool with_method(bench *b, const bench_host_setup *setup, const char *method, uint32_t *count) {
    char text[64];
    hs_error none = {HS_OK, ""};
    *count = setup->value_count < MAX_VALUES ? setup->value_count : MAX_VALUES;
    for (uint32_t i = 0; i < *count; i++) b->values[i] = setup->values[i];
    (void)snprintf(text, sizeof text, "method=%s", method);
    if (!hs_plugin_parse_param(setup->plugin, text, &b->values[*count], &none)) return false;
    (*count)++;
    return true;
}

bool bench_loop_run(const bench_host_setup *setup, bench_team *team, const hs_source *source,
                    bench_loop_result *out, hs_error *err) {
    *out = (bench_loop_result){0};
    for (int i = 0; i < BENCH_LOOP_METHODS; i++) {
        bench b = {0};
        uint32_t values;
        if (!with_method(&b, setup, methods[i], &values) && i > 0) continue;
        bench_loop_row *row = &out->row[out->count++];
        row->method = values > setup->value_count ? methods[i] : "its own";
        const bool ok =
            open_loops(&b, setup, source, values, err) && run_method(&b, setup, team, source, row, err);
        close_loops(&b);
        if (!ok) return false;
    }
    return true;
}

static double per_second(double ms) {
    return ms > 0.0 ? 1e3 / ms : 0.0;
}

void bench_print_loop(const bench_loop_result *result) {
    printf(
        "\nThe whole loop: camera at %g, %g degrees, a new volume every frame, lit; medians in milliseconds, "
        "(of minima)\n",
        yaw, pitch);
    printf("%-8s | %7s %7s %7s %7s | %7s %7s %8s | %-13s %-13s %-13s | %s\n", "method", "upload", "convert",
           "plugin", "DVR", "loop", "min", "vol/s", "/ read", "/ unlit", "in flow", "clipped");
    for (uint32_t i = 0; i < result->count; i++) {
        const bench_loop_row *r = &result->row[i];
        const bench_times *loop = &r->stage[HS_STAGE_LOOP];
        printf("%-8s | %7.2f %7.2f %7.2f %7.2f | %7.2f %7.2f %8.1f | %5.1f (%5.1f) %5.2f (%5.2f) %5.2f "
               "(%5.2f) | %u "
               "of %u\n",
               r->method, r->stage[HS_STAGE_UPLOAD].median, r->stage[HS_STAGE_CONVERT].median,
               r->stage[HS_STAGE_PLUGIN].median, r->stage[HS_STAGE_DVR].median, loop->median, loop->min,
               per_second(loop->median), loop->median / r->read.median, loop->min / r->read.min,
               loop->median / r->unlit.median, loop->min / r->unlit.min, r->flow.median / loop->median,
               r->flow.min / loop->min, r->clipped, r->frames);
    }
    printf(
        "In flow: as a multiple of the loop whose stages wait for each other. Processor time of a frame in "
        "flow, all threads:\n");
    for (uint32_t i = 0; i < result->count; i++) {
        const bench_loop_row *r = &result->row[i];
        printf("  %-8s %7.2f (min %7.2f), %5.1f (%5.1f) times that of reading; on two cores that do nothing "
               "else at "
               "most %.1f volumes a second\n",
               r->method, r->processor.median, r->processor.min,
               r->processor.median / r->read_processor.median, r->processor.min / r->read_processor.min,
               per_second(0.5 * r->processor.min));
    }
    for (uint32_t i = 0; i < result->count; i++) {
        const bench_loop_row *r = &result->row[i];
        const double rate = per_second(r->stage[HS_STAGE_LOOP].median);
        printf("whole loop, turned camera, new volumes, lit, method %-8s at least %.0f a second: %5.1f "
               "(%5.1f)  %s\n",
               r->method, BENCH_LOOP_TARGET, rate, per_second(r->stage[HS_STAGE_LOOP].min),
               rate >= BENCH_LOOP_TARGET ? "holds" : "does not hold");
    }
}
