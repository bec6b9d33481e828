/* SPDX-License-Identifier: MIT */
/* host_sim run: its options. */
#include "commands/run_line.h"

#include "base/cli.h"
#include "commands/look_line.h"
#include "commands/run_value.h"
#include "guarded/guard_options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_FRAMES 100000u

static const char help_head[] =
    "Usage: host_sim run (--volume FILE | --scene NAME) [options]\n"
    "Runs the scan loop: volume -> scan conversion -> slabs -> plugin -> depthmap -> DVR -> picture.\n"
    "Prints times and statistics, and writes pictures to one folder.\n"
    "\n"
    "Source:\n"
    "  --volume FILE         MetaImage (.mha, .mhd) or Kretz (.vol), volume or sequence; repeatable\n"
    "  --padding MODE        what a 0 in FILE is: auto (not scanned if connected to the border), none, all"
    " [auto]\n"
    "  --probe FACE          where the probe is: -z (slice 0), +z, -y, +y, -x or +x; as FILE says, or -z "
    "[FILE's]\n"
    "  --scanned FIRST,END   two maps (MetaImage, a whole number a ray): the first scanned slice, and the "
    "first one\n"
    "                        behind the scan; takes the place of --padding\n"
    "  --window LOW,HIGH     source values that become 0 and 255"
    " [the file's own range; 8-bit files as they are]\n"
    "  --mirror              of a Kretz file: positive sweep angles at +y [at -y]; the file does not say\n"
    "  --spacing MM          of a Kretz file: voxels of its Cartesian copy [pitch, or 1/400 of its side]\n"
    "  --scene NAME|FILE     a built-in scene (see 'host_sim scenes') or a scene file\n"
    "  --size N              voxels per axis of a scene, 32 .. 512 [256]\n"
    "  --seed N              seed of a scene; 0 is its own [0]\n"
    "  --moving N            N volumes of the scene's motion, one a frame, 1 .. 16 [1: it stands still]\n"
    "  --real FILE           the volume of a scene of kind real\n"
    "  --live                uploads every frame's volume anew, as a live scan does\n"
    "Plugin:\n"
    "  --plugin PATH         library to load, a path or a name [smartvis]\n"
    "  --id ID               which of its plugins [the first]\n"
    "  --set KEY=VALUE       a plugin parameter; repeatable; see 'host_sim list'\n"
    "  --carrier KIND        how slabs are handed over: host, buffer, image [buffer; host with --own-queue]\n"
    "  --own-queue           the plugin picks its own device and queue\n"
    "                        [or, where the plugin takes no such slabs, as it does take them]\n"
    "  --fan HOW             how the plugin is told what was scanned: ranges, padding, nothing\n"
    "                        [ranges if it takes them, else padding]\n"
    "  --slab N              slices of a slab [16]\n"
    "  --lowres N            pixels across the low-resolution volume [a third of the source's resolution]\n"
    "  --verbose             prints all the plugin logs; default: warnings and errors\n";

