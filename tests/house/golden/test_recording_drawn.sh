#!/bin/bash
# SPDX-License-Identifier: MIT
# A frame of a recording goes to files and is drawn by the machine: with the very map that was played, to a hundredth of a millimetre.
# Called with the source and the build folder.
set -u
build=$2
# shellcheck source=tests/support/holds.sh
. "$1/tests/support/holds.sh"
run() { "$build/host_sim" run --picture 64 --setting smartvis --frames 1 "$@" > "$work/said" 2>&1 || { cat "$work/said"; false; }; }

SMARTVIS_CHECK_PLUGIN=$build/smartvis.so SMARTVIS_RECORD=$work/turn.svr holds run --scene E02 --size 64 --yaw 20 --no-guard \
    --plugin "$build/smartvis_check.so" --out "$work/recorded"
holds "$build/sv_replay" "$work/turn.svr" --out "$work/frame" > "$work/played"
cat "$work/played"
drawn=$(sed -n 's/^frame [0-9]* is in .*; to draw it: host_sim run //p' "$work/played")
# shellcheck disable=SC2086 # options are words, and the folder's name has none between
holds run $drawn --out "$work/drawn" --write depthmap
holds test -s "$work/drawn/panel.png"
holds python3 - "$work/frame/map.mha" "$work/drawn/depthmap.mha" << 'EOF'
import array, re, sys
def read(path):
    with open(path, "rb") as file:
        head, _, data = file.read().partition(b"ElementDataFile = LOCAL\n")
    return array.array("f", data), float(re.search(rb"ElementSpacing = \S+ \S+ (\S+)", head)[1])
(played, slice_mm), (drawn, _) = read(sys.argv[1]), read(sys.argv[2])
clipped = sum(mm > 0 for mm in played)
worst = max(abs(mm - (slice_mm / 2 if mm > 0 else 0) - got) for mm, got in zip(played, drawn, strict=True))
print(f"{clipped} of {len(played)} rays clipped, {worst:.6f} mm apart at most")
sys.exit(not (clipped > len(played) / 4 and worst < 0.01))
EOF
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
