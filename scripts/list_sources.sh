#!/bin/bash
# SPDX-License-Identifier: MIT
# list_sources.sh EXTENSION...: the project's own files with these extensions, one a line, relative to the root.
# Works without git. Built folders and results are left out.
set -eu
cd "$(dirname "$0")/.."
names=()
for extension in "$@"; do
    names+=(-o -name "*.$extension")
done
find . \( -path ./.git -o -path './build*' -o -path ./out \) -prune -o -type f \( "${names[@]:1}" \) -print |
    sed 's|^\./||' | sort
