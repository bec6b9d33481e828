#!/bin/bash
# SPDX-License-Identifier: MIT
# test_layer_threads.sh SOURCE_FOLDER BUILD_FOLDER: the checking layer under ThreadSanitizer, with and without a recording: instances on threads of their own, calls from
# any thread beside them, and a host that breaks the rule and calls one instance from two threads (tests/programs/layer_threads.c).
set -eu
source_dir=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Addresses at random are too many bits for some versions of it.
tsan() { setarch -R env TSAN_OPTIONS="halt_on_error=1 exitcode=66" "$@"; }
cd "$source_dir"
flags=(-std=c11 -D_GNU_SOURCE -DCL_TARGET_OPENCL_VERSION=120 -g -O1 -fsanitize=thread -ffp-contract=off -Iinclude -Isdk -Ibase)
echo 'int main(void) { return 0; }' > "$work/probe.c"
{ cc "${flags[@]}" "$work/probe.c" -o "$work/probe" && tsan "$work/probe"; } 2> "$work/why" || {
    echo "skipped: no ThreadSanitizer here: $(head -n 1 "$work/why")"
    exit 77
}
cc "${flags[@]}" -fPIC -shared -fvisibility=hidden -I "$2/obj/version" sdk/layer/*.c sdk/rules/*.c sdk/record/*.c \
    base/core/system_posix.c -o "$work/layer.so" -lOpenCL -lz -lm -lpthread
cc "${flags[@]}" -fPIC -shared -fvisibility=hidden -DPLUGIN tests/programs/layer_threads.c -o "$work/plugin.so"
cc "${flags[@]}" tests/programs/layer_threads.c -o "$work/host" -ldl -lpthread
export SMARTVIS_CHECK_PLUGIN=$work/plugin.so
tsan "$work/host" "$work/layer.so"
SMARTVIS_RECORD=$work/recording tsan "$work/host" "$work/layer.so"
test -s "$work/recording" && test -s "$work/recording.2"
