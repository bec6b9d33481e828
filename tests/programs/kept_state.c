/* SPDX-License-Identifier: MIT */
/*
 * kept_state PLUGIN.so [trap [queue]]: a plugin that opens its own device leaves the process as its host had
 * it. Every signal has a handler of the host's before the runtime starts, and has it after an activation and
 * a frame. With "trap" floating-point exceptions trap, as in hosts of Delphi or of Fortran with its checks:
 * the frame is the same as without, and they still trap. With "queue" the host opens the device, and takes
 * what the runtime does to signals upon itself. A program, since a runtime takes signals once in a process.
 */
#include "smartvis/lookup.h"
#include "stage/stage.h"

#include <dlfcn.h>
#include <fenv.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 40, SLICES = 48, RAYS = SIDE * SIDE, TRAPS = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW };

static uint8_t voxels[SLICES * RAYS];
static int failures;
static volatile sig_atomic_t heard;

static void expect(bool holds, const char *what) {
    if (holds) return;
    failures++;
    (void)fprintf(stderr, "kept_state: FAIL: %s\n", what);
}

static void hear(int number) {
    if (number == SIGFPE || number == SIGSEGV || number == SIGILL || number == SIGBUS)
        _exit(3); /* it would come again */
    heard = number;
}

static bool is_ours(int number) {
    return number != SIGKILL && number != SIGSTOP && number != SIGPROF && (number < 32 || number > 33);
}

static void take_signals(void) {
    const struct sigaction ours = {.sa_handler = hear};
    for (int n = 1; n <= SIGSYS; n++)
        if (is_ours(n)) expect(sigaction(n, &ours, NULL) == 0, "a handler");
}

static void look_at_signals(void) {
    for (int n = 1; n <= SIGSYS; n++) {
        struct sigaction now;
        char what[60];
        (void)snprintf(what, sizeof what, "SIG%s is no longer the host's", sigabbrev_np(n));
        if (is_ours(n)) expect(sigaction(n, NULL, &now) == 0 && now.sa_handler == hear, what);
    }
    (void)raise(SIGUSR1);
    expect(heard == SIGUSR1, "the host hears no SIGUSR1");
}

static void make_volume(void) {
    for (int i = 0; i < SLICES * RAYS; i++) {
        const int x = i % SIDE, y = i / SIDE % SIDE, z = i / RAYS, near = 8 + x / 16,
                  far = near + 20 + (x / 8 + y / 8) % 4;
        voxels[i] = (uint8_t)((z < near ? 100 : z < far ? 10 : 200) + (z * 7 + i * 13) % 9);
    }
}

static void failed(void *data, const char *what, cl_int code) {
    (void)fprintf(stderr, "kept_state: %s: %d\n", what, (int)code);
    exit(1);
}

static stage_device own; /* zeros: the plugin opens one */

static void open_own(void) {
    cl_platform_id platform = NULL;
    cl_int code = CL_SUCCESS;
    (void)clGetPlatformIDs(1, &platform, NULL);
    (void)clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &own.device, NULL);
    own.context = clCreateContext(NULL, 1, &own.device, NULL, NULL, &code);
    own.queue = clCreateCommandQueue(own.context, own.device, 0, &code);
    if (code != CL_SUCCESS) failed(NULL, "a queue", code);
}

/* The sum of the depths of one frame. */
static double frame(const sv_plugin *p) {
    static stage st;
    const stage_way way = {.width = SIDE,
                           .height = SIDE,
                           .slices = SLICES,
                           .longest = 16,
                           .tiles_x = 1,
                           .carrier = SV_CARRIER_HOST,
                           .own_queue = own.queue == NULL,
                           .spacing_mm = {1, 1, 1},
                           .padding = SV_NO_PADDING};
    double sum = 0;
    stage_make(&st, &way, &own, failed, NULL);
    stage_fill(&st, voxels, NULL);
    stage_poison(&st, 0);
    const sv_result result = stage_result(&st);
    const bool active = p->activate(p, &st.format) >= SV_OK;
    expect(active && stage_run(&st, p, NULL, 0, &result) >= SV_OK, p->last_error(p));
    for (int i = 0; i < RAYS; i++) sum += (double)result.depth[i];
    if (active) p->deactivate(p);
    stage_free(&st);
    return sum;
}

int main(int argc, char **argv) {
    const bool traps = argc > 2 && strcmp(argv[2], "trap") == 0;
    const bool queue = argc > 3 && strcmp(argv[3], "queue") == 0;
    make_volume();
    take_signals();
    /* Before the runtime is loaded: its threads inherit it. */
    if (traps) expect(feenableexcept(TRAPS) != -1, "traps");
    if (queue) open_own();
    void *library = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    const sv_entry *entry = library ? dlsym(library, SV_ENTRY_SYMBOL) : NULL;
    const sv_host host = {sizeof host, SV_ABI_MINOR, NULL, "kept_state", "1", NULL, NULL};
    const sv_plugin *p = NULL;
    if (!entry || entry->create(&host, entry->descriptor(0)->id, &p) != SV_OK) return 2;
    const double sum = frame(p);
    if (!queue) look_at_signals();
    expect((fegetexcept() & TRAPS) == (traps ? TRAPS : 0), "traps are no longer the host's");
    (void)fedisableexcept(TRAPS);
    expect(frame(p) == sum && sum > 0, "a frame without traps is another");
    p->destroy(p);
    if (queue) (void)(clReleaseCommandQueue(own.queue) + clReleaseContext(own.context));
    return failures > 0;
}
