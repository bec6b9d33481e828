/* SPDX-License-Identifier: MIT */
/* What of the process a plugin must leave as it is, looked at before and after every call of it: descriptors
 * with what lies behind them, resource limits, and that there are no child processes. */
#include "validate/drive/process.h"

#include "validate/drive/drive.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BAITS = 16, BAIT_BYTES = 4096, MAX_OPEN = 1024 };

struct v_watch {
    pid_t self;
    struct rlimit limits[RLIM_NLIMITS];
    uint32_t count; /* of open descriptors */
    struct {
        int number, flags;
        dev_t device;
        ino_t file;
    } open[MAX_OPEN];
    int bait;
};

/* A file of the host's own behind some descriptors, for those who write to whatever is open. */
static int lay_bait(void) {
    uint8_t page[BAIT_BYTES];
    const int bait = memfd_create("the host's", MFD_CLOEXEC);
    memset(page, 0xa5, sizeof page);
    if (bait < 0 || write(bait, page, sizeof page) != BAIT_BYTES) return -1;
    for (int i = 1; i < BAITS; i++) (void)fcntl(bait, F_DUPFD_CLOEXEC, 3);
    return bait;
}

static bool is_bait_touched(int bait) {
    uint8_t page[BAIT_BYTES];
    struct stat info;
    if (fstat(bait, &info) != 0 || info.st_size != BAIT_BYTES) return true;
    if (lseek(bait, 0, SEEK_CUR) != BAIT_BYTES || pread(bait, page, sizeof page, 0) != BAIT_BYTES)
        return true;
    for (size_t i = 0; i < sizeof page; i++)
        if (page[i] != 0xa5) return true;
    return false;
}

v_watch *v_watch_begin(void) {
    static v_watch watch;
    watch = (v_watch){.self = getpid(), .bait = lay_bait()};
    if (watch.bait < 0) return NULL;
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1); /* a daemon's orphan is found, too */
    for (int i = 0; i < RLIM_NLIMITS; i++) (void)getrlimit((__rlimit_resource_t)i, &watch.limits[i]);
    for (int number = 0; number < MAX_OPEN; number++) {
        struct stat info;
        if (fstat(number, &info) != 0) continue;
        watch.open[watch.count].number = number;
        watch.open[watch.count].flags = fcntl(number, F_GETFL);
        watch.open[watch.count].device = info.st_dev;
        watch.open[watch.count++].file = info.st_ino;
    }
    return &watch;
}

const char *v_watch_change(const v_watch *watch) {
    static char text[80];
    siginfo_t info;
    if (getpid() != watch->self) _exit(0); /* a copy that came back from a fork in the plugin */
    for (uint32_t i = 0; i < watch->count; i++) {
        struct stat now;
        const int number = watch->open[i].number;
        (void)snprintf(text, sizeof text, "closes or changes descriptor %d", number);
        if (fstat(number, &now) != 0 || now.st_dev != watch->open[i].device ||
            now.st_ino != watch->open[i].file || fcntl(number, F_GETFL) != watch->open[i].flags)
            return text;
    }
    if (is_bait_touched(watch->bait)) return "writes to a file of the host's, or changes its size";
    for (int i = 0; i < RLIM_NLIMITS; i++) {
        struct rlimit now;
        (void)snprintf(text, sizeof text, "changes the resource limit %d", i);
        if (getrlimit((__rlimit_resource_t)i, &now) == 0 &&
            (now.rlim_cur != watch->limits[i].rlim_cur || now.rlim_max != watch->limits[i].rlim_max))
            return text;
    }
    if (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0) return "leaves a child process behind";
    return NULL;
}

/* ---- */
/* An OpenCL runtime may have handlers of its own. */
const char *v_process_handler(library_range library) {
    static char name[16];
    for (int number = 1; number < NSIG; number++) {
        struct sigaction now;
        const char *known = sigabbrev_np(number);
        if (sigaction(number, NULL, &now) != 0 ||
            !library_range_holds(library, (const void *)(uintptr_t)now.sa_handler))
            continue;
        if (known)
            (void)snprintf(name, sizeof name, "SIG%s", known);
        else
            (void)snprintf(name, sizeof name, "signal %d", number);
        return name;
    }
    return NULL;
}

static uint32_t entries_of(const char *folder) {
    uint32_t count = 0;
    DIR *dir = opendir(folder);
    if (!dir) return 0;
    while (readdir(dir)) count++;
    (void)closedir(dir);
    return count;
}

uint32_t v_process_files(void) {
    return entries_of("/proc/self/fd");
}

uint32_t v_process_threads(void) {
    return entries_of("/proc/self/task");
}

uint64_t v_process_most_files(void) {
    struct rlimit files;
    return getrlimit(RLIMIT_NOFILE, &files) == 0 ? files.rlim_cur : UINT64_MAX;
}
