/* SPDX-License-Identifier: MIT */
/*
 * Builds OpenCL programs, for hosts and for plugins with kernels. Where the runtime keeps nothing of what it
 * compiles, the programs are kept in files (smartvis/author_kept.h) and the next process takes them: by
 * device, driver, processor, options and the whole source. It needs <CL/cl.h> before it.
 *
 * Runtimes that keep nothing, and load what they gave out, are Intel's for processors. If
 * SMARTVIS_KERNEL_CACHE names a folder, programs of all runtimes are kept there.
 *
 * If SMARTVIS_QUICK_KERNELS is set and not empty, PoCL 3 compiles without optimisation what was never
 * compiled with it: in a third of the time, to the same results, for kernels that take some five times as
 * long. It is for who wants a few frames and then leaves. Their sources see the macro SVA_QUICK.
 */
#ifndef SMARTVIS_AUTHOR_PROGRAMS_H
#define SMARTVIS_AUTHOR_PROGRAMS_H

#include "smartvis/author_kept.h"

SMARTVIS_BEGIN_C

enum { SVA_BUILT_TEXT = SVA_CACHE_TEXT + 120 };
typedef struct sva_built {
    cl_program program;       /* also after a build that failed, for its log; or NULL */
    cl_int code;              /* CL_SUCCESS, or what this call said: */
    const char *call;         /* clBuildProgram, or one before it */
    int kept;                 /* it comes from a file: nothing was compiled */
    int quick;                /* without optimisation */
    char why[SVA_BUILT_TEXT]; /* why it is not kept for the next process, where it should be; else "" */
} sva_built;

/* Internal: the source; its parts are `count` texts. */
typedef struct sva_source {
    cl_uint count;
    const char **texts;
    const size_t *bytes;
    const char *options;
} sva_source;

#if SVA_RUNTIME_POSIX
enum { SVA_PROGRAM_FACT = 500, SVA_PROGRAM_FACTS = 8 * SVA_PROGRAM_FACT };

/* Internal: a sum of what the processor can, by the system's own words: two that can different things may
 * have one name. 0 where it does not say. */
static inline uint64_t sva_program_processor(void) {
    char text[8192];
    memset(text, 0, sizeof text);
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (!file) return 0;
    const size_t bytes = fread(text, 1, sizeof text - 1, file);
    (void)fclose(file);
    const char *flags = bytes > 0 ? strstr(text, "\nflags") : NULL;
    if (!flags) flags = strstr(text, "\nFeatures");
    return flags ? sva_kept_sum(SVA_KEPT_SUM, flags, 1 + strcspn(flags + 1, "\n")) : 0;
}

/* Internal: what tells this device and its compiler from others. Not CL_SUCCESS if they do not say. */
static inline cl_int sva_program_facts(cl_device_id device, char *out) {
    static const cl_device_info of_device[] = {CL_DEVICE_NAME, CL_DEVICE_VENDOR, CL_DEVICE_VERSION,
                                               CL_DRIVER_VERSION};
    static const cl_platform_info of_platform[] = {CL_PLATFORM_NAME, CL_PLATFORM_VERSION};
    cl_platform_id platform = NULL;
    cl_uint lanes = 0, bits = 0;
    cl_int code = clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, (void *)&platform, NULL);
    if (code == CL_SUCCESS)
        code = clGetDeviceInfo(device, CL_DEVICE_NATIVE_VECTOR_WIDTH_CHAR, sizeof lanes, &lanes, NULL);
    if (code == CL_SUCCESS) code = clGetDeviceInfo(device, CL_DEVICE_ADDRESS_BITS, sizeof bits, &bits, NULL);
    for (int i = 0; i < 6 && code == CL_SUCCESS; i++) {
        char text[SVA_PROGRAM_FACT];
        memset(text, 0, sizeof text);
        code = i < 4 ? clGetDeviceInfo(device, of_device[i], sizeof text - 1, text, NULL)
                     : clGetPlatformInfo(platform, of_platform[i - 4], sizeof text - 1, text, NULL);
        out += snprintf(out, sizeof text + 1, "%s\n", text);
    }
    (void)snprintf(out, SVA_PROGRAM_FACT, "%u lanes, %u bits, processor %llx\n", (unsigned)lanes,
                   (unsigned)bits, (unsigned long long)sva_program_processor());
    return code;
}

