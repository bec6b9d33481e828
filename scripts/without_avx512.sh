#!/bin/bash
# SPDX-License-Identifier: MIT
# without_avx512.sh COMMAND...: runs a command on this machine's OpenCL as a processor without AVX-512 would have it, for figures: PoCL's
# LLVM 15 is told of a Haswell with what is left of this one. Kernels are kept apart from others'.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/told.c" << 'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <string.h>
#define NAME     _ZN4llvm3sys14getHostCPUNameEv
#define FEATURES _ZN4llvm3sys18getHostCPUFeaturesERNS_9StringMapIbNS_15MallocAllocatorEEE
#define TEXT(x)  #x
#define QUOTE(x) TEXT(x)
struct text { const char *data; size_t length; } NAME(void) { return (struct text){"haswell", 7}; }
struct map { void **table; unsigned buckets, items, tombs, size; };
_Bool FEATURES(struct map *map) {
    _Bool (*real)(struct map *) = dlsym(dlopen("libLLVM-15.so.1", RTLD_NOW), QUOTE(FEATURES));
    const _Bool known = real(map);
    for (unsigned i = 0; i < map->buckets; i++) {
        const uintptr_t entry = (uintptr_t)map->table[i];
        if (!entry || entry >= (uintptr_t)-16) continue; /* none, or one that was taken out */
        const char *name = (const char *)entry + map->size;
        if (!strncmp(name, "avx512", 6) || !strncmp(name, "avxvnni", 7)) ((_Bool *)entry)[8] = 0;
    }
    return known;
}
END
cc -O2 -shared -fPIC "$folder/told.c" -o "$folder/told.so"
mkdir -p "$folder/kernels"
LD_PRELOAD=$folder/told.so POCL_CACHE_DIR=$folder/kernels "$@"
