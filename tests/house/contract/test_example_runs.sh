#!/bin/bash
# SPDX-License-Identifier: MIT
# The examples as an author meets them: they are as short as promised, a copy of each folder builds alone, the host simulator
# renders with their maps, which are close to the truth, and the small host tells what it did.
set -u
source_dir=$1
build_dir=$2
. "$1/tests/support/holds.sh"

# --- lines: in all, and without the method
most() { holds [ "$(wc -l < "$source_dir/examples/$1")" -le "$2" ]; } # most FILE LINES
beside_method() { # beside_method FILE LINES
    local marks='^/[*] ---- the (method|plugin) [*]/'
    holds [ "$(grep -cE "$marks" "$source_dir/examples/$1")" = 2 ]
    holds [ "$(awk '/^\/\* ---- the method/ { method = 1 } /^\/\* ---- the plugin/ { method = 0 } !method { n++ } END { print n }' "$source_dir/examples/$1")" -le "$2" ]
}
most first_edge/first_edge.c 80
most small_host/small_host.c 90
most template/my_surface.c 50
beside_method first_edge/first_edge.c 40
most kernel_edge/kernel_edge.c 65

# --- copies build alone
for name in first_edge kernel_edge template small_host queue_host deadline_host; do
    cp -r "$source_dir/examples/$name" "$work/$name"
    ends 0 cmake -S "$work/$name" -B "$work/$name/build" -D CMAKE_PREFIX_PATH="$build_dir" -D CMAKE_C_FLAGS='-Wall -Wextra -Werror'
    ends 0 cmake --build "$work/$name/build"
done

# runs CODE TEXT EXAMPLE ARGUMENT...: exit code, and a pattern in what is printed.
runs() {
    ends "$1" "$build_dir/examples/$3" "${@:4}"
    holds grep -qE -- "$2" "$work/stdout" "$work/stderr"
}
plugins=$build_dir/tests/plugins

# --- the small host; fluid of ray (4, 4) is in slices 8 .. 27, and q is 0.25: 27.5 - 0.25 * 20
runs 2 usage small_host
runs 2 "no symbol smartvis_plugin_entry" small_host "$plugins/no_symbol.so"
runs 4 "needs the host's queue" small_host "$plugins/zeros.so"
runs 4 'rendered unclipped' small_host "$plugins/create_fails.so"
runs 0 'rendered with the map' small_host "$build_dir/smartvis.so"
runs 0 'rendered with the map' small_host "$build_dir/examples/first_edge.so"
holds grep -q '^ 22\.5 ' "$work/stdout"
tail -n +2 "$work/stdout" > "$work/first"
runs 0 'rendered with the map' small_host "$build_dir/examples/kernel_edge.so"
tail -n +2 "$work/stdout" > "$work/second"
holds cmp "$work/first" "$work/second"

# --- the host with a queue of its own: the same depths, by way of buffers
for plugin in smartvis.so examples/kernel_edge.so; do
    runs 0 'rendered with the map' small_host "$build_dir/$plugin"
    mv "$work/stdout" "$work/expected"
    runs 0 'rendered with the map' queue_host "$build_dir/$plugin"
    holds cmp "$work/expected" "$work/stdout"
done
runs 4 'takes no queue' queue_host "$build_dir/examples/first_edge.so"

for name in small_host queue_host deadline_host; do
    limit=()
    [ $name != deadline_host ] || limit=(600000)
    runs 4 'another ABI: 2' $name "$plugins/other_major.so" "${limit[@]}"
    runs 4 'another ABI: 0' $name "$plugins/older_major.so" "${limit[@]}"
done

# --- the host with a deadline: in time, all are drawn with the map; with none, unclipped, and what cannot be handed over is skipped
for plugin in smartvis.so examples/first_edge.so; do
    runs 0 '^200 volumes: 200 drawn with the map, 0 unclipped; 0 of these were skipped$' deadline_host "$build_dir/$plugin" 600000
done
runs 0 '^200 volumes: 0 drawn with the map, 200 unclipped; [1-9][0-9]* of these were skipped$' deadline_host "$build_dir/smartvis.so" 0.001
runs 4 '^200 volumes: 0 drawn with the map, 200 unclipped; 0 of these were skipped$' deadline_host "$plugins/begin_77.so" 600000
ends 2 "$build_dir/examples/deadline_host" "$plugins/plane.so"

# --- the host simulator
simulate() { # simulate OPTION...
    ends 0 "$build_dir/host_sim" run --scene D01 --size 64 --setting smartvis --frames 2 --picture 64 --few-pictures --out "$work/run" "$@"
    holds grep -q 'Frames: 2 clipped' "$work/stdout" "$work/stderr"
}
simulate --plugin "$build_dir/examples/first_edge.so" # on its own queue: the host reads that it knows no other
simulate --plugin "$build_dir/examples/kernel_edge.so"
simulate --plugin "$build_dir/examples/kernel_edge.so" --own-queue
simulate --plugin "$build_dir/examples/kernel_edge.so" --carrier host --set q=0.5
simulate --plugin "$build_dir/examples/template.so"

# --- the machine as a library, by ctypes: the map of host_sim, whose millimetres are slices here
ends 0 "$build_dir/host_sim" scenes D01 --size 120 --export --out "$work/scan"
ends 0 "$build_dir/host_sim" run --volume "$work/scan/D01_full.mha" --set q=0.4 --setting smartvis --frames 1 --picture 64 --few-pictures \
    --write depthmap --out "$work/run"
door=("$source_dir/examples/door/clip.py" "$build_dir/libsmartvis_host.so" "$work/scan/D01_full.mha" "$work/depth.raw")
preload=() # the address sanitizer must come first in a process; what Python never frees is not ours
[ "${SV_SANITIZE:-0}" = 0 ] || preload=("LD_PRELOAD=$(cc -print-file-name=libasan.so)" "ASAN_OPTIONS=${ASAN_OPTIONS:-}:detect_leaks=0")
ends 0 env "${preload[@]}" python3 -B "${door[@]}" q=0.4
holds grep -q '^120 x 120 rays of 120 slices, 1 mm apart: outcome 0$' "$work/stdout"
tail -c "$(stat -c %s "$work/depth.raw")" "$work/run/depthmap.mha" > "$work/expected.raw"
holds cmp "$work/depth.raw" "$work/expected.raw"
ends 1 env "${preload[@]}" python3 -B "${door[@]}" q=2
holds grep -qF 'parameter q: 2 is outside' "$work/stderr"

# --- against the truth: an error of less than a step, where the unclipped volume has more than fifty
ends 0 "$build_dir/host_sim" report --case D01 --size 96 --seeds 1 --frames 0 --out "$work/report" \
    --compare "$build_dir/examples/kernel_edge.so" --compare "$plugins/zeros.so"
error() { awk -v name="$1" '$NF ~ name { print $2 }' "$work/stdout" "$work/stderr"; }
holds awk -v found="$(error kernel_edge.so)" -v none="$(error zeros.so)" 'BEGIN { exit !(found != "" && found < 1 && none > 50) }'
echo "$checked checked, $failed failed"
[ $failed = 0 ]
