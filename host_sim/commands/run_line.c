/* SPDX-License-Identifier: MIT */
/* host_sim run: its options. */
#include "commands/run_line.h"

#include "commands/look_line.h"
#include "core/cli.h"
#include "core/options.h"
#include "loop/source_options.h"

#include <stdio.h>
#include <string.h>

static bool take_volume(void *target, const char *text, hs_error *err) {
    hs_run_line *const line = target;
    return hs_cli_append("--volume", text, line->volumes, &line->request.volume_count, HS_RUN_MAX_VOLUMES,
                         err);
}

static bool take_set(void *target, const char *text, hs_error *err) {
    hs_run_line *const line = target;
    return hs_cli_append("--set", text, line->sets, &line->request.set_count, HS_RUN_MAX_SETS, err);
}

static bool take_mark(hs_run_line *line, const char *option, const char *text, bool keep, hs_error *err) {
    uint32_t *count = &line->request.loop.mark_count;
    double numbers[] = {0.0, 0.0, 0.0, HS_MARK_RADIUS};
    if (!hs_cli_numbers(option, text, "X,Y,Z or X,Y,Z,R (mm)", -1e4, 1e4, 3, 4, numbers, err)) return false;
    const double radius = numbers[3];
    if (radius < HS_MARK_RADIUS_LEAST || radius > HS_MARK_RADIUS_MOST)
        return hs_fail(err, HS_ERR_USAGE, "%s: a radius of %g mm is outside %g .. %g", option, radius,
                       HS_MARK_RADIUS_LEAST, HS_MARK_RADIUS_MOST);
    if (*count == HS_MARKS_MAX)
        return hs_fail(err, HS_ERR_USAGE, "%s: at most %d marks", option, HS_MARKS_MAX);
    line->marks[(*count)++] = (hs_mark){{numbers[0], numbers[1], numbers[2]}, radius, keep};
    return true;
}

static bool take_keep(void *target, const char *text, hs_error *err) {
    return take_mark(target, "--keep", text, true, err);
}

static bool take_remove(void *target, const char *text, hs_error *err) {
    return take_mark(target, "--remove", text, false, err);
}

static bool take_box(void *target, const char *text, hs_error *err) {
    hs_crop *const crop = target;
    double ends[6];
    if (!hs_cli_numbers("--box", text, "X,Y,Z,X,Y,Z (mm), two corners", -1e4, 1e4, 6, 6, ends, err))
        return false;
    for (int k = 0; k < 3; k++) {
        crop->low[k] = ends[k];
        crop->high[k] = ends[3 + k];
    }
    return (crop->used = true);
}

static bool take_padding(void *target, const char *text, hs_error *err) {
    static const char *const names[] = {"auto", "none", "all"};
    hs_run_line *const line = target;
    uint32_t index = 0;
    if (!hs_cli_select("--padding", text, names, 3, &index, err)) return false;
    line->request.files.metaimage.padding = (hs_padding)index;
    return (line->padding_given = true);
}

/* The request points to both paths: into the copy of the first one, and into `text`. */
static bool take_scanned(void *target, const char *text, hs_error *err) {
    hs_run_line *const line = target;
    const char *comma = strchr(text, ',');
    const size_t length = comma ? (size_t)(comma - text) : 0;
    if (length == 0 || length >= sizeof line->scanned || comma[1] == '\0' || strchr(comma + 1, ','))
        return hs_fail(err, HS_ERR_USAGE, "--scanned: '%s', expected two files, FIRST,END", text);
    memcpy(line->scanned, text, length);
    line->scanned[length] = '\0';
    const char **scanned = line->request.files.metaimage.scanned;
    scanned[0] = line->scanned;
    scanned[1] = comma + 1;
    return true;
}

static bool take_window(void *target, const char *text, hs_error *err) {
    hs_metaimage_options *const read = target;
    double ends[2];
    if (!hs_cli_numbers("--window", text, "LOW,HIGH", -1e12, 1e12, 2, 2, ends, err)) return false;
    read->has_window = true;
    read->window_low = ends[0];
    read->window_high = ends[1];
    return ends[0] < ends[1] || hs_fail(err, HS_ERR_USAGE, "--window: %s: LOW must be less than HIGH", text);
}

