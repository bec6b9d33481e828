#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_examples.sh SOURCE_FOLDER BUILD_FOLDER: the example plugins pass every check that applies to them.
set -u
build=$2
failed=0
# Instrumented programs have their own place for what is loaded first.
preload=()
[ -n "${SV_SANITIZE:-}" ] || preload=("LD_PRELOAD=$build/tests/libshared_programs.so" SV_SHARE_PROGRAMS=1)
for plugin in "$build"/examples/*.so; do
    env "${preload[@]}" "$build/sv_validate" --level 3 --timeout 240 "$plugin" || failed=1
    [ ${#preload[@]} -eq 0 ] ||
        "$build/sv_validate" --level 3 --timeout 240 --only activations --only opencl-balance "$plugin" || failed=1
done
[ -e "$build/examples/kernel_edge.so" ] || { echo "no examples were built"; failed=1; }
exit $failed
