#!/bin/bash
# SPDX-License-Identifier: MIT
# What the built library shows to the world: one symbol, three libraries, no writable global state, no code that runs at
# load time. And the host program has none of the plugin's code linked in.
set -eu
source_dir=$1 build_dir=$2
library=$build_dir/smartvis.so
[ -f "$library" ] || { echo "no $library"; exit 1; }
failures=0
fail() {
    echo "failed: $*"
    failures=$((failures + 1))
}

exported=$(nm -D --defined-only "$library" | awk '{print $3}' | tr '\n' ' ')
[ "$exported" = "smartvis_plugin_entry " ] || fail "exports '$exported', expected smartvis_plugin_entry only"

needed=$(readelf -dW "$library" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
allowed='lib(c\.so\.6|m\.so\.6|OpenCL\.so\.1)'
[ -z "${SV_SANITIZE:-}" ] || allowed='lib(c\.so\.6|m\.so\.6|OpenCL\.so\.1|asan\.so\.[0-9]+|ubsan\.so\.[0-9]+|gcc_s\.so\.1)'
for name in $needed; do
    [[ $name =~ ^$allowed$ ]] || fail "needs $name"
done
grep -qx 'libOpenCL.so.1' <<< "$needed" || fail "does not name libOpenCL.so.1 as needed: a host without it could not load the library"

# Lines of readelf -S as "number name size(hex)".
sections=$(readelf -SW "$library" | sed -n 's/^ *\[ *\([0-9]*\)\] *\([^ ]*\) *[A-Z_]* *[0-9a-f]* *[0-9a-f]* *\([0-9a-f]*\) .*/\1 \2 \3/p')
section_name() { awk -v n="$1" '$1 == n {print $2}' <<< "$sections"; }

# The entry is constant: in read-only data, or in data that is read-only after relocation.
index=$(readelf --dyn-syms -W "$library" | awk '$8 == "smartvis_plugin_entry" {print $7}')
[[ $(section_name "$index") =~ ^\.(rodata|data\.rel\.ro) ]] || fail "the entry is in $(section_name "$index"), which is writable"

# Instrumented builds have sections and constructors of their own.
if [ -z "${SV_SANITIZE:-}" ]; then
    # One constructor, which the compiler's start files bring along (frame_dummy).
    [ "$(awk '$2 == ".init_array" {print $3}' <<< "$sections" | sed 's/^0*//')" = 8 ] || fail "code runs when the library is loaded"

    # Objects in writable sections: those of the start files only.
    while read -r name section; do
        case $(section_name "$section") in
        .data | .bss | .tdata | .tbss | .data.* | .bss.*)
            [[ $(section_name "$section") == .data.rel.ro* || $name =~ ^(completed\.[0-9]+|__dso_handle|__TMC_END__)$ ]] ||
                fail "writable global state: $name in $(section_name "$section")"
            ;;
        esac
    done < <(readelf -sW "$library" | awk '($4 == "OBJECT" || $4 == "TLS") && $7 ~ /^[0-9]+$/ {print $8, $7}' | sort -u)
fi

# Tables of the loader are read-only once a library or a program has been loaded.
for file in "$library" "$build_dir/host_sim"; do
    [ -f "$file" ] || continue
    readelf -dW "$file" | grep -qE 'BIND_NOW|NOW' || fail "$file: symbols are bound late"
    readelf -lW "$file" | grep -q GNU_RELRO || fail "$file: without RELRO"
done

if [ -f "$build_dir/host_sim" ]; then
    # But for what public headers define for all who include them.
    linked=$(nm "$build_dir/host_sim" | awk '$2 ~ /^[TtDdBbRr]$/ && $3 ~ /^sv_/ {print $3}' |
        { grep -vxFf <(grep -hoE '\bsv_[a-z_]+' "$source_dir"/include/smartvis/*.h) || true; } | tr '\n' ' ')
    [ -z "$linked" ] || fail "host_sim has code of the plugin in it: $linked"
fi

# The static library: the entry is all that is visible of it, and a host that links it needs no other library than the plugin.
visible=$(readelf -sW "$build_dir/libsmartvis.a" | awk '$5 == "GLOBAL" && $6 == "DEFAULT" && $7 != "UND" { print $8 }' | sort -u)
[ -z "${SV_SANITIZE:-}" ] || visible=$(grep -v '^__odr_asan\.' <<< "$visible")
[ "$visible" = smartvis_plugin_entry ] || fail "libsmartvis.a shows '$visible'"
if [ -z "${SV_SANITIZE:-}" ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    printf '#include "smartvis_plugin.h"\n#include <stdio.h>\nextern const sv_entry smartvis_plugin_entry;\n%s\n' \
        'int main(void) { return puts(smartvis_plugin_entry.descriptor(0)->id) < 0; }' > "$work/host.c"
    cc -I "$1/include" "$work/host.c" "$build_dir/libsmartvis.a" -lOpenCL -lm -o "$work/host" || fail "nothing can be linked with libsmartvis.a"
    [ "$("$work/host")" = org.smartvis.clip ] || fail "the linked host finds no plugin"
fi

echo "exports: ${exported}needs: $(tr '\n' ' ' <<< "$needed")"
[ $failures = 0 ]
