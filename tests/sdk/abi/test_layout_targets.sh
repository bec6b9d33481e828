#!/bin/bash
# SPDX-License-Identifier: MIT
# The assertions of test_layout.c, asked of other systems: every struct has the same size and offsets for the compilers of
# Linux, Windows (both of its ABIs) and macOS on both 64-bit processors. Needs clang, which knows all of them.
set -eu
command -v clang > /dev/null || { echo "skipped: clang is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Without what is not of the ABI: OpenCL's header, C libraries, tests.
grep -E '^(#include "smartvis|#define (AT|SIZE)\(|AT\(|SIZE\()' "$1/tests/sdk/abi/test_layout.c" > "$work/layout.c"
count=$(grep -cE '^(AT|SIZE)\(' "$work/layout.c")
[ "$count" -ge 190 ] || { echo "only $count assertions found"; exit 1; }
# check TARGET FILE: no system's headers; the compiler brings stdint.h and stddef.h itself.
check() { clang -target "$1" -ffreestanding -nostdlibinc -std=c11 -Wall -Wextra -Werror -fsyntax-only -I "$source_dir/include" "$2"; }
source_dir=$1
for target in x86_64-linux-gnu aarch64-linux-gnu x86_64-windows-gnu x86_64-pc-windows-msvc aarch64-pc-windows-msvc \
    x86_64-apple-macos11 arm64-apple-macos11; do
    check $target "$work/layout.c"
    echo "$target: $count sizes and offsets hold"
done
# It can fail: a struct that moved is seen.
sed 's/^SIZE(sv_host, \([0-9]*\));/SIZE(sv_host, 1\1);/' "$work/layout.c" > "$work/moved.c"
! check arm64-apple-macos11 "$work/moved.c" 2> /dev/null
