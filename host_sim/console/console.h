/* SPDX-License-Identifier: MIT */
/* The console: what a page wants to see, what it is told, and who draws for it. */
#pragma once

#include "console/served_files.h"
#include "core/error.h"
#include "guarded/guarded.h"
#include "loop/loop.h"
#include "loop/screen.h"
#include "loop/view.h"
#include "picture/picture.h"
#include "render/camera.h"
#include "render/dvr_settings.h"
#include "result/result_write.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* ----------------------------------------------------------------------------------------------- state -- */
/* What a page of the console wants to see. It is sent whole, so the newest one holds and nothing else is
 * needed. */

enum {
    HS_CONSOLE_KEY = 64,      /* bytes of a parameter's key */
    HS_CONSOLE_VALUES = 96,   /* parameters of a lane */
    HS_CONSOLE_LANES = 2,     /* settings side by side */
    HS_CONSOLE_THICK = 20,    /* mm of a slice, at most */
    HS_CONSOLE_PICTURE = 1024 /* pixels of a picture's side, at most; 16 at least */
};

/* What can be drawn; lane 1 has a result and a depthmap of its own. */
typedef enum {
    HS_CONSOLE_RESULT,
    HS_CONSOLE_FULL,
    HS_CONSOLE_TRUTH,
    HS_CONSOLE_DEPTH,
    HS_CONSOLE_ACROSS, /* the slices of show/picture_slices.h */
    HS_CONSOLE_ALONG,
    HS_CONSOLE_DEEP,
    HS_CONSOLE_OTHER, /* the result of lane 1 */
    HS_CONSOLE_VIEWS
} hs_console_view;

/* "result", "full", "truth", "depthmap", "across", "along", "deep", "other". */
const char *hs_console_view_name(hs_console_view view);

typedef struct {
    char key[HS_CONSOLE_KEY];
    double value;
} hs_console_value;

/* A plugin and its parameters; those that are not named have their defaults. */
typedef struct {
    bool used;
    uint32_t plugin; /* index among those that the console offers */
    uint32_t count;
    hs_console_value values[HS_CONSOLE_VALUES];
} hs_console_lane;

/* Where volumes come from: a built-in scene, or a file of the list. */
typedef struct {
    char scene[16];             /* "": a file */
    uint32_t size, volumes;     /* of a scene: voxels per axis, volumes of its motion */
    uint32_t folder;            /* of a file: index among the folders of the command line */
    char path[HS_CONSOLE_PATH]; /* its path in there */
    hs_from from;
} hs_console_source;

typedef struct {
    uint64_t serial; /* the page's own count, told back */
    hs_console_source source;
    double yaw, pitch, roll, zoom; /* degrees; hs_loop_options.zoom */
    uint32_t views;                /* bits 1 << HS_CONSOLE_* */
    uint32_t picture, draft;       /* pixels of a picture's side, at rest and under way */
    bool hurried;                  /* a hand is on a control: drafts */
    bool playing;
    double speed;        /* volumes a second */
    uint32_t index;      /* the volume while it does not play */
    double cross[3];     /* where the slices lie, 0 .. 1 of the picture's window: right, down, away */
    double thick;        /* mm that slices are averaged over; 0: one voxel */
    hs_dvr_settings dvr; /* but for the picture's size */
    hs_console_lane lane[HS_CONSOLE_LANES]; /* lane 0 is always used */
    hs_mark marks[HS_MARKS_MAX];            /* for all lanes */
    uint32_t mark_count;
    hs_crop crop; /* what is looked at */
} hs_console_state;

/* -------------------------------------------------------------------------------------------- messages -- */
/* Messages of a page, from text to values. A pure function: nothing is read, opened or kept.
 * state.js has the fields of a state. */

#define HS_CONSOLE_MAX_MESSAGE 16384u /* bytes */

typedef enum {
    HS_CONSOLE_SAYS_STATE, /* what to show from now on */
    HS_CONSOLE_SAYS_SEEN,  /* the page has painted frame `seen` */
    HS_CONSOLE_SAYS_DO     /* something once: */
} hs_console_says;

