/* SPDX-License-Identifier: MIT */
#include "guard/child_living.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define MAX_CHILDREN 64
#define MAX_LOOKS    100 /* for strays, however fast they multiply */

/* The children that have not been collected yet. Whoever starts one, or looks for strays, holds the lock. */
static pid_t living[MAX_CHILDREN];
static pthread_mutex_t starting = PTHREAD_MUTEX_INITIALIZER;

static bool replace_living(pid_t from, pid_t to) {
    for (size_t i = 0; i < MAX_CHILDREN; i++) {
        if (living[i] != from) continue;
        living[i] = to;
        return true;
    }
    return false;
}

pid_t hs_child_fork(void) {
    (void)pthread_mutex_lock(&starting);
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
    const bool room = replace_living(0, -1);
    const pid_t pid = room ? fork() : -1;
    const int reason = room ? errno : EAGAIN;
    if (pid == 0) {
        memset(living, 0, sizeof living);
        (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
    } else if (room) {
        (void)replace_living(-1, pid > 0 ? pid : 0);
    }
    (void)pthread_mutex_unlock(&starting);
    errno = reason;
    return pid;
}

void hs_child_read_proc(long pid, const char *what, char *text, size_t bytes) {
    char path[64];
    (void)snprintf(path, sizeof path, "/proc/%ld/%s", pid, what);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    const ssize_t length = file < 0 ? 0 : read(file, text, bytes - 1);
    if (file >= 0) (void)close(file);
    text[length > 0 ? length : 0] = '\0';
}

/* True for an orphan of a child that has ended. What others start in this process has the process's group. */
static bool is_stray(long pid) {
    char text[512];
    int parent = 0, group = 0;
    hs_child_read_proc(pid, "stat", text, sizeof text);
    const char *name_end = strrchr(text, ')');
    return name_end && sscanf(name_end + 1, " %*c %d %d", &parent, &group) == 2 && parent == getpid() &&
           group != getpgrp() && !replace_living((pid_t)pid, (pid_t)pid);
}

/* Ends the strays of one look. What these had started are strays then. False: there were none. */
static bool end_strays(void) {
    DIR *all = opendir("/proc");
    bool found = false;
    for (const struct dirent *entry; all && (entry = readdir(all));) {
        const long pid = strtol(entry->d_name, NULL, 10);
        if (pid <= 0 || !is_stray(pid)) continue;
        (void)kill((pid_t)pid, SIGKILL);
        (void)waitpid((pid_t)pid, NULL, 0);
        found = true;
    }
    if (all) (void)closedir(all);
    return found;
}

void hs_child_end_leftovers(pid_t pid) {
    (void)kill(-pid, SIGKILL);
    (void)pthread_mutex_lock(&starting);
    (void)replace_living(pid, 0);
    for (int looks = 0; looks < MAX_LOOKS && end_strays(); looks++) {
    }
    (void)pthread_mutex_unlock(&starting);
}
