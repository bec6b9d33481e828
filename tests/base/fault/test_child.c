/* SPDX-License-Identifier: MIT */
/* Child processes: however one ends, the parent hears of it in time, and says it in one sentence. */
#include "guard/child.h"

#include "core/progress.h"
#include "support/unit.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define MEMORY_LIMIT (64u << 20)

static _Noreturn void forever(void) {
    for (;;) (void)poll(NULL, 0, 1000);
}

static int crash(intptr_t channel, int value) {
    (void)signal(SIGSEGV, SIG_DFL); /* of a sanitizer, which would leave */
    (void)raise(SIGSEGV);
    return 0;
}

static int abort_it(intptr_t channel, int value) {
    abort();
}

static int leave(intptr_t channel, int value) {
    return value;
}

static int hang(intptr_t channel, int value) {
    (void)signal(SIGTERM, SIG_IGN);
    forever();
}

static int grab(intptr_t channel, int value) {
    for (int i = 0; i < 10000; i++) {
        char *block = malloc(1u << 20);
        if (block) memset(block, 1, 1u << 20);
        (void)poll(NULL, 0, 1);
    }
    return 0;
}

static int silent(intptr_t channel, int value) {
    (void)close((int)channel);
    forever();
}

static int stop_group(intptr_t channel, int value) {
    (void)kill(0, SIGKILL); /* its group is its own: the parent does not notice */
    forever();
}

static int tell_itself(intptr_t channel, int value) {
    const pid_t self = getpid();
    (void)hs_child_send(channel, &self, sizeof self);
    forever();
}

static int with_grandchild(intptr_t channel, int value);
static int echo(intptr_t channel, int value);

/* What a child does is told by its arguments: the number of its work, and a value. */
static int (*const works[])(intptr_t channel, int value) = {
    crash, abort_it, leave, hang, grab, silent, stop_group, tell_itself, with_grandchild, echo};

__attribute__((constructor)) static void be_a_child(int argc, char **argv) {
    if (hs_child_take(&argc, argv)) hs_child_leave(works[atoi(argv[1])](hs_child_passed(0), atoi(argv[2])));
}

static void start(hs_child *child, const hs_child_limits *limits, int (*work)(intptr_t, int), int value) {
    char name[] = "child", number[16], text[16];
    char *const argv[] = {name, number, text, NULL};
    hs_error err = {0};
    int n = 0;
    while (works[n] != work) n++;
    (void)snprintf(number, sizeof number, "%d", n);
    (void)snprintf(text, sizeof text, "%d", value);
    if (!hs_child_start(child, limits, NULL, argv, NULL, 0, &err)) fail_msg("%s", err.text);
}

static void each_end_has_its_sentence(void **state) {
    const struct {
        int (*work)(intptr_t, int);
        int value;
        hs_child_fate fate;
        const char *sentence;
    } cases[] = {
        {crash, 0, HS_CHILD_CRASHED, "crashed: SIGSEGV"},
        {abort_it, 0, HS_CHILD_CRASHED, "aborted"},
        {leave, 0, HS_CHILD_LEFT, "left by exit(0)"},
        {leave, 77, HS_CHILD_LEFT, "left by exit(77)"},
        {grab, 0, HS_CHILD_GREEDY, "took more than 64 MiB"},
        {silent, 0, HS_CHILD_SILENT, "closed or misused its channel"},
        {stop_group, 0, HS_CHILD_CRASHED, "crashed: SIGKILL"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const hs_child_limits limits = {.memory_bytes = MEMORY_LIMIT};
        hs_child child;
        char sentence[128];
        start(&child, &limits, cases[i].work, cases[i].value);
        assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_ENDED);
        hs_child_tell(&child.end, sentence, sizeof sentence);
        assert_string_equal(sentence, cases[i].sentence);
        assert_int_equal(child.end.fate, cases[i].fate);
        hs_child_close(&child);
        assert_int_equal(child.process, 0);
    }
}

static void a_hanging_child_is_ended_in_time(void **state) {
    hs_child child;
    char sentence[128];
    const hs_child_limits none = {0};
    start(&child, &none, hang, 0);
    const double start = hs_now();
    assert_int_equal(hs_child_wait(&child, 0.1), HS_CHILD_NOTHING);
    hs_child_wait_end(&child, 0.2);
    const double seconds = hs_now() - start;
    assert_true(seconds >= 0.3 && seconds < 5);
    hs_child_tell(&child.end, sentence, sizeof sentence);
    assert_string_equal(sentence, "ran out of time (0.2 s)");
    hs_child_close(&child);
}

