/* SPDX-License-Identifier: MIT */
/* What judges surfaces: cases with their truth, scores, sites, a plugin at work on them. */
#pragma once

#include "eval/eval_case.h"
#include "plugin/loader.h"
#include "ref/ref_wall.h"
#include "render/host_kernels.h"
#include "scene/scene.h"
#include "stage/stage.h"
#include "wall_layout.h"

#include <stddef.h>

/* ----------------------------------------------------------------------------------------------- cases -- */
/* A volume with its ground truth, to judge the definition of the wall's surface on: from files or from a
 * scene. */

typedef struct {
    char name[64];
    uint32_t nx, ny, nz;
    double spacing_mm[3];
    uint8_t *full;         /* nx * ny * nz voxels */
    uint16_t *first, *end; /* scanned slices of each ray */
    uint8_t *label;        /* per ray: 0 neither, 1 sac, 2 fetus; NULL: no truth is known */
    float *truth;          /* per ray: slice at which it ends in the ground truth; NULL with `label` */
    uint8_t *clean;        /* the ground truth: `full` without what hides; NULL with `label` */
    float *near, *far;     /* per labelled ray: the admissible clipping depths, slices; NULL: not known */
    sv_frame told;         /* what its frame tells of probe and beams; zeros: nobody knows */
} wall_case;

/* Copies a case of the report: its volume, truth and label. Voxels of 0 were not scanned. */
bool wall_case_take(const hs_eval_source *source, wall_case *out, hs_error *err);

/* Reads "FULL,TRUTH,LABEL[,FIRST,END]" as `host_sim report --case` does (eval/eval_case.h), with its
 * errors. With maps the voxels are the file's, so black fluid is 0; without, scanned voxels are 1 .. 255. */
bool wall_case_files(const char *files, wall_case *out, hs_error *err);

/* Reads NAME_full.mha, NAME_truth.mha, NAME_label.mha, NAME_first.mha and NAME_end.mha of a folder so, too;
 * scan_first.mha and scan_end.mha in place of the last two. NAME_near.mha and NAME_far.mha, if both are
 * there, are the admissible depths. */
bool wall_case_read(const char *folder, const char *name, wall_case *out, hs_error *err);

/* Makes an empty file "<$TMPDIR or /tmp>/<stem>_<six characters><ending>" that no other has and only its
 * owner may read, and writes its path to out. Returns its descriptor; -1 with HS_ERR_OUTPUT. The caller
 * closes it and removes the file. */
int judge_temporary(const char *stem, const char *ending, char *out, size_t bytes, hs_error *err);

/* Makes a scene of 128^3 voxels. `pose` 0: the scene as its file has it; else fetus, limbs, occluders and sac
 * are shifted (by up to 4 mm), turned (8 degrees) and scaled (4 %), by numbers that `pose` seeds. `frame` of
 * its motion. Zeros at the ends of a ray were not scanned. HS_ERR_INPUT, HS_ERR_OUTPUT, HS_ERR_MEMORY. */
bool wall_case_make(const char *scene, uint64_t seed, uint32_t pose, uint32_t frame, wall_case *out,
                    hs_error *err);

/* The same of a scene that is made: takes its arrays. */
bool wall_case_scene(hs_scene_data *data, const char *name, wall_case *out, hs_error *err);

/* A volume without a truth; the zeros at the ends of each ray were not scanned. */
bool wall_case_open(const char *path, wall_case *out, hs_error *err);

/* Resamples the volume for a camera that is turned by `degrees` about axis 0 (x), 1 (y) or 2 (z, then looked
 * at from the side): a cube of `side`^3 voxels that holds all of it. */
bool wall_case_turn(const wall_case *from, int axis, double degrees, uint32_t side, wall_case *out,
                    hs_error *err);

/* Grey levels become 255 (level / 255)^gamma * gain + black, at scanned voxels only. */
void wall_case_change(wall_case *c, double gain, double gamma, double black);

/* The first scanned slices of every ray become level * gain + black: gel, a dead zone, a skin line. */
void wall_case_change_near(wall_case *c, uint32_t slices, double gain, double black);

void wall_case_free(wall_case *c);

/* A case like another with room for everything, `lead` slices longer; all zeros, no admissible depths. */
bool wall_case_room(const wall_case *from, uint32_t lead, wall_case *out, hs_error *err);

/* The full volume as the wall's definition takes it; borrows the case's arrays. */
sv_wall_volume wall_case_volume(const wall_case *c);

