/* SPDX-License-Identifier: MIT */
/* What differs between systems, for all that stands above. Paths are UTF-8, with '/' or what the system takes
 * besides. On failure errno says why. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes of the longest path, with its end. */
#define SYS_PATH 4096

/* The ending of a library's name: ".so". */
extern const char sys_library_ending[];

typedef enum {
    SYS_READ,
    SYS_NEW,  /* an empty one, to be written and read, that only its owner may read */
    SYS_MORE, /* one that is there, to be written and read */
} sys_way;

/* Opens a regular file: a descriptor that no child inherits, for read, write, lseek, ftruncate and close, in
 * binary; -1. EINVAL: it is no regular file, such as a pipe, which would be waited for. */
int sys_open(const char *path, sys_way way);

bool sys_is_file(const char *path);

/* True if both are there and are one file. */
bool sys_same_file(const char *a, const char *b);

/* Renames a file that is not open, over another one if there is one. */
bool sys_replace(const char *from, const char *to);

bool sys_is_absolute(const char *path);

/* The whole path of a file that is there, without links; the caller's to free. NULL. */
char *sys_full_path(const char *path);

/* What parts the paths of a list: ':'. */
extern const char sys_list_separator[];

/* The program's own path; false where it cannot be told. */
bool sys_program(char *path, size_t bytes);

/* argv as UTF-8, with its count, as long as the program runs. */
char **sys_arguments(int *count, char **argv);

/* The folder of the program or library that `inside` lies in, with a '/' at its end; "" where it cannot be
 * told. */
void sys_own_folder(const void *inside, char *folder, size_t bytes);

/* Gives back, while this library is unloaded, one that it holds (smartvis/open.h), where the system allows
 * that. */
void sys_close_when_unloaded(void *library);

#endif
