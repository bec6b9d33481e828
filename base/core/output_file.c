/* SPDX-License-Identifier: MIT */
#include "core/output_file.h"

#include "core/paths.h"
#include "core/system.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Temporary names that are in use, for what ends the program. Of more at once the rest would stay behind. */
#define MAX_PENDING 32
static _Atomic(const char *) pending[MAX_PENDING];

/* Removes what is half written. */
static void clean_up(void) {
    for (int i = 0; i < MAX_PENDING; i++) {
        const char *name = atomic_load(&pending[i]);
        if (name) (void)sys_remove(name);
    }
}

static void remember(const char *name) {
    static atomic_bool watching;
    if (!atomic_exchange(&watching, true)) sys_when_ended(clean_up);
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

static int create_temporary(hs_output_file *output, const char *path) {
    const size_t bytes = strlen(path) + 16;
    char *stem = malloc(bytes);
    output->temporary = malloc(bytes);
    int descriptor = -1;
    errno = ENOMEM;
    if (stem && output->temporary) {
        (void)snprintf(stem, bytes, "%s.tmp", path);
        descriptor = hs_path_first(stem, output->temporary, bytes);
    }
    if (descriptor >= 0) remember(output->temporary);
    free(stem);
    return descriptor;
}

bool hs_output_open(hs_output_file *output, const char *path, hs_error *err) {
    memset(output, 0, sizeof *output);
    if (sys_is_there(path) && !sys_is_file(path))
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
    ok = ok && sys_replace(output->temporary, output->path);
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
        (void)sys_remove(output->temporary);
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
