#!/bin/bash
# SPDX-License-Identifier: MIT
# host_sim run --write, --view and --probe, and info, at the command line: files that are there and what they say, and
# exit codes with a message that names the thing. Called with the source and the build folder.
set -u
build=$2
host_sim=$build/host_sim
. "$1/tests/support/holds.sh"
cd "$work" || exit 1

# expect CODE WORDS ARGUMENTS...: host_sim ends with CODE, and what it prints holds WORDS.
expect() {
    local code=$1 words=$2
    shift 2
    checked=$((checked + 1))
    "$host_sim" "$@" > out.txt 2>&1
    local got=$?
    if [ $got -ne "$code" ] || ! grep -qF -- "$words" out.txt; then
        echo "FAIL: host_sim $*: exit code $got, expected $code and '$words':"
        cat out.txt
        failed=$((failed + 1))
    fi
}

# make_volume FILE LINES: 24^3 voxels with more lines in the header.
make_volume() {
    printf 'ObjectType = Image\nNDims = 3\nDimSize = 24 24 24\n%bElementType = MET_UCHAR\nElementDataFile = LOCAL\n' "$2" > "$1"
    head -c 13824 /dev/zero | tr '\0' '\310' >> "$1"
}
make_volume plain.mha 'ElementSpacing = 1 1 2\n'
make_volume lying.mha 'TransformMatrix = -1 0 0 0 0 1 0 1 0\nOffset = 1 2 3\n'
make_volume doubt.mha 'TransformMatrix = 1 0 0 0 1 0 0 0 1\nAnatomicalOrientation = LPI\n'
make_volume mirror.mha 'TransformMatrix = -1 0 0 0 1 0 0 0 1\n'
make_volume letters.mha 'AnatomicalOrientation = LPI\n'

run=(run --frames 1 --setting smartvis --picture 32 --panel 64 --lowres 48 --out out --plugin "$build/tests/plugins/plane.so" --set depth=2)

# ------------------------------------------------------------------------------------------ a reference
expect 0 "Results: depthmap.mha" "${run[@]}" --volume plain.mha --write depthmap
holds mv out/depthmap.mha kept.mha
expect 0 "Reference kept.mha: 0 of 2304 rays differ by more than 0 mm" "${run[@]}" --volume plain.mha --reference kept.mha
holds [ "$(cat out/differences.csv)" = x,y,reference_mm,depth_mm,difference_mm ]
# One slice is 0.5 mm; the tilted plane goes one slice deeper a pixel.
expect 0 "0 of 2304 rays differ by more than 0.5 mm" "${run[@]}" --volume plain.mha --reference kept.mha --tolerance 0.5 --set depth=3
expect 1 "2304 of 2304 rays differ by more than 0.4 mm, the most by 0.5 mm at (0, 0): differences.csv" \
    "${run[@]}" --volume plain.mha --reference kept.mha --tolerance 0.4 --set depth=3
expect 1 "2256 of 2304 rays differ by more than 0 mm, the most by 23.5 mm at (47, 0): differences.csv" \
    "${run[@]}" --volume plain.mha --reference kept.mha --set shape=tilted --json run.json
holds [ "$(wc -l < out/differences.csv)" = 2257 ]
holds grep -qx '5,0,1,3.5,2.5' out/differences.csv
holds grep -q '"different": 2256' run.json
expect 2 "--tolerance 1: is for --reference" "${run[@]}" --volume plain.mha --tolerance 1
expect 2 "--reference: needs a camera that stands still" "${run[@]}" --volume plain.mha --reference kept.mha --orbit 10
expect 2 "is one map, and the source has 2 volumes" "${run[@]}" --volume plain.mha --volume plain.mha --reference kept.mha
expect 3 "--reference none.mha: cannot be read: No such file" "${run[@]}" --volume plain.mha --reference none.mha
expect 3 "plain.mha:3: DimSize is 24 24 24, expected 48 48 1" "${run[@]}" --volume plain.mha --reference plain.mha
expect 4 "2304 of 2304 rays differ" "${run[@]}" --volume plain.mha --reference kept.mha --set fail=end

