/* SPDX-License-Identifier: MIT */
#include "core/system.h"

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

const char sys_library_ending[] = ".dll", sys_list_separator[] = ";", sys_separators[] = "/\\";
const char *const sys_plugin_folders[] = {NULL}; /* at a drive's root anybody may make a folder */

/* A colon names a drive, also behind "//?/". Any other one would name a stream, which nobody sees. */
static bool names_stream(const char *path) {
    const bool prefixed = strspn(path, sys_separators) == 2 && strspn(path, "/\\?.") == 4;
    const char *colon = strrchr(path, ':');
    return colon && colon != path + (prefixed ? 5 : 1);
}

/* A drive has a folder of its own, in which "C:name" lies; who reads the path does not see which. */
static bool lacks_folder(const char *path) {
    return path[0] != '\0' && path[1] == ':' && strspn(path + 2, sys_separators) == 0;
}

/* Windows leaves out dots and spaces at the end of a name, and so opens another file. */
static bool names_another(const char *path) {
    size_t length;
    for (; *path; path += length + strspn(path + length, sys_separators)) {
        length = strcspn(path, sys_separators);
        const size_t dots = length < 3 ? strspn(path, ".") : 0;
        if (dots < length && length > 0 && strchr(". ", path[length - 1])) return true;
    }
    return false;
}

static bool refuse(int why) {
    errno = why;
    return false;
}

static bool to_wide(const char *text, wchar_t wide[SYS_PATH]) {
    return MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, wide, SYS_PATH) > 0 ||
           refuse(GetLastError() == ERROR_INSUFFICIENT_BUFFER ? ENAMETOOLONG : EILSEQ);
}

/* False: not UTF-8, too long, or what opens another file than it says. What is longer than old programs may
 * name becomes a whole path of the kind that has no such limit. */
static bool widen(const char *path, wchar_t wide[SYS_PATH]) {
    enum { OLD_MAX = 240, PREFIX = 4 };
    wchar_t whole[SYS_PATH];
    if (names_stream(path) || lacks_folder(path) || names_another(path)) return refuse(EINVAL);
    if (!to_wide(path, wide)) return false;
    const DWORD full = GetFullPathNameW(wide, SYS_PATH - PREFIX, whole, NULL);
    if (full == 0) return refuse(path[0] ? EINVAL : ENOENT);
    if (full >= SYS_PATH - PREFIX) return refuse(ENAMETOOLONG);
    if (full > OLD_MAX)
        (void)_snwprintf(wide, SYS_PATH, L"%ls%ls", whole[1] == L':' ? L"\\\\?\\" : L"", whole);
    return true;
}

static bool fail(void) {
    const DWORD error = GetLastError();
    errno = error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND ? ENOENT
            : error == ERROR_FILE_EXISTS || error == ERROR_ALREADY_EXISTS  ? EEXIST
            : error == ERROR_DISK_FULL                                     ? ENOSPC
            : error == ERROR_SHARING_VIOLATION                             ? EBUSY
            : error == ERROR_NOT_ENOUGH_MEMORY                             ? ENOMEM
            : error == ERROR_COMMITMENT_LIMIT                              ? ENOMEM
            : error == ERROR_INVALID_NAME                                  ? EINVAL
            : error == ERROR_FILENAME_EXCED_RANGE                          ? ENAMETOOLONG
                                                                           : EACCES;
    return false;
}

static bool has_attribute(const wchar_t *path, DWORD which) {
    const DWORD found = GetFileAttributesW(path);
    return found != INVALID_FILE_ATTRIBUTES && (found & which) != 0;
}

/* What is no file on a disk, such as a folder, CON or a pipe, is not opened. */
static int open_file(const wchar_t *path, DWORD access, DWORD creation, SECURITY_ATTRIBUTES *owner) {
    const HANDLE handle = CreateFileW(path, access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                      owner, creation, FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        (void)fail();
        if (errno == EACCES && has_attribute(path, FILE_ATTRIBUTE_DIRECTORY)) errno = EINVAL;
        return -1;
    }
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
    if (way == SYS_FIRST) return open_file(wide, GENERIC_WRITE, CREATE_NEW, NULL);
    /* For the owner alone: nothing is inherited from the folder. */
    if (!ConvertStringSecurityDescriptorToSecurityDescriptorW(L"D:P(A;;FA;;;OW)", SDDL_REVISION_1,
                                                              &owner.lpSecurityDescriptor, NULL))
        return fail() - 1;
    int file = open_file(wide, GENERIC_READ | GENERIC_WRITE | WRITE_DAC, CREATE_ALWAYS, &owner);
    if (file >= 0 &&
        !SetKernelObjectSecurity((HANDLE)_get_osfhandle(file), /* else one that was there has its own */
                                 DACL_SECURITY_INFORMATION | PROTECTED_DACL_SECURITY_INFORMATION,
                                 owner.lpSecurityDescriptor)) {
        (void)fail();
        (void)_close(file);
        file = -1;
    }
    (void)LocalFree(owner.lpSecurityDescriptor);
    return file;
}

