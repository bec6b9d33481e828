/* SPDX-License-Identifier: MIT */
#include "bench/bench.h"

#include "guarded/in_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --------------------------------------------------------------------------------------------- machine -- */

/* "model name" of /proc/cpuinfo; "unknown CPU" elsewhere. */
static void ask_cpu(char *out, size_t bytes) {
    char line[256];
    (void)snprintf(out, bytes, "unknown CPU");
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *value = strchr(line, ':');
        if (!value || strncmp(line, "model name", strlen("model name")) != 0) continue;
        (void)snprintf(out, bytes, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
        break;
    }
    if (file) (void)fclose(file);
}

void bench_machine_ask(bench_machine *m, const hs_cl *cl, const hs_plugin *plugin) {
    const sv_descriptor *d = plugin->instance->descriptor;
    *m = (bench_machine){.processors = sysconf(_SC_NPROCESSORS_ONLN)};
    ask_cpu(m->cpu, sizeof m->cpu);
    if (getloadavg(&m->load, 1) != 1) m->load = -1.0;
    (void)snprintf(m->device, sizeof m->device, "%s", cl->device_name);
    (void)snprintf(m->plugin, sizeof m->plugin, "%s %s", d->id, d->version);
    cl_platform_id platform = NULL;
    /* Captions only: what cannot be asked stays empty. */
    (void)clGetDeviceInfo(cl->device, CL_DEVICE_VERSION, sizeof m->version - 1, m->version, NULL);
    (void)clGetDeviceInfo(cl->device, CL_DRIVER_VERSION, sizeof m->driver - 1, m->driver, NULL);
    if (clGetDeviceInfo(cl->device, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL) == CL_SUCCESS)
        (void)clGetPlatformInfo(platform, CL_PLATFORM_VERSION, sizeof m->platform - 1, m->platform, NULL);
}

void bench_machine_print(const bench_machine *m) {
    printf("CPU       %s, %ld processors, load %.1f when the run began\n", m->cpu, m->processors, m->load);
    printf("device    %s; %s; driver %s; %s\n", m->device, m->version, m->driver, m->platform);
    printf("plugin    %s\n", m->plugin);
    printf("plain C   %s, %d threads, compiled for %s\n", __VERSION__, BENCH_THREADS,
           BENCH_NATIVE ? "this processor" : "any processor");
}

/* ----------------------------------------------------------------------------------------------- times -- */

bool bench_samples_create(bench_samples *samples, uint32_t capacity, hs_error *err) {
    *samples = (bench_samples){.ms = malloc(capacity * sizeof(double)), .capacity = capacity};
    return samples->ms || hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %u samples", capacity);
}

void bench_samples_add(bench_samples *samples, double ms) {
    hs_child_goes_on();
    if (samples->count < samples->capacity) samples->ms[samples->count++] = ms;
}

void bench_samples_destroy(bench_samples *samples) {
    free(samples->ms);
    *samples = (bench_samples){0};
}

hs_timing bench_samples_times(const bench_samples *samples) {
    return hs_timing_of(samples->ms, samples->count);
}
