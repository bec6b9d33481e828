#!/bin/bash
# SPDX-License-Identifier: MIT
# The hard cases have rows of their own in the report, a turned camera and a scene without a fetus among them. What the latter
# does not have is "-", and the mean is that of the others. All of them at night. Called with the source and the build folder.
set -u
build=$2
. "$1/tests/support/holds.sh"

names=(H01 H10 H16)
asked=("${names[@]/#/--case=}")
[ -z "${SV_NIGHT:-}" ] || { names=(H{01..16}) && asked=(--hard); }
"$build/host_sim" report "${asked[@]}" --size 64 --lowres 16 --coarse --frames 0 --out "$work/hard" \
    > "$work/stdout" 2> "$work/stderr"
holds [ $? -eq 0 ]
best=$work/hard/best.csv
holds [ "$(cut -d, -f1 "$best" | tr '\n' ' ')" = "case ${names[*]} mean " ]
holds grep -qE '^H10,([^,]*,){7}-,' "$best"
holds grep -qE '^mean,([^,]*,){7}[0-9]' "$best"
holds grep -q 'H16' "$work/hard/index.html"
[ "${failed:-1}" -eq 0 ]
