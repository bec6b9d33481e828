#!/bin/bash
# SPDX-License-Identifier: MIT
# Bad input at the command line: the exit code, and a message that names the thing and the value.
# Called with the source and the build folder.
set -u
source=$1
build=$2
host_sim=$build/host_sim
plugins=$build/tests/plugins
. "$1/tests/support/holds.sh"

# A MetaImage of 16 x 16 x $2 voxels, of which $3 bytes are there.
make_volume() {
    printf 'ObjectType = Image\nNDims = 3\nDimSize = 16 16 %s\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nElementDataFile = LOCAL\n' \
        "$2" > "$1"
    head -c "$3" /dev/zero | tr '\0' '\310' >> "$1"
}
make_volume "$work/good.mha" 16 4096
make_volume "$work/other_size.mha" 8 2048
make_volume "$work/short.mha" 16 4000
: > "$work/empty.mha"
cd "$work" || exit 1

run=(run --frames 1 --picture 32 --panel 64 --out "$work/out")
good=("${run[@]}" --volume good.mha --lowres 24)

# ------------------------------------------------------------------------------- exit code 2: usage
expect 2 "Usage:"
expect 2 "'walk' is no command" walk
expect 2 "no source" "${run[@]}"
expect 2 "--colour: not an option" "${good[@]}" --colour
expect 2 "--size: needs a value" "${run[@]}" --scene D01 --size
expect 2 "--size: 31 is outside 32 .. 512" "${run[@]}" --scene D01 --size 31
expect 2 "--size: '64x' is not a whole number" "${run[@]}" --scene D01 --size 64x
expect 2 "--size: '-64' is not a whole number" "${run[@]}" --scene D01 --size -64
expect 2 "--frames: 0 is outside" "${good[@]}" --frames 0
expect 2 "--frames: 99999999999999999999 is outside" "${good[@]}" --frames 99999999999999999999
expect 2 "--yaw: 'nan' is not a number" "${good[@]}" --yaw nan
expect 2 "--pitch: 361 is outside -360 .. 360" "${good[@]}" --pitch 361
expect 2 "--t-low: 1.5 is outside 0 .. 1" "${good[@]}" --t-low 1.5
expect 2 "--t-low 0.5 must be less than --t-high 0.5" "${good[@]}" --t-low 0.5 --t-high 0.5
expect 2 "--carrier: 'tape' is none of host, buffer, image" "${good[@]}" --carrier tape
expect 2 "--ghost-doubt" "${good[@]}" --ghost-doubt 16.5
expect 2 "--setting: 'both' is none of dvr, convert, smartvis, all" "${good[@]}" --setting both
expect 2 "--padding: 'some' is none of auto, none, all" "${good[@]}" --padding some
expect 2 "--window: '7', expected LOW,HIGH" "${good[@]}" --window 7
expect 2 "--window: 9,7: LOW must be less than HIGH" "${good[@]}" --window 9,7
expect 2 "--mirror: is for Kretz files" "${good[@]}" --mirror
expect 2 "--spacing: is for Kretz files" "${run[@]}" --scene D01 --spacing 1
expect 2 "--spacing: 0 is outside 0.01 .. 100" info --spacing 0 good.mha
expect 2 "--number 2: good.mha has 1" info --number 2 good.mha
for option in --mirror "--spacing 1"; do
    # shellcheck disable=SC2086  # an option and its value
    expect 2 "${option%% *}: is for Kretz files, good.mha is none" info $option good.mha
done
for option in "--size 64" "--seed 3" "--moving 2" "--real good.mha"; do
    # shellcheck disable=SC2086
    expect 2 "${option%% *}: is for --scene, --volume good.mha was given" "${good[@]}" $option
done
for option in "--window 3,4" "--padding all"; do
    # shellcheck disable=SC2086
    expect 2 "${option%% *}: is for --volume, --scene D01 was given" "${run[@]}" --scene D01 $option
