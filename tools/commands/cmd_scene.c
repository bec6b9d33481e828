/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "base/cli.h"
#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"
#include "commands/scene_line.h"
#include "scene/scene.h"
#include "scene/scene_draw.h"
#include "scene/scene_export.h"
#include "show/scene_sheet.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>

static bool list_scenes(hs_error *err) {
    for (int group = 0; group < HS_SCENES_GROUPS; group++)
        for (uint32_t i = 0; hs_scene_of_group((hs_scene_group)group, i); i++) {
            hs_scene *scene = hs_scene_open(hs_scene_of_group((hs_scene_group)group, i), err);
            if (!scene) return false;
            hs_print(stdout, "%-5s %s\n", hs_scene_name(scene), hs_scene_title(scene));
            hs_scene_close(scene);
        }
    return true;
}

/* As the rows of the table in docs/scenes.md. */
static void print_ranges(void) {
    for (int i = 0; i < HS_RANGE_COUNT; i++) {
        const hs_scene_range *r = &hs_scene_ranges[i];
        if (r->low == r->high)
            hs_print(stdout, "| `%s` | %g %s | | %s |\n", r->key, r->low / 100.0, r->unit, r->what);
        else
            hs_print(stdout, "| `%s` | %g .. %g%s%s | %g | %s |\n", r->key, r->low / 100.0, r->high / 100.0,
                     r->unit[0] ? " " : "", r->unit, r->step / 100.0, r->what);
    }
}

static void print_times(const hs_scene_times *times) {
    for (int i = 0; i < HS_SCENE_STEPS; i++) {
        if (times->ms[i] > 0.0)
            hs_print(stdout, "    %-14s %8.1f ms\n", hs_scene_step_name(i), times->ms[i]);
        else
            hs_print(stdout, "    %-14s        -\n", hs_scene_step_name(i));
    }
}

static void print_facts(const char *name, const hs_scene_data *data, const hs_scene_points *points,
                        const hs_scene_times *times) {
    size_t labels[3] = {0}, pixels = (size_t)data->full.nx * data->full.ny;
    for (size_t i = 0; i < pixels; i++) labels[data->label[i]]++;
    double found = points->right + points->wrong, rays = (double)points->width * points->height;
    hs_print(stdout,
             "%-10s %u x %u x %u in %.0f ms; rays: fetus %.1f %%, sac only %.1f %%; "
             "initial points on %.1f %% of the rays, %.0f %% of them right\n",
             name, data->full.nx, data->full.ny, data->full.nz, times->total_ms,
             100.0 * (double)labels[2] / (double)pixels, 100.0 * (double)labels[1] / (double)pixels,
             rays > 0.0 ? 100.0 * found / rays : 0.0, found > 0.0 ? 100.0 * points->right / found : 0.0);
}

static bool write_sheet(const hs_scene_line *r, const hs_scene *scene, const char *name,
                        const hs_scene_data *data, const hs_scene_points *points, const hs_cl *cl,
                        hs_error *err) {
    char path[1024], file[128], title[640];
    hs_picture picture;
    snprintf(file, sizeof file, "%s_sheet.png", name);
    snprintf(title, sizeof title, "%s: %s", name, hs_scene_title(scene));
    if (!hs_path_join(r->out, file, path, sizeof path, err)) return false;
    if (!hs_scene_sheet(cl, &r->drawing, data, points, title, &picture, err)) return false;
    bool ok = hs_picture_save(&picture, path, err);
    hs_picture_free(&picture);
    return ok;
}

/* What --export asks for. A sequence of Kretz files has the scene's name, whatever the frame. */
static bool export_frame(const hs_scene_line *r, const hs_scene *scene, const char *prefix,
                         const hs_scene_data *data, hs_vol_export *files, hs_error *err) {
    char path[1024];
    if (!r->vol) return hs_scene_export(data, prefix, err);
    return hs_path_join(r->out, hs_scene_name(scene), path, sizeof path, err) &&
           hs_vol_export_frame(files, &r->geometry, path, r->frames, data, err);
}

