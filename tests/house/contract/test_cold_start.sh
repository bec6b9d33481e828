#!/bin/bash
# SPDX-License-Identifier: MIT
# A run whose kernels were never compiled: nothing is compiled that no frame and no picture launches, no process is left, and the
# pictures and maps are those of a run whose kernels were there, and of one whose kernels were optimised. PoCL's cache has a folder
# for each kernel that it compiled, so this asks PoCL alone.
set -u
build_dir=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
optimised=${POCL_CACHE_DIR:-$work/optimised}
export POCL_CACHE_DIR=$work/cache SMARTVIS_DEVICE=cpu
unset SMARTVIS_QUICK_KERNELS
mkdir "$POCL_CACHE_DIR"
failures=0
fail() {
    echo "failed: $*"
    failures=$((failures + 1))
}
optimises_always() { grep -q '^Device   cpu-' "$work/$1.txt"; } # PoCL from 4 on, whose devices are called so; those of 3 pthread-
run() { # run FOLDER QUICK: one frame; of the plugin's programs, so many are quick
    local quick=$2
    "$build_dir/host_sim" run --scene E01 --size 100 --frames 1 --picture 64 --panel 64 --setting smartvis --verbose --write depthmap,confidence --out "$work/$1" > "$work/$1.txt" 2>&1 ||
        fail "$1: exit code $?: $(tail -n 20 "$work/$1.txt")"
    ! optimises_always "$1" || quick=0
    grep -q "info: activate: [0-9.]* s; of it [0-9.]* s for building 1 program, $quick without optimisation," "$work/$1.txt" || fail "$1: activate does not tell its time"
}
run cold 1
compiled=$(find "$POCL_CACHE_DIR" -name '*.so' -printf '%f\n' | sed 's/\.so$//' | sort -u)
if [ -z "$compiled" ]; then
    echo "skipped: the driver keeps no kernels in POCL_CACHE_DIR"
    exit 77
fi
for kernel in wall_costs render_lit; do
    grep -qx "$kernel" <<< "$compiled" || fail "$kernel was not compiled"
done
for kernel in profile_strip profile_rays frame_end band_mean band_points convert_beams; do
    if grep -qx "$kernel" <<< "$compiled"; then fail "$kernel was compiled in vain"; fi
done
[ "$(wc -l <<< "$compiled")" -le 39 ] || fail "$(wc -l <<< "$compiled") kernels were compiled, at most 39 are needed"
run warm 1
again=$(find "$POCL_CACHE_DIR" -name '*.so' -printf '%f\n' | sed 's/\.so$//' | sort -u)
[ "$again" = "$compiled" ] || fail "the second run compiled more: $(comm -13 <(echo "$compiled") <(echo "$again"))"
SMARTVIS_QUICK_KERNELS='' POCL_CACHE_DIR=$optimised run optimised 0
for file in result.png depthmap.png slices.png depthmap.mha confidence.mha; do
    cmp -s "$work/cold/$file" "$work/warm/$file" || fail "$file is another in a cold start"
    cmp -s "$work/cold/$file" "$work/optimised/$file" || fail "$file is another without optimisation"
done
optimises_always warm || grep -q 'Kernels  compiled without optimisation' "$work/warm.txt" || fail "the run does not say why it is slow"
if grep -q 'Kernels  compiled' "$work/optimised.txt"; then fail "the optimised run says that it is not"; fi
# The process that compiles ahead compiles what this run needs: the host's program, the profiles and the frame's, each once.
POCL_CACHE_DIR=$work/mean "$build_dir/host_sim" run --scene E01 --size 100 --frames 1 --picture 32 --few-pictures --setting smartvis \
    --set method=mean --out "$work/mean_out" > "$work/mean.txt" 2>&1 || fail "mean: exit code $?: $(tail -n 20 "$work/mean.txt")"
programs=$(find "$work/mean" -name program.bc | wc -l)
[ "$programs" = 3 ] || fail "method mean: $programs programs were built, 3 are needed"
# The layer's recording of such a run is whole: no other process of the host writes there.
POCL_CACHE_DIR=$work SMARTVIS_RECORD=$work/cold.svr "$build_dir/host_sim" run --scene E01 --size 32 --frames 1 --picture 32 --few-pictures \
    --setting smartvis --set method=mean --no-guard --plugin "$build_dir/smartvis_check.so" --out "$work/recorded" > "$work/recorded.txt" 2>&1
said=$("$build_dir/sv_replay" "$work/cold.svr" 2>&1 | tail -n 1)
[ "$said" = "the same" ] || fail "recorded in a cold start: $said"
[ "$failures" = 0 ] && echo "cold start: $(wc -l <<< "$compiled") kernels"
exit "$failures"