static bool take_carrier(void *target, const char *text, hs_error *err) {
    static const char *const names[] = {"host", "buffer", "image"};
    hs_run_line *const line = target;
    uint32_t index = 0;
    if (!hs_cli_select("--carrier", text, names, 3, &index, err)) return false;
    line->request.loop.carrier = SV_CARRIER_HOST + index;
    return (line->carrier_given = true);
}

static bool take_setting(void *request, const char *text, hs_error *err) {
    static const char *const names[] = {"dvr", "convert", "smartvis", "all"};
    hs_run_request *const r = request;
    uint32_t index = 0;
    if (!hs_cli_select("--setting", text, names, 4, &index, err)) return false;
    for (uint32_t s = 0; s < HS_SETTING_COUNT; s++) r->settings[s] = index == HS_SETTING_COUNT || s == index;
    return true;
}

static bool take_view(void *from, const char *text, hs_error *err) {
    const char *names[HS_FROM_COUNT];
    uint32_t index = 0;
    for (int i = 0; i < HS_FROM_COUNT; i++) names[i] = hs_from_name((hs_from)i);
    if (!hs_cli_select("--view", text, names, HS_FROM_COUNT, &index, err)) return false;
    *(hs_from *)from = (hs_from)index;
    return true;
}

static bool take_picture(void *target, const char *text, hs_error *err) {
    hs_dvr_settings *const dvr = target;
    if (!hs_cli_u32("--picture", text, 16, 2048, &dvr->width, err)) return false;
    dvr->height = dvr->width;
    return true;
}

static bool take_write(void *request, const char *text, hs_error *err) {
    hs_run_request *const r = request;
    return hs_result_parse("--write", text, strcmp(text, "all") == 0 ? &r->write_if : &r->write, err);
}

