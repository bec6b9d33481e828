#!/bin/bash
# SPDX-License-Identifier: MIT
# windows.sh BUILD_FOLDER OUT_FOLDER: SDK, host_sim and Python wheel for 64-bit Windows, as a vendor builds them, and what they do there, under
# wine, on this machine's OpenCL: the hosts of the examples print with the plugin, and with plugins made of the template and in C++, what they print
# on Linux. BUILD_FOLDER is a build of this machine.
set -eu -o pipefail
[ -d /usr/lib/wine ] || { echo "windows: no wine here; see scripts/packages-windows.txt" >&2; exit 1; }
build=$(realpath "$1")
source "$(dirname "$0")/windows_build.sh" "$2"

methods=$(scripts/list_methods.sh)
# An example in C++ for this machine, to compare with.
cmake -S examples/cpp -B "$out/cpp_here" -G Ninja -D "CMAKE_PREFIX_PATH=$build" > /dev/null
cmake --build "$out/cpp_here" > /dev/null
# The plugin alone, as docs/systems.md has it, is what the examples are built against.
cross . alone -D SV_PLUGIN_ONLY=ON
cmake --install "$out/alone" --prefix "$out/sdk" > "$out/there.log"
here=(-D "CMAKE_PREFIX_PATH=$out/sdk" -D CMAKE_EXE_LINKER_FLAGS=-static -D CMAKE_MODULE_LINKER_FLAGS=-static)
for example in small_host queue_host template first_edge kernel_edge cpp; do cross examples/$example $example "${here[@]}"; done

for library in smartvis smartvis_check; do
    exports=$(x86_64-w64-mingw32-objdump -p "$out/plugin/$library.dll" | sed -n '/\[Ordinal\/Name Pointer\]/,/^$/s/.*\] //p')
    [ "$(tail -n +2 <<< "$exports")" = smartvis_plugin_entry ] || { echo "windows: $library.dll exports: $exports" >&2; exit 1; }
done

export WINEPREFIX=$out/wine WINEDEBUG=-all LC_ALL=C.UTF-8
# same PROGRAM_HERE PROGRAM_THERE PLUGIN_HERE PLUGIN_THERE: both print the same and end alike.
same() {
    local a=0 b=0
    "$1" "$3" > "$out/here.txt" || a=$?
    timeout 300 wine "$2" "$4" 2> "$out/there.log" | tr -d '\r' > "$out/there.txt" || b=$?
    if [ $a != $b ] || ! diff "$out/here.txt" "$out/there.txt"; then
        cat "$out/there.log" >&2
        echo "windows: $2 $4: exit code $b, on Linux $a, or the output above differs" >&2
        return 1
    fi
    echo "windows: $(basename "$2") $(basename "$4"): as on Linux ($(head -n 1 "$out/here.txt"))"
}
mkdir -p "$out/fötus"
cp "$out/plugin/smartvis.dll" "$out/fötus/"
examples=$build/examples
same "$examples/small_host" "$out/small_host/small_host.exe" "$build/smartvis.so" "$out/plugin/smartvis.dll"
same "$examples/small_host" "$out/small_host/small_host.exe" "$examples/first_edge.so" "$out/first_edge/first_edge.dll"
same "$examples/queue_host" "$out/queue_host/queue_host.exe" "$build/smartvis.so" "$out/plugin/smartvis.dll"
same "$examples/queue_host" "$out/queue_host/queue_host.exe" "$examples/kernel_edge.so" "$out/kernel_edge/kernel_edge.dll"
same "$out/cpp_here/small_host" "$out/cpp/small_host.exe" "$build/smartvis.so" "$out/fötus/smartvis.dll"
same "$examples/queue_host" "$out/queue_host/queue_host.exe" "$build/smartvis_check.so" "$out/plugin/smartvis_check.dll"
same "$out/cpp_here/small_host" "$out/cpp/small_host.exe" "$out/cpp_here/fluid_plugin.so" "$out/cpp/fluid_plugin.dll"

