#!/bin/bash
# SPDX-License-Identifier: MIT
# steps.sh [COMMIT...]: what commits cost, as a table: text files and their lines by folder, and what a build from nothing takes,
# in steps and in processor seconds. By default of HEAD. With STEPS_BUILD=0 nothing is built.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
[ $# -gt 0 ] || set -- HEAD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for commit in "$@"; do
    tree=$work/tree
    mkdir -p "$tree"
    git -C "$root" archive "$commit" | tar -x -C "$tree"
    echo "$(git -C "$root" log -1 --format='%h %s' "$commit")"
    # grep -I: a file with a NUL is no text.
    (cd "$tree" && find . -type f | sort | xargs -d '\n' grep -IlE '' | xargs -d '\n' wc -l | grep -v ' total$') |
        awk '{ n = split($2, part, "/"); folder = n > 2 ? part[2] : "."; files[folder]++; lines[folder] += $1 }
            END { for (f in files) { printf "  %-12s %5d files %7d lines\n", f, files[f], lines[f]; a += files[f]; b += lines[f] }
                  printf "  %-12s %5d files %7d lines\n", "~ in all", a, b }' | sort
    if [ "${STEPS_BUILD:-1}" = 1 ]; then
        cmake -S "$tree" -B "$work/build" -G Ninja > /dev/null
        for targets in "host_sim smartvis" all; do
            # shellcheck disable=SC2086 # words
            printf '  %-18s %5d steps' "$targets" "$(ninja -C "$work/build" -t commands $targets | wc -l)"
            before=$(awk '{ print $16 + $17 }' /proc/$$/stat)
            # shellcheck disable=SC2086
            cmake --build "$work/build" --target $targets > "$work/log" 2>&1 || { tail -n 20 "$work/log" >&2 && exit 1; }
            awk -v b="$before" -v h="$(getconf CLK_TCK)" '{ printf " %7.1f s\n", ($16 + $17 - b) / h }' /proc/$$/stat
        done
    fi
    rm -rf "$tree" "$work/build"
done