/* How a child's own child goes, and how the child itself ends. */
enum { IN_GROUP, IN_A_SESSION, AS_A_DAEMON, WAYS };
typedef struct {
    int way;
    bool leaves; /* else it is ended */
} escape;

/* Starts a process that runs on and tells its id; leaves or hangs beside it. */
static int with_grandchild(intptr_t channel, int value) {
    const escape e = {.way = value / 2, .leaves = value % 2};
    if (fork() == 0) {
        if (e.way != IN_GROUP) (void)setsid();
        if (e.way == AS_A_DAEMON && fork() != 0) _exit(0);
        const pid_t self = getpid();
        (void)hs_child_send(channel, &self, sizeof self);
        forever();
    }
    if (!e.leaves) forever();
    (void)poll(NULL, 0, 200); /* until it has told */
    return 0;
}

/* A process that nobody waits for may stay as a zombie where no init collects it: it does not run any
 * more. */
static bool runs(pid_t pid) {
    char path[64], text[256] = "";
    (void)snprintf(path, sizeof path, "/proc/%ld/stat", (long)pid);
    FILE *file = fopen(path, "re");
    if (!file) return false;
    const size_t length = fread(text, 1, sizeof text - 1, file);
    (void)fclose(file);
    text[length] = '\0';
    const char *after_name = strrchr(text, ')');
    return after_name && after_name[1] && after_name[2] != 'Z' && after_name[2] != 'X';
}

/* Waits until it does not. */
static bool ends(pid_t pid) {
    for (int i = 0; i < 3000 && runs(pid); i++) (void)poll(NULL, 0, 10);
    return !runs(pid);
}

static void assert_grandchild_ends(escape e) {
    hs_child child;
    pid_t grandchild = 0;
    const hs_child_limits none = {0};
    start(&child, &none, with_grandchild, 2 * e.way + e.leaves);
    assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_MESSAGE);
    assert_true(hs_child_receive(child.channel, &grandchild, sizeof grandchild));
    assert_true(grandchild > 0 && runs(grandchild));
    if (e.leaves) {
        hs_child_wait_end(&child, 30);
        assert_int_equal(child.end.fate, HS_CHILD_LEFT);
    } else {
        hs_child_close(&child);
    }
    const bool ended = ends(grandchild);
    if (!ended) (void)kill(grandchild, SIGKILL);
    assert_true(ended);
    if (e.leaves) hs_child_close(&child);
}

static void what_it_started_ends_with_it(void **state) {
    for (int way = 0; way < WAYS; way++) {
        assert_grandchild_ends((escape){way, false});
        assert_grandchild_ends((escape){way, true});
    }
}

/* Others that this process has started itself are nobody's leftovers: a child's siblings, and its own. */
static void nobody_else_is_ended(void **state) {
    hs_child first, second;
    const hs_child_limits none = {0};
    const pid_t own = fork();
    if (own == 0) forever();
    start(&first, &none, hang, 0);
    start(&second, &none, hang, 0);
    hs_child_close(&first);
    assert_true(runs(own) && runs((pid_t)second.process));
    hs_child_close(&second);
    assert_true(runs(own));
    (void)kill(own, SIGKILL);
}

/* A program that prints without end is heard to the end, and shown up to its limit. */
static void what_it_prints_is_bounded(void **state) {
    enum { PRINTED = 2000000, SHOWN = 5000 };
    hs_child child;
    hs_error err = {0};
    struct stat shown;
    const hs_child_limits limits = {.said_bytes = SHOWN};
    char *const argv[] = {"sh", "-c", "yes 0123456789 | head -c 2000000; exit 9", NULL};
    const int errors = dup(STDERR_FILENO), file = memfd_create("errors", MFD_CLOEXEC);
    (void)dup2(file, STDERR_FILENO);
    const bool started = hs_child_start(&child, &limits, "/bin/sh", argv, NULL, 0, &err);
    const hs_child_news news = started ? hs_child_wait(&child, 60) : HS_CHILD_NOTHING;
    (void)dup2(errors, STDERR_FILENO);
    assert_int_equal(news, HS_CHILD_ENDED);
    assert_int_equal(child.end.number, 9);
    assert_int_equal(fstat(file, &shown), 0);
    assert_int_equal(shown.st_size, SHOWN);
    assert_int_equal(hs_child_dropped(&child), PRINTED - SHOWN);
    assert_int_equal(hs_child_dropped(&child), 0);
    hs_child_close(&child);
    (void)close(errors);
    (void)close(file);
}

