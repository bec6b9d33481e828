#!/bin/bash
# SPDX-License-Identifier: MIT
# oclgrind.sh BUILD_FOLDER OUT: every method on a small frame in Oclgrind, which simulates a device and sees reads and writes
# outside of a buffer, data races, and wrong calls of OpenCL. Exit code 1 if it saw any, or if a frame failed.
#
# Kernels are built without optimisation: Oclgrind 21.10 does not know some of LLVM's vector intrinsics. Its --uninitialized is
# left out: it ends in a crash of its own where rows are filled up to whole vectors.
set -u
build=$1
out=$2
mkdir -p "$out"
command -v oclgrind > /dev/null || { echo "oclgrind: not installed: apt-get install oclgrind" >&2; exit 1; }
code=0
oclgrind --build-options "-cl-opt-disable" --data-races --check-api --log "$out/oclgrind.log" \
    "$build/tests/every_method" "$build/smartvis.so" small > "$out/oclgrind.txt" || code=$?
cat "$out/oclgrind.txt"
if [ $code != 0 ] || [ -s "$out/oclgrind.log" ]; then
    head -n 60 "$out/oclgrind.log"
    echo "oclgrind: FAILED (exit code $code), see $out/oclgrind.log"
    exit 1
fi
"$build/tests/every_method" "$build/smartvis.so" small > "$out/oclgrind_beside.txt" || exit 1
same=$(comm -12 <(sort "$out/oclgrind.txt") <(sort "$out/oclgrind_beside.txt") | wc -l)
echo "oclgrind: nothing found; $same of $(wc -l < "$out/oclgrind.txt") results have the same bits as on the machine's own device"
