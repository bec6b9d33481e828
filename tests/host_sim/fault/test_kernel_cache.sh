#!/bin/bash
# SPDX-License-Identifier: MIT
# test_kernel_cache.sh SOURCE_FOLDER BUILD_FOLDER: what PoCL's kernel cache can do to its host. One that cannot be written, or whose disk
# is full, is told before anything is compiled, with its folder; a damaged one, that a library ended the program and what helps;
# 'prepare --fresh' makes it good and touches nothing else there, nor where SmartVis keeps kernels itself.
set -u
build=$2
host_sim=$build/host_sim
. "$1/tests/support/holds.sh"
run=(run --scene E01 --size 32 --frames 1 --few-pictures --out "$work/out")
: > "$work/file"
for guard in --no-guard --guard; do
    POCL_CACHE_DIR=$work/file/cache expect 5 "kernel cache $work/file/cache cannot be written: Not a directory" "${run[@]}" $guard
    LD_PRELOAD=$build/tests/full_disk.so expect 5 "1 MiB free, expected 8" "${run[@]}" $guard
done
# The plugin asks by itself, for hosts that do not.
POCL_CACHE_DIR=$work/file/cache ends 1 "$build/tests/kept_state" "$build/smartvis.so"
holds grep -qF "$work/file/cache cannot be written" "$work/stderr"
POCL_CACHE_DIR=$work/file/cache ends 1 "$build/tests/kept_state" "$build/examples/kernel_edge.so"
holds grep -qF "$work/file/cache cannot be written" "$work/stderr"

expect 0 "" prepare
cp -r "$POCL_CACHE_DIR" "$work/cache"
export POCL_CACHE_DIR=$work/cache
find "$work/cache" -name '*.so' -exec truncate -s 1000 {} +
code=0
"$host_sim" "${run[@]}" > "$work/stdout" 2> "$work/stderr" || code=$?
holds test $code != 0
holds grep -qF "'host_sim prepare" "$work/stderr"
mkdir "$work/cache/mine" "$work/elsewhere" && : > "$work/elsewhere/file" && ln -s "$work/elsewhere" "$work/cache/AB"
expect 0 "" prepare --fresh
holds test -d "$work/cache/mine"
holds test -f "$work/elsewhere/file"
holds test ! -e "$work/cache/AB"
# What SmartVis would keep itself, and cannot, is told once, and all works.
SMARTVIS_KERNEL_CACHE=$work/file/kept expect 0 "$work/file/kept cannot be opened: Not a directory; SMARTVIS_KERNEL_CACHE" "${run[@]}"
holds test "$(grep -cF "kernels are compiled anew each time" "$work/stderr")" = 1
mkdir -m 700 "$work/kept" && : > "$work/kept/0123456789abcdef.kernels" && : > "$work/kept/mine"
SMARTVIS_KERNEL_CACHE=$work/kept expect 2 "is not one of mean, minimum" prepare --fresh --set method=nonsense
holds test ! -e "$work/kept/0123456789abcdef.kernels"
holds test -f "$work/kept/mine"
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
