#!/bin/bash
# SPDX-License-Identifier: MIT
# check_includes.sh [ROOT]: who may include whom. Prints every line that breaks the rule; exit code 1 if there is one.
#
#   folder         may include
#   include/       <stdint.h>, <stddef.h>
#   include/smartvis/ include/, the C library
#   cl/FAMILY/     cl/common/, itself
#   src/LAYER/     include/, src/, cl/common/sv_shared.h, the C library, <CL/...>
#   src/ref/       include/, src/ref/, cl/common/sv_shared.h, the C library                 (no OpenCL)
#   host_sim/ROOM/ include/, host_sim/, the C library, <CL/...>, png, turbojpeg, cairo, fontconfig, zlib, jansson;
#                  never src/ or cl/
#   host_sim/render/cl/  itself
#   examples/NAME/ include/, the C library, <CL/...>
#   bench/, tests/                                                             anything
set -eu
cd "${1:-$(dirname "$0")/..}"

families='common|profile|chain|mean|minimum|spline|pushpull|grid|cost'
layers='abi|frame|method|device|ref'
examples='first_edge|kernel_edge|small_host'
rooms='base|volume|picture|plugin|render|scene|loop|eval|report|commands'

# The C library and POSIX headers that C code here may use.
libc='(assert|ctype|dirent|dlfcn|errno|fcntl|fenv|float|getopt|inttypes|limits|locale|math|pthread|signal|stdalign|stdarg|stdatomic|stdbool|stddef|stdint|stdio|stdlib|string|strings|threads|time|unistd|wchar|sys/[a-z]+)\.h'
opencl='CL/[a-z_]+\.h'
libraries='(png|turbojpeg|zlib|jansson|cairo|cairo/cairo|fontconfig/fontconfig)\.h'

failed=0
complain() {
    echo "include rule: $1:$2: $3 ($4)"
    failed=1
}

# may_include NAME PLACE...: true if the quoted name is found in one of the places. A place is a folder; or PREFIX/=FOLDER,
# where names begin with the prefix; or the name itself (a generated file, the shared header).
may_include() {
    local name=$1 place
    shift
    [[ $name != *..* && $name != /* ]] || return 1
    for place in "$@"; do
        case $place in
        "$name") return 0 ;;
        *=*) [[ $name == "${place%%=*}"* && -f ${place#*=}/${name#"${place%%=*}"} ]] && return 0 ;;
        *) [ -f "$place/$name" ] && return 0 ;;
        esac
    done
    return 1
}

# include_lines FILE...: "file:line:text" of every line that includes something, of those files that exist.
include_lines() { grep -nHsE '^[[:space:]]*(#|%:)[[:space:]]*(include|import|embed)' "$@" || true; }

# check_folder FOLDER ALLOWED_SYSTEM_REGEX PLACE...: all sources directly in FOLDER.
check_folder() {
    local folder=$1 system=$2 file line number name
    shift 2
    while IFS=: read -r file number line; do
        if [[ $line =~ ^[[:space:]]*#[[:space:]]*include[[:space:]]*\<([^\>]*)\> ]]; then
            name=${BASH_REMATCH[1]}
            [[ $name =~ ^$system$ ]] || complain "$file" "$number" "<$name>" "not for $folder/"
        elif [[ $line =~ ^[[:space:]]*#[[:space:]]*include[[:space:]]*\"([^\"]*)\" ]]; then
            name=${BASH_REMATCH[1]}
            may_include "$name" "$@" || complain "$file" "$number" "\"$name\"" "not for $folder/"
        else
            complain "$file" "$number" "$line" "include a file by its name"
        fi
    done < <(include_lines "$folder"/*.{c,h,cl,clh})
}

check_folder include '(stdint|stddef)\.h'
check_folder include/smartvis "$libc" include
for folder in ${families//|/ }; do
    check_folder "cl/$folder" '(none)' "common/=cl/common" "$folder/=cl/$folder"
done
for folder in abi frame method device; do
    check_folder "src/$folder" "($libc|$opencl)" include src common/sv_shared.h \
        kernels_{frame,chain,cost,mean_maps,minimum,spline,pushpull,grid}.h
done
check_folder src/ref "$libc" include ref/=src/ref common/sv_shared.h
for folder in ${rooms//|/ }; do
    check_folder "host_sim/$folder" "($libc|$opencl|$libraries)" include host_sim hs_kernels_embedded.h
done
check_folder host_sim/render/cl '(none)' host_sim/render/cl
for folder in ${examples//|/ }; do
    check_folder "examples/$folder" "($libc|$opencl)" include
done

# A folder that the table does not know would escape it.
while read -r file; do
    complain "$file" 1 "a source in a folder without a rule" "known: include cl/* src/* host_sim/* host_sim/render/cl examples/* bench tests"
done < <(find . \( -path './build*' -o -path ./out -o -path ./.git -o -path ./bench -o -path ./tests \) -prune -o \
    -type f \( -name '*.c' -o -name '*.h' -o -name '*.cl' -o -name '*.clh' \) -print | sed 's|^\./||' |
    grep -vE "^(include|include/smartvis|cl/($families)|src/($layers)|host_sim/($rooms|render/cl)|examples/($examples))/[^/]*\$" || true)

exit $failed