static const char help_tail[] =
    "Loop:\n"
    "  --setting WHICH       dvr, convert, smartvis or all: the settings of the thesis' Figure 5.21 [all];\n"
    "                        dvr and convert render the full volume, unclipped\n"
    "  --frames N            volumes per setting [30]\n"
    "  --view PLACE          where the camera is: probe, or around the patient, if FILE says how it lies in\n"
    "                        him: anterior, posterior, left, right, superior, inferior [probe]\n"
    "  --yaw DEG --pitch DEG turn it from there, to the right and up [0 0]\n"
    "  --turnable            one box for every direction, as the console's: maps and depths do not change "
    "with it\n"
    "  --zoom Z              the picture shows 1/Z of the box' side; with --turnable of the volume seen from "
    "PLACE [1]\n"
    "  --orbit DEG           turns the camera by DEG over the frames, half to either side of --yaw [0]\n"
    "Renderer:\n"
    "  --look NAME           thesis: Eq. 3.22 - 3.24; lit: a smooth surface in light [lit]\n"
    "  --light AZ,EL         where the lamp of the lit look is, degrees from the viewer: right, up [-35,40]\n"
    "  --t-low T --t-high T  opacity is 0 at T_L and below, 1 at T_H and above, in 0 .. 1 [0.1588 0.45]\n"
    "  --ghost-offset S      s of the ghosting, in steps [0]\n"
    "  --ghost-width W       w of the ghosting, in steps; 0 is a hard cut [0]\n"
    "  --ghost-doubt G       where the plugin is not sure, the ghosting begins up to G times W sooner [2]\n"
    "  --exposure G          gain of the picture's colours, 1 is the plain formula\n"
    "                        [lit 1, thesis 1.5]\n"
    "  --picture N           the picture is N x N pixels [512]\n"
    "Output:\n"
    "  --out DIR             folder for the pictures [out/run]\n"
    "  --few-pictures        writes result.png and full.png, no other pictures\n"
    "  --panel N             width of each picture in panel.png, pixels [512]\n"
    "  --write WHAT,...      writes data for other programs to DIR: depthmap, confidence, status, clipped,\n"
    "                        mask (MetaImage), surface (PLY), or all [nothing]\n"
    "  --json FILE           writes the results as JSON, too\n"
    "  --help                this text\n"
    "\n";

enum {
    OPT_VOLUME = 256,
    OPT_PADDING,
    OPT_SCANNED,
    OPT_WINDOW,
    OPT_MIRROR,
    OPT_SPACING,
    OPT_PROBE,
    OPT_SCENE,
    OPT_SIZE,
    OPT_SEED,
    OPT_MOVING,
    OPT_REAL,
    OPT_LIVE,
    OPT_PLUGIN,
    OPT_ID,
    OPT_SET,
    OPT_CARRIER,
    OPT_OWN_QUEUE,
    OPT_FAN,
    OPT_SLAB,
    OPT_LOWRES,
    OPT_VERBOSE,
    OPT_SETTING,
    OPT_FRAMES,
    OPT_VIEW,
    OPT_YAW,
    OPT_PITCH,
    OPT_ORBIT,
    OPT_TURNABLE,
    OPT_ZOOM,
    OPT_LOOK,
    OPT_LIGHT,
    OPT_T_LOW,
    OPT_T_HIGH,
    OPT_GHOST_OFFSET,
    OPT_GHOST_WIDTH,
    OPT_GHOST_DOUBT,
    OPT_EXPOSURE,
    OPT_PICTURE,
    OPT_OUT,
    OPT_PANEL,
    OPT_FEW,
    OPT_WRITE,
    OPT_JSON,
    OPT_HELP
};