ends() { # ends CODE COMMAND...: under wine
    local code=0
    timeout 120 wine "${@:2}" > "$out/there.txt" 2>&1 || code=$?
    [ $code = "$1" ] || { cat "$out/there.txt" >&2; echo "windows: ${*:2}: exit code $code, expected $1" >&2; return 1; }
}
# plays SAYS COMMAND...: sv_replay ends so, with that last line.
plays() {
    local said
    said=$("${@:2}" 2>> "$out/there.log" | tr -d '\r' | tail -n 1)
    [ "$said" = "$1" ] || { echo "windows: ${*:2}: $said, expected $1" >&2; return 1; }
}
# Recordings, both ways: what this machine records is the same there, bit for bit; and played there through the layer, which keeps the
# last two frames of it, it is a recording that is the same here. That file was there before, and a program that scans files has it open.
replay=$out/plugin/sv_replay.exe
printf '#include <stdio.h>\n#include <windows.h>\nint main(int n, char **of) {\n    return n < 2 || CreateFileA(of[1], GENERIC_READ, 7, 0, %s\n}\n' \
    'OPEN_EXISTING, 0, 0) == INVALID_HANDLE_VALUE || puts("open") < 0 || fflush(stdout) || (Sleep(600000), 0);' > "$out/holds.c"
x86_64-w64-mingw32-gcc -O2 "$out/holds.c" -o "$out/holds.exe"
: > "$out/fötus/back.svr"
(cd "$out/fötus" && exec wine "$out/holds.exe" back.svr) > "$out/holds.txt" 2> "$out/there.log" &
holder=$!
for method in $methods; do
    record=$out/$method.svr
    SMARTVIS_RECORD=$record "$build/host_sim" run --scene D01 --size 96 --picture 96 --few-pictures --frames 3 --no-guard \
        --set "method=$method" --plugin "$build/smartvis_check.so" --out "$out/run" > "$out/here.txt" 2>&1 || { cat "$out/here.txt" >&2; exit 1; }
    plays "the same" wine "$replay" "$record" --plugin "$out/fötus/smartvis.dll"
    SMARTVIS_RECORD=$out/fötus/back.svr SMARTVIS_RECORD_OPTIONS=frames=2 wine "$replay" "$record" --plugin "$out/plugin/smartvis_check.dll" \
        > "$out/there.txt" 2>&1 || true # its own lines are not recorded
    [ "$(stat -c %a "$out/fötus/back.svr")" = 0 ] || { echo "windows: back.svr: others may read it" >&2; exit 1; }
    chmod u+rw "$out/fötus/back.svr" # wine reads "only for its owner" as nobody
    plays "the same" "$build/sv_replay" "$out/fötus/back.svr"
    echo "windows: D01 by $method: recordings are the same, both ways"
done
kill "$holder"
grep -q open "$out/holds.txt" && ! compgen -G "$out/fötus/back.svr.*" || { echo "windows: back.svr: not held open, or more is left" >&2; exit 1; }
# A plugin that crashes, leaves or hangs in slab ends the process that plays, and is named.
SMARTVIS_CHECK_PLUGIN=$build/tests/plugins/plane.so SMARTVIS_RECORD=$out/plane.svr "$build/host_sim" run --scene E01 --size 32 --frames 2 \
    --picture 32 --few-pictures --no-guard --plugin "$build/smartvis_check.so" --out "$out/run" > "$out/here.txt" 2>&1
line=0
while read -r name; do
    case $name in
    by_crash) says='crashed: access violation' ;;
    by_leave) says='left by exit' ;;
    by_hang) says='ran out of time' ;;
    *) says='' ;;
    esac
    if [ -n "$says" ]; then
        x86_64-w64-mingw32-gcc -O2 -mcmodel=small -Wno-attributes -shared -static -D CL_TARGET_OPENCL_VERSION=120 -I include -I "$root/include" \
            tests/base/plugins/plane.c "-Wl,--defsym=plane_line=plane_lines+$line" -L "$root/lib" -lOpenCL -o "$out/$name.dll" 2> "$out/there.log"
        ends 4 "$replay" "$out/plane.svr" --plugin "$out/$name.dll" --set fail=slab --guard-time 5,8
        grep -q "$name.dll: $says" "$out/there.txt" || { cat "$out/there.txt" >&2; exit 1; }
        (cd "$out" && timeout 120 wine installed/bin/host_sim.exe run --scene E01 --size 32 --frames 2 --picture 32 --few-pictures --setting smartvis \
            --plugin $name.dll --set fail=slab --guard-time 2,8 --out run) > "$out/there.txt" 2>&1 || true
        grep -q "$name.dll: slab: SV_ERR_INTERNAL (-1): $says.*in slab 2 of 2" "$out/there.txt" && grep -q 'unclipped: 0 by the plugin.s note, 2 by its failure' "$out/there.txt" &&
            ! grep -q debugger "$out/there.txt" ||
            { cat "$out/there.txt" >&2; echo "windows: host_sim and $name: expected two unclipped frames" >&2; exit 1; }
    fi
    line=$((line + 1))
