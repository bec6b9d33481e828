/* SPDX-License-Identifier: MIT */
/* A host that never waits longer than it may: the plugin works on a thread of its own, and every volume is
 * drawn when its time has come, with the map or without. Usage: deadline_host PLUGIN.so MILLISECONDS */
#include "smartvis/open.h"
#include "smartvis_plugin.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    SIDE = 64,
    SLICES = 64,
    SLAB = 16,
    RAYS = SIDE * SIDE,
    VOLUMES = 200,
    SKIN = 100,
    FLUID = 10,
    FETUS = 200
};

/* Between the thread that scans and draws, and the one that calls the plugin. */
static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int given, finished; /* number of the volume handed over last, and of the one whose call has returned */
    sv_status status;    /* of that one */
    int over;
} desk = {.lock = PTHREAD_MUTEX_INITIALIZER};

static uint8_t volume[SLICES][RAYS]; /* the plugin's from when it is given until it is finished */
static float depthmap[RAYS];         /* the same */

static void print_log(const sv_host *host, int32_t severity, const char *text) {
    (void)host;
    if (severity >= SV_LOG_WARNING) fprintf(stderr, "plugin: %s\n", text);
}

/* A skin, a gap of fluid that moves with the number, and a fetus. */
static void scan(int number) {
    for (uint32_t i = 0; i < RAYS; i++)
        for (uint32_t z = 0; z < SLICES; z++) {
            const uint32_t near = 8 + (uint32_t)number % 4, far = near + 20 + i % SIDE / 16;
            volume[z][i] = z < near ? SKIN : z < far ? FLUID : FETUS;
        }
}

/* ---- the plugin's thread: all its calls but create and destroy are made here, one after the other */
static sv_status frame(const sv_plugin *p) {
    sv_stats stats = {.size = sizeof stats};
    const sv_frame begun = {.size = sizeof begun};
    const sv_result result = {.size = sizeof result, .depth = depthmap, .stats = &stats};
    sv_status status = p->begin(p, &begun);
    for (uint32_t z = 0; z < SLICES && status == SV_OK; z += SLAB) {
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = z,
                              .slice_count = SLAB,
                              .memory = volume[z],
                              .bytes = sizeof volume[0] * SLAB};
        status = p->slab(p, &slab);
    }
    return status == SV_OK ? p->end(p, &result) : status;
}

static void *work(void *plugin) {
    const sv_plugin *p = plugin;
    const sv_format format = {.size = sizeof format,
                              .width = SIDE,
                              .height = SIDE,
                              .slices = SLICES,
                              .max_slab_slices = SLAB,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = SIDE,
                              .tile_h = SIDE,
                              .row_pitch = SIDE,
                              .spacing_mm = {1, 1, 1}};
    const sv_status active =
        p->activate(p, &format); /* takes seconds: volumes are drawn meanwhile, unclipped */
    if (active < SV_OK) fprintf(stderr, "deadline_host: %s\n", p->last_error(p));
    (void)pthread_mutex_lock(&desk.lock);
    while (!desk.over) {
        if (desk.finished == desk.given) {
            (void)pthread_cond_wait(&desk.changed, &desk.lock);
            continue;
        }
        (void)pthread_mutex_unlock(&desk.lock);
        const sv_status status = active < SV_OK ? active : frame(p);
        (void)pthread_mutex_lock(&desk.lock);
        desk.status = status;
        desk.finished = desk.given;
        (void)pthread_cond_broadcast(&desk.changed);
    }
    (void)pthread_mutex_unlock(&desk.lock);
    if (active >= SV_OK) p->deactivate(p);
    return NULL;
}

/* ---- the thread that scans and draws */
/* 1 if the plugin may have the volume; else it still has an older one, and this one is skipped. */
static int hand_over(int number) {
    (void)pthread_mutex_lock(&desk.lock);
    const int idle = desk.finished == desk.given;
    if (idle) scan(number); /* nobody reads the voxels now */
    if (idle) desk.given = number;
    (void)pthread_cond_broadcast(&desk.changed);
    (void)pthread_mutex_unlock(&desk.lock);
    return idle;
}

/* 1 if the map is this volume's, there in time, and clips. A late map is of an older volume: it is never
 * drawn. */
static int wait_for_map(int number, double ms) {
    struct timespec until;
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    const long long ns = until.tv_nsec + (long long)(ms * 1e6);
    until.tv_sec += (time_t)(ns / 1000000000);
    until.tv_nsec = (long)(ns % 1000000000);
    (void)pthread_mutex_lock(&desk.lock);
    int code = 0;
    while (desk.finished != number && code != ETIMEDOUT)
        code = pthread_cond_timedwait(&desk.changed, &desk.lock, &until);
    const int clips = desk.finished == number && (desk.status == SV_OK || desk.status == SV_PARTIAL);
    (void)pthread_mutex_unlock(&desk.lock);
    return clips;
}

/* The exit code: 4 if the plugin's last frame was no success, as of small_host. */
static int run(const sv_plugin *p, double ms) {
    pthread_t worker;
    int clipped = 0, skipped = 0;
    if (pthread_create(&worker, NULL, work, (void *)(uintptr_t)p) != 0)
        return fprintf(stderr, "deadline_host: no thread\n"), 4;
    for (int number = 1; number <= VOLUMES; number++) {
        const int given = hand_over(number);
        /* A renderer draws here: with the map, or unclipped. */
        clipped += wait_for_map(number, ms);
        skipped += !given;
    }
    (void)pthread_mutex_lock(&desk.lock);
    desk.over = 1;
    (void)pthread_cond_broadcast(&desk.changed);
    (void)pthread_mutex_unlock(&desk.lock);
    (void)pthread_join(worker, NULL);
    printf("%d volumes: %d drawn with the map, %d unclipped; %d of these were skipped\n", VOLUMES, clipped,
           VOLUMES - clipped, skipped);
    return desk.status < SV_OK || desk.status > SV_PARTIAL ? 4 : 0;
}

int main(int argc, char **argv) {
    char why[256] = "usage: deadline_host FOLDER/PLUGIN.so MILLISECONDS";
    const double ms = argc == 3 ? strtod(argv[2], NULL) : 0.0;
    const sv_entry *entry = ms > 0.0 ? sv_open(argv[1], NULL, why, sizeof why) : NULL;
    if (!entry) return fprintf(stderr, "%s\n", why), 2;
    if (entry->abi_major != SV_ABI_MAJOR) return fprintf(stderr, "another ABI: %u\n", entry->abi_major), 4;
    const sv_descriptor *about = entry->descriptor(0);
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "deadline_host", "1", print_log, NULL};
    const sv_plugin *p = NULL;
    if (!(about->queues & SV_QUEUE_OWN)) return fprintf(stderr, "%s needs the host's queue\n", about->id), 4;
    if (entry->create(&host, about->id, &p) != SV_OK) return fprintf(stderr, "no instance\n"), 4;
    pthread_condattr_t clock; /* a clock that nobody sets */
    (void)pthread_condattr_init(&clock);
    (void)pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&desk.changed, &clock);
    const int code = run(p, ms);
    p->destroy(p);
    return code; /* the library stays loaded until the process ends */
}
