#!/bin/bash
# SPDX-License-Identifier: MIT
# host_sim measure: maps from elsewhere are measured as the report measures a plugin's, and bad ones are named.
# Called with the source and the build folder.
set -u
host_sim=$2/host_sim
# shellcheck source=tests/support/holds.sh
. "$1/tests/support/holds.sh"
cd "$work" || exit 1

# map FILE SIDE BYTES: a float32 map of SIDE x SIDE that holds one value, given as four octal escapes.
map() {
    printf 'ObjectType = Image\nNDims = 3\nDimSize = %s %s 1\nElementType = MET_FLOAT\nElementSpacing = 1 1 1\nElementDataFile = LOCAL\n' \
        "$2" "$2" > "$1"
    for ((i = 0; i < $2 * $2; i++)); do printf '%b' "$3"; done >> "$1"
}
case=(--case D01 --size 64 --lowres 32)
map zero.mha 32 '\0000\0000\0000\0000'   # 0: clips nothing
map behind.mha 32 '\0000\0000\0170\0102' # 62: behind everything
map other.mha 16 '\0000\0000\0000\0000'
map nan.mha 32 '\0000\0000\0300\0177'
map far.mha 32 '\0000\0000\0310\0102' # 100: beyond twice the volume

"$host_sim" measure "${case[@]}" - zero.mha behind.mha > out.json
holds [ $? -eq 0 ]
value() { grep "\"$1\"" out.json | sed -n "${2}s/.*: \([0-9.e+-]*\),*/\1/p"; }
holds [ "$(value e_abs 1)" = "$(value e_abs 2)" ]
holds [ "$(value occluder_left 1)" = 1.0 ]
holds [ "$(value occluder_left 3)" = 0.0 ]
holds [ "$(value fetus_cut 3)" = 1.0 ]
# a map behind everything is not free beside the sac either
holds [ "$(value e_abs_outside 2)" = "$(value e_abs_outside 1)" ]
holds [ "$(value e_abs_outside 3 | cut -d. -f1)" -gt 5 ]

refused() { # refused CODE WORDS ARGUMENTS...
    local code=$1 words=$2
    shift 2
    "$host_sim" measure "$@" > /dev/null 2> err
    holds [ $? -eq "$code" ]
    holds grep -qF -- "$words" err
}
refused 2 "no depthmap was given" "${case[@]}"
refused 2 "--size: 7 is outside" --size 7 -
refused 2 "--colour: not an option" --colour
refused 2 "--size: is for scenes, --case a,b,c names files" --case a,b,c --size 64 -
refused 2 "--seed: is for scenes, --case a,b,c names files" --case a,b,c --seed 2 -
refused 2 "--real x.mha: is for --case real, not E01" --case E01 --real x.mha -
refused 3 "none.mha" "${case[@]}" none.mha
refused 3 "other.mha" "${case[@]}" other.mha
refused 3 "voxel (0, 0, 0)" "${case[@]}" nan.mha
refused 3 "far.mha: the depth of pixel (0, 0) is 100, expected twice 32 slices at most" "${case[@]}" far.mha
refused 3 "Z99" --case Z99 -

# Kretz files with their truth and labels: what clips nothing leaves all occluders, what clips all cuts all of the fetus.
"$host_sim" scenes D01 --size 64 --export --format vol --out vol > /dev/null
files=vol/D01_full.vol,vol/D01_truth.vol,vol/D01_label.mha
"$host_sim" measure --case "$files" --lowres 32 - behind.mha > out.json
holds [ $? -eq 0 ]
holds [ "$(value occluder_left 1)" = 1.0 ]
holds [ "$(value fetus_cut 2)" = 1.0 ]
holds [ "$(value occluder_left 2)" = 0.0 ]
refused 3 "vol/D01_truth.vol: is a Kretz file; host_sim reads MetaImage (.mha, .mhd): labels and maps come in no other format" \
    --case vol/D01_full.vol,vol/D01_truth.vol,vol/D01_truth.vol --lowres 32 -
echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
