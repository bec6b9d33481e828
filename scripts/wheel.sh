#!/bin/bash
# SPDX-License-Identifier: MIT
# wheel.sh BUILD OUT: the wheel of tests/python/environment.sh as one that every Linux with a C library as old as this machine's
# takes. host_sim goes in beside the plugin, with the scenes and the font of its pictures; its libraries are linked into it (target
# host_sim_alone). auditwheel adds what is left, the OpenCL loader (ocl-icd, BSD) and civetweb, and names the least C library
# (manylinux_2_34 from Debian 12). The licences of all of it go in, too. Beside the wheel comes a scene with the depthmap that is
# to come out: scripts/try_wheel.sh clips it. Exit code 3: a library has no static form here, as cairo in Debian 13.
set -eu
build=$(realpath "$1")
venv=$build/python/venv
source=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$2"
out=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --build "$build" --target host_sim_alone > "$work/log" || {
    cat "$work/log" >&2
    exit 1
}
# What has no static library there would come without its licence, and with all that it needs.
alone=$build/obj/program/alone/host_sim
more=$(objdump -p "$alone" | awk '/NEEDED/ && $2 !~ /^(lib(c|m|OpenCL|civetweb)\.so|ld-linux)/ { print $2 }' | paste -sd ' ')
if [ -n "$more" ]; then
    echo "wheel: this system has no static library for $more: make the wheel on Debian 12" >&2
    exit 3
fi
into=$work/content # what goes into the wheel; licences/ into its licenses
mkdir -p "$into/plugin/share/smartvis" "$into/plugin/share/fonts" "$into/licences"
cp "$alone" "$into/plugin"
cp -r "$source/data/scenes" "$into/plugin/share/smartvis"
font=$(dpkg-query -L fonts-dejavu-core | grep '/DejaVuSans\.ttf$')
cp "$font" "$into/plugin/share/fonts"
# As Debian sets the font, so that pictures are the same to the bit.
cat > "$into/plugin/share/fonts/fonts.conf" << 'END_FONTS'
<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig>
<dir prefix="relative">.</dir>
<cachedir prefix="xdg">fontconfig</cachedir>
<match target="pattern"><edit name="hintstyle" mode="append"><const>hintslight</const></edit></match>
</fontconfig>
END_FONTS

# Licences as Debian's packages tell them, each named after its library.
shared() { ldconfig -p | sed -n "s/.*$1\.so\.1 .*=> //p" | head -n 1; }
package() { dpkg-query -S "$(realpath "$1")" | cut -d : -f 1; }
cp "$source/LICENSE" "$into/licences"
cp "/usr/share/doc/$(package "$(shared libOpenCL)")/copyright" "$into/licences/OpenCL-loader"
for file in $(grep -oE '^/[^ (]+\.a' "$build/obj/program/alone.map" | sort -u | grep -v '/libgcc\.a') "$(shared libcivetweb)" "$font"; do
    name=$(package "$file")
    cp "/usr/share/doc/$name/copyright" "$into/licences/${name%-dev}"
done
"$venv/bin/python" "$source/scripts/fill_wheel.py" "$build"/python/wheel/smartvis-*.whl "$into" "$work"
PATH=$venv/bin:$PATH auditwheel repair --wheel-dir "$work/fixed" "$work"/smartvis-*.whl > "$work/log" 2>&1 || {
    cat "$work/log" >&2
    exit 1
}
rm -f "$out"/smartvis-*.whl
cp "$work"/fixed/*.whl "$out"

SMARTVIS_HOST_SIM=$build/host_sim "$venv/bin/python" -P - "$out/scene.npz" << 'END_PYTHON'
import sys, numpy, smartvis
scene = smartvis.scene("D01", size=96)
numpy.savez_compressed(sys.argv[1], full=scene.full, spacing=scene.spacing, depth=scene.clip().depth)
END_PYTHON
ls "$out"/smartvis-*.whl
