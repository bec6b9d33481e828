#!/bin/bash
# SPDX-License-Identifier: MIT
# windows_build.sh OUT_FOLDER: SDK and programs for 64-bit Windows, cross-built with Debian's mingw-w64: OUT/root has what they are linked
# to, OUT/plugin the build, OUT/installed what is installed. scripts/windows.sh sources this and goes on with `cross`.
set -eu -o pipefail
mkdir -p "$1"
out=$(realpath "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$out/root

# OpenCL for the linker: the names that this machine's loader exports are those of OpenCL.dll; the headers are the same, too.
mkdir -p "$root/lib" "$root/include"
cp -rL /usr/include/CL "$root/include"
loader=$(ldconfig -p | awk '$1 == "libOpenCL.so.1" && !n++ { print $NF }')
{
    printf 'LIBRARY OpenCL.dll\nEXPORTS\n'
    nm -D --defined-only "$loader" | awk '$3 ~ /^cl[A-Z]/ { sub(/@.*/, "", $3); print $3 }' | sort -u
} > "$root/OpenCL.def"
(cd "$root" && x86_64-w64-mingw32-dlltool -d OpenCL.def -l lib/libOpenCL.a) # its path becomes names in what is linked

cross() { # cross SOURCE FOLDER ARGUMENT...: configures and builds; CMake's own output only if it fails
    local log
    log=$(cmake -S "$1" -B "$out/$2" -G Ninja -D "CMAKE_TOOLCHAIN_FILE=$PWD/cmake/x86_64-windows.cmake" -D "SV_WINDOWS_ROOT=$root" \
        -D CMAKE_BUILD_TYPE=Release "${@:3}" 2>&1 && cmake --build "$out/$2" 2>&1) || { echo "$log"; exit 1; }
    if grep -E 'warning:' <<< "$log"; then echo "windows: warnings in $1" >&2; exit 1; fi
}
scripts/windows_libraries.sh "$root"
cross . plugin -D SV_WERROR="${SV_WERROR:-OFF}"
cmake --install "$out/plugin" --prefix "$out/installed" > "$out/installed.log"
