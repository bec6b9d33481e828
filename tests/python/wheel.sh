#!/bin/bash
# SPDX-License-Identifier: MIT
# wheel.sh SOURCE BUILD: scripts/wheel.sh makes a wheel that auditwheel calls fit for other machines. It has host_sim and the
# OpenCL loader in it, with all licences, needs nothing else but the C library, finds the runtimes of the system, and says which
# command brings one where there is none. Its host_sim makes the scenes and pictures of the build's, bit for bit. What a bare
# machine makes of it, scripts/try_wheel.sh tries.
set -eu
venv=$2/python/venv
. "$1/tests/support/holds.sh"
if [ ! -x "$venv/bin/auditwheel" ]; then # environment.sh says why
    echo "skipped: no index of Python packages (PyPI) can be reached"
    exit 77
fi
code=0
"$1/scripts/wheel.sh" "$2" "$work/out" 2> "$work/said" || code=$?
if [ $code = 3 ] && grep 'has no static library' "$work/said" > "$work/why"; then
    echo "skipped: $(cat "$work/why")"
    exit 77
fi
[ $code = 0 ] || { cat "$work/said" && exit 1; }
wheel=("$work"/out/smartvis-*.whl)
[[ ${wheel[*]} =~ -py3-none-manylinux_2_([0-9]+)_ ]] && libc=${BASH_REMATCH[1]}
holds [ "${libc:-99}" -le "$(ldd --version | sed -n '1s/.*\.//p')" ]
"$venv/bin/auditwheel" show "${wheel[0]}" > "$work/shown"
holds grep -qF "\"manylinux_2_${libc:-99}_" "$work/shown"

"$venv/bin/pip" install --quiet --no-deps --no-index --target "$work/there" "${wheel[0]}"
holds grep -qF "MIT License" "$work"/there/smartvis-*.dist-info/licenses/LICENSE
holds grep -qiE "BSD|Apache" "$work"/there/smartvis-*.dist-info/licenses/OpenCL-loader
for name in libcairo2 libcivetweb1 libjansson zlib1g fonts-dejavu-core; do
    holds [ -s "$work"/there/smartvis-*.dist-info/licenses/$name ]
done
needed() { objdump -p "$1" | awk '/NEEDED/ { print $2 }' | grep -vE '^((libc|libm)\.so\.6|ld-linux-.*)$'; }
loader=$(needed "$work/there/smartvis/plugin/smartvis.so")
holds [ -e "$work/there/smartvis.libs/$loader" ]
host=$work/there/smartvis/plugin/host_sim
holds [ -x "$host" ]
holds [ "$(needed "$host" | sort)" = "$(ls "$work/there/smartvis.libs" | sort)" ] # the loader is the plugin's
for file in "$work"/there/smartvis.libs/*; do
    holds [ -z "$(needed "$file")" ]
done

cat > "$work/clip.py" << 'END_PYTHON'
import sys, numpy, smartvis
scene = numpy.load(sys.argv[1])
result = smartvis.clip(scene["full"], scene["spacing"], scanned=scene["full"] > 0)
loaders = {line.split()[-1] for line in open("/proc/self/maps") if "libOpenCL" in line}
print(result.clips and numpy.array_equal(result.depth, scene["depth"]), *loaders)
END_PYTHON
cd "$work"
env -u SMARTVIS_PLUGIN PYTHONPATH="$work/there" "$venv/bin/python" clip.py out/scene.npz > said
holds [ "$(cat said)" = "True $work/there/smartvis.libs/$loader" ]
code=0
env -u SMARTVIS_PLUGIN PYTHONPATH="$work/there" OCL_ICD_VENDORS=/nowhere "$venv/bin/python" clip.py out/scene.npz 2> said || code=$?
holds [ $code = 1 ]
holds grep -qF "pip install pocl-binary-distribution" said

# Without a folder for fontconfig's cache, and with the wheel's font instead of the system's.
cat > draw.py << 'END_PYTHON'
import sys, numpy, smartvis
from smartvis import _host
scene = smartvis.scene("D01", size=96)
result = scene.clip()
result.picture(scene.full, size=128).save("drawn.png")
print(_host.find(), numpy.array_equal(scene.full, numpy.load(sys.argv[1])["full"]), smartvis.measure(scene, result))
END_PYTHON
draw() { env -u SMARTVIS_PLUGIN "$@" PYTHONPATH="$work/there" "$venv/bin/python" draw.py out/scene.npz > said; }
draw SMARTVIS_HOST_SIM="$2/host_sim"
mv drawn.png expected.png
expected=$(sed "s|^[^ ]*|$host|" said)
draw -u SMARTVIS_HOST_SIM -u XDG_CACHE_HOME HOME=/dev/null
holds [ "$(cat said)" = "$expected" ]
holds cmp expected.png drawn.png
echo "$checked checked, $failed failed"
[ "$failed" = 0 ]
