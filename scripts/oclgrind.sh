#!/bin/bash
# SPDX-License-Identifier: MIT
# oclgrind.sh BUILD_FOLDER JOBS OUT: every method on a small frame in Oclgrind, which simulates a device and sees reads and writes
# outside of a buffer, data races, and wrong calls of OpenCL. Exit code 1 if it saw any, or if a frame failed.
#
# Kernels are built without optimisation: Oclgrind 21.10 does not know some of LLVM's vector intrinsics. Its --uninitialized is
# left out: it ends in a crash of its own where rows are filled up to whole vectors.
set -u -o pipefail
build=$1
jobs=$2
out=$3
mkdir -p "$out"
command -v oclgrind > /dev/null || { echo "oclgrind: not installed: apt-get install oclgrind" >&2; exit 1; }
beside=$out/oclgrind_beside.txt
"$build/tests/every_method" "$build/smartvis.so" small > "$beside" || exit 1

simulate() { # simulate METHOD
    local log=$out/oclgrind_$1.log text=$out/oclgrind_$1.txt code=0 start=$SECONDS
    oclgrind --build-options "-cl-opt-disable" --data-races --check-api --log "$log" \
        "$build/tests/every_method" "$build/smartvis.so" small "$1" > "$text" 2> "$text.err" || code=$?
    if [ $code != 0 ] || [ -s "$log" ] || [ ! -s "$text" ]; then
        cat "$text" "$text.err"
        head -n 60 "$log"
        echo "oclgrind: $1: FAILED (exit code $code), see $log"
        return 1
    fi
    echo "oclgrind: $1: nothing found in $(wc -l < "$text") frames ($((SECONDS - start)) s);" \
        "$(comm -12 <(sort "$text") <(sort "$beside") | wc -l) with the bits of the machine's own device"
}
export -f simulate
export build out beside

# Each method by itself: the simulation uses one processor. In the order from the newest, which take longest.
awk '{ print $1 }' "$beside" | uniq | tac |
    xargs -P "$jobs" -I METHOD bash -c 'simulate METHOD' && echo "oclgrind: nothing found"
