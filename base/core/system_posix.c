/* SPDX-License-Identifier: MIT */
#include "core/system.h"

#include "core/error.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

const char sys_library_ending[] = ".so", sys_list_separator[] = ":", sys_separators[] = "/";
const char *const sys_plugin_folders[] = {"/usr/local/lib/smartvis", "/usr/lib/smartvis", NULL};

int sys_open(const char *path, sys_way way) {
    static const int flags[] = {[SYS_READ] = O_RDONLY,
                                [SYS_NEW] = O_RDWR | O_CREAT | O_TRUNC,
                                [SYS_MORE] = O_RDWR,
                                [SYS_FIRST] = O_WRONLY | O_CREAT | O_EXCL};
    struct stat found;
    const int file = open(path, flags[way] | O_CLOEXEC | O_NONBLOCK, way == SYS_FIRST ? 0666 : 0600);
    if (file < 0) return -1;
    const bool regular = fstat(file, &found) == 0 && S_ISREG(found.st_mode);
    /* One that was there has a mode of its own. */
    if (regular && (way != SYS_NEW || fchmod(file, 0600) == 0)) return file;
    const int why = regular ? errno : EINVAL;
    (void)close(file);
    errno = why;
    return -1;
}

bool sys_is_file(const char *path) {
    struct stat found;
    return stat(path, &found) == 0 && S_ISREG(found.st_mode);
}

bool sys_is_folder(const char *path) {
    struct stat found;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

bool sys_is_there(const char *path) {
    return access(path, F_OK) == 0;
}

bool sys_make_folder(const char *path) {
    return mkdir(path, 0777) == 0 || errno == EEXIST;
}

bool sys_remove(const char *path) {
    return unlink(path) == 0;
}

/* The kernel's name of what was opened is compared, so nobody can change a link in between. */
bool sys_is_below(int file, const char *folder) {
    char link[64], name[SYS_PATH];
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t bytes = readlink(link, name, sizeof name - 1);
    char *whole = realpath(folder, NULL);
    const size_t length = whole && whole[1] != '\0' ? strlen(whole) : 0; /* "/" holds everything */
    name[bytes > 0 ? bytes : 0] = '\0';
    const bool below = whole && strncmp(name, whole, length) == 0 && name[length] == '/';
    free(whole);
    return below;
}

ptrdiff_t sys_read_at(int file, void *out, size_t bytes, uint64_t at) {
    ssize_t got;
    while ((got = pread(file, out, bytes, (off_t)at)) < 0 && errno == EINTR) continue;
    return got;
}

bool sys_same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

bool sys_replace(const char *from, const char *to) {
    return rename(from, to) == 0;
}

bool sys_is_absolute(const char *path) {
    return path[0] == '/';
}

char *sys_full_path(const char *path) {
    return realpath(path, NULL);
}

bool sys_program(char *path, size_t bytes) {
    const ssize_t length = readlink("/proc/self/exe", path, bytes - 1);
    path[length > 0 ? length : 0] = '\0';
    return length > 0;
}

enum { STACK_ENOUGH = 2 << 20, STACK_LEAST = 512 << 10 };

/* The runtime compiles and computes on this stack and on those of its threads, which have by default what the
 * user's limit says. */
static void take_stacks(void) {
    struct rlimit main_thread;
    pthread_attr_t others;
    size_t bytes = 0;
    if (getrlimit(RLIMIT_STACK, &main_thread) == 0 && main_thread.rlim_cur < STACK_ENOUGH) {
        const rlim_t most = main_thread.rlim_max;
        main_thread.rlim_cur = most < STACK_ENOUGH ? most : STACK_ENOUGH;
        if (most < STACK_LEAST) {
            (void)fprintf(stderr, "This process may take %llu KiB of stack (ulimit -s), %d are needed.\n",
                          (unsigned long long)most >> 10, STACK_LEAST >> 10);
            _Exit(HS_ERR_MEMORY);
        }
        (void)setrlimit(RLIMIT_STACK, &main_thread);
    }
    if (pthread_getattr_default_np(&others) != 0) return;
    if (pthread_attr_getstacksize(&others, &bytes) == 0 && bytes < STACK_ENOUGH &&
        pthread_attr_setstacksize(&others, STACK_ENOUGH) == 0)
        (void)pthread_setattr_default_np(&others);
    (void)pthread_attr_destroy(&others);
}

static void (*last_work)(void);

/* Calls what a handler may call only, then lets the signal do what it does: nothing to the first process of a
 * container, which ends by itself. */
static void end(int number) {
    if (last_work) last_work();
    (void)signal(number, SIG_DFL);
    (void)raise(number);
    if (getpid() == 1) _Exit(128 + number);
}

static void hear_the_end(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction now;
        const struct sigaction ours = {.sa_handler = end};
        if (sigaction(numbers[i], NULL, &now) == 0 && now.sa_handler == SIG_DFL)
            (void)sigaction(numbers[i], &ours, NULL);
    }
}

