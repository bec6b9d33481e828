#!/bin/bash
# SPDX-License-Identifier: MIT
# check_rules.sh: the house rules that a pattern can tell. Prints every breach; exit code 1 if there is one.
set -u
cd "$(dirname "$0")/.."
failed=0
complain() {
    echo "house rule: $*"
    failed=1
}

mapfile -t sources < <(scripts/list_sources.sh c h hpp cpp rs cl clh)
mapfile -t texts < <(scripts/list_sources.sh c h hpp cpp rs cl clh toml sh cmake txt md json map)
texts+=(.ci/run)

# One idea a file: 450 lines at most. The ABI header is one document on purpose, half of it comments: 600.
for file in "${sources[@]}"; do
    limit=450
    [ "$file" != include/smartvis_plugin.h ] || limit=600
    lines=$(wc -l < "$file")
    [ "$lines" -le $limit ] || complain "$file: $lines lines, at most $limit"
done

# grep's findings are the breaches; the words are split here so that this file does not find itself.
tab=$'\t'
while read -r line; do complain "tab: $line"; done < <(grep -nH "$tab" "${texts[@]}" | cut -c 1-100)
while read -r line; do complain "a merge that was not finished: $line"; done < <(grep -nHE '^(<{7}|>{7}) ' "${texts[@]}")
while read -r line; do complain "trailing blanks: $line"; done < <(grep -nHE ' +$' "${texts[@]}" | cut -c 1-100)
while read -r line; do complain "unfinished: $line"; done < <(grep -nHwE 'TO''DO|FIX''ME|X''XX' "${texts[@]}" | cut -c 1-120)
# A path of somebody's machine in a source works on that machine only.
while read -r line; do complain "machine path: $line"; done < <(grep -nHE '(^|[^a-z.])/(home|work|root|Users)/' "${sources[@]}" | cut -c 1-120)

# What a user moves has one name, "surface position"; a plugin in general has a "primary parameter".
read_by_people=(README.md docs/*.md include/*.h include/smartvis/*.h python/smartvis/*.py examples/*/* host_sim/console/*.{html,js,css})
while read -r line; do complain "say surface position, or primary parameter: $line"; done < <(
    grep -nHwiE -d skip 'kno''bs?|surface off''set' "${read_by_people[@]}" | cut -c 1-120
    grep -nHiE '"[^"]*\b(kno''bs?|surface off''set)\b[^"]*"' "${sources[@]}" | grep -vE '(^|/)tests/' | cut -c 1-120)

# Every source says its licence.
for file in "${sources[@]}" $(scripts/list_sources.sh sh cmake py toml); do
    head -n 2 "$file" | grep -q 'SPDX-License-Identifier: MIT' || complain "$file: no SPDX-License-Identifier"
done

# Headers are read once: by a guard, or where they are not installed by a pragma.
for file in "${sources[@]}"; do
    [[ $file == *.h ]] || continue
    guard="#ifndef [A-Z_]*$(basename "$file" .h | tr 'a-z' 'A-Z')_H"
    [[ $file == include/* ]] || guard+='|#pragma once'
    grep -qE "^($guard)\$" "$file" || complain "$file: no line $guard"
done

# File names are in lower snake case and unique, but for include/smartvis/, whose headers are named as the extensions are.
for file in "${sources[@]}"; do
    [[ $(basename "$file") =~ ^[a-z][a-z0-9_]*\.[a-z]+$ ]] || complain "$file: not lower snake case"
done
while read -r name; do complain "$name: two files of one name"; done < <(printf '%s\n' "${sources[@]}" | grep -v '^include/smartvis/' | sed 's|.*/||' | sort | uniq -d)

exit $failed
