/* SPDX-License-Identifier: MIT */
/* The addresses at which a loaded library lies. */
#ifndef SV_LIBRARY_RANGE_H
#define SV_LIBRARY_RANGE_H

#include <link.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uintptr_t start, end; /* both 0: none */
} library_range;

typedef struct {
    uintptr_t address;
    library_range found;
} library_search;

static inline int library_look(struct dl_phdr_info *info, size_t size, void *data) {
    (void)size;
    library_search *s = data;
    library_range range = {UINTPTR_MAX, 0};
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *h = &info->dlpi_phdr[i];
        if (h->p_type != PT_LOAD) continue;
        const uintptr_t start = info->dlpi_addr + h->p_vaddr, end = start + h->p_memsz;
        if (start < range.start) range.start = start;
        if (end > range.end) range.end = end;
    }
    if (s->address < range.start || s->address >= range.end) return 0;
    s->found = range;
    return 1;
}

/* The range of the program or library that holds this address. */
static inline library_range library_range_of(const void *address) {
    library_search s = {.address = (uintptr_t)address};
    (void)dl_iterate_phdr(library_look, &s);
    return s.found;
}

static inline bool library_range_holds(library_range range, const void *address) {
    return (uintptr_t)address >= range.start && (uintptr_t)address < range.end;
}

#endif
