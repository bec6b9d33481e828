#!/bin/bash
# SPDX-License-Identifier: MIT
# test_parts.sh SOURCE_FOLDER BUILD_FOLDER: a change concerns the tests of every part that is built from the changed file
# (scripts/part_of.awk), as CMake knows it: what the target part_NAME needs. Headers lie beside the sources that they belong to.
set -eu
source_dir=$(cd "$1" && pwd)
build=$2
cd "$source_dir"
ninja -C "$build" -t inputs part_base > /dev/null 2>&1 || { echo "skipped: no build by ninja"; exit 77; }

# missed PART FILES: of these files, those whose change would not run the part's tests.
missed() {
    awk "$(cat scripts/part_of.awk)"' {
        part = part_of($0)
        if (part != "rest" && !index(" " concerned(part) " ", " " tested " ")) print tested ": " $0
    }' tested="$1" "$2"
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
for part in base sdk host_sim python lab; do
    ninja -C "$build" -t inputs "part_$part" | sed -n "s|^$source_dir/||p" > "$work/files"
    [ "$(wc -l < "$work/files")" -gt 50 ] || { echo "part_$part is built from next to nothing"; failed=1; }
    missed "$part" "$work/files" > "$work/missed"
    [ ! -s "$work/missed" ] || { head -n 5 "$work/missed"; failed=1; }
done

# concerned FILE PART...: a change of this file runs the tests of these parts, and of the house.
concerned() {
    [ "$(scripts/concerned.sh <<< "$1" | sort | paste -sd ' ')" = "$(printf '%s\n' "${@:2}" | sort | paste -sd ' ')" ] ||
        { echo "$1: $(scripts/concerned.sh <<< "$1" | paste -sd ' ')" && failed=1; }
}
concerned base/core/system_posix.c base sdk host_sim python lab house
concerned src/ref/ref_mean.c base sdk host_sim python lab house
concerned sdk/stage/stage.c base sdk host_sim lab house
concerned host_sim/loop/loop.c host_sim python lab house
concerned python/smartvis/__init__.py python lab house
concerned docs/validator.md sdk house
concerned include/smartvis_plugin.h all
concerned scripts/lint.sh all
concerned tests/support/unit.c all
exit $failed