void sys_when_ended(void (*clean_up)(void)) {
    last_work = clean_up;
    hear_the_end();
}

char **sys_arguments(int *count, char **argv) { /* NOLINT(readability-non-const-parameter) */
    (void)count;
    for (int file = 0; file <= 2; file++) /* open takes the lowest that is free */
        if (fcntl(file, F_GETFD) < 0) (void)!open("/dev/null", O_RDWR);
    take_stacks();
    if (getpid() == 1) hear_the_end();
    return argv;
}

void sys_own_folder(const void *inside, char *folder, size_t bytes) {
    Dl_info own;
    folder[0] = '\0';
    const char *slash = dladdr(inside, &own) && own.dli_fname ? strrchr(own.dli_fname, '/') : NULL;
    if (slash) (void)snprintf(folder, bytes, "%.*s", (int)(slash - own.dli_fname + 1), own.dli_fname);
}

void sys_close_when_unloaded(void *library) {
    if (library) (void)dlclose(library);
}

void *sys_pages(size_t bytes) {
    void *at = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return at == MAP_FAILED ? NULL : at;
}

void sys_pages_forbid(void *at, size_t bytes) {
    (void)mprotect(at, bytes, PROT_NONE);
}

void sys_pages_free(void *at, size_t bytes) {
    if (at) (void)munmap(at, bytes);
}

int sys_temporary(void) {
    return memfd_create("temporary", MFD_CLOEXEC);
}

bool sys_environment(const char *name, char *value, size_t bytes) {
    const char *set = getenv(name);
    const int length = snprintf(value, bytes, "%s", set ? set : "");
    if (set && length >= 0 && (size_t)length < bytes) return true;
    value[0] = '\0';
    return false;
}

void sys_set_default(const char *name, const char *value) {
    (void)setenv(name, value, 0);
}

void sys_end_at_fault(void) {
    const struct rlimit none = {0, 0};
    (void)setrlimit(RLIMIT_CORE, &none);
}

static const char *volatile last_words;
static volatile int last_code;

static void say_last_words(void) {
    const char *words = last_words;
    last_words = NULL;
    if (words) (void)!write(STDERR_FILENO, words, strlen(words));
}

static void left(void) {
    if (!last_words) return;
    (void)fflush(NULL);
    say_last_words();
    _exit(last_code);
}

static void fallen(int number) {
    say_last_words();
    (void)signal(number, SIG_DFL);
    (void)raise(number);
}

void sys_last_words(const char *words, int code) {
    static const int numbers[] = {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE};
    static bool watching;
    last_words = words;
    last_code = code;
    if (watching || !words) return;
    watching = atexit(left) == 0;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction now;
        const struct sigaction ours = {.sa_handler = fallen, .sa_flags = SA_NODEFER};
        if (sigaction(numbers[i], NULL, &now) == 0 && now.sa_handler == SIG_DFL)
            (void)sigaction(numbers[i], &ours, NULL);
    }
}

unsigned sys_processors(void) {
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 ? (unsigned)online : 1u;
}

void *sys_aligned(size_t alignment, size_t bytes) {
    return aligned_alloc(alignment, bytes);
}

void sys_aligned_free(void *memory) {
    free(memory);
}

void sys_close_others(void) {
    closefrom(3);
}

/* Of a size that stays it is sealed: nobody can take it away. */
intptr_t sys_shared_new(size_t bytes) {
    const int file = memfd_create("shared", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (file < 0 || bytes == 0 ||
        (ftruncate(file, (off_t)bytes) == 0 &&
         fcntl(file, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0))
        return file;
    (void)close(file);
    return -1;
}

bool sys_shared_resize(intptr_t shared, size_t bytes) {
    return ftruncate((int)shared, (off_t)bytes) == 0;
}

void sys_shared_close(intptr_t shared) {
    if (shared >= 0) (void)close((int)shared);
}

intptr_t sys_shared_reader(intptr_t shared) {
    char path[64];
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", (int)shared);
    return open(path, O_RDONLY | O_CLOEXEC);
}

void *sys_shared_map(intptr_t shared, size_t bytes, bool writes) {
    struct stat there;
    if (fstat((int)shared, &there) != 0 || (size_t)there.st_size < bytes) return NULL;
    void *at = mmap(NULL, bytes, writes ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED | MAP_NORESERVE,
                    (int)shared, 0);
    return at == MAP_FAILED ? NULL : at;
}

bool sys_shared_use(void *at, size_t bytes, bool writes) { /* NOLINT(readability-non-const-parameter) */
    (void)at;
    (void)bytes;
    (void)writes;
    return true;
}

void sys_shared_unmap(void *at, size_t bytes) {
    if (at) (void)munmap(at, bytes);
}