/* -------------------------------------------------------------------------------------- turned cameras -- */
/* Another pose of a camera before a case whose truth is known: a check on data that nobody made for it. */

/* The case as a camera sees it that is turned by `degrees` about x and then about y, around the middle of the
 * volume: as many voxels of the same size; what comes to lie outside of them is lost. A voxel was scanned if
 * all eight around its place were. Rays end where they do in the turned ground truth; a ray's label is that
 * of the ray of `c` that ends in the same place, at most two rays and three slices away, else none. In that
 * truth what hides is removed along the rays of `c`, so turns should be small. False: no memory, and `c` is
 * as it was. */
bool wall_case_tilt(wall_case *c, const double degrees[2], hs_error *err);

/* ---------------------------------------------------------------------------------------------- scores -- */
/* How good a surface is: Eq. 4.6 of the thesis, how much of the fetus is cut and of occluders is left, and
 * whether the confidence predicts errors. */

/* Bins of the confidence. Most of it is above 0.98, where coarse bins would merge different values. */
#define WALL_BINS 2048

typedef struct {
    double error; /* mean over labelled rays of |end in the result - end in the truth|, slices of 128 */
    double cut;   /* share of the fetus' rays that end more than 2 slices too deep */
    double left;  /* share of the labelled rays that end more than 2 slices too early */
    double fetus; /* the error of the fetus' rays alone */
    /* By the admissible depths, which know nothing of a renderer, so haze in the sac is neither: shares of
     * the fetus' rays whose surface lies more than 2 mm behind `far`, and in front of `near`. NAN: not known.
     */
    double deep, shallow;
    double confidence; /* mean over the labelled rays */
} wall_score;

/* Labelled rays by confidence: right ones (error at most 2 slices), wrong ones, and those of these that end
 * too deep. Scores are added to it. */
typedef struct {
    uint64_t right[WALL_BINS], wrong[WALL_BINS], cut[WALL_BINS];
} wall_calibration;

void wall_calibration_add(wall_calibration *to, const wall_calibration *from);

/* Slice at which ray `pixel` ends when it starts at a surface of that depth. */
float wall_ray_end(const wall_case *c, const uint8_t *voxels, size_t pixel, float depth);

wall_score wall_judge(const wall_case *c, const uint8_t *original, const float *depth,
                      const float *confidence, wall_calibration *calibration);

/* Area under the ROC curve of the confidence as a predictor of wrong rays, or of some of them. */
typedef enum { WALL_WRONG, WALL_CUT, WALL_LEFT } wall_fault;
double wall_auc(const wall_calibration *t, wall_fault fault);

/* ------------------------------------------------------------------------------------ scores of a site -- */
/* What judgements add up to over the cases of a site. */

/* What a method says of a volume; doubtful: whether it clips or not. */
typedef enum { SURF_SURE, SURF_DOUBTFUL, SURF_REFUSED, SURF_ANSWERS } surf_answer;
surf_answer surf_answer_of(uint32_t reason, bool clips);

/* Sums of wall_judge's scores. Zeroed: none yet. */
typedef struct {
    wall_score sum;
    double worst, surest; /* error of a case; mean confidence of one of which more than a tenth is cut */
    char worst_name[64], surest_name[64];
    double worst_cut;
    uint32_t count, harmed; /* of which more than 2 % of the fetus' rays are cut */
    uint32_t refused;       /* cases that the method does not clip */
    uint32_t answers[SURF_ANSWERS];
    wall_calibration calibration;
} site_score;

void site_score_add(site_score *to, const char *name, const wall_score *score);

/* The means: error in slices of 128; cut and left as shares. */
wall_score site_score_mean(const site_score *score);

/* Prints "error / cut / left, worst case", and with `sure` the confidence's AUC and what the next one prints:
 * the surest case of which more than a tenth is cut, if there is one. */
void site_score_print(const site_score *score, bool sure);
void site_score_print_surest(const site_score *score);

/* Prints the error of the fetus' rays, and what the admissible depths say if all cases have them. */
void site_score_print_fetus(const site_score *score);

/* Prints, for every tenth of the confidence that has at least 100 rays, what it says on average, how many
 * rays are right there and their share of all. */
void site_score_print_calibration(const char *what, const wall_calibration *t);

/* ----------------------------------------------------------------------------------------------- sites -- */
/* The sites that surfaces are judged on: sets of cases from scenes, folders and files. */

enum { SITE_NAMES = 9, SITE_MAX_SETS = 8, SITE_MAX_CASES = 128 };

/* E01 .. D02. */
extern const char *const site_names[SITE_NAMES];

