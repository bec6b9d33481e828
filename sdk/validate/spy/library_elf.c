/* SPDX-License-Identifier: MIT */
#include "validate/spy/library.h"

#include <dlfcn.h>
#include <link.h>
#include <stdio.h>

const char library_magic[] = "\x7f"
                             "ELF";

void *library_load(const char *path, char *why, size_t bytes) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) (void)snprintf(why, bytes, "dlopen: %s", dlerror());
    return library;
}

void *library_find(void *library, const char *name) {
    return dlsym(library, name);
}

bool library_close(void *library) {
    return dlclose(library) == 0;
}

/* ---- symbols */
typedef struct {
    const ElfW(Sym) * symbols;
    const char *names;
    const uint32_t *hash; /* GNU's; hash[1] is the first symbol that is not an import */
} tables;

static bool find_tables(void *library, tables *t) {
    struct link_map *map = NULL;
    *t = (tables){0};
    if (dlinfo(library, RTLD_DI_LINKMAP, &map) != 0) return false;
    for (const ElfW(Dyn) *d = map->l_ld; d->d_tag != DT_NULL; d++) {
        if (d->d_tag == DT_SYMTAB) t->symbols = (const ElfW(Sym) *)d->d_un.d_ptr;
        if (d->d_tag == DT_STRTAB) t->names = (const char *)d->d_un.d_ptr;
        if (d->d_tag == DT_GNU_HASH) t->hash = (const uint32_t *)d->d_un.d_ptr;
    }
    return t->symbols && t->names && t->hash;
}

/* One more than the last symbol that others can find: GNU's hash table ends every chain by an odd value. */
static uint32_t symbol_end(const tables *t) {
    const uint32_t buckets = t->hash[0], first = t->hash[1], words = t->hash[2];
    const uint32_t *bucket = t->hash + 4 + words * (sizeof(ElfW(Addr)) / sizeof(uint32_t));
    const uint32_t *chain = bucket + buckets;
    uint32_t last = 0;
    for (uint32_t i = 0; i < buckets; i++)
        if (bucket[i] > last) last = bucket[i];
    if (last < first) return first;
    while (!(chain[last - first] & 1u)) last++;
    return last + 1;
}

bool library_exports(void *library, void (*tell)(void *context, const char *name, bool weak), void *context) {
    tables t;
    if (!find_tables(library, &t)) return false;
    const uint32_t end = symbol_end(&t);
    for (uint32_t i = t.hash[1]; i < end; i++) {
        const unsigned binding = t.symbols[i].st_info >> 4u;
        if (t.symbols[i].st_shndx != SHN_UNDEF && binding != STB_LOCAL)
            tell(context, t.names + t.symbols[i].st_name, binding == STB_WEAK);
    }
    return true;
}

/* ---- where it lies */
typedef struct {
    uintptr_t address;
    library_range found;
} library_search;

static int look(struct dl_phdr_info *info, size_t size, void *data) {
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

library_range library_range_of(const void *address) {
    library_search s = {.address = (uintptr_t)address};
    (void)dl_iterate_phdr(look, &s);
    return s.found;
}

/* ---- whom it calls */
void library_redirect(const void *address) {
    (void)address;
}

void *library_next(const char *name) {
    return dlsym(RTLD_NEXT, name);
}

const char *library_unknown_import(void *library) {
    tables t;
    const char *unknown = NULL;
    if (!find_tables(library, &t)) return "(no symbol table)";
    void *self = dlopen(NULL, RTLD_NOW);
    const library_range own = library_range_of((const void *)(uintptr_t)&library_unknown_import);
    for (uint32_t i = 1; i < t.hash[1] && !unknown; i++) {
        const char *name = t.names + t.symbols[i].st_name;
        if (library_is_opencl(name) && self && !library_range_holds(own, dlsym(self, name))) unknown = name;
    }
    if (self) (void)dlclose(self);
    return unknown;
}
