/* SPDX-License-Identifier: MIT */
/*
 * A helper for hosts, header-only and optional: loads a library of plugins and finds its entry, by dlopen or,
 * on Windows, by LoadLibrary. Where the C library lacks dlopen, the program links libdl.
 */
#ifndef SMARTVIS_OPEN_H
#define SMARTVIS_OPEN_H

#include "smartvis_plugin.h"

#include <stdio.h>
#include <string.h>

#if defined(_WIN32)
#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
/* Words of 16-bit days, which a program about depths wants for itself. */
#undef near
#undef far
#else
#include <dlfcn.h>
#endif

SMARTVIS_BEGIN_C

/* Gives a library back that sv_open loaded. No instance of it may live. */
static inline void sv_close(void *library) {
#if defined(_WIN32)
    (void)FreeLibrary((HMODULE)library);
#else
    (void)dlclose(library);
#endif
}

/*
 * Loads the library at `path`, whose constructors run, and finds its entry. The path is UTF-8; on Windows
 * what is not is text of the code page, as argv is. *library gets what sv_close takes; NULL: the library
 * stays loaded. A path without a folder is looked up where the system looks for libraries. The host reads
 * abi_major before all else. On failure NULL: nothing stays loaded, and the reason stands in `why`, of
 * `bytes` bytes.
 */
static inline const sv_entry *sv_open(const char *path, void **library, char *why, size_t bytes) {
    const sv_entry *entry = NULL;
#if defined(_WIN32)
    wchar_t wide[4096];
    int count = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, 4096);
    if (count == 0) count = MultiByteToWideChar(CP_ACP, 0, path, -1, wide, 4096);
    void *loaded = count > 0 ? (void *)LoadLibraryW(wide) : NULL;
    if (loaded) {
        const FARPROC found = GetProcAddress((HMODULE)loaded, SV_ENTRY_SYMBOL);
        memcpy(&entry, &found, sizeof entry); /* an object's address, told as a function's */
    }
    const unsigned long reason = loaded ? 0 : GetLastError();
    if (!loaded)
        (void)snprintf(why, bytes, "%s: Windows' error %lu%s", path, reason,
                       reason == ERROR_MOD_NOT_FOUND    ? ": it is not there, or a library that it needs"
                       : reason == ERROR_BAD_EXE_FORMAT ? ": it is no library for this processor"
                                                        : "");
#else
    void *loaded = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (loaded) entry = (const sv_entry *)dlsym(loaded, SV_ENTRY_SYMBOL);
    if (!loaded) (void)snprintf(why, bytes, "%s", dlerror());
#endif
    if (!entry && loaded) (void)snprintf(why, bytes, "%.200s: no symbol " SV_ENTRY_SYMBOL, path);
    if (!entry && loaded) sv_close(loaded);
    if (library) *library = entry ? loaded : NULL;
    return entry;
}

SMARTVIS_END_C

#endif
