#!/bin/bash
# SPDX-License-Identifier: MIT
# The sanitizers of `make test-sanitize` find what they are there for: a lost malloc, a cl_mem and a cl_program that were not
# released, a read past the end, an undefined shift. And they keep quiet about PoCL's own compiler, and about threads that still
# have variables of a library. Without this, a suppression too wide or a leak check that is switched off would look like clean code.
set -eu
build_dir=$2
probe=$build_dir/tests/leak_probe
[ -x "$probe" ] || { echo "skipped: not a sanitizer build"; exit 77; }

# The first run compiles its kernel (an empty cache folder), the others find it in the cache: PoCL leaks in the first only.
export POCL_CACHE_DIR=$build_dir/pocl_cache/leak_probe
rm -rf "$POCL_CACHE_DIR"
mkdir -p "$POCL_CACHE_DIR"

log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! "$probe" none > "$log" 2>&1; then
    cat "$log"
    echo "a clean program is reported"
    exit 1
fi
if ! "$probe" thread "$build_dir/tests/thread_local.so" > "$log" 2>&1; then
    cat "$log"
    echo "the leak check does not bear a thread's variables (tests/CMakeLists.txt says which option lets it)"
    exit 1
fi

failures=0
caught() { # caught MISTAKE TEXT: this mistake must end the probe with an error, and the report must hold this text
    if "$probe" "$1" > "$log" 2>&1 || ! grep -qE "$2" "$log"; then
        cat "$log"
        echo "not caught: $1"
        failures=$((failures + 1))
    fi
}
caught host 'LeakSanitizer: detected memory leaks'
caught host '77 byte.s. leaked in 1 allocation'
caught buffer 'LeakSanitizer: detected memory leaks'
caught program 'LeakSanitizer: detected memory leaks'
caught overflow 'AddressSanitizer: heap-buffer-overflow'
caught shift 'runtime error: shift exponent 42'
[ $failures = 0 ]