# ------------------------------------------------------------------------------------------ orientation
expect 0 "in the patient: not said" info plain.mha
expect 0 "beams: unknown; nobody says where the probe was" info plain.mha
expect 0 "Beams    parallel, from +y" "${run[@]}" --volume plain.mha --probe +y
expect 0 "in the patient: x to the right, y to the head, z to the back (LIA)" info lying.mha
expect 0 "first voxel at (1, 2, 3) mm (left, back, head)" info lying.mha
expect 0 "AnatomicalOrientation says LPI instead: only TransformMatrix counts" info doubt.mha
expect 0 "the axes are left-handed" info mirror.mha
expect 0 "AnatomicalOrientation says LPI instead: only TransformMatrix counts" info letters.mha
expect 3 "letters.mha: does not say how it lies in the patient" "${run[@]}" --volume letters.mha --view anterior
expect 0 "Camera   from anterior, yaw 0" "${run[@]}" --volume lying.mha --view anterior
expect 0 "Patient  x to the right, y to the head, z to the back" "${run[@]}" --volume lying.mha
expect 0 "AnatomicalOrientation says LPI instead: only TransformMatrix counts" "${run[@]}" --volume doubt.mha
expect 0 "Camera   from the probe at +y" "${run[@]}" --volume plain.mha --probe +y
expect 3 "plain.mha: does not say how it lies in the patient" "${run[@]}" --volume plain.mha --view left
expect 2 "--view: 'above' is none of probe, anterior, posterior, left, right, superior, inferior" "${run[@]}" --volume lying.mha --view above
expect 2 "--probe: 'y' is none of -z, +z, -y, +y, -x, +x" "${run[@]}" --volume plain.mha --probe y
expect 2 "--probe +x: is for --volume" "${run[@]}" --scene D01 --size 32 --probe +x
make_volume turned.mha 'ElementSpacing = 1 1 2\nTransformMatrix = -1 0 0 0 0 1 0 1 0\n'
expect 3 "turned.mha: lies otherwise in the patient than plain.mha" "${run[@]}" --volume plain.mha --volume turned.mha

expect 0 "in the pictures: patient's right at the right, feet at the top" "${run[@]}" --few-pictures --volume lying.mha
expect 0 "in the pictures: patient's left at the right, head at the top" "${run[@]}" --few-pictures --volume lying.mha --view anterior

# ---------------------------------------------------------------------------------------------- results
rm -rf out
expect 0 "Results: depthmap.mha, status.mha, clipped.mha, mask.mha, surface.ply; what is cut away became 0" "${run[@]}" --volume plain.mha --write all --json r.json
for file in depthmap.mha status.mha clipped.mha mask.mha surface.ply; do holds [ -s "out/$file" ]; done
holds [ ! -e out/confidence.mha ]
for words in '"carrier": "buffer"' '"outcome": "SV_OK"' '"probe": null' '"beams": "unknown' '"from": "probe"' '"what":'; do
    holds grep -qF "$words" r.json
done
holds [ "$(tr -d ' \n' < r.json | grep -oF '"source_size_mm":[24.0,24.0,48.0]')" ]
rm -rf out
expect 0 "Results: mask.mha" "${run[@]}" --volume plain.mha --write mask
holds [ -s out/mask.mha ]
holds [ ! -e out/clipped.mha ]
expect 0 "were not scanned" info out/mask.mha
expect 0 "confidence.mha" "${run[@]}" --plugin "$build/tests/plugins/confidence_ramp.so" --volume plain.mha --write confidence,depthmap
holds [ -s out/confidence.mha ]
expect 0 "sequences of 2 volumes" "${run[@]}" --volume plain.mha --volume plain.mha --write clipped,surface
holds grep -aqxF "DimSize = 24 24 24 2" out/clipped.mha
holds [ -s out/surface_0001.ply ]
expect 0 "a sequence of 2 volumes" info out/clipped.mha
expect 0 "Clipped although doubtful (14 %, sure from 30 %): the fetus may be cut." "${run[@]}" --plugin "$build/tests/plugins/confidence_doubtful.so" --volume plain.mha
rm -rf out
expect 4 "confidence: the plugin gave none" "${run[@]}" --volume plain.mha --write confidence,mask
holds [ ! -e out/mask.mha ]
expect 4 "nothing is cut away in 1" "${run[@]}" --volume plain.mha --write mask --set fail=end
expect 2 "--write: 'depth' is none of depthmap, confidence, status, clipped, mask, surface, or all" "${run[@]}" --volume plain.mha --write depth
expect 2 "--write: needs a camera that stands still, --orbit is 60 degrees" "${run[@]}" --volume plain.mha --write mask --orbit 60
mkdir -p out2/mask.mha
expect 6 "out2/mask.mha: cannot be written" "${run[@]}" --volume plain.mha --out out2 --write mask
holds [ -z "$(find "$work" -name '*.tmp*')" ]

# ------------------------------------------------------------------------------------------ other formats
printf 'NRRD0004\n# x\n' > a.mha
expect 3 "a.mha: is an NRRD file; host_sim reads MetaImage (.mha, .mhd): 'smartvis clip' of the Python package reads it" info a.mha
printf 'NDims = 3\nDimSize = 24 24 24\nKinds = domain domain list\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' > b.mha
head -c 13824 /dev/zero | tr '\0' '\310' >> b.mha
expect 3 "b.mha:3: Kinds: this is a sequence of pictures" "${run[@]}" --volume b.mha

echo "$checked checks, $failed failed"
[ $failed -eq 0 ]