/* Internal: a program's key, to be freed; or NULL. */
static inline char *sva_program_key(cl_device_id device, const sva_source *s, size_t *bytes) {
    char facts[SVA_PROGRAM_FACTS];
    if (sva_program_facts(device, facts) != CL_SUCCESS) return NULL;
    const size_t first = strlen(facts) + 1, options = strlen(s->options) + 1;
    size_t used = first + options;
    for (cl_uint i = 0; i < s->count; i++) used += s->bytes[i];
    char *key = (char *)malloc(used);
    if (!key) return NULL;
    *bytes = used;
    memcpy(key, facts, first);
    memcpy(key + first, s->options, options);
    used = first + options;
    for (cl_uint i = 0; i < s->count; i++) {
        memcpy(key + used, s->texts[i], s->bytes[i]);
        used += s->bytes[i];
    }
    return key;
}

/* Internal: what the device's platform says of itself. out->code is not CL_SUCCESS where it does not. */
static inline void sva_program_platform(cl_device_id device, cl_platform_info what, char *text, size_t bytes,
                                        sva_built *out) {
    cl_platform_id platform = NULL;
    memset(text, 0, bytes);
    out->call = "clGetDeviceInfo(CL_DEVICE_PLATFORM)";
    out->code = clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, (void *)&platform, NULL);
    if (out->code != CL_SUCCESS) return;
    out->call = what == CL_PLATFORM_NAME ? "clGetPlatformInfo(CL_PLATFORM_NAME)"
                                         : "clGetPlatformInfo(CL_PLATFORM_VERSION)";
    out->code = clGetPlatformInfo(platform, what, bytes - 1, text, NULL);
}

/* Internal: true if programs of this device are to be kept; out->code is not CL_SUCCESS where it does not say
 * what it is. */
static inline int sva_program_is_kept(cl_device_id device, sva_built *out) {
    static const char *const keep_nothing[] = {"Intel(R) OpenCL"};
    const char *named = getenv("SMARTVIS_KERNEL_CACHE");
    char name[100];
    if (named) return named[0] != '\0';
    sva_program_platform(device, CL_PLATFORM_NAME, name, sizeof name, out);
    for (size_t i = 0; out->code == CL_SUCCESS && i < sizeof keep_nothing / sizeof *keep_nothing; i++)
        if (strcmp(name, keep_nothing[i]) == 0) return 1;
    return 0;
}

/* Internal: the program from its file, if there is one that the runtime still takes. */
static inline void sva_program_load(const sva_kept *k, cl_context context, cl_device_id device,
                                    const char *key, size_t key_bytes, const char *options, sva_built *out) {
    size_t at = 0, bytes = 0;
    cl_int code = CL_SUCCESS;
    unsigned char *file = sva_kept_read(k, key, key_bytes, &at, &bytes);
    if (!file) return;
    const unsigned char *binary = file + at;
    cl_program program = clCreateProgramWithBinary(context, 1, &device, &bytes, &binary, NULL, &code);
    if (code == CL_SUCCESS) code = clBuildProgram(program, 1, &device, options, NULL, NULL);
    out->kept = code == CL_SUCCESS;
    if (out->kept)
        out->program = program;
    else if (program)
        (void)clReleaseProgram(program);
    free(file);
}

/* Internal: keeps a program of a context that has one device. */
static inline void sva_program_store(sva_kept *k, const char *key, size_t key_bytes, cl_program program) {
    cl_uint devices = 0;
    size_t bytes = 0;
    unsigned char *binary = NULL;
    cl_int code = clGetProgramInfo(program, CL_PROGRAM_NUM_DEVICES, sizeof devices, &devices, NULL);
    if (code == CL_SUCCESS && devices != 1) return;
    if (code == CL_SUCCESS)
        code = clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof bytes, &bytes, NULL);
    if (code == CL_SUCCESS && bytes > 0) binary = (unsigned char *)malloc(bytes);
    if (binary) code = clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof binary, (void *)&binary, NULL);
    if (binary && code == CL_SUCCESS)
        sva_kept_write(k, key, key_bytes, binary, bytes);
    else
        (void)snprintf(k->why, sizeof k->why, "the runtime does not give them out (%d)", (int)code);
    free(binary);
}
#endif

/* Internal: compiles. */
static inline void sva_program_compile(cl_context context, cl_device_id device, const sva_source *s,
                                       sva_built *out) {
    out->call = "clCreateProgramWithSource";
    out->program = clCreateProgramWithSource(context, s->count, s->texts, s->bytes, &out->code);
    if (out->code != CL_SUCCESS) return;
    out->call = "clBuildProgram";
    out->code = clBuildProgram(out->program, 1, &device, s->options, NULL, NULL);
}

