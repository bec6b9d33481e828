#!/bin/bash
# SPDX-License-Identifier: MIT
# check_lines.sh [--write]: lines of text a part of the house may have, by scripts/lines.txt; exit code 1 if one has more. A change
# that makes a part grow makes it or another smaller, or raises the number in a commit of its own that says why. --write: as it is now.
# Left out, since nobody reads it: ABI dumps, the fuzzers' corpus, lists of versions for pip, pictures.
set -eu
cd "$(dirname "$0")/.."
git rev-parse --git-dir > /dev/null 2>&1 || { echo "lines: no git, so nothing is counted"; exit 0; }
counted=$(git grep -Ic '' -- . ':!abi' ':!tests/fuzz/corpus' ':!python/requirements-*.txt' ':!*.svg' | awk -F: "$(cat scripts/part_of.awk)"'
    { lines[part_of($1)] += $2; lines["all"] += $2 }
    END { for (part in lines) print part, lines[part] }' | sort)
[ "${1:-}" != --write ] || echo "$counted" > scripts/lines.txt
raised=$(join <(git show HEAD~1:scripts/lines.txt 2> /dev/null | sort) <(git show HEAD:scripts/lines.txt | sort) | awk '$3 > $2 { print $1 }')
[ -z "$raised" ] || [ "$(git diff --name-only HEAD~1 HEAD)" = scripts/lines.txt ] ||
    { echo "lines: the last commit raises $(xargs <<< "$raised") in scripts/lines.txt, and changes more than that"; exit 1; }
join <(sort scripts/lines.txt) <(echo "$counted") | awk '
    $3 > $2 { print "lines: " $1 ": " $3 ", at most " $2 " (scripts/lines.txt)"; bad = 1 }
    END { exit bad || NR != 5 }'
