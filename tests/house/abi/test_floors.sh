#!/bin/bash
# SPDX-License-Identifier: MIT
# test_floors.sh SOURCE_FOLDER BUILD_FOLDER: the walls between the folders hold (scripts/check_floors.py has the table of who may
# include whom), and the check notices every kind of breach: one that finds nothing must be known to be able to find something.
set -eu
check=$1/scripts/check_floors.py
python3 -B "$check" "$1" "$2" || { echo "the sources break the rule"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# put FILE NAME...: adds an include of each to a file of the small tree.
put() {
    mkdir -p "$work/tree/$(dirname "$1")"
    printf '%s\n' "${@:2}" | sed 's/^./#include &/' >> "$work/tree/$1"
}

# caught BUILD WORDS...: the check says these of the tree, which is then as it was.
caught() {
    local words output=
    ! output=$(python3 -B "$check" "$work/tree" ${1:+"$1"}) || output=
    for words in "${@:2}"; do
        grep -qF "floors: $words" <<< "$output" || { echo "not caught: $words" && failures=$((failures + 1)); }
    done
    rm -rf "$work/tree"
    cp -r "$work/kept" "$work/tree"
}

# A small tree that keeps the rule: each floor includes what it may.
while read -ra words; do
    put "${words[@]}"
done << 'TREE'
include/smartvis_plugin.h <stdint.h> <stddef.h>
include/smartvis/stats.h "smartvis_plugin.h" <stdint.h>
include/smartvis/author.h "smartvis/author_calls.h" <string.h>
include/smartvis/author_calls.h "smartvis/stats.h" <stdlib.h>
cl/common/sv_shared.h
cl/wall/wall_shared.h "common/sv_shared.h"
cl/wall/wall.clh "wall/wall_shared.h"
cl/mean/mean.cl "common/sv_shared.h" "mean/sums.clh"
cl/mean/sums.clh
src/quantise.h "wall/wall_shared.h" <math.h>
src/quantise.c "quantise.h" <stdint.h>
src/ref/ref_mean.h "common/sv_shared.h"
src/ref/ref_mean.c "ref/ref_mean.h" "quantise.h"
src/device/clx.h <CL/cl.h>
src/device/clx.c "device/clx.h" "kernels_frame.h" <sys/stat.h>
src/method/method.h "device/clx.h"
src/method/method.c "method/method.h" "ref/ref_mean.h" "quantise.h"
src/frame/frame.h "method/method.h"
src/frame/frame.c "frame/frame.h" "ref/ref_mean.h" "device/clx.h"
src/abi/params.h "smartvis/stats.h"
src/abi/plugin.c "abi/params.h" "frame/frame.h"
base/core/error.h <stdbool.h>
host_sim/volume/volume.h "core/error.h"
host_sim/volume/volume.c "volume/volume.h" <zlib.h>
host_sim/picture/png.h "core/error.h"
host_sim/picture/png.c "picture/png.h" <png.h>
base/plugin/loader.h "smartvis_plugin.h" "core/error.h"
host_sim/scene/scene.h "volume/volume.h" <jansson.h>
host_sim/render/dvr.h "volume/volume.h" <CL/cl.h>
host_sim/render/cl/dvr.cl "sample.clh"
host_sim/render/cl/sample.clh
host_sim/loop/loop.h "render/dvr.h" "plugin/loader.h" "scene/scene.h"
host_sim/commands/run.h "loop/loop.h"
lab/eval/measure.h "loop/loop.h"
lab/report/page.h "eval/measure.h" "picture/png.h" "commands/run.h"
host_sim/program/main.c "report/page.h"
lab/bench/times.h "loop/loop.h"
tests/sdk/check/test_any.c "../../../src/device/clx.h" <lapacke.h>
examples/plane/plane.c "smartvis/author.h" <CL/cl.h>
TREE
python3 -B "$check" "$work/tree" || { echo "the check complains about a tree that keeps the rule"; exit 1; }
cp -r "$work/tree" "$work/kept"

# What each of these files must not include, a line each.
while read -ra words; do
    file=${words[0]} wanted=()
    put "${words[@]}"
    lines=$(($(wc -l < "$work/tree/$file") - ${#words[@]} + 1))
    for ((n = 1; n < ${#words[@]}; n++)); do wanted+=("$file:$((lines + n)):"); done
    [[ $file != */new.* ]] || wanted=("$file:1: a source in a folder without a rule")
    caught "" "${wanted[@]}"
done << 'BREACHES'
include/smartvis_plugin.h <stdio.h> <CL/cl.h> "smartvis/stats.h"
include/smartvis/stats.h <string.h>
include/smartvis/author.h <CL/cl.h> "common/sv_shared.h"
cl/mean/mean.cl "device/clx.h" "wall/wall.clh" "../../host_sim/render/cl/sample.clh"
cl/common/sv_shared.h <stdint.h> "mean/sums.clh"
src/quantise.c "ref/ref_mean.h" <CL/cl.h>
src/ref/ref_mean.c "smartvis_plugin.h" <CL/cl.h> "device/clx.h" "../device/clx.h"
src/device/clx.c "method/method.h" "quantise.h" "mean/mean.cl" "wall/wall.clh" <png.h>
src/method/method.c "frame/frame.h"
src/frame/frame.c "abi/params.h"
src/abi/plugin.c "ref/ref_mean.h" "picture/png.h"
base/core/error.h "volume/volume.h" "smartvis_plugin.h"
host_sim/volume/volume.c "picture/png.h"
host_sim/picture/png.c "volume/volume.h" "smartvis_plugin.h" <CL/cl.h> "../core/error.h" MACRO_NAME
base/plugin/loader.h "render/dvr.h"
host_sim/scene/scene.h "render/dvr.h"
host_sim/render/dvr.h "scene/scene.h" "eval/measure.h" "device/clx.h" "../src/device/clx.h"
host_sim/render/cl/dvr.cl "common/sv_shared.h"
host_sim/loop/loop.h "eval/measure.h"
lab/eval/measure.h "picture/png.h" "report/page.h" "ref/ref_mean.h"
host_sim/program/main.c "ref/ref_mean.h"
examples/plane/plane.c "core/error.h"
tests/sdk/check/test_any.c "there_is_none.h"
corner/new.c <stdint.h>
cl/new.cl "common/sv_shared.h"
src/corner/new.c <stdint.h>
BREACHES
# An include in another form.
for form in '#include MACRO_NAME' '%:include "core/error.h"' '#  include "../../base/core/error.h"'; do
    echo "$form" >> "$work/tree/host_sim/picture/png.c"
    caught "" "host_sim/picture/png.c:$(wc -l < "$work/kept/host_sim/picture/png.c" | awk '{ print $1 + 1 }'):"
done

# Circles: FILE NAMED, each file including the one it names. A source and its header are one: b.h needs a.h, and a.c needs b.h.
while read -ra words; do
    for ((n = 0; n < ${#words[@]}; n += 2)); do put "${words[n]}" "\"${words[n + 1]}\""; done
    caught "" "${words[0]%.*}: in a circle of includes"
done << 'CIRCLES'
src/device/a.h device/b.h src/device/b.h device/a.h
base/core/a.h core/b.h base/core/b.h core/c.h base/core/c.h core/a.h
base/core/a.c core/b.h base/core/b.h core/a.h base/core/a.h core/error.h
cl/mean/a.clh mean/b.clh cl/mean/b.clh mean/a.clh
CIRCLES

# Calls, as the objects of a build have them.
compiled() { # PATH LINE
    local object=$work/build/obj/${1%/*}/CMakeFiles/x.dir/${1##*/}.o
    mkdir -p "${object%/*}"
    cc -x c -c -o "$object" - <<< "$2"
}
compiled src/low/a.c 'int a(void) { return 0; }'
compiled src/high/b.c 'int a(void); int b(void) { return a(); }'
python3 -B "$check" "$work/tree" "$work/build"
compiled src/low/c.c 'int b(void); int c(void) { return b(); }'
caught "$work/build" "src/low: in a circle of calls of folders"
compiled src/low/a.c 'int c(void); int a(void) { return c(); }'
caught "$work/build" "src/low/a.c: in a circle of calls of sources"
[ $failures = 0 ]
