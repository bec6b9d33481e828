#!/bin/bash
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
    mkdir -p "$work"/tree/{include,cl,src/ref,host_sim/cl,tests/check,bench}
    cd "$work/tree"
    printf '#include <stdint.h>\n#include <stddef.h>\n' > include/smartvis_plugin.h
    printf '/* shared */\n' > cl/sv_shared.h
    printf '#include "sv_shared.h"\n' > cl/profile.cl
    printf '#include "sv_shared.h"\n#include <math.h>\n' > src/ref/ref_mean.h
    printf '#include "ref_mean.h"\n#include "smartvis_plugin.h"\n' > src/ref/ref_mean.c
    printf '#include <CL/cl.h>\n' > src/clx.h
    printf '/* lifecycle */\n' > src/plugin.h
    printf '#include "program.h"\n' > src/pipeline.h
    printf '#include "clx.h"\n' > src/program.h
    printf '#include "clx.h"\n#include "ref/ref_mean.h"\n#include "kernels_embedded.h"\n#include <sys/stat.h>\n' > src/program.c
    printf '#include <CL/cl.h>\n#include <png.h>\n#include "smartvis_plugin.h"\n' > host_sim/hs_png.c
    printf '/* helper */\n' > host_sim/cl/hs_sample.clh
    printf '#include "hs_sample.clh"\n' > host_sim/cl/hs_dvr.cl
    printf '#include "../../src/clx.h"\n' > tests/check/test_any.c
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
caught include/smartvis_plugin.h '#include "sv_shared.h"'
caught cl/profile.cl '#include "clx.h"'
caught cl/profile.cl '#include "../host_sim/cl/hs_sample.clh"'
caught cl/sv_shared.h '#include <stdint.h>'
caught src/ref/ref_mean.c '#include <CL/cl.h>'
caught src/ref/ref_mean.c '#include "../clx.h"'
caught src/ref/ref_mean.c '#include "clx.h"'
caught src/program.c '#include "hs_png.h"'
caught src/program.c '#include "profile.cl"'
caught src/program.c '#include <png.h>'
caught src/program.c '#  include "../host_sim/hs_png.h"'
caught src/clx.h '#include "program.h"'
caught src/program.c '#include "pipeline.h"'
caught src/pipeline.h '#include "plugin.h"'
caught host_sim/hs_png.c '#include "clx.h"'
caught host_sim/hs_png.c '#include "../src/clx.h"'
caught host_sim/hs_png.c '#include "ref/ref_mean.h"'
caught host_sim/hs_png.c '#include "sv_shared.h"'
caught host_sim/hs_png.c '#include MACRO_NAME'
caught host_sim/hs_png.c '%:include "clx.h"'
caught host_sim/cl/hs_dvr.cl '#include "sv_shared.h"'
caught tools/new.c '#include "clx.h"'
[ $failures = 0 ]
