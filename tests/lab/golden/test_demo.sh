#!/bin/bash
# SPDX-License-Identifier: MIT
# The demo end to end, small: its pictures and its page. Called with the source and the build folder.
set -u
build=$2
. "$1/tests/support/holds.sh"

# A file to stand for a real volume: a layer, fluid, and a bright ball behind it.
mkdir -p "$work/data/real"
printf 'ObjectType = Image\nNDims = 3\nDimSize = 32 32 32\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nElementDataFile = LOCAL\n' \
    > "$work/data/layers.mha"
{
    head -c $((32 * 32 * 6)) /dev/zero | tr '\0' '\220'
    head -c $((32 * 32 * 14)) /dev/zero | tr '\0' '\005'
    head -c $((32 * 32 * 12)) /dev/zero | tr '\0' '\360'
} >> "$work/data/layers.mha"

# The same as the real fetus.
cp "$work/data/layers.mha" "$work/data/real/fetus_12w.mha"

# And one in the geometry of a probe.
"$build/host_sim" scenes D01 --size 32 --export --format vol --out "$work/vol" > /dev/null
mv "$work/vol/D01_truth.vol" "$work/data/probe.vol"

"$build/host_sim" demo --quick --picture 128 --out "$work/demo" --data "$work/data" > "$work/stdout" 2> "$work/stderr"
code=$?
if [ $code -ne 0 ]; then
    echo "FAIL: exit code $code"
    cat "$work/stderr"
    exit 1
fi
page=$work/demo/index.html
# What is waited for is said before the first case is.
holds [ "$(grep -n 'OpenCL compiles' "$work/stderr" | cut -d : -f 1)" = 1 ]
for case in example D01 E01 E02; do
    for picture in result full truth panel slices depthmap confidence; do holds [ -s "$work/demo/$case/$picture.png" ]; done
    # The rendering of the ground truth differs from the full volume's: something hides the fetus.
    holds [ "$(cmp -s "$work/demo/$case/full.png" "$work/demo/$case/truth.png"; echo $?)" = 1 ]
    # And the plugin takes some of it away.
    holds [ "$(cmp -s "$work/demo/$case/full.png" "$work/demo/$case/result.png"; echo $?)" = 1 ]
done
# Width and height in the PNG's head: as --picture says.
holds [ "$(od -An -tu1 -j 16 -N 8 "$work/demo/D01/result.png")" = "   0   0   0 128   0   0   0 128" ]
holds [ -s "$work/demo/layers_mha/panel.png" ]
holds [ ! -e "$work/demo/layers_mha/truth.png" ]
holds [ -s "$work/demo/hidden_layers_mha/truth.png" ]
holds [ -s "$work/demo/probe_vol/panel.png" ]
holds [ -s "$work/demo/hidden_probe_vol/truth.png" ]