static const struct option options[] = {{"volume", required_argument, NULL, OPT_VOLUME},
                                        {"padding", required_argument, NULL, OPT_PADDING},
                                        {"scanned", required_argument, NULL, OPT_SCANNED},
                                        {"window", required_argument, NULL, OPT_WINDOW},
                                        {"mirror", no_argument, NULL, OPT_MIRROR},
                                        {"spacing", required_argument, NULL, OPT_SPACING},
                                        {"probe", required_argument, NULL, OPT_PROBE},
                                        {"scene", required_argument, NULL, OPT_SCENE},
                                        {"size", required_argument, NULL, OPT_SIZE},
                                        {"seed", required_argument, NULL, OPT_SEED},
                                        {"moving", required_argument, NULL, OPT_MOVING},
                                        {"real", required_argument, NULL, OPT_REAL},
                                        {"live", no_argument, NULL, OPT_LIVE},
                                        {"plugin", required_argument, NULL, OPT_PLUGIN},
                                        {"id", required_argument, NULL, OPT_ID},
                                        {"set", required_argument, NULL, OPT_SET},
                                        {"carrier", required_argument, NULL, OPT_CARRIER},
                                        {"own-queue", no_argument, NULL, OPT_OWN_QUEUE},
                                        {"fan", required_argument, NULL, OPT_FAN},
                                        {"slab", required_argument, NULL, OPT_SLAB},
                                        {"lowres", required_argument, NULL, OPT_LOWRES},
                                        {"verbose", no_argument, NULL, OPT_VERBOSE},
                                        {"setting", required_argument, NULL, OPT_SETTING},
                                        {"frames", required_argument, NULL, OPT_FRAMES},
                                        {"view", required_argument, NULL, OPT_VIEW},
                                        {"yaw", required_argument, NULL, OPT_YAW},
                                        {"pitch", required_argument, NULL, OPT_PITCH},
                                        {"orbit", required_argument, NULL, OPT_ORBIT},
                                        {"turnable", no_argument, NULL, OPT_TURNABLE},
                                        {"zoom", required_argument, NULL, OPT_ZOOM},
                                        {"look", required_argument, NULL, OPT_LOOK},
                                        {"light", required_argument, NULL, OPT_LIGHT},
                                        {"t-low", required_argument, NULL, OPT_T_LOW},
                                        {"t-high", required_argument, NULL, OPT_T_HIGH},
                                        {"ghost-offset", required_argument, NULL, OPT_GHOST_OFFSET},
                                        {"ghost-width", required_argument, NULL, OPT_GHOST_WIDTH},
                                        {"ghost-doubt", required_argument, NULL, OPT_GHOST_DOUBT},
                                        {"exposure", required_argument, NULL, OPT_EXPOSURE},
                                        {"picture", required_argument, NULL, OPT_PICTURE},
                                        {"out", required_argument, NULL, OPT_OUT},
                                        {"panel", required_argument, NULL, OPT_PANEL},
                                        {"few-pictures", no_argument, NULL, OPT_FEW},
                                        {"write", required_argument, NULL, OPT_WRITE},
                                        {"json", required_argument, NULL, OPT_JSON},
                                        HS_GUARD_OPTIONS,
                                        {"help", no_argument, NULL, OPT_HELP},
                                        {0}};

static bool take_source_option(hs_run_line *line, int option, const char *text, hs_error *err) {
    static const char *const paddings[] = {"auto", "none", "all"};
    hs_run_request *r = &line->request;
    uint32_t index = 0;
    switch (option) {
    case OPT_VOLUME:
        return hs_cli_append("--volume", text, line->volumes, &r->volume_count, HS_RUN_MAX_VOLUMES, err);
    case OPT_PADDING:
        if (!hs_cli_pick("--padding", text, paddings, 3, &index, err)) return false;
        r->read.padding = (hs_padding)index;
        line->padding_given = true;
        return true;
    case OPT_WINDOW:
        return hs_value_window(text, &r->read, err);
    case OPT_SCANNED:
        return hs_value_scanned(text, line->scanned, sizeof line->scanned, &r->scanned, err);
    case OPT_MIRROR:
        return (r->kretz.mirrored = true);
    case OPT_SPACING:
        return hs_cli_number("--spacing", text, 0.01, 100, &r->kretz.spacing, err);
    case OPT_PROBE:
        return hs_value_probe(text, &r->read, err);
    case OPT_SCENE:
        r->scene.name = text;
        return true;
    case OPT_SIZE:
        return hs_cli_u32("--size", text, 32, 512, &r->scene.size, err);
    case OPT_SEED:
        return hs_cli_integer("--seed", text, 0, UINT64_MAX, &r->scene.seed, err);
    case OPT_MOVING:
        return hs_cli_u32("--moving", text, 1, 16, &r->scene.volumes, err);
    case OPT_REAL:
        r->scene.real = text;
        return true;
    case OPT_LIVE:
        r->loop.live = true;
        return true;
    default:
        return hs_cli_forgotten(option, err);
    }
}