/* A plain process, under no keeper: starts a child with a child of its own, tells of both, and ends. */
static _Noreturn void short_parent(int told, int way, int number) {
    hs_child child;
    pid_t both[2] = {0};
    const hs_child_limits none = {0};
    start(&child, &none, with_grandchild, 2 * way);
    if (hs_child_wait(&child, 30) == HS_CHILD_MESSAGE)
        (void)hs_child_receive(child.channel, &both[1], sizeof both[1]);
    both[0] = (pid_t)child.process;
    (void)!write(told, both, sizeof both);
    (void)raise(number);
    _exit(1);
}

static void assert_all_end_with(int way, int number) {
    int told[2], status = 0;
    pid_t both[2] = {0};
    assert_int_equal(pipe(told), 0);
    const pid_t parent = fork();
    if (parent == 0) short_parent(told[1], way, number);
    assert_int_equal(read(told[0], both, sizeof both), sizeof both);
    assert_true(both[0] > 0 && both[1] > 0);
    assert_int_equal(waitpid(parent, &status, 0), parent);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == number);
    assert_true(ends(both[0]) && ends(both[1]));
    (void)close(told[0]);
    (void)close(told[1]);
}

static void all_of_it_dies_with_its_parent(void **state) {
    static const int numbers[] = {SIGKILL, SIGTERM, SIGINT};
    for (int way = 0; way < WAYS; way++)
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) assert_all_end_with(way, numbers[n]);
}

static void *start_one(void *child) {
    const hs_child_limits none = {0};
    start(child, &none, echo, 0);
    return NULL;
}

/* Somebody ends its first process, which looks after the one that works: nobody is left to end that. */
static void what_works_ends_without_its_keeper(void **state) {
    hs_child child;
    pid_t worker = 0;
    const hs_child_limits none = {0};
    start(&child, &none, tell_itself, 0);
    assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_MESSAGE);
    assert_true(hs_child_receive(child.channel, &worker, sizeof worker));
    assert_true(worker != (pid_t)child.process && runs(worker));
    assert_int_equal(kill((pid_t)child.process, SIGKILL), 0);
    const bool ended = ends(worker);
    if (!ended) (void)kill(worker, SIGKILL);
    assert_true(ended);
    hs_child_close(&child);
}

/* It is bound to the process, and the thread that started it may end. */
static void the_thread_that_started_it_may_end(void **state) {
    hs_child child;
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, start_one, &child), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    (void)poll(NULL, 0, 50);
    for (int number = 3; number >= 0; number -= 3) {
        assert_true(hs_child_send(child.channel, &number, sizeof number));
        assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_MESSAGE);
        int doubled = -1;
        assert_true(hs_child_receive(child.channel, &doubled, sizeof doubled));
        assert_int_equal(doubled, 2 * number);
    }
    hs_child_close(&child);
}

/* A service may have 64 descriptors, or fewer. */
static void few_descriptors_are_enough(void **state) {
    hs_child child;
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    const struct rlimit few = {40, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    const hs_child_limits none = {0};
    start(&child, &none, leave, 9);
    hs_child_wait_end(&child, 30);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(child.end.number, 9);
    hs_child_close(&child);
}

/* What begins as a child's mark is an argument if it is none. */
static void other_arguments_stay(void **state) {
    static const char *const texts[] = {"child:",
                                        "child:x",
                                        "child:3",
                                        "child:3,x",
                                        "child:3,4 ",
                                        "child:99,99",
                                        "child:1,2,3,4,5,6,7,8,9,10,11,12"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char name[] = "program", last[64];
        char *argv[] = {name, last, NULL};
        int argc = 2;
        (void)snprintf(last, sizeof last, "%s", texts[i]);
        assert_false(hs_child_take(&argc, argv));
        assert_int_equal(argc, 2);
        assert_false(hs_child_is_one());
    }
}

/* Doubles what it is told, and leaves after a 0. */
static int echo(intptr_t channel, int value) {
    struct rlimit core;
    (void)getrlimit(RLIMIT_CORE, &core);
    for (int number = 1; number && hs_child_receive(channel, &number, sizeof number);) {
        number *= 2;
        if (!hs_child_send(channel, &number, sizeof number)) return 1;
    }
    return core.rlim_max == 0 ? 5 : 6;
}

/* Also where its first process only looks after the one that works. */
static void a_signal_to_it_reaches_what_works(void **state) {
    hs_child child;
    const hs_child_limits none = {0};
    char sentence[128];
    int number = 7;
    start(&child, &none, echo, 0);
    assert_true(hs_child_send(child.channel, &number, sizeof number));
    assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_MESSAGE);
    assert_true(hs_child_receive(child.channel, &number, sizeof number)); /* it works */
    assert_int_equal(kill((pid_t)child.process, SIGTERM), 0);
    assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_ENDED);
    hs_child_tell(&child.end, sentence, sizeof sentence);
    assert_string_equal(sentence, "crashed: SIGTERM");
    hs_child_close(&child);
}

