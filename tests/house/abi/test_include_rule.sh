#!/bin/bash
# SPDX-License-Identifier: MIT
# The walls between the folders hold (scripts/check_includes.sh, with the table of who may include whom), and the check
# notices every kind of breach: a check that finds nothing must be known to be able to find something.
set -eu
source_dir=$1
check=$source_dir/scripts/check_includes.sh
bash "$check" "$source_dir" || { echo "the sources break the include rule"; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# put FILE LINE...: writes a file of the small tree.
put() {
    local file=$work/tree/$1
    shift
    [ -d "${file%/*}" ] || mkdir -p "${file%/*}"
    printf '%s\n' "$@" > "$file"
}

# A small tree that keeps the rule: each floor includes what it may.
make_tree() {
    put include/smartvis_plugin.h '#include <stdint.h>' '#include <stddef.h>'
    put include/smartvis/stats.h '#include "smartvis_plugin.h"' '#include <stdint.h>'
    put include/smartvis/author.h '#include "smartvis/author_calls.h"' '#include <string.h>'
    put include/smartvis/author_calls.h '#include "smartvis/stats.h"' '#include <stdlib.h>'
    put cl/common/sv_shared.h '/* shared */'
    put cl/wall/wall_shared.h '#include "common/sv_shared.h"'
    put cl/wall/wall.clh '#include "wall/wall_shared.h"'
    put cl/mean/mean.cl '#include "common/sv_shared.h"' '#include "mean/sums.clh"'
    put cl/mean/sums.clh '/* sums */'
    put src/quantise.h '#include "wall/wall_shared.h"' '#include <math.h>'
    put src/quantise.c '#include "quantise.h"' '#include <stdint.h>'
    put src/ref/ref_mean.h '#include "common/sv_shared.h"'
    put src/ref/ref_mean.c '#include "ref/ref_mean.h"' '#include "quantise.h"'
    put src/device/clx.h '#include <CL/cl.h>'
    put src/device/clx.c '#include "device/clx.h"' '#include "kernels_frame.h"' '#include <sys/stat.h>'
    put src/method/method.h '#include "device/clx.h"'
    put src/method/method.c '#include "method/method.h"' '#include "ref/ref_mean.h"' '#include "quantise.h"'
    put src/frame/frame.h '#include "method/method.h"'
    put src/frame/frame.c '#include "frame/frame.h"' '#include "ref/ref_mean.h"' '#include "device/clx.h"'
    put src/abi/params.h '#include "smartvis/stats.h"'
    put src/abi/plugin.c '#include "abi/params.h"' '#include "frame/frame.h"' 'const sv_entry smartvis_plugin_entry = {'
    put host_sim/base/error.h '#include <stdbool.h>'
    put host_sim/volume/volume.h '#include "base/error.h"'
    put host_sim/volume/volume.c '#include "volume/volume.h"' '#include <zlib.h>'
    put host_sim/picture/png.h '#include "base/error.h"'
    put host_sim/picture/png.c '#include "picture/png.h"' '#include <png.h>'
    put host_sim/plugin/loader.h '#include "smartvis_plugin.h"' '#include "base/error.h"'
    put host_sim/scene/scene.h '#include "volume/volume.h"' '#include <jansson.h>'
    put host_sim/render/dvr.h '#include "volume/volume.h"' '#include <CL/cl.h>'
    put host_sim/render/cl/dvr.cl '#include "sample.clh"'
    put host_sim/render/cl/sample.clh '/* helper */'
    put host_sim/loop/loop.h '#include "render/dvr.h"' '#include "plugin/loader.h"' '#include "scene/scene.h"'
    put tools/machine/commands/run.h '#include "loop/loop.h"'
    put lab/eval/measure.h '#include "loop/loop.h"'
    put lab/report/page.h '#include "eval/measure.h"' '#include "picture/png.h"' '#include "commands/run.h"'
    put tools/machine/main.c '#include "report/page.h"' 'int main(void) {'
    put lab/bench/times.h '#include "loop/loop.h"'
    put lab/judge/judge_main.c '#include "ref/ref_mean.h"' 'int main(void) {'
    put tests/sdk/check/test_any.c '#include "../../../src/device/clx.h"' '#include <lapacke.h>'
    put examples/plane/plane.c '#include "smartvis/author.h"' '#include <CL/cl.h>'
}

make_tree
cp -r "$work/tree" "$work/kept"
fresh_tree() {
    rm -rf "$work/tree"
    cp -r "$work/kept" "$work/tree"
}
bash "$check" "$work/tree" || { echo "the check complains about a tree that keeps the rule"; exit 1; }

# caught FILE LINE [NAMED]: adding this line to this file must be reported, and NAMED (the file) be named.
failures=0
caught() {
    fresh_tree
    mkdir -p "$work/tree/${1%/*}"
    printf '%s\n' "$2" >> "$work/tree/$1"
    if output=$(bash "$check" "$work/tree") || ! grep -qF "rule: ${3:-$1}:" <<< "$output"; then
        echo "not caught: $2 in $1"
        failures=$((failures + 1))
    fi
}

# The ABI, and the kernels.
caught include/smartvis_plugin.h '#include <stdio.h>'
caught include/smartvis_plugin.h '#include <CL/cl.h>'
caught include/smartvis_plugin.h '#include "smartvis/stats.h"'
caught include/smartvis/stats.h '#include <string.h>'
caught include/smartvis/author.h '#include <CL/cl.h>'
caught include/smartvis/author.h '#include "common/sv_shared.h"'
caught cl/mean/mean.cl '#include "device/clx.h"'
caught cl/mean/mean.cl '#include "wall/wall.clh"'
caught cl/mean/mean.cl '#include "../../host_sim/render/cl/sample.clh"'
caught cl/common/sv_shared.h '#include <stdint.h>'
caught cl/common/sv_shared.h '#include "mean/sums.clh"'
# The plugin.
caught src/quantise.c '#include "ref/ref_mean.h"'
caught src/quantise.c '#include <CL/cl.h>'
caught src/quantise.c '#include "smartvis_plugin.h"'
caught src/ref/ref_mean.c '#include "smartvis_plugin.h"'
caught src/ref/ref_mean.c '#include <CL/cl.h>'
caught src/ref/ref_mean.c '#include "device/clx.h"'
caught src/ref/ref_mean.c '#include "../device/clx.h"'
caught src/device/clx.c '#include "method/method.h"'
caught src/device/clx.c '#include "quantise.h"'
caught src/device/clx.c '#include "mean/mean.cl"'
caught src/device/clx.c '#include "wall/wall.clh"'
caught src/device/clx.c '#include <png.h>'
caught src/device/clx.c '#  include "../../host_sim/picture/png.h"'
caught src/method/method.c '#include "frame/frame.h"'
caught src/frame/frame.c '#include "abi/params.h"'
caught src/abi/plugin.c '#include "ref/ref_mean.h"'
caught src/abi/plugin.c '#include "picture/png.h"'
# The host.
caught host_sim/base/error.h '#include "volume/volume.h"'
caught host_sim/base/error.h '#include "smartvis_plugin.h"'
caught host_sim/volume/volume.c '#include "picture/png.h"'
caught host_sim/picture/png.c '#include "volume/volume.h"'
caught host_sim/picture/png.c '#include "smartvis_plugin.h"'
caught host_sim/picture/png.c '#include <CL/cl.h>'
caught host_sim/picture/png.c '#include "../base/error.h"'
caught host_sim/picture/png.c '#include MACRO_NAME'
caught host_sim/picture/png.c '%:include "base/error.h"'
caught host_sim/plugin/loader.h '#include "render/dvr.h"'
caught host_sim/scene/scene.h '#include "render/dvr.h"'
caught host_sim/render/dvr.h '#include "scene/scene.h"'
caught host_sim/render/dvr.h '#include "eval/measure.h"'
caught host_sim/render/dvr.h '#include "device/clx.h"'
caught host_sim/render/dvr.h '#include "../src/device/clx.h"'
caught host_sim/render/cl/dvr.cl '#include "common/sv_shared.h"'
caught host_sim/loop/loop.h '#include "eval/measure.h"'
caught lab/eval/measure.h '#include "picture/png.h"'
caught lab/eval/measure.h '#include "report/page.h"'
caught tools/machine/main.c '#include "ref/ref_mean.h"'
# Around them.
caught lab/eval/measure.h '#include "ref/ref_mean.h"'
caught lab/judge/judge_main.c '#include "method/method.h"'
caught examples/plane/plane.c '#include "base/error.h"'
caught tests/sdk/check/test_any.c '#include "there_is_none.h"'
caught corner/new.c '#include <stdint.h>'
caught cl/new.cl '#include "common/sv_shared.h"'
caught src/corner/new.c '#include <stdint.h>'

# circle FILE LINE...: these files together must be reported as a circle.
circle() {
    fresh_tree
    local first=${1%.*}
    while [ $# -gt 0 ]; do
        put "$1" "$2"
        shift 2
    done
    if output=$(bash "$check" "$work/tree") || ! grep -qF "rule: $first: in a circle" <<< "$output"; then
        echo "a circle is not caught: $first"
        failures=$((failures + 1))
    fi
}

circle src/device/a.h '#include "device/b.h"' src/device/b.h '#include "device/a.h"'
circle host_sim/base/a.h '#include "base/b.h"' host_sim/base/b.h '#include "base/c.h"' host_sim/base/c.h '#include "base/a.h"'
# A source and its header are one: b.h needs a.h, and a.c needs b.h.
circle host_sim/base/a.c '#include "base/b.h"' host_sim/base/b.h '#include "base/a.h"' host_sim/base/a.h '#include <stdint.h>'
circle cl/mean/a.clh '#include "mean/b.clh"' cl/mean/b.clh '#include "mean/a.clh"'
[ $failures = 0 ]
