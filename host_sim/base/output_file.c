/* SPDX-License-Identifier: MIT */
#include "base/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Temporary names that are in use, for the handler below. Of more at once the rest would stay behind. */
#define MAX_PENDING 32
static _Atomic(const char *) pending[MAX_PENDING];

/* Removes what is half written, then lets the signal do what it does. Calls what a handler may call only. */
static void clean_up(int number) {
    for (int i = 0; i < MAX_PENDING; i++) {
        const char *name = atomic_load(&pending[i]);
        if (name) (void)unlink(name);
    }
    (void)signal(number, SIG_DFL);
    (void)raise(number);
}

/* Signals that end the program, unless somebody else wants them or they are ignored (nohup). */
static void watch_signals(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    static atomic_bool watching;
    if (atomic_exchange(&watching, true)) return;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction now;
        const struct sigaction ours = {.sa_handler = clean_up};
        if (sigaction(numbers[i], NULL, &now) == 0 && now.sa_handler == SIG_DFL)
            (void)sigaction(numbers[i], &ours, NULL);
    }
}

static void remember(const char *name) {
    watch_signals();
    for (int i = 0; i < MAX_PENDING; i++) {
        const char *nobody = NULL;
        if (atomic_compare_exchange_strong(&pending[i], &nobody, name)) return;
    }
}

static void forget(const char *name) {
    for (int i = 0; i < MAX_PENDING; i++) {
        const char *same = name;
        if (atomic_compare_exchange_strong(&pending[i], &same, NULL)) return;
    }
}

/* Opens a name that no file has yet. open instead of mkstemp, so that the file gets the user's umask. */
static int create_temporary(hs_output_file *output, const char *path) {
    const size_t bytes = strlen(path) + 16;
    output->temporary = malloc(bytes);
    if (!output->temporary) {
        errno = ENOMEM;
        return -1;
    }
    for (int attempt = 0; attempt < 1000; attempt++) {
        (void)snprintf(output->temporary, bytes, "%s.tmp%d", path, attempt);
        const int descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) remember(output->temporary);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
    return -1;
}

bool hs_output_open(hs_output_file *output, const char *path, hs_error *err) {
    memset(output, 0, sizeof *output);
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be written: exists and is not a regular file", path);
    const int descriptor = create_temporary(output, path);
    if (descriptor < 0) {
        hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be created: %s", path, strerror(errno));
        free(output->temporary);
        output->temporary = NULL;
        return false;
    }
    output->path = strdup(path);
    output->file = output->path ? fdopen(descriptor, "wb") : NULL;
    if (!output->file) {
        hs_fail(err, HS_ERR_MEMORY, "%s: no memory to write the file", path);
        (void)close(descriptor);
        hs_output_discard(output);
        return false;
    }
    return true;
}

bool hs_output_write(hs_output_file *output, const void *data, size_t bytes, hs_error *err) {
    if (bytes == 0 || fwrite(data, 1, bytes, output->file) == bytes) return true;
    return hs_fail(err, HS_ERR_OUTPUT, "%s: %zu bytes cannot be written: %s", output->path, bytes,
                   strerror(errno));
}

bool hs_output_commit(hs_output_file *output, hs_error *err) {
    /* fclose reports what buffered writes met, a full disk for example. */
    bool ok = ferror(output->file) == 0;
    ok = fclose(output->file) == 0 && ok;
    output->file = NULL;
    ok = ok && rename(output->temporary, output->path) == 0;
    if (!ok) hs_fail(err, HS_ERR_OUTPUT, "%s: cannot be written: %s", output->path, strerror(errno));
    if (ok) {
        forget(output->temporary);
        free(output->temporary);
        output->temporary = NULL;
    }
    hs_output_discard(output);
    return ok;
}

void hs_output_discard(hs_output_file *output) {
    if (output->file) (void)fclose(output->file);
    if (output->temporary) {
        (void)unlink(output->temporary);
        forget(output->temporary);
    }
    free(output->temporary);
    free(output->path);
    memset(output, 0, sizeof *output);
}

bool hs_output_try(const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (path && !hs_output_open(&output, path, err)) return false;
    hs_output_discard(&output);
    return true;
}
