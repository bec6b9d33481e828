#!/bin/bash
# SPDX-License-Identifier: MIT
# wrong_table.sh [--tsv MODE] [BUILD [ID...]]: what `host_sim run` makes of every plugin of tests/sdk/wrong, guarded and not, as a
# table. With --tsv, for tests: id, mode, exit code, picture, reason, parted by tabs, in that mode (guard,
# no-guard) only.
#
# picture: unclipped, clipped (the plugin's map was used), none (nothing was written), or WRONG (said to be unclipped, but
# another picture than that of the full volume).
set -u
cd "$(dirname "$0")/.." || exit
modes="guard no-guard" tsv=0
[ "${1:-}" != --tsv ] || { tsv=1 modes=$2; shift 2; }
build=$(realpath "${1:-build}")
[ $# = 0 ] || shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tab=$(printf '\t')

# one ID MODE: a small run; prints its line.
one() {
    local id=$1 mode=$2 out=$work/$1-$2 code reason picture=none
    # Only what hangs meets a limit, however busy the machine is. Without a guard nothing ends it.
    local seconds=1200 limits=300,300
    [[ $id != hang* ]] || limits=8,15
    [[ $mode$id != no-guardhang* ]] || seconds=10
    timeout -k 1 $seconds "$build/host_sim" run --scene E01 --size 32 --lowres 11 --frames 1 --setting smartvis --picture 16 --few-pictures \
        --plugin "$build/wrong/$id.so" "--$mode" --guard-time $limits --guard-memory 512 --out "$out" \
        > "$out.text" 2> "$out.errors"
    code=$?
    # The host's first word; the file's folder says nothing.
    reason=$(sed -n "s|$build/wrong/||g; s|^host_sim run: ||p" "$out.errors" | head -n 1 | tr -d '\000-\037' | cut -c 1-160)
    case $code in
    124 | 137) reason="ended from outside" ;;
    13[0-9]) reason="signal $((code - 128))" ;;
    esac
    if [ -f "$out/result.png" ]; then
        picture=clipped
        ! grep -q '^Frames: 0 clipped' "$out.text" || picture=unclipped
        [ $picture = clipped ] || cmp -s "$out/result.png" "$out/full.png" || picture=WRONG
    fi
    printf '%s\t%s\t%s\t%s\t%s\n' "$id" "$mode" "$code" "$picture" "$reason"
    rm -rf "$out"
}
export -f one
export work build

if [ $# -gt 0 ]; then
    printf '%s\n' "$@" > "$work/ids"
else
    sed -n 's/^    WRONG(\([a-z0-9_]*\), .*/\1/p' tests/sdk/wrong/wrong_list.h > "$work/ids"
fi
# Those that hang take the longest, and no processor.
for mode in $modes; do sed "s/\$/ $mode/" "$work/ids"; done | sort -k 1,1 | awk '/^(hang|memory|count)/ { print; next } { rest[++n] = $0 }
    END { for (i = 1; i <= n; i++) print rest[i] }' |
    xargs -P "$((2 * $(nproc)))" -L 1 bash -c 'one "$@"' bash > "$work/lines" 2> /dev/null
sort -o "$work/lines" "$work/lines"
if [ $tsv = 1 ]; then
    cat "$work/lines"
    exit
fi
echo '| plugin | guarded | code | unguarded | code |'
echo '|---|---|---|---|---|'
# "unclipped: REASON"
cell() { echo "$1${2:+: $2}" | sed 's/|/\\|/g; s/^none: /no picture: /; s/^none$/no picture/'; }
while read -r id; do
    IFS=$tab read -r _ _ code picture reason < <(grep "^$id${tab}guard$tab" "$work/lines")
    IFS=$tab read -r _ _ code2 picture2 reason2 < <(grep "^$id${tab}no-guard$tab" "$work/lines")
    echo "| \`$id\` | $(cell "$picture" "$reason") | $code | $(cell "$picture2" "$reason2") | $code2 |"
done < "$work/ids"
