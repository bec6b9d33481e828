/* SPDX-License-Identifier: MIT */
#include "guard/child_keeper.h"
#include "guard/child_living.h"
#include "guard/child_system.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define CHANNEL    3 /* its descriptor in the child; what is passed comes behind it */
#define MAX_HANDED (HS_CHILD_MAX_PASSED + 2u) /* the channel, what is passed, and the line */
/* Descriptors are moved up there first, so that none lands on another. */
#define ABOVE_HANDED (CHANNEL + (int)MAX_HANDED)

/* ------------------------------------------------------------------------------------ in the child -- */

/* Between fork and what comes next: calls that are safe there only. */
static void prepare_child(void) {
    static const int reset[] = {SIGINT, SIGTERM, SIGHUP,  SIGPIPE, SIGSEGV,
                                SIGBUS, SIGFPE,  SIGABRT, SIGILL,  SIGCHLD};
    sigset_t none;
    (void)setpgid(0, 0);
    for (size_t i = 0; i < sizeof reset / sizeof *reset; i++) (void)signal(reset[i], SIG_DFL);
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL);
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (nothing >= 0) (void)dup2(nothing, STDIN_FILENO);
}

/* Puts what is handed over where the program looks for it. False with errno. */
static bool arrange(const int *handed, uint32_t count, int output) {
    int high[MAX_HANDED];
    if (output >= 0 && (dup2(output, STDERR_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0)) return false;
    for (uint32_t i = 0; i < count; i++) {
        high[i] = fcntl(handed[i], F_DUPFD_CLOEXEC, ABOVE_HANDED);
        if (high[i] < 0) return false;
    }
    for (uint32_t i = 0; i < count; i++)
        if (dup2(high[i], CHANNEL + (int)i) < 0) return false;
    /* What a library of the parent left open without CLOEXEC; on an old kernel it stays open. */
    (void)close_range(CHANNEL + count, ~0u, CLOSE_RANGE_CLOEXEC);
    return true;
}

/* ----------------------------------------------------------------------------------------- starting -- */

static bool refuse(const char *what, hs_error *err) {
    return hs_fail(err, HS_ERR_MEMORY, "child process: %s: %s", what, strerror(errno));
}

/* The child's end is output[1]; -1: it has the parent's. */
static bool open_output(hs_child_output where, int output[2], hs_error *err) {
    if (where == HS_CHILD_INHERITED) return true;
    if (where == HS_CHILD_DISCARDED)
        return (output[1] = open("/dev/null", O_WRONLY | O_CLOEXEC)) >= 0 || refuse("/dev/null", err);
    return (pipe2(output, O_CLOEXEC | O_NONBLOCK) == 0 && fcntl(output[1], F_SETFL, 0) == 0) ||
           refuse("no pipe", err);
}

/* The new process: becomes the program, or writes errno to `report`. */
static _Noreturn void become(const char *program, char *const argv[], const int *handed, uint32_t count,
                             int output, int report) {
    /* Above what arrange overwrites. */
    const int safe = fcntl(report, F_DUPFD_CLOEXEC, ABOVE_HANDED);
    if (safe >= 0 && arrange(handed, count, output)) (void)execv(program, argv);
    const int reason = errno;
    (void)!write(safe >= 0 ? safe : report, &reason, sizeof reason);
    _exit(127);
}

/* fork and exec. The pipe `report` closes without a word where exec succeeds. */
static bool launch(hs_child *child, const char *program, char *const argv[], const int *handed,
                   uint32_t count, int output, hs_error *err) {
    int report[2], reason = 0;
    if (pipe2(report, O_CLOEXEC) != 0) return refuse("no pipe", err);
    const pid_t pid = hs_child_fork();
    if (pid == 0) {
        prepare_child();
        become(program, argv, handed, count, output, report[1]);
    }
    bool ok = pid > 0 || refuse("cannot be started", err);
    if (ok) (void)setpgid(pid, pid); /* as the child does: whoever comes first */
    (void)close(report[1]);
    child->process = pid;
    if (ok && read(report[0], &reason, sizeof reason) == (ssize_t)sizeof reason) {
        (void)waitpid(pid, NULL, 0);
        hs_child_end_leftovers(pid);
        ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot be run: %s", program, strerror(reason));
    }
    (void)close(report[0]);
    return ok;
}

/* Two ends that no further process inherits. */
static bool open_pair(int kind, int ends[2], hs_error *err) {
    return socketpair(AF_UNIX, kind | SOCK_CLOEXEC, 0, ends) == 0 || refuse("no channel", err);
}

bool hs_process_start(hs_child *child, const char *program, char **argv, uint32_t argc,
                      const intptr_t *passed, uint32_t passed_count, hs_error *err) {
    intptr_t places[HS_CHILD_HANDLES] = {CHANNEL, CHANNEL + 1 + (int)passed_count};
    int ends[2] = {-1, -1}, line[2] = {-1, -1}, output[2] = {-1, -1}, handed[MAX_HANDED];
    char mark[64];
    for (uint32_t i = 0; i < passed_count; i++) places[2 + i] = CHANNEL + 1 + (int)i;
    hs_child_mark(mark, sizeof mark, places, 2 + passed_count);
    argv[argc - 1] = mark;
    bool ok = open_pair(SOCK_SEQPACKET, ends, err) && open_pair(SOCK_STREAM, line, err) &&
              open_output(child->limits.output, output, err);
    handed[0] = ends[1];
    for (uint32_t i = 0; i < passed_count; i++) handed[1 + i] = (int)passed[i];
    handed[1 + passed_count] = line[1];
    ok = ok &&
         launch(child, program ? program : "/proc/self/exe", argv, handed, 2 + passed_count, output[1], err);
    child->channel = ends[0];
    child->bell = line[0];
    child->output = output[0];
    const int theirs[] = {ends[1], line[1], output[1]};
    for (size_t i = 0; i < sizeof theirs / sizeof *theirs; i++)
        if (theirs[i] >= 0) (void)close(theirs[i]);
    if (!ok) hs_process_close(child);
    return ok;
}

void hs_process_close(hs_child *child) {
    const intptr_t ours[] = {child->channel, child->bell, child->output};
    for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
        if (ours[i] >= 0) (void)close((int)ours[i]);
    child->output = -1;
}

/* ----------------------------------------------------------------------------------------- watching -- */

bool hs_process_collect(hs_child *child, bool waits, hs_child_end *end, bool *killed) {
    int status = 0;
    const pid_t pid = (pid_t)child->process, got = waitpid(pid, &status, waits ? 0 : WNOHANG);
    if (got == 0 || (got < 0 && errno == EINTR)) return false;
    hs_child_end_leftovers(pid);
    *killed = got < 0 || (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    const bool left = got < 0 || WIFEXITED(status);
    end->fate = left ? HS_CHILD_LEFT : HS_CHILD_CRASHED;
    end->number = got < 0 ? 0 : left ? WEXITSTATUS(status) : WTERMSIG(status);
    return true;
}

void hs_process_kill(hs_child *child) {
    (void)kill(-(pid_t)child->process, SIGKILL);
    (void)kill((pid_t)child->process, SIGKILL); /* if it left its group */
}

uint64_t hs_process_memory(hs_child *child) {
    char text[128];
    unsigned long long resident = 0, shared = 0;
    if (child->job == 0) child->job = hs_child_worker((int)child->bell);
    hs_child_read_proc(child->job ? child->job : child->process, "statm", text, sizeof text);
    if (sscanf(text, "%*u %llu %llu", &resident, &shared) != 2 || resident < shared) return 0;
    return (uint64_t)(resident - shared) * (uint64_t)sysconf(_SC_PAGESIZE);
}

ptrdiff_t hs_process_read(hs_child *child, char *text, size_t bytes) {
    const ssize_t got = read((int)child->output, text, bytes);
    if (got != 0) return got;
    (void)close((int)child->output);
    child->output = -1;
    return 0;
}

/* The end of the stream is readable, too, but has no bytes. */
bool hs_process_has_message(const hs_child *child) {
    char byte;
    return recv((int)child->channel, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
}

bool hs_process_stirs(hs_child *child, int ms) {
    struct pollfd ends[] = {{.fd = (int)child->channel, .events = POLLIN},
                            {.fd = (int)child->output, .events = POLLIN}};
    (void)poll(ends, 2, ms);
    return ends[0].revents != 0;
}

void hs_process_pause(const hs_child *child, int ms) {
    (void)child;
    (void)poll(NULL, 0, ms);
}

void hs_process_tell_crash(int number, char *out, size_t bytes) {
    const char *name = sigabbrev_np(number);
    if (number == SIGABRT)
        (void)snprintf(out, bytes, "aborted");
    else if (name)
        (void)snprintf(out, bytes, "crashed: SIG%s", name);
    else
        (void)snprintf(out, bytes, "crashed: signal %d", number);
}

/* ------------------------------------------------------------------------------------ being a child -- */

bool hs_child_send(intptr_t channel, const void *message, size_t bytes) {
    ssize_t sent;
    do {
        sent = send((int)channel, message, bytes, MSG_NOSIGNAL);
    } while (sent < 0 && errno == EINTR);
    return sent == (ssize_t)bytes;
}

bool hs_child_receive(intptr_t channel, void *message, size_t bytes) {
    ssize_t got;
    do {
        got = recv((int)channel, message, bytes, MSG_TRUNC);
    } while (got < 0 && errno == EINTR);
    return got == (ssize_t)bytes;
}

void hs_child_look_around(void) {
    static pid_t self;
    if (self == 0) self = getpid();
    if (getpid() != self) _exit(0);
    while (fcntl(CHANNEL, F_GETFD) < 0) (void)pause();
}

void hs_child_leave(int code) {
    _exit(code);
}
