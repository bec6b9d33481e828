#!/bin/bash
# SPDX-License-Identifier: MIT
# test_call_rule.sh SOURCE_FOLDER BUILD_FOLDER: no sources and no folders of this build call each other in a circle, and
# scripts/check_calls.sh notices such circles.
set -eu
check=$1/scripts/check_calls.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bash "$check" "$2"

# compiled PATH LINE: as an object of a build.
compiled() {
    local object=$work/obj/${1%/*}/CMakeFiles/x.dir/${1##*/}.o
    mkdir -p "${object%/*}"
    cc -x c -c -o "$object" - <<< "$2"
}
# said TEXT: the check fails, and says this.
said() {
    if output=$(bash "$check" "$work") || ! grep -qF "$1" <<< "$output"; then
        echo "not noticed: $1"
        exit 1
    fi
}

compiled src/low/a.c 'int a(void) { return 0; }'
compiled src/high/b.c 'int a(void); int b(void) { return a(); }'
bash "$check" "$work"
compiled src/low/c.c 'int b(void); int c(void) { return b(); }'
said "src/low: in a circle of folders"
compiled src/low/a.c 'int c(void); int a(void) { return c(); }'
said "src/low/a.c: in a circle of sources"
