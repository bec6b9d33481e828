#!/bin/bash
# SPDX-License-Identifier: MIT
# test_layer_hosts.sh SOURCE_FOLDER BUILD_FOLDER: hosts run with the checking layer in the plugin's place as they run without, and it
# has nothing to say: the examples' hosts, host_sim in its ways, the report, the console, and the validator, which breaks every rule
# on purpose and finds that the layer passes all of it on. With SMARTVIS_CHECK=stop, a word of the layer's would be an error.
set -u
source_dir=$1 build=$2 layer=$2/smartvis_check.so
. "$source_dir/tests/support/holds.sh"
export SMARTVIS_CHECK=stop

# quiet COMMAND...: it ends well, and the layer logs that it was there and nothing else.
quiet() {
    ends 0 "$@"
    cat "$work/stdout" "$work/stderr" > "$work/said"
    ! grep -E 'misbehaving: check:|^plugin: check:' "$work/said" || holds false "$@"
}

# --- examples: the same output to the byte
export SMARTVIS_CHECK_PLUGIN
for pair in small_host:first_edge small_host:kernel_edge small_host:smartvis queue_host:kernel_edge queue_host:smartvis; do
    host=$build/examples/${pair%:*} plugin=$build/examples/${pair#*:}.so
    [ -e "$plugin" ] || plugin=$build/${pair#*:}.so
    ends 0 "$host" "$plugin"
    mv "$work/stdout" "$work/direct"
    SMARTVIS_CHECK_PLUGIN=$plugin quiet "$host" "$layer"
    holds cmp "$work/direct" "$work/stdout"
done

# --- a plugin of each family that is wrong: the layer names the rule in the host's own log, and with `stop` the host renders unclipped
# How long a call may take is told of the plugin that takes long, alone: on a busy machine others do, too, and the first rule that is
# broken in a frame ends it.
wrong() { # wrong PLUGIN HOST WORDS [MILLISECONDS]
    local plugin=$build/wrong/$1.so
    SMARTVIS_CHECK=on SMARTVIS_CHECK_MS=${4:-60000} SMARTVIS_CHECK_PLUGIN=$plugin "$build/examples/$2" "$layer" > "$work/said" 2>&1
    holds grep -qE "^plugin: check: $3" "$work/said"
    SMARTVIS_CHECK=stop SMARTVIS_CHECK_MS=${4:-60000} SMARTVIS_CHECK_PLUGIN=$plugin "$build/examples/$2" "$layer" > "$work/said" 2>&1
    ! grep -q 'rendered with the map' "$work/said" || holds false "$@"
}
wrong unknown_feature small_host 'descriptors: descriptor 0: features is 0x'
wrong two_primaries small_host 'param-flags: 2 parameters'
wrong depth_1e30 small_host 'depth-values: end: frame [0-9]+: the depth of ray \(0, 0\) is 1e\+30'
wrong changes_rounding small_host 'process-untouched: end: leaves the rounding mode'
wrong frame_builds queue_host 'frame-path-time: begin: took [0-9.]+ ms' 1

# --- the simulated machine
SMARTVIS_CHECK_PLUGIN=$build/smartvis.so
run=("$build/host_sim" run --scene E01 --size 64 --frames 4 --picture 64 --few-pictures --plugin "$layer" --verbose --guard-time 300,300 --out "$work/out")
for way in "--carrier buffer --no-guard" "--carrier host --no-guard" "--carrier image --no-guard" "--own-queue --no-guard" \
    "--orbit 40 --live --no-guard" "--guard"; do
    # shellcheck disable=SC2086
    quiet "${run[@]}" $way
    holds grep -qE 'check: [0-9]+ frames; milliseconds of a call' "$work/said"
done
quiet "$build/host_sim" report --quick --size 64 --lowres 24 --case E01 --plugin "$layer" --guard-time 300,300 --out "$work/report"

# --- what it finds reaches the exit code, guarded or not
for plugin in depth_nan last_row_missing map_not_written any_extension; do
    for way in --guard --no-guard; do
        SMARTVIS_CHECK=on SMARTVIS_CHECK_PLUGIN=$build/wrong/$plugin.so ends 4 "$build/host_sim" run --scene E01 --size 32 --frames 2 \
            --setting smartvis --picture 16 --few-pictures --plugin "$layer" $way --out "$work/out"
        holds grep -qE '^host_sim run: .*smartvis_check.so: check: (depth-values|extensions): ' "$work/stderr"
    done
done

# --- the console: a few settings of a page
PYTHONPATH=$source_dir/tests/host_sim/console ends 0 python3 -B - "$build" "$layer" << 'PAGE'
import sys
from console_client import Console, Page

console = Console(sys.argv[1], ["--plugin", sys.argv[2], "--no-guard"])
try:
    page = Page(console)
    for changes in ({}, {"camera": {"yaw": 30, "pitch": 10, "roll": 0, "zoom": 1}}, {"lanes": [{"plugin": 0, "values": {"q": 0.5}}]},
                    {"play": {"on": False, "speed": 20, "index": 0}}):
        frame = page.show(**changes)
        assert frame["type"] == "frame" and not frame["lanes"][0]["failed"], frame
    page.close()
    console.interrupt()  # by itself it ends 30 s later
    assert console.wait(60) == 0
finally:
    console.end()
PAGE
! grep 'misbehaving: check:' "$work/stderr" || holds false console

# --- the validator
export SMARTVIS_CHECK=on
for right in params results life opencl; do
    only=()
    [ $right != opencl ] || only=(--only opencl-balance --only opencl-faults --only frame-path-opencl --only foreign-objects)
    SMARTVIS_CHECK_PLUGIN=$build/wrong/right/$right.so ends 0 "$build/sv_validate" --level 1 "${only[@]}" "$layer"
done

echo "$checked checks, $failed failed"
[ "$failed" -eq 0 ]
