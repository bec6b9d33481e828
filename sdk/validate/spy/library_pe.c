/* SPDX-License-Identifier: MIT */
#include "validate/spy/library.h"

#include <stdio.h>
#include <string.h>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

const char library_magic[] = "MZ";

void *library_load(const char *path, char *why, size_t bytes) {
    wchar_t wide[4096];
    const int count = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, 4096);
    void *library = count > 0 ? (void *)LoadLibraryW(wide) : NULL;
    if (!library) (void)snprintf(why, bytes, "LoadLibrary: error %lu", GetLastError());
    return library;
}

static void *as_object(FARPROC function) {
    void *object;
    memcpy(&object, &function, sizeof object);
    return object;
}

void *library_find(void *library, const char *name) {
    return as_object(GetProcAddress((HMODULE)library, name));
}

bool library_close(void *library) {
    return FreeLibrary((HMODULE)library);
}

/* ---- its headers */
static const IMAGE_OPTIONAL_HEADER64 *header_of(const uint8_t *base) {
    const IMAGE_DOS_HEADER *dos = (const void *)base;
    const IMAGE_NT_HEADERS64 *nt = (const void *)(base + dos->e_lfanew);
    return &nt->OptionalHeader;
}

/* One of its tables; NULL: it has none. */
static const void *table_of(const uint8_t *base, unsigned which) {
    const DWORD at = header_of(base)->DataDirectory[which].VirtualAddress;
    return at ? base + at : NULL;
}

bool library_exports(void *library, void (*tell)(void *context, const char *name, bool weak), void *context) {
    const uint8_t *base = library;
    const IMAGE_EXPORT_DIRECTORY *exports = table_of(base, IMAGE_DIRECTORY_ENTRY_EXPORT);
    if (!exports) return false;
    const DWORD *names = (const void *)(base + exports->AddressOfNames);
    for (DWORD i = 0; i < exports->NumberOfNames; i++) tell(context, (const char *)base + names[i], false);
    return true;
}

static HMODULE module_of(const void *address) {
    const DWORD from = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    HMODULE module = NULL;
    (void)GetModuleHandleExW(from, address, &module);
    return module;
}

library_range library_range_of(const void *address) {
    const uint8_t *base = (const void *)module_of(address);
    const uintptr_t start = (uintptr_t)base;
    return base ? (library_range){start, start + header_of(base)->SizeOfImage} : (library_range){0, 0};
}

/* ---- whom it calls */
static HMODULE runtime; /* the C library whose heap the redirected library uses */

/* The program's function that stands in for this one, which sv_validate exports. */
static void *own(const char *name) {
    char instead[24];
    (void)snprintf(instead, sizeof instead, "instead_of_%s", name);
    return library_find((void *)GetModuleHandleW(NULL), library_is_opencl(name) ? name : instead);
}

/* Calls `each` for every function that it imports by name, and where its address stands. */
static void every_import(const uint8_t *base, void (*each)(void *context, const char *name, void **at),
                         void *context) {
    const IMAGE_IMPORT_DESCRIPTOR *from = table_of(base, IMAGE_DIRECTORY_ENTRY_IMPORT);
    for (; from && from->Name; from++) {
        const IMAGE_THUNK_DATA64 *name = (const void *)(base + from->OriginalFirstThunk);
        void **at = (void **)(uintptr_t)(base + from->FirstThunk);
        for (; name->u1.AddressOfData; name++, at++) {
            const IMAGE_IMPORT_BY_NAME *named = (const void *)(base + name->u1.AddressOfData);
            if (!IMAGE_SNAP_BY_ORDINAL64(name->u1.Ordinal)) each(context, (const char *)named->Name, at);
        }
    }
}

static void redirect(void *context, const char *name, void **at) {
    void *to = own(name);
    DWORD before;
    (void)context;
    if (!to || *at == to || !VirtualProtect(at, sizeof *at, PAGE_READWRITE, &before)) return;
    if (!library_is_opencl(name)) runtime = module_of(*at);
    *at = to;
    (void)VirtualProtect(at, sizeof *at, before, &before);
}

void library_redirect(const void *address) {
    const HMODULE module = module_of(address);
    if (module) every_import((const void *)module, redirect, NULL);
}

void *library_next(const char *name) {
    return as_object(GetProcAddress(library_is_opencl(name) ? LoadLibraryW(L"OpenCL.dll") : runtime, name));
}

static void find_unknown(void *context, const char *name, void **at) {
    const char **unknown = context;
    (void)at;
    if (library_is_opencl(name) && !*unknown && !own(name)) *unknown = name;
}

const char *library_unknown_import(void *library) {
    const char *unknown = NULL;
    every_import(library, find_unknown, (void *)&unknown);
    return unknown;
}
