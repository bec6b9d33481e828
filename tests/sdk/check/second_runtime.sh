#!/bin/bash
# SPDX-License-Identifier: MIT
# second_runtime.sh BUILD_FOLDER ICD: another OpenCL runtime, named by its .icd file or its folder of them, computes what PoCL
# computes, bit for bit: every method in every layout, every carrier; and once more in a process that finds its kernels compiled.
# Registered where there is such a runtime (SV_SECOND_RUNTIME).
set -u
build=$1
other=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
run() { # run ICD NAME
    local start=$SECONDS
    OCL_ICD_VENDORS=$1 "$build/tests/every_method" "$build/smartvis.so" > "$work/$2" 2> "$work/$2.err" || {
        cat "$work/$2" "$work/$2.err"
        echo "FAIL: every_method on $1"
        exit 1
    }
    echo "$((SECONDS - start)) s: $(head -n 1 "$work/$2.err")"
}
first=/etc/OpenCL/vendors/pocl.icd
[ -e "$first" ] || { echo "FAIL: no $first to compare with"; exit 1; }
run "$first" first
run "$other" second
run "$other" again
cmp "$work/second" "$work/again" || { echo "FAIL: with its kernels compiled it computes something else"; exit 1; }
if cmp -s "$work/first.err" "$work/second.err"; then
    echo "FAIL: both are the same runtime"
    exit 1
fi
# A device may have no images that slabs could be.
grep -q ' image ' "$work/second" || sed -i '/ image /d' "$work/first"
if ! diff "$work/first" "$work/second"; then
    echo "FAIL: the results differ"
    exit 1
fi
echo "$(wc -l < "$work/first") results, the same bits"
