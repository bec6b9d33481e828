#!/bin/bash
# SPDX-License-Identifier: MIT
# Twenty frames of a turning camera are recorded in the simulated machine by the checking layer, and played again: bit for bit
# in another process, in other layouts of the work, from other carriers, under the guard. What is changed is told, with the
# frame; a plugin that crashes in a recording, and one that crashes on it, are; a recording that is cut off ends with 3.
# Called with the source and the build folder.
set -u
build=$2
# shellcheck source=tests/support/holds.sh
. "$1/tests/support/holds.sh"
record() { # record FILE OPTIONS PLUGIN ARGUMENTS...: of host_sim run
    local file=$1 options=$2 plugin=$3
    shift 3
    SMARTVIS_CHECK_PLUGIN=$plugin SMARTVIS_RECORD=$file SMARTVIS_RECORD_OPTIONS=$options "$build/host_sim" run --scene E02 --size 64 --picture 64 --few-pictures \
        --setting smartvis --no-guard --plugin "$build/smartvis_check.so" --out "$work/run" "$@" > "$work/host" 2>&1
}
patient=(--seconds 600 --guard-time 600,600) # kernels take long on a busy CPU
replay() { "$build/sv_replay" "$@" > "$work/said" 2>&1; }
code() { local wanted=$1; shift; "$@"; [ $? = "$wanted" ] || { cat "$work/said"; false; }; }
says() { grep -qE -- "$1" "$work/said" || { cat "$work/said"; false; }; }

holds record "$work/turn" "" "$build/smartvis.so" --orbit 60 --frames 20
for options in "" "--guard" "--own-queue" "--carrier image"; do
    # shellcheck disable=SC2086 # options are words
    holds code 0 replay "$work/turn" $options "${patient[@]}"
    holds says '^the same$'
    holds says '[2-9][0-9] frames, '
    holds says '[2-9][0-9] maps and '
done

# --- what is not the same, and where
holds code 1 replay "$work/turn" --set q=0.75 "${patient[@]}"
holds says '^frame 0 .*: end: [0-9]+ of [0-9]+ depths are others, by up to [0-9.]+ slices; the first is ray'
holds says '^NOT THE SAME$'
holds code 1 replay "$work/turn" --plugin "$build/examples/first_edge.so" "${patient[@]}"
holds says 'SV_PARTIAL'

# --- of the layer's rules none was broken on the way
holds test "$(grep -c 'check: ' "$work/host")" = 0

# --- a ring, no voxels, host memory
(umask 022 && : > "$work/ring") # others may read it; the recording they may not
holds record "$work/ring" "frames=4" "$build/smartvis.so" --orbit 60 --frames 20 --carrier host
holds code 0 replay "$work/ring" "${patient[@]}"
holds says ' 5 frames, ' # the last four, and the one that brought their volume
holds test "$(stat -c %a "$work/ring")" = 600
holds code 0 replay "$work/ring" --set strategy=rays "${patient[@]}"
holds says '^the same$'
holds record "$work/empty" "voxels=no" "$build/smartvis.so" --frames 5
holds code 0 replay "$work/empty" "${patient[@]}"
holds says 'holds no voxels and no maps'
holds test "$(($(stat -c %s "$work/empty") * 5))" -lt "$(stat -c %s "$work/turn")"
holds test "$(stat -c %a "$work/turn")" = 600

# --- what the plugin wrote is recorded, not what the layer makes of it: NaN and what was left out come again
for plugin in depth_nan last_row_missing map_not_written; do
    record "$work/nan" "" "$build/wrong/$plugin.so" --frames 3
    holds grep -q 'check: depth-values: end' "$work/host"
    holds code 0 replay "$work/nan" --plugin "$build/wrong/$plugin.so" "${patient[@]}"
    holds says '^[1-9][0-9]* maps and '
done

# --- a frame as files; test_recording_drawn.sh draws them
holds code 0 replay "$work/ring" --out "$work/files" --frame 2 "${patient[@]}"
holds grep -aq '^DimSize = \([0-9]*\) \1 [0-9]*$' "$work/files/volume.mha"
holds grep -aq '^DimSize = \([0-9]*\) \1 1$' "$work/files/map.mha"
holds code 3 replay "$work/empty" --out "$work/files"

# --- a page of what was recorded: every frame with its depthmap and the lines of the log; a plugin's words are no HTML
holds code 0 replay "$work/turn" --show "$work/page" "${patient[@]}"
holds test "$(grep -c '<h2>Frame' "$work/page/index.html")" -ge 20 -a "$(grep -c '<img' "$work/page/index.html")" = "$(find "$work/page" -name '*.png' | wc -l)"
holds grep -q '<pre>activate: .* needs [0-9]* bytes' "$work/page/index.html"
holds code 0 replay "$work/empty" --show "$work/page_empty"
holds test "$(grep -c '<img' "$work/page_empty/index.html")" = 0 -a "$(grep -c '<p>end: SV_OK' "$work/page_empty/index.html")" -ge 5

