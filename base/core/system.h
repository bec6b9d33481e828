/* SPDX-License-Identifier: MIT */
/* What differs between systems, for all that stands above. Paths are UTF-8, with '/' or what the system takes
 * besides. On failure errno says why. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Bytes of the longest path, with its end. */
#define SYS_PATH 4096

/* The ending of a library's name: ".so". */
extern const char sys_library_ending[];

typedef enum {
    SYS_READ,
    SYS_NEW,  /* an empty one, to be written and read, that only its owner may read */
    SYS_MORE, /* one that is there, to be written and read */
    SYS_FIRST /* one that is not there yet (EEXIST), to be written, for whom the user's settings say */
} sys_way;

/* What parts the folders of a path: "/". */
extern const char sys_separators[];

/* Opens a regular file: a descriptor that no child inherits, for read, write, lseek, ftruncate and close, in
 * binary; -1. EINVAL: it is no regular file, such as a pipe, which would be waited for. */
int sys_open(const char *path, sys_way way);

bool sys_is_file(const char *path);

bool sys_is_folder(const char *path);
bool sys_is_there(const char *path);

/* True for a folder that is there, too. */
bool sys_make_folder(const char *path);

/* Removes a file, also an open one. */
bool sys_remove(const char *path);

/* True if what was opened lies in the folder or below, whatever links are on the way. */
bool sys_is_below(int file, const char *folder);

/* pread: any number of threads at a time. */
ptrdiff_t sys_read_at(int file, void *out, size_t bytes, uint64_t at);

/* True if both are there and are one file. */
bool sys_same_file(const char *a, const char *b);

/* Renames a file that is not open, over another one if there is one, also over an open one. */
bool sys_replace(const char *from, const char *to);

bool sys_is_absolute(const char *path);

/* The whole path of a file that is there, without links; the caller's to free. NULL. */
char *sys_full_path(const char *path);

/* Where plugins are looked for, after the folders that the user names. NULL ends them. */
extern const char *const sys_plugin_folders[];

/* What parts the paths of a list: ':'. */
extern const char sys_list_separator[];

/* The program's own path; false where it cannot be told. */
bool sys_program(char *path, size_t bytes);

/* argv as UTF-8, with '/' in paths, with its count, as long as the program runs. Once, at the program's
 * start: its output is binary from then on, and where descriptors 0 to 2 were closed, as daemons have them,
 * nothing that is opened later becomes one of them. Threads get stacks that compiling kernels takes; where
 * the main one may not have 512 KiB, the program ends with a sentence and HS_ERR_MEMORY. As the first process
 * of a container, which no signal but SIGKILL ends by default, it ends at those that end others. */
char **sys_arguments(int *count, char **argv);

/* The folder of the program or library that `inside` lies in, with a '/' at its end; "" where it cannot be
 * told. */
void sys_own_folder(const void *inside, char *folder, size_t bytes);

/* Gives back, while this library is unloaded, one that it holds (smartvis/open.h), where the system allows
 * that. */
void sys_close_when_unloaded(void *library);

/* Whole pages of memory, zeroed; NULL. Pages that are forbidden end who touches them. */
void *sys_pages(size_t bytes);
void sys_pages_forbid(void *at, size_t bytes);
void sys_pages_free(void *at, size_t bytes);

/* A file of no name, which is gone when it is closed: its descriptor; -1. */
int sys_temporary(void);

/* A variable's value as UTF-8; false, and "", if it is not set or longer. */
bool sys_environment(const char *name, char *value, size_t bytes);

/* Sets a variable, unless it is set. */
void sys_set_default(const char *name, const char *value);

/* From now on a fault ends the program at once: nobody debugs it, and no memory is written to a file. */
void sys_end_at_fault(void);

/* Before Ctrl-C or the system's request ends the program, unless it is ignored or somebody else wants it,
 * `clean_up` removes files: on any thread, amid anything. */
void sys_when_ended(void (*clean_up)(void));

/* From now on, should somebody else end this program (exit, abort, a fault), `words` go to standard error
 * before it ends, and exit's code becomes `code`. NULL: no longer. They must stay. For programs alone. */
void sys_last_words(const char *words, int code);

unsigned sys_processors(void);

/* NULL: no memory. */
void *sys_aligned(size_t alignment, size_t bytes);
void sys_aligned_free(void *memory);

/* Closes all but standard input, output and error, where the system has files that a caller left open by
 * mistake. */
void sys_close_others(void);

/* Memory that children share, as a handle that is passed on (guard/child.h); -1. Its size stays; 0: as
 * sys_shared_resize says. What is never used takes none. */
intptr_t sys_shared_new(size_t bytes);
bool sys_shared_resize(intptr_t shared, size_t bytes);
void sys_shared_close(intptr_t shared);

/* A handle of the same memory that can only be mapped for reading. */
intptr_t sys_shared_reader(intptr_t shared);

/* NULL: there is no such memory, or not as much. sys_shared_use comes before the first access to a part of
 * it, in every process; false: no memory. */
void *sys_shared_map(intptr_t shared, size_t bytes, bool writes);
bool sys_shared_use(void *at, size_t bytes, bool writes);
void sys_shared_unmap(void *at, size_t bytes);

#endif
