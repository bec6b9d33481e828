/* SPDX-License-Identifier: MIT */
/* Checks of the library as a file: loading, symbols, entry, descriptors. */
#include "validate/checks/check.h"

#include "base/progress.h"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PLUGINS = 4096, MOST_EXTENSIONS = 256, MOST_TEXT = 1000 };
#define SCAN_SECONDS 0.1

static void *load(v_run *run) {
    v_where(run, "dlopen");
    void *library = dlopen(run->path, RTLD_NOW | RTLD_LOCAL);
    V_EXPECT(run, library, "dlopen: %s", dlerror());
    return library;
}

void check_library_loads(v_run *run) {
    (void)load(run);
}

void check_library_reloads(v_run *run) {
    for (int i = 0; i < 3; i++) {
        void *library = load(run);
        v_where(run, "dlclose");
        V_EXPECT(run, dlclose(library) == 0, "dlclose: %s", dlerror());
    }
    for (int i = 0; i < 3; i++) {
        v_subject s;
        v_open(run, &s);
        v_close(&s);
    }
}

/* ---- symbols */
typedef struct {
    const ElfW(Sym) * symbols;
    const char *names;
    const uint32_t *hash;
} tables;

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

/* Also what AddressSanitizer adds beside every variable. */
static bool is_toolchains_own(const char *name) {
    static const char *const own[] = {"_init", "_fini", "_end", "_edata", "__bss_start"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(name, own[i]) == 0) return true;
    return strncmp(name, "__odr_asan", strlen("__odr_asan")) == 0;
}

static void inspect_symbol(v_run *run, const tables *t, uint32_t i) {
    const ElfW(Sym) *symbol = &t->symbols[i];
    const char *name = t->names + symbol->st_name;
    const unsigned binding = symbol->st_info >> 4u;
    if (symbol->st_shndx == SHN_UNDEF || is_toolchains_own(name) || strcmp(name, SV_ENTRY_SYMBOL) == 0)
        return;
    if (binding == STB_WEAK)
        v_warn(run, "the library also exports the weak symbol %s", name);
    else if (binding != STB_LOCAL)
        v_fail(run, "the library also exports %s; its only symbol should be " SV_ENTRY_SYMBOL, name);
}

void check_library_symbols(v_run *run) {
    struct link_map *map = NULL;
    tables t = {0};
    void *library = load(run);
    V_EXPECT(run, dlsym(library, SV_ENTRY_SYMBOL), "the library exports no symbol " SV_ENTRY_SYMBOL);
    V_EXPECT(run, dlinfo(library, RTLD_DI_LINKMAP, &map) == 0, "dlinfo: %s", dlerror());
    for (const ElfW(Dyn) *d = map->l_ld; d->d_tag != DT_NULL; d++) {
        if (d->d_tag == DT_SYMTAB) t.symbols = (const ElfW(Sym) *)d->d_un.d_ptr;
        if (d->d_tag == DT_STRTAB) t.names = (const char *)d->d_un.d_ptr;
        if (d->d_tag == DT_GNU_HASH) t.hash = (const uint32_t *)d->d_un.d_ptr;
    }
    if (!t.symbols || !t.names || !t.hash) v_skip(run, "the library has no GNU hash table of symbols");
    const uint32_t end = symbol_end(&t);
    for (uint32_t i = t.hash[1]; i < end; i++) inspect_symbol(run, &t, i);
}

void check_library_scan_time(v_run *run) {
    v_subject s;
    const double start = hs_now();
    v_load(run, &s);
    for (uint32_t i = 0; i < s.entry->count && i < MOST_PLUGINS; i++) (void)s.entry->descriptor(i);
    const double took = hs_now() - start;
    if (took > SCAN_SECONDS)
        v_warn(run, "loading the library and reading its descriptors took %.0f ms", took * 1e3);
}

/* ---- entry and descriptors */
void check_entry_whole(v_run *run) {
    const sv_entry *e = dlsym(load(run), SV_ENTRY_SYMBOL);
    V_EXPECT(run, e, "the library exports no symbol " SV_ENTRY_SYMBOL);
    V_EXPECT(run, e->abi_major == SV_ABI_MAJOR, "entry.abi_major is %u, expected %u", e->abi_major,
             SV_ABI_MAJOR);
    V_EXPECT(run, e->size >= sizeof *e, "entry.size is %u, expected at least %zu", e->size, sizeof *e);
    V_EXPECT(run, e->count >= 1 && e->count <= MOST_PLUGINS, "entry.count is %u, expected 1 to %d", e->count,
             MOST_PLUGINS);
    V_EXPECT(run, e->descriptor && e->create, "entry.%s is NULL", e->descriptor ? "create" : "descriptor");
}

static void inspect_texts(v_run *run, uint32_t index, const sv_descriptor *d) {
    const struct {
        const char *field, *text;
    } list[] = {{"id", d->id},
                {"name", d->name},
                {"vendor", d->vendor},
                {"version", d->version},
                {"summary", d->summary}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        V_EXPECT(run, list[i].text, "descriptor %u: %s is NULL", index, list[i].field);
        V_EXPECT(run, v_is_text(list[i].text, MOST_TEXT),
                 "descriptor %u: %s is not UTF-8 text of at most %d bytes without control characters", index,
                 list[i].field, MOST_TEXT);
        V_EXPECT(run, i > 1 || list[i].text[0], "descriptor %u: %s is empty", index, list[i].field);
    }
}

