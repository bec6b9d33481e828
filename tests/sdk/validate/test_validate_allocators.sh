#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_allocators.sh SOURCE_FOLDER BUILD_FOLDER: sv_validate with another allocator loaded first, as a machine may have it,
# blames no plugin that is right, and still finds leaks and heap calls.
set -u
build=$2
. "$1/tests/support/holds.sh"
tried=0
asan=$(readlink -f "$(gcc -print-file-name=libasan.so 2> /dev/null)" 2> /dev/null)
jemalloc=$(ldconfig -p | sed -n 's/.*libjemalloc.so.2 .*=> //p' | head -n 1)
export ASAN_OPTIONS=detect_leaks=0:use_sigaltstack=0
with() { local library=$1; shift; LD_PRELOAD=$library "$build/sv_validate" "$@"; }

for library in "$jemalloc" "$asan"; do
    [ -f "$library" ] || continue
    tried=$((tried + 1))
    for right in wrong/right/life wrong/right/results examples/first_edge; do
        ends 0 with "$library" --level 1 "$build/$right.so"
    done
    ends 0 with "$library" --level 1 --only first-frame,opencl-balance,activations,frame-path-heap,heap-faults "$build/smartvis.so"
    for id in leaks_memory:activations frame_allocates:frame-path-heap ignores_no_memory:heap-faults; do
        ends 1 with "$library" --only "${id#*:}" "$build/wrong/${id%:*}.so"
        holds grep -qE "^(fail|crash) +${id#*:} " "$work/stdout"
    done
done
[ $tried -gt 0 ] || { echo "skipped: neither libjemalloc nor libasan is here"; exit 77; }
ends 2 "$build/sv_validate" --only first-frame,nonsense "$build/smartvis.so"
holds grep -q "no check 'nonsense'" "$work/stderr"
ends 0 "$build/sv_validate" --only first-frame,frame-path-heap "$build/examples/first_edge.so"
holds grep -q '^2 checks in ' "$work/stdout"
echo "$checked checked with $tried allocators, $failed failed"
[ "$failed" = 0 ]
