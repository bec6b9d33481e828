#!/bin/bash
# SPDX-License-Identifier: MIT
# try_wheel.sh FOLDER: what a researcher does on a machine without OpenCL, with the wheel of FOLDER alone: pip installs it, the
# error of the first clip names a command, the command is run, and the scene of FOLDER is clipped to the bits that were
# clipped where the wheel was made. The wheel's host_sim makes the same scene, measures what was clipped, and reads a MetaImage file.
# Needs PyPI, and root for Python. On a bare Debian:
#     scripts/bare_root.sh --bring out/wheel bookworm try-wheel
set -eu
folder=$(realpath "$1")
wheels=("$folder"/smartvis-*manylinux*.whl)
[ -e "${wheels[0]}" ] || { echo "try_wheel: no wheel in $folder: run make wheel" >&2; exit 1; }
command -v python3 > /dev/null && python3 -c 'import ensurepip' 2> /dev/null || {
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -q
    apt-get install -y -q --no-install-recommends python3-venv > /dev/null
}
! ldconfig -p | grep -F libOpenCL || { echo "try_wheel: OpenCL is there; this is for machines without" >&2; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
export PATH=$work/venv/bin:$PATH PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1 POCL_CACHE_DIR=$work
pip install --quiet "${wheels[0]}"
cat > clip.py << 'END_PYTHON'
import sys, time, numpy, smartvis
from smartvis import _host
scene = numpy.load(sys.argv[1])
start = time.perf_counter()
try:
    result = smartvis.clip(scene["full"], scene["spacing"], scanned=scene["full"] > 0)
except smartvis.PluginError as error:
    sys.exit(f"{error}")
same = numpy.array_equal(result.depth, scene["depth"])
print(f"{result.outcome.name}, {numpy.mean(result.depth > 0):.2f} of the rays clipped, after {time.perf_counter() - start:.0f} s")
if not same or not result.clips:
    sys.exit(f"the depthmap is {'the same' if same else 'another one'}, {result.outcome.name}")
made = smartvis.scene("D01", size=96)
error = smartvis.measure(made, result).e_abs
print(f"{_host.find()}: mean error {error:.2f} steps")
_host.run(["scenes", "D01", "--size", "96", "--export", "--out", "."])
sys.exit(0 if numpy.array_equal(made.full, scene["full"]) and error < 1 else "the scene of host_sim is another one")
END_PYTHON

# PoCL's package may be older than the processor; then the second message names another one.
for attempt in 1 2 3; do
    echo "\$ python clip.py"
    if python clip.py "$folder/scene.npz" > said 2>&1; then
        cat said
        [ "$attempt" -gt 1 ] || { echo "try_wheel: it clipped without a runtime" >&2; exit 1; }
        pip install --quiet SimpleITK
        smartvis clip D01_full.mha --write clipped --out out | tee said
        grep -q ', OK,' said || { echo "try_wheel: the file was not clipped" >&2; exit 1; }
        echo "try_wheel: the wheel alone, from the message to a clipped scene and a clipped file: ok"
        exit 0
    fi
    cat said
    command=$(grep -oE 'pip install [a-z ._-]+' said | tail -n 1) || break
    echo "\$ $command"
    $command --quiet
done
echo "try_wheel: no scene was clipped" >&2
exit 1