static void inspect_bits(v_run *run, uint32_t index, const sv_descriptor *d) {
    const struct {
        const char *field;
        uint32_t value, known, needed;
    } list[] = {{"carriers", d->carriers,
                 SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) | SV_BIT(SV_CARRIER_IMAGE),
                 SV_BIT(SV_CARRIER_HOST)},
                {"voxel_types", d->voxel_types, SV_BIT(SV_VOXEL_U8) | SV_BIT(SV_VOXEL_U16), 0},
                {"queues", d->queues, SV_QUEUE_OWN | SV_QUEUE_HOST, 0},
                {"features", d->features, SV_FEATURE_SCANNED | SV_FEATURE_PADDING | SV_FEATURE_ADJUST, 0},
                {"reserved", d->reserved, 0, 0}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        V_EXPECT(run, (list[i].value & ~list[i].known) == 0, "descriptor %u: %s is 0x%x, only 0x%x is known",
                 index, list[i].field, list[i].value, list[i].known);
        V_EXPECT(run, (list[i].value & list[i].needed) == list[i].needed,
                 "descriptor %u: %s is 0x%x, expected it to hold 0x%x", index, list[i].field, list[i].value,
                 list[i].needed);
    }
    V_EXPECT(run, d->voxel_types && d->queues, "descriptor %u: %s is 0: nobody can use the plugin", index,
             d->queues ? "voxel_types" : "queues");
    V_EXPECT(run, d->queues & SV_QUEUE_HOST || d->carriers == SV_BIT(SV_CARRIER_HOST),
             "descriptor %u: carriers is 0x%x, but OpenCL objects need SV_QUEUE_HOST", index, d->carriers);
}

static void inspect_extensions(v_run *run, uint32_t index, const sv_descriptor *d) {
    V_EXPECT(run, d->extensions, "descriptor %u: extensions is NULL", index);
    for (uint32_t i = 0; d->extensions[i]; i++) {
        V_EXPECT(run, i < MOST_EXTENSIONS, "descriptor %u: extensions has no NULL among its first %d entries",
                 index, MOST_EXTENSIONS);
        V_EXPECT(run, v_is_text(d->extensions[i], MOST_TEXT) && strchr(d->extensions[i], '/'),
                 "descriptor %u: extension %u is not of the form name/revision", index, i);
    }
}

void check_descriptors(v_run *run) {
    v_subject s;
    v_load(run, &s);
    v_where(run, "descriptor");
    for (uint32_t i = 0; i < s.entry->count && i < MOST_PLUGINS; i++) {
        const sv_descriptor *d = s.entry->descriptor(i);
        V_EXPECT(run, d, "descriptor(%u) is NULL, and entry.count is %u", i, s.entry->count);
        V_EXPECT(run, d->size >= sizeof *d, "descriptor %u: size is %u, expected at least %zu", i, d->size,
                 sizeof *d);
        inspect_texts(run, i, d);
        inspect_bits(run, i, d);
        inspect_extensions(run, i, d);
        for (uint32_t k = 0; k < i; k++)
            V_EXPECT(run, strcmp(s.entry->descriptor(k)->id, d->id) != 0,
                     "descriptors %u and %u have one id, %s", k, i, d->id);
    }
    V_EXPECT(run, !s.entry->descriptor(s.entry->count) && !s.entry->descriptor(UINT32_MAX),
             "descriptor(%u) is not NULL, and entry.count is %u", s.entry->count, s.entry->count);
    if (s.entry->count > 1 && !run->id)
        v_warn(run, "the library holds %u plugins; the other checks try %s, --id tries another",
               s.entry->count, s.entry->descriptor(0)->id);
}

/* ---- constant */
static void copy_text(const sv_descriptor *d, sv_descriptor *fields, char text[5][MOST_TEXT + 1]) {
    const char *const list[5] = {d->id, d->name, d->vendor, d->version, d->summary};
    *fields = *d;
    for (int i = 0; i < 5; i++) strncpy(text[i], list[i], MOST_TEXT);
}

void check_descriptor_constant(v_run *run) {
    static char before[5][MOST_TEXT + 1], after[5][MOST_TEXT + 1];
    sv_descriptor first, later;
    v_subject s;
    v_load(run, &s);
    const sv_descriptor *d = s.entry->descriptor(0);
    copy_text(d, &first, before);
    v_rig r;
    v_rig_open(run, &r);
    V_EXPECT(run, s.entry->descriptor(0) == d, "create changes where the descriptor lies");
    copy_text(d, &later, after);
    V_EXPECT(run, memcmp(&first, &later, sizeof first) == 0 && memcmp(before, after, sizeof before) == 0,
             "create changes the descriptor");
    V_EXPECT(run, strcmp(r.s.plugin->descriptor->id, r.s.descriptor->id) == 0,
             "the instance's descriptor has the id %s, expected %s", r.s.plugin->descriptor->id,
             r.s.descriptor->id);
    v_rig_close(&r);
    copy_text(d, &later, after);
    V_EXPECT(run, memcmp(&first, &later, sizeof first) == 0 && memcmp(before, after, sizeof before) == 0,
             "destroy changes the descriptor");
}
