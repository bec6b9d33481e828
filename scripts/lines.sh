#!/bin/bash
# SPDX-License-Identifier: MIT
# lines.sh [COMMIT]: files and lines of text of each part of the house, of the working tree or of a commit; then entries at the root,
# includes by a root folder's sources of another one's headers, and words of pages. Left out of the lines, since nobody reads it: ABI
# dumps, the fuzzers' corpus, lists of versions for pip, pictures.
set -eu
cd "$(dirname "$0")/.."
commit=${1:+$(git rev-parse --verify "$1^{commit}")}
text() { git grep "$1" "$2" ${commit:+"$commit"} -- "${@:3}" | sed "s/^$commit://"; }
files() { if [ -n "$commit" ]; then git ls-tree -r --name-only "$commit"; else git ls-files; fi; }

text -Ic '' . ':!abi' ':!tests/fuzz/corpus' ':!python/requirements-*.txt' ':!*.svg' | awk -F: "$(cat scripts/part_of.awk)"'
    { part = part_of($1); files[part]++; lines[part] += $2; all += $2 }
    END { for (part in lines) printf "%-10s %5d files %7d lines\n", part, files[part], lines[part]; printf "%-10s %5d files %7d lines\n", "all", NR, all }' | sort
echo "root       $(files | grep -v '^\.' | sed 's|/.*||' | sort -u | wc -l) entries, but for names with a dot"
{
    files | sed 's/^/:/'
    text -E '^#include "' '*.c' '*.h' ':!tests' ':!examples'
} | awk -F: '
    $1 == "" { known[n++] = $2; next }
    {
        split($2, quoted, "\"")
        to = ""
        for (i = 0; i < n && to == ""; i++)
            if (substr("/" known[i], length(known[i]) + 1 - length(quoted[2])) == "/" quoted[2]) to = known[i]
        sub(/\/.*/, "", to)
        sub(/\/.*/, "", $1)
        across += to != "" && to != $1
    }
    END { printf "includes   %d across folders of the root, tests and examples apart\n", across }'
for folder in docs lab .; do
    echo "pages      $(text -h '' "$folder/*.md" | wc -w) words in ${folder/#./all}"
done
