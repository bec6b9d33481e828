/* SPDX-License-Identifier: MIT */
#include "base/system.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <sddl.h>
#include <shellapi.h>

const char sys_library_ending[] = ".dll", sys_list_separator[] = ";";

/* False: not UTF-8, or too long. */
static bool widen(const char *path, wchar_t wide[SYS_PATH]) {
    if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, SYS_PATH) > 0) return true;
    errno = EILSEQ;
    return false;
}

static bool fail(void) {
    const DWORD error = GetLastError();
    errno = error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND ? ENOENT
            : error == ERROR_DISK_FULL                                     ? ENOSPC
            : error == ERROR_INVALID_NAME                                  ? EINVAL
                                                                           : EACCES;
    return false;
}

/* What is no file on a disk, such as CON or a pipe, is not opened. */
static int open_file(const wchar_t *path, DWORD access, DWORD creation, SECURITY_ATTRIBUTES *owner) {
    const HANDLE handle = CreateFileW(path, access, FILE_SHARE_READ | FILE_SHARE_WRITE, owner, creation,
                                      FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE) return fail() - 1;
    const int file = GetFileType(handle) == FILE_TYPE_DISK
                         ? _open_osfhandle((intptr_t)handle, O_BINARY | O_NOINHERIT)
                         : -1;
    if (file >= 0) return file;
    (void)CloseHandle(handle);
    errno = EINVAL;
    return -1;
}

int sys_open(const char *path, sys_way way) {
    wchar_t wide[SYS_PATH];
    SECURITY_ATTRIBUTES owner = {.nLength = sizeof owner};
    if (!widen(path, wide)) return -1;
    if (way == SYS_READ) return open_file(wide, GENERIC_READ, OPEN_EXISTING, NULL);
    if (way == SYS_MORE) return open_file(wide, GENERIC_READ | GENERIC_WRITE, OPEN_EXISTING, NULL);
    /* For the owner alone: nothing is inherited from the folder. */
    if (!ConvertStringSecurityDescriptorToSecurityDescriptorW(L"D:P(A;;FA;;;OW)", SDDL_REVISION_1,
                                                              &owner.lpSecurityDescriptor, NULL))
        return fail() - 1;
    const int file = open_file(wide, GENERIC_READ | GENERIC_WRITE, CREATE_ALWAYS, &owner);
    (void)LocalFree(owner.lpSecurityDescriptor);
    return file;
}

bool sys_is_file(const char *path) {
    const int file = sys_open(path, SYS_READ);
    return file >= 0 && _close(file) == 0;
}

static bool file_facts(const char *path, BY_HANDLE_FILE_INFORMATION *facts) {
    const int file = sys_open(path, SYS_READ);
    const bool told = file >= 0 && GetFileInformationByHandle((HANDLE)_get_osfhandle(file), facts);
    if (file >= 0) (void)_close(file);
    return told;
}

bool sys_same_file(const char *a, const char *b) {
    BY_HANDLE_FILE_INFORMATION one, other;
    return file_facts(a, &one) && file_facts(b, &other) &&
           one.dwVolumeSerialNumber == other.dwVolumeSerialNumber &&
           one.nFileIndexHigh == other.nFileIndexHigh && one.nFileIndexLow == other.nFileIndexLow;
}

bool sys_replace(const char *from, const char *to) {
    wchar_t wide_from[SYS_PATH], wide_to[SYS_PATH];
    return widen(from, wide_from) && widen(to, wide_to) &&
           (MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING) || fail());
}

/* Also of the current drive: what begins with a separator belongs to no other folder. */
bool sys_is_absolute(const char *path) {
    return path[0] == '/' || path[0] == '\\' || (path[0] && path[1] == ':');
}

/* UTF-8, with '/'; the caller's to free. NULL: no memory. */
static char *narrow(const wchar_t *wide) {
    const int bytes = WideCharToMultiByte(CP_UTF8, 0, wide, -1, NULL, 0, NULL, NULL);
    char *text = bytes > 0 ? malloc((size_t)bytes) : NULL;
    if (text) (void)WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, bytes, NULL, NULL);
    return text;
}

static char *with_slashes(const wchar_t *wide) {
    char *path = narrow(wide);
    for (char *c = path; c && *c; c++)
        if (*c == '\\') *c = '/';
    return path;
}

char *sys_full_path(const char *path) {
    wchar_t wide[SYS_PATH], full[SYS_PATH];
    const DWORD length = widen(path, wide) ? GetFullPathNameW(wide, SYS_PATH, full, NULL) : 0;
    return length > 0 && length < SYS_PATH ? with_slashes(full) : NULL;
}

/* The path of a program or library of this process; NULL: of the program. */
static bool module_path(HMODULE module, char *path, size_t bytes) {
    wchar_t wide[SYS_PATH];
    const DWORD length = GetModuleFileNameW(module, wide, SYS_PATH);
    char *own = length > 0 && length < SYS_PATH ? with_slashes(wide) : NULL;
    (void)snprintf(path, bytes, "%s", own ? own : "");
    free(own);
    return path[0] != '\0';
}

bool sys_program(char *path, size_t bytes) {
    return module_path(NULL, path, bytes);
}

char **sys_arguments(int *count, char **argv) {
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), count);
    char **narrowed = wide ? calloc((size_t)*count + 1, sizeof *narrowed) : NULL;
    bool whole = narrowed != NULL;
    for (int i = 0; whole && i < *count; i++) whole = (narrowed[i] = narrow(wide[i])) != NULL;
    (void)LocalFree(wide);
    return whole ? narrowed : argv;
}

void sys_own_folder(const void *inside, char *folder, size_t bytes) {
    HMODULE own;
    const DWORD from = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    folder[0] = '\0';
    if (GetModuleHandleExW(from, (LPCWSTR)inside, &own)) (void)module_path(own, folder, bytes);
    char *slash = strrchr(folder, '/');
    if (slash) slash[1] = '\0';
}

/* Not while the loader is at work: FreeLibrary is forbidden there. */
void sys_close_when_unloaded(void *library) {
    (void)library;
}