done
expect 2 "--map map.mha: needs --lowres N" "${run[@]}" --volume good.mha --map map.mha
expect 2 "--map map.mha: takes the place of --plugin, --id and --set" "${good[@]}" --map map.mha --lowres 16 --set q=0
expect 2 "own queue: needs carrier host, got image" "${good[@]}" --own-queue --carrier image
expect 2 "--scene D01 and --volume good.mha" "${good[@]}" --scene D01
expect 2 "'more': unexpected argument" "${good[@]}" more
expect 2 "no parameter 'kernal'" "${good[@]}" --set kernal=23
expect 2 "99 is outside" "${good[@]}" --set kernel=99
expect 2 "24 is not 3 plus a multiple of 2" "${good[@]}" --set kernel=24
expect 2 "'offest' is not one of absolute, offset, fraction" "${good[@]}" --set bone_mode=offest
expect 2 "bytes of slabs, the device allows" "${good[@]}" --lowres 8192
expect 2 "the device allows" "${good[@]}" --lowres 1200 --carrier image --slab 1200
expect 2 "not an option" list --everything
expect 2 "no FILE given" info
expect 2 "'x': unexpected argument" demo x
expect 2 "--seeds 7: is for --compare" report --seeds 7
expect 2 "--picture: 63 is outside 64 .. 1024" demo --picture 63

# ------------------------------------------------------------------------------- exit code 3: input
expect 3 "missing.mha" "${run[@]}" --volume missing.mha
expect 3 "short.mha" "${run[@]}" --volume short.mha
expect 3 "missing.mha" "${good[@]}" --map missing.mha --lowres 16
expect 3 "good.mha" "${good[@]}" --map good.mha --lowres 16
expect 3 "empty.mha" "${run[@]}" --volume empty.mha
expect 3 "$work" "${run[@]}" --volume "$work"
expect 3 "good.mha has 16 x 16 x 16: a sequence has one size" "${good[@]}" --volume other_size.mha
expect 3 "N99" "${run[@]}" --scene N99
expect 3 "missing.mha" info missing.mha
expect 3 "/no/such/folder" demo --out "$work/out" --data /no/such/folder

# ---------------------------------------------------------- exit code 4: plugin, picture unclipped (other words: test_loader)
"$host_sim" "${good[@]}" --setting dvr --plugin "$plugins/plane.so" > /dev/null 2>&1
cp out/full.png full.png
unclipped() {
    rm -rf out
    expect 4 "$@"
    holds grep -q "rendering unclipped" stderr
    holds cmp out/result.png full.png
}
rm -rf out # a file that is not there ends the run before anything is drawn
expect 4 "no_such.so: cannot read the plugin file: No such file" "${good[@]}" --plugin no_such.so
holds [ ! -e out ]
unclipped "good.mha: not a library of plugins" "${good[@]}" --plugin good.mha
unclipped "no symbol smartvis_plugin_entry" "${good[@]}" --plugin "$plugins/no_symbol.so"
far="create 'org.smartvis.test.plane': SV_ERR_INTERNAL (-1): parameter 'depth': the default is 100000, expected -10000 to 10000"
unclipped "$far" "${good[@]}" --plugin "$plugins/far_default.so"
holds grep -q "^Last frame: .*$far" stdout
unclipped "no plugin with id 'a.b'" "${good[@]}" --plugin "$plugins/plane.so" --id a.b
for call in activate begin slab end; do
    unclipped "$call: SV_ERR_INTERNAL (-1): fails in $call on purpose" "${good[@]}" --slab 2 \
        --plugin "$plugins/plane.so" --set fail=$call --set depth=30
done
expect 4 "no_such.so" list --plugin no_such.so

# SV_NO_SURFACE is no failure, but unclipped all the same. SmartVis says why; of a size that no scan has, the host.
expect 0 "" "${good[@]}" --spacing 5,5,5
holds grep -q "^Why: Too little was scanned, or all of it has one grey level" stdout
expect 0 "" "${good[@]}" --spacing 0.005,0.005,0.005
holds grep -q "^Why: The volume is 0.08 mm wide: is its spacing in metres?" stdout
rm -rf out
expect 0 "" "${good[@]}" --plugin "$plugins/plane.so" --set note=true --set depth=30
holds cmp out/result.png full.png
# So deep a plane leaves nothing to see: these comparisons would notice a picture that is clipped.
expect 0 "" "${good[@]}" --plugin "$plugins/plane.so" --set depth=30
holds [ "$(cmp -s out/result.png full.png; echo $?)" = 1 ]

