/* SPDX-License-Identifier: MIT */
/* Limits of resources and what lies behind a descriptor have no counterpart: the standard streams are looked
 * at. */
#include "validate/drive/process.h"

#include "validate/drive/drive.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <tlhelp32.h>

struct v_watch {
    HANDLE streams[3];
};

static v_watch streams_now(void) {
    return (v_watch){
        {GetStdHandle(STD_INPUT_HANDLE), GetStdHandle(STD_OUTPUT_HANDLE), GetStdHandle(STD_ERROR_HANDLE)}};
}

v_watch *v_watch_begin(void) {
    static v_watch watch;
    watch = streams_now();
    return &watch;
}

const char *v_watch_change(const v_watch *watch) {
    const v_watch now = streams_now();
    DWORD flags;
    for (int i = 0; i < 3; i++)
        if (now.streams[i] != watch->streams[i] ||
            (watch->streams[i] && !GetHandleInformation(watch->streams[i], &flags)))
            return "closes or changes a standard stream";
    return NULL;
}

const char *v_process_handler(library_range library) {
    const LPTOP_LEVEL_EXCEPTION_FILTER filter = SetUnhandledExceptionFilter(NULL);
    (void)SetUnhandledExceptionFilter(filter);
    return library_range_holds(library, (const void *)(uintptr_t)filter) ? "unhandled exceptions" : NULL;
}

uint32_t v_process_files(void) {
    DWORD count = 0;
    return GetProcessHandleCount(GetCurrentProcess(), &count) ? count : 0;
}

uint32_t v_process_threads(void) {
    const HANDLE all = CreateToolhelp32Snapshot(TH32CS_SNAPTHREAD, 0);
    THREADENTRY32 thread = {.dwSize = sizeof thread};
    uint32_t count = 0;
    for (BOOL there = Thread32First(all, &thread); there; there = Thread32Next(all, &thread))
        count += thread.th32OwnerProcessID == GetCurrentProcessId();
    (void)CloseHandle(all);
    return count;
}

uint64_t v_process_most_files(void) {
    return UINT64_MAX;
}
