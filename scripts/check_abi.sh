#!/bin/bash
# SPDX-License-Identifier: MIT
# check_abi.sh [--door] [--write] [INCLUDE_FOLDER]: what of the plugin ABI differs from the versions before it. Additions are fine: a
# field behind the last one of a struct that may grow, a constant, an extension. Everything else is printed, and the exit code is 1; 3
# if a tool is missing. Of the headers of extensions each has a table sv_ext_NAME; the others are helpers, which are compiled
# into plugins and hosts, so they are no ABI. --door: of libsmartvis_host instead, where a function is an addition, too.
#
#   abi/types-VERSION.txt       structs and fields, as libabigail's abidw sees them (scripts/abi_types.py); the door's functions, too
#   abi/constants-VERSION.txt   the constants, of which debug information says nothing
#   abi/door/                   both, of the door
#
# Every version that has a dump is compared with. --write adds that of the version the header names, when it is released; of the
# door, that of CMakeLists.txt.
set -eu
export LC_ALL=C
door=0 write=0
if [ "${1:-}" = --door ]; then door=1 && shift; fi
if [ "${1:-}" = --write ]; then write=1 && shift; fi
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $door = 1 ]; then
    folder=$root/host_sim/door dumps=$root/abi/door prefix=SVH files=(smartvis_host.h)
else
    folder=$root/include dumps=$root/abi prefix=SV files=(smartvis_plugin.h)
fi
include=$(cd "${1:-$folder}" && pwd)
for tool in abidw gcc python3; do
    command -v $tool > /dev/null || { echo "abi: no $tool: apt-get install abigail-tools gcc python3" >&2; exit 3; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

extensions=()
if [ $door = 0 ]; then
    for header in "$include"/smartvis/*.h; do
        name=$(basename "$header" .h)
        if grep -q "^} sv_ext_$name;" "$header"; then extensions+=("$name") && files+=("smartvis/$name.h"); fi
    done
fi
# The headers as C without comments.
(cd "$include" && cat "${files[@]}") > all.h
gcc -w -fpreprocessed -dD -E -P all.h > plain.h

# A function for each table of the plugin's, and a pointer to each function of the door's: another one changes none.
{
    printf '#include "%s"\n' "${files[@]}"
    if [ $door = 1 ]; then
        grep -oE '\bsvh_[a-z_]+\(' plain.h | tr -d '(' | sort -u | sed 's/.*/__typeof__(\&&) is_&;/'
    else
        printf 'SV_EXPORT void sv_abi(const sv_entry *entry) { (void)entry; }\n'
        for name in "${extensions[@]}"; do
            printf 'SV_EXPORT void sv_abi_%s(const sv_ext_%s *table) { (void)table; }\n' "$name" "$name"
        done
    fi
} > types.c
gcc -std=c11 -g -gdwarf-4 -shared -fPIC -I "$include" types.c -o types.so
abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-architecture --type-id-style hash \
    --out-file types.abi types.so
python3 -B "$root/scripts/abi_types.py" types.abi > types.txt

# Every word in capitals that is a value: NAME TYPE VALUE.
grep -oE "\b${prefix}_[A-Z0-9_]+\b" plain.h | sort -u | grep -vE '^(SV_(ABI_MINOR|CALL|HAS|BIT)|SVH?_EXPORT)$' > names
{
    printf '#include "%s"\n' "${files[@]}"
    printf '#include <stdio.h>\nstatic void text(const char *n, const char *v) { printf("%%s text %%s\\n", n, v); }\n'
    printf 'static void real(const char *n, double v) { printf("%%s real %%.17g\\n", n, v); }\n'
    printf 'static void whole(const char *n, long long v) { printf("%%s whole %%lld\\n", n, v); }\nint main(void) {\n'
    while read -r name; do
        printf '    _Generic((%s), char *: text, const char *: text, float: real, double: real, default: whole)("%s", %s);\n' \
            "$name" "$name" "$name"
    done < names
    printf '    return 0;\n}\n'
} > constants.c
gcc -w -std=c11 -I "$include" constants.c -o constants
./constants > constants.txt

if [ $write = 1 ]; then
    if [ $door = 1 ]; then
        version=$(sed -n 's/^project(smartvis VERSION \([0-9]*\.[0-9]*\).*/\1/p' "$root/CMakeLists.txt")
    else
        version=$(awk '/^#define SV_ABI_(MAJOR|MINOR) / { printf "%s%d", dot, $3; dot = "." }' "$include/smartvis_plugin.h")
    fi
    mkdir -p "$dumps"
    cp types.txt "$dumps/types-$version.txt"
    cp constants.txt "$dumps/constants-$version.txt"
    exit 0
fi

# Fields and functions that are gone, called otherwise, elsewhere or of another type; fields before the end; structs that shrink, or
# grow and never may.
types() { # types DUMP
    awk '
    function breach(line) { print "abi: " line; failed = 1 }
    function rest(line) { sub(/^[^ ]+ /, "", line); return (line ~ /^[0-9]/ ? "at " : "") line }
    NR == FNR && $2 == "size" { size[$1] = $3; next }
    NR == FNR { field[$1] = $0; next }
    $2 == "size" { size_now[$1] = $3; next }
    {
        now[$1] = $0
        struct = $1
        sub(/[.].*/, "", struct)
        if (!($1 in field) && struct in size && $2 < size[struct]) breach(struct ": a field before the end: " $0)
    }
    END {
        for (f in field)
            if (!(f in now)) breach(f ": gone, or called otherwise")
            else if (now[f] != field[f]) breach(f ": was " rest(field[f]) ", is " rest(now[f]))
        for (s in size)
            if (size_now[s] < size[s]) breach(s ": had " size[s] " bytes, has " size_now[s] + 0)
            else if (size_now[s] > size[s] && s ~ /^sv(_param_value|_scanned|h_mark)$/) # arrays: another size is another distance
                breach(s ": never grows, but has " size_now[s] " bytes")
        exit failed
    }' "$1" types.txt
}

# A constant that is gone or has another value.
constants() { # constants LIST
    local code=0
    while read -r line; do
        grep -qxF -- "$line" constants.txt || {
            echo "abi: constant $line: now $(grep "^${line%% *} " constants.txt || echo gone)"
            code=1
        }
    done < "$1"
    return $code
}

failed=0
for dump in "$dumps"/types-*.txt; do
    types "$dump" || failed=1
    constants "${dump/types-/constants-}" || failed=1
done
exit $failed
