/* SPDX-License-Identifier: MIT */
#include "guard/child.h"

#include "base/progress.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define LOOK_EVERY_MS 20 /* between two looks at the child's memory: too short to fill the machine */
#define MAX_CHILDREN  64
#define MAX_LOOKS     100 /* for strays, however fast they multiply */
#define ABOVE_PASSED  64  /* descriptors are moved up there first, so that none lands on another */

/* ------------------------------------------------------------------------------------ what it leaves -- */

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

/* fork for a child of which all descendants can be found: orphans of it stay below it, and come to this
 * process when it has ended. */
static pid_t fork_child(void) {
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

/* A line of /proc about a process; "" if there is none. */
static void read_proc(long pid, const char *what, char *text, size_t bytes) {
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
    read_proc(pid, "stat", text, sizeof text);
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

/* Ends what a child has left behind; it must have been collected. */
static void end_leftovers(pid_t pid) {
    (void)kill(-pid, SIGKILL);
    (void)pthread_mutex_lock(&starting);
    (void)replace_living(pid, 0);
    for (int looks = 0; looks < MAX_LOOKS && end_strays(); looks++) {
    }
    (void)pthread_mutex_unlock(&starting);
}

/* ------------------------------------------------------------------------------------ what it prints -- */

/* Shows what has come, up to the limit. A pipe holds less than is read here, so all that was printed before
 * a message is shown before it is taken. */
static void show_output(hs_child *child) {
    char text[16384];
    for (int i = 0; child->output >= 0 && i < 16; i++) {
        const ssize_t got = read(child->output, text, sizeof text);
        if (got < 0) return;
        if (got == 0) {
            (void)close(child->output);
            child->output = -1;
            return;
        }
        const uint64_t limit = child->limits.said_bytes ? child->limits.said_bytes : UINT64_MAX;
        const uint64_t room = limit > child->said ? limit - child->said : 0;
        (void)fwrite(text, 1, room < (size_t)got ? (size_t)room : (size_t)got, stderr);
        child->said += (uint64_t)got;
    }
}

uint64_t hs_child_dropped(hs_child *child) {
    const uint64_t said = child->said, limit = child->limits.said_bytes;
    child->said = 0;
    return limit && said > limit ? said - limit : 0;
}

/* ------------------------------------------------------------------------------------ in the child -- */

static void set_limit(__rlimit_resource_t what, rlim_t soft, rlim_t hard) {
    const struct rlimit limit = {soft, hard};
    (void)setrlimit(what, &limit);
}

/* Between fork and what comes next: calls that are safe there only. */
static void prepare_child(pid_t parent) {
    static const int reset[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL};
    sigset_t none;
    (void)setpgid(0, 0);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0); /* the parent died before that took hold */
    for (size_t i = 0; i < sizeof reset / sizeof *reset; i++) (void)signal(reset[i], SIG_DFL);
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL);
    set_limit(RLIMIT_CORE, 0, 0);
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (nothing >= 0) (void)dup2(nothing, STDIN_FILENO);
}