typedef enum {
    HS_CONSOLE_SNAPSHOT, /* sends `view` as a PNG */
    HS_CONSOLE_WRITE,    /* writes results: `write` */
    HS_CONSOLE_MARK      /* tells where in the volume `mark` is that was put `at` this place of `view` */
} hs_console_deed;

typedef struct {
    hs_console_says says;
    hs_console_state state;
    uint64_t seen;
    hs_console_deed deed;
    hs_console_view view;
    hs_mark mark; /* its place is still to be found */
    double at[2]; /* 0 .. 1 of the picture: right, down */
} hs_console_message;

/* Reads `bytes` bytes, which need not end with a NUL. HS_ERR_INPUT names the field, its value and what is
 * expected; *out means nothing then. Any thread. */
bool hs_console_message_read(const char *text, size_t bytes, hs_console_message *out, hs_error *err);

/* --------------------------------------------------------------------------------------------- plugins -- */
/* The plugins that a page may choose from: those of the libraries on the command line. A page never names a
 * path. */

enum { HS_CONSOLE_OFFERS = 32 };

typedef struct {
    const char *library; /* as the command line has it; NULL: the default one */
    char path[1024];     /* where that is */
    char id[128];        /* "": the library could not be read, `failure` says why */
    char name[128], version[64];
    bool first; /* of its library: needs no --id */
    bool ours;  /* the default library's first: what others are compared with */
    hs_error failure;
} hs_console_offer;

typedef struct {
    hs_console_offer offer[HS_CONSOLE_OFFERS];
    uint32_t count;
    hs_guard_options guard;
} hs_console_offers;

/* Adds the plugins of a library (NULL: the default one). A library that cannot be read is offered with its
 * reason, so that a page can say it, and is tried again when it is chosen. HS_ERR_USAGE beyond
 * HS_CONSOLE_OFFERS. */
bool hs_console_offer_library(hs_console_offers *offers, const char *library, hs_error *err);

/* Adds the default library behind others, unless it is among them or cannot be read. The errors are the
 * same. */
bool hs_console_offer_ours(hs_console_offers *offers, hs_error *err);

/* ---------------------------------------------------------------------------------------------- shared -- */
/* What all pages of a console share, and how anything gets to one of them. */

typedef struct {
    hs_console_offers offers;
    hs_console_files files;
    const char *out;           /* folder for what is written */
    uint32_t lowres;           /* hs_loop_options.lowres */
    hs_metaimage_options read; /* what MetaImage files do not say */
} hs_console_shared;

/* How to send to a page; may block. False: it is gone. Called from the page's thread and that of
 * hs_console_page_say. */
typedef bool (*hs_console_send)(void *connection, bool binary, const uint8_t *data, size_t bytes);

/* ------------------------------------------------------------------------------------------------ lane -- */
/* A plugin with its values in a scan loop of its own. Two lanes on one source can be compared. */

/* What a plugin still has to do for a picture that holds; a later one includes those before it. */
typedef enum {
    HS_LANE_NOTHING,
    HS_LANE_ADJUST, /* one value that adjust takes */
    HS_LANE_ASK,    /* begin, slabs, end */
    HS_LANE_CONVERT /* and the slabs before */
} hs_lane_need;

/* What tells one build of a library from the next. Zeros: there is no file. */
typedef struct {
    uint64_t device, inode, bytes;
    int64_t written_ns;
} hs_library_stamp;

typedef struct {
    const hs_console_offer *offer; /* NULL: no plugin was chosen yet */
    hs_library_stamp stamp;        /* of its library when it was opened */
    hs_plugin plugin;
    bool has_plugin;
    hs_error failure; /* of opening it */
    sv_param_value values[HS_CONSOLE_VALUES];
    uint32_t count;
    hs_loop *loop;
    uint32_t adjusted; /* index into values of what HS_LANE_ADJUST is about */
    hs_lane_need need;
    hs_frame frame;            /* the last one */
    bool was_adjusted;         /* it came from adjust */
    double activation_ms;      /* of the last activation */
    uint32_t activations;      /* so many there were */
    double ms[HS_STAGE_COUNT]; /* of the last frame's stages; 0 for those it did not need */
} hs_lane;