/* Cases that are read or made at once. Owned. */
typedef struct {
    char title[160];
    wall_case *cases;
    uint32_t count;
} site_set;

/* All sets of a command line. A zeroed list is empty. */
typedef struct {
    site_set set[SITE_MAX_SETS];
    uint32_t count;
} site_list;

/* Adds the cases of a folder as a set of its own: every NAME_full.mha (wall_case_read). */
bool site_add_folder(site_list *list, const char *folder, hs_error *err);

/* Adds one case, FULL,TRUTH,LABEL[,FIRST,END], to the set of files. */
bool site_add_files(site_list *list, const char *files, hs_error *err);

/* True for the set of site_add_files. */
bool site_is_files(const site_set *set);

/* Adds the nine scenes at 128^3 of "SEED,POSE" to the set of scenes. */
bool site_add_scenes(site_list *list, const char *seed_and_pose, hs_error *err);

/* Adds a scene by its name or path, as hs_scene_open takes it, at its own seed, to the set of scenes. */
bool site_add_scene(site_list *list, const char *name, hs_error *err);

/* The same for the scenes 0 .. COUNT - 1 of "SEED,COUNT". `set`: R, random scenes, or G, random greys. */
bool site_add_random(site_list *list, char set, const char *seed_and_count, hs_error *err);

void site_free(site_list *list);

/* --------------------------------------------------------------------------------------------- session -- */
/* A plugin at work on cases in memory, known by its ABI only: one instance with its settings, active for
 * whatever size came last. */

typedef enum { SURF_NOTHING, SURF_POSE, SURF_BEAMS } surf_told;

/* Owned by the caller; must not move while open. */
typedef struct {
    hs_plugin plugin;
    hs_eval_values values;
    stage stage; /* `told` is what frames tell of probe and beams */
    bool active;
    double spacing_mm[3];
    sv_scanned *scanned;
    const float *depth; /* of the last frame, slices; all 0 if it has no surface */
    float *confidence;  /* the same: 0 .. 1; all 0 if there is none */
    bool sure;          /* the method gives a confidence */
    sv_status outcome;
    surf_told told; /* how much of wall_case.told it is told */
    surf_answer answer;
} surf_session;

/* Opens a library; `settings` are "key=value" texts, parted by spaces. HS_ERR_PLUGIN or HS_ERR_USAGE. */
bool surf_session_open(surf_session *s, const char *path, const char *settings, hs_error *err);
void surf_session_close(surf_session *s);
bool surf_session_set(surf_session *s, const char *key, double value, hs_error *err);

/* A whole frame, with its confidence. A status of "no surface" is a success. */
bool surf_session_frame(surf_session *s, const wall_case *c, hs_error *err);

/* False if the frame that was just run has no surface. */
bool surf_session_clips(const surf_session *s);

/* ----------------------------------------------------------------------------------------------- table -- */
/* Methods of a plugin on every site, one setting for all cases. */

enum { SITE_MAX_METHODS = 8 };

/* A method: settings as "key=value", parted by spaces. */
typedef struct {
    const char *settings;
    bool best_q; /* at the single q that gives the least mean error over the set */
} site_method;

typedef struct {
    const char *plugin;
    site_method method[SITE_MAX_METHODS];
    uint32_t count;
} site_methods;

/* The mean filter at its best q, and `wall`. */
site_methods site_methods_default(const char *plugin);

/* Judges a frame of an open session, and adds what comes of it to `to`. */
bool site_judge_case(surf_session *s, const wall_case *c, site_score *to, wall_score *score, hs_error *err);

/* Judges an open session on a set; `q` gets the best one, or -1 if the method is taken as it is set. `each`
 * (count numbers, may be NULL) gets every case's score. */
bool site_judge(surf_session *s, const site_set *set, bool best_q, site_score *out, double *q,
                wall_score *each, hs_error *err);

/* Prints the table, every case's errors, and how well the confidences are calibrated. */
bool site_table(const site_list *list, const site_methods *methods, hs_error *err);

/* ----------------------------------------------------------------------------------------------- scans -- */
/* What a person who scans gets: verdicts and surfaces with beams told, the pose alone, nothing. */

/* Prints a row for every set, method and what is told. Then the volumes from turned cameras, as a host hands
 * them over: FILE with FILE_label.mha beside it (voxels: 1, 5 tissue, 2 fluid, 3 fetus, 4 cord, 6 and more
 * doubtful) by its labels from 23 views; others, which nothing hides, from 54; and an orbit of 200 frames. */
