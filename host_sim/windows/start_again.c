/* SPDX-License-Identifier: MIT */
/* guarded/in_child.h by Windows' means: the program starts itself again, and that process finds in its
 * environment the events by which it says that it goes on, and that its work is done. */
#include "guarded/in_child.h"

#include "base/progress.h"
#include "base/system.h"
#include "plugin/loader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#define EVENTS "SMARTVIS_CHILD_EVENTS"

typedef struct {
    HANDLE goes_on, done; /* of a child; NULL in a process that is none */
} events;

static events told;

void hs_child_goes_on(void) {
    if (told.goes_on) (void)SetEvent(told.goes_on);
}

static void step(const char *label) {
    (void)label;
    hs_child_goes_on();
}

/* True in the child. What the plugin starts is none. */
static bool read_events(void) {
    const char *text = getenv(EVENTS);
    const bool found = text && sscanf(text, "%p,%p", &told.goes_on, &told.done) == 2;
    if (found) (void)SetEnvironmentVariableW(L"" EVENTS, NULL);
    return found;
}

static int perform(int (*work)(void *context), void *context) {
    (void)SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX); /* no window asks what to do */
    hs_progress_tell(step);
    const int code = work(context);
    (void)fflush(NULL);
    (void)SetEvent(told.done);
    return code;
}

/* A job ends with its last handle, and all processes in it. */
static HANDLE make_job(uint64_t memory_bytes) {
    const HANDLE job = CreateJobObjectW(NULL, NULL);
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits = {0};
    limits.BasicLimitInformation.LimitFlags =
        JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE | (memory_bytes ? JOB_OBJECT_LIMIT_JOB_MEMORY : 0);
    limits.JobMemoryLimit = (SIZE_T)memory_bytes;
    if (job) (void)SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits);
    return job;
}

/* The program again, in the job, with the same arguments and streams; NULL. */
static HANDLE start_again(HANDLE job, const events *e) {
    wchar_t program[SYS_PATH], *line = _wcsdup(GetCommandLineW());
    char text[64];
    STARTUPINFOW start = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES};
    PROCESS_INFORMATION process = {0};
    start.hStdInput = GetStdHandle(STD_INPUT_HANDLE);
    start.hStdOutput = GetStdHandle(STD_OUTPUT_HANDLE);
    start.hStdError = GetStdHandle(STD_ERROR_HANDLE);
    (void)snprintf(text, sizeof text, "%p,%p", e->goes_on, e->done);
    (void)SetEnvironmentVariableA(EVENTS, text);
    (void)fflush(NULL);
    const bool made =
        line && GetModuleFileNameW(NULL, program, SYS_PATH) &&
        CreateProcessW(program, line, NULL, NULL, TRUE, CREATE_SUSPENDED, NULL, NULL, &start, &process);
    (void)SetEnvironmentVariableA(EVENTS, NULL);
    free(line);
    if (!made) return NULL;
    (void)AssignProcessToJobObject(job, process.hProcess);
    (void)ResumeThread(process.hThread);
    (void)CloseHandle(process.hThread);
    return process.hProcess;
}

/* How the process ended, in words; "" if it did its work, with its exit code. */
static void watch(HANDLE process, const events *e, double silence_s, DWORD *code, char *how, size_t bytes) {
    const HANDLE both[] = {process, e->goes_on};
    DWORD what;
    how[0] = '\0';
    while ((what = WaitForMultipleObjects(2, both, FALSE, (DWORD)(silence_s * 1e3))) == WAIT_OBJECT_0 + 1)
        continue;
    if (what == WAIT_TIMEOUT) {
        (void)snprintf(how, bytes, "ran out of time (%.1f s)", silence_s);
        return;
    }
    (void)GetExitCodeProcess(process, code);
    if (WaitForSingleObject(e->done, 0) == WAIT_OBJECT_0) return;
    if (*code >= 0xC0000000u)
        (void)snprintf(how, bytes, "crashed: 0x%08lX", (unsigned long)*code);
    else
        (void)snprintf(how, bytes, "left by exit(%ld)", (long)*code);
}

int hs_work_in_child(const hs_guard_options *guard, const char *plugin, const char *doing,
                     int (*work)(void *context), void *context, hs_error *err) {
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    char found[1024], how[128] = "no process can be started";
    DWORD code = HS_ERR_MEMORY;
    hs_plugin_find(plugin, found, sizeof found);
    if (read_events()) return perform(work, context);
    if (!hs_guard_wanted(guard, found)) return work(context);
    const events e = {CreateEventW(&inherited, FALSE, FALSE, NULL),
                      CreateEventW(&inherited, TRUE, FALSE, NULL)};
    const HANDLE job = make_job(guard->memory_bytes), process = start_again(job, &e);
    if (process) watch(process, &e, guard->setup_s, &code, how, sizeof how);
    (void)CloseHandle(job); /* and with it what is still there */
    if (process) (void)CloseHandle(process);
    (void)CloseHandle(e.goes_on);
    (void)CloseHandle(e.done);
    if (how[0] == '\0') return (int)code;
    (void)hs_fail(err, HS_ERR_PLUGIN, "%s: %s while %s", found, how, doing);
    return HS_ERR_PLUGIN;
}
