/* SPDX-License-Identifier: MIT */
/*
 * A random scene is written as a scene file, in the manner of the nine cases: a wall of layers, a sac, a
 * fetus, what lies before it, the artefacts of the scan. Lengths are whole hundredths of a millimetre all
 * the way. Depths that depend on the solids, such as where an occluder ends, are not computed here: the
 * file asks for them by gap_mm.
 */
#include "scene/scene_draw.h"

#include "scene/scene_random.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RANGE(id, ...) [HS_RANGE_##id] = {__VA_ARGS__},
const hs_scene_range hs_scene_ranges[HS_RANGE_COUNT] = {HS_SCENE_RANGES(RANGE)};

int32_t hs_range_draw(uint64_t key, hs_range_id id, uint32_t k) {
    const hs_scene_range *r = &hs_scene_ranges[id];
    const uint64_t count = (uint64_t)((r->high - r->low) / r->step) + 1u;
    const uint64_t bits = hs_random_bits(key, ((uint64_t)id << 8) + k) >> 32;
    return r->low + r->step * (int32_t)(bits * count >> 32);
}

enum {
    ROOM = 16384, /* for the text */
    MIN_EXTENT = 12000,
    UTERUS = 900, /* of uterine wall before the sac */
    BEHIND = 400, /* of it behind the sac */
    BLADDER_WALL = 300,
    DEEP = 4000 /* from a resting fetus' feet to the back of its head, at scale 1 */
};

/* A scene being written. Lengths in hundredths. */
typedef struct {
    uint64_t key;
    char *text;
    size_t used;
    bool fetus, bare, twins, lateral, frontal, bladder;
    int32_t extent, middle;
    int32_t fat, muscle, sac[3]; /* radii */
    int32_t sac_z;               /* the middle's depth */
    int32_t turn;                /* of the first fetus about y */
    int32_t camera;              /* of the camera about y */
    int32_t gap;                 /* of fluid between the nearest occluder and the fetus; below 0 they touch */
    int32_t protrusion;          /* of that occluder into the sac */
} drawn;

