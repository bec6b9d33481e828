/* SPDX-License-Identifier: MIT */
#include "support/files.h"

#include <dirent.h>
#include <unistd.h>

static char files_folder[64];

int files_setup(void **state) {
    (void)snprintf(files_folder, sizeof files_folder, "/tmp/sv_files_XXXXXX");
    return mkdtemp(files_folder) ? 0 : -1;
}

int files_count(void) {
    DIR *folder = opendir(files_folder);
    assert_non_null(folder);
    int count = -2; /* "." and ".." */
    while (readdir(folder)) count++;
    (void)closedir(folder);
    return count;
}

const char *files_path(const char *name) {
    return unit_text("%s/%s", files_folder, name);
}

int files_teardown(void **state) {
    DIR *folder = opendir(files_folder);
    if (!folder) return -1;
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;) (void)unlink(files_path(entry->d_name));
    (void)closedir(folder);
    return rmdir(files_folder);
}

void files_write(const char *name, const char *text, const void *data, size_t bytes) {
    FILE *file = fopen(files_path(name), "wb");
    assert_non_null(file);
    if (text) assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    if (bytes) assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    assert_int_equal(fclose(file), 0);
}
