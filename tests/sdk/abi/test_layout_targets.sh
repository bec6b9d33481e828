#!/bin/bash
# SPDX-License-Identifier: MIT
# The layout in the newest dump of abi/, asked of other systems: every struct has the same offsets, and one size, for the
# compilers of Linux, Windows (both of its ABIs) and macOS on both 64-bit processors. Needs clang, which knows all of them.
set -eu
command -v clang > /dev/null || { echo "skipped: clang is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source_dir=$1
dump=$(printf '%s\n' "$source_dir"/abi/types-*.txt | sort -V | tail -n 1)
{
    printf '#include <stddef.h>\n#include "smartvis_plugin.h"\n'
    sed -nE 's/^sv_ext_([a-z]+) size .*/#include "smartvis\/\1.h"/p' "$dump"
    printf '#define AT(type, field, byte) _Static_assert(offsetof(type, field) == (byte), #type "." #field " moved")\n'
    printf '#define SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), #type " changed its size")\n'
} > "$work/head.h"
# A struct may have grown since: its size is that of this machine, which check_abi.sh compares with the dump.
{
    cat "$work/head.h"
    printf '#include <stdio.h>\nint main(void) {\n'
    sed -nE 's/^([a-z_]+) size .*/    printf("SIZE(\1, %zu);\\n", sizeof(\1));/p' "$dump"
    printf '    return 0;\n}\n'
} > "$work/sizes.c"
clang -std=c11 -I "$source_dir/include" "$work/sizes.c" -o "$work/sizes"
{ cat "$work/head.h"; sed -nE 's/^([a-z_]+)\.([a-z_]+) ([0-9]+) .*/AT(\1, \2, \3);/p' "$dump"; "$work/sizes"; } > "$work/layout.c"
count=$(grep -cE '^(AT|SIZE)\(' "$work/layout.c")
[ "$count" -ge 190 ] || { echo "only $count assertions found"; exit 1; }
# check TARGET FILE: no system's headers; the compiler brings stdint.h and stddef.h itself.
check() { clang -target "$1" -ffreestanding -nostdlibinc -std=c11 -Wall -Wextra -Werror -fsyntax-only -I "$source_dir/include" "$2"; }
for target in x86_64-linux-gnu aarch64-linux-gnu x86_64-windows-gnu x86_64-pc-windows-msvc aarch64-pc-windows-msvc \
    x86_64-apple-macos11 arm64-apple-macos11; do
    check $target "$work/layout.c"
    echo "$target: $count sizes and offsets hold"
done
# It can fail: a struct that moved is seen.
sed 's/^SIZE(sv_host, \([0-9]*\));/SIZE(sv_host, 1\1);/' "$work/layout.c" > "$work/moved.c"
! check arm64-apple-macos11 "$work/moved.c" 2> /dev/null
