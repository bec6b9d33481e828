#!/bin/bash
# SPDX-License-Identifier: MIT
# The examples as an author meets them: they are as short as promised, a copy of each folder builds alone, the host simulator
# renders with their maps, which are close to the truth, and the small host tells what it did.
set -u
source_dir=$1
build_dir=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() {
    echo "failed: $*"
    failures=$((failures + 1))
}

# --- lines: in all, and without the method
most() { # most FILE LINES
    local lines
    lines=$(wc -l < "$source_dir/examples/$1")
    [ "$lines" -le "$2" ] || fail "$1 has $lines lines, at most $2"
}
beside_method() { # beside_method FILE LINES
    local lines
    lines=$(awk '/^\/\* ---- the method/ { method = 1 } /^\/\* ---- the plugin/ { method = 0 } !method { n++ } END { print n }' "$source_dir/examples/$1")
    [ "$lines" -le "$2" ] || fail "$1 has $lines lines beside its method, at most $2"
    [ "$(grep -c '^/\* ---- the \(method\|plugin\) \*/' "$source_dir/examples/$1")" = 2 ] || fail "$1: the method is not marked"
}
most first_edge/first_edge.c 80
most small_host/small_host.c 90
most template/my_surface.c 50
beside_method first_edge/first_edge.c 40
most kernel_edge/kernel_edge.c 65

# --- copies build alone
for name in first_edge kernel_edge template small_host queue_host deadline_host; do
    cp -r "$source_dir/examples/$name" "$work/$name"
    if ! { cmake -S "$work/$name" -B "$work/$name/build" -D CMAKE_PREFIX_PATH="$build_dir" -D CMAKE_C_FLAGS='-Wall -Wextra -Werror' &&
        cmake --build "$work/$name/build"; } > "$work/log" 2>&1; then
        tail -n 20 "$work/log"
        fail "a copy of $name does not build"
    fi
done

# --- the small host; fluid of ray (4, 4) is in slices 8 .. 27, and q is 0.25: 27.5 - 0.25 * 20
host() { # host CODE TEXT ARGUMENT...
    local code=$1 text=$2
    shift 2
    "$build_dir/examples/small_host" "$@" > "$work/out" 2> "$work/err"
    local found=$?
    [ $found = "$code" ] || fail "small_host $*: exit code $found, expected $code"
    grep -qF "$text" "$work/out" "$work/err" || fail "small_host $*: no '$text' in $(cat "$work/out" "$work/err")"
}
host 2 usage
host 2 "no symbol smartvis_plugin_entry" "$build_dir/tests/plugins/no_symbol.so"
host 4 'another ABI: 2' "$build_dir/tests/plugins/other_major.so"
host 4 'another ABI: 0' "$build_dir/tests/plugins/older_major.so"
host 4 "needs the host's queue" "$build_dir/tests/plugins/zeros.so"
host 4 'rendered unclipped' "$build_dir/tests/plugins/create_fails.so"
host 0 'rendered with the map' "$build_dir/smartvis.so"
host 0 'rendered with the map' "$build_dir/examples/first_edge.so"
grep -q '^ 22\.5 ' "$work/out" || fail "small_host, first_edge: $(sed -n 2p "$work/out")"
tail -n +2 "$work/out" > "$work/first"
host 0 'rendered with the map' "$build_dir/examples/kernel_edge.so"
tail -n +2 "$work/out" | cmp - "$work/first" || fail "small_host: the two examples differ"

# --- the host with a queue of its own: the same depths, by way of buffers
for plugin in smartvis.so examples/kernel_edge.so; do
    host 0 'rendered with the map' "$build_dir/$plugin"
    mv "$work/out" "$work/expected"
    "$build_dir/examples/queue_host" "$build_dir/$plugin" > "$work/out" 2> "$work/err" || fail "queue_host $plugin: exit code $?"
    cmp "$work/expected" "$work/out" || fail "queue_host $plugin: not what small_host prints"