#define AT(field)   offsetof(hs_run_line, request.field)
#define LINE(field) offsetof(hs_run_line, field)
static const hs_option options[] = {
    HS_OPTIONS_GROUP("Source:"),
    HS_TAKEN("volume", "FILE", 0, take_volume,
             "MetaImage (.mha, .mhd) or Kretz (.vol), volume or sequence; repeatable"),
    HS_TAKEN("padding", "MODE", 0, take_padding,
             "what a 0 in FILE is: auto (not scanned if connected to the border), none, all [auto]"),
    HS_SOURCE_PROBE_ROW(AT(files.metaimage)),
    HS_TAKEN("scanned", "FIRST,END", 0, take_scanned,
             "two maps (MetaImage, a whole number a ray): the first scanned slice, and the first one\n"
             "behind the scan; takes the place of --padding"),
    HS_TAKEN("window", "LOW,HIGH", AT(files.metaimage), take_window,
             "source values that become 0 and 255 [the file's own range; 8-bit files as they are]"),
    HS_FLAG("mirror", AT(files.kretz.mirrored),
            "of a Kretz file: positive sweep angles at +y [at -y]; the file does not say"),
    HS_SOURCE_SPACING_ROW(AT(files)),
    HS_TEXT("scene", "NAME|FILE", AT(scene.name), "a built-in scene (see 'host_sim scenes') or a scene file"),
    HS_IN(COUNT, "size", "N", AT(scene.size), 32, 512, "voxels per axis of a scene, 32 .. 512 [256]"),
    HS_IN(WHOLE, "seed", "N", AT(scene.seed), 0, 0, "seed of a scene; 0 is its own [0]"),
    HS_IN(COUNT, "moving", "N", AT(scene.volumes), 1, 16,
          "N volumes of the scene's motion, one a frame, 1 .. 16 [1: it stands still]"),
    HS_TEXT("real", "FILE", AT(scene.real), "the volume of a scene of kind real"),
    HS_TAKEN("box", "X,Y,Z,X,Y,Z", AT(crop), take_box,
             "looks at this part alone: two corners, mm from the centre of the first voxel, the lower\n"
             "one first; what lies outside counts as not scanned"),
    HS_FLAG("live", AT(loop.live), "uploads every frame's volume anew, as a live scan does"),
    HS_OPTIONS_GROUP("Plugin:"),
    HS_TEXT("plugin", "PATH", AT(plugin_path), "library to load, a path or a name [smartvis]"),
    HS_TEXT("id", "ID", AT(plugin_id), "which of its plugins [the first]"),
    HS_TEXT("map", "FILE", AT(map),
            "no plugin, but depths from a file (MetaImage, N x N values of --lowres N): mm from the\n"
            "volume's front; 0 or less clips nothing. A depthmap.mha of --write counts from the middle of\n"
            "the first slice: half of its third ElementSpacing less"),
    HS_TAKEN("set", "KEY=VALUE", 0, take_set, "a plugin parameter; repeatable; see 'host_sim list'"),
    HS_TAKEN("carrier", "KIND", 0, take_carrier,
             "how slabs are handed over: host, buffer, image [buffer; host with --own-queue]"),
    HS_FLAG("own-queue", AT(loop.own_queue),
            "the plugin picks its own device and queue\n"
            "[or, where the plugin takes no such slabs, as it does take them]"),
    HS_IN(COUNT, "slab", "N", AT(loop.slab_slices), 1, 8192, "slices of a slab [16]"),
    HS_IN(COUNT, "lowres", "N", AT(loop.lowres), 1, 8192,
          "pixels across the low-resolution volume [1 mm each; a third of the\n"
          "source's resolution at least, all of it at most]"),
    HS_TAKEN("remove", "X,Y,Z[,R]", 0, take_remove,
             "takes away what is seen there, mm from the centre of the first voxel, R mm around [5],\n"
             "down to the next tissue behind fluid; repeatable, in the order given"),
    HS_TAKEN("keep", "X,Y,Z[,R]", 0, take_keep, "brings back what the plugin cut there; likewise"),
    HS_CHOICE("verbose", AT(log_level), SV_LOG_DEBUG,
              "prints all the plugin logs; default: warnings and errors"),
    HS_GUARD_ROWS(AT(guard)),
    HS_OPTIONS_GROUP("Loop:"),
    HS_TAKEN("setting", "WHICH", LINE(request), take_setting,
             "dvr, convert, smartvis or all: the settings of the thesis' Figure 5.21 [all];\n"
             "dvr and convert render the full volume, unclipped"),
    HS_IN(COUNT, "frames", "N", AT(loop.frames), 1, 100000, "volumes per setting [30]"),
    HS_TAKEN("view", "PLACE", AT(loop.from), take_view,
             "where the camera is: probe, or around the patient, if FILE says how it lies in\n"
             "him: anterior, posterior, left, right, superior, inferior [probe]"),
    HS_IN(NUMBER, "yaw", "DEG", AT(loop.yaw), -360, 360, "turns it from there, to the right [0]"),
    HS_IN(NUMBER, "pitch", "DEG", AT(loop.pitch), -360, 360, "turns it from there, up [0]"),
    HS_IN(NUMBER, "roll", "DEG", AT(loop.roll), -360, 360, "turns its picture clockwise [0]"),
    HS_FLAG("turnable", AT(loop.turnable),
            "one box for every direction, as the console's: maps and depths do not change with it"),
    HS_IN(NUMBER, "zoom", "Z", AT(loop.zoom), 1.0 / HS_LOOP_MAX_ZOOM, HS_LOOP_MAX_ZOOM,
          "the picture shows 1/Z of the box' side; with --turnable of the volume seen from PLACE [1]"),
    HS_IN(NUMBER, "orbit", "DEG", AT(loop.orbit), -360, 360,
          "turns the camera by DEG over the frames, half to either side of --yaw [0]"),
    HS_OPTIONS_GROUP("Renderer:"),
    HS_TAKEN("look", "NAME", LINE(look), hs_look_line_look,
             "thesis: Eq. 3.22 - 3.24; lit: a smooth surface in light [lit]"),
    HS_TAKEN("light", "AZ,EL", AT(loop.dvr.light), hs_look_line_light,
             "where the lamp of the lit look is, degrees from the viewer: right, up [-35,40]"),
    HS_IN(FLOAT, "t-low", "T", AT(loop.dvr.threshold_low), 0, 1,
          "opacity is 0 at T_L and below, in 0 .. 1 [0.1588]"),
    HS_IN(FLOAT, "t-high", "T", AT(loop.dvr.threshold_high), 0, 1,
          "opacity is 1 at T_H and above, in 0 .. 1 [0.45]"),
    HS_IN(FLOAT, "ghost-offset", "S", AT(loop.dvr.ghost_offset), -8192, 8192,
          "s of the ghosting, in steps [0]"),
    HS_IN(FLOAT, "ghost-width", "W", AT(loop.dvr.ghost_width), 0, 8192,
          "w of the ghosting, in steps; 0 is a hard cut [0]"),
    HS_IN(FLOAT, "ghost-doubt", "G", AT(loop.dvr.ghost_doubt), 0, (double)HS_DVR_MAX_DOUBT,
          "where the plugin is not sure, the ghosting begins up to G times W sooner [2]"),
    HS_IN(FLOAT, "exposure", "G", LINE(exposure), 0.1, 10,
          "gain of the picture's colours, 1 is the plain formula [lit 1, thesis 1.5]"),
    HS_TAKEN("picture", "N", AT(loop.dvr), take_picture, "the picture is N x N pixels [512]"),
    HS_OPTIONS_GROUP("Output:"),
    HS_TEXT("out", "DIR", LINE(out), "folder for the pictures [out/run]"),
    HS_FLAG("few-pictures", AT(few_pictures), "writes result.png and full.png, no other pictures"),
    HS_IN(COUNT, "panel", "N", AT(panel_cell), 64, 1024, "width of each picture in panel.png, pixels [512]"),
    HS_TAKEN("write", "WHAT,...", LINE(request), take_write,
             "writes data for other programs to DIR: depthmap, confidence, status, clipped,\n"
             "mask (MetaImage), surface (PLY), or all [nothing]"),
    HS_TEXT("reference", "MAP", AT(reference),
            "compares the depthmap with one that was kept (a depthmap.mha of --write), writes the\n"
            "rays that differ to differences.csv in DIR, and ends with 1 if there are any"),
    HS_IN(NUMBER, "tolerance", "MM", AT(tolerance), 0, 1000,
          "with --reference: as much may a depth differ [0]"),
    HS_TEXT("json", "FILE", LINE(json), "writes the results as JSON, too"),
    HS_OPTIONS_END,
};