bool sys_is_file(const char *path) {
    const int file = sys_open(path, SYS_READ);
    return file >= 0 && _close(file) == 0;
}

bool sys_is_folder(const char *path) {
    wchar_t wide[SYS_PATH];
    return widen(path, wide) && has_attribute(wide, FILE_ATTRIBUTE_DIRECTORY);
}

bool sys_is_there(const char *path) {
    wchar_t wide[SYS_PATH];
    return widen(path, wide) && (has_attribute(wide, ~0u) || fail());
}

/* "//server" and "C:" are there, or what is made below says so. */
bool sys_make_folder(const char *path) {
    wchar_t wide[SYS_PATH];
    const bool server = path[0] == '/' && (path[1] == '\0' || (path[1] == '/' && !strchr(path + 2, '/')));
    const bool drive = path[0] != '\0' && path[1] == ':' && path[2] == '\0';
    if (server || drive) return true;
    return widen(path, wide) && (CreateDirectoryW(wide, NULL) || (fail(), errno == EEXIST));
}

bool sys_remove(const char *path) {
    wchar_t wide[SYS_PATH];
    return widen(path, wide) && (DeleteFileW(wide) || fail());
}

bool sys_is_below(int file, const char *folder) {
    wchar_t wide[SYS_PATH], whole[SYS_PATH], name[SYS_PATH];
    const HANDLE handle = widen(folder, wide)
                              ? CreateFileW(wide, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                            NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL)
                              : INVALID_HANDLE_VALUE;
    if (handle == INVALID_HANDLE_VALUE) return false;
    DWORD length = GetFinalPathNameByHandleW(handle, whole, SYS_PATH, 0);
    (void)CloseHandle(handle);
    if (length == 0 || length >= SYS_PATH) return false;
    const DWORD named = GetFinalPathNameByHandleW((HANDLE)_get_osfhandle(file), name, SYS_PATH, 0);
    length -= whole[length - 1] == L'\\'; /* of a drive */
    return named > length && named < SYS_PATH && wcsncmp(name, whole, length) == 0 && name[length] == L'\\';
}

