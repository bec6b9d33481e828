#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_smartvis.sh SOURCE_FOLDER BUILD_FOLDER: the plugin of this repository passes every check, with every method.
set -u
build=$2
# Level 1 of 10: all checks, with fewer activations than sv_validate tries by itself. Each check's programs are built once
# (tests/programs/shared_programs.h), or nine tenths of the time would go into building them.
out=$(LD_PRELOAD=$build/tests/libshared_programs.so SV_SHARE_PROGRAMS=1 \
    "$build/sv_validate" --level 1 --timeout 240 "$build/smartvis.so" 2>&1)
code=$?
echo "$out"
[ $code -eq 0 ] || exit 1
# What counts memory and objects counts those of builds, too.
"$build/sv_validate" --level 1 --timeout 240 --only activations --only opencl-balance "$build/smartvis.so" || exit 1
# What it can do, it is tried with.
for id in carriers confidence adjust-equals-frame scanned-ranges padding-value every-setting param-pairs opencl-faults; do
    grep -qE "^pass +$id " <<< "$out" || { echo "$id: was not tried"; exit 1; }
done