static void messages_travel_whole(void **state) {
    hs_child child;
    const hs_child_limits none = {0};
    start(&child, &none, echo, 0);
    for (int i = 3; i >= 0; i--) {
        int number = i;
        assert_true(hs_child_send(child.channel, &number, sizeof number));
        /* The last answer is there although the child may have ended behind it. */
        if (i == 0) (void)poll(NULL, 0, 50);
        assert_int_equal(hs_child_wait(&child, 30), HS_CHILD_MESSAGE);
        char two[2];
        if (i == 1) { /* a message of another length is none */
            assert_false(hs_child_receive(child.channel, two, sizeof two));
            continue;
        }
        assert_true(hs_child_receive(child.channel, &number, sizeof number));
        assert_int_equal(number, 2 * i);
    }
    hs_child_wait_end(&child, 30);
    assert_int_equal(child.end.fate, HS_CHILD_LEFT);
    assert_int_equal(child.end.number, 5); /* and no core dumps */
    assert_false(hs_child_send(child.channel, &(int){1}, sizeof(int)));
    hs_child_close(&child);
}

/* Behind it, at 6, is the line to the keeper. */
static void a_program_gets_what_is_passed(void **state) {
    hs_child child;
    const hs_child_limits none = {0};
    char *const argv[] = {
        "sh", "-c", "read line; [ -z \"$line\" ] && cat <&5 >&4 && [ ! -e /proc/self/fd/7 ] && exit 9", NULL};
    char text[16] = "";
    const int from = memfd_create("from", MFD_CLOEXEC), to = memfd_create("to", MFD_CLOEXEC);
    const int left_open = dup(to); /* without CLOEXEC: a careless library */
    assert_int_equal(pwrite(from, "as given", 8, 0), 8);
    const intptr_t passed[] = {to, from};
    must(hs_child_start(&child, &none, "/bin/sh", argv, passed, 2, &err));
    hs_child_wait_end(&child, 30);
    assert_int_equal(child.end.fate, HS_CHILD_LEFT);
    assert_int_equal(child.end.number, 9);
    assert_int_equal(pread(to, text, sizeof text - 1, 0), 8);
    assert_string_equal(text, "as given");
    hs_child_close(&child);
    (void)close(from);
    (void)close(to);
    (void)close(left_open);
}

static void a_program_that_is_not_there(void **state) {
    hs_child child;
    hs_error err = {0};
    const hs_child_limits none = {0};
    char *const argv[] = {"nobody", NULL};
    assert_false(hs_child_start(&child, &none, "/nonexistent/nobody", argv, NULL, 0, &err));
    assert_int_equal(err.code, HS_ERR_INPUT);
    assert_string_equal(err.text, "/nonexistent/nobody: cannot be run: No such file or directory");
    assert_int_equal(child.process, 0);
    hs_child_close(&child); /* safe */
}

UNIT_MAIN(NULL, NULL, each_end_has_its_sentence, a_hanging_child_is_ended_in_time,
          what_it_started_ends_with_it, all_of_it_dies_with_its_parent, what_works_ends_without_its_keeper,
          the_thread_that_started_it_may_end, few_descriptors_are_enough, other_arguments_stay,
          a_signal_to_it_reaches_what_works, messages_travel_whole, a_program_gets_what_is_passed,
          a_program_that_is_not_there, nobody_else_is_ended, what_it_prints_is_bounded)
