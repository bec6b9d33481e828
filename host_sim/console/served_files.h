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
    bool drops;      /* the last folder is that of hs_console_drop_open */
    int drop_fd;     /* of that folder, open and locked as long as it is in use */
    uint32_t reader; /* a socket: hs_console_ask; 0: nobody is there */
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

/* Bytes that copies may still have. */
uint64_t hs_console_drop_room(const hs_console_files *files);

/* Takes `bytes` bytes that a page hands over under a name, and tells what became of them, which the caller
 * frees. HS_ERR_INPUT: they are none of that, or did not come whole. HS_ERR_OUTPUT, HS_ERR_MEMORY. */
typedef bool (*hs_console_taker)(const hs_console_files *files, const char *given, uint64_t bytes,
                                 hs_console_receive receive, void *connection, char **made, hs_error *err);

/* A volume, for a new file of the folder. `given`: its name, or what may be a file's. *made: JSON, "paths" in
 * the folder and what is to be "told". What is no .mha or .vol the reader makes MetaImage of. */
bool hs_console_take_volume(const hs_console_files *files, const char *given, uint64_t bytes,
                            hs_console_receive receive, void *connection, char **made, hs_error *err);

/* A picture as PNG, of which the reader makes DICOM: *made is the path of a file, for the caller to remove.
 * `given`: the copy that the picture was made of; "": of none. */
bool hs_console_take_picture(const hs_console_files *files, const char *given, uint64_t bytes,
                             hs_console_receive receive, void *connection, char **made, hs_error *err);

/* ---------------------------------------------------------------------------------------------- reader -- */
/* Who has started the console may know more formats, as the Python package does, and answers at a socket
 * (SOCK_SEQPACKET): "read PATH BYTES", "dicom PATH COPY", parted by newlines, by "+ANSWER" or "-SENTENCE". */

/* The answer, which the caller frees; one question at a time. HS_ERR_INPUT: the sentence, or who was asked
 * has gone. HS_ERR_MEMORY. */
bool hs_console_ask(uint32_t reader, const char *what, const char *path, const char *of, char **answer,
                    hs_error *err);

/* HS_ERR_USAGE: it is no such socket. */
bool hs_console_check_reader(uint32_t reader, hs_error *err);
