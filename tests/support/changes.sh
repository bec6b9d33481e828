# SPDX-License-Identifier: MIT
# Sourced behind holds.sh by tests that change headers in $folder, one way at a time, and ask `guard FOLDER` whether that is an addition:
# every fourth change by day, all with SV_NIGHT. What it says is in $work/said.
change=0

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
