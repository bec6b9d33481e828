#!/bin/bash
# SPDX-License-Identifier: MIT
# What docs/stability.md promises by name is there: the plugin's parameters and their enums' values, Python's names, the exit codes,
# versions of files. More may be there. Called with the source and the build folder.
# Requirement: R16.
set -u
source_dir=$1 build=$2
. "$source_dir/tests/support/holds.sh"
page=$source_dir/docs/stability.md
# The names in backticks of the paragraph that begins with a word.
promised() { awk -v word="$1: " 'index($0, word) == 1 { on = 1 } on && /^$/ { exit } on' "$page" | grep -oE '`[A-Za-z_0-9]+`' | tr -d '`'; }

# --- parameters, and the names of their values, in their order: a number in a stored setting means the same
"$build/host_sim" list --all > "$work/list"
awk '/^[A-Z][a-z]/ { on = 1 } on && /^  [a-z]/ { print $1 }' "$work/list" | sort > "$work/keys"
holds test "$(promised Parameters | wc -l)" -ge 22
for key in $(promised Parameters); do holds grep -qx "$key" "$work/keys"; done
# begins KEY VALUES: an enum has these values first
begins() {
    local found
    found=$(awk -v key="$1" '$1 == key { getline; sub(/^ *enum, /, ""); sub(/, default .*/, ""); print }' "$work/list")
    [[ "$found |" == "$2 |"* ]] || { echo "$1 is '$found', promised is '$2'"; return 1; }
}
while read -r key values; do
    holds begins "$key" "$values"
done << 'ENUMS'
method mean | minimum | spline | wall
unsure keep | clip
bone_mode absolute | offset | fraction
prefilter none | minimum
precision float64 | float32
strategy auto | single | bands | rays
ENUMS

# --- Python: what is offered to all
sed -n '/^__all__/,/^]/p' "$source_dir/python/smartvis/__init__.py" | grep -oE '"\w+"' | tr -d '"' > "$work/names"
holds test "$(promised Python | wc -l)" -ge 27
for name in $(promised Python); do holds grep -qx "$name" "$work/names"; done

# --- exit codes, as they are brought about
code() { local wanted=$1; shift; "$@" > "$work/said" 2>&1; [ $? = "$wanted" ] || { cat "$work/said"; return 1; }; }
run=("$build/host_sim" run --scene E01 --size 32 --setting smartvis --frames 1 --few-pictures --picture 64 --out "$work/out")
holds code 0 "${run[@]}"
holds code 1 "$build/sv_validate" "$build/wrong/depth_nan.so" --only depth-values
holds code 2 "${run[@]}" --no-such-option
holds code 3 "$build/host_sim" info "$0"
holds code 4 "${run[@]}" --plugin "$0"
OCL_ICD_VENDORS=$work/nothing holds code 5 "${run[@]}"
holds code 6 "$build/host_sim" run --scene E01 --size 32 --picture 64 --out "$0/folder"

# --- every test says what it shows: the table of docs/soup.md is made of that
holds python3 "$source_dir/scripts/test_table.py" "$source_dir" > "$work/table"
holds grep -qF '| tests/house/package/test_stability.sh | package | What docs/stability.md promises by name is there: ' "$work/table"
mkdir -p "$work/silent/tests/house/package" && echo 'int main(void) { return 0; }' > "$work/silent/tests/house/package/test_silent.c"
holds code 1 python3 "$source_dir/scripts/test_table.py" "$work/silent"

# --- every requirement of docs/soup.md has a test, and no test names another one
holds python3 "$source_dir/scripts/test_table.py" --requirements "$source_dir" > "$work/table"
holds grep -qF 'tests/house/package/test_stability.sh' <(grep '^| R16 |' "$work/table")
mkdir "$work/silent/docs" && printf '| R1 | It works. |\n' > "$work/silent/docs/soup.md"
holds code 1 python3 "$source_dir/scripts/test_table.py" --requirements "$work/silent"
holds grep -qx 'test_table: requirement R1: no test names it' "$work/said"
printf '/* What works. Requirements: R1, R2. */\n' > "$work/silent/tests/house/package/test_silent.c"
holds code 1 python3 "$source_dir/scripts/test_table.py" --requirements "$work/silent"
holds grep -qx 'test_table: requirement R2: tests/house/package/test_silent.c names it, and it is none' "$work/said"

# --- versions of files
holds grep -q "^#define REC_VERSION 2u$" "$source_dir/sdk/record/rec_item.h"

echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