static bool take_plugin_option(hs_run_line *line, int option, const char *text, hs_error *err) {
    static const char *const carriers[] = {"host", "buffer", "image"};
    static const char *const fans[] = {"ranges", "padding", "nothing"};
    hs_run_request *r = &line->request;
    uint32_t index = 0;
    switch (option) {
    case OPT_PLUGIN:
        r->plugin_path = text;
        return true;
    case OPT_ID:
        r->plugin_id = text;
        return true;
    case OPT_SET:
        return hs_cli_append("--set", text, line->sets, &r->set_count, HS_RUN_MAX_SETS, err);
    case OPT_CARRIER:
        if (!hs_cli_pick("--carrier", text, carriers, 3, &index, err)) return false;
        r->loop.carrier = SV_CARRIER_HOST + index;
        line->carrier_given = true;
        return true;
    case OPT_OWN_QUEUE:
        r->loop.own_queue = true;
        return true;
    case OPT_FAN:
        if (!hs_cli_pick("--fan", text, fans, 3, &index, err)) return false;
        r->loop.fan = (hs_fan)(HS_FAN_RANGES + index);
        return true;
    case OPT_SLAB:
        return hs_cli_u32("--slab", text, 1, 8192, &r->loop.slab_slices, err);
    case OPT_LOWRES:
        return hs_cli_u32("--lowres", text, 1, 8192, &r->loop.lowres, err);
    case OPT_VERBOSE:
        r->log_level = SV_LOG_DEBUG;
        return true;
    default:
        return hs_cli_forgotten(option, err);
    }
}

static bool take_setting(hs_run_request *r, const char *text, hs_error *err) {
    static const char *const names[] = {"dvr", "convert", "smartvis", "all"};
    uint32_t index = 0;
    if (!hs_cli_pick("--setting", text, names, 4, &index, err)) return false;
    for (uint32_t s = 0; s < HS_SETTING_COUNT; s++) r->settings[s] = index == HS_SETTING_COUNT || s == index;
    return true;
}

