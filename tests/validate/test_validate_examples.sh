#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_examples.sh SOURCE_FOLDER BUILD_FOLDER: the example plugins pass every check that applies to them.
set -u
build=$2
failed=0
for plugin in "$build"/examples/*.so; do
    "$build/sv_validate" --level 3 --timeout 240 "$plugin" || failed=1
done
[ -e "$build/examples/kernel_edge.so" ] || { echo "no examples were built"; failed=1; }
exit $failed
