#!/bin/bash
# SPDX-License-Identifier: MIT
# test_few_descriptors.sh SOURCE_FOLDER BUILD_FOLDER: programs as a service or a daemon starts them, with standard input, output or error
# closed, or with no more than 64 descriptors. What is right is found right, and nothing that is printed lands in a file.
set -u
build=$2
. "$1/tests/support/holds.sh"
cd "$work" || exit 1
"$build/host_sim" scenes D01 --size 48 --export --out scene > /dev/null || exit 1

# closed REDIRECTIONS COMMAND...: the command ends well with these.
closed() {
    local how=$1 code=0
    shift
    eval '"$@" > stdout 2> stderr '"$how" || code=$?
    checked=$((checked + 1))
    [ $code = 0 ] && return
    echo "FAIL: $* $how: exit code $code"
    cat stderr
    failed=$((failed + 1))
}

for how in '0<&-' '1>&-' '2>&-' '0<&- 1>&- 2>&-'; do
    closed "$how" "$build/host_sim" run --volume scene/D01_full.mha --guard --setting smartvis --frames 1 --write depthmap --out "out$how"
    holds cmp "out$how/depthmap.mha" "out0<&-/depthmap.mha"
    closed "$how" "$build/host_sim" list --guard
    closed "$how" "$build/sv_validate" --only descriptors,first-frame "$build/smartvis.so"
done
closed '0<&- 1>&- 2>&-' "$build/sv_bench" --guard --size 128 --slab 16 --route copy-own
ulimit -n 64
closed '' "$build/host_sim" run --volume scene/D01_full.mha --guard --setting smartvis --frames 1 --write depthmap --out few
holds cmp few/depthmap.mha "out0<&-/depthmap.mha"
closed '' "$build/sv_validate" --only descriptors,first-frame "$build/smartvis.so"
echo "$checked checked, $failed failed"
[ $failed = 0 ]
