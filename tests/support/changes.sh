# SPDX-License-Identifier: MIT
# Sourced by tests of scripts/check_abi.sh, $promise: its option, if any, and $folder with the headers. As they are it finds nothing in
# them. Then the test changes them in one way each, and asks whether that is an addition: every fourth change by day, all with SV_NIGHT.
# What it says is in $work/said.
# shellcheck source=tests/support/holds.sh
. "$source_dir/tests/support/holds.sh"
change=0
guard() { bash "$source_dir/scripts/check_abi.sh" ${promise:+"$promise"} "$@" > "$work/said" 2>&1; }

guard
code=$?
if [ $code = 3 ]; then
    cat "$work/said"
    exit 77
fi
holds test $code = 0
holds test ! -s "$work/said"

# change HEADER PERL: a fresh copy of the headers in $folder, changed; the change must change something.
change() {
    rm -rf "$work/include"
    cp -r "$folder" "$work/include"
    perl -0pi -e "$2" "$work/include/$1"
    ! cmp -s "$folder/$1" "$work/include/$1"
}
today() { [ -n "${SV_NIGHT:-}" ] || [ $((change++ % 4)) = 0 ]; }
refused() { # refused WORDS HEADER PERL
    today || return 0
    checked=$((checked + 1))
    if ! change "$2" "$3" || guard "$work/include" || ! grep -qF -- "$1" "$work/said"; then
        echo "FAIL: not refused with '$1': $2: $3"
        cat "$work/said"
        failed=$((failed + 1))
    fi
}
allowed() { # allowed HEADER PERL
    today || return 0
    checked=$((checked + 1))
    if ! change "$1" "$2" || ! guard "$work/include"; then
        echo "FAIL: not allowed: $1: $2"
        cat "$work/said"
        failed=$((failed + 1))
    fi
}