# A map that was made elsewhere is drawn as the plugin's would be, and named after its file.
expect 0 "" "${good[@]}" --plugin "$plugins/plane.so" --set depth=30 --write depthmap
holds cp out/depthmap.mha given.mha
holds cp out/result.png plane.png
expect 0 "" "${good[@]}" --map ./given.mha --lowres 24
holds grep -q '^Plugin   given.mha (./given.mha)$' stdout
holds cmp out/result.png plane.png

# A map with holes is drawn, and the summary tells how many: of a test plugin, and of the mean filter that fills nothing.
rm -rf out
expect 0 "" "${good[@]}" --plugin "$plugins/partial.so" --set depth=30
holds [ "$(cmp -s out/result.png full.png; echo $?)" = 1 ]
holds grep -q "^Frames: 1 clipped, 1 of them in part; rendered unclipped: 0 by" stdout
holds grep -q "SV_PARTIAL; 576 rays gave a point (100.0 % of 576), 288 pixels without a surface" stdout
for queue in "" --own-queue; do
    expect 0 "" "${run[@]}" --scene E04 --size 64 $queue --set method=mean --set kernel=3 --set evidence=0 --set fill_weight=0
    holds grep -q "^Frames: 1 clipped, 1 of them in part;" stdout
    holds grep -qE "^Last frame: SV_PARTIAL; .* [1-9][0-9]* pixels without a surface" stdout
    holds [ "$(cmp -s out/result.png out/full.png; echo $?)" = 1 ]
done

# A confidence that is none is said once (that the picture is the one without it: test_confidence_faults); one that is is drawn.
ghost=(--set depth=3 --ghost-offset 8 --ghost-width 8)
expect 0 "confidence_nan.so: confidence: 1 of " "${good[@]}" --plugin "$plugins/confidence_nan.so" "${ghost[@]}" --frames 4
holds [ "$(grep -c 'ghosting without the confidence map' "$work/stderr")" = 1 ]
expect 0 "" "${good[@]}" --plugin "$plugins/confidence_ramp.so" "${ghost[@]}"
holds [ ! -s "$work/stderr" ]
holds [ -s "$work/out/confidence.png" ]

# ------------------------------------------------------------------------------ exit code 5: device
export OCL_ICD_VENDORS=$work/no_drivers
expect 5 "OCL_ICD_VENDORS, where drivers are looked for, is '$work/no_drivers'. Install a driver" "${good[@]}"
unset OCL_ICD_VENDORS
export SMARTVIS_DEVICE=abacus
expect 5 "SMARTVIS_DEVICE is 'abacus', expected 'cpu' or 'gpu'" "${good[@]}"
unset SMARTVIS_DEVICE

# ------------------------------------- exit code 6: output; found out before a volume is even opened
expect 6 "good.mha/out" run --volume missing.mha --out good.mha/out
expect 6 "good.mha" run --volume missing.mha --out good.mha
expect 6 "nowhere/x.json" run --volume missing.mha --out "$work/out" --json nowhere/x.json
expect 6 "good.mha/demo" demo --out good.mha/demo

# -------------------------------------------------------------------------------------------- good
for command in run demo list info; do
    expect 0 "" $command --help
    holds grep -q "^Exit codes:" stdout