/* Opens the offered plugin, or another one; its values are the defaults then. The loop must be built anew by
 * hs_lane_build. A plugin that cannot be opened is no failure: `failure` tells. */
void hs_lane_choose(hs_lane *lane, const hs_console_offer *offer, const hs_guard_options *guard);

/* True if the lane's library was built anew since, and nobody has written to it for half a second. */
bool hs_lane_is_rebuilt(const hs_lane *lane);

/* Takes out of `wanted` what the plugin does not take: a build may have lost a parameter. */
void hs_lane_leave_out(const hs_lane *lane, hs_console_lane *wanted);

/* Ends loop and plugin, and zeroes the lane. Safe on a zeroed one. */
void hs_lane_close(hs_lane *lane);

/* Builds the loop on a source. HS_ERR_INPUT, HS_ERR_DEVICE, HS_ERR_MEMORY: there is no loop then. */
bool hs_lane_build(hs_lane *lane, const hs_cl *cl, const hs_source *source, const hs_loop_options *options,
                   hs_error *err);

/* Takes the values of a state, and activates the plugin anew if one of them needs it. HS_ERR_INPUT names a
 * parameter that the plugin does not have, or a value out of its range: the values are then as they were.
 * HS_ERR_DEVICE or HS_ERR_MEMORY. */
bool hs_lane_set(hs_lane *lane, const hs_console_lane *wanted, const hs_loop_options *options, hs_error *err);

/* Does what the lane needs for volume `index`, which is brought first. HS_ERR_DEVICE, or the source's
 * errors. */
bool hs_lane_run(hs_lane *lane, uint32_t index, hs_error *err);

/* At least this is needed at the next run. */
void hs_lane_needs(hs_lane *lane, hs_lane_need need);

/* Which rule of the plugin's found no surface in the last frame, or a doubtful one, in words for who holds
 * the probe. False: the plugin does not tell. Waits for the lane's queue. */
bool hs_lane_reason(const hs_lane *lane, sv_confidence_report *out, char words[HS_REASON_BYTES]);

/* Why the last frame is not clipped, if the plugin failed; code HS_OK if it did not. */
const hs_error *hs_lane_error(const hs_lane *lane);

/* ----------------------------------------------------------------------------------------------- stage -- */
/* What one page looks at: a source, one or two lanes on it, and a renderer. It follows the page's newest
 * state, and does only what a change of that state needs. */

typedef struct {
    const hs_console_offers *offers;
    const hs_console_files *files;
    uint32_t lowres;           /* hs_loop_options.lowres: the caller sets it */
    hs_metaimage_options read; /* and how MetaImage files are read */
    hs_cl cl;
    hs_source source;
    bool has_source;
    char path[2][1024]; /* of a file source, at path_used, and of the one that is being opened */
    uint32_t path_used;
    hs_console_state state; /* as it was last applied */
    uint32_t index;         /* the volume that is shown */
    hs_lane lane[HS_CONSOLE_LANES];
    bool told[HS_CONSOLE_LANES]; /* the page knows this lane's parameters: the caller sets it */
    hs_screen *screen;           /* of screen_dvr, its size included */
    hs_dvr_settings screen_dvr;
    hs_truth_picture *truth; /* NULL: the source has none */
    uint64_t scene_epoch;    /* counts what changes every picture: volume, camera, renderer */
    uint64_t clip_epoch;     /* counts frames of the lanes */
    double source_ms;        /* that opening the source took */
    double depth_mm[2];      /* that the depthmap's colours run over; 0, 0: it has no surface */
} hs_console_stage;

/* Opens the device. `offers` and `files` must outlive it. HS_ERR_DEVICE. The stage must not move in
 * memory. */
bool hs_console_stage_open(hs_console_stage *stage, const hs_console_offers *offers,
                           const hs_console_files *files, hs_error *err);
