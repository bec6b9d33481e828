#!/bin/bash
# SPDX-License-Identifier: MIT
# Every public header compiles alone, first and twice in a file, without a warning, as every standard it promises: C99 to C23
# and C++11 to C++20, with gcc and clang where they are installed. It leaves no implicit padding in any struct. That two
# languages can use it together: test_install, with examples/cpp.
set -eu
source_dir=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Uses a bit of everything, in the common subset of C99 and C++11.
cat > use.c << 'END'
#include "smartvis_plugin.h"
#include "smartvis_plugin.h"
int check_header(const sv_entry *entry, const sv_host *host, struct _cl_mem *buffer);
int check_header(const sv_entry *entry, const sv_host *host, struct _cl_mem *buffer) {
    const sv_plugin *plugin = NULL;
    sv_slab slab = {sizeof(sv_slab), 0, 1, 0, NULL, NULL, 0, 0};
    slab.object = buffer;
    if (entry->abi_major != SV_ABI_MAJOR || entry->create(host, "x", &plugin) != SV_OK) return SV_ERR_UNKNOWN_ID;
    if (!SV_HAS(plugin, get_extension)) return SV_ERR_SIZE;
    return plugin->slab(plugin, &slab) == SV_OK && &smartvis_plugin_entry == entry;
}
END
cp use.c use.cpp
# The headers of extensions and helpers, each in a file of its own.
headers=()
parts=() # of author.h and author_cl.h: every standard reads them through these two; alone, the oldest is enough
for header in "$source_dir"/include/smartvis/*.h; do
    name=$(basename "$header" .h)
    : > "$name.c"
    # These say that they need OpenCL's header before them.
    [[ ! $name =~ ^(device|author_(cl|objects|programs|device|rehearsal))$ ]] ||
        printf '#define CL_TARGET_OPENCL_VERSION 120\n#include <CL/cl.h>\n' > "$name.c"
    printf '#include "smartvis/%s.h"\n#include "smartvis/%s.h"\nextern int %s_compiles;\n' "$name" "$name" "$name" >> "$name.c"
    cp "$name.c" "$name.cpp"
    if [[ $name =~ ^author_(method|checks|calls|runtime|kept|programs|objects|device|rehearsal)$ ]]; then parts+=("$name"); else headers+=("$name"); fi
done

failures=0
compile() { # compile COMPILER FILE FLAG...: no warning, or the test fails
    if ! "$1" "${@:3}" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-align -Wundef -Werror \
        -I "$source_dir/include" -c "$2" -o out.o; then
        echo "failed: $*"
        failures=$((failures + 1))
    fi
}

tried=0
for compiler in gcc clang; do
    command -v $compiler > /dev/null || { echo "not installed, left out: $compiler"; continue; }
    # c2x is what compilers of 2022 call C23.
    for standard in c99 gnu99 c11 c17 c2x; do
        for file in use "${headers[@]}"; do
            compile $compiler "$file.c" -fsyntax-only -std=$standard -Wstrict-prototypes -Wmissing-prototypes -Wc++-compat
        done
        tried=$((tried + 1))
    done
done
for compiler in g++ clang++; do
    command -v $compiler > /dev/null || { echo "not installed, left out: $compiler"; continue; }
    for standard in c++11 c++14 c++17 c++20; do
        for file in use "${headers[@]}"; do compile $compiler "$file.cpp" -fsyntax-only -std=$standard; done
        tried=$((tried + 1))
    done
done
if command -v gcc > /dev/null; then
    for file in "${parts[@]}"; do compile gcc "$file.c" -std=c99 -Wstrict-prototypes -Wmissing-prototypes -Wc++-compat; done
fi
[ $tried -gt 0 ] || { echo "skipped: no compiler"; exit 77; }

# Implicit padding would hide a field appended later: SV_HAS could not tell the old struct from the new one.
if command -v gcc > /dev/null; then
    for file in use timing points needs confidence; do compile gcc "$file.c" -std=c99 -Wpadded; done
fi

# It includes <stdint.h> and <stddef.h> and needs nothing else before it.
included=$(sed -n 's/^ *# *include *//p' "$source_dir/include/smartvis_plugin.h" | sort | tr '\n' ' ')
[ "$included" = "<stddef.h> <stdint.h> " ] || { echo "includes $included"; failures=$((failures + 1)); }

echo "$tried compilations, $failures failures"
[ $failures = 0 ]
