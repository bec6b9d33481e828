#!/bin/bash
# SPDX-License-Identifier: MIT
# macos.sh BUILD_FOLDER OUT_FOLDER: the plugin and the examples compile for macOS without a warning, for both of its processors, with
# the system's headers that zig brings. Nothing is linked or run. BUILD_FOLDER is a build of this machine, which has the kernels as
# text. deadline_host is left out: macOS waits until a time by other calls.
set -eu -o pipefail
build=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
rm -rf "$out/objects" && mkdir -p "$out/objects" "$out/CL"
cd "$(dirname "$0")/.."
scripts/python_env.sh "$out/venv" python/requirements-macos.txt
cp -rL /usr/include/CL/*.h "$out/CL"

export ZIG_GLOBAL_CACHE_DIR=$out/cache ZIG_LOCAL_CACHE_DIR=$out/cache
flags=(-std=c11 -O1 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-enum-float-conversion
    -Wno-float-conversion -DCL_TARGET_OPENCL_VERSION=120 '-DPLUGIN_NAME="mine"' '-DPLUGIN_VERSION="0"'
    -I include -I src -I cl -I "$build/obj/src" -I "$build/obj/version" -I "$build/obj/examples/kernel_edge/smartvis_kernels" -isystem "$out")
for processor in aarch64 x86_64; do
    find src examples -name '*.c' ! -name deadline_host.c -printf '%p\n' | sort | while read -r file; do
        "$out/venv/bin/python" -m ziglang cc -target $processor-macos "${flags[@]}" -c "$file" -o "$out/objects/$(tr / _ <<< "$file").$processor.o"
    done
    echo "macos: $(find "$out/objects" -name "*.$processor.o" | wc -l) files compile for $processor"
done