bool site_scans(const site_list *list, const char *const *volumes, uint32_t count,
                const site_methods *methods, hs_error *err);

/* -------------------------------------------------------------------------------------------- marks -- */
/* A user who knows the truth puts marks on the largest wrong regions, as the console's brush does. Each is
 * the best of twelve: on one of the three largest regions, of 3, 5, 8 or 12 mm; none if all are worse. */

/* Where a ray may be clipped, mm from the first slice: low .. high was scanned, near .. far is right. high 0:
 * it is not judged. */
typedef struct {
    double low, near, far, high;
} scan_ray;

/* How much is left (> 0) or cut (< 0) of a ray that is clipped at a depth of so many mm. */
double site_scan_off(const scan_ray *ray, double depth);

/* Slices of 128, or mm, by which a ray may be off; and what came of rays by it: their sums. */
#define SITE_TOLERANCE 2.0
typedef struct {
    double rays, fetus, error, cut, left;
} site_sum;

/* Adds a ray: so much of an occluder is left (> 0), or so much of what it should end on is cut. */
void site_count(site_sum *sum, double off, bool of_fetus);

/* What the user looks at: a volume as a camera sees it, with either kind of truth. Square maps. */
typedef struct {
    hs_volume volume;
    hs_camera camera;
    uint32_t n[3];
    const wall_case *c; /* NULL: */
    const scan_ray *rays;
} site_play;

enum { MARK_ROWS = 4 };
extern const uint32_t mark_rows[MARK_ROWS]; /* after 0, 1, 3 and 6 marks */

/* Error in slices of 128, of scans in mm; shares of rays that are more than 2 of them off. */
typedef struct {
    double error, cut, left;
} mark_score;

/* Zeroed: none yet. */
typedef struct {
    mark_score sum[MARK_ROWS];
    uint32_t count;
} mark_scores;

/* Plays from a depthmap on, and adds the scores. A map that does not clip has no marks. HS_ERR_MEMORY. */
bool site_play_marks(const site_play *play, const float *depth, bool clips, mark_scores *to, hs_error *err);
void site_print_marks(const char *what, const char *unit, const mark_scores *scores);

/* Prints the means of every set; and of volumes with labels, from nine views up to 20 degrees. */
bool site_marks(const site_list *list, const char *const *volumes, uint32_t count,
                const site_methods *methods, hs_error *err);

/* ------------------------------------------------------------------------------------------ do no harm -- */
/* Do no harm: what methods do where there is nothing to remove, or something that only looks like it. */

/* Prints for every method: the variants of every case (bare, without a fetus, with a bladder), and `count`
 * volumes that nothing hides, MetaImage files, from all sides, with and without scanned ranges, behind fluid
 * and behind occluders. */
bool site_harm(const site_list *list, const char *const *volumes, uint32_t count, const site_methods *methods,
               hs_error *err);

/* ------------------------------------------------------------------------------------------- sequences -- */
/* How calm a surface is in a moving scene: what the renderings flicker beyond the truth's. */

/* The set of files in `list` as the frames of one sequence, or without one four scenes that move, 20
 * frames each. Prints for every method and scene the mean over labelled rays of |end in this frame - end
 * in the one before|, slices of 128, less the same of the ground truth. A method at its best q takes the
 * one that is best for these frames. Nothing remembers unless its settings say so. */
bool site_flicker(const site_list *list, const site_methods *methods, hs_error *err);

/* -------------------------------------------------------------------------------------------- commands -- */

/* What the definition of wall is given: other constants, other grey levels 255 (level / 255)^gamma * gain +
 * black, a camera that is turned by so many degrees about x and y. */
typedef struct {
    sv_wall_settings settings;
    double gain, gamma, black, tilt[2];
    double near_slices, near_gain, near_black; /* and another near field */
    bool beams;                                /* it is told what a case knows of its beams */
} wall_change;

wall_change wall_change_none(void);

/* Takes "KEY=NUMBER", a constant or one of the others above. HS_ERR_USAGE. */
bool wall_change_set(wall_change *change, const char *text, hs_error *err);

enum { JUDGE_MAX_VOLUMES = 16 };

/* A command line of sv_judge. */
typedef struct {
    const struct command *command;
    site_list sites;
    site_methods methods;
    const char *volumes[JUDGE_MAX_VOLUMES]; /* MetaImage files that nothing hides */
    uint32_t volume_count;
    wall_change wall;
    bool help;
} judge_request;

/* The definition of wall on every case, with what it knows of it. */
bool judge_wall(judge_request *request, hs_error *err);