done < <(sed -n 's/^    {"\([a-z0-9_]*\)".*/\1/p' tests/base/plugins/plane.c)
echo "windows: plugins that crash, leave and hang are named, and host_sim renders unclipped"
# Paths that Windows reads otherwise: a device, a stream, a folder, a name that is longer than a path, and what is not there.
long=$(printf 'n%.0s' {1..300})
for path in CON nul.svr "$record:stream" "$record." "$out" "$out/$long.svr" 'C:\missing.svr' 'C:plane.svr' '\\.\pipe\none'; do ends 3 "$replay" "$path"; done
echo "windows: devices, streams and long names are refused"

# sv_validate: right plugins pass, and each wrong one fails by the check that names its fault. docs/systems.md tells of those left out.
for plugin in template/template plugin/smartvis; do ends 0 "$out/plugin/sv_validate.exe" --level 1 "$out/$plugin.dll"; done
ends 3 "$out/plugin/sv_validate.exe" "$out/plane.svr"
# So does one that was linked to another C library, which alone knows the blocks that were made before the validator looked.
x86_64-w64-mingw32-gcc -dumpspecs | sed 's/-lmsvcrt/-lucrt/' > "$out/ucrt.specs"
printf '#include <stdlib.h>\nstatic void its_own(void *p) { if (p && !(p = realloc(p, 1))) abort(); free(p); }\n#define free its_own\n' > "$out/its_own.h"
x86_64-w64-mingw32-gcc "-specs=$out/ucrt.specs" -D_UCRT -include "$out/its_own.h" -O2 -Wno-attributes -shared -static -D CL_TARGET_OPENCL_VERSION=120 \
    -D PLUGIN_NAME='"ucrt"' -D PLUGIN_VERSION='"1"' -I include -I "$root/include" examples/template/my_surface.c -o "$out/ucrt.dll"
ends 0 "$out/plugin/sv_validate.exe" --only activations,frame-path-heap "$out/ucrt.dll"
ninja -C "$out/plugin" wrong_plugins > "$out/there.log" 2>&1 || { cat "$out/there.log" >&2; exit 1; }
said=$(WRONG_VALIDATOR="wine $out/plugin/sv_validate.exe" WRONG_ENDING=dll \
    WRONG_LEFT_OUT='undefined_symbol|crash_in_destructor|leaks_file|changes_locale|takes_signal|shrinks_files|lowers_[a-z_]*|forks[a-z_]*' \
    bash tests/sdk/validate/test_validate_wrong.sh . "$out/plugin") || { echo "$said" >&2; exit 1; }
echo "windows: sv_validate: right plugins pass; $said"

# host_sim: what it makes of scenes and files, in a folder whose name is not ASCII, is what it makes on Linux, bit for bit.
machine=$out/installed/bin/host_sim.exe
mkdir -p "$out/here"
both() { # both COMMAND ARGUMENT...: of host_sim, here and there
    (cd "$out/here" && "$build/host_sim" "$@") > "$out/here.txt" 2> "$out/here.log" || { cat "$out/here.log" >&2; exit 1; }
    (cd "$out/fötus" && timeout 300 wine "$machine" "$@") > "$out/there.txt" 2> "$out/there.log" ||
        { cat "$out/there.log" >&2; echo "windows: host_sim $*: failed" >&2; exit 1; }
}
equal() { # equal FOLDER NAME...: files of both
    local name
    for name in "${@:2}"; do cmp "$out/here/$1/$name" "$out/fötus/$1/$name"; done
}
for method in $methods; do
    both run --scene D01 --size 96 --picture 96 --frames 3 --set method=$method --write all --out $method
    equal $method {clipped,depthmap,mask,status}.mha surface.ply {full,result}.png
