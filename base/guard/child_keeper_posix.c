/* SPDX-License-Identifier: MIT */
#include "guard/child_keeper.h"

#include "guard/child_living.h"
#include "guard/child_system.h"

#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LINE, NEWS, KEPT }; /* the keeper's descriptors; it has no others */

pid_t hs_child_worker(int line) {
    pid_t worker = 0;
    return recv(line, &worker, sizeof worker, MSG_DONTWAIT) == (ssize_t)sizeof worker ? worker : 0;
}

/* Collects what has ended. True: the worker has, with this status. */
static bool collect(pid_t worker, int *status) {
    bool ended = false;
    int how = 0;
    for (pid_t pid; (pid = waitpid(-1, &how, WNOHANG)) > 0;) {
        if (pid != worker) continue;
        *status = how;
        ended = true;
    }
    return ended;
}

static _Noreturn void end_as(int status) {
    if (WIFSIGNALED(status)) {
        sigset_t it;
        (void)signal(WTERMSIG(status), SIG_DFL);
        (void)sigemptyset(&it);
        (void)sigaddset(&it, WTERMSIG(status));
        (void)raise(WTERMSIG(status));
        (void)sigprocmask(SIG_UNBLOCK, &it, NULL);
    }
    _exit(WEXITSTATUS(status));
}

/* What somebody tells this process is meant for the worker. */
static void hand_on(pid_t worker) {
    struct signalfd_siginfo news;
    if (read(NEWS, &news, sizeof news) == (ssize_t)sizeof news && news.ssi_signo != SIGCHLD)
        (void)kill(worker, (int)news.ssi_signo);
}

static _Noreturn void keep(pid_t worker) {
    struct pollfd ends[] = {{.fd = LINE, .events = POLLIN}, {.fd = NEWS, .events = POLLIN}};
    int status = 0;
    (void)send(LINE, &worker, sizeof worker, MSG_NOSIGNAL);
    while (!collect(worker, &status)) {
        (void)poll(ends, 2, -1);
        if (ends[1].revents) hand_on(worker);
        if (!ends[0].revents) continue;
        (void)kill(worker, SIGKILL); /* the parent is gone, or needs it no more */
        ends[0].fd = -1;
    }
    hs_child_end_leftovers(worker);
    end_as(status);
}

/* With a group of its own: what it does to that does not hit the keeper. */
static void be_worker(pid_t keeper, const sigset_t *before) {
    (void)setpgid(0, 0);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL); /* the keeper has one thread */
    if (getppid() != keeper) _exit(0);
    (void)sigprocmask(SIG_SETMASK, before, NULL);
}

bool hs_child_is_channel(intptr_t handle) {
    struct stat facts;
    return handle <= INT_MAX && fstat((int)handle, &facts) == 0 && S_ISSOCK(facts.st_mode);
}

void hs_child_settle(intptr_t handle) {
    const int line = (int)handle;
    const pid_t keeper = getpid();
    sigset_t news, before;
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
    (void)sigemptyset(&news);
    static const int heard[] = {SIGCHLD, SIGTERM, SIGINT, SIGHUP};
    for (size_t i = 0; i < sizeof heard / sizeof *heard; i++) (void)sigaddset(&news, heard[i]);
    (void)sigprocmask(SIG_BLOCK, &news, &before);
    const int told = signalfd(-1, &news, SFD_CLOEXEC);
    const pid_t worker = told >= 0 ? fork() : -1;
    if (worker == 0) be_worker(keeper, &before);
    if (worker <= 0) { /* without a keeper it is a child all the same */
        if (worker < 0) (void)sigprocmask(SIG_SETMASK, &before, NULL);
        if (told >= 0) (void)close(told);
        (void)close(line);
        return;
    }
    const int high = fcntl(line, F_DUPFD_CLOEXEC, KEPT);
    (void)dup2(told, NEWS);
    (void)dup2(high, LINE);
    closefrom(KEPT);
    keep(worker);
}
