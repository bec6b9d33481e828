/* SPDX-License-Identifier: MIT */
/*
 * What an OpenCL runtime does to the process that it works in, for hosts and for plugins with kernels:
 * smartvis/device.h does it for both. Where POSIX is not declared (_POSIX_C_SOURCE 200809L or _GNU_SOURCE
 * before the first header) nothing is done.
 *
 * Before anything is compiled: can PoCL's kernel cache be written, and is there room? PoCL and LLVM end the
 * process, by exit or abort, where it is not.
 *
 * Around everything that may start a runtime: LLVM takes fifteen signals, SIGUSR1 and SIGTERM among them, and
 * never gives them back.
 */
#ifndef SMARTVIS_AUTHOR_RUNTIME_H
#define SMARTVIS_AUTHOR_RUNTIME_H

#include "smartvis_plugin.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_POSIX_C_SOURCE) && _POSIX_C_SOURCE >= 200809L
#define SVA_RUNTIME_POSIX 1
#include <errno.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#else
#define SVA_RUNTIME_POSIX 0
#endif

SMARTVIS_BEGIN_C

/* An activation compiles some 2 MiB, and LLVM writes each object a second time. */
enum { SVA_CACHE_MIB = 8, SVA_CACHE_PATH = 600, SVA_CACHE_TEXT = 1000 };

/* The folder as PoCL finds it. False: it is no path of that length. */
static inline int sva_cache_folder(char *out, size_t bytes) {
    const char *named = getenv("POCL_CACHE_DIR"), *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    const int length = named   ? snprintf(out, bytes, "%s", named)
                       : cache ? snprintf(out, bytes, "%s/pocl/kcache", cache)
                       : home  ? snprintf(out, bytes, "%s/.cache/pocl/kcache", home)
                               : snprintf(out, bytes, "/tmp/pocl/kcache");
    return length > 0 && (size_t)length < bytes;
}

#if SVA_RUNTIME_POSIX
/* Cuts the path back to what is there: PoCL makes the rest. */
static inline void sva_cache_parent(char *path) {
    struct stat info;
    char *slash;
    while (stat(path, &info) != 0 && errno == ENOENT && (slash = strrchr(path, '/')) != NULL && slash != path)
        *slash = '\0';
}

static inline int sva_cache_problem_at(const char *folder, char *out, size_t bytes) {
    char there[SVA_CACHE_PATH];
    struct statvfs disk;
    (void)snprintf(there, sizeof there, "%s", folder);
    sva_cache_parent(there);
    if (access(there, W_OK | X_OK) != 0)
        return snprintf(out, bytes,
                        "PoCL's kernel cache %s cannot be written: %s; make it so, or name another folder in "
                        "POCL_CACHE_DIR",
                        folder, strerror(errno)) > 0;
    if (statvfs(there, &disk) != 0) return 0;
    const unsigned long long free_mib = (unsigned long long)disk.f_bavail * disk.f_frsize >> 20;
    if (free_mib >= SVA_CACHE_MIB || disk.f_blocks == 0) return 0;
    return snprintf(out, bytes,
                    "the disk of PoCL's kernel cache %s has %llu MiB free, expected %d; make room, or name "
                    "another folder in POCL_CACHE_DIR",
                    folder, free_mib, SVA_CACHE_MIB) > 0;
}
#endif

/* True if kernels cannot be compiled on the OpenCL platform of this name, with the folder and what to do in
 * `out`. */
static inline int sva_cache_problem(const char *platform_name, char *out, size_t bytes) {
#if SVA_RUNTIME_POSIX
    char folder[SVA_CACHE_PATH];
    if (strcmp(platform_name, "Portable Computing Language") != 0) return 0;
    return sva_cache_folder(folder, sizeof folder) && sva_cache_problem_at(folder, out, bytes);
#else
    (void)platform_name, (void)out, (void)bytes;
    return 0;
#endif
}

/* The handlers of all signals. */
enum { SVA_SIGNALS = 65 };
typedef struct sva_handlers {
#if SVA_RUNTIME_POSIX
    struct sigaction of[SVA_SIGNALS];
#else
    char none;
#endif
} sva_handlers;

static inline void sva_handlers_keep(sva_handlers *h) {
    memset(h, 0, sizeof *h);
#if SVA_RUNTIME_POSIX
    for (int n = 1; n < SVA_SIGNALS; n++) (void)sigaction(n, NULL, &h->of[n]);
#endif
}

/* Gives the host its handlers back. Where it has none for SIGFPE, the runtime's stays: PoCL lets a kernel
 * divide an integer by zero. */
static inline void sva_handlers_put_back(const sva_handlers *h) {
#if SVA_RUNTIME_POSIX
    for (int n = 1; n < SVA_SIGNALS; n++) {
        struct sigaction now;
        if (sigaction(n, NULL, &now) != 0 || now.sa_handler == h->of[n].sa_handler) continue;
        if (n != SIGFPE || h->of[n].sa_handler != SIG_DFL) (void)sigaction(n, &h->of[n], NULL);
    }
#else
    (void)h;
#endif
}

SMARTVIS_END_C

#endif