done
equal wall confidence.mha
n=$(printf 'n%.0s' {1..100})
scene=$n/$n/$n # longer than the 260 characters that old programs may name
both scenes D02 --size 96 --export --out "$scene"
equal "$scene" D02_{full,truth,label}.mha
for command in "info $scene/D02_full.mha" "measure --case D01 --size 96 wall/depthmap.mha"; do
    both $command
    diff "$out/here.txt" "$out/there.txt"
done
both report --case D01 --size 64 --lowres 64 --coarse --frames 0 --out report
equal report best.csv common.csv plain.csv space_D01.csv
grep -q '</html>' "$out/fötus/report/index.html"
echo "windows: host_sim run, scenes, info, measure and report: as on Linux"
# A header names a file in its folder, whatever Windows reads otherwise; and such paths are no volumes.
mkdir -p "$out/deep"
head -c 64 /dev/zero | tee "$out/out.raw" > "$out/deep/in.raw"
for name in in.raw '..\out.raw' '..\deep\..\out.raw' 'C:\windows\win.ini' z:out.raw '\out.raw' in.raw:stream NUL CON; do
    printf 'ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = %s\n' "$name" > "$out/deep/of.mhd"
    ends "$([ "$name" = in.raw ] && echo 0 || echo 3)" "$machine" info "$out/deep/of.mhd"
done
for path in CON nul.mha "$out/deep" "$out/$long.mha" 'C:\missing.mha' '\\.\pipe\none' "$out/deep/in.raw:x" 'Q:x.mha' 'CONIN$'; do ends 3 "$machine" info "$path"; done
for path in NUL COM1 "$out/nul.txt" "$out/deep/new:x" 'C:x:y' C: 'Q:\none'; do ends 6 "$machine" scenes D02 --size 32 --export --out "$path"; done
echo "windows: host_sim refuses devices, streams, and files outside of a header's folder, also for what it writes"

# The wheel: plugin and libsmartvis_host by the package's own build, host_sim.exe with the scenes, licences of what is linked in. It needs Windows'
# own libraries and OpenCL.dll only, and is loaded and run from where Python would have it.
rm -rf "$out"/smartvis-*.whl "$out/filled" "$out/unpacked"
mkdir -p "$out/filled/plugin/share/smartvis"
scripts/python_env.sh "$build/python/venv" python/requirements-test.txt
python=$build/python/venv/bin/python
"$python" -m pip wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps --config-settings build-dir="$out/wheel" \
    --config-settings cmake.define.CMAKE_TOOLCHAIN_FILE="$PWD/cmake/x86_64-windows.cmake" \
    --config-settings cmake.define.SV_WINDOWS_ROOT="$root" --config-settings cmake.define.SV_HOST_SIM=OFF --wheel-dir "$out" ./python
cp "$machine" "$out/filled/plugin"
cp -r data/scenes "$out/filled/plugin/share/smartvis"
cp -r "$root/licences" "$out/filled"
cp LICENSE "$out/filled/licences"
for package in mingw-w64-common libz-mingw-w64-dev gcc-mingw-w64-x86-64-win32; do cp "/usr/share/doc/$package/copyright" "$out/filled/licences/$package"; done
"$python" scripts/fill_wheel.py "$out"/smartvis-*-linux_x86_64.whl "$out/filled" "$out" win_amd64
rm "$out"/smartvis-*-linux_x86_64.whl
"$python" -m zipfile -e "$out"/smartvis-*-win_amd64.whl "$out/unpacked"
machine=$out/unpacked/smartvis/plugin/host_sim.exe
needs=$(cd "$(dirname "$machine")" && x86_64-w64-mingw32-objdump -p smartvis.dll libsmartvis_host.dll host_sim.exe | sed -n 's/.*DLL Name: //p' |
    grep -vixE '(opencl|kernel32|msvcrt|advapi32|shell32|gdi32|user32)\.dll' || true)
[ -z "$needs" ] || { echo "windows: the wheel needs $needs" >&2; exit 1; }
both run --scene D02 --size 64 --frames 1 --picture 64 --few-pictures --write depthmap --out wheel
equal wheel depthmap.mha
ends 4 "$machine" list --plugin "$(dirname "$machine")/libsmartvis_host.dll" # what Python opens is loaded, and is no plugin
grep -q 'no symbol smartvis_plugin_entry' "$out/there.txt"
echo "windows: $(ls "$out"/smartvis-*.whl): a frame of it is as on Linux"
