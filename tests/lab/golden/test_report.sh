#!/bin/bash
# SPDX-License-Identifier: MIT
# The evaluation end to end, small: CSV files, page, comparison. Called with the source and the build
# folder.
set -u
build=$2
. "$1/tests/support/holds.sh"

# code WANTED ARGUMENTS...: the exit code of host_sim report; its output is in $work/stdout and stderr.
# Only what hangs meets the guard's limits, however busy the machine is.
code() { ends "$1" "$build/host_sim" report --guard-time 300,300 "${@:2}"; }

small=(--quick --size 72 --lowres 24 --case E04 --case D01)

# --- the whole
code 0 "${small[@]}" --out "$work/whole"
page=$work/whole/index.html
for case in E04 D01; do
    # 11 thresholds x 4 kernels x 7 positions, and the names of the columns.
    holds [ "$(wc -l < "$work/whole/space_$case.csv")" -eq $((11 * 4 * 7 + 1)) ]
    for picture in full truth result error depthmap slices confidence common common_error; do holds [ -s "$work/whole/$case/$picture.png" ]; done
done
holds [ -z "$(find "$work/whole" -name '*.part*')" ]
# The best settings are not worse than the common ones, and those are better than nothing.
awk -F, 'NR == FNR { best[$1] = $6; next } FNR > 1 && !(best[$1] <= $6 && $6 < $11) { bad = 1 } END { exit bad }' \
    "$work/whole/best.csv" "$work/whole/common.csv"
holds [ $? -eq 0 ]
# e_abs of the best row is the lowest of its CSV file.
lowest=$(tail -n +2 "$work/whole/space_E04.csv" | cut -d , -f 6 | sort -g | head -n 1)
holds [ "$(printf %.2f "$lowest")" = "$(grep '^E04' "$work/whole/best.csv" | cut -d , -f 6)" ]

# --- the plugin as it is comes first: a head, two cases and their means
holds [ "$(wc -l < "$work/whole/plain.csv")" -eq 4 ]
awk -F, '
    NR == 2 || NR == 3 { sum += $2 / 2 }
    NR == 4 && (sum - $2 > 0.011 || $2 - sum > 0.011) { bad = 1 }
    # No map does better than the true surface, and nothing is worse than to clip nothing.
    NR > 1 && !($7 <= $2 && $2 < $6) { bad = 1 } END { exit bad }' "$work/whole/plain.csv"
