/* SPDX-License-Identifier: MIT */
/* Wrong plugins: states, refusals, and how they treat the process and the host they live in. */
#include "wrong_base.h"

#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#if !defined(_WIN32)
#include <sys/resource.h>
#endif

enum { MEBIBYTE = 1 << 20, GRAB_MEBIBYTES = 2048, MAX_RAYS = 4096, LINES = 10000 };
static int refused_a_slab; /* since activate */
static uint32_t adjusted;  /* since begin */
static const void *voxels; /* of the slab that was last */
static double shared[PARAMS];
static float scratch[MAX_RAYS];
static char old_reason[256];

/* ---- what crashes, hangs and takes */
static int recurse(volatile int *depth) {
    volatile int here = *depth + 1;
    return here > 0 ? recurse(&here) + here : here;
}

static int divide(void) {
    volatile int zero = 0, quotient = 7 / zero;
    return quotient;
}

/* Takes no more than that, so that a machine without limits outlives it. */
static void grab(void) {
    for (int i = 0; i < GRAB_MEBIBYTES; i++) {
        char *volatile block = (char *)malloc(MEBIBYTE);
        while (!block) (void)usleep(1000);
        memset(block, i, MEBIBYTE);
    }
}

/* ---- what is the host's */
enum { MAX_OPEN = 1024, LIVES_S = 300 };

static void spoil_descriptors(void) {
    for (int number = 0; number < MAX_OPEN && WRONG_IS(closes_descriptors); number++) (void)close(number);
    for (int number = 3; number < MAX_OPEN && WRONG_IS(shrinks_files); number++) (void)!ftruncate(number, 0);
    for (int number = 3; number < MAX_OPEN && WRONG_IS(writes_to_files); number++)
        (void)!write(number, "", 1);
}

#if defined(_WIN32) /* where there is no such thing */
static void leave_a_process(void) {}
static void lower_limits(void) {}
static void lower_hard_limit(void) {}
static void take_signal(void) {}
#else
/* Once, and for minutes only, should a host not end it; or it goes on as a copy of the host. */
static void leave_a_process(void) {
    static int left;
    if (left++ || fork() != 0 || WRONG_IS(forks)) return;
    (void)setsid();
    (void)sleep(LIVES_S);
    _exit(0);
}

static void hear(int number) {
    (void)number;
}

static void take_signal(void) {
    (void)signal(SIGUSR1, hear);
}

static void lower_limits(void) {
    struct rlimit files = {0, 0};
    (void)getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur /= 2;
    (void)setrlimit(RLIMIT_NOFILE, &files);
}

/* Of the first limit that lies below it. */
static void lower_hard_limit(void) {
    for (int what = 0; what < RLIM_NLIMITS; what++) {
        struct rlimit limit;
        if (getrlimit((__rlimit_resource_t)what, &limit) != 0 || limit.rlim_cur == limit.rlim_max) continue;
        limit.rlim_max = limit.rlim_cur;
        if (setrlimit((__rlimit_resource_t)what, &limit) == 0) return;
    }
}
#endif

static void *sleep_for_ever(void *nothing) {
    wrong_hang();
    return nothing;
}

/* ---- control */
static void be_noisy(const sva *a) {
    if (WRONG_IS(needs_log)) a->host->log(a->host, SV_LOG_INFO, "activate");
    if (!a->host->log) return;
    if (WRONG_IS(unknown_severity)) a->host->log(a->host, 9, "activate");
    if (WRONG_IS(logs_null)) a->host->log(a->host, SV_LOG_INFO, NULL);
}

static void leak(void) {
    pthread_t thread;
    void *volatile block = WRONG_IS(leaks_memory) || WRONG_IS(ignores_no_memory) ? malloc(10000) : NULL;
    if (WRONG_IS(ignores_no_memory)) {
        *(volatile char *)block = 1;
        free(block);
    }
    if (WRONG_IS(leaks_file) && dup(STDERR_FILENO) < 0) wrong_crash();
    if (WRONG_IS(leaks_thread) && pthread_create(&thread, NULL, sleep_for_ever, NULL) == 0)
        (void)pthread_detach(thread);
}

