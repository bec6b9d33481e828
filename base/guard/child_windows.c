/* SPDX-License-Identifier: MIT */
/* The channel is a pipe of messages, beside an event that the child rings with each: a pipe cannot be waited
 * for. A job ends all that the child has started, also if this process ends before it. */
#include "core/system.h"
#include "guard/child_system.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIN32_LEAN_AND_MEAN
#define PSAPI_VERSION 2 /* what it offers lies in kernel32 */
#include <windows.h>

#include <psapi.h>

#define CHANNEL_BYTES 65536u
#define KILLED        0xE0534B4Cu /* the exit code of what is ended here */

/* ----------------------------------------------------------------------------------------- starting -- */

static bool refuse(const char *what, hs_error *err) {
    return hs_fail(err, HS_ERR_MEMORY, "child process: %s: error %lu", what, GetLastError());
}

static SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};

/* *theirs: the child's end. */
static bool open_channel(hs_child *child, HANDLE *theirs) {
    static volatile LONG number;
    wchar_t name[64];
    DWORD mode = PIPE_READMODE_MESSAGE;
    (void)swprintf(name, sizeof name / sizeof *name, L"\\\\.\\pipe\\smartvis-%lu-%ld", GetCurrentProcessId(),
                   InterlockedIncrement(&number));
    const HANDLE ours =
        CreateNamedPipeW(name, PIPE_ACCESS_DUPLEX | FILE_FLAG_FIRST_PIPE_INSTANCE,
                         PIPE_TYPE_MESSAGE | PIPE_READMODE_MESSAGE | PIPE_REJECT_REMOTE_CLIENTS, 1,
                         CHANNEL_BYTES, CHANNEL_BYTES, 0, NULL);
    if (ours == INVALID_HANDLE_VALUE) return false;
    child->channel = (intptr_t)ours;
    *theirs = CreateFileW(name, GENERIC_READ | GENERIC_WRITE, 0, &inherited, OPEN_EXISTING, 0, NULL);
    child->bell = (intptr_t)CreateEventW(&inherited, FALSE, FALSE, NULL);
    return *theirs != INVALID_HANDLE_VALUE && SetNamedPipeHandleState(*theirs, &mode, NULL, NULL) &&
           child->bell;
}

/* What the child has as standard input, output and error; those that were opened for it are the first
 * `own`. */
static bool open_streams(hs_child *child, HANDLE streams[3], int *own) {
    HANDLE ours = NULL;
    *own = 1;
    streams[0] = CreateFileW(L"NUL", GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                             OPEN_EXISTING, 0, NULL);
    streams[1] = GetStdHandle(STD_OUTPUT_HANDLE);
    streams[2] = GetStdHandle(STD_ERROR_HANDLE);
    if (child->limits.output == HS_CHILD_INHERITED) {
        for (int i = 1; i < 3; i++)
            (void)SetHandleInformation(streams[i], HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
        return true;
    }
    *own = 2;
    streams[1] = NULL;
    if (child->limits.output == HS_CHILD_DISCARDED)
        streams[1] = CreateFileW(L"NUL", GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                                 OPEN_EXISTING, 0, NULL);
    else if (CreatePipe(&ours, &streams[1], &inherited, CHANNEL_BYTES))
        child->output = (intptr_t)ours;
    if (ours) (void)SetHandleInformation(ours, HANDLE_FLAG_INHERIT, 0);
    streams[2] = streams[1];
    return streams[1] && streams[1] != INVALID_HANDLE_VALUE;
}

/* The arguments in one line, of which a C program makes them again; the caller's to free. NULL. */
static wchar_t *line_of(char *const *argv, uint32_t argc) {
    size_t bytes = 1;
    for (uint32_t i = 0; i < argc; i++) bytes += 2 * strlen(argv[i]) + 3;
    char *line = malloc(bytes), *to = line;
    wchar_t *wide = calloc(bytes, sizeof *wide);
    for (uint32_t i = 0; line && i < argc; i++) {
        size_t slashes = 0; /* in front of a quotation mark they count twice */
        *to++ = '"';
        for (const char *c = argv[i];; c++) {
            if (*c == '"' || !*c)
                for (; slashes > 0; slashes--) *to++ = '\\';
            if (!*c) break;
            slashes = *c == '\\' ? slashes + 1 : 0;
            if (*c == '"') *to++ = '\\';
            *to++ = *c;
        }
        *to++ = '"';
        *to++ = i + 1 < argc ? ' ' : '\0';
    }
    if (!line || !wide || !MultiByteToWideChar(CP_UTF8, 0, line, -1, wide, (int)bytes)) {
        free(wide);
        wide = NULL;
    }
    free(line);
    return wide;
}

/* A job ends with its last handle, and all processes in it. */
static HANDLE make_job(void) {
    const HANDLE job = CreateJobObjectW(NULL, NULL);
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits = {0};
    limits.BasicLimitInformation.LimitFlags =
        JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE | JOB_OBJECT_LIMIT_DIE_ON_UNHANDLED_EXCEPTION;
    if (!job || SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits))
        return job;
    (void)CloseHandle(job);
    return NULL;
}

