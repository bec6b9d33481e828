#!/bin/bash
# SPDX-License-Identifier: MIT
# Files, names and streams that come from anywhere: what they must not do to the terminal, to other folders and to the
# program. Called with the source and the build folder.
# Requirement: R12.
set -u
source=$1
build=$2
host_sim=$build/host_sim
. "$1/tests/support/holds.sh"
cd "$work" || exit 1

# clean FILE: no control characters but newlines.
clean() { ! LC_ALL=C grep -qP '[\x00-\x09\x0b-\x1f\x7f]|\xc2[\x80-\x9f]' "$1"; }
volume() { # NAME SPACING FIELD...: 16^3 voxels
    local name=$1 spacing=$2
    shift 2
    { printf 'ObjectType = Image\nNDims = 3\nDimSize = 16 16 16\nElementType = MET_UCHAR\nElementSpacing = %s\n' "$spacing"
        printf '%s\n' "$@"; } > "$name"
}

# ---- control characters
escape=$(printf 'x\033]0;title\007\302\233.mha')
expect 3 'x\x1b]0;title\x07\xc2\x9b.mha: cannot be read' info "$escape"
holds clean stderr
expect 2 '\x1b]0;title' "$escape"
holds clean stderr
sed "s/\"title\": *\"/&a\\\\u001b[31mb/" "$source/data/scenes/E01.json" > esc.json
expect 3 'esc.json: title: has a control character' scenes ./esc.json --size 32
holds clean stdout
holds clean stderr
for mode in --guard --no-guard; do
    "$host_sim" list --plugin "$build/wrong/param_key_blank.so" $mode > stdout 2> stderr
    holds grep -qF '\x1b' stdout
    holds clean stdout
    "$host_sim" list --plugin "$build/wrong/name_not_utf8.so" $mode > stdout 2> stderr
    holds iconv -f UTF-8 -t UTF-8 -o iconv.out stdout
done

# ---- names that leave the folder
for name in ../evil /tmp/evil .hidden a/b '' 'a:b' '..\evil' C:evil NUL nul.txt 'con .x' COM1 lpt9.raw 'CONIN$' 'a.' 'a ' 'a*b'; do
    sed "s|\"name\": *\"[^\"]*\"|\"name\": \"${name//\\/\\\\\\\\}\"|" "$source/data/scenes/E01.json" > evil.json
    expect 3 "evil.json: name: is '$name', expected a part of a file's name" scenes ./evil.json --export --out out/deep
done
holds [ -z "$(find . -name '*evil*.mha')" ]
# ---- what waits for ever
mkfifo pipe.json
expect 3 "pipe.json: cannot be read: not a regular file" run --scene ./pipe.json

# ---- a spacing that is the file's fault
head -c 4096 /dev/zero > near.raw
volume good.mhd "1 1 1" "ElementDataFile = near.raw"
volume flat.mhd "0.001 1 1" "ElementDataFile = near.raw"
expect 3 "flat.mhd: voxels of 0.001 x 1 x 1 mm" run --volume flat.mhd --frames 1 --out out

# ---- an output that is full
if [ -w /dev/full ]; then
    for arguments in "--version" "--help" "list" "info good.mhd" "scenes"; do
        # shellcheck disable=SC2086
        "$host_sim" $arguments > /dev/full 2> stderr
        holds [ $? -eq 6 ]
        holds grep -q "the standard output cannot be written: No space left on device" stderr
    done
    for tool in sv_bench sv_replay; do
        [ -x "$build/$tool" ] || continue # some are not in every build
        "$build/$tool" --help > /dev/full 2> stderr
        holds [ $? -eq 6 ]
        holds grep -q "^$tool: the standard output cannot be written: No space left on device" stderr
    done
fi

# ---- the guard's own command is nobody else's
expect 2 "is started by host_sim itself" guard-child
expect 2 "--guard-time: '1x' is not a number" list --guard-time 1x
expect 2 "--guard-time: 0 is outside" list --guard-time 5,0
expect 2 "--guard-memory: 1 is outside 16 .." list --guard-memory 1
# On by default for a library that is not the host's own: what its constructor does is told.
expect 4 "exit_in_constructor.so: left by exit(0) in dlopen" list --plugin "$build/wrong/exit_in_constructor.so"
expect 5 "a library ended it: the plugin" list --plugin "$build/wrong/exit_in_constructor.so" --no-guard
holds [ ! -s stdout ]
if [ "${SV_SANITIZE:-0}" = 0 ]; then # a sanitizer makes an exit of a crash
    expect 4 "crash_in_constructor.so: crashed: SIGSEGV in dlopen" list --plugin "$build/wrong/crash_in_constructor.so"
    "$host_sim" list --plugin "$build/wrong/crash_in_constructor.so" --no-guard > stdout 2> stderr
    holds [ $? -gt 128 ]
fi

echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