void hs_console_stage_close(hs_console_stage *stage);

/* True if the state needs another source, which takes a while. */
bool hs_console_stage_changes_source(const hs_console_stage *stage, const hs_console_state *state);

/* Follows the state and shows volume `index`. A failing plugin is no error of it (hs_lane_error).
 * HS_ERR_INPUT: the state cannot be followed, and the stage is as it was, or has no source any more.
 * HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool hs_console_stage_show(hs_console_stage *stage, const hs_console_state *state, uint32_t index,
                           hs_error *err);

/* Finds the place of a mark that was put on a picture, to hundredths of a millimetre. On the full volume it
 * is what is seen there; on a result what is seen there to remove, what was cut last before it to keep.
 * "Seen": where a ray's opacity reaches one half. HS_ERR_INPUT: nothing is there, or the mark would change
 * nothing. HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool hs_console_stage_mark(hs_console_stage *stage, hs_console_view view, const double at[2], hs_mark *mark,
                           hs_error *err);

/* Ends loops and renderer, most of its memory; source, plugins and state stay. The next
 * hs_console_stage_show makes them anew. */
void hs_console_stage_rest(hs_console_stage *stage);

/* True if the library of one of its lanes was built anew: the next hs_console_stage_show opens it again, with
 * the values it had. */
bool hs_console_stage_is_rebuilt(const hs_console_stage *stage);

/* The loop of lane 0 as a run has it, for what is written to files; its options are those of the command
 * line. */
hs_loop *hs_console_stage_loop(hs_console_stage *stage);

/* "host_sim run --scene D01 ...", for a shell; the caller frees it. NULL without memory. Its result.png has
 * the pixels of the view "result" of lane `lane` at rest. */
char *hs_console_line(const hs_console_stage *stage, uint32_t lane);

/* --------------------------------------------------------------------------------------------- replies -- */
/* What the console tells a page, as JSON (docs/console.md). Every function returns a text that
 * the caller frees, or NULL without memory. */

/* What there is to choose from: scenes, files, plugins, stages. */
char *hs_console_reply_hello(const hs_console_offers *offers, const hs_console_files *files);

/* The parameters of a lane's plugin, as it describes them; their values are not among them. */
char *hs_console_reply_plugin(const hs_console_stage *stage, uint32_t lane);

/* A frame, behind its pictures. */
typedef struct {
    uint64_t frame;    /* counted by the console */
    uint32_t pictures; /* that came before */
    double draw_ms, encode_ms, all_ms;
} hs_console_shown;
char *hs_console_reply_frame(const hs_console_stage *stage, const hs_console_shown *shown);

/* A frame that was not drawn: the page need not wait for it. */
char *hs_console_reply_skipped(uint64_t frame);

/* A mark whose place was found, as a state has it; NULL: there is none, which "refused" has told. */
char *hs_console_reply_marked(const hs_mark *mark);

/* "refused" or "busy" with a text for a person, "written" with the folder. */
char *hs_console_reply_text(const char *type, const char *text);
char *hs_console_reply_written(const hs_console_stage *stage, const char *folder,
                               const hs_result_report *report);

/* ------------------------------------------------------------------------------------------------ show -- */
/* What a page's thread does with a state: the stage follows it, and its pictures go to the page. */

typedef struct hs_console_show hs_console_show;

/* Sends what there is to choose from. The device is opened for the first frame. NULL without memory, or if
 * the page is gone. */
hs_console_show *hs_console_show_open(const hs_console_shared *shared, hs_console_send send,
                                      void *connection);
void hs_console_show_close(hs_console_show *show);

/* Draws what has changed, and sends it: pictures, then the frame's text. False: the page is gone. What cannot
 * be shown is answered with "refused". */
bool hs_console_show_frame(hs_console_show *show, const hs_console_state *state, uint32_t index,
                           uint64_t frame);

/* True if a plugin that is shown was built anew: a frame would show it. */
bool hs_console_show_is_rebuilt(const hs_console_show *show);

/* Gives back what it draws with, until it draws again; pictures that were sent hold. False: it had nothing.
 */