/* Puts the channel and what is passed where the program looks for them. False with errno. */
static bool arrange(int channel, int output, const int *passed, uint32_t count) {
    int high[HS_CHILD_MAX_PASSED + 1];
    if (dup2(output, STDERR_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0) return false;
    for (uint32_t i = 0; i <= count; i++) {
        high[i] = fcntl(i ? passed[i - 1] : channel, F_DUPFD_CLOEXEC, ABOVE_PASSED);
        if (high[i] < 0) return false;
    }
    for (uint32_t i = 0; i <= count; i++)
        if (dup2(high[i], HS_CHILD_CHANNEL + (int)i) < 0) return false;
    /* What a library of the parent left open without CLOEXEC; on an old kernel it stays open. */
    (void)close_range(HS_CHILD_CHANNEL + 1u + count, ~0u, CLOSE_RANGE_CLOEXEC);
    return true;
}

/* ----------------------------------------------------------------------------------------- starting -- */

/* The channel's two ends, and whether the parent's is to be kept. */
static bool open_channel(int ends[2], hs_error *err) {
    return socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0 ||
           hs_fail(err, HS_ERR_MEMORY, "child process: no channel: %s", strerror(errno));
}

/* The parent's side after fork; `pid` < 0: it failed. */
static bool adopt(hs_child *child, pid_t pid, int ends[2], int output, const hs_child_limits *limits,
                  hs_error *err) {
    const int reason = errno;
    (void)close(ends[1]);
    if (pid < 0) {
        (void)close(ends[0]);
        return hs_fail(err, HS_ERR_MEMORY, "child process: cannot be started: %s", strerror(reason));
    }
    (void)setpgid(pid, pid); /* as the child does: whoever comes first */
    *child = (hs_child){.pid = pid, .channel = ends[0], .output = output, .limits = *limits};
    return true;
}

bool hs_child_fork(hs_child *child, const hs_child_limits *limits, int (*work)(int channel, void *context),
                   void *context, hs_error *err) {
    int ends[2];
    *child = (hs_child){0};
    if (!open_channel(ends, err)) return false;
    const pid_t parent = getpid(), pid = fork_child();
    if (pid == 0) {
        prepare_child(parent);
        (void)close(ends[0]);
        _exit(work(ends[1], context));
    }
    return adopt(child, pid, ends, -1, limits, err);
}

/* The new process: becomes the program, or writes errno to `report`. */
static _Noreturn void become(const char *program, char *const argv[], int channel, int output,
                             const int *passed, uint32_t count, int report) {
    /* Above what arrange overwrites. */
    const int safe = fcntl(report, F_DUPFD_CLOEXEC, ABOVE_PASSED);
    if (safe >= 0 && arrange(channel, output, passed, count)) (void)execv(program, argv);
    const int reason = errno;
    (void)!write(safe >= 0 ? safe : report, &reason, sizeof reason);
    _exit(127);
}

bool hs_child_exec(hs_child *child, const hs_child_limits *limits, const char *program, char *const argv[],
                   const int *passed, uint32_t passed_count, hs_error *err) {
    int ends[2], report[2], output[2] = {-1, -1}, reason = 0;
    *child = (hs_child){0};
    if (passed_count > HS_CHILD_MAX_PASSED)
        return hs_fail(err, HS_ERR_MEMORY, "child process: %u descriptors, at most %u", passed_count,
                       HS_CHILD_MAX_PASSED);
    if (pipe2(report, O_CLOEXEC) != 0)
        return hs_fail(err, HS_ERR_MEMORY, "child process: no pipe: %s", strerror(errno));
    bool ok = (pipe2(output, O_CLOEXEC | O_NONBLOCK) == 0 && fcntl(output[1], F_SETFL, 0) == 0) ||
              hs_fail(err, HS_ERR_MEMORY, "child process: no pipe: %s", strerror(errno));
    if (ok && (ok = open_channel(ends, err))) {
        const pid_t parent = getpid(), pid = fork_child();
        if (pid == 0) {
            prepare_child(parent);
            become(program, argv, ends[1], output[1], passed, passed_count, report[1]);
        }
        ok = adopt(child, pid, ends, output[0], limits, err);
    }
    if (!ok) (void)close(output[0]);
    (void)close(output[1]);
    (void)close(report[1]);
    /* The pipe closes without a word where exec succeeds. */
    if (ok && read(report[0], &reason, sizeof reason) == (ssize_t)sizeof reason) {
        hs_child_close(child);
        ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot be run: %s", program, strerror(reason));
    }
    (void)close(report[0]);
    return ok;
}

/* ----------------------------------------------------------------------------------------- watching -- */

/* Notes how the child ended, if it has. If it ended in its own way while it was being killed, that counts. */
static bool has_ended(hs_child *child, int options) {
    int status = 0;
    if (!child->pid) return true;
    const pid_t got = waitpid(child->pid, &status, options);
    if (got == 0 || (got < 0 && errno == EINTR)) return false;
    end_leftovers(child->pid);
    show_output(child); /* its last words */
    child->pid = 0;
    const bool killed = got < 0 || (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    if (killed && child->end.fate != HS_CHILD_RUNS) return true;
    const bool left = got < 0 || WIFEXITED(status);
    child->end.fate = left ? HS_CHILD_LEFT : HS_CHILD_CRASHED;
    child->end.number = got < 0 ? 0 : left ? WEXITSTATUS(status) : WTERMSIG(status);
    return true;
}

/* Bytes of resident memory that the child shares with nobody; 0 if the system does not tell. */
static uint64_t own_memory(pid_t pid) {
    char text[128];
    unsigned long long resident = 0, shared = 0;
    read_proc(pid, "statm", text, sizeof text);
    if (sscanf(text, "%*u %llu %llu", &resident, &shared) != 2 || resident < shared) return 0;
    return (uint64_t)(resident - shared) * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* True if the child has ended, or has been ended for its memory. */
static bool look(hs_child *child) {
    show_output(child);
    if (has_ended(child, WNOHANG)) return true;
    const uint64_t limit = child->limits.memory_bytes;
    if (limit == 0 || own_memory(child->pid) <= limit) return false;
    hs_child_kill(child, HS_CHILD_GREEDY, 0);
    return true;
}

static int slice_ms(double seconds) {
    const double ms = seconds * 1e3;
    return ms <= 0 ? 0 : ms < LOOK_EVERY_MS ? (int)ms + 1 : LOOK_EVERY_MS;
}

/* True if a message waits. The end of the stream is readable, too, but has no bytes. */
static bool has_message(const hs_child *child) {
    char byte;
    return recv(child->channel, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
}

/* After the other end of the channel was closed: the child is about to end, or is ended. */
static void wait_or_kill(hs_child *child) {
    for (int pause_ms = 1; pause_ms < 200; pause_ms *= 2) {
        if (has_ended(child, WNOHANG)) return;
        (void)poll(NULL, 0, pause_ms);
    }
    hs_child_kill(child, HS_CHILD_SILENT, 0);
}

hs_child_news hs_child_wait(hs_child *child, double seconds) {
    const double until = hs_now() + seconds;
    while (child->pid) {
        struct pollfd ends[] = {{.fd = child->channel, .events = POLLIN},
                                {.fd = child->output, .events = POLLIN}};
        (void)poll(ends, 2, slice_ms(until - hs_now()));
        if (ends[0].revents) {
            const bool message = has_message(child);
            show_output(child);
            if (message) return HS_CHILD_MESSAGE;
            wait_or_kill(child);
        } else if (!look(child) && hs_now() >= until) {
            return HS_CHILD_NOTHING;
        }
    }
    /* Its last words count: it may have ended after them. */
    return child->end.fate == HS_CHILD_LEFT && has_message(child) ? HS_CHILD_MESSAGE : HS_CHILD_ENDED;
}

void hs_child_wait_end(hs_child *child, double seconds) {
    const double until = hs_now() + seconds;
    int pause_ms = 1; /* most children end at once */
    while (!look(child)) {
        const double left = until - hs_now();
        if (left <= 0) {
            hs_child_kill(child, HS_CHILD_LATE, seconds);
            return;
        }
        const int slice = slice_ms(left);
        (void)poll(NULL, 0, pause_ms < slice ? pause_ms : slice);
        if (pause_ms < LOOK_EVERY_MS) pause_ms *= 2;
    }
}

void hs_child_kill(hs_child *child, hs_child_fate why, double seconds) {
    if (has_ended(child, WNOHANG)) return;
    child->end = (hs_child_end){.fate = why, .seconds = seconds, .memory_bytes = child->limits.memory_bytes};
    (void)kill(-child->pid, SIGKILL);
    (void)kill(child->pid, SIGKILL); /* if it left its group */
    while (!has_ended(child, 0)) {
    }
}

void hs_child_close(hs_child *child) {
    if (child->pid) hs_child_kill(child, HS_CHILD_GONE, 0);
    if (child->end.fate != HS_CHILD_RUNS) { /* else there never was one */
        (void)close(child->channel);
        if (child->output >= 0) (void)close(child->output);
    }
    *child = (hs_child){0};
}

/* ---------------------------------------------------------------------------------------- the words -- */

bool hs_child_send(int channel, const void *message, size_t bytes) {
    ssize_t sent;
    do {
        sent = send(channel, message, bytes, MSG_NOSIGNAL);
    } while (sent < 0 && errno == EINTR);
    return sent == (ssize_t)bytes;
}

bool hs_child_receive(int channel, void *message, size_t bytes) {
    ssize_t got;
    do {
        got = recv(channel, message, bytes, MSG_TRUNC);
    } while (got < 0 && errno == EINTR);
    return got == (ssize_t)bytes;
}

void hs_child_tell(const hs_child_end *end, char *out, size_t bytes) {
    const char *name;
    switch (end->fate) {
    case HS_CHILD_RUNS:
        (void)snprintf(out, bytes, "runs");
        return;
    case HS_CHILD_LEFT:
        (void)snprintf(out, bytes, "left by exit(%d)", end->number);
        return;
    case HS_CHILD_CRASHED:
        name = sigabbrev_np(end->number);
        if (end->number == SIGABRT)
            (void)snprintf(out, bytes, "aborted");
        else if (name)
            (void)snprintf(out, bytes, "crashed: SIG%s", name);
        else
            (void)snprintf(out, bytes, "crashed: signal %d", end->number);
        return;
    case HS_CHILD_LATE:
        (void)snprintf(out, bytes, "ran out of time (%.1f s)", end->seconds);
        return;
    case HS_CHILD_GREEDY:
        (void)snprintf(out, bytes, "took more than %" PRIu64 " MiB", end->memory_bytes >> 20);
        return;
    case HS_CHILD_SILENT:
        (void)snprintf(out, bytes, "closed or misused its channel");
        return;
    case HS_CHILD_GONE:
        (void)snprintf(out, bytes, "was ended");
        return;
    }
}
