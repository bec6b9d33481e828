/* SPDX-License-Identifier: MIT */
/* Wrong plugins: the library, its entry, its descriptors, and create. */
/* The header says that the entry is constant; here loading changes it. */
#define smartvis_plugin_entry constant_entry
#include "wrong_base.h"
#undef smartvis_plugin_entry

/* ---- loading and unloading */
void wrong_function_that_nobody_has(void);
int wrong_function_for_all(void);
static void spoil_entry(void);

__attribute__((constructor)) static void load(void) {
    if (WRONG_IS(crash_in_constructor)) wrong_crash();
    if (WRONG_IS(hang_in_constructor)) wrong_hang();
    if (WRONG_IS(slow_to_load)) (void)usleep(300000);
    if (WRONG_IS(exit_in_constructor)) exit(0);
#if WRONG_UNDEFINED
    wrong_function_that_nobody_has();
#endif
    spoil_entry();
}

__attribute__((destructor)) static void unload(void) {
    if (WRONG_IS(crash_in_destructor)) wrong_crash();
}

#if WRONG_EXTRA
SV_EXPORT int wrong_function_for_all(void) {
    return 42;
}
#endif

/* ---- descriptors */
static const sv_descriptor *descriptor_at(uint32_t index) {
    static sv_descriptor d;
    if (d.size == 0) d = wrong_descriptor;
    if (WRONG_IS(descriptor_missing)) return NULL;
    if (WRONG_IS(descriptor_short)) d.size = 24;
    if (WRONG_IS(no_host_carrier)) d.carriers = SV_BIT(SV_CARRIER_BUFFER);
    if (WRONG_IS(unknown_feature)) d.features |= 1u << 30;
    if (WRONG_IS(no_extension_list)) d.extensions = NULL;
    if (WRONG_IS(name_not_utf8)) d.name = "Wr\xff\xc0ng \x1b[31m";
    if (WRONG_IS(one_id_twice)) return index < 2 ? &d : NULL;
    if (WRONG_IS(count_endless) || WRONG_IS(descriptor_beyond_count)) return &d;
    return index == 0 ? &d : NULL;
}

static void change_descriptor(void) {
    sv_descriptor *d = (sv_descriptor *)(uintptr_t)descriptor_at(0);
    d->features = 0;
    d->name = "Something else";
}

/* ---- create */
static sv_status create(const sv_host *host, const char *id, const sv_plugin **out) {
    const sv_plugin *before = out ? *out : NULL;
    if (WRONG_IS(crash_in_create)) wrong_crash();
    if (WRONG_IS(hang_in_create)) wrong_hang();
    if (WRONG_IS(null_host_crashes)) (void)*(const volatile uint32_t *)&host->size;
    if (WRONG_IS(descriptor_changes)) change_descriptor();
    if (WRONG_IS(takes_any_id) && id) id = wrong_descriptor.id;
    if (WRONG_IS(no_instance) && out) {
        *out = NULL;
        return SV_OK;
    }
    const sv_status status = sva_create(&wrong_method, host, id, out);
    if (WRONG_IS(out_left_behind) && status < 0 && out) *out = before;
    if (status != SV_OK) return status;
    sv_plugin *api = &wrong_self(*out)->api;
    api->descriptor = descriptor_at(0);
    if (WRONG_IS(short_instance)) api->size = 8;
    if (WRONG_IS(null_function)) api->adjust = NULL;
    return SV_OK;
}

/* ---- entry */
#if WRONG_HIDDEN
#define smartvis_plugin_entry smartvis_plugin_entry_of_another_name
#endif
extern SV_EXPORT sv_entry smartvis_plugin_entry;
SV_EXPORT sv_entry smartvis_plugin_entry = {SV_ABI_MAJOR,  SV_ABI_MINOR, (uint32_t)sizeof(sv_entry), 1,
                                            descriptor_at, create};

static void spoil_entry(void) {
    if (WRONG_IS(other_major)) smartvis_plugin_entry.abi_major++;
    if (WRONG_IS(short_entry)) smartvis_plugin_entry.size = 16;
    if (WRONG_IS(count_zero)) smartvis_plugin_entry.count = 0;
    if (WRONG_IS(count_endless)) smartvis_plugin_entry.count = UINT32_MAX;
    if (WRONG_IS(one_id_twice)) smartvis_plugin_entry.count = 2;
    if (WRONG_IS(no_create)) smartvis_plugin_entry.create = NULL;
}