# --- what is no recording, and what cannot be said
mkfifo "$work/pipe"
in_time() { timeout 60 "$build/sv_replay" "$@" > "$work/said" 2>&1; }
for no in "$work/pipe" "$work" /dev/zero; do
    holds code 3 in_time "$no"
    holds says "^sv_replay: $no: not a regular file"
done
holds code 2 replay "$work/ring" --frame 2
holds says 'frame 2: is for --out FOLDER'
full() { "$build/sv_replay" "$@" > /dev/full 2> "$work/said"; }
if [ -w /dev/full ]; then
    holds code 6 full "$work/ring"
    holds says 'standard output cannot be written'
    holds [ "$(wc -l < "$work/said")" = 1 ]
    holds code 6 full "$work/ring" --list
    holds code 6 full --help
fi

# --- a plugin that crashes: in the recording, and on it
{ record "$work/crash" "" "$build/wrong/crash_in_slab.so" --frames 3; } 2> /dev/null
holds code 3 replay "$work/crash" "${patient[@]}"
holds says 'without its last part: whoever wrote it ended first'
holds code 4 replay "$work/crash" --plugin "$build/wrong/crash_in_slab.so" "${patient[@]}"
holds says "crashed: SIGSEGV${SV_SANITIZE:+|left by exit}" # UBSan ends the process before the signal
holds code 4 replay "$work/turn" --guard --plugin "$build/wrong/crash_in_slab.so" "${patient[@]}"

# --- what nobody would write: parts in an order or of sizes that cannot be, with checksums that hold, activations that were refused
# there and are taken here, numbers that no byte pays for. Each costs its player little, and none ends it.
mkdir "$work/hostile"
python3 -B "$1/tests/house/golden/hostile_recordings.py" "$work/hostile" ${SV_NIGHT:+400}
bounded() { # sv_replay ...: 99 if it took more than 20 s of a processor or 2 GiB; sanitizers take their own
    python3 - "$build/sv_replay" "$@" > "$work/said" 2>&1 << 'EOF'
import os, resource, subprocess, sys
code = subprocess.run(sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
seconds, mib = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
if not os.environ.get("SV_SANITIZE") and (seconds > 20 or mib > 2048):
    sys.exit(print(f"{seconds:.1f} s, {mib:.0f} MiB") or 99)
sys.exit(code)
EOF
}
holds code 0 replay "$work/hostile/right/right.svr" --plugin "$build/examples/first_edge.so"
holds says ' 1 frames, 6 calls'
holds code 3 replay "$work/hostile/wrong/one_row.svr" --out "$work/files"
holds says 'rays are not nearly'
rm "$work/hostile/wrong/one_row.svr" # is played
holds code 3 bounded "$work/hostile/wrong/many_rays.svr" --show "$work/page_many" --seconds 0.1
holds says 'has been shown for 0\.[0-9] s: --seconds allows more$'
holds grep -q 'class=bad.*has been shown for' "$work/page_many/index.html"
for file in "$work"/hostile/wrong/*.svr; do
    holds code 3 bounded "$file" --plugin "$build/examples/first_edge.so"
    holds says "^sv_replay: (.*${file##*/}: (byte [0-9]+: this part cannot be|has been played for)|activate: .* voxels in rows of)"
done
for file in "$work"/hostile/apart/*.svr; do
    for plugin in examples/first_edge.so smartvis.so; do
        holds code 1 bounded "$file" --plugin "$build/$plugin" "${patient[@]}"
        holds says 'recorded '
        holds [ "$(grep -c 'lasts here' "$work/said")" = 0 ] # what was refused there has ended here
    done
done
holds says 'activate: SV_OK, recorded SV_ERR_NO_MEMORY'
# What is handed over would fit; what the plugin says that it needs does not.
holds code 3 bounded "$work/hostile/needy/many_rays.svr" --plugin "$build/smartvis.so" --guard-memory 100 "${patient[@]}"
holds says 'activate: 2048 x 2048 x 8 voxels in rows of .* take [0-9]+ MiB, and a recording of this size may take 100: '
one_of_three() { bounded "$@"; case $? in 0 | 1 | 3) ;; *) cat "$work/said"; return 1 ;; esac; }
for file in "$work"/hostile/any/*.svr; do holds one_of_three "$file" --plugin "$build/smartvis.so"; done

# --- cut off, no recording, wrong words
head -c 100000 "$work/turn" > "$work/cut"
holds code 3 replay "$work/cut" "${patient[@]}"
holds says 'the recording is cut off here'
holds code 3 replay "$work/cut" --list
holds code 3 replay "$work/cut" --show "$work/page_cut"
holds grep -q 'class=bad.*the recording is cut off here' "$work/page_cut/index.html"
holds code 3 replay "$0"
holds code 3 replay "$work/nothing"
holds code 2 replay "$work/turn" --set nothing=1
holds code 2 replay
holds code 0 replay "$work/ring" --list
holds says '^begin [0-9]+, time [0-9]+ ns, .*probe towards \(.*; at [1-9][0-9.]* ms$'

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