static bool make_frame(const hs_scene_line *r, const hs_scene *scene, uint32_t frame, const hs_cl *cl,
                       hs_vol_export *files, hs_error *err) {
    hs_scene_options one = r->options;
    hs_scene_data data;
    hs_scene_times times;
    hs_scene_points points = {0};
    char name[96], prefix[1024];
    one.frame = frame;
    if (r->frames > 1)
        snprintf(name, sizeof name, "%s_f%03u", hs_scene_name(scene), frame);
    else
        snprintf(name, sizeof name, "%s", hs_scene_name(scene));
    if (!hs_path_join(r->out, name, prefix, sizeof prefix, err)) return false;
    if (!hs_scene_frame(scene, &one, &data, &times, err)) return false;
    bool ok = hs_scene_points_find(&data, &points, err);
    if (ok) print_facts(name, &data, &points, &times);
    if (ok && r->times) print_times(&times);
    if (ok && r->export) ok = export_frame(r, scene, prefix, &data, files, err);
    if (ok && r->sheet) ok = write_sheet(r, scene, name, &data, &points, cl, err);
    hs_scene_points_free(&points);
    hs_scene_free(&data);
    return ok;
}

static bool write_json(const hs_scene_line *r, const hs_scene *scene, hs_error *err) {
    char path[1024], file[128];
    hs_output_file output;
    snprintf(file, sizeof file, "%s.json", hs_scene_name(scene));
    if (!hs_path_join(r->out, file, path, sizeof path, err) || !hs_output_open(&output, path, err))
        return false;
    (void)fputs(hs_scene_json(scene), output.file);
    return hs_output_commit(&output, err);
}

static bool make_scene(const hs_scene_line *r, const char *name, const hs_cl *cl, hs_error *err) {
    hs_scene *scene = hs_scene_open_with(name, r->sets, r->set_count, err);
    if (!scene) return false;
    const bool volumes = !r->json || r->export || r->sheet;
    bool ok = true;
    hs_vol_export files = {0};
    for (uint32_t frame = 0; ok && volumes && frame < r->frames; frame++)
        ok = make_frame(r, scene, frame, cl, &files, err);
    if (ok && (r->json || r->export)) ok = write_json(r, scene, err);
    hs_vol_export_discard(&files);
    hs_scene_close(scene);
    return ok;
}

static bool make_group(const hs_scene_line *r, hs_scene_group group, const hs_cl *cl, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && hs_scene_of_group(group, i); i++)
        ok = make_scene(r, hs_scene_of_group(group, i), cl, err);
    return ok;
}

static bool make_random(const hs_scene_line *r, const hs_cl *cl, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < r->random; i++) {
        char name[64];
        snprintf(name, sizeof name, "R%" PRIu64 "_%" PRIu32, r->random_seed, i);
        ok = make_scene(r, name, cl, err);
    }
    return ok;
}

static bool make_scenes(const hs_scene_line *r, char **names, int count, hs_error *err) {
    hs_cl cl = {0};
    const bool files = r->json || r->export || r->sheet;
    if (files && !hs_path_make_folder(r->out, err)) return false;
    bool ok = !r->sheet || hs_cl_open(&cl, err);
    for (int i = 0; ok && i < count; i++) ok = make_scene(r, names[i], &cl, err);
    if (ok && r->all) ok = make_group(r, HS_SCENES_THESIS, &cl, err);
    if (ok && r->hard) ok = make_group(r, HS_SCENES_HARD, &cl, err);
    if (ok && r->random) ok = make_random(r, &cl, err);
    hs_cl_close(&cl);
    if (ok && files) hs_print(stdout, "Files are in %s\n", r->out);
    return ok;
}

int hs_cmd_scene(int argc, char **argv) {
    hs_scene_line r;
    hs_error err = {0};
    if (!hs_scene_line_parse(argc, argv, &r, &err)) return hs_cli_fail("scenes", &err);
    if (r.help) {
        hs_scene_line_help();
        return HS_OK;
    }
    if (r.ranges) {
        print_ranges();
        return HS_OK;
    }
    const bool make = !r.list && (r.all || r.hard || r.random || optind < argc);
    bool ok = make ? make_scenes(&r, argv + optind, argc - optind, &err) : list_scenes(&err);
    return ok ? HS_OK : hs_cli_fail("scenes", &err);
}
