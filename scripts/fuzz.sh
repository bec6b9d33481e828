#!/bin/bash
# SPDX-License-Identifier: MIT
# fuzz.sh BUILD_FOLDER SECONDS JOBS OUT [SEED]: every fuzz target of a build with SV_FUZZ for so many seconds, JOBS of them side by
# side. They begin with the corpus in tests/fuzz/corpus and with what earlier runs found in OUT/NAME. An input that breaks
# something is left in OUT/NAME.broken-*; the same input without the fuzzer: BUILD_FOLDER/fuzz/fuzz_NAME FILE. Exit code 1 if
# there is one. The same SEED tries much the same inputs again; 0, the default, is a new one every time.
set -u
build=$(cd "$1" && pwd) || exit 1
seconds=$2
jobs=$3
mkdir -p "$4"
out=$(cd "$4" && pwd)
seed=${5:-0}
cd "$(dirname "$0")/.." || exit 1

# words_of NAME: its dictionary, with the words of the sources that read such inputs.
words_of() {
    echo "# $1" # an empty dictionary would be an error
    [ ! -f "tests/fuzz/dict/$1.dict" ] || cat "tests/fuzz/dict/$1.dict"
    case $1 in
        scene) grep -ohE '"[a-z][a-z0-9_]*"' data/scenes/*.json | sort -u | sed 's/"/\\"/g; s/.*/"&"/' ;;
        command) sed -nE 's/^ +\{"([a-z-]+)", .*/"--\1\\x0a"/p' host_sim/commands/run_line.c lab/report/cmd_report.c | sort -u ;;
    esac
}
export -f words_of

fuzz() { # fuzz NAME
    local name=$1 corpus=("$out/$1" "tests/fuzz/corpus/$1") start=$SECONDS
    mkdir -p "$out/$name" "$out/pocl_cache"
    [ "$name" != scene ] || corpus+=(data/scenes)
    words_of "$name" > "$out/$name.dict"
    # tests/CMakeLists.txt says why intercept_tls_get_addr=0.
    # Scenes and OpenCL have work to do behind an input, and the machine may be busy: two minutes are a hang all the same.
    if POCL_CACHE_DIR=$out/pocl_cache POCL_SIGFPE_HANDLER=0 \
        ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:allocator_may_return_null=1:intercept_tls_get_addr=0 \
        LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0 UBSAN_OPTIONS=print_stacktrace=1 \
        "$build/fuzz/fuzz_$name" -max_total_time="$seconds" -seed="$seed" -timeout=120 -rss_limit_mb=4096 -print_final_stats=1 \
        -artifact_prefix="$out/$name.broken-" -dict="$out/$name.dict" "${corpus[@]}" > "$out/$name.log" 2>&1; then
        echo "fuzz: $name: ok, $(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$name.log") inputs in $((SECONDS - start)) s"
    else
        tail -n 40 "$out/$name.log"
        echo "fuzz: $name: BROKEN, see $out/$name.log and $out/$name.broken-*"
        return 1
    fi
}
export -f fuzz
export build seconds out seed

names=()
for program in "$build"/fuzz/fuzz_*; do names+=("$(basename "$program" | sed 's/^fuzz_//')"); done
[ -e "$build/fuzz/fuzz_${names[0]}" ] || { echo "fuzz: no targets in $build/fuzz" >&2; exit 1; }
printf '%s\n' "${names[@]}" | xargs -P "$jobs" -I NAME bash -c 'fuzz NAME' && echo "fuzz: all targets held"
