#!/bin/bash
# SPDX-License-Identifier: MIT
# test_small_stacks.sh SOURCE_FOLDER BUILD_FOLDER: where a user's stacks are small (ulimit -s), the main thread's and those of the
# runtime's threads. With 512 KiB all is right; with less a program says so before it starts. Hosts of others, which change
# nothing of that, have the plugin's frames, too.
set -u
build=$2
. "$1/tests/support/holds.sh"
cd "$work" || exit 1

small() { # small KIB CODE COMMAND...
    checked=$((checked + 1))
    (ulimit -s "$1" && ends "${@:2}" && exit "$failed") || failed=$((failed + 1))
}

run=("$build/host_sim" run --scene D01 --size 64 --setting smartvis --frames 1)
ends 0 "${run[@]}" --out plenty
for guard in --guard --no-guard; do
    small 512 0 "${run[@]}" "$guard" --out "small$guard"
    holds cmp "small$guard/result.png" plenty/result.png
done
small 512 0 "$build/sv_validate" --only first-frame "$build/smartvis.so"
small 512 0 "$build/examples/small_host" "$build/smartvis.so"
for program in host_sim sv_validate sv_replay; do
    small 256 7 "$build/$program" --help
    holds grep -qF 'This process may take 256 KiB of stack (ulimit -s), 512 are needed.' stderr
done
# More may be taken: the program does so.
checked=$((checked + 1))
(ulimit -Ss 128 && ends 0 "$build/host_sim" run --scene D01 --size 64 --setting smartvis --frames 1 --out soft && exit "$failed") ||
    failed=$((failed + 1))
echo "$checked checked, $failed failed"
[ $failed = 0 ]