static sv_status activate(const sv_plugin *plugin, const sv_format *format) {
    sva *a = wrong_self(plugin);
    sv_format f;
    if (!format || format->size < sizeof *format) return sva_activate(plugin, format);
    f = *format;
    refused_a_slab = 0;
    if (WRONG_IS(crash_in_activate)) wrong_crash();
    if (WRONG_IS(hang_in_activate)) wrong_hang();
    if (WRONG_IS(activate_fails)) return sva_error(a, SV_ERR_FORMAT, "activate: no format is good enough");
    if (WRONG_IS(refuses_longer_structs) && f.size > sizeof f)
        return sva_blame(a, SV_ERR_SIZE, "activate: format.size is %u", (unsigned)f.size);
    if (WRONG_IS(activates_twice) && a->state != SVA_INACTIVE) sva_release(a);
    if (WRONG_IS(takes_any_format) && f.tile_w < f.width) {
        f.tile_w = f.width;
        f.row_pitch = f.tiles_x * f.width;
    }
    if (WRONG_IS(takes_unknown_flags)) f.flags &= SV_FORMAT_SCANNED;
    const sv_status status = sva_activate(plugin, &f);
    if (status != SV_OK) return status;
    be_noisy(a);
    leak();
    if (WRONG_IS(changes_locale)) (void)setlocale(LC_ALL, "C.UTF-8");
    if (WRONG_IS(takes_signal)) take_signal();
    if (WRONG_IS(lowers_limits)) lower_limits();
    if (WRONG_IS(lowers_hard_limit)) lower_hard_limit();
    if (WRONG_IS(activate_77)) return 77;
    if (WRONG_IS(activate_partial)) return SV_PARTIAL;
    return status;
}

static void deactivate(const sv_plugin *plugin) {
    if (!WRONG_IS(ignores_deactivate)) sva_deactivate(plugin);
}

/* ---- frame */
static sv_status begin(const sv_plugin *plugin, const sv_frame *frame) {
    sva *a = wrong_self(plugin);
    sv_frame f;
    if (WRONG_IS(null_frame_crashes)) (void)*(const volatile uint32_t *)&frame->size;
    if (!frame || (frame->size < SV_FRAME_SIZE_1_0 && !WRONG_IS(ignores_sizes)))
        return sva_begin(plugin, frame);
    memset(&f, 0, sizeof f);
    memcpy(&f, frame, frame->size > SV_FRAME_SIZE_1_0 && frame->size < sizeof f ? frame->size : sizeof f);
    if (WRONG_IS(ignores_sizes)) f.size = sizeof f;
    if (WRONG_IS(refuses_longer_structs) && f.size > sizeof f)
        return sva_blame(a, SV_ERR_SIZE, "begin: frame.size is %u", (unsigned)f.size);
    if (WRONG_IS(takes_missing_values) && !f.values) f.value_count = 0;
    if (WRONG_IS(takes_unknown_flags)) f.flags &= SV_FRAME_DISCONTINUITY;
    if (WRONG_IS(fails_for_ever) && refused_a_slab)
        return sva_error(a, SV_ERR_INTERNAL, "begin: an earlier frame had failed");
    if (WRONG_IS(lost_after_adjust) && a->state == SVA_FINISHED && adjusted >= 2)
        return sva_wrong_state(a, "begin");
    if (WRONG_IS(frame_allocates)) {
        void *volatile block = malloc(100);
        free(block);
    }
    adjusted = 0;
    spoil_descriptors();
    const sv_status status = sva_begin(plugin, &f);
    if (status == SV_OK) memcpy(shared, a->values, sizeof shared);
    return status;
}

static sv_status slab(const sv_plugin *plugin, const sv_slab *s) {
    sva *a = wrong_self(plugin);
    sv_slab taken;
    if (WRONG_IS(slab_before_begin) && a->state == SVA_IDLE) {
        a->state = SVA_SLABS;
        a->next_slice = 0;
    }
    if (!s || s->size < sizeof *s || a->state != SVA_SLABS) return sva_slab(plugin, s);
    taken = *s;
    voxels = s->memory;
    if (WRONG_IS(crash_in_slab)) wrong_crash();
    if (WRONG_IS(abort_in_slab)) abort();
    for (int i = 0; i < LINES && WRONG_IS(logs_without_end); i++)
        sva_log(a, SV_LOG_ERROR, "A line of the log that tells nothing that was not told before.");
    if (WRONG_IS(prints)) (void)(printf("slab %u\n", (unsigned)s->first_slice) + fflush(stdout));
    if (WRONG_IS(takes_any_order)) taken.first_slice = a->next_slice;
    if (WRONG_IS(takes_long_slab)) a->format.max_slab_slices = a->format.slices;
    if (WRONG_IS(takes_short_memory) && s->bytes > 0) taken.bytes = UINT64_MAX / 2;
    const sv_status status = sva_slab(plugin, &taken);
    refused_a_slab |= status < 0;
    for (int number = 0; number < MAX_OPEN && status < 0 && WRONG_IS(closes_when_refused); number++)
        (void)close(number);
    return status;
}