holds [ $? -eq 0 ]
# What was chosen by the truth stands behind it and says so, and all parts are in the list of contents.
holds [ "$(grep -o '<h2 id="[^<]*' "$page" | sed 's/.*>//' | paste -sd '|')" = 'As it is|The settings of mean, chosen by the truth|Speed at the common setting|What the words mean' ]
holds [ "$(grep -o '<h2 id="[^<]*' "$page" | sed 's/<h2 id="//')" = "$(grep -o '<a href="#[^<]*' "$page" | sed 's/<a href="#//')" ]
# Pictures and figures come before any word is defined, and every word is.
plain=$(sed 's/data:[^"]*//g' "$page" | tr -d '\n')
first() { grep -obF -- "$1" <<< "$plain" | head -n 1 | cut -d : -f 1; }
holds [ "$(first '<img ')" -lt "$(first '<dl>')" -a "$(first '<dl>')" -lt "$(first '<table')" ]
while read -r term; do holds [ "$(first "$term")" -gt "$(first '<table')" ]; done << 'TERMS'
e_abs is the mean size of the error
e_pos is the mean of the errors above 0
T_B is the threshold
Delta_MI is the largest value of the volume
DVR is direct volume rendering
true surface is the scene
TERMS
# Full volume, result, ground truth: the order of every page.
holds [ "$(grep -o 'alt="E04: rendering[^"]*' "$page" | head -n 3 | sed 's/.*rendering of the //' | paste -sd '|')" = 'full volume|result|ground truth' ]
# --- the page: self-contained, every picture with a text, balanced tags, figures with titles
pictures=$(grep -o '<img ' "$page" | wc -l)
holds [ "$pictures" -ge $((2 * (6 + 7))) ]
holds [ "$(grep -o '<img alt="[^"][^"]*" src="data:image/\(png;base64,iVBORw0KGgo\|jpeg;base64,/9j/\)' "$page" | wc -l)" -eq "$pictures" ]
holds [ "$(grep -c 'https\?://\|<link\|url(\|src="[^d]' "$page")" -eq 0 ]
for tag in figure figcaption div table svg title g h2 h3 p label script td; do
    holds [ "$(grep -o "<$tag[ >]" "$page" | wc -l)" -eq "$(grep -o "</$tag>" "$page" | wc -l)" ]
done
# Figures 5.7 (one a case), 5.8, 5.21.
holds [ "$(grep -c '<svg class="plot" [^>]*role="img" aria-label="[^"]' "$page")" -eq 4 ]
holds [ "$(sed 's/base64,[^"]*//g' "$page" | grep -c 'nan\|inf<')" -eq 0 ]

# --- a plugin of zeros has the errors of the full volume, whatever its (missing) parameters
code 0 "${small[@]}" --out "$work/zeros" --plugin "$build/tests/plugins/zeros.so" --frames 0
awk -F, 'FNR > 1 && $6 != $11 { bad = 1 } END { exit bad }' "$work/zeros/best.csv"
holds [ $? -eq 0 ]
holds grep -q '^E04,-,-,-,-,' "$work/zeros/best.csv"
# The page and the terminal have no columns for what it does not have.
holds [ "$(grep -c 'T_B\|Delta_MI' "$work/zeros/index.html")" -eq 0 ]
holds [ "$(grep -c 'T_B' "$work/stdout")" -eq 0 ]
# As it is, it clips nothing.
awk -F, 'FNR > 1 && $2 != $6 { bad = 1 } END { exit bad }' "$work/zeros/plain.csv"
holds [ $? -eq 0 ]
# A plane has a knob, its depth, that no adjust takes.
code 0 "${small[@]}" --out "$work/plane" --plugin "$build/tests/plugins/plane.so" --frames 0
holds [ "$(wc -l < "$work/plane/space_E04.csv")" -eq $((7 + 1)) ]

# --- comparison: the plugin with its default method, a plane in the fluid, a plane behind everything, zeros, a plane at 0
plane=$build/tests/plugins/plane.so
code 0 --quick --size 144 --lowres 48 --case E04 --case D01 --out "$work/compare" --seeds 2 \
    --compare "$plane depth=60" --compare "$build/tests/plugins/zeros.so" --compare "$plane depth=0" \
    --compare "$plane depth=22" --compare "- evidence=0"
rank() { grep "  $1\$" "$work/stdout" | awk '{ print $1 }'; }
value() { grep "  $1\$" "$work/stdout" | awk -v column="$2" '{ print $column }'; }
holds [ "$(rank '- evidence=0')" -eq 1 ]
holds [ "$(rank "$plane depth=22")" -eq 2 ]
holds [ "$(rank "$plane depth=60")" -eq 3 ]
# Zeros and a plane at 0 clip nothing: the same numbers, and all of the occluder is left.
for column in 2 4 5; do
    holds [ "$(value "$build/tests/plugins/zeros.so" $column)" = "$(value "$plane depth=0" $column)" ]
done
holds [ "$(value "$plane depth=0" 5)" = 100.00 ]
# Behind everything no occluder is left, and all of the fetus is cut.
holds [ "$(value "$plane depth=60" 4)" = 100.00 ]
holds [ "$(value "$plane depth=60" 5)" = 0.00 ]
# The knob of the plane reaches the same from any start; that of zeros does not exist.
holds [ "$(value "$plane depth=60" 3)" = "$(value "$plane depth=0" 3)" ]
holds [ "$(value "$build/tests/plugins/zeros.so" 3)" = "$(value "$build/tests/plugins/zeros.so" 2)" ]
holds [ "$(wc -l < "$work/compare/compare.csv")" -eq $((1 + 5 * 2 * 2)) ]
holds grep -q '(spread [0-9.]*) \*' "$work/compare/index.html"
# Every case in pictures: full volume, ground truth, and five methods.
holds [ "$(grep -o '<img ' "$work/compare/index.html" | wc -l)" -eq $((2 * (2 + 5))) ]
for picture in full truth method_1 method_5; do holds [ -s "$work/compare/D01/$picture.png" ]; done
# A map of zeros shows the full volume.
holds cmp "$work/compare/D01/method_2.png" "$work/compare/D01/full.png"

# Every seed is another volume, of E01, too, whose own seed is 1.
code 0 --quick --size 96 --case E01 --out "$work/seeds" --seeds 2 --compare "$build/tests/plugins/zeros.so" --compare "$plane depth=22"
holds [ "$(tail -n +2 "$work/seeds/compare.csv" | cut -d, -f9 | sort -u | wc -l)" -eq 2 ]

# --- files with a ground truth: a scene's own, with a label map that says "fetus" everywhere
label() { # label NAME CHARACTER: one slice of 48 x 48 labels
    printf 'ObjectType = Image\nNDims = 3\nDimSize = 48 48 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' > "$work/$1"
    head -c $((48 * 48)) /dev/zero | tr '\0' "$2" >> "$work/$1"
}
holds "$build/host_sim" scenes D01 --size 48 --export --out "$work/scene" > /dev/null
label fetus.mha '\2'
label wrong.mha '\7'
full=$(find "$work/scene" -name 'D01*_full.mha')
truth=$(find "$work/scene" -name 'D01*_truth.mha')
# What an expert left is drawn beside the truth, as the truth is: here it is the truth.
code 0 --quick --out "$work/files" --case "$full,$truth,$work/fetus.mha,$truth" --frames 0
holds cmp "$work"/files/*/reference.png "$work"/files/*/truth.png
holds grep -qF 'Reference: what an expert left of the volume' "$work/files/index.html"
holds [ "$(grep -cF 'what an expert left' "$page")" = 0 ]
# Columns 6 and 12: e_abs of all rays and of the fetus' rays are the same.
holds [ "$(tail -n +2 "$work"/files/space_*.csv | awk -F, '$6 != $12' | wc -l)" -eq 0 ]
holds [ "$(tail -n +2 "$work"/files/space_*.csv | wc -l)" -eq $((11 * 4 * 7)) ]
code 3 --quick --out "$work/bad" --case "$full,$truth,$work/wrong.mha"
holds grep -q 'label 7' "$work/stderr"
code 3 --quick --out "$work/bad" --case "$full,$work/fetus.mha,$work/fetus.mha"
holds grep -q '48 x 48 x 1 voxels, the volume has 48 x 48 x 48' "$work/stderr"
code 2 --quick --out "$work/bad" --case "$full,$truth"
# The same with maps of what was scanned, here from slice 10 on: the measures of a map that clips everything before it.
label from.mha '\12'
label to.mha '\60'
measure() { "$build/host_sim" measure --lowres 48 --case "$@" | grep -v '"map' | tr -d ,; }
label="$(find "$work/scene" -name 'D01*_label.mha')"
holds [ "$(measure "$full,$truth,$label,$work/from.mha,$work/to.mha" -)" = "$(measure "$full,$truth,$label" "$work/from.mha")" ]
holds [ "$(measure "$full,$truth,$label" -)" != "$(measure "$full,$truth,$label" "$work/from.mha")" ]
code 0 --quick --out "$work/ranged" --case "$full,$truth,$work/fetus.mha,$work/from.mha,$work/to.mha" --frames 0
holds [ "$(tail -n +2 "$work"/ranged/space_*.csv | wc -l)" -eq $((11 * 4 * 7)) ]
holds [ "$(tail -n +2 "$work"/ranged/space_*.csv | cmp -s - <(tail -n +2 "$work"/files/space_*.csv); echo $?)" = 1 ]
code 3 --quick --out "$work/bad" --case "$full,$truth,$label,$work/to.mha,$work/from.mha"
holds grep -q 'to.mha: pixel (0, 0) is 48, behind 10 in ' "$work/stderr"
code 3 --quick --out "$work/bad" --case "$full,$truth,$label,$work/to.mha"
holds grep -q 'to.mha: 48 x 48 x 1 voxels, the volume has 48 x 48 x 48' "$work/stderr"
code 2 --quick --out "$work/bad" --case "$full,$truth,$label,$work/from.mha,$work/to.mha,$truth,$truth"
# Occluders before a given volume, which is its own ground truth.
code 0 --quick --out "$work/real" --real "$truth" --frames 0
holds [ -s "$work/real/space_real.csv" ]

# --- command lines that are wrong
code 2 --case E01 extra
code 2 --size 8
code 2 --quick --case D01 --out "$work/bad" --set kernel=4
code 3 --quick --case nowhere --out "$work/bad"
code 4 --quick --case D01 --out "$work/bad" --plugin "$build/tests/plugins/no_symbol.so"
code 6 --quick --case D01 --out /dev/null/report

[ $failed -eq 0 ]
