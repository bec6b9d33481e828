#!/bin/bash
# SPDX-License-Identifier: MIT
# same_maps.sh HOST_SIM OTHER [VOLUME...]: whether two builds of host_sim, each with the plugin beside it, make the same depthmaps to the
# bit: of the nine scenes and of these volumes, by every method. Names what differs; exit code 1 if anything does.
set -eu
programs=("$1" "$2")
shift 2
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
methods=$("$root/scripts/list_methods.sh")
inputs=(E01 E02 E03 E04 M01 M02 M03 D01 D02 "$@")

failed=0
for method in $methods; do
    same=0
    for input in "${inputs[@]}"; do
        what=(--volume "$input")
        [ -f "$input" ] || what=(--scene "$input" --size 64)
        for i in 0 1; do
            "${programs[i]}" run "${what[@]}" --setting smartvis --set "method=$method" --frames 1 --few-pictures --picture 32 \
                --write depthmap --out "$work/$i" > "$work/said" || { cat "$work/said"; exit 1; }
        done
        if cmp -s "$work/0/depthmap.mha" "$work/1/depthmap.mha"; then same=$((same + 1)); else echo "$method: $input differs" && failed=1; fi
    done
    echo "$method: $same of ${#inputs[@]} depthmaps are the same"
done
exit $failed