bool hs_console_show_rest(hs_console_show *show);

/* A snapshot, or results on the disk. False: the page is gone. */
bool hs_console_show_deed(hs_console_show *show, const hs_console_message *deed);

/* ------------------------------------------------------------------------------------------------ page -- */
/*
 * A page that is open. A thread of its own holds the page's stage and draws; who receives its messages only
 * leaves the newest state for it, in a mailbox with one place. So there is never a queue: what is older than
 * the newest state is never drawn. Frames go out only while the page keeps up: two may be under way that it
 * has not said it has painted.
 */

typedef struct hs_console_page hs_console_page;

/* Starts the page's thread. `shared` and `connection` must outlive it. NULL with HS_ERR_MEMORY or
 * HS_ERR_FAILED. */
hs_console_page *hs_console_page_open(const hs_console_shared *shared, hs_console_send send, void *connection,
                                      hs_error *err);

/* Takes a message of the page; never waits for a picture. What cannot be read is answered with "refused".
 * False: the page sends nothing but nonsense, and should be closed. */
bool hs_console_page_say(hs_console_page *page, const char *text, size_t bytes);

/* Ends the thread, which finishes what it is about. */
void hs_console_page_close(hs_console_page *page);

/* ---------------------------------------------------------------------------------------------- access -- */
/* Who may talk to the console: pure checks of what a request says, and the token that its address carries. */

enum { HS_CONSOLE_TOKEN = 33 }; /* 128 random bits as hexadecimal digits, and a NUL */

/* A new token from the system's random numbers. HS_ERR_FAILED. */
bool hs_console_make_token(char token[HS_CONSOLE_TOKEN], hs_error *err);

/* True if the query ("t=...&...", or NULL) has this token; takes the same time wherever they differ. */
bool hs_console_token_fits(const char *query, const char *token);

/* True if the header Host (or NULL) names this server: a number and no name, or "localhost", at any
 * port: a tunnel's or a container's may be another one. A name may be made to lead here by whoever owns it
 * (DNS rebinding); a number may not. `loopback`: the server listens on this machine only, so the number is
 * one of its own. */
bool hs_console_host_is_ours(const char *host, bool loopback);

/* Reads a proxy's address, "http(s)://HOST[:PORT]/[PATH/]": its origin ("https://HOST") and, behind the two
 * slashes of that, the Host of its requests. False: it is none, or too long. */
bool hs_console_behind(const char *address, char *origin, size_t bytes);

/* True if the header Origin (or NULL) is that of a page which this server sent: "http://" and its Host. */
bool hs_console_origin_is_ours(const char *origin, const char *host);

/* ---------------------------------------------------------------------------------------------- server -- */
/* The console's web server: its page by HTTP, and everything that lives by WebSocket. docs/console.md has
 * what it refuses and why. */

typedef struct {
    const char *listen; /* address; NULL: 127.0.0.1 */
    uint32_t port;      /* 0: any that is free */
    const char *behind; /* "https://HOST/PATH/" under which a proxy shows the page; NULL: none does */
} hs_console_address;

typedef struct hs_console_server hs_console_server;

/* Starts listening. `shared` must outlive it. NULL with HS_ERR_USAGE (an address that is none), HS_ERR_FAILED
 * (it is taken, or may not be listened on) or HS_ERR_MEMORY. */
hs_console_server *hs_console_server_open(const hs_console_shared *shared, const hs_console_address *address,
                                          hs_error *err);

/* The address to open, with its token. */
void hs_console_server_address(const hs_console_server *server, char *out, size_t bytes);

/* Pages that are open now, and how many there ever were. Any thread. */
uint32_t hs_console_server_pages(hs_console_server *server, uint32_t *ever);

/* Closes every page and stops. */
void hs_console_server_close(hs_console_server *server);

/* --------------------------------------------------------------------------------------------- command -- */
/* host_sim console: the scan loop on a web page, live. */

/* argv[0] is the command's own name. Returns the exit code (hs_code, base/error.h). */
int hs_cmd_console(int argc, char **argv);
