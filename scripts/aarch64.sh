#!/bin/bash
# SPDX-License-Identifier: MIT
# aarch64.sh BUILD_FOLDER OUT_FOLDER: the plugin, the validator and the template for 64-bit ARM, as a vendor builds them, and
# the validator's checks there under qemu, where there is no OpenCL device. The template computes on the CPU, so its frames are
# tried, too; of the plugin that is loading, creation and parameters. BUILD_FOLDER is a build of this machine, whose headers
# the template takes. Packages of that architecture are unpacked to OUT_FOLDER/root; nothing is installed.
set -eu -o pipefail
build=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
cd "$(dirname "$0")/.."

# The packages' own apt: its lists and its status lie in OUT_FOLDER.
if [ ! -e "$out/root/done" ]; then
    mkdir -p "$out/apt/lists/partial" "$out/apt/cache/archives/partial" "$out/root"
    : > "$out/apt/status"
    own=(-o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=root -o "Dir::State::Lists=$out/apt/lists"
        -o "Dir::State::status=$out/apt/status" -o "Dir::Cache=$out/apt/cache")
    apt-get "${own[@]}" -q update > "$out/apt.log" 2>&1 || { cat "$out/apt.log" >&2; exit 1; }
    (cd "$out/apt" && apt-get "${own[@]}" -q download libjansson4 libjansson-dev ocl-icd-libopencl1 ocl-icd-opencl-dev opencl-c-headers)
    for package in "$out"/apt/*.deb; do dpkg-deb -x "$package" "$out/root"; done
    touch "$out/root/done"
fi

cross=(-G Ninja -D "CMAKE_TOOLCHAIN_FILE=$PWD/cmake/aarch64-linux-gnu.cmake" -D "SV_AARCH64_ROOT=$out/root")
log=$(cmake -S . -B "$out/build" "${cross[@]}" -D SV_PLUGIN_ONLY=ON -D SV_VALIDATOR=ON -D SV_WERROR="${SV_WERROR:-OFF}" 2>&1) ||
    { echo "$log"; exit 1; }
cmake --build "$out/build"
log=$(cmake -S examples/template -B "$out/template" "${cross[@]}" -D "CMAKE_PREFIX_PATH=$build" 2>&1) || { echo "$log"; exit 1; }
cmake --build "$out/template"
for file in build/smartvis.so build/sv_validate template/template.so; do
    LC_ALL=C readelf -h "$out/$file" | grep -q 'Machine: *AArch64' || { echo "aarch64: $file is not of that architecture" >&2; exit 1; }
done

# The validator itself leaves out what needs a device, and fails if anything else does not hold. proot starts its children in qemu, too.
validate() { # validate LEAST PLUGIN: so many checks pass at least
    proot -q "qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH=$out/root/usr/lib/aarch64-linux-gnu" \
        "$out/build/sv_validate" --level 1 --timeout 240 "$2" | tee "$out/log"
    local passed
    passed=$(grep -c '^pass ' "$out/log")
    [ "$passed" -ge "$1" ] || { echo "aarch64: $passed checks of $2 pass, expected at least $1" >&2; return 1; }
}
validate 50 "$out/template/template.so"
validate 20 "$out/build/smartvis.so"
