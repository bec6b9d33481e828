/* SPDX-License-Identifier: MIT */
/* Checks of the library as a file: loading, symbols, entry, descriptors. */
#include "validate/checks/check.h"

#include "core/progress.h"
#include "validate/spy/library.h"

#include <stdlib.h>

#define SCAN_SECONDS 0.1

static void *load(v_run *run) {
    char why[256];
    v_where(run, "loading");
    void *library = library_load(run->path, why, sizeof why);
    V_EXPECT(run, library, "%s", why);
    return library;
}

void check_library_loads(v_run *run) {
    (void)load(run);
}

void check_library_reloads(v_run *run) {
    for (int i = 0; i < 3; i++) {
        void *library = load(run);
        v_where(run, "unloading");
        V_EXPECT(run, library_close(library), "the library cannot be unloaded");
    }
    for (int i = 0; i < 3; i++) {
        v_subject s;
        v_open(run, &s);
        v_close(&s);
    }
}

/* ---- symbols */
/* Also what AddressSanitizer adds beside every variable. */
static bool is_toolchains_own(const char *name) {
    static const char *const own[] = {"_init", "_fini", "_end", "_edata", "__bss_start"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(name, own[i]) == 0) return true;
    return strncmp(name, "__odr_asan", strlen("__odr_asan")) == 0;
}

static void inspect_symbol(void *context, const char *name, bool weak) {
    v_run *run = context;
    if (is_toolchains_own(name) || strcmp(name, SV_ENTRY_SYMBOL) == 0) return;
    if (weak)
        v_warn(run, "the library also exports the weak symbol %s", name);
    else
        v_fail(run, "the library also exports %s; its only symbol should be " SV_ENTRY_SYMBOL, name);
}

void check_library_symbols(v_run *run) {
    void *library = load(run);
    V_EXPECT(run, library_find(library, SV_ENTRY_SYMBOL), "the library exports no symbol " SV_ENTRY_SYMBOL);
    if (!library_exports(library, inspect_symbol, run))
        v_skip(run, "the library has no GNU hash table of symbols");
}

void check_library_scan_time(v_run *run) {
    v_subject s;
    const double start = hs_now();
    v_load(run, &s);
    for (uint32_t i = 0; i < s.entry->count; i++) (void)s.entry->descriptor(i);
    const double took = hs_now() - start;
    if (took > SCAN_SECONDS)
        v_warn(run, "loading the library and reading its descriptors took %.0f ms", took * 1e3);
}

/* ---- entry and descriptors */
void check_entry_whole(v_run *run) {
    const rule_sink to = v_sink(run);
    const sv_entry *e = library_find(load(run), SV_ENTRY_SYMBOL);
    V_EXPECT(run, e, "the library exports no symbol " SV_ENTRY_SYMBOL);
    rule_entry(&to, e);
}

void check_descriptors(v_run *run) {
    const rule_sink to = v_sink(run);
    v_subject s;
    v_load(run, &s);
    v_where(run, "descriptor");
    rule_descriptors(&to, s.entry);
    if (s.entry->count > 1 && !run->id)
        v_warn(run, "the library holds %u plugins; the other checks try %s, --id tries another",
               s.entry->count, s.entry->descriptor(0)->id);
}

/* ---- constant */
static void copy_text(const sv_descriptor *d, sv_descriptor *fields, char text[5][RULE_MAX_TEXT + 1]) {
    const char *const list[5] = {d->id, d->name, d->vendor, d->version, d->summary};
    *fields = *d;
    for (int i = 0; i < 5; i++) strncpy(text[i], list[i], RULE_MAX_TEXT);
}

void check_descriptor_constant(v_run *run) {
    static char before[5][RULE_MAX_TEXT + 1], after[5][RULE_MAX_TEXT + 1];
    sv_descriptor first, later;
    v_subject s;
    v_load(run, &s);
    const sv_descriptor *d = s.entry->descriptor(0);
    copy_text(d, &first, before);
    v_rig *r = v_rig_open(run);
    V_EXPECT(run, s.entry->descriptor(0) == d, "create changes where the descriptor lies");
    copy_text(d, &later, after);
    V_EXPECT(run, memcmp(&first, &later, sizeof first) == 0 && memcmp(before, after, sizeof before) == 0,
             "create changes the descriptor");
    V_EXPECT(run, strcmp(r->s.plugin->descriptor->id, r->s.descriptor->id) == 0,
             "the instance's descriptor has the id %s, expected %s", r->s.plugin->descriptor->id,
             r->s.descriptor->id);
    v_rig_close(r);
    copy_text(d, &later, after);
    V_EXPECT(run, memcmp(&first, &later, sizeof first) == 0 && memcmp(before, after, sizeof before) == 0,
             "destroy changes the descriptor");
}
