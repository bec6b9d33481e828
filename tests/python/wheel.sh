#!/bin/bash
# SPDX-License-Identifier: MIT
# wheel.sh SOURCE BUILD: scripts/wheel.sh makes a wheel that auditwheel calls fit for other machines. It has the OpenCL loader
# and both licences in it, needs nothing else but the C library, finds the runtimes of the system, and says which command
# brings one where there is none. What a bare machine makes of it, scripts/try_wheel.sh tries.
set -eu
venv=$2/python/venv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
. "$1/tests/support/holds.sh"
if [ ! -x "$venv/bin/auditwheel" ]; then # environment.sh says why
    echo "skipped: no index of Python packages (PyPI) can be reached"
    exit 77
fi
"$1/scripts/wheel.sh" "$2" "$work/out"
wheel=("$work"/out/smartvis-*.whl)
[[ ${wheel[*]} =~ -py3-none-manylinux_2_([0-9]+)_ ]] && libc=${BASH_REMATCH[1]}
holds [ "${libc:-99}" -le "$(ldd --version | sed -n '1s/.*\.//p')" ]
"$venv/bin/auditwheel" show "${wheel[0]}" > "$work/shown"
holds grep -qF "\"manylinux_2_${libc:-99}_" "$work/shown"

"$venv/bin/pip" install --quiet --no-deps --no-index --target "$work/there" "${wheel[0]}"
holds grep -qF "MIT License" "$work"/there/smartvis-*.dist-info/licenses/LICENSE
holds grep -qiE "BSD|Apache" "$work"/there/smartvis-*.dist-info/licenses/OpenCL-loader
needed=$(objdump -p "$work/there/smartvis/plugin/smartvis.so" | awk '/NEEDED/ { print $2 }' | grep -vE '^(libc|libm)\.so\.6$')
holds [ -e "$work/there/smartvis.libs/$needed" ]

cat > "$work/clip.py" << 'END_PYTHON'
import sys, numpy, smartvis
scene = numpy.load(sys.argv[1])
result = smartvis.clip(scene["full"], scene["spacing"], scanned=scene["full"] > 0)
loaders = {line.split()[-1] for line in open("/proc/self/maps") if "libOpenCL" in line}
print(result.clips and numpy.array_equal(result.depth, scene["depth"]), *loaders)
END_PYTHON
cd "$work"
env -u SMARTVIS_PLUGIN PYTHONPATH="$work/there" "$venv/bin/python" clip.py out/scene.npz > said
holds [ "$(cat said)" = "True $work/there/smartvis.libs/$needed" ]
code=0
env -u SMARTVIS_PLUGIN PYTHONPATH="$work/there" OCL_ICD_VENDORS=/nowhere "$venv/bin/python" clip.py out/scene.npz 2> said || code=$?
holds [ $code = 1 ]
holds grep -qF "pip install pocl-binary-distribution" said
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