done
"$build_dir/examples/queue_host" "$build_dir/examples/first_edge.so" > /dev/null 2> "$work/err"
[ $? = 4 ] || fail "queue_host, a plugin without the host's queue: exit code"
grep -q 'takes no queue' "$work/err" || fail "queue_host: $(cat "$work/err")"

for plugin in other_major older_major; do
    for line in "queue_host PLUGIN" "deadline_host PLUGIN 600000"; do
        read -ra words <<< "${line/PLUGIN/$build_dir/tests/plugins/$plugin.so}"
        "$build_dir/examples/${words[0]}" "${words[@]:1}" > /dev/null 2> "$work/err"
        [ $? = 4 ] || fail "${words[*]}: exit code"
        grep -q 'another ABI: [02]' "$work/err" || fail "${words[*]}: $(cat "$work/err")"
    done
done

# --- the host with a deadline: in time, all are drawn with the map; with none, unclipped, and what cannot be handed over is skipped
for plugin in smartvis.so examples/first_edge.so; do
    "$build_dir/examples/deadline_host" "$build_dir/$plugin" 600000 > "$work/out" 2>&1 || fail "deadline_host $plugin: exit code $?"
    grep -qx '200 volumes: 200 drawn with the map, 0 unclipped; 0 of these were skipped' "$work/out" ||
        fail "deadline_host $plugin, in time: $(cat "$work/out")"
done
"$build_dir/examples/deadline_host" "$build_dir/smartvis.so" 0.001 > "$work/out" 2>&1 || fail "deadline_host: exit code $?"
grep -qE '^200 volumes: 0 drawn with the map, 200 unclipped; [1-9][0-9]* of these were skipped$' "$work/out" ||
    fail "deadline_host, too late: $(cat "$work/out")"
"$build_dir/examples/deadline_host" "$build_dir/tests/plugins/begin_77.so" 600000 > "$work/out" 2>&1
[ $? = 4 ] || fail "deadline_host, a plugin that fails: exit code"
grep -q '^200 volumes: 0 drawn with the map, 200 unclipped; 0 of these were skipped$' "$work/out" ||
    fail "deadline_host, a plugin that fails: $(cat "$work/out")"
"$build_dir/examples/deadline_host" "$build_dir/tests/plugins/plane.so" > /dev/null 2>&1
[ $? = 2 ] || fail "deadline_host without a time: exit code"

# --- the host simulator
simulate() { # simulate OPTION...
    "$build_dir/host_sim" run --scene D01 --size 64 --setting smartvis --frames 2 --picture 64 --few-pictures \
        --out "$work/run" "$@" > "$work/out" 2>&1 ||
        { cat "$work/out"; fail "host_sim run $*"; }
    grep -q 'Frames: 2 clipped' "$work/out" || fail "host_sim run $*: $(grep Frames: "$work/out")"
}
simulate --plugin "$build_dir/examples/first_edge.so" # on its own queue: the host reads that it knows no other
simulate --plugin "$build_dir/examples/kernel_edge.so"
simulate --plugin "$build_dir/examples/kernel_edge.so" --own-queue
simulate --plugin "$build_dir/examples/kernel_edge.so" --carrier host --set q=0.5
simulate --plugin "$build_dir/examples/template.so"

# --- against the truth: an error of less than a step, where the unclipped volume has more than fifty
"$build_dir/host_sim" report --case D01 --size 96 --seeds 1 --frames 0 --out "$work/report" \
    --compare "$build_dir/examples/kernel_edge.so" --compare "$build_dir/tests/plugins/zeros.so" > "$work/out" 2>&1 ||
    { cat "$work/out"; fail "host_sim report"; }
error() { awk -v name="$1" '$NF ~ name { print $2 }' "$work/out"; }
awk -v found="$(error kernel_edge.so)" -v none="$(error zeros.so)" 'BEGIN { exit !(found != "" && found < 1 && none > 50) }' ||
    fail "mean error: kernel_edge $(error kernel_edge.so), unclipped $(error zeros.so)"

echo "$failures failures"
[ $failures = 0 ]