/* Slices that never came are as the last one that did. */
static void make_up_slices(sva *a) {
    if (a->next_slice == 0) return;
    for (; a->next_slice < a->format.slices; a->next_slice++)
        a->slice[a->next_slice] = a->slice[a->next_slice - 1];
}

static void pass_through_scratch(const sva *a, const sv_result *r) {
    const size_t bytes = sva_rays(a) * sizeof(float);
    if (bytes > sizeof scratch || r->depth_pitch) return;
    memcpy(scratch, r->depth, bytes);
    (void)usleep(3000);
    memcpy(r->depth, scratch, bytes);
}

static sv_status end(const sv_plugin *plugin, const sv_result *result) {
    static unsigned frames;
    sva *a = wrong_self(plugin);
    volatile int depth = 0;
    if (a->state == SVA_SLABS && WRONG_IS(exit_in_end)) exit(0);
    if (a->state == SVA_SLABS && WRONG_IS(hang_in_end)) wrong_hang();
    if (a->state == SVA_SLABS && WRONG_IS(slow_frames) && ++frames % 3 > 0) (void)usleep(60000);
    if (a->state == SVA_SLABS && WRONG_IS(divides_by_zero)) (void)divide();
    if (a->state == SVA_SLABS && WRONG_IS(endless_recursion)) (void)recurse(&depth);
    if (a->state == SVA_SLABS && WRONG_IS(memory_grab)) grab();
    if (WRONG_IS(forks) || WRONG_IS(forks_session)) leave_a_process();
    if (WRONG_IS(changes_rounding)) (void)fesetround(FE_UPWARD);
    if (WRONG_IS(end_twice) && a->state == SVA_FINISHED) a->state = SVA_SLABS;
    if (WRONG_IS(takes_missing_slabs) && a->state == SVA_SLABS) make_up_slices(a);
    if (WRONG_IS(shared_state)) memcpy(a->values, shared, sizeof shared);
    const sv_status status = sva_end(plugin, result);
    if (WRONG_IS(shared_scratch) && status >= 0) pass_through_scratch(a, result);
    return status;
}

static sv_status adjust(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                        const sv_result *result) {
    const sv_status status = sva_adjust(plugin, values, count, result);
    if (WRONG_IS(forks_in_adjust) && count > 0) leave_a_process();
    if (WRONG_IS(writes_in_adjust)) *(uint8_t *)(uintptr_t)voxels ^= 1;
    adjusted += status >= 0;
    return status;
}

/* ---- any */
static const char *last_error(const sv_plugin *plugin) {
    const char *reason = sva_last_error(plugin);
    if (WRONG_IS(no_reason)) return "";
    if (!WRONG_IS(reason_stays)) return reason;
    if (reason[0]) memcpy(old_reason, reason, strlen(reason) + 1);
    return old_reason;
}

static const void *extension(const sv_plugin *plugin, const char *id) {
    return WRONG_IS(any_extension) ? (const void *)&wrong_descriptor : sva_get_extension(plugin, id);
}

static void misbehave(sv_plugin *api) {
    api->activate = activate;
    api->deactivate = deactivate;
    api->begin = begin;
    api->slab = slab;
    api->end = end;
    api->adjust = adjust;
    api->last_error = last_error;
    api->get_extension = extension;
}

/* The surface, and what the helper's guards must find. */
static sv_status find(sva *a, float *depth) {
    const size_t rays = sva_rays(a);
    const sv_status status = wrong_find(a, depth);
    if (WRONG_IS(hang_with_value) && sva_value(a, GAP) == 5.0) wrong_hang();
    if (WRONG_IS(surface_overruns)) depth[rays] = 0.0f;
    if (WRONG_IS(surface_underruns)) *(depth - 1) = 0.0f;
    if (WRONG_IS(points_overrun)) memset(a->points + rays, SV_POINT_NONE, a->format.width);
    if (WRONG_IS(rays_overrun)) ((wrong_edge *)a->rays)[rays].far = 1;
    return status;
}

static const sva_method complete = {.descriptor = &wrong_descriptor,
                                    .params = wrong_params,
                                    .param_count = PARAMS,
                                    .ray_bytes = sizeof(wrong_edge),
                                    .finish = find,
                                    .adjust = wrong_place};
static const sva_method forgetful = {.descriptor = &wrong_descriptor,
                                     .params = wrong_params,
                                     .param_count = PARAMS,
                                     .finish = wrong_find,
                                     .adjust = wrong_place};
WRONG_ENTRY(*(WRONG_IS(forgets_ray_bytes) ? &forgetful : &complete), misbehave);
