/* SPDX-License-Identifier: MIT */
/* What of libraries only the system tells, by library_elf.c and library_pe.c. */
#ifndef SV_LIBRARY_H
#define SV_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* With these bytes a library's file begins. */
extern const char library_magic[];

/* NULL, and why. Its constructors run. */
void *library_load(const char *path, char *why, size_t bytes);
void *library_find(void *library, const char *name);
bool library_close(void *library);

/* Tells of every symbol that others can find in it. False: it has no table of them. */
bool library_exports(void *library, void (*tell)(void *context, const char *name, bool weak), void *context);

/* The addresses at which a loaded library lies. */
typedef struct {
    uintptr_t start, end; /* both 0: none */
} library_range;

/* The range of the program or library that holds this address. */
library_range library_range_of(const void *address);

static inline bool library_range_holds(library_range range, const void *address) {
    return (uintptr_t)address >= range.start && (uintptr_t)address < range.end;
}

/* From now on the OpenCL calls of the library that holds this address, and those of the heap, reach this
 * program's functions: clFinish, or malloc by the name instead_of_malloc. Nothing is to be done where a
 * program's names come first. */
void library_redirect(const void *address);

/* The function by this name that comes after this program's. */
void *library_next(const char *name);

/* First OpenCL function that the library imports and this program does not define, or NULL. */
const char *library_unknown_import(void *library);

/* True for the name of an OpenCL function. */
static inline bool library_is_opencl(const char *name) {
    return name[0] == 'c' && name[1] == 'l' && name[2] >= 'A' && name[2] <= 'Z';
}

#endif