static bool take_loop_option(hs_run_line *line, int option, const char *text, hs_error *err) {
    hs_run_request *r = &line->request;
    switch (option) {
    case OPT_SETTING:
        return take_setting(r, text, err);
    case OPT_FRAMES:
        return hs_cli_u32("--frames", text, 1, MAX_FRAMES, &r->loop.frames, err);
    case OPT_VIEW:
        return hs_value_view(text, &r->loop, err);
    case OPT_YAW:
        return hs_cli_number("--yaw", text, -360, 360, &r->loop.yaw, err);
    case OPT_PITCH:
        return hs_cli_number("--pitch", text, -360, 360, &r->loop.pitch, err);
    case OPT_ORBIT:
        return hs_cli_number("--orbit", text, -360, 360, &r->loop.orbit, err);
    case OPT_TURNABLE:
        return (r->loop.turnable = true);
    case OPT_ZOOM:
        return hs_cli_number("--zoom", text, 1.0 / HS_LOOP_MAX_ZOOM, HS_LOOP_MAX_ZOOM, &r->loop.zoom, err);
    case OPT_LOOK:
        return hs_look_line_look(text, &line->look, err);
    case OPT_LIGHT:
        return hs_look_line_light(text, r->loop.dvr.light, err);
    case OPT_T_LOW:
        return hs_value_float("--t-low", text, 0, 1, &r->loop.dvr.threshold_low, err);
    case OPT_T_HIGH:
        return hs_value_float("--t-high", text, 0, 1, &r->loop.dvr.threshold_high, err);
    case OPT_GHOST_OFFSET:
        return hs_value_float("--ghost-offset", text, -8192, 8192, &r->loop.dvr.ghost_offset, err);
    case OPT_GHOST_WIDTH:
        return hs_value_float("--ghost-width", text, 0, 8192, &r->loop.dvr.ghost_width, err);
    case OPT_GHOST_DOUBT:
        return hs_value_float("--ghost-doubt", text, 0, (double)HS_DVR_MAX_DOUBT, &r->loop.dvr.ghost_doubt,
                              err);
    case OPT_EXPOSURE:
        return hs_value_float("--exposure", text, 0.1, 10, &line->exposure, err);
    case OPT_PICTURE:
        if (!hs_cli_u32("--picture", text, 16, 2048, &r->loop.dvr.width, err)) return false;
        r->loop.dvr.height = r->loop.dvr.width;
        return true;
    case OPT_PANEL:
        return hs_cli_u32("--panel", text, 64, 1024, &r->panel_cell, err);
    case OPT_FEW:
        r->few_pictures = true;
        return true;
    case OPT_OUT:
        line->out = text;
        return true;
    case OPT_WRITE:
        return hs_result_parse("--write", text, strcmp(text, "all") == 0 ? &r->write_if : &r->write, err);
    case OPT_JSON:
        line->json = text;
        return true;
    default:
        return hs_cli_forgotten(option, err);
    }
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
    if (r->scanned.first && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--scanned %s,%s: is for --volume; a scene has its own fan",
                       line->scanned, r->scanned.end);
    for (uint32_t i = 0; i < r->volume_count; i++) kretz |= hs_kretz_is_file(line->volumes[i]);
    if ((r->kretz.mirrored || r->kretz.spacing > 0.0) && !kretz)
        return hs_fail(err, HS_ERR_USAGE, "%s: is for Kretz files (--volume FILE.vol)",
                       r->kretz.mirrored ? "--mirror" : "--spacing");
    if (r->scanned.first && line->padding_given)
        return hs_fail(err, HS_ERR_USAGE, "--scanned and --padding: give one of them");
    if (r->read.has_probe && r->volume_count == 0)
        return hs_fail(err, HS_ERR_USAGE, "--probe %s: is for --volume; a scene is scanned from slice 0",
                       hs_probe_name(r->read.probe));
    if ((r->write | r->write_if) && r->loop.orbit != 0)
        return hs_fail(err, HS_ERR_USAGE, "--write: needs a camera that stands still, --orbit is %g degrees",
                       r->loop.orbit);
    if (r->loop.dvr.threshold_low >= r->loop.dvr.threshold_high)
        return hs_fail(err, HS_ERR_USAGE, "--t-low %g must be less than --t-high %g",
                       (double)r->loop.dvr.threshold_low, (double)r->loop.dvr.threshold_high);
    return true;
}

bool hs_run_line_parse(int argc, char **argv, hs_run_line *line, hs_error *err) {
    *line = (hs_run_line){.out = "out/run", .look = HS_LOOK_LIT};
    hs_run_defaults(&line->request);
    line->request.loop.frames = 30;
    int option;
    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, ":", options, NULL)) != -1) {
        bool ok = true;
        if (option == OPT_HELP) return (line->help = true);
        if (!hs_cli_known(option, argv, err)) return false;
        if (hs_guard_line_is(option))
            ok = hs_guard_line_take(option, optarg, &line->request.guard, err);
        else if (option <= OPT_LIVE)
            ok = take_source_option(line, option, optarg, err);
        else if (option <= OPT_VERBOSE)
            ok = take_plugin_option(line, option, optarg, err);
        else
            ok = take_loop_option(line, option, optarg, err);
        if (!ok) return false;
    }
    if (!hs_cli_no_more(argc, argv, optind, err) || !check_line(line, err)) return false;
    hs_loop_for_pictures(&line->request.loop, line->look);
    if (line->exposure > 0.0f) line->request.loop.dvr.exposure = line->exposure;
    line->request.volumes = line->volumes;
    line->request.sets = line->sets;
    if (line->request.loop.own_queue && !line->carrier_given) line->request.loop.carrier = SV_CARRIER_HOST;
    line->request.loop.carrier_fixed = line->carrier_given || line->request.loop.own_queue;
    return true;
}

void hs_run_line_help(void) {
    (void)printf("%s%s%s%s", help_head, hs_guard_line_help, help_tail, hs_exit_codes_help);
}
