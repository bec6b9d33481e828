#!/bin/bash
# SPDX-License-Identifier: MIT
# check_abi.sh [--write] [INCLUDE_FOLDER]: what of the plugin ABI differs from the versions before it, as libabigail's abidiff
# sees it. Additions are fine: a field behind the last one of a struct that may grow, a constant, an extension. Everything else is
# printed, and the exit code is 1; 3 if a tool is missing. Of the headers of extensions each has a table sv_ext_NAME; the helpers
# (author*.h, lookup.h, open.h, probe.h) are compiled into plugins and hosts, so they are no ABI.
#
#   abi/smartvis-VERSION.abi    the types, written by abidw
#   abi/constants-VERSION.txt   the constants, of which debug information says nothing
#
# Every version that has a dump is compared with. --write adds that of the version the header names, when it is released.
set -eu
export LC_ALL=C
write=0
if [ "${1:-}" = --write ]; then write=1 && shift; fi
root=$(cd "$(dirname "$0")/.." && pwd)
include=$(cd "${1:-$root/include}" && pwd)
for tool in abidw abidiff gcc; do
    command -v $tool > /dev/null || { echo "abi: no $tool: apt-get install abigail-tools gcc" >&2; exit 3; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

headers=() # of extensions
for header in "$include"/smartvis/*.h; do
    [[ $(basename "$header") =~ ^(author.*|lookup|open|probe)\.h$ ]] || headers+=("$(basename "$header" .h)")
done

# A function for each table, so that another extension is another function and changes none.
{
    printf '#include "smartvis_plugin.h"\nSV_EXPORT void sv_abi(const sv_entry *entry) { (void)entry; }\n'
    for name in "${headers[@]}"; do
        printf '#include "smartvis/%s.h"\n' "$name"
        printf 'SV_EXPORT void sv_abi_%s(const sv_ext_%s *table) { (void)table; }\n' "$name" "$name"
    done
} > types.c
gcc -std=c11 -g -gdwarf-4 -shared -fPIC -I "$include" types.c -o types.so
abidw --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed --no-architecture --type-id-style hash \
    --out-file types.abi types.so

files=("${headers[@]/#/smartvis/}")
files=("${files[@]/%/.h}")
# Every word in capitals that is left without the comments and is a value: NAME TYPE VALUE.
(cd "$include" && cat smartvis_plugin.h "${files[@]}") > all.h
gcc -w -fpreprocessed -dD -E -P all.h | grep -oE '\bSV_[A-Z0-9_]+\b' | sort -u |
    grep -vE '^SV_(ABI_MINOR|CALL|EXPORT|HAS|BIT)$' > names
{
    printf '#include "smartvis_plugin.h"\n'
    printf '#include "smartvis/%s.h"\n' "${headers[@]}"
    printf '#include <stdio.h>\nstatic void text(const char *n, const char *v) { printf("%%s text %%s\\n", n, v); }\n'
    printf 'static void real(const char *n, double v) { printf("%%s real %%.17g\\n", n, v); }\n'
    printf 'static void whole(const char *n, long long v) { printf("%%s whole %%lld\\n", n, v); }\nint main(void) {\n'
    while read -r name; do
        printf '    _Generic((%s), char *: text, const char *: text, float: real, double: real, default: whole)("%s", %s);\n' \
            "$name" "$name" "$name"
    done < names
    printf '    return 0;\n}\n'
} > constants.c
gcc -std=c11 -I "$include" constants.c -o constants
./constants > constants.txt

if [ $write = 1 ]; then
    version=$(awk '/^#define SV_ABI_(MAJOR|MINOR) / { printf "%s%d", dot, $3; dot = "." }' "$include/smartvis_plugin.h")
    cp types.abi "$root/abi/smartvis-$version.abi"
    cp constants.txt "$root/abi/constants-$version.txt"
    exit 0
fi

# abidiff's own rule for members at the end lets changes of other members pass, so its report is read here: what is known to
# be an addition is let through, every other line is a breach. The exit code says if there is a report at all.
types() { # types DUMP
    local code=0
    abidiff --leaf-changes-only --harmless --no-show-locs "$1" types.abi > report || code=$?
    [ $((code & 3)) = 0 ] || { cat report; echo "abi: abidiff failed"; return 1; }
    awk '
function breach(line) { print "abi: " (type != "" ? type ": " : "") line; failed = 1 }
/^$/ || /^Leaf changes summary:/ || /^Changed leaf types summary:/ { next }
/^Removed\/Changed\/Added (functions|variables) summary: 0 Removed, 0 Changed, / { next }
/^[0-9]+ Added functions?:$/ || /^ *\[A\] / { next }
/^.struct [a-z_]+.*changed:$/ { type = $2; sub(/\x27.*/, "", type); next }
/^  type size changed from [0-9]+ to [0-9]+ \(in bits\)$/ {
    old = $5
    # They travel in arrays: another size is another distance between elements.
    if (type ~ /^sv_(param_value|scanned)$/) breach("never grows, but" substr($0, 2))
    next
}
/^  type size hasn.t changed$/ { old = 1e9; next }
/^  [0-9]+ data member insertions?:$/ { next }
/^    .*, at offset [0-9]+ \(in bits\)$/ {
    match($0, /at offset [0-9]+/)
    if (substr($0, RSTART + 10, RLENGTH - 10) + 0 < old) breach("a field before the end:" substr($0, 4))
    next
}
{ sub(/^ +/, ""); breach($0) }
END { exit failed }' report
}

# A field that is called otherwise: the same to a binary, and abidiff says little of it, but sources stop to compile.
fields() {
    awk -F"'" '
    /<class-decl / { for (i = 1; i < NF; i += 2) if ($i ~ / name=$/) name = $(i + 1) }
    /<\/class-decl>/ { name = "" }
    /<var-decl / && name != "" { print name "." $2 }' "$1"
}
fields types.abi > fields.txt
names() { # names DUMP
    local code=0
    while read -r field; do
        grep -qxF -- "$field" fields.txt || { echo "abi: $field: gone, or called otherwise"; code=1; }
    done < <(fields "$1")
    return $code
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
for dump in "$root"/abi/smartvis-*.abi; do
    version=${dump##*smartvis-} version=${version%.abi}
    types "$dump" || failed=1
    names "$dump" || failed=1
    constants "$root/abi/constants-$version.txt" || failed=1
done
exit $failed
