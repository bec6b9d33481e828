/* SPDX-License-Identifier: MIT */
#include "validate/spy/library_range.h"

#include <link.h>

typedef struct {
    uintptr_t address;
    library_range found;
} search;

static int look(struct dl_phdr_info *info, size_t size, void *data) {
    (void)size;
    search *s = data;
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

library_range library_range_of(const void *address) {
    search s = {.address = (uintptr_t)address};
    (void)dl_iterate_phdr(look, &s);
    return s.found;
}