/* Starts the program in the job, with these handles and no others. */
static bool launch(hs_child *child, const wchar_t *program, wchar_t *line, HANDLE streams[3], HANDLE *handed,
                   uint32_t count) {
    STARTUPINFOEXW start = {.StartupInfo = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES}};
    PROCESS_INFORMATION process = {0};
    SIZE_T bytes = 0;
    start.StartupInfo.hStdInput = streams[0];
    start.StartupInfo.hStdOutput = streams[1];
    start.StartupInfo.hStdError = streams[2];
    (void)InitializeProcThreadAttributeList(NULL, 1, 0, &bytes);
    start.lpAttributeList = malloc(bytes);
    if (!start.lpAttributeList) return false;
    (void)SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX); /* no window asks what to do */
    const bool made =
        InitializeProcThreadAttributeList(start.lpAttributeList, 1, 0, &bytes) &&
        UpdateProcThreadAttribute(start.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, handed,
                                  count * sizeof *handed, NULL, NULL) &&
        CreateProcessW(program, line, NULL, NULL, TRUE,
                       CREATE_SUSPENDED | CREATE_NEW_PROCESS_GROUP | EXTENDED_STARTUPINFO_PRESENT, NULL, NULL,
                       &start.StartupInfo, &process);
    free(start.lpAttributeList);
    if (!made) return false;
    const bool held = AssignProcessToJobObject((HANDLE)child->job, process.hProcess) &&
                      ResumeThread(process.hThread) != (DWORD)-1;
    (void)CloseHandle(process.hThread);
    child->process = held ? (intptr_t)process.hProcess : 0;
    if (held) return true;
    (void)TerminateProcess(process.hProcess, KILLED);
    (void)CloseHandle(process.hProcess);
    return false;
}

bool hs_process_start(hs_child *child, const char *program, char **argv, uint32_t argc,
                      const intptr_t *passed, uint32_t passed_count, hs_error *err) {
    wchar_t path[SYS_PATH];
    HANDLE theirs = INVALID_HANDLE_VALUE, streams[3] = {NULL}, handed[HS_CHILD_HANDLES + 3];
    intptr_t marked[HS_CHILD_HANDLES];
    char mark[32 * HS_CHILD_HANDLES];
    uint32_t count = 0;
    int own = 0;
    const bool named = program ? MultiByteToWideChar(CP_UTF8, 0, program, -1, path, SYS_PATH) > 0
                               : GetModuleFileNameW(NULL, path, SYS_PATH) > 0;
    child->job = (intptr_t)make_job();
    bool ok = (named && child->job && open_channel(child, &theirs) && open_streams(child, streams, &own)) ||
              refuse("no channel", err);
    marked[0] = (intptr_t)theirs;
    marked[1] = child->bell;
    memcpy(marked + 2, passed, passed_count * sizeof *passed);
    hs_child_mark(mark, sizeof mark, marked, passed_count + 2);
    argv[argc - 1] = mark;
    for (; count < passed_count + 2; count++) handed[count] = (HANDLE)marked[count];
    for (int i = 0; i < 3; i++)
        if (streams[i] && (i < 2 || streams[2] != streams[1])) handed[count++] = streams[i];
    wchar_t *line = line_of(argv, argc);
    (void)fflush(NULL);
    ok = ok && ((line && launch(child, path, line, streams, handed, count)) ||
                hs_fail(err, HS_ERR_INPUT, "%s: cannot be run: error %lu", program ? program : argv[0],
                        GetLastError()));
    free(line);
    if (theirs != INVALID_HANDLE_VALUE) (void)CloseHandle(theirs);
    for (int i = 0; i < own; i++)
        if (streams[i]) (void)CloseHandle(streams[i]);
    if (!ok) hs_process_close(child);
    return ok;
}

void hs_process_close(hs_child *child) {
    const intptr_t all[] = {child->channel, child->bell, child->job, child->output};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i] && all[i] != -1) (void)CloseHandle((HANDLE)all[i]);
    child->output = -1;
}

/* ----------------------------------------------------------------------------------------- watching -- */