done
expect 0 "" --help
holds grep -q -- "--version" stdout
# The versions are those of the project and of the header.
expect 0 "" --version
version=$(sed -n 's/^project(smartvis VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
abi() { sed -n "s/^#define SV_ABI_$1 *\([0-9]*\)u.*/\1/p" "$source/include/smartvis_plugin.h"; }
commit=$(cat "$build/commit.txt")
holds [ -n "$version" ]
holds [ "$(cat stdout)" = "host_sim $version${commit:++$commit}, SmartVis plugin ABI $(abi MAJOR).$(abi MINOR)" ]
expect 0 "" info good.mha "$work/other_size.mha"
holds grep -q "16 x 16 x 8 voxels" stdout
# A Kretz file: the mirror is told by the summary and the file of results, and what is for MetaImage is refused.
"$host_sim" scenes E01 --size 32 --frames 2 --export --format vol --out "$work/kretz" > /dev/null
kretz=("${run[@]}" --volume "$work/kretz/E01_full.vol" --out "$work/out")
expect 0 "" "${kretz[@]}" --mirror --spacing 4 --json "$work/kretz.json"
holds grep -q '"mirrored": true' kretz.json
holds grep -q "sweep + at +y, mirrored; 2 volumes in turn" stdout
expect 0 "" "${kretz[@]}" --spacing 4 --json "$work/kretz.json"
holds grep -q '"mirrored": false' kretz.json
holds grep -q "sweep + at -y; 2 volumes in turn" stdout
expect 2 "a window was given" "${kretz[@]}" --window 1,2
expect 2 "where the probe is" "${kretz[@]}" --probe +y
expect 0 "" "${kretz[@]}" --spacing 4 --volume "$work/kretz/E01_full.vol"
holds grep -q "; 4 volumes in turn" stdout
head -c 5000 "$work/kretz/E01_full.vol" > "$work/cut.vol"
expect 3 "cut.vol: byte" info cut.vol
# No OpenCL device is needed to describe a plugin.
export OCL_ICD_VENDORS=$work/no_drivers
expect 0 "" list --set method=mean
holds grep -q "^  kernel .*Filter size k" stdout
holds grep -q "more parameters do not matter with these values" stdout
expect 2 "no parameter 'foo'" list --set foo=1
expect 2 "needs a value" list --set
# A copy is guarded, and tells the same as the host's own.
cp "$build/smartvis.so" "$work/copy.so"
for options in "--all" "--set method=spline"; do
    for library in "$build/smartvis.so" "$work/copy.so"; do
        # shellcheck disable=SC2086 # options are words
        expect 0 "" list $options --plugin "$library"
        holds grep -q "^  takes for" stdout
        tail -n +2 "$work/stdout" > "$work/list.${library##*/}"
    done
    holds cmp "$work/list.smartvis.so" "$work/list.copy.so"
done
# An enum's retired values are neither listed nor taken.
expect 0 "" list --all
holds grep -q "mean | minimum | spline | wall" stdout
expect 2 "'plate' is not one of mean, minimum, spline, wall" list --set method=plate
# What matters to the default, method wall: the knob, doubtful fluid, the method itself, the work layout; and all there are.
keys() { grep -v '^  vendor' stdout | sed -nE 's/^  ([a-z_]+) +[A-Z].*/\1/p'; }
expect 0 "" list
holds [ "$(keys | grep -cxE 'q|unsure|method|strategy|kernel|substeps')" -eq 4 ]
expect 0 "" list --all
holds grep -q "; $(keys | wc -l) parameters$" stdout
unset OCL_ICD_VENDORS
expect 0 "" "${good[@]}" --json "$work/result.json"
holds grep -q '"volumes_per_second"' result.json
holds [ "$(tail -n 1 stdout)" = "Pictures are in $work/out" ]
# One volume is uploaded once, unless it comes live.
holds [ "$(grep -c '"upload"' result.json)" = 0 ]
expect 0 "" "${good[@]}" --live --json "$work/result.json"
holds [ "$(grep -c '"upload"' result.json)" = 3 ]
holds grep -q "^upload " stdout
for picture in result full panel depthmap; do holds [ -s "out/$picture.png" ]; done
holds [ ! -e out/confidence.png ] # what an earlier run left is not taken for this one's
holds [ -z "$(find "$work" -name '*.tmp*' -o -name '.host_sim_*')" ]
# Colours and progress are for terminals.
holds [ -z "$(grep -l "$(printf '\033')" stdout stderr)" ]

# Every option of the help is taken.
for option in $("$host_sim" run --help | grep -o '^  --[a-z-]*' | grep -v help); do
    "$host_sim" run "$option" > stdout 2> stderr
    holds grep -qE -- "^host_sim run: ($option: needs a value|no source|--mirror: is for)" stderr
done

echo "$checked checks, $failed failed"
[ $failed -eq 0 ]
