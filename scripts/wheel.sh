#!/bin/bash
# SPDX-License-Identifier: MIT
# wheel.sh BUILD OUT: the wheel of tests/python/environment.sh as one that every Linux with a C library as old as this machine's
# takes: auditwheel puts the OpenCL loader (ocl-icd, BSD) into it and names the least C library (manylinux_2_34 from Debian 12).
# Both licences go in, too. Beside it comes a scene with the depthmap that is to come out: scripts/try_wheel.sh clips it.
set -eu
build=$(realpath "$1")
venv=$build/python/venv
source=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$2"
out=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp "$build"/python/wheel/smartvis-*.whl "$work"
loader=$(dpkg-query -S "$(realpath "$(ldconfig -p | sed -n 's/.*libOpenCL\.so\.1 .*=> //p' | head -n 1)")" | cut -d : -f 1)
"$venv/bin/python" - "$work"/smartvis-*.whl "$source/LICENSE" "/usr/share/doc/$loader/copyright" << 'END_PYTHON'
import sys, zipfile
with zipfile.ZipFile(sys.argv[1], "a") as wheel:
    facts = next(n for n in wheel.namelist() if n.endswith("/WHEEL")).removesuffix("WHEEL")
    wheel.write(sys.argv[2], facts + "licenses/LICENSE")
    wheel.write(sys.argv[3], facts + "licenses/OpenCL-loader")
END_PYTHON
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
