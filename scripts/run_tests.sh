#!/bin/bash
# SPDX-License-Identifier: MIT
# run_tests.sh BUILD_FOLDER JOBS [LABELS [PART]]: runs CTest and closes with one line of counts, with what was skipped and why, and
# with the command that runs again what failed.
# LABELS is a regular expression: tests with such a label only; `night`: those of `make test-night`. PART: those of base, sdk,
# host_sim, python, lab or house. Exit code: CTest's. With SV_SKIP_NOTHING=1 a test that is skipped is an error, too.
set -u
folder=$(cd "$1" && pwd) || exit 1
jobs=$2
labels=()
[ -z "${3:-}" ] || labels=(-L "$3")
[ -z "${4:-}" ] || labels+=(-L "^$4\$")
[ "${3:-}" != night ] || labels+=(-C night)
result=$folder/test_results.xml
rm -f "$result"

# More than there are processors: among those that begin are some that wait longer than they compute. In the background of a script,
# whose SIGINT is ignored, as in front: what is held to end by it has to see it.
log=out/log/$(basename "$folder").tests.log
"$(dirname "$0")/quietly.sh" tests "$log" env --default-signal=INT,QUIT ctest --test-dir "$folder" --no-tests=error --output-on-failure -j "$((2 * jobs + 2))" \
    --output-junit "$result" "${labels[@]}"
code=$?
# What the tests that failed printed, some lines of each.
[ $code = 0 ] || awk '/^ *[0-9]+\/[0-9]+ Test |^ +Start / { n = 0 } /\*\*\*/ { n = 60 } n-- > 0' "$log"

# Counts from the attributes of <testsuite>.
count() { sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p" "$result" 2> /dev/null | head -n 1; }
total=$(count tests) failed=$(count failures) idle=$(($(count skipped) + $(count disabled)))
if [ -n "$total" ]; then
    times > "$log.times" # in no shell of its own: those of its children
    used=$(awk -F '[ms ]+' 'NR == 2 { print int(60 * ($1 + $3) + $2 + $4) }' "$log.times")
    echo "tests ($1): $((total - failed - idle)) passed, $failed failed, $idle did not run, of $total; $used s of processor time"
fi
# What a skipped test said of it, and the tests that said so.
skipped=$(awk -F'"' '/<testcase / { name = $2; off = /status="notrun"/ }
    off && /skipped: / { sub(/.*skipped: /, ""); sub(/<.*/, ""); off = 0; tests[$0] = tests[$0] " " name }
    off && /<\/testcase>/ { tests["no reason given"] = tests["no reason given"] " " name }
    END { for (why in tests) print "LEFT OUT, " why ":" tests[why] }' "$result" 2> /dev/null)
if [ -n "$skipped" ]; then
    sort <<< "$skipped"
    [ "${SV_SKIP_NOTHING:-0}" = 0 ] || [ $code != 0 ] || { echo "tests: nothing may be left out here" && code=1; }
fi
again=$(awk -F'"' '/<testcase / && /status="fail"/ { printf "%s%s", sep, $2; sep = "|" }' "$result" 2> /dev/null)
[ -z "$again" ] || echo "Again: ctest --test-dir $1 --output-on-failure -R '^($again)\$'"
exit $code
