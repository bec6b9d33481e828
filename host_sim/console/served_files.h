/* SPDX-License-Identifier: MIT */
/* The volumes that a page may open: those in the folders of the command line, and those that are dropped on
 * it. */
#pragma once

#include "core/error.h"

#include <stddef.h>
#include <stdint.h>

enum {
    HS_CONSOLE_FOLDERS = 16,
    HS_CONSOLE_FILES = 500,
    HS_CONSOLE_DEPTH_OF_FOLDERS = 4,
    HS_CONSOLE_PATH = 1024 /* bytes of a file's path in its folder */
};

/* The folders by their real paths. Zeroed: none. */
typedef struct {
    char *folder[HS_CONSOLE_FOLDERS + 1];
    uint32_t count;
    bool drops;  /* the last folder is that of hs_console_drop_open */
    int drop_fd; /* of that folder, open and locked as long as it is in use */
} hs_console_files;

/* Adds a folder. HS_ERR_INPUT if there is none of that name, HS_ERR_USAGE beyond HS_CONSOLE_FOLDERS. */
bool hs_console_files_add(hs_console_files *files, const char *folder, hs_error *err);
void hs_console_files_free(hs_console_files *files);

/* Called for every volume, by its path in folder `folder`, in the order of the names; false ends the list. */
typedef bool (*hs_console_file_fn)(void *context, uint32_t folder, const char *path);

/* Lists volumes: files that end in .mha, .mhd or .vol and are no labels or depths of a scene,
 * HS_CONSOLE_FILES at most, HS_CONSOLE_DEPTH_OF_FOLDERS folders deep. What a symbolic link leads to outside
 * its folder is left out. */
void hs_console_files_list(const hs_console_files *files, hs_console_file_fn tell, void *context);

/* The real path of a listed file. HS_ERR_INPUT if there is no such folder, no such file, or if it lies
 * outside, by ".." or by a symbolic link, or is no volume's. */
bool hs_console_files_find(const hs_console_files *files, uint32_t folder, const char *path, char *out,
                           size_t bytes, hs_error *err);

/* ------------------------------------------------------------------------------------------------ drop -- */
/* Volumes that are dropped on a page: copies in a private folder, which goes with the console. */

#define HS_CONSOLE_DROP_BYTES (UINT64_C(2) << 30) /* of all copies of a console */

/* Makes the folder, which is the last one of `files`. Removes those that consoles have left which ended
 * without a word: nobody holds their lock. */
void hs_console_drop_open(hs_console_files *files);

/* Removes the folder and what is in it. */
void hs_console_drop_close(hs_console_files *files);

/* Reads up to `bytes` bytes that a page sends; 0 or less: no more come. */
typedef int (*hs_console_receive)(void *connection, void *out, size_t bytes);

/* Copies `bytes` bytes into a new file of the folder and writes its path there to `name`: `given`, or what
 * may be a file's name. HS_ERR_INPUT: it is no .mha or .vol, or did not come whole. HS_ERR_OUTPUT,
 * HS_ERR_MEMORY. */
bool hs_console_drop_take(const hs_console_files *files, const char *given, uint64_t bytes,
                          hs_console_receive receive, void *connection, char name[HS_CONSOLE_PATH],
                          hs_error *err);