ptrdiff_t sys_read_at(int file, void *out, size_t bytes, uint64_t at) {
    DWORD got = 0;
    OVERLAPPED place = {.Offset = (DWORD)at, .OffsetHigh = (DWORD)(at >> 32)};
    const DWORD most = bytes < 1u << 30 ? (DWORD)bytes : 1u << 30;
    if (ReadFile((HANDLE)_get_osfhandle(file), out, most, &got, &place)) return (ptrdiff_t)got;
    return GetLastError() == ERROR_HANDLE_EOF ? 0 : (ptrdiff_t)fail() - 1;
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

/* Nothing is renamed over a file that somebody has open, but that file itself may be, and goes when it is
 * closed. A folder stays. */
static bool replace_open(const wchar_t *from, const wchar_t *to) {
    wchar_t aside[SYS_PATH];
    (void)fail();
    if ((errno != EACCES && errno != EBUSY) || has_attribute(to, FILE_ATTRIBUTE_DIRECTORY)) return false;
    (void)_snwprintf(aside, SYS_PATH, L"%ls.%lu", to, GetCurrentProcessId());
    aside[SYS_PATH - 1] = L'\0';
    if (!MoveFileExW(to, aside, 0)) return fail();
    const bool ok = MoveFileExW(from, to, 0) || fail();
    (void)(ok ? SetFileAttributesW(aside, FILE_ATTRIBUTE_NORMAL) && DeleteFileW(aside)
              : MoveFileExW(aside, to, 0));
    return ok;
}

bool sys_replace(const char *from, const char *to) {
    wchar_t wide_from[SYS_PATH], wide_to[SYS_PATH];
    return widen(from, wide_from) && widen(to, wide_to) &&
           (MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING) || replace_open(wide_from, wide_to));
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
    const DWORD length =
        sys_is_there(path) && widen(path, wide) ? GetFullPathNameW(wide, SYS_PATH, full, NULL) : 0;
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

static UINT code_page;

static void restore_console(void) {
    (void)SetConsoleOutputCP(code_page);
}

char **sys_arguments(int *count, char **argv) {
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), count);
    char **narrowed = wide ? calloc((size_t)*count + 1, sizeof *narrowed) : NULL;
    bool whole = narrowed != NULL;
    for (int i = 0; whole && i < *count; i++) whole = (narrowed[i] = with_slashes(wide[i])) != NULL;
    code_page = GetConsoleOutputCP();
    if (code_page && SetConsoleOutputCP(CP_UTF8)) (void)atexit(restore_console);
    for (int stream = 1; stream <= 2; stream++) {
        const HANDLE console = (HANDLE)_get_osfhandle(stream);
        DWORD mode;
        (void)_setmode(stream, O_BINARY);
        if (GetConsoleMode(console, &mode))
            (void)SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
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

bool sys_environment(const char *name, char *value, size_t bytes) {
    wchar_t wide[SYS_PATH];
    const wchar_t *set = to_wide(name, wide) ? _wgetenv(wide) : NULL;
    char *found = set ? narrow(set) : NULL;
    const bool fits = found && strlen(found) < bytes;
    (void)snprintf(value, bytes, "%s", fits ? found : "");
    free(found);
    return fits;
}

void sys_set_default(const char *name, const char *value) {
    if (!getenv(name)) (void)_putenv_s(name, value);
}

static LONG WINAPI end_by_fault(EXCEPTION_POINTERS *fault) {
    (void)TerminateProcess(GetCurrentProcess(), fault->ExceptionRecord->ExceptionCode);
    return EXCEPTION_CONTINUE_SEARCH;
}

void sys_end_at_fault(void) {
    (void)SetUnhandledExceptionFilter(end_by_fault);
}

static void (*last_work)(void);

static BOOL WINAPI end(DWORD event) {
    (void)event;
    last_work();
    return FALSE; /* and the program is ended as it would be */
}

void sys_when_ended(void (*clean_up)(void)) {
    last_work = clean_up;
    (void)SetConsoleCtrlHandler(end, TRUE);
}

static const char *volatile last_words;
static volatile int last_code;

static void left(void) {
    if (!last_words) return;
    (void)fflush(NULL);
    (void)fputs(last_words, stderr);
    _exit(last_code);
}

void sys_last_words(const char *words, int code) {
    static bool watching;
    last_words = words;
    last_code = code;
    if (!watching && words) watching = atexit(left) == 0;
}

unsigned sys_processors(void) {
    SYSTEM_INFO info;
    GetSystemInfo(&info);
    return info.dwNumberOfProcessors;
}

void *sys_aligned(size_t alignment, size_t bytes) {
    return _aligned_malloc(bytes, alignment);
}

void sys_aligned_free(void *memory) {
    _aligned_free(memory);
}

void *sys_pages(size_t bytes) {
    return VirtualAlloc(NULL, bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
}

void sys_pages_forbid(void *at, size_t bytes) {
    DWORD before;
    (void)VirtualProtect(at, bytes, PAGE_NOACCESS, &before);
}

void sys_pages_free(void *at, size_t bytes) {
    (void)bytes;
    if (at) (void)VirtualFree(at, 0, MEM_RELEASE);
}

int sys_temporary(void) {
    wchar_t folder[MAX_PATH + 1], name[MAX_PATH + 1];
    if (!GetTempPathW(MAX_PATH, folder) || !GetTempFileNameW(folder, L"sv", 0, name)) return fail() - 1;
    const HANDLE handle = CreateFileW(name, GENERIC_READ | GENERIC_WRITE, 0, NULL, CREATE_ALWAYS,
                                      FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    return handle != INVALID_HANDLE_VALUE ? _open_osfhandle((intptr_t)handle, O_BINARY) : fail() - 1;
}

/* A handle is inherited only if the caller wants it. */
void sys_close_others(void) {}

#define LARGEST_SHARED                                                                                       \
    (UINT64_C(8) << 30) /* of a size that is not known: Windows keeps 2 bytes for each KiB */

intptr_t sys_shared_new(size_t bytes) {
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    const uint64_t most = bytes ? bytes : LARGEST_SHARED;
    const HANDLE shared = CreateFileMappingW(INVALID_HANDLE_VALUE, &inherited, PAGE_READWRITE | SEC_RESERVE,
                                             (DWORD)(most >> 32), (DWORD)most, NULL);
    return shared ? (intptr_t)shared : fail() - 1;
}

bool sys_shared_resize(intptr_t shared, size_t bytes) {
    (void)shared;
    return bytes <= LARGEST_SHARED;
}

void sys_shared_close(intptr_t shared) {
    if (shared != -1) (void)CloseHandle((HANDLE)shared);
}

intptr_t sys_shared_reader(intptr_t shared) {
    HANDLE reader;
    const HANDLE self = GetCurrentProcess();
    return DuplicateHandle(self, (HANDLE)shared, self, &reader, FILE_MAP_READ, TRUE, 0) ? (intptr_t)reader
                                                                                        : fail() - 1;
}

void *sys_shared_map(intptr_t shared, size_t bytes, bool writes) {
    void *at = MapViewOfFile((HANDLE)shared, writes ? FILE_MAP_WRITE : FILE_MAP_READ, 0, 0, bytes);
    if (!at) (void)fail();
    return at;
}

bool sys_shared_use(void *at, size_t bytes, bool writes) {
    return VirtualAlloc(at, bytes, MEM_COMMIT, writes ? PAGE_READWRITE : PAGE_READONLY) || fail();
}

void sys_shared_unmap(void *at, size_t bytes) {
    (void)bytes;
    if (at) (void)UnmapViewOfFile(at);
}
