/* SPDX-License-Identifier: MIT */
/* The volumes in the folders of the command line, and nothing outside them. */
#ifndef HS_CONSOLE_FILES_H
#define HS_CONSOLE_FILES_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { HS_CONSOLE_FOLDERS = 16, HS_CONSOLE_FILES = 500, HS_CONSOLE_DEPTH_OF_FOLDERS = 4 };

/* The folders by their real paths. Zeroed: none. */
typedef struct {
    char *folder[HS_CONSOLE_FOLDERS];
    uint32_t count;
} hs_console_files;

/* Adds a folder. HS_ERR_INPUT if there is none of that name, HS_ERR_USAGE beyond HS_CONSOLE_FOLDERS. */
bool hs_console_files_add(hs_console_files *files, const char *folder, hs_error *err);
void hs_console_files_free(hs_console_files *files);

/* Called for every volume, by its path in folder `folder`, in the order of the names; false ends the list. */
typedef bool (*hs_console_file_fn)(void *context, uint32_t folder, const char *path);

/* Lists files that end in .mha, .mhd or .vol, HS_CONSOLE_FILES at most, HS_CONSOLE_DEPTH_OF_FOLDERS folders
 * deep. What a symbolic link leads to outside its folder is left out. */
void hs_console_files_list(const hs_console_files *files, hs_console_file_fn tell, void *context);

/* The real path of a listed file. HS_ERR_INPUT if there is no such folder, no such file, or if it lies
 * outside, by ".." or by a symbolic link, or is no volume's. */
bool hs_console_files_find(const hs_console_files *files, uint32_t folder, const char *path, char *out,
                           size_t bytes, hs_error *err);

#endif
