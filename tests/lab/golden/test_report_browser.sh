#!/bin/bash
# SPDX-License-Identifier: MIT
# The evaluation's page and the demo's in headless Chromium, where there is one (page_looks.py says what is looked at). At night of all
# nine cases. Called with the source and the build folder.
set -eu
build=$2
for program in chromium chromedriver; do
    command -v "$program" > /dev/null || {
        echo "skipped: no $program"
        exit 77
    }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
few=(--case E04 --case D01)
[ -z "${SV_NIGHT:-}" ] || few=()
"$build/host_sim" report --quick --size 48 --frames 1 "${few[@]}" --out "$work/report" > /dev/null 2>&1
"$build/host_sim" demo --quick --picture 64 --out "$work/demo" > /dev/null 2>&1
grep -q 'class="slider' "$work/report/index.html"
grep -q 'class="row wide' "$work/demo/index.html"
python3 -B "$1/tests/host_sim/console/page_looks.py" "$work/report/index.html" "$work/demo/index.html"
