#!/bin/bash
# SPDX-License-Identifier: MIT
# lines.sh: files and lines of text of each part of the house. Left out, since nobody reads it: ABI dumps, the fuzzers' corpus, lists
# of versions for pip, pictures.
set -eu
cd "$(dirname "$0")/.."
git grep -Ic '' -- . ':!abi' ':!tests/fuzz/corpus' ':!python/requirements-*.txt' ':!*.svg' | awk -F: "$(cat scripts/part_of.awk)"'
    { part = part_of($1); files[part]++; lines[part] += $2; all += $2 }
    END { for (part in lines) printf "%-10s %5d files %7d lines\n", part, files[part], lines[part]; printf "%-10s %5d files %7d lines\n", "all", NR, all }' | sort
