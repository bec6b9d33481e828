#!/bin/bash
# SPDX-License-Identifier: MIT
# test_validate_wrong.sh SOURCE_FOLDER BUILD_FOLDER: sv_validate fails on every plugin of the family (tests/sdk/wrong/), by the check
# that the list names for it, and passes the same sources without a fault. It ends by itself every time. WRONG_VALIDATOR,
# WRONG_ENDING and WRONG_LEFT_OUT are another validator, how its plugins' names end, and plugins that are not tried; with WRONG_FEW
# one plugin is tried for each check.
set -u
source_folder=$1
build=$2
validate=${WRONG_VALIDATOR:-$build/sv_validate}
ending=${WRONG_ENDING:-so}
list=$source_folder/tests/sdk/wrong/wrong_list.h
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [ "${4:-}" ]; then
    # One plugin: ID SOURCE CHECK behind the folders. Kernels take long to compile, so plugins that have some are not tried
    # with every check at night either.
    id=$3 check=$5
    options=(--level 2)
    [ -n "${SV_NIGHT:-}" ] || options+=(--only "$check")
    [ "$4" != opencl ] || options=(--level 10 --only "$check")
    # What only ends by running out of time does so soon, but not before a busy machine has come to the call that hangs.
    [[ $id != hang* && $id != memory* ]] || options+=(--timeout 15)
    timeout 1200 $validate "${options[@]}" "$build/wrong/$id.$ending" > "$work/$id" 2>&1
    code=$?
    line=$(tr -d '\r' < "$work/$id" | grep -E "^[a-z]+ +$check ")
    wanted=1 words='^(fail|crash|timeout) '
    case $check in library-scan-time | first-launches | frame-time) wanted=0 words='^warn ' ;; esac
    if [ "$code" -ne $wanted ]; then
        echo "$id: exit code $code, expected $wanted"
    elif ! [[ $line =~ $words ]]; then
        echo "$id: $check should have failed: '$line'"
        grep -E '^(fail|crash|timeout) ' "$work/$id"
    elif [[ $id = forgets_ray_bytes && $line != *ray_bytes* ]]; then
        echo "$id: the field is not named: '$line'"
    fi
    exit 0
fi

# Some at a time, for many of them wait, and first those that take their time.
sed -nE 's/^    WRONG\(([a-z0-9_]+), ([a-z]+), ([a-z-]+),.*/\1 \2 \3/p' "$list" > "$work/family"
count=$(wc -l < "$work/family")
$validate --list | awk '/^[a-z]/ { print $1 }' | sort > "$work/checks"
unbroken=$(comm -23 "$work/checks" <(cut -d ' ' -f 3 "$work/family" | sort))
[ -s "$work/checks" ] && [ -z "$unbroken" ] || { echo "no plugin of the family breaks $unbroken, of $(wc -l < "$work/checks") checks"; exit 1; }
[ -z "${WRONG_LEFT_OUT:-}" ] || sed -i -E "/^($WRONG_LEFT_OUT) /d" "$work/family"
# Sanitized, what a check finds is found for one plugin of each.
[ -z "${WRONG_FEW:-}${SV_SANITIZE:-}" ] || { awk '!seen[$3]++' "$work/family" > "$work/few"; mv "$work/few" "$work/family"; }
# The sanitizer keeps the heap for itself, so what these do there is not seen.
[ -z "${SV_SANITIZE:-}" ] || sed -i -E '/^(leaks_memory|frame_allocates|ignores_no_memory) /d' "$work/family"
{ grep -E '^(hang|memory)' "$work/family"; grep -vE '^(hang|memory)' "$work/family"; } |
    xargs -P 4 -L 1 bash "$0" "$source_folder" "$build" > "$work/bad"
cat "$work/bad"
failed=0
[ ! -s "$work/bad" ] || failed=1
for right in library params results life; do
    $validate --level 2 "$build/wrong/right/$right.$ending" > "$work/right" || {
        echo "right/$right.$ending:"
        cat "$work/right"
        failed=1
    }
done
[ "$failed" -ne 0 ] || echo "$(wc -l < "$work/family") of $count wrong plugins, each caught by its check"
exit "$failed"
