#!/bin/bash
# SPDX-License-Identifier: MIT
# sv_judge end to end on small cases that scenes export: every command, foreign files, wrong ones. Called with the source and
# the build folder.
set -u
build=$2
. "$1/tests/support/holds.sh"

# code WANTED ARGUMENTS...: the exit code of sv_judge; its output is in $work/stdout and stderr.
code() { ends "$1" "$build/sv_judge" "${@:2}"; }

# map NAME SIDE CHARACTER: one slice of SIDE x SIDE bytes.
map() {
    printf 'ObjectType = Image\nNDims = 3\nDimSize = %d %d 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' "$2" "$2" > "$1"
    head -c $(($2 * $2)) /dev/zero | tr '\0' "$3" >> "$1"
}

# export SCENE SIZE: the scene's files, as FULL,TRUTH,LABEL.
export_scene() {
    "$build/host_sim" scenes "$1" --size "$2" --export --out "$work/$1_$2" > /dev/null 2>&1 || return 1
    echo "$(find "$work/$1_$2" -name '*_full.mha'),$(find "$work/$1_$2" -name '*_truth.mha'),$(find "$work/$1_$2" -name '*_label.mha')"
}

case=$(export_scene E04 64)
holds [ -n "$case" ]

# --- the table: what clips nothing has the error that host_sim measures, by another renderer, of a map that clips nothing
code 0 table --case "$case" --method 'method=mean evidence=1 min_gap=64'
found=$(sed -n 's/^.*min_gap=64 *\([0-9.]*\) \/.*no confidence  1 refused$/\1/p' "$work/stdout")
steps=$("$build/host_sim" measure --case "$case" --lowres 64 - | sed -n 's/.*"e_abs": \([0-9.]*\),/\1/p')
holds awk -v found="$found" -v steps="$steps" 'BEGIN { d = found - steps * 128 / 64; exit !(steps > 1 && d < 0.05 && d > -0.05) }'

# --- the methods: all are there, the best q is not worse than the default's, a confidence has an AUC and its calibration
code 0 table --case "$case" --method 'best method=mean' --method method=mean --method method=wall
error_of() { grep -- "$1" "$work/stdout" | head -n 1 | sed 's/^ *method[^ ]*\(, best q = [0-9.]*\)\? *//; s/ .*//'; }
holds awk -v best="$(error_of 'best q = ')" -v given="$(error_of 'method=mean  ')" 'BEGIN { exit !(best != "" && given != "" && best <= given) }'
holds grep -q 'method=wall .* AUC [01]\.[0-9]* (cut' "$work/stdout"
holds grep -q 'method=wall: it says / right' "$work/stdout"
# With maps that say that all was scanned, the zeros around the fan are black fluid: another answer.
map "$work/from.mha" 64 '\0'
map "$work/to.mha" 64 '@'
code 0 table --case "$case,$work/from.mha,$work/to.mha" --method method=wall
cp "$work/stdout" "$work/mapped"
code 0 table --case "$case" --method method=wall
holds [ "$(cmp -s "$work/stdout" "$work/mapped"; echo $?)" = 1 ]
expected=$(error_of 'method=wall  ')

# --- no harm: four variants of every method; bare, nothing is cut by method wall
code 0 harm --case "$case" --method method=wall --method method=mean
holds [ "$(grep -c 'method=wall  *. of   1 refused' "$work/stdout")" -eq 4 ]
holds [ "$(grep -c '^  bare, .*method=wall .* 0 cut above 2 %' "$work/stdout")" -eq 2 ]

# --- flicker of a sequence of files: the same frame twice does not flicker
code 0 flicker --case "$case" --case "$case" --method method=wall
holds grep -q '^  files, 2 frames: the truth moves by 0.00' "$work/stdout"
holds grep -q '^    method=wall  *+0.00 ' "$work/stdout"
holds [ "$(grep -c 'the truth moves' "$work/stdout")" -eq 1 ]

