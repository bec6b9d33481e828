#!/bin/bash
# SPDX-License-Identifier: MIT
# The include rule holds (scripts/check_includes.sh, with the table of who may include whom), and the check itself
# catches every kind of violation: a check that finds nothing must be known to be able to find something.
set -eu
source_dir=$1
check=$source_dir/scripts/check_includes.sh
bash "$check" "$source_dir" || { echo "the sources break the include rule"; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# fresh_tree: a small tree that keeps the rule.
fresh_tree() {
    rm -rf "$work/tree"
    mkdir -p "$work"/tree/{include,cl/{common,profile},src/{abi,frame,device,ref},host_sim/{base,picture,render/cl},examples/first_edge,tests/check,bench}
    cd "$work/tree"
    printf '#include <stdint.h>\n#include <stddef.h>\n' > include/smartvis_plugin.h
    printf '/* shared */\n' > cl/common/sv_shared.h
    printf '#include "common/sv_shared.h"\n' > cl/profile/profile.cl
    printf '#include "common/sv_shared.h"\n#include <math.h>\n' > src/ref/ref_mean.h
    printf '#include "ref/ref_mean.h"\n#include "smartvis_plugin.h"\n' > src/ref/ref_mean.c
    printf '#include <CL/cl.h>\n' > src/device/clx.h
    printf '#include "device/clx.h"\n#include "kernels_frame.h"\n#include <sys/stat.h>\n' > src/device/program.c
    printf '#include "device/clx.h"\n#include "ref/ref_mean.h"\n' > src/frame/pipeline.c
    printf '#include <CL/cl.h>\n#include <png.h>\n#include "smartvis_plugin.h"\n' > host_sim/picture/png.c
    printf '/* helper */\n' > host_sim/render/cl/sample.clh
    printf '#include "sample.clh"\n' > host_sim/render/cl/dvr.cl
    printf '#include "smartvis_plugin.h"\n#include <stdio.h>\n' > examples/first_edge/first_edge.c
    printf '#include "../../src/device/clx.h"\n' > tests/check/test_any.c
}

fresh_tree
bash "$check" "$work/tree" || { echo "the check complains about a tree that keeps the rule"; exit 1; }

# caught FILE LINE: adding this line to this file must be reported, by the file's name.
failures=0
caught() {
    fresh_tree
    mkdir -p "$(dirname "$1")"
    printf '%s\n' "$2" >> "$1"
    if output=$(bash "$check" "$work/tree") || ! grep -qF "$1:" <<< "$output"; then
        echo "not caught: $2 in $1"
        failures=$((failures + 1))
    fi
}

caught include/smartvis_plugin.h '#include <stdio.h>'
caught include/smartvis_plugin.h '#include <CL/cl.h>'
caught include/smartvis_plugin.h '#include "common/sv_shared.h"'
caught cl/profile/profile.cl '#include "device/clx.h"'
caught cl/profile/profile.cl '#include "../../host_sim/render/cl/sample.clh"'
caught cl/common/sv_shared.h '#include <stdint.h>'
caught cl/common/sv_shared.h '#include "profile/profile.cl"'
caught src/ref/ref_mean.c '#include <CL/cl.h>'
caught src/ref/ref_mean.c '#include "../device/clx.h"'
caught src/ref/ref_mean.c '#include "device/clx.h"'
caught src/device/program.c '#include "picture/png.h"'
caught src/device/program.c '#include "profile/profile.cl"'
caught src/device/program.c '#include <png.h>'
caught src/device/program.c '#  include "../../host_sim/picture/png.h"'
caught host_sim/picture/png.c '#include "device/clx.h"'
caught host_sim/picture/png.c '#include "../src/device/clx.h"'
caught host_sim/picture/png.c '#include "ref/ref_mean.h"'
caught host_sim/picture/png.c '#include "common/sv_shared.h"'
caught host_sim/picture/png.c '#include MACRO_NAME'
caught host_sim/picture/png.c '%:include "device/clx.h"'
caught host_sim/render/cl/dvr.cl '#include "common/sv_shared.h"'
caught examples/first_edge/first_edge.c '#include "device/clx.h"'
caught examples/first_edge/first_edge.c '#include <png.h>'
caught examples/new/new.c '#include <stdio.h>'
caught tools/new.c '#include "device/clx.h"'
[ $failures = 0 ]
