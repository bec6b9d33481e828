#!/bin/bash
# SPDX-License-Identifier: MIT
# host_sim verify: what is right holds, with the sums that sha256sum prints of files of all lengths around a block; a file that was
# changed or is missing, another depthmap, a deadline that no frame keeps, and a plugin that fails each have their exit code and their row,
# on the terminal and on the page. accepted.mha holds the maps of `wall` to those of the release (docs/stability.md); before 1.0.0 is
# released, `host_sim run --scene D01 --size 64 --setting smartvis --write depthmap` makes it anew. Called with the source and the build folder.
# Requirement: R18.
set -u
source_dir=$1 build=$2
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
unset SMARTVIS_SCENES SMARTVIS_PLUGIN_PATH
prefix=$work/prefix out=$work/out
mkdir -p "$prefix/bin" "$prefix/lib/smartvis" "$prefix/share/smartvis/sums"
cp "$build/host_sim" "$prefix/bin" && cp "$build/smartvis.so" "$prefix/lib/smartvis" && cp -r "$source_dir/data/scenes" "$prefix/share/smartvis"
for length in 0 1 55 56 63 64 65 119 120 32767 32768 32769 100000; do head -c "$length" "$build/host_sim" > "$prefix/share/length$length"; done
sums=$prefix/share/smartvis/sums/smartvis.sha256

# verify CODE WORDS [OPTION...]: ends with the code, and says the words on the terminal and on the page
verify() {
    local code=$1 words=$2
    shift 2
    rm -rf "$out"
    (cd "$work" && "$prefix/bin/host_sim" verify --frames 3 --out "$out" "$@") > "$work/log" 2>&1
    [ $? = "$code" ] && grep -qE "$words" "$work/log" && grep -qE "$(sed 's/^.* +//' <<< "$words")" "$out/verify.html" && return
    cat "$work/log"
    return 1
}

holds verify 0 'Files +not asked +no sums beside'
(cd "$prefix" && find . -type f ! -path '*/sums/*' | sort | xargs sha256sum) > "$sums"
holds verify 0 "Files +holds +$(wc -l < "$sums") of $(wc -l < "$sums") files"
holds grep -qF "SHA-256 $(sha256sum < "$build/smartvis.so" | head -c 64)" "$work/log"
holds grep -qE '^Self-test +holds' "$work/log"
holds grep -qE '^Accepted frame +holds +0 of 4096 rays' "$work/log"
holds grep -qE '^Frames +holds +3 clipped' "$work/log"
holds grep -qE '^Times of the plugin +not asked +3 frames: median' "$work/log"
holds grep -q 'data:image' "$out/verify.html"

printf x >> "$prefix/share/length64"
holds verify 1 'Files +FAILS +.*share/length64: changed'
rm "$prefix/share/length64"
holds verify 1 'Files +FAILS +.*share/length64: missing'
: > "$prefix/share/length64"
head -c 64 "$build/host_sim" > "$prefix/share/length64"
holds verify 1 'Times of the plugin +FAILS +.*the deadline is 0.001 ms' --deadline 0.001
holds verify 0 'Times of the plugin +holds +.*the deadline is 100000 ms' --deadline 100000
holds verify 0 'Accepted frame +not asked +no accepted map' --scene D01 --size 64
# Another method's map is another map.
holds verify 1 'Accepted frame +FAILS +.*rays differ' --scene D01 --size 64 --set method=mean --reference "$prefix/share/smartvis/scenes/accepted.mha"
holds verify 4 'Self-test +FAILS +.*not a library|Self-test +FAILS' --plugin "$source_dir/LICENSE"
verify 2 x --deadline 0 || true
holds grep -qF -- '--deadline' "$work/log"

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