# Self-contained: every picture is inlined and has a text; nothing is loaded from elsewhere; no script.
pictures=$(grep -o '<img ' "$page" | wc -l)
# One of the files has no surface, and so no confidence.
holds [ "$pictures" -eq $((6 * 6 + 2 * 5 + 5 - 1)) ]
holds [ "$(grep -o '<img alt="[^"][^"]*" src="data:image/\(png;base64,iVBORw0KGgo\|jpeg;base64,/9j/\)' "$page" | wc -l)" -eq "$pictures" ]
holds [ "$(grep -c 'https\?://\|<script\|<link\|url(' "$page")" -eq 0 ]
holds grep -q 'name="viewport"' "$page"
# The first PNG, taken out of the page again, is the file; renderings are JPEG, whole ones: they end with its mark.
grep -o -m 1 'png;base64,[^"]*' "$page" | head -n 1 | cut -d , -f 2 | base64 -d > "$work/first.png"
holds cmp "$work/first.png" "$work/demo/fetus_12w_mha/depthmap.png"
grep -o -m 1 'jpeg;base64,[^"]*' "$page" | head -n 1 | cut -d , -f 2 | base64 -d > "$work/first.jpeg"
holds [ "$(tail -c 2 "$work/first.jpeg" | od -An -tx1)" = " ff d9" ]
# Tags are balanced.
for tag in figure figcaption div table details pre p h2 nav ul li a dl dt dd; do
    holds [ "$(grep -o "<$tag[ >]" "$page" | wc -l)" -eq "$(grep -o "</$tag>" "$page" | wc -l)" ]
done
# One row a case in the table of speeds, after its head.
holds [ "$(grep -c '^<tr><th>' "$page")" -eq 10 ]

# The answer comes first: the real fetus with its source, then mean and worst of the synthetic cases, as their verdicts have them.
plain=$(sed 's/data:[^"]*//g' "$page" | tr -d '\n')
opening=${plain%%<nav*}
holds grep -q 'vizbi_webgl_demo (commit c6c2d7d, MIT licence)' <<< "$opening"
holds [ "$(grep -o 'alt="[^"]*"' <<< "$opening" | sed 's/.*rendering//' | paste -sd '|')" = ' of the full volume"| that starts at the clipping surface"' ]
figure() { grep -o '<dd>[0-9.]* %' <<< "$opening" | sed -n "$1p" | grep -o '[0-9.]*'; }
worst() { grep -o '(worst: [0-9.]* %' <<< "$opening" | sed -n "$1p" | grep -o '[0-9.]*'; }
grep -o 'Verdict: [^<]* Cut [0-9.]* %, left [0-9.]* %' <<< "$plain" | head -n 4 | grep -o '[0-9.]* %, left [0-9.]*' |
    awk -v cut="$(figure 1)" -v left="$(figure 2)" -v cut_most="$(worst 1)" -v left_most="$(worst 2)" '
        function off(a, b) { return a - b > 0.1 || b - a > 0.1 }
        { c += $1 / 4; l += $4 / 4; if ($1 > cm) cm = $1; if ($4 > lm) lm = $4; n++ }
        END { exit off(c, cut) || off(l, left) || off(cm, cut_most) || off(lm, left_most) || n != 4 }'
holds [ $? -eq 0 ]
# A verdict a case, and every case in the list of contents, by the same name.
holds [ "$(grep -o '<p>Verdict: ' <<< "$plain" | wc -l)" -eq 9 ]
holds [ "$(grep -o '<h2 id="[^<]*' <<< "$plain" | sed 's/<h2 id="//')" = "$(grep -o 'href="#[^<]*' <<< "$plain" | sed 's/href="#//')" ]
holds grep -q '<h2 id="part[0-9]*">Cord before the face</h2>' "$page"
# What is said of a picture holds for it: there is a yellow line where something is clipped, and grey in a truth that has it.
clipped=$(grep -o 'the yellow line is the clipping surface' <<< "$plain" | wc -l)
whole=$(grep -o '<figcaption>The result beside three slices: nothing is removed' <<< "$plain" | wc -l)
holds [ "$clipped $whole" = "$(grep -o '<td data-head="outcome">clipped<' <<< "$plain" | wc -l) $(grep -o '<td data-head="outcome">nothing removed<' <<< "$plain" | wc -l)" ]
holds [ $((clipped + whole)) -eq 9 -a "$whole" -ge 1 ]
part() { sed "s/.*<h2 id=\"part[0-9]*\">$1<//; s/<h2.*//" <<< "$plain"; }
holds grep -q '<figcaption>Ground truth. Grey: touches the occluder, cut<' <<< "$(part 'Cord before the face')"
holds grep -q '<figcaption>Ground truth<' <<< "$(part 'A wide gap of fluid')"
# A volume that is no fetus is not called one.
holds grep -q 'Verdict: the volume is ' <<< "$(part 'Layers, behind a synthetic placenta')"
# What is said of a result is not what the thesis says of its own.
holds [ "$(grep -c 'forehead is cut' "$page")" -eq 0 ]
# A line a case and two of where the rest is; the tables are in the log.
holds [ "$(grep -c '^demo [1-9] of 9: ' "$work/stdout")" -eq 9 -a "$(wc -l < "$work/stdout")" -eq 11 ]
holds [ "$(grep -c 'Last frame' "$work/demo/log.txt")" -eq 9 ]
holds [ "$(tail -n 1 "$work/stdout")" = "Pictures are in $work/demo, the page is $page" ]

# With a plugin that fails, the demo ends with its code and shows the full volume.
"$build/host_sim" demo --quick --picture 64 --look thesis --out "$work/bad" --plugin "$build/tests/plugins/no_symbol.so" > /dev/null 2>&1
holds [ $? -eq 4 ]
holds cmp "$work/bad/D01/full.png" "$work/bad/D01/result.png"
holds grep -q 'no symbol smartvis_plugin_entry' "$work/bad/index.html"

# A folder need not have the real fetus, nor anything.
mkdir "$work/nothing"
ends 0 "$build/host_sim" demo --quick --picture 64 --out "$work/plain" --data "$work/nothing"
holds grep -qF "demo 4 of 4" "$work/stdout"

[ $failed -eq 0 ]