/* What of a source is for the other kind of it, and would do nothing. */
static bool check_source(const hs_run_line *line, hs_error *err) {
    const hs_run_request *r = &line->request;
    const hs_source_scene *s = &r->scene;
    const hs_metaimage_options *read = &r->files.metaimage;
    const char *of_scene = s->size      ? "--size"
                           : s->seed    ? "--seed"
                           : s->volumes ? "--moving"
                           : s->real    ? "--real"
                                        : NULL;
    const char *of_file = read->has_window ? "--window" : line->padding_given ? "--padding" : NULL;
    if (of_scene && r->volume_count > 0)
        return hs_fail(err, HS_ERR_USAGE, "%s: is for --scene, --volume %s was given", of_scene,
                       line->volumes[0]);
    if (of_file && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "%s: is for --volume, --scene %s was given", of_file, s->name);
    if (read->scanned[0] && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--scanned %s,%s: is for --volume; a scene has its own fan",
                       read->scanned[0], read->scanned[1]);
    if (read->has_spacing && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--spacing: is for --volume; a scene has its own");
    if (read->has_probe && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--probe %s: is for --volume; a scene is scanned from slice 0",
                       hs_probe_name(read->probe));
    return true;
}

/* What can be said before anything is loaded. */
static bool check_line(const hs_run_line *line, hs_error *err) {
    const hs_run_request *r = &line->request;
    bool kretz = false;
    if (r->scene.name && r->volume_count > 0)
        return hs_fail(err, HS_ERR_USAGE, "--scene %s and --volume %s: give one of them", r->scene.name,
                       line->volumes[0]);
    if (!r->scene.name && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "no source: give --volume FILE or --scene NAME");
    if (!check_source(line, err)) return false;
    for (uint32_t i = 0; i < r->volume_count; i++) kretz |= hs_kretz_is_file(line->volumes[i]);
    if ((r->files.kretz.mirrored || r->files.kretz.spacing > 0.0) && !kretz)
        return hs_fail(err, HS_ERR_USAGE, "%s: is for Kretz files (--volume FILE.vol)",
                       r->files.kretz.mirrored ? "--mirror" : "--spacing");
    if (r->map && (r->plugin_path || r->plugin_id || r->set_count > 0))
        return hs_fail(err, HS_ERR_USAGE, "--map %s: takes the place of --plugin, --id and --set", r->map);
    if (r->map && r->loop.lowres == 0)
        return hs_fail(err, HS_ERR_USAGE, "--map %s: needs --lowres N, the map's pixels across", r->map);
    if (r->files.metaimage.scanned[0] && line->padding_given)
        return hs_fail(err, HS_ERR_USAGE, "--scanned and --padding: give one of them");
    if ((r->write || r->write_if || r->reference) && r->loop.orbit != 0)
        return hs_fail(err, HS_ERR_USAGE, "--%s: needs a camera that stands still, --orbit is %g degrees",
                       r->reference ? "reference" : "write", r->loop.orbit);
    if (r->tolerance > 0.0 && !r->reference)
        return hs_fail(err, HS_ERR_USAGE, "--tolerance %g: is for --reference MAP", r->tolerance);
    if (r->loop.dvr.threshold_low >= r->loop.dvr.threshold_high)
        return hs_fail(err, HS_ERR_USAGE, "--t-low %g must be less than --t-high %g",
                       (double)r->loop.dvr.threshold_low, (double)r->loop.dvr.threshold_high);
    return true;
}

bool hs_run_line_parse(int argc, char **argv, hs_run_line *line, hs_error *err) {
    int next = argc;
    *line = (hs_run_line){.out = "out/run", .look = HS_LOOK_LIT};
    hs_run_defaults(&line->request);
    line->request.loop.frames = 30;
    const hs_source_scene defaults = line->request.scene;
    line->request.scene = (hs_source_scene){0}; /* what is given shows */
    if (!hs_options_read(argc, argv, options, line, &next, &line->help, err)) return false;
    if (line->help) return true;
    if (!hs_cli_no_more(argc, argv, next, err) || !check_line(line, err)) return false;
    hs_source_scene *scene = &line->request.scene;
    if (scene->size == 0) scene->size = defaults.size;
    if (scene->volumes == 0) scene->volumes = defaults.volumes;
    hs_loop_for_pictures(&line->request.loop, line->look);
    if (line->exposure > 0.0f) line->request.loop.dvr.exposure = line->exposure;
    line->request.volumes = line->volumes;
    line->request.sets = line->sets;
    line->request.loop.marks = line->marks;
    if (line->request.loop.own_queue && !line->carrier_given) line->request.loop.carrier = SV_CARRIER_HOST;
    line->request.loop.carrier_fixed = line->carrier_given || line->request.loop.own_queue;
    return true;
}

static const char usage[] =
    "Usage: host_sim run (--volume FILE | --scene NAME) [options]\n"
    "Runs the scan loop: volume -> scan conversion -> slabs -> plugin -> depthmap -> DVR -> picture.\n"
    "Prints times and statistics, and writes pictures to one folder.\n\n";

int hs_run_line_help(void) {
    return hs_options_help(usage, options, "");
}