# --- scans: with nothing told a set has the table's error; a volume that is refused is hidden straight on by what its labels call tissue
code 0 scans --case "$case"
beams=$(sed -n 's/^  method=wall *beams .* \([0-9.]*\) slices .*/\1/p' "$work/stdout")
holds [ "$(grep -c '^  method=wall ' "$work/stdout")" -eq 3 ]
holds [ -n "$expected" ] && holds grep -q "^  method=wall *nothing .* $expected slices " "$work/stdout"
IFS=, read -r full _ <<< "$(export_scene E01 32)"
printf 'ObjectType = Image\nNDims = 3\nDimSize = 32 32 32\nElementSpacing = 3.75 3.75 3.75\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' > "${full%.mha}_label.mha"
{ head -c 16384 /dev/zero | tr '\0' '\1'; head -c 16384 /dev/zero | tr '\0' '\3'; } >> "${full%.mha}_label.mha"
code 0 scans --volume "$full" --method 'method=mean evidence=1 min_gap=64'
holds [ "$(grep -c '^  to 20 degrees .* 0 / *0 / *9 .* cut *0.00 % .* worst 100.0$' "$work/stdout")" -eq 3 ]
holds [ "$(grep -c '^  orbit .* changes 0 times' "$work/stdout")" -eq 3 ]

# --- marks: without one the error is that of `scans`; it falls and never grows; where nothing is clipped there are none
code 0 marks --volume "$full" --method 'method=mean evidence=1 min_gap=64'
holds grep -qE ' 9 +([0-9.]+ .*[1-9])  [|] +\1  [|] +\1  [|] +\1  mm$' "$work/stdout"
rm "${full%.mha}_label.mha"
code 3 marks --volume "$full"
code 0 marks --case "$case"
holds awk -v expected="$beams" '/ slices$/ { gsub(/[|\/]/, " "); e = $(NF - 12); a = $(NF - 9); b = $(NF - 6); c = $(NF - 3)
    exit !(expected != "" && e - expected < 0.02 && expected - e < 0.02 && a < e && b <= a && c <= b) }' "$work/stdout"

# --- a folder and files are two sites
small=$(export_scene D01 32)
IFS=, read -r full truth label <<< "$small"
mkdir "$work/site"
for name in E01 M01; do
    cp "$full" "$work/site/${name}_full.mha"
    cp "$truth" "$work/site/${name}_truth.mha"
    cp "$label" "$work/site/${name}_label.mha"
done
map "$work/site/scan_first.mha" 32 '\0'
map "$work/site/scan_end.mha" 32 ' '
code 0 wall --site "$work/site" --case "$(export_scene E04 32)"
holds [ "$(grep -c '^  all ' "$work/stdout")" -eq 2 ]
holds [ "$(grep -cE '^  (E01|M01) ' "$work/stdout")" -eq 2 ]

# --- what is wrong
code 2
code 2 nothing
holds grep -q "'nothing' is no command" "$work/stderr"
code 2 table --nothing
code 2 table --scenes 1
code 2 table --random 7,0
code 2 table --case "$full"
holds grep -q 'FULL,TRUTH,LABEL' "$work/stderr"
code 3 table --site "$work/nowhere"
holds grep -q 'nowhere: there is no NAME_full.mha' "$work/stderr"
code 3 table --case "$full,$truth,$truth"
holds grep -q 'labels, expected 32 x 32 x 1' "$work/stderr"
code 3 table --case "$small,$work/from.mha,$work/to.mha"
holds grep -q 'from.mha:[0-9]*: DimSize is 64 64 1, expected 32 32 1' "$work/stderr"
code 4 table --case "$small" --plugin "$build/tests/plugins/no_symbol.so"
code 2 table --case "$small" --method method=wall --plugin "$build/tests/plugins/zeros.so"

# --- the definition of wall: its table, a turned camera, another constant, wrong ones
code 0 wall --case "$small"
holds grep -q '^  all ' "$work/stdout"
cp "$work/stdout" "$work/as_it_is"
code 0 wall --case "$small" --set fetus_level=0
holds [ "$(cmp -s "$work/stdout" "$work/as_it_is"; echo $?)" = 1 ]
for beams in 0 1; do # limits are heeded by cases and by volumes, by a camera and along the beams
    code 0 wall --case "$small" --volume "$full" --set seen_share=1 --set clear_share=2 --set beams=$beams
    holds [ "$(grep -c 'outcome 3,' "$work/stdout")" -eq 2 ]
done
code 0 wall --tilt 10,-5 --case "$small"
holds grep -q ' 10,-5 .*outcome 0' "$work/stdout"
for wrong in 1 50,0 0,x 1,2,3; do
    code 2 wall --tilt "$wrong" --case "$small"
    holds grep -q -- "--tilt: '$wrong' is no X,Y of -45 to 45 degrees" "$work/stderr"
done
for wrong in fetus_level fetus_level=x nothing=1; do
    code 2 wall --set "$wrong" --case "$small"
    holds grep -q -- '^sv_judge: --set: ' "$work/stderr"
done

[ $failed -eq 0 ]