bool hs_process_collect(hs_child *child, bool waits, hs_child_end *end, bool *killed) {
    DWORD code = 0;
    const HANDLE process = (HANDLE)child->process;
    if (WaitForSingleObject(process, waits ? INFINITE : 0) == WAIT_TIMEOUT) return false;
    (void)GetExitCodeProcess(process, &code);
    (void)CloseHandle(process);
    (void)TerminateJobObject((HANDLE)child->job, KILLED);
    *killed = code == KILLED;
    const bool crashed = code >= 0xC0000000u && code < 0xF0000000u; /* an error's code, but no exit(-1) */
    end->fate = crashed ? HS_CHILD_CRASHED : HS_CHILD_LEFT;
    end->number = (int)code;
    return true;
}

void hs_process_kill(hs_child *child) {
    (void)TerminateJobObject((HANDLE)child->job, KILLED);
}

/* Windows 7 tells one, wine the other, newer Windows both. */
uint64_t hs_process_memory(hs_child *child) { /* NOLINT(readability-non-const-parameter) */
    PROCESS_MEMORY_COUNTERS_EX taken = {.cb = sizeof taken};
    (void)GetProcessMemoryInfo((HANDLE)child->process, (PROCESS_MEMORY_COUNTERS *)&taken, sizeof taken);
    return taken.PrivateUsage > taken.PagefileUsage ? taken.PrivateUsage : taken.PagefileUsage;
}

/* Bytes that can be read at once; -1: the other end is closed. */
static ptrdiff_t waiting_in(intptr_t pipe) {
    DWORD bytes = 0;
    return PeekNamedPipe((HANDLE)pipe, NULL, 0, NULL, &bytes, NULL) ? (ptrdiff_t)bytes : -1;
}

ptrdiff_t hs_process_read(hs_child *child, char *text, size_t bytes) {
    DWORD got = 0;
    const ptrdiff_t there = waiting_in(child->output);
    if (there == 0) return -1;
    if (there > 0 && ReadFile((HANDLE)child->output, text, (DWORD)bytes, &got, NULL)) return (ptrdiff_t)got;
    (void)CloseHandle((HANDLE)child->output);
    child->output = -1;
    return 0;
}

bool hs_process_has_message(const hs_child *child) {
    return waiting_in(child->channel) > 0;
}

bool hs_process_stirs(hs_child *child, int ms) {
    const HANDLE either[] = {(HANDLE)child->bell, (HANDLE)child->process};
    if (waiting_in(child->channel) == 0) (void)WaitForMultipleObjects(2, either, FALSE, (DWORD)ms);
    return waiting_in(child->channel) != 0;
}

void hs_process_pause(const hs_child *child, int ms) {
    (void)WaitForSingleObject((HANDLE)child->process, (DWORD)ms);
}

void hs_process_tell_crash(int number, char *out, size_t bytes) {
    static const struct {
        DWORD code;
        const char *name;
    } names[] = {{EXCEPTION_ACCESS_VIOLATION, "access violation"},
                 {EXCEPTION_STACK_OVERFLOW, "stack overflow"},
                 {EXCEPTION_INT_DIVIDE_BY_ZERO, "division by zero"},
                 {EXCEPTION_ILLEGAL_INSTRUCTION, "illegal instruction"},
                 {0xC0000409u, "aborted, or wrote over its stack"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if ((DWORD)number == names[i].code) {
            (void)snprintf(out, bytes, "crashed: %s", names[i].name);
            return;
        }
    (void)snprintf(out, bytes, "crashed: 0x%08X", (unsigned)number);
}

/* ------------------------------------------------------------------------------------ being a child -- */

bool hs_child_is_channel(intptr_t handle) {
    return GetFileType((HANDLE)handle) == FILE_TYPE_PIPE;
}

void hs_child_settle(intptr_t handle) {
    (void)handle;
}

bool hs_child_send(intptr_t channel, const void *message, size_t bytes) {
    DWORD sent = 0;
    const bool ok = WriteFile((HANDLE)channel, message, (DWORD)bytes, &sent, NULL) && sent == bytes;
    if (channel == hs_child_passed(0)) (void)SetEvent((HANDLE)hs_child_handle(1));
    return ok;
}

bool hs_child_receive(intptr_t channel, void *message, size_t bytes) {
    DWORD got = 0;
    return ReadFile((HANDLE)channel, message, (DWORD)bytes, &got, NULL) && got == bytes;
}

void hs_child_look_around(void) {
    DWORD flags;
    while (!GetHandleInformation((HANDLE)hs_child_passed(0), &flags)) Sleep(INFINITE);
}

void hs_child_leave(int code) {
    (void)TerminateProcess(GetCurrentProcess(), (UINT)code);
    abort();
}