static void put(drawn *d, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(drawn *d, const char *format, ...) {
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(d->text + d->used, ROOM - d->used, format, args);
    va_end(args);
    if (length > 0) d->used += (size_t)length;
    if (d->used >= ROOM) d->used = ROOM - 1; /* what is cut off is no JSON, and reading it says so */
}

/* A number of hundredths, written without rounding: -5 is -0.05. */
static void put_number(drawn *d, int32_t value) {
    const uint32_t size = (uint32_t)(value < 0 ? -value : value);
    put(d, "%s%u", value < 0 ? "-" : "", size / 100);
    if (size % 100) put(d, size % 10 ? ".%02u" : ".%u", size % 10 ? size % 100 : size % 100 / 10);
}
static void put_field(drawn *d, const char *key, int32_t value) {
    put(d, ", \"%s\": ", key);
    put_number(d, value);
}
static void put_vector(drawn *d, const char *key, int32_t x, int32_t y, int32_t z) {
    put(d, ", \"%s\": [", key);
    put_number(d, x);
    put(d, ", ");
    put_number(d, y);
    put(d, ", ");
    put_number(d, z);
    put(d, "]");
}

static int32_t draw(const drawn *d, hs_range_id id, uint32_t k) {
    return hs_range_draw(d->key, id, k);
}
/* Whether something with that share is in the scene. */
static bool has(const drawn *d, hs_range_id id) {
    const uint64_t bits = hs_random_bits(d->key, ((uint64_t)id << 8) + 255u) >> 32;
    return (int32_t)(bits * 10000u >> 32) < hs_scene_ranges[id].low;
}

/* Tosses a coin by a bit that is the range's own. */
static bool coin(const drawn *d, hs_range_id id) {
    return hs_random_bits(d->key, ((uint64_t)id << 8) + 254u) >> 63;
}

/* What kind of scene it is. A scene without a fetus has nothing of one, and a bare fetus has nothing
 * before it. */
static void choose(drawn *d) {
    d->fetus = !has(d, HS_RANGE_NO_FETUS);
    d->bare = d->fetus && has(d, HS_RANGE_BARE);
    d->twins = d->fetus && !d->bare && has(d, HS_RANGE_TWINS);
    d->frontal = d->fetus && !d->bare && has(d, HS_RANGE_FRONTAL);
    d->lateral = d->fetus && !d->frontal && has(d, HS_RANGE_LATERAL);
    d->bladder = !d->bare && has(d, HS_RANGE_BLADDER);
    d->fat = draw(d, HS_RANGE_FAT, 0);
    d->muscle = draw(d, HS_RANGE_MUSCLE, 0);
    for (int a = 0; a < 3; a++) d->sac[a] = draw(d, (hs_range_id)(HS_RANGE_SAC_X + a), 0);
    d->sac_z = d->fat + d->muscle + UTERUS + d->sac[2];
    if (d->bladder) d->sac_z += draw(d, HS_RANGE_BLADDER_Z, 0) + BLADDER_WALL;
    d->extent = (d->sac_z + d->sac[2] + BEHIND + 499) / 500 * 500;
    if (d->extent < MIN_EXTENT || d->bare) d->extent = MIN_EXTENT;
    d->middle = d->extent / 2;
    if (d->bare) d->sac_z = d->middle;
    const int32_t side = coin(d, HS_RANGE_CAMERA) ? 1 : -1, away = has(d, HS_RANGE_FROM_BEHIND) ? 18000 : 0;
    d->camera = side * draw(d, HS_RANGE_CAMERA, 0);
    d->turn = draw(d, HS_RANGE_TURN, 0) + (d->frontal ? d->camera : away);
    d->gap = has(d, HS_RANGE_CONTACT) ? -draw(d, HS_RANGE_OVERLAP, 0) : draw(d, HS_RANGE_GAP, 0);
    d->protrusion = draw(d, HS_RANGE_PROTRUSION, 0);
}

/* ---------------------------------------------------------------------------------------- the anatomy -- */

static void put_wall(drawn *d) {
    if (d->bare) {
        put(d, "  \"sac\": { \"centre_mm\": [60, 60, 60], \"radii_mm\": [200, 200, 200] },\n");
        return;
    }
    put(d, "  \"sac\": { \"roughness_scale_mm\": 45");
    put_vector(d, "centre_mm", d->middle, d->middle, d->sac_z);
    put_vector(d, "radii_mm", d->sac[0], d->sac[1], d->sac[2]);
    put_field(d, "roughness_mm", draw(d, HS_RANGE_ROUGHNESS, 0));
    put(d, " },\n  \"layers\": { \"list\": [{ \"tissue\": \"fat\"");
    put_field(d, "thickness_mm", d->fat);
    put(d, " }, { \"tissue\": \"muscle\"");
    put_field(d, "thickness_mm", d->muscle);
    put(d, " }]");
    put_field(d, "undulation_mm", draw(d, HS_RANGE_UNDULATION, 0));
    put(d, " },\n");
}

/* How far a limb is stretched to the probe. */
static int32_t stretched(const drawn *d, uint32_t body) {
    return has(d, HS_RANGE_LIMB_FORWARD) ? draw(d, HS_RANGE_FORWARD, body) : 0;
}

/* The joints of hs_fetus_resting in hundredths, each a little off; one limb may be stretched to the probe. */
static void put_pose(drawn *d, uint32_t body) {
    static const struct {
        const char *name;
        int32_t at[3];
    } joints[8] = {{"right_elbow", {-2100, 1000, -700}}, {"left_elbow", {2100, 1100, -600}},
                   {"right_hand", {-700, 100, -1900}},   {"left_hand", {900, -500, -1800}},
                   {"right_knee", {-1500, 2100, -1800}}, {"left_knee", {1600, 2300, -1700}},
                   {"right_ankle", {300, 4000, -1900}},  {"left_ankle", {-400, 4400, -1400}}};
    const uint32_t limb =
        2 + (uint32_t)(hs_random_bits(d->key, ((uint64_t)HS_RANGE_LIMB_FORWARD << 8) + body) >> 62);
    const int32_t forward = stretched(d, body);
    for (uint32_t j = 0; j < 8; j++) {
        int32_t p[3];
        for (uint32_t a = 0; a < 3; a++)
            p[a] = joints[j].at[a] + draw(d, HS_RANGE_JOINT, 64 * body + 3 * j + a);
        if (j == limb) p[2] -= forward;
        if (j == limb + 2 && limb >= 4) p[2] -= forward; /* the ankle goes with its knee */
        put_vector(d, joints[j].name, p[0], p[1], p[2]);
    }
}

/* How far the skin lies behind the wall where it is nearest to it. The fetus is not to be pressed into
 * the sac's far side, and where its head lies, the sac is about nine tenths as deep. */
static int32_t wall_gap(const drawn *d, uint32_t body, int32_t scale) {
    if (has(d, HS_RANGE_LIMB_CONTACT)) return -draw(d, HS_RANGE_OVERLAP, 8 + body);
    const int32_t maximum = 177 * d->sac[2] / 100 - (DEEP + stretched(d, body)) * scale / 100;
    const int32_t wanted = (d->gap > 0 ? d->gap : 0) + d->protrusion;
    return wanted < maximum ? wanted : maximum > 0 ? maximum : 0;
}

static void put_fetus(drawn *d, uint32_t body, int32_t aside) {
    const int32_t scale = draw(d, d->twins ? HS_RANGE_TWIN_SCALE : HS_RANGE_SCALE, body);
    put(d, "    { \"type\": \"fetus\"");
    put_vector(d, "position_mm", d->middle + aside + draw(d, HS_RANGE_PLACE, 4 * body),
               d->middle + 300 + draw(d, HS_RANGE_PLACE, 4 * body + 1), d->bare ? d->middle : d->sac_z);
    put_vector(d, "rotation_deg", draw(d, HS_RANGE_NOD, 4 * body),
               body ? draw(d, HS_RANGE_TURN, body) : d->turn, draw(d, HS_RANGE_NOD, 4 * body + 1));
    put_field(d, "scale", scale);
    if (!d->bare) put_field(d, "gap_mm", wall_gap(d, body, scale));
    put_pose(d, body);
    put(d, " },\n");
}

/* Of the first one the gap is the scene's; the others leave as much or more. All are so deep that they
 * hang from the wall wherever their gap puts their end. */
static void put_occluder(drawn *d, uint32_t i) {
    const int32_t across = draw(d, HS_RANGE_ACROSS, 2 * i), deep = 2000 + d->protrusion / 2;
    const int32_t further = draw(d, HS_RANGE_GAP, 1 + i), front = d->sac_z - d->sac[2];
    put(d, "    { \"type\": \"occluder\", \"tissue\": \"placenta\"");
    put_vector(d, "centre_mm", d->middle + draw(d, HS_RANGE_ASIDE, 2 * i),
               d->middle + draw(d, HS_RANGE_ASIDE, 2 * i + 1), front + d->protrusion - deep);
    put_vector(d, "radii_mm", across, draw(d, HS_RANGE_ACROSS, 2 * i + 1), deep);
    put_field(d, "blend_mm", draw(d, HS_RANGE_BLEND, i));
    put_field(d, "echo_db", draw(d, HS_RANGE_BRIGHTNESS, i));
    if (has(d, HS_RANGE_SOFT)) put_field(d, "soft_mm", draw(d, HS_RANGE_SOFT_MM, i));
    if (d->fetus && !has(d, HS_RANGE_LIMB_CONTACT))
        put_field(d, "gap_mm", i == 0 || further < d->gap ? d->gap : further);
    put(d, " },\n");
}

/* Puts what floats in the fluid behind the occluders. */
static void put_floating(drawn *d) {
    const int32_t room = d->gap > 300 ? d->gap : 300, z = d->sac_z - d->sac[2] + d->protrusion + room / 2;
    if (has(d, HS_RANGE_CLOUD)) {
        put(d, "    { \"type\": \"cloud\", \"particle_min_mm\": 0.8, \"particle_max_mm\": 2.2");
        put_vector(d, "centre_mm", d->middle + draw(d, HS_RANGE_ASIDE, 20),
                   d->middle + draw(d, HS_RANGE_ASIDE, 21), z);
        put_vector(d, "radii_mm", 1600, 1200, room / 3);
        put_field(d, "count", draw(d, HS_RANGE_PARTICLES, 0));
        put(d, " },\n");
    }
    if (has(d, HS_RANGE_CORD)) {
        put(d, "    { \"type\": \"cord\", \"points_mm\": [");
        for (int32_t i = 0; i < 5; i++) {
            put(d, "%s[", i ? ", " : "");
            put_number(d, d->middle - 3600 + 1800 * i);
            put(d, ", ");
            put_number(d, d->middle + draw(d, HS_RANGE_ASIDE, 30 + (uint32_t)i));
            put(d, ", ");
            put_number(d, z + draw(d, HS_RANGE_JOINT, 200 + (uint32_t)i) + (i % 4 ? 0 : 600));
            put(d, "]");
        }
        put(d, "]");
        put_field(d, "radius_mm", draw(d, HS_RANGE_CORD_RADIUS, 0));
        put(d, " },\n");
    }
}

static void put_bladder(drawn *d) {
    const int32_t x = draw(d, HS_RANGE_BLADDER_X, 0), z = draw(d, HS_RANGE_BLADDER_Z, 0);
    put(d, "    { \"type\": \"bladder\"");
    put_vector(d, "centre_mm", d->middle + draw(d, HS_RANGE_ASIDE, 40) / 2,
               d->middle + 1500 + draw(d, HS_RANGE_ASIDE, 41) / 2, d->fat + d->muscle + z);
    put_vector(d, "radii_mm", x, 2 * x / 3, z);
    put_field(d, "wall_mm", BLADDER_WALL);
    put(d, " },\n");
}

static void put_structures(drawn *d) {
    const uint32_t occluders = d->bare ? 0 : (uint32_t)draw(d, HS_RANGE_OCCLUDERS, 0) / 100;
    put(d, "  \"structures\": [\n");
    for (uint32_t i = 0; i < occluders; i++) put_occluder(d, i);
    if (d->bladder) put_bladder(d);
    if (d->fetus) put_fetus(d, 0, d->twins ? -2400 : 0);
    if (d->twins) put_fetus(d, 1, 2400);
    if (d->fetus && !d->bare && has(d, HS_RANGE_NUCHAL)) {
        put(d, "    { \"type\": \"nuchal_cord\"");
        put_field(d, "loops", draw(d, HS_RANGE_LOOPS, 0));
        put_field(d, "radius_mm", draw(d, HS_RANGE_CORD_RADIUS, 1));
        put(d, " },\n");
    }
    if (!d->bare) put_floating(d);
    if (d->text[d->used - 2] == ',') d->used -= 2; /* the last has no comma */
    put(d, "\n  ],\n");
}

/* -------------------------------------------------------------------------------------- the artefacts -- */

/* One field of an artefact; the list ends with a key of NULL. */
typedef struct {
    const char *key;
    hs_range_id id;
} field;

static void put_artefact(drawn *d, const char *type, const field *fields) {
    put(d, "    { \"type\": \"%s\"", type);
    for (; fields->key; fields++) put_field(d, fields->key, draw(d, fields->id, 0));
    put(d, " },\n");
}

static void put_artefacts(drawn *d) {
    static const field attenuation[] = {{"tgc_db_cm_mhz", HS_RANGE_TGC}, {0}};
    static const field haze[] = {{"level_db", HS_RANGE_HAZE_LEVEL},
                                 {"decay_db_mm", HS_RANGE_HAZE_DECAY},
                                 {"patch_db", HS_RANGE_HAZE_PATCH},
                                 {0}};
    static const field thick[] = {{"elevation_mm", HS_RANGE_ELEVATION},
                                  {"focus_mm", HS_RANGE_THICK_FOCUS},
                                  {"rayleigh_mm", HS_RANGE_THICK_RAYLEIGH},
                                  {0}};
    static const field corner[] = {
        {"loss_db", HS_RANGE_CORNER_LOSS}, {"direction_deg", HS_RANGE_CORNER_TURN}, {0}};
    static const field noise[] = {{"level_db", HS_RANGE_NOISE}, {0}};
    put(d, "  \"artefacts\": [\n");
    if (d->bare) /* the more of the way is fluid, the less is to be compensated for */
        put(d, "    { \"type\": \"attenuation\", \"tgc_db_cm_mhz\": 0.05 },\n");
    else
        put_artefact(d, "attenuation", attenuation);
    if (has(d, HS_RANGE_EDGE)) put(d, "    { \"type\": \"edge_shadow\", \"max_loss_db\": 8 },\n");
    if (!d->bare && has(d, HS_RANGE_REVERBERATION))
        put(d, "    { \"type\": \"reverberation\", \"count\": 2, \"loss_db\": 9, \"spacing_mm\": 4 },\n");
    if (!d->bare && has(d, HS_RANGE_HAZE)) put_artefact(d, "haze", haze);
    if (has(d, HS_RANGE_CORNER)) put_artefact(d, "dark_corner", corner);
    if (has(d, HS_RANGE_THICK)) put_artefact(d, "slice_thickness", thick);
    if (has(d, HS_RANGE_SIDE_LOBES))
        put(d, "    { \"type\": \"side_lobes\", \"level_db\": -26.5, \"width_mm\": 12 },\n");
    put(d, "    { \"type\": \"speckle\", \"rayleigh_mm\": 60");
    put_field(d, "axial_mm", draw(d, HS_RANGE_AXIAL, 0));
    put_field(d, "lateral_mm", draw(d, HS_RANGE_LATERAL_MM, 0));
    put_field(d, "focus_mm", draw(d, HS_RANGE_FOCUS, 0));
    put(d, " },\n");
    put_artefact(d, "noise", noise);
    put(d, "    { \"type\": \"fan\", \"azimuth_deg\": 62, \"sweep_deg\": 60, \"azimuth_radius_mm\": 60, "
           "\"sweep_radius_mm\": 62");
    put_field(d, "depth_mm", d->extent - 700);
    put(d, " }\n  ]\n}\n");
}

/* Gives every tissue an echo of its own. What the probe, the wall and the fetus are made of says nothing then
 * of how bright they are. */
static void put_greys(drawn *d) {
    static const char *const tissues[] = {"wall",  "fat",  "muscle", "placenta", "cord",
                                          "cloud", "soft", "brain",  "bone"};
    put(d, "  \"tissues\": {");
    for (uint32_t i = 0; i < sizeof tissues / sizeof *tissues; i++) {
        put(d, "%s\"%s\": { \"echo_db\": ", i ? ", " : " ", tissues[i]);
        put_number(d, draw(d, HS_RANGE_GREY, i));
        put(d, " }");
    }
    put(d, " },\n");
}

/* --------------------------------------------------------------------------------------------- a file -- */

static void put_title(drawn *d) {
    put(d, "  \"title\": \"Random: %s%s%s%s%s%s.\",\n",
        !d->fetus  ? "no fetus"
        : d->bare  ? "a fetus that nothing hides"
        : d->twins ? "twins"
                   : "a fetus",
        d->lateral   ? ", seen from the side of the beams"
        : d->frontal ? ", a profile to the probe, its face to the camera"
                     : "",
        d->bladder ? ", behind a bladder" : "",
        d->fetus && !d->bare && d->gap < 0 ? ", touched by an occluder" : "",
        d->fetus && !d->bare && has(d, HS_RANGE_LIMB_CONTACT) ? ", touching the wall" : "",
        d->fetus && !d->bare && has(d, HS_RANGE_NUCHAL) ? ", the cord round its neck" : "");
}

char *hs_scene_draw(const hs_scene_drawn *s) {
    drawn d = {.key = hs_random_key(hs_random_key(s->seed, 7000), s->number), .text = malloc(ROOM)};
    if (!d.text) return NULL;
    choose(&d);
    put(&d, "{\n  \"name\": \"%c%" PRIu64 "_%" PRIu32 "\",\n", s->greys ? 'G' : 'R', s->seed, s->number);
    put_title(&d);
    put(&d, "  \"seed\": %" PRIu64 ",\n  \"extent_mm\": %d", 1 + (hs_random_bits(d.key, ~UINT64_C(0)) >> 13),
        d.extent / 100);
    if (d.lateral || d.frontal) put_vector(&d, "camera_deg", 0, d.camera, 0);
    put_field(&d, "frequency_mhz", draw(&d, HS_RANGE_FREQUENCY, 0));
    put(&d, ",\n  \"display\": { \"specular_db\": 6, \"specular_power\": 2");
    put_field(&d, "dynamic_range_db", draw(&d, HS_RANGE_DYNAMIC, 0));
    put_field(&d, "gain_db", draw(&d, HS_RANGE_GAIN, 0));
    put(&d, " },\n");
    if (s->greys) put_greys(&d);
    put_wall(&d);
    put_structures(&d);
    put_artefacts(&d);
    return d.text;
}

bool hs_scene_drawn_name(const char *name, hs_scene_drawn *s) {
    char again[64];
    unsigned long long seed;
    unsigned int number;
    if ((*name != 'R' && *name != 'G') || sscanf(name + 1, "%19llu_%5u", &seed, &number) != 2) return false;
    *s = (hs_scene_drawn){*name == 'G', seed, number};
    (void)snprintf(again, sizeof again, "%c%llu_%u", *name, seed, number);
    return number < HS_SCENE_MAX_DRAWN && strcmp(again, name) == 0;
}
