/* SPDX-License-Identifier: MIT */
#include "door/door.h"

#include "render/host_kernels.h"
#include "sv_version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *svh_version(void) {
    return SV_VERSION;
}

/* --------------------------------------------------------------------------------------------- errors -- */

bool door_check_given(const char *call, const char *names, const void *const *pointers, size_t count,
                      hs_error *err) {
    for (size_t i = 0; i < count; i++) {
        const int length = (int)strcspn(names, ",");
        if (!pointers[i]) return hs_fail(err, HS_ERR_USAGE, "%s: %.*s is NULL", call, length, names);
        if (i + 1 < count) names += length + 2; /* behind ", " */
    }
    return true;
}

/* The call, status and words of "PATH: CALL: NAME (STATUS): WORDS", as hs_plugin_check writes it. */
static void tell_call(const char *text, svh_error *out) {
    int status, at = 0;
    for (const char *part = strstr(text, ": "); part; part = strstr(part + 2, ": ")) {
        char call[sizeof out->call], name[32];
        if (sscanf(part, ": %15[a-z_]: %31[A-Z_a-z ] (%d)%n", call, name, &status, &at) < 3 &&
            sscanf(part, ": %15[a-z_] '%*[^']': %31[A-Z_a-z ] (%d)%n", call, name, &status, &at) < 3)
            continue;
        out->status = status;
        (void)snprintf(out->call, sizeof out->call, "%s", call);
        (void)snprintf(out->reason, sizeof out->reason, "%s",
                       strncmp(part + at, ": ", 2) ? "" : part + at + 2);
        return;
    }
}

int32_t door_leave(svh_host *host, const hs_error *err, svh_error *out) {
    if (host) (void)pthread_mutex_unlock(&host->lock);
    if (err->code != HS_OK && out && out->size >= DOOR_1_0_svh_error) {
        svh_error own = {.code = (int32_t)err->code};
        (void)snprintf(own.text, sizeof own.text, "%s", err->text);
        if (err->code == HS_ERR_PLUGIN) tell_call(err->text, &own);
        door_give(out, &own, sizeof own);
    }
    return (int32_t)err->code;
}

/* ------------------------------------------------------------------------------------------ the host -- */

/* True if `name` lies at `place` from the folder of this library. */
static bool find_beside(const char *place, const char *name, char *out, size_t bytes) {
    char folder[SYS_PATH];
    sys_own_folder((const void *)"", folder, sizeof folder);
    const int length = snprintf(out, bytes, "%s%s%s", folder, place, name);
    if (folder[0] && length >= 0 && (size_t)length < bytes && sys_is_file(out)) return true;
    out[0] = '\0';
    return false;
}

#ifdef _WIN32
#define PROGRAM_ENDING ".exe"
#else
#define PROGRAM_ENDING ""
#endif

static void find_parts(svh_host *host, const char *program) {
    char name[32], found[SYS_PATH];
    (void)snprintf(name, sizeof name, "smartvis%s", sys_library_ending);
    if (!find_beside("", name, host->own, sizeof host->own))
        (void)find_beside("smartvis/", name, host->own, sizeof host->own);
    if (program)
        hs_guard_set_program(program);
    else if (find_beside("", "host_sim" PROGRAM_ENDING, found, sizeof found) ||
             find_beside("../bin/", "host_sim" PROGRAM_ENDING, found, sizeof found))
        hs_guard_set_program(found);
}

/* A caller that is told of a line of the log may free an object meanwhile, on the same thread. */
static void make_lock(pthread_mutex_t *lock) {
    pthread_mutexattr_t again;
    (void)pthread_mutexattr_init(&again);
    (void)pthread_mutexattr_settype(&again, PTHREAD_MUTEX_RECURSIVE);
    (void)pthread_mutex_init(lock, &again);
    (void)pthread_mutexattr_destroy(&again);
}

int32_t svh_open(const svh_options *options, svh_host **out, svh_error *error) {
    svh_options own = {0};
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, out)) return door_leave(NULL, &err, error);
    *out = NULL;
    if (options && !DOOR_TAKE(svh_options, &own, options, &err)) return door_leave(NULL, &err, error);
    svh_host *host = hs_memory(1, sizeof *host, "host", &err);
    if (!host) return door_leave(NULL, &err, error);
    hs_guard_defaults(&host->guard);
    host->guard.choice = (hs_guard_choice)own.guard;
    if (own.guard > SVH_GUARD_OFF) {
        (void)hs_fail(&err, HS_ERR_USAGE, "svh_options: guard is %u, expected 0 .. 2", own.guard);
        free(host);
        return door_leave(NULL, &err, error);
    }
    host->log = own.log;
    host->context = own.context;
    host->users = 1;
    make_lock(&host->lock);
    find_parts(host, own.program);
    *out = host;
    return SVH_OK;
}

void door_let_go(svh_host *host) {
    const bool is_last = --host->users == 0;
    (void)pthread_mutex_unlock(&host->lock);
    if (!is_last) return;
    hs_cl_close(&host->cl);
    hs_fits_free(&host->fits);
    (void)pthread_mutex_destroy(&host->lock);
    free(host);
}

void svh_close(svh_host *host) {
    if (!host) return;
    (void)pthread_mutex_lock(&host->lock);
    door_let_go(host);
}

bool door_open_device(svh_host *host, hs_error *err) {
    return host->cl.context || hs_cl_open(&host->cl, err);
}

uint32_t svh_rests_after(void) {
    return 16;
}

void door_rest_device(svh_host *host) {
    if (host->on_device > 0 || host->ended < svh_rests_after()) return;
    hs_cl_close(&host->cl);
    host->ended = 0;
}