#if SVA_RUNTIME_POSIX
enum { SVA_PROGRAM_MARK = SVA_CACHE_PATH + 40 };

/* Internal: true if the device is one of PoCL 3, whose kernels' results do not depend on optimisation.
 * out->code is not CL_SUCCESS where it does not say. */
static inline int sva_program_is_pocl3(cl_device_id device, sva_built *out) {
    char version[1000];
    sva_program_platform(device, CL_PLATFORM_VERSION, version, sizeof version, out);
    return out->code == CL_SUCCESS && strstr(version, " PoCL 3.") != NULL;
}

/* Internal: the file in PoCL's cache that says: this program was compiled with optimisation. It lies there
 * because it goes with it. False where there is none; see out->code. */
static inline int sva_program_mark(cl_device_id device, const sva_source *s, char *mark, size_t bytes,
                                   sva_built *out) {
    char cache[SVA_CACHE_PATH], facts[SVA_PROGRAM_FACTS];
    if (!sva_program_is_pocl3(device, out) || !sva_cache_folder(cache, sizeof cache)) return 0;
    out->call = "clGetDeviceInfo";
    out->code = sva_program_facts(device, facts);
    if (out->code != CL_SUCCESS) return 0;
    uint64_t sum = sva_kept_sum(SVA_KEPT_SUM, facts, strlen(facts) + 1);
    sum = sva_kept_sum(sum, s->options, strlen(s->options) + 1);
    for (cl_uint i = 0; i < s->count; i++) sum = sva_kept_sum(sum, s->texts[i], s->bytes[i]);
    (void)snprintf(mark, bytes, "%s/smartvis/%016llx", cache, (unsigned long long)sum);
    return 1;
}

/* Internal: makes it, where that can be done: without it the next quick process compiles once more. */
static inline void sva_program_set_mark(char *mark) {
    char *slash = strrchr(mark, '/');
    *slash = '\0';
    (void)mkdir(mark, S_IRWXU);
    *slash = '/';
    const int file = open(mark, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR);
    if (file >= 0) (void)close(file);
}

/* Internal: compiles as the user is in a hurry or not. */
static inline void sva_program_compile_as_asked(cl_context context, cl_device_id device, const sva_source *s,
                                                sva_built *out) {
    char mark[SVA_PROGRAM_MARK], options[1024];
    sva_source source = *s;
    const char *quick = getenv("SMARTVIS_QUICK_KERNELS");
    const int marks = sva_program_mark(device, s, mark, sizeof mark, out);
    if (out->code != CL_SUCCESS) return;
    if (marks && quick && quick[0] && access(mark, F_OK) != 0) {
        const int length =
            snprintf(options, sizeof options, "%s -cl-opt-disable -DSVA_QUICK", source.options);
        out->quick = length > 0 && (size_t)length < sizeof options;
        if (out->quick) source.options = options;
    }
    sva_program_compile(context, device, &source, out);
    if (marks && !out->quick && out->code == CL_SUCCESS) sva_program_set_mark(mark);
}
#endif

/* [control] Builds a program for one device of a source in `count` texts of so many bytes. The caller
 * releases out->program, also after a failure, unless it is NULL. */
static inline void sva_program_build(cl_context context, cl_device_id device, cl_uint count,
                                     const char **texts, const size_t *bytes, const char *options,
                                     sva_built *out) {
    sva_source s;
    memset(out, 0, sizeof *out);
    s.count = count;
    s.texts = texts;
    s.bytes = bytes;
    s.options = options;
#if SVA_RUNTIME_POSIX
    if (sva_program_is_kept(device, out)) {
        sva_kept k;
        size_t key_bytes = 0;
        sva_kept_open(&k, 1);
        char *key = k.folder >= 0 ? sva_program_key(device, &s, &key_bytes) : NULL;
        if (key) sva_program_load(&k, context, device, key, key_bytes, options, out);
        if (!out->kept) sva_program_compile(context, device, &s, out);
        if (key && !out->kept && out->code == CL_SUCCESS) sva_program_store(&k, key, key_bytes, out->program);
        if (k.why[0])
            (void)snprintf(
                out->why, sizeof out->why,
                "kernels are compiled anew each time: %s; SMARTVIS_KERNEL_CACHE names another folder", k.why);
        free(key);
        sva_kept_close(&k);
        return;
    }
    if (out->code != CL_SUCCESS) return;
    sva_program_compile_as_asked(context, device, &s, out);
#else
    sva_program_compile(context, device, &s, out);
#endif
}

SMARTVIS_END_C

#endif
