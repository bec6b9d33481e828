#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_examples.sh SOURCE_FOLDER BUILD_FOLDER: the example plugins pass every check that applies to them.
set -u
build=$2
failed=0
for name in first_edge kernel_edge; do
    "$build/sv_validate" --level 3 --timeout 240 "$build/examples/$name.so" || failed=1
done
exit $failed
