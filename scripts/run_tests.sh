#!/bin/bash
# SPDX-License-Identifier: MIT
# run_tests.sh BUILD_FOLDER JOBS [LABELS]: runs CTest and closes with one line of counts. LABELS is a regular
# expression: tests with such a label only. Exit code: CTest's.
set -u
folder=$(cd "$1" && pwd) || exit 1
jobs=$2
labels=()
[ -z "${3:-}" ] || labels=(-L "$3")
result=$folder/test_results.xml
rm -f "$result"

# Two more than there are processors: some tests wait longer than they compute.
ctest --test-dir "$folder" --no-tests=error --output-on-failure -j "$((jobs + 2))" --output-junit "$result" "${labels[@]}"
code=$?

# Counts from the attributes of <testsuite>.
count() { sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p" "$result" 2> /dev/null | head -n 1; }
total=$(count tests) failed=$(count failures) idle=$(($(count skipped) + $(count disabled)))
if [ -n "$total" ]; then
    echo "tests ($1): $((total - failed - idle)) passed, $failed failed, $idle did not run, of $total"
fi
exit $code
