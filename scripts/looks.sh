#!/bin/bash
# SPDX-License-Identifier: MIT
# looks.sh BUILD_FOLDER OUT [VOLUME...]: before and after, side by side. Draws the nine cases in the thesis' look and in the lit
# one, and every VOLUME (a scan file) from four sides, and puts them together as OUT/looks.jpg: the thesis' look above, the lit
# one below. Needs ImageMagick (scripts/packages-looks.txt). SIZE: voxels per axis of the cases; PICTURE: pixels of a picture.
set -eu
[ $# -ge 2 ] || { echo "usage: looks.sh BUILD_FOLDER OUT [VOLUME...]" >&2; exit 2; }
command -v montage > /dev/null || { echo "looks.sh: there is no montage: install imagemagick" >&2; exit 3; }
host_sim=$1/host_sim out=$2
shift 2
size=${SIZE:-256} picture=${PICTURE:-216}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"

# draw LOOK NAME PICTURE ARGUMENTS...: PICTURE (without its ending) of a run, as $work/LOOK_NAME.png.
draw() {
    local look=$1 name=$2 what=$3
    shift 3
    "$host_sim" run "$@" --look "$look" --frames 1 --picture "$picture" --out "$work/run" > "$work/log" ||
        { cat "$work/log" >&2; exit 1; }
    mv "$work/run/$what.png" "$work/${look}_$name.png"
}

# row FILE NAME...: both looks of the names, one above the other.
row() {
    local file=$1 look
    local -a pictures=()
    shift
    for look in thesis lit; do
        for name in "$@"; do pictures+=("$work/${look}_$name.png"); done
    done
    montage -background '#181818' -geometry +2+2 -tile "$#x2" "${pictures[@]}" "$file"
}

cases=(E01 E02 E03 E04 M01 M02 M03 D01 D02)
for name in "${cases[@]}"; do
    for look in thesis lit; do draw "$look" "$name" result --scene "$name" --size "$size" --setting smartvis; done
done
row "$work/row_0.png" "${cases[@]}"
rows=("$work/row_0.png") names=()
for volume in "$@"; do
    for yaw in 0 90 180 -90; do
        name=$(basename "${volume%.*}")_$yaw
        for look in thesis lit; do draw "$look" "$name" full --volume "$volume" --yaw "$yaw" --setting dvr; done
        names+=("$name")
    done
done
if [ ${#names[@]} -gt 0 ]; then
    row "$work/row_1.png" "${names[@]}"
    rows+=("$work/row_1.png")
fi
convert -background '#181818' "${rows[@]}" -append -quality 85 "$out/looks.jpg"
echo "$out/looks.jpg"
